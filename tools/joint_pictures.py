"""Draws docs/pictures/joints/<name>.png, one for each joint of docs/joints.md, from runs of docs/joints/<name>.yml.

    .venv/bin/python tools/joint_pictures.py           # all of them, a minute once compiled
    .venv/bin/python tools/joint_pictures.py cam gear  # some

Every position in the pictures is one that the program computed; only the shapes of the bodies are made up.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from joint_drawing import (
    GREEN,
    JOINT,
    PATH,
    SAND,
    STEEL,
    VIOLET,
    Array,
    Color,
    Sheet,
    X,
    Y,
    Z,
    circle,
    gear_wheel,
    new_figure,
    save,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import maggi
from maggi.results.results import Results
from maggi.view.projection import Camera, axonometric, facing
from maggi.view.style import COLORS, FAINT, INK, style

DOCS = Path(__file__).resolve().parent.parent / "docs"
FRONT, ABOVE, CORNER = facing(Y), facing(Z), axonometric()
SIDEWAYS = Camera(Y, -X, Z)  # above, x downwards
DOWN = np.array([0.0, 0.0, -9.81])
LATER = (0.55, 0.7, 0.8, 0.85)  # how pale later instants are
Pose = tuple[Array, Array]


def pose(results: Results, body: str, row: int) -> Pose:
    """Origin (3,) and rotation (3, 3) of a body at a row."""
    one = results.body(body)
    return one.origin[row], one.rotation[row]


def at(place: Pose, points: object) -> Array:
    """Points (n, 3) of a body, global."""
    return np.asarray(place[0] + np.asarray(points, dtype=float) @ place[1].T)


def track(results: Results, body: str, point: object) -> Array:
    """Where a point of a body went (n, 3)."""
    one = results.body(body)
    return np.asarray(one.origin + one.rotation @ np.asarray(point, dtype=float))


def rows(results: Results, *times: float) -> list[int]:
    """The rows nearest to some times."""
    return [int(np.argmin(np.abs(results.time - t))) for t in times]


def instants(sheet: Sheet, chosen: list[int], draw: Callable[[int], None]) -> None:
    """Draw later instants pale and the first as it is, on top."""
    for k in range(len(chosen) - 1, 0, -1):
        sheet.pale_by = LATER[min(k, len(LATER)) - 1]
        draw(chosen[k])
    sheet.pale_by = 0.0
    draw(chosen[0])


def chart(axes: Axes, what: str, across: str) -> None:
    """Names of a chart's axes."""
    axes.set_xlabel(across)
    axes.set_title(what, fontweight="normal", fontsize=8.5)
    axes.tick_params(labelsize=7.5)
    axes.margins(x=0.0)


def drawing_and_chart(height: float, shares: tuple[float, float]) -> tuple[Figure, Axes, Axes]:
    """A figure with a drawing on the left and a chart on the right."""
    figure = new_figure(height)
    left, right = figure.subplots(1, 2, width_ratios=shares)
    return figure, left, right


def only(camera: Camera) -> tuple[Figure, Sheet]:
    """A figure of one drawing."""
    figure = new_figure()
    return figure, Sheet(figure.subplots(), camera)


# Joints between two frames


def revolute(results: Results) -> Figure:
    """A swinging bar."""
    figure, sheet = only(FRONT)
    chosen = rows(results, 0.0, 0.2, 0.3, 0.4, 0.5)
    sheet.path(track(results, "bar", [0.25, 0, 0]))
    instants(sheet, chosen, lambda row: sheet.bar(at(pose(results, "bar", row), [[-0.25, 0, 0], [0.25, 0, 0]])))
    sheet.ground(np.zeros(3))
    sheet.dots(np.zeros(3))
    sheet.label([0, 0, 0], "hinge", -26, 8, JOINT)
    for row in chosen:
        sheet.label(track(results, "bar", [0.32, 0, 0])[row], f"{results.time[row]:.1f} s" if row else "t = 0", 4, 0)
    sheet.room([[-0.58, 0, -0.5], [0.72, 0, 0.05]])
    sheet.triad(DOWN)
    sheet.finish()
    return figure


