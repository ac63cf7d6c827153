"""All pictures of a run, or of a model before any run, as PNG files."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType

from matplotlib.figure import Figure

from maggi.analyses.scene import Scene
from maggi.model.errors import ModelError
from maggi.results.results import Results

from .deflection import deflection_figure
from .energy import energy_figure
from .joints import joints_figure
from .mechanism import mechanism_figure
from .motion import motion_figure
from .residuals import residuals_figure
from .scene import scene_figure
from .style import save, style

FIGURES: Mapping[str, Callable[[Results], Figure | None]] = MappingProxyType(
    {
        "mechanism": mechanism_figure,
        "joints": joints_figure,
        "motion": motion_figure,
        "deflection": deflection_figure,
        "energy": energy_figure,
        "residuals": residuals_figure,
    }
)


def plot_results(results: Results, folder: str | Path, stem: str) -> list[Path]:
    """Write ``<stem>_mechanism.png``, ``_joints``, ``_motion``, ``_deflection``, ``_energy`` and ``_residuals``.

    Pictures of what was not kept are left out.

    Returns
    -------
    The files written.

    Raises
    ------
    ModelError : there is nothing to draw, or the folder cannot be written to.
    """
    if not len(results.time):
        raise ModelError(f"{results.name} holds no rows: there is nothing to draw")
    written: list[Path] = []
    with style(), _writing(folder):
        for name, make in FIGURES.items():
            figure = make(results)
            if figure is not None:
                written.append(save(figure, Path(folder) / f"{stem}_{name}.png"))
    return written


def plot_scene(scene: Scene, folder: str | Path, stem: str) -> list[Path]:
    """Write ``<stem>_model.png``, the mechanism as it stands before a run.

    Raises
    ------
    ModelError : the folder cannot be written to.
    """
    with style(), _writing(folder):
        return [save(scene_figure(scene), Path(folder) / f"{stem}_model.png")]


@contextmanager
def _writing(folder: str | Path) -> Iterator[None]:
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
        yield
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise ModelError(f"cannot write to {folder}: {reason}", remedy="choose another folder with -o") from error
