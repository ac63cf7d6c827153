"""Joint forces and torques over time."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from maggi.results.contract import AXES
from maggi.results.results import Array, Results

from .charts import draw_lines, stacked

MOST_JOINTS = 6
COMPONENTS = tuple(f"F{axis}" for axis in AXES)
_NOTHING = 1e-6  # relative to the largest of its kind: below this a joint carries none of it


def joints_figure(results: Results) -> Figure | None:
    """Force magnitudes together, the components of the most loaded joints, and all torques; None without joints.

    A torque is shown by its main component, with its sign: a driver's is about its axis.
    """
    names = [name for name in results.joints if results.has(f"joints/{name}/force")]
    if not names or not len(results.time):
        return None
    forces = {name: results.joint(name).force for name in names}
    torques = {name: results.joint(name).torque for name in names}
    largest_force, largest_torque = _largest(forces), _largest(torques)
    loaded = sorted(largest_force, key=lambda name: -largest_force[name])[:MOST_JOINTS]
    loaded = [name for name in names if name in loaded]  # the model's order

    charts: list[tuple[dict[str, Array], str, str, str]] = []
    if loaded:
        magnitudes = {name: np.linalg.norm(forces[name], axis=1) for name in loaded}
        left_out = len(largest_force) - len(loaded)
        title = "Joint forces, magnitude" + (
            f" (the {MOST_JOINTS} largest of {len(largest_force)})" if left_out else ""
        )
        charts.append((magnitudes, "N", "|F|", title))
    for name in loaded:
        parts = {part: forces[name][:, i] for i, part in enumerate(COMPONENTS)}
        parts = {
            part: values for part, values in parts.items() if np.abs(values).max() > _NOTHING * largest_force[name]
        }
        only = next(iter(parts)) if len(parts) == 1 else "global components"
        charts.append((parts, "N", "F", f"{name}, {only}"))
    turning = sorted(largest_torque, key=lambda name: -largest_torque[name])[:MOST_JOINTS]
    if turning:
        lines = dict(_main_component(name, torques[name]) for name in names if name in turning)
        title = "Torques of joints and drivers, main component"
        charts.append((lines, "N m", "torque", title if len(lines) > 1 else f"Torque of {next(iter(lines))}"))
    if not charts:
        charts.append(({name: np.linalg.norm(forces[name], axis=1) for name in names}, "N", "|F|", "Joint forces"))

    heights = [2.1 if i == 0 or unit == "N m" else 1.25 for i, (_, unit, _, _) in enumerate(charts)]
    figure, panels = stacked(results, heights, "joint forces and torques")
    for axes, (lines, unit, what, title) in zip(panels, charts, strict=True):
        draw_lines(axes, results, lines, unit, what, COMPONENTS if set(lines) <= set(COMPONENTS) else ())
        axes.set_title(title)
    return figure


def _largest(vectors: dict[str, Array]) -> dict[str, float]:
    """Largest magnitude by name, of those that carry anything."""
    sizes = {name: float(np.linalg.norm(values, axis=1).max()) for name, values in vectors.items()}
    limit = _NOTHING * max(sizes.values(), default=0.0)
    return {name: size for name, size in sizes.items() if size > limit}


def _main_component(name: str, torque: Array) -> tuple[str, Array]:
    k = int(np.argmax(np.abs(torque).max(axis=0)))
    return f"{name}, T{AXES[k]}", torque[:, k]