def prismatic(results: Results) -> Figure:
    """A carriage at four instants."""
    figure, sheet = only(FRONT)
    rail = at(pose(results, "carriage", 0), [[-0.12, 0, -0.035], [0.95, 0, -0.035]])
    sheet.line(rail, JOINT, 2.4)
    for x in np.arange(-0.1, 0.94, 0.05):
        sheet.line(at(pose(results, "carriage", 0), [[x, 0, -0.04], [x - 0.02, 0, -0.065]]), INK, 0.7)
    chosen = rows(results, 0.0, 0.3, 0.45, 0.6)
    corners = [[-0.06, 0, -0.03], [0.06, 0, -0.03], [0.06, 0, 0.045], [-0.06, 0, 0.045]]
    instants(sheet, chosen, lambda row: sheet.area(at(pose(results, "carriage", row), corners), STEEL))
    for row in chosen:
        text = f"{results.time[row]:.2f} s" if row else "t = 0"
        sheet.label(at(pose(results, "carriage", row), [0, 0, 0.045]), text, 7, 10)
    sheet.label(rail[1], "rail", 0, -14, JOINT)
    sheet.triad(DOWN)
    sheet.finish()
    return figure


def _on_a_shaft(results: Results, body: str, shaft: Callable[[Sheet, Array], None]) -> Figure:
    """A tube with a handle that goes down a vertical shaft."""
    figure, sheet = only(axonometric(elevation=18.0))
    low = float(results.body(body).origin[-1, 2])
    path = track(results, body, [0.12, 0, 0])
    chosen = rows(results, *np.sqrt(np.linspace(0, 1, 4)) * results.time[-1])
    shaft(sheet, np.array([[0, 0, low - 0.08], [0, 0, 0.08]]))
    sheet.path(path)

    def draw(row: int) -> None:
        place = pose(results, body, row)
        sheet.cylinder(place[0], Z, 0.032, 0.05, STEEL)
        sheet.bar(at(place, [[0.034, 0, 0], [0.12, 0, 0]]), STEEL, 5.0)

    instants(sheet, chosen, draw)
    for row in chosen:
        place = results.body(body).origin[row]
        sheet.label(place, f"{results.time[row]:.2f} s" if row else "t = 0", 62, 0)
    sheet.room([[-0.4, 0, low], [0.5, 0, low]])
    sheet.triad(DOWN)
    sheet.finish()
    return figure


def cylindrical(results: Results) -> Figure:
    """A falling, turning sleeve."""
    return _on_a_shaft(results, "sleeve", lambda sheet, ends: sheet.bar(ends, JOINT, 5.0))


def screw(results: Results) -> Figure:
    """A nut on its thread."""

    def thread(sheet: Sheet, ends: Array) -> None:
        sheet.bar(ends, JOINT, 6.5)
        z = np.arange(ends[0, 2], ends[1, 2], 0.0375)
        for height in z:
            sheet.line([[-0.011, 0, height - 0.006], [0.011, 0, height + 0.006]], "#f2d7d5", 1.0)

    return _on_a_shaft(results, "nut", thread)


def spherical(results: Results) -> Figure:
    """The bob's path, and its shadow."""
    figure, sheet = only(CORNER)
    path = results.body("rod").origin
    chosen = rows(results, 0.0, 0.55, 1.1, 1.65)
    floor = np.column_stack([path[:, :2], np.full(len(path), -0.6)])
    sheet.area(circle([0, 0, -0.6], Z, 0.42), "#f1f4f6", None)
    sheet.line(floor, FAINT, 0.7)
    sheet.path(path)

    def draw(row: int) -> None:
        sheet.bar([[0, 0, 0], path[row]], STEEL, 5.0)
        sheet.ball(path[row], 0.035, STEEL)

    instants(sheet, chosen, draw)
    sheet.ground(np.zeros(3))
    sheet.dots(np.zeros(3), filled=True, size=40)
    sheet.label(path[0], "t = 0", 24, 0)
    sheet.triad(DOWN)
    sheet.finish()
    return figure


def planar(results: Results) -> Figure:
    """A plate seen from above."""
    figure, sheet = only(ABOVE)
    sheet.area([[-0.2, -0.2, 0], [1.1, -0.2, 0], [1.1, 0.62, 0], [-0.2, 0.62, 0]], "#f1f4f6", FAINT)
    path = track(results, "plate", [0.1, 0.06, 0])
    corners = [[-0.1, -0.06, 0], [0.1, -0.06, 0], [0.1, 0.06, 0], [-0.1, 0.06, 0]]
    instants(
        sheet, rows(results, 0, 0.5, 1.0, 1.5), lambda row: sheet.area(at(pose(results, "plate", row), corners), STEEL)
    )
    sheet.path(path)
    sheet.dots(path[:1], PATH, 14, True)
    sheet.label([0, 0, 0], "t = 0")
    sheet.label(results.body("plate").origin[-1], f"{results.time[-1]:.1f} s")
    sheet.label([0.93, -0.15, 0], "the table's plane", 0, 0, FAINT)
    sheet.finish(0.02)
    return figure


