"""`maggi check`: read and assemble a model, and say what it is."""

from __future__ import annotations

import click

from maggi.model.errors import ModelError

from . import options
from .outcome import Outcome, Status
from .start import started


@click.command()
@options.model
@options.overrides
@options.as_json
@click.option(
    "--formulations",
    is_flag=True,
    help="Also compute accelerations and joint forces at t = 0 by Lagrange, Gibbs–Appell, Kane and Newton–Euler, "
    "and compare them with Maggi's; exit status 1 where they disagree.",
)
@click.pass_context
def check(ctx: click.Context, model: str, overrides: tuple[str, ...], as_json: bool, formulations: bool) -> None:
    """Check MODEL without running it: freedoms, masses, node sets, liaisons and their rank.

    What stands against a run is told last, and makes the exit status 2.
    """
    from maggi.modelfile import read

    described, source = read(model, overrides)
    from maggi.analyses.audit import audit

    started()
    try:
        found = audit(described)
    except ModelError as error:
        raise (source.locate(error) if error.path else error) from error
    problems = [*found.problems]
    more, text = {"model": found.data()}, [found.text()]
    disagreement: list[ModelError] = []
    if formulations and not problems:
        from maggi.analyses.compare_formulations import compare_formulations

        try:
            comparison = compare_formulations(described)
        except ModelError as error:
            problems.append(error)
        else:
            if not comparison.agree:
                remedy = "this is a mistake in maggi: please report it with the model"
                disagreement.append(ModelError("the formulations disagree", remedy=remedy))
            more["formulations"] = comparison.data()
            text.append(comparison.text())
    status: Status = "error" if problems else "failed" if disagreement else "complete"
    errors = (*(source.locate(problem) for problem in problems), *disagreement)
    outcome = Outcome(status, errors=errors, more=more)
    if as_json:
        outcome.print_json()
    else:
        click.echo("\n\n".join(text))
    outcome.print_errors()
    ctx.exit(outcome.exit_code)
