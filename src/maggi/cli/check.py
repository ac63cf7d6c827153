"""`maggi check`: read and assemble a model, and say what it is."""

from __future__ import annotations

import click

from maggi.model.errors import ModelError

from . import options
from .outcome import Outcome


@click.command()
@options.model
@options.overrides
@options.as_json
@click.pass_context
def check(ctx: click.Context, model: str, overrides: tuple[str, ...], as_json: bool) -> None:
    """Check MODEL without running it: freedoms, masses, node sets, liaisons and their rank.

    What stands against a run is told last, and makes the exit status 2.
    """
    from maggi.modelfile import read

    described, source = read(model, overrides)
    from maggi.analyses.audit import audit

    try:
        found = audit(described)
    except ModelError as error:
        raise (source.locate(error) if error.path else error) from error
    problems = tuple(source.locate(problem) for problem in found.problems)
    outcome = Outcome("error" if problems else "complete", errors=problems, more={"model": found.data()})
    if as_json:
        outcome.print_json()
    else:
        click.echo(found.text())
    outcome.print_errors()
    ctx.exit(outcome.exit_code)