def _spin(results: Results, body: str) -> Array:
    """Angular speed (n,) of a body that turns about a fixed axis, from its rotations."""
    rotation, time = results.body(body).rotation, results.time
    turn = np.einsum("nij,nik->njk", rotation[:-2], rotation[2:])
    sine = 0.5 * np.stack(
        [turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]], axis=1
    )
    speed = np.arcsin(np.linalg.norm(sine, axis=1)) / (time[2:] - time[:-2])
    return np.concatenate([speed[:1], speed, speed[-1:]])


def _shafts(results: Results, ratio: str, middle: Callable[[Sheet, Pose, Pose], None]) -> Figure:
    """Two shafts in bearings and, beside them, the ratio of their speeds."""
    figure, left, right = drawing_and_chart(2.1, (1.45, 1.0))
    sheet = Sheet(left, axonometric(-70, 32))
    first, second = pose(results, "input", 0), pose(results, "output", 0)
    for place, away in ((first, -1.0), (second, 1.0)):
        inner, outer = at(place, [[-away * 0.13, 0, 0], [away * 0.05, 0, 0]])
        middle_of, along = 0.5 * (inner + outer), outer - inner
        sheet.cylinder(middle_of, along, 0.022, float(np.linalg.norm(along)), STEEL if away < 0 else SAND)
        sheet.circle(place[0], along, 0.032, JOINT, 2.0)
    middle(sheet, first, second)
    sheet.label(first[0], "input", 0, 24)
    sheet.label(second[0], "output", -4, 22)
    sheet.finish(0.03, fit=False)
    angle = np.degrees(results.joint("bearing").coordinate[:, 0])
    right.plot(angle, _spin(results, "output") / _spin(results, "input"), color=COLORS[1])
    right.set_ylim(0.6, 1.45)
    right.set_xticks([0, 90, 180, 270, 360])
    chart(right, ratio, "angle of input [°]")
    right.set_xlim(0, 360)
    return figure


def universal(results: Results) -> Figure:
    """A cross between two forks; the output's speed varies."""

    def cross(sheet: Sheet, first: Pose, second: Pose) -> None:
        bend = second[1][:, 0]
        for pin, shaft, color in ((Z, -X, STEEL), (np.cross(Z, bend), bend, SAND)):
            sheet.bar([0.075 * shaft, 0.055 * shaft + 0.05 * pin, 0.05 * pin], color, 5.0)
            sheet.bar([0.075 * shaft, 0.055 * shaft - 0.05 * pin, -0.05 * pin], color, 5.0)
        for pin in (Z, np.cross(Z, bend)):
            sheet.line([-0.05 * pin, 0.05 * pin], JOINT, 3.0)

    return _shafts(results, "speed of output / input", cross)


def constant_velocity(results: Results) -> Figure:
    """A ball in a bell; the output's speed does not vary."""

    def bell(sheet: Sheet, first: Pose, second: Pose) -> None:
        sheet.cylinder([-0.02, 0, 0], X, 0.05, 0.1, STEEL)
        sheet.ball([0.022, 0, 0], 0.043, JOINT)
        sheet.cylinder(0.1 * second[1][:, 0], second[1][:, 0], 0.022, 0.09, SAND)

    return _shafts(results, "speed of output / input", bell)


def weld(results: Results) -> Figure:
    """Two bars that swing as one."""
    figure, sheet = only(FRONT)
    chosen = rows(results, 0, 0.2, 0.35, 0.5)

    def draw(row: int) -> None:
        sheet.bar(at(pose(results, "arm", row), [[-0.2, 0, 0], [0.2, 0, 0]]), STEEL)
        leg = pose(results, "leg", row)
        sheet.bar(at(leg, [[0, 0, 0.1], [0, 0, -0.1]]), SAND)
        sheet.area(at(leg, [[-0.05, 0, 0.1], [0, 0, 0.1], [0, 0, 0.05]]), JOINT, JOINT)

    instants(sheet, chosen, draw)
    sheet.ground(np.zeros(3))
    sheet.dots(np.zeros(3))
    sheet.label([0.4, 0, 0], "weld", 4, 14, JOINT)
    sheet.label([0.2, 0, 0], "arm", 0, 12)
    sheet.label([0.4, 0, -0.1], "leg", 16, 0)
    sheet.room([[-0.12, 0, -0.05], [0.6, 0, 0.06]])
    sheet.triad(DOWN)
    sheet.finish()
    return figure


