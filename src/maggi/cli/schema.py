"""`maggi schema`: the model file's JSON Schema, for editors."""

from __future__ import annotations

import json

import click


@click.command()
def schema() -> None:
    """Print the JSON Schema of model files, with which editors check and complete them."""
    from maggi.modelfile import json_schema

    click.echo(json.dumps(json_schema(), indent=2, ensure_ascii=False))
