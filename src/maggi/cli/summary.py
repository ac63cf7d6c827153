"""What `maggi run` tells after a run: how well it went, and the extremes."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from maggi.results.extremes import Extreme, deflection_extremes, joint_extremes
from maggi.results.read import read

if TYPE_CHECKING:
    from maggi.analyses.transient import RunSummary
    from maggi.results.results import Results

_PLAIN_WIDTH = 110
_NOISE = 1e-6  # relative to the largest force or torque of all joints: nothing to tell below it
_MOST_BYTES = 2 << 30  # of nodal displacements looked at for the extremes


def print_summary(path: Path, summary: RunSummary) -> None:
    """Print the tables on standard output."""
    console = Console(file=sys.stdout, width=None if sys.stdout.isatty() else _PLAIN_WIDTH, highlight=False)
    with read(path) as results:
        rows = len(results.time)
        console.print(_quality(summary))
        joints = _joints(results)
        if joints.row_count:
            console.print(joints)
        step = _step(results)
        deflections = _deflections(results, step)
        if deflections.row_count:
            console.print(deflections)
            if step > 1:
                console.print(f"(deflections: of every {step}th row)", style="dim")
    size = path.stat().st_size / 1e6
    console.print(Text(f"{path}: {rows:,} rows, {size:,.1f} MB; pictures: maggi plot {path}"))


def _quality(summary: RunSummary) -> Table:
    table = _table("Run", ("", ""))
    position, velocity, acceleration = (f"{float(value):.1e}" for value in summary.residuals)
    per_step = summary.back_substitutions / max(1, summary.steps)
    slowest = sorted(summary.timings.items(), key=lambda item: -item[1])[:4]
    spent = ", ".join(f"{name} {seconds:.1f} s" for name, seconds in slowest if seconds >= 0.05)
    restarts = f" ({summary.restarts:,} times with a smaller step)" if summary.restarts else ""
    table.add_row("steps", f"{summary.steps:,}{restarts}")
    table.add_row("back-substitutions per step", f"{per_step:.2f}")
    table.add_row(
        "largest residuals (scaled)", f"position {position}, velocity {velocity}, acceleration {acceleration}"
    )
    table.add_row("energy balance (of the energy exchanged)", f"{summary.energy_balance:.1e}")
    table.add_row("energy taken by the method", f"{summary.numerical_loss:.2e} J")
    table.add_row("time", f"{summary.seconds:.1f} s" + (f" ({spent})" if spent else ""))
    table.show_header = False
    return table


def _joints(results: Results) -> Table:
    heads = ("joint", "largest force [N]", "at t [s]", "components x, y, z [N]", "largest torque [N m]", "at t [s]")
    table = _table("Extreme joint forces and torques", heads)
    extremes = joint_extremes(results)
    noise_force = _NOISE * max((joint.force.magnitude for joint in extremes), default=0.0)
    noise_torque = _NOISE * max((joint.torque.magnitude for joint in extremes), default=0.0)
    for joint in extremes:
        force, torque = _extreme(joint.force, noise_force), _extreme(joint.torque, noise_torque)
        components = _components(joint.force) if force[1] else ""
        table.add_row(Text(joint.name), *force, components, *torque)
    return table


def _extreme(extreme: Extreme, noise: float) -> tuple[str, str]:
    """Value and time; what is round-off compared with the other joints has no time worth telling."""
    if extreme.magnitude <= noise:
        return ("0" if extreme.magnitude == 0.0 else "≈ 0"), ""
    return f"{extreme.magnitude:.5g}", f"{extreme.time:.5g}"


def _components(extreme: Extreme) -> str:
    """Components with the decimals that make sense beside the magnitude."""
    decimals = max(0, 4 - math.floor(math.log10(extreme.magnitude)))
    return ", ".join(f"{value:.{decimals}f}" for value in extreme.components)


def _deflections(results: Results, step: int) -> Table:
    heads = ("body", "largest displacement [mm]", "at t [s]", "largest deflection [mm]", "at t [s]", "from the line")
    table = _table("Extreme elastic deflections", heads)
    for body in deflection_extremes(results, step):
        bent = ("", "", "")
        if body.deflection is not None and body.deflection_time is not None and body.ends is not None:
            bent = (f"{1e3 * body.deflection:.5g}", f"{body.deflection_time:.5g}", " – ".join(body.ends))
        table.add_row(
            Text(body.body), f"{1e3 * body.displacement:.5g}", f"{body.displacement_time:.5g}", *map(Text, bent)
        )
    return table


def _table(title: str, heads: Sequence[str]) -> Table:
    table = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for i, head in enumerate(heads):
        table.add_column(Text(head), justify="left" if i == 0 or heads[0] == "" else "right")
    return table


def _step(results: Results) -> int:
    """Every how many rows the displacements are looked at, so that it takes seconds whatever the file's size."""
    paths = [f"bodies/{name}/displacement" for name in results.bodies]
    shapes = [results.frames(path).shape for path in paths if results.has(path)]
    total = sum(8 * shape[0] * shape[1] * shape[2] for shape in shapes)
    return max(1, -(-total // _MOST_BYTES))