def free(results: Results) -> Figure:
    """A thrown hammer and what is measured of it."""
    figure, sheet = only(FRONT)
    sheet.path(track(results, "hammer", [0, 0, 0]))

    def draw(row: int) -> None:
        place = pose(results, "hammer", row)
        sheet.bar(at(place, [[-0.2, 0, 0], [0.1, 0, 0]]), SAND, 5.0)
        sheet.area(at(place, [[0.07, 0, -0.07], [0.13, 0, -0.07], [0.13, 0, 0.07], [0.07, 0, 0.07]]), STEEL)

    instants(sheet, rows(results, 0, 0.15, 0.3, 0.45, 0.6), draw)
    middle = rows(results, 0.3)[0]
    for axis, color in ((X, JOINT), (Z, "#1f5fa8")):
        sheet.arrow([np.zeros(3), 0.22 * axis], color, 1.4)
    sheet.line([np.zeros(3), results.body("hammer").origin[middle]], JOINT, 1.0, dashed=True)
    sheet.label(0.5 * results.body("hammer").origin[middle], "displacements,\nrotation vector", 34, -12, JOINT)
    sheet.label([0, 0, 0], "t = 0", -28, -10)
    sheet.room([[-0.3, 0, 0]])
    sheet.triad(DOWN)
    sheet.finish()
    return figure


# Drivers and relations


def driver(results: Results) -> Figure:
    """A bar that is raised, and the torque that it takes."""
    figure, left, right = drawing_and_chart(2.3, (1.0, 1.1))
    sheet = Sheet(left, FRONT)
    instants(
        sheet,
        rows(results, 0, 0.4, 0.5, 0.6, 1.0),
        lambda row: sheet.bar(at(pose(results, "bar", row), [[0, 0, 0.25], [0, 0, -0.25]])),
    )
    sheet.path(0.42 * track(results, "bar", [0, 0, -0.25]), color=JOINT)
    sheet.ground(np.zeros(3))
    sheet.dots(np.zeros(3))
    sheet.label([0.0, 0, -0.46], "t = 0", -24, 0)
    sheet.label(track(results, "bar", [0, 0, -0.25])[-1], "1 s", 4, 12)
    sheet.room([[-0.15, 0, 0.3], [0.55, 0, 0]])
    sheet.finish(fit=False)
    right.plot(results.time, results.joint("motor").torque @ -Y, color=JOINT)
    chart(right, "torque of the motor [N m]", "t [s]")
    return figure


def _wheel(sheet: Sheet, place: Pose, outline: Array, radius: float, color: Color, hub: float) -> None:
    sheet.area(at(place, outline), color)
    sheet.line(at(place, [[hub, 0, 0], [0.8 * radius, 0, 0]]), INK, 2.0)
    sheet.dots(place[0])


def _spokes(sheet: Sheet, results: Results, body: str, radius: float, *times: float) -> None:
    """Where the mark on a wheel is later, pale."""
    for k, row in enumerate(rows(results, *times)):
        sheet.pale_by = (0.35, 0.55, 0.7)[k]
        sheet.line(at(pose(results, body, row), [[0.2 * radius, 0, 0], [0.8 * radius, 0, 0]]), INK, 1.6)
    sheet.pale_by = 0.0


def gear(results: Results) -> Figure:
    """Two wheels; marks on them show the ratio."""
    figure, sheet = only(FRONT)
    for body, radius, teeth, color in (("pinion", 0.05, 16, STEEL), ("wheel", 0.1, 32, SAND)):
        turn = np.pi / teeth if body == "wheel" else 0.0
        c, s = np.cos(turn), np.sin(turn)
        outline = gear_wheel(radius, teeth) @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]).T
        _wheel(sheet, pose(results, body, 0), outline, radius, color, 0.008)
        _spokes(sheet, results, body, radius, 0.15, 0.2, 0.25)
    for place, radius, sense in (([0, 0, 0], 0.062, 1.0), ([0.15, 0, 0], 0.113, -1.0)):
        # right-handed about y: from x towards −z
        a = np.radians(np.linspace(150, 95, 20) if sense > 0 else np.linspace(30, 60, 20))
        sheet.path(np.asarray(place) + radius * np.column_stack([np.cos(a), 0 * a, np.sin(a)]), color=JOINT)
    sheet.label([0, 0, 0], "shaft", 0, -14, JOINT)
    sheet.label([0.15, 0, 0], "output = −½ shaft", 0, -16, JOINT)
    sheet.finish()
    return figure


