"""`maggi plot`: pictures of a run, or of a model before any run."""

from __future__ import annotations

from pathlib import Path

import click

from maggi.model.errors import ModelError

from . import options
from .outcome import Outcome
from .start import started


@click.command()
@click.argument("file", type=click.Path())
@click.option(
    "-o", "--output", type=click.Path(), help="Folder for the pictures; by default that of a result file, or this one."
)
@options.overrides
@options.as_json
def plot(file: str, output: str | None, overrides: tuple[str, ...], as_json: bool) -> None:
    """Draw the results in FILE, or the mechanism of a model file as it stands before a run.

    Writes PNG files: mechanism, joints, motion, deflection, energy and residuals of a run; model for a model.
    """
    path = Path(file)
    if _is_result_file(path):
        if overrides:
            raise ModelError("--set is for model files", remedy=f"{file} is a result file: leave --set out")
        written = _plot_results(path, Path(output) if output else path.parent)
    else:
        written = _plot_model(file, overrides, Path(output or "."))
    if as_json:
        Outcome("complete", file, more={"files": [str(one) for one in written]}).print_json()
    else:
        for one in written:
            click.echo(str(one))


def _is_result_file(path: Path) -> bool:
    """By what is in it, not by its name; a missing .h5 file is meant to be one."""
    if not path.is_file():
        return path.suffix.lower() in (".h5", ".hdf5")
    with path.open("rb") as file:
        return file.read(4) == b"\x89HDF"


def _plot_results(path: Path, folder: Path) -> list[Path]:
    from maggi.results.read import read
    from maggi.view.plots import plot_results

    started()
    with read(path) as results:
        return plot_results(results, folder, path.stem)


def _plot_model(file: str, overrides: tuple[str, ...], folder: Path) -> list[Path]:
    from maggi.modelfile import read

    described, source = read(file, overrides)
    from maggi.analyses.build_scene import build_scene
    from maggi.view.plots import plot_scene

    started()
    try:
        drawn = build_scene(described)
    except ModelError as error:
        raise (source.locate(error) if error.path else error) from error
    return plot_scene(drawn, folder, Path(file).stem)
