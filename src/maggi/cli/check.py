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
def check(model: str, overrides: tuple[str, ...], as_json: bool) -> None:
    """Check MODEL without running it: freedoms, masses, node sets, liaisons and their rank."""
    from maggi.modelfile import read

    described, source = read(model, overrides)
    from maggi.analyses.audit import audit

    try:
        found = audit(described)
    except ModelError as error:
        raise (source.locate(error) if error.path else error) from error
    if as_json:
        Outcome("complete", more={"model": found.data()}).print_json()
    else:
        click.echo(found.text())