def planetary(results: Results) -> Figure:
    """Sun, planet, ring and carrier, and the path of a mark on the planet."""
    figure, sheet = only(FRONT)
    rim = circle([0, 0, 0], Y, 0.122)
    sheet.area(rim, "#e4e0d4")
    sheet.area(gear_wheel(0.1, 40, inside=True), "#ffffff")
    turn = np.pi / 12  # of the planet, which has a gap where the sun has a tooth
    c, s = np.cos(turn), np.sin(turn)
    outline = gear_wheel(0.03, 12) @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]).T
    mark = [0.024, 0, 0]
    sheet.path(track(results, "planet_wheel", mark))
    chosen = rows(results, 0.0, 1.0)

    def draw(row: int) -> None:
        sheet.area(at(pose(results, "planet_wheel", row), outline), STEEL)
        sheet.line(at(pose(results, "planet_wheel", row), [[0.006, 0, 0], mark]), INK, 1.8)

    instants(sheet, chosen, draw)
    sheet.area(at(pose(results, "sun_wheel", 0), gear_wheel(0.04, 16)), SAND)
    for row in reversed(chosen):
        sheet.pale_by = 0.5 if row else 0.0
        sheet.line(at(pose(results, "sun_wheel", row), [[0.006, 0, 0], [0.032, 0, 0]]), INK, 1.8)
        sheet.bar([np.zeros(3), results.body("planet_wheel").origin[row]], GREEN, 5.0)
    sheet.dots([np.zeros(3), results.body("planet_wheel").origin[0]])
    for text, start, end in (
        ("ring, fixed", [0.08, 0, 0.08], [0.16, 0, 0.09]),
        ("planet", [0.085, 0, 0.012], [0.16, 0, 0.03]),
        ("carrier", [0.035, 0, 0], [0.16, 0, -0.03]),
        ("sun", [-0.02, 0, 0.02], [-0.16, 0, 0.06]),
    ):
        sheet.line([start, end], INK, 0.6)
        sheet.label(end, text, 24 if end[0] > 0 else -14, 0)
    sheet.room([[0.2, 0, 0], [-0.2, 0, 0]])
    sheet.finish()
    return figure


def rack(results: Results) -> Figure:
    """Pinion and rack."""
    figure, sheet = only(FRONT)
    radius, teeth = 0.05, 20
    pitch = 2 * np.pi * radius / teeth
    outline = gear_wheel(radius, teeth)
    c, s = np.cos(np.pi / 2), np.sin(np.pi / 2)  # a tooth upwards, into the bar's gap
    outline = outline @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]).T
    x = np.arange(-8, 8)[:, None] * pitch + pitch * np.array([0.18, 0.36, 0.64, 0.82])
    z = np.tile(np.array([0.34, -0.28, -0.28, 0.34]) * pitch, 16)
    bar = np.column_stack([x.ravel(), 0 * z, z])
    bar = np.vstack([bar, [bar[-1, 0], 0, 0.03], [bar[0, 0], 0, 0.03]]) + [0.05, 0, 0]
    chosen = rows(results, 0.0, 1.0)
    instants(sheet, chosen, lambda row: sheet.area(at(pose(results, "bar", row), bar), SAND))
    _wheel(sheet, pose(results, "pinion", 0), outline, radius, STEEL, 0.008)
    _spokes(sheet, results, "pinion", radius, 0.5, 1.0)
    a = np.radians(np.linspace(250, 175, 30))
    sheet.path(0.065 * np.column_stack([np.cos(a), 0 * a, np.sin(a)]), color=JOINT)
    sheet.path([[-0.02, 0, 0.095], [0.08, 0, 0.095]], color=JOINT)
    sheet.label([0.03, 0, 0.095], "radius · angle", 0, 9, JOINT)
    sheet.label([0, 0, 0], "shaft", -4, 14, JOINT)
    sheet.room([[0, 0, 0.105]])
    sheet.finish()
    return figure


