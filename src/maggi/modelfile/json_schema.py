"""JSON Schema of the model file, for editors that check and complete YAML."""

from __future__ import annotations

from typing import Any

from .schema.document import Document


def json_schema() -> dict[str, Any]:
    """The schema (draft 2020-12) as a mapping that can be written with `json.dumps`."""
    schema = Document.model_json_schema(mode="validation")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "maggi model file"}
