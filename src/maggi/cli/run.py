"""`maggi run`: simulate a model."""

from __future__ import annotations

from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from maggi.model.errors import ModelError, SimulationError

from . import options
from .outcome import Outcome, Status, failure
from .progress import Display, display
from .start import started

if TYPE_CHECKING:
    from maggi.analyses.transient import RunSummary
    from maggi.results.store import FileRecorder


@click.command()
@options.model
@click.option(
    "-o", "--output", type=click.Path(), help="Result file; by default MODEL's name with .h5, in this folder."
)
@options.overrides
@options.as_json
@click.option("-q", "--quiet", is_flag=True, help="Show neither progress nor summary, only errors.")
@click.pass_context
def run(
    ctx: click.Context, model: str, output: str | None, overrides: tuple[str, ...], as_json: bool, quiet: bool
) -> None:
    """Simulate MODEL and write a result file.

    What was computed is kept, also when the run fails or is interrupted.
    """
    path = Path(output) if output else Path(f"{Path(model).stem}.h5")
    with display(quiet or as_json) as progress:
        outcome, summary = simulate(model, path, overrides, progress)
    if as_json:
        outcome.print_json()
    outcome.print_errors()
    if summary is not None:
        for warning in summary.warnings:
            click.echo(f"warning: {warning}", err=True)
        if not (quiet or as_json):
            from .summary import print_summary

            print_summary(path, summary)
    ctx.exit(outcome.exit_code)


def simulate(
    model: str, path: Path, overrides: tuple[str, ...], progress: Display
) -> tuple[Outcome, RunSummary | None]:
    """Run a model file into a result file; every way it can end becomes an outcome."""
    from maggi.modelfile import read

    try:
        described, source = read(model, overrides)
        from maggi.stepping import ahead

        ahead.begin()
        from maggi.analyses.transient import run as run_transient
        from maggi.results.store import FileRecorder

        recorder = FileRecorder(path, described.outputs.quantities, described.text)
    except ModelError as error:
        return failure("error", error), None
    started()
    try:
        summary = run_transient(described, recorder, progress)
    except ModelError as error:
        # An error without a place in the model, such as a disk too full, would only be shown at its first line.
        return _ended("error", source.locate(error) if error.path else error, recorder, progress), None
    except SimulationError as error:
        return _ended("failed", ModelError(f"the run failed: {error}"), recorder, progress), None
    except KeyboardInterrupt:
        recorder.end("interrupted")  # if it came at a moment when the run could not do it itself
        return _ended("interrupted", ModelError("interrupted"), recorder, progress), None
    except BaseException as error:
        recorder.end(f"failed: {type(error).__name__}: {error}")  # a bug: whatever there is shall be kept
        raise
    residuals = dict(zip(("position", "velocity", "acceleration"), map(float, summary.residuals), strict=True))
    more = {
        "back_substitutions": summary.back_substitutions,
        "factorisations": summary.factorisations,
        "restarts": summary.restarts,
        "energy_balance": summary.energy_balance,
        "numerical_loss": summary.numerical_loss,
        "seconds": summary.seconds,
        "warnings": list(summary.warnings),
    }
    return Outcome("complete", str(path), summary.steps, summary.iterations, residuals, more=more), summary


def _ended(status: Status, error: ModelError, recorder: FileRecorder, progress: Display) -> Outcome:
    """The outcome of a run that did not reach its end; says what is kept, and where."""
    outcome = failure(status, error)
    if recorder.rows == 0:
        return outcome
    from maggi.results.contract import RESIDUALS
    from maggi.results.read import read

    kept = f"{recorder.path} keeps {recorder.rows:,} rows, up to t = {recorder.last_time:.6g} s"
    first, *others = outcome.errors
    first = copy(first)
    first.remedy = f"{first.remedy}; {kept}" if first.remedy else kept
    with read(recorder.path) as results:
        paths = {name: f"residuals/{name}" for name in RESIDUALS}
        residuals = {name: float(results.series(at).max()) for name, at in paths.items() if results.has(at)}
        iterations = int(results.iterations.sum())
    return replace(
        outcome,
        file=str(recorder.path),
        steps=progress.step,
        iterations=iterations,
        residuals=residuals,
        errors=(first, *others),
    )