def belt(results: Results) -> Figure:
    """Two pulleys."""
    figure, sheet = only(FRONT)
    distance, a, b = 0.3, 0.05, 0.1
    tilt = np.arcsin((b - a) / distance)  # of the free parts
    lines = [
        np.array(
            [[-a * np.sin(tilt), 0, side * a * np.cos(tilt)], [distance - b * np.sin(tilt), 0, side * b * np.cos(tilt)]]
        )
        for side in (1, -1)
    ]
    for body, radius, color in (("small", a, STEEL), ("large", b, SAND)):
        _wheel(sheet, pose(results, body, 0), circle([0, 0, 0], Y, radius), radius, color, 0.008)
        _spokes(sheet, results, body, radius, 0.1, 0.15, 0.2)
    around = np.linspace(0.5 * np.pi + tilt, 1.5 * np.pi - tilt, 40)
    beyond = np.linspace(0.5 * np.pi + tilt, -0.5 * np.pi - tilt, 40)
    for centre, radius, angles in (([0, 0, 0], a, around), ([distance, 0, 0], b, beyond)):
        sheet.line(
            np.asarray(centre) + radius * np.column_stack([np.cos(angles), 0 * angles, np.sin(angles)]), JOINT, 2.4
        )
    for line in lines:
        sheet.line(line, JOINT, 2.4)
    sheet.path([[0.09, 0, 0.085], [0.19, 0, 0.1]], color=JOINT)
    sheet.label([0, 0, 0], "shaft", 0, -13, JOINT)
    sheet.label([distance, 0, 0], "output = ½ shaft", 0, -16, JOINT)
    sheet.room([[0.0, 0, 0.11]])
    sheet.finish()
    return figure


def coupler(results: Results) -> Figure:
    """Steered wheels, whose axles meet on that of the rear wheels."""
    figure, sheet = only(ABOVE)
    row = len(results.time) - 1
    tyre = np.array([[-0.3, -0.09, 0], [0.3, -0.09, 0], [0.3, 0.09, 0], [-0.3, 0.09, 0]])
    left, right = (pose(results, name, row) for name in ("left", "right"))
    # both wheels' axles meet on the line of the rear axle
    reach = left[0][0] / left[1][0, 1]
    centre = left[0] - reach * left[1][:, 1]
    sheet.area([[-0.5, -0.45, 0], [2.7, -0.45, 0], [2.7, 0.45, 0], [-0.5, 0.45, 0]], "#f1f4f6", FAINT)
    for x in (0.0, 2.2):
        sheet.line([[x, -0.6, 0], [x, 0.6, 0]], INK, 1.6)
    for y in (-0.6, 0.6):
        sheet.area(tyre + [0, y, 0], "#b9c2ca")

    def draw(k: int) -> None:
        for body in ("left", "right"):
            sheet.area(at(pose(results, body, k), tyre), STEEL)

    instants(sheet, rows(results, 1.0, 0.5, 0.0), draw)
    for place in (left[0], right[0], np.zeros(3)):
        sheet.line([place, centre], JOINT, 0.9, dashed=True)
    sheet.dots([left[0], right[0]])
    sheet.dots(centre, JOINT, 16, True)
    sheet.label(left[0], "l = 40°", 40, 0, JOINT)
    angle = np.degrees(results.joint("r").coordinate[row, 0])
    sheet.label(right[0], f"r = {angle:.1f}°", 42, 0, JOINT)
    sheet.label(centre, "centre of the turn", 42, 10, JOINT)
    sheet.finish()
    return figure


# Rods, curves, surfaces, cams


def distance(results: Results) -> Figure:
    """A load on a rope that gets shorter."""
    figure, sheet = only(FRONT)
    path = results.body("load").origin
    sheet.path(path)

    def draw(row: int) -> None:
        sheet.line([[0, 0, 0], path[row]], JOINT, 1.6)
        sheet.area(path[row] + [[-0.12, 0, -0.2], [0.12, 0, -0.2], [0.12, 0, 0], [-0.12, 0, 0]], STEEL)

    instants(sheet, rows(results, 0, 1.25, 2.3, 3.5), draw)
    sheet.ground(np.zeros(3))
    sheet.dots(np.zeros(3))
    sheet.label(path[0], "t = 0", 30, -8)
    sheet.label(path[-1], f"{results.time[-1]:.1f} s", -34, -8)
    sheet.label([0.95, 0, -1.27], "rope", 22, 0, JOINT)
    sheet.room([[1.65, 0, 0], [-1.2, 0, 0.05]])
    sheet.triad(DOWN)
    sheet.finish()
    return figure


