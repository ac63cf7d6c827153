"""`maggi export`: results as tables for other programs."""

from __future__ import annotations

from pathlib import Path

import click

from . import options
from .outcome import Outcome


@click.command()
@click.argument("file", type=click.Path())
@click.option("--csv", is_flag=True, help="Comma-separated tables, one for each group of quantities.")
@click.option("-o", "--output", type=click.Path(), help="Folder for the tables; by default that of FILE.")
@options.as_json
@click.pass_context
def export(ctx: click.Context, file: str, csv: bool, output: str | None, as_json: bool) -> None:
    """Write the results in FILE as tables.

    The first line of a table names its columns with their units. Nodal displacements stay in FILE.
    """
    from maggi.results.export import export_csv
    from maggi.results.read import read

    if not csv:
        raise click.UsageError("say which format: --csv", ctx)
    path = Path(file)
    with read(path) as results:
        written = export_csv(results, Path(output) if output else path.parent, path.stem)
    if as_json:
        Outcome("complete", file, more={"files": [str(one) for one in written]}).print_json()
    else:
        for one in written:
            click.echo(str(one))
