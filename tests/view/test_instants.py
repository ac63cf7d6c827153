"""Instants to draw."""

import numpy as np

from maggi.view.instants import different_instants


def test_whole_turns_do_not_all_look_alike():
    # Four whole turns of 30 rows each: evenly spread rows would show the same pose four times.
    angle = np.linspace(0.0, 8 * np.pi, 121)
    points = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)[:, None]
    rows = different_instants(points, 4)
    assert list(rows) == sorted(set(rows))
    chosen = points[rows, 0]
    nearest = min(np.linalg.norm(a - b) for i, a in enumerate(chosen) for b in chosen[:i])
    assert nearest > 1.3  # a square in the unit circle has sides of 1.41


def test_what_does_not_move_is_drawn_once():
    assert list(different_instants(np.ones((50, 2, 3)), 4, first=7)) == [7]