def point_on_curve(results: Results) -> Figure:
    """A bead at equal intervals of time."""
    figure, sheet = only(FRONT)
    sheet.line(results.joint("wire").outline.first, JOINT, 1.8)
    times = np.arange(0.0, results.time[-1] + 1e-9, 0.1)
    for k, row in enumerate(rows(results, *times)):
        sheet.pale_by = 0.0 if k == 0 else 0.55
        sheet.ball(results.body("bead").origin[row], 0.022, STEEL)
    sheet.pale_by = 0.0
    sheet.label(results.body("bead").origin[0], "t = 0", 26, 4)
    sheet.label(results.body("bead").origin[rows(results, 0.5)[0]], "0.5 s", 2, 14)
    sheet.label(results.body("bead").origin[rows(results, 1.0)[0]], "1 s", -16, 8)
    sheet.label([0.5, 0, 0.2], "wire", 0, -16, JOINT)
    sheet.room([[1.8, 0, 0.6]])
    sheet.triad(DOWN)
    sheet.finish()
    return figure


def point_on_surface(results: Results) -> Figure:
    """A ball's path in a bowl."""
    figure, sheet = only(axonometric(elevation=32.0))
    top = 0.55
    for radius in np.linspace(0.11, top, 5):
        sheet.circle([0, 0, radius**2], Z, float(radius), "#d9b3ae", 0.8)
    for angle in np.arange(0, 360, 20):
        s = np.linspace(0, top, 20)
        c, d = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        sheet.line(np.column_stack([s * c, s * d, s**2]), "#d9b3ae", 0.8)
    sheet.circle([0, 0, top**2], Z, top, JOINT, 1.4)
    path = results.body("ball").origin
    sheet.path(path)
    instants(sheet, rows(results, 0, 0.5, 1.0), lambda row: sheet.ball(path[row], 0.025, STEEL))
    sheet.label(path[0], "t = 0", 26, 0)
    sheet.triad(DOWN)
    sheet.finish()
    return figure


def cam(results: Results) -> Figure:
    """One cam at three angles, with three followers."""
    figure = new_figure(1.7)
    profile = results.joint("rolls").outline.first
    for axes, row in zip(figure.subplots(1, 3), rows(results, 0.0, 1 / 6, 5 / 12), strict=True):
        sheet = Sheet(axes, FRONT)
        sheet.area(at(pose(results, "cam", row), profile), STEEL)
        sheet.line(at(pose(results, "cam", row), [[0.006, 0, 0], [0.036, 0, 0]]), INK, 1.6)
        right, top, left = (results.body(name).origin[row] for name in ("right", "top", "left"))
        sheet.bar([right, [0.085, 0, 0]], SAND, 4.5)
        sheet.area(circle(right, Y, 0.01), SAND, JOINT)
        sheet.bar([top + [0, 0, 0.014], [0, 0, 0.076]], GREEN, 4.5)
        sheet.area([top, top + [0.006, 0, 0.016], top + [-0.006, 0, 0.016]], GREEN, JOINT)
        sheet.bar([left, [-0.066, 0, 0]], VIOLET, 4.5)
        sheet.line([left + [0, 0, 0.028], left - [0, 0, 0.028]], JOINT, 2.6)
        sheet.dots(np.zeros(3))
        sheet.room([[-0.068, 0, -0.052], [0.088, 0, 0.078]])
        sheet.finish(0.01, fit=False)
        angle = np.degrees(results.joint("bearing").coordinate[row, 0])
        axes.set_title(f"{angle:.0f}°", fontweight="normal", fontsize=8.5, loc="center")
    return figure


# Contacts


