"""Energies and their balance over time."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from maggi.results.contract import ENERGIES
from maggi.results.results import Array, Results

from .charts import draw_lines, stacked

_SMALL = 0.05  # an energy below this part of the largest gets a chart of its own


def energy_figure(results: Results) -> Figure | None:
    """All energies, the small ones once more on their own scale, and the balance; None if they were not kept."""
    if not (len(results.time) and results.has("energy/kinetic")):
        return None
    energies = {name: results.series(f"energy/{name}") for name in ENERGIES}
    energies = {name: values for name, values in energies.items() if np.abs(values).max() > 0.0} or energies
    balance = results.energy.balance
    charts: list[tuple[dict[str, Array], float, str]] = [(energies, 2.2, "Energies")]
    small = _small(energies)
    while small:
        charts.append((small, 1.4, f"{', '.join(small)} alone".capitalize()))
        small = _small(small)
    exchanged = max(float(np.ptp(values)) for values in energies.values())
    part = f", at most {np.abs(balance).max() / exchanged:.1e} of the energy exchanged" if exchanged else ""
    order = (*energies, "balance")
    charts.append(({"balance": balance}, 1.2, f"Balance: kinetic + strain + gravity + dissipated − work{part}"))
    figure, panels = stacked(results, [height for _, height, _ in charts], "energy")
    for axes, (lines, _, title) in zip(panels, charts, strict=True):
        draw_lines(axes, results, lines, "J", "energy", order)
        axes.set_title(title)
    return figure


def _small(energies: dict[str, Array]) -> dict[str, Array]:
    """Those that the scale of the largest hides."""
    largest = max(float(np.abs(values).max()) for values in energies.values())
    return {name: values for name, values in energies.items() if np.abs(values).max() < _SMALL * largest}