def rolling_disc(results: Results) -> Figure:
    """A disc and the path of its contact."""
    figure, sheet = only(axonometric(-60, 35))
    body, radius = results.body("disc"), 0.1
    axis = body.rotation[:, :, 1]
    low = -(Z - axis[:, 2:] * axis) / np.sqrt(1 - axis[:, 2:] ** 2)
    contact = body.origin + radius * low
    reach = [contact[:, :2].min(axis=0) - 0.12, contact[:, :2].max(axis=0) + 0.12]
    (a, b), (c, d) = reach
    sheet.area([[a, b, 0], [c, b, 0], [c, d, 0], [a, d, 0]], "#f1f4f6", FAINT)
    sheet.path(contact)

    def draw(row: int) -> None:
        place = pose(results, "disc", row)
        sheet.area(circle(place[0], axis[row], radius), STEEL)
        sheet.line(at(place, [[-0.08, -0.005, 0], [0.08, -0.005, 0]]), INK, 1.6)

    instants(sheet, rows(results, 0.0, 0.4, 0.9, 1.4, 1.9), draw)
    sheet.dots(contact[:1], JOINT, 12, True)
    sheet.label(contact[0], "contact", -26, -6, JOINT)
    sheet.triad()
    sheet.finish()
    return figure


def rolling_sphere(results: Results) -> Figure:
    """A ball's circle on a turntable."""
    figure, sheet = only(axonometric(-60, 38))
    path = results.body("ball").origin
    sheet.cylinder([0, 0, -0.01], Z, 0.62, 0.02, "#e6ebef")
    a = np.radians(np.linspace(-75, -25, 30))
    sheet.path(0.55 * np.column_stack([np.cos(a), np.sin(a), 0 * a]), color=JOINT)
    sheet.path(path * [1, 1, 0])
    instants(sheet, rows(results, 0.0, 0.6, 1.2, 1.8), lambda row: sheet.ball(path[row], 0.05, SAND))
    sheet.label(path[0], "t = 0", 30, 4)
    sheet.label([0.36, -0.42, 0], "6 rad/s", 0, 14, JOINT)
    sheet.triad()
    sheet.finish()
    return figure


def knife_edge(results: Results) -> Figure:
    """A skate's cycloid."""
    figure, sheet = only(SIDEWAYS)
    path = results.body("skate").origin
    sheet.path(path)
    for row in rows(results, *np.arange(0.0, results.time[-1] + 1e-9, 0.25)):
        place = pose(results, "skate", row)
        sheet.line(at(place, [[-0.02, 0, 0], [0.02, 0, 0]]), JOINT, 2.6)
    sheet.dots(path[:1], INK, 10, True)
    sheet.label(path[0], "t = 0", -18, 8)
    sheet.arrow([[-0.04, 0.47, 0], [0.03, 0.47, 0]])
    sheet.label([-0.005, 0.47, 0], "downhill", 26, 0)
    sheet.room([[-0.06, -0.05, 0], [0.08, 0.56, 0]])
    sheet.finish()
    return figure


def pfaffian(results: Results) -> Figure:
    """Dog and hare."""
    figure, sheet = only(SIDEWAYS)
    hare, dog = (results.body(name).origin for name in ("hare", "dog"))
    for row in rows(results, *np.arange(0.0, 5.01, 0.5)):
        sheet.line([dog[row], hare[row]], FAINT, 0.8, dashed=True)
    sheet.path(hare, color=COLORS[1])
    sheet.path(dog)
    for row in rows(results, *np.arange(0.0, 5.01, 0.5)):
        sheet.dots([hare[row]], COLORS[1], 12, True)
        sheet.dots([dog[row]], PATH, 12, True)
    sheet.label(hare[0], "hare", -20, 0, COLORS[1])
    sheet.label(dog[0], "dog", -18, 0, PATH)
    sheet.room([[-10, -1.6, 0], [0.4, 0, 0]])
    sheet.finish()
    return figure


PICTURES: dict[str, Callable[[Results], Figure]] = {
    function.__name__.replace("_", "-"): function
    for function in (
        revolute, prismatic, cylindrical, screw, spherical, planar, universal, constant_velocity, weld, free,
        driver, gear, planetary, rack, belt, coupler,
        distance, point_on_curve, point_on_surface, cam,
        rolling_disc, rolling_sphere, knife_edge, pfaffian,
    )
}  # fmt: skip


def main(names: list[str]) -> None:
    """Draw the pictures of the named joints, or of all."""
    folder = DOCS / "pictures" / "joints"
    folder.mkdir(parents=True, exist_ok=True)
    for name in names or PICTURES:
        results = maggi.run(maggi.load(DOCS / "joints" / f"{name}.yml"))
        with style():
            path = folder / f"{name}.png"
            save(PICTURES[name](results), path)
        print(f"{path.relative_to(DOCS)}: {path.stat().st_size / 1024:.0f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
