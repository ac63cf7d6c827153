"""The JSON Schema: complete, described, and in agreement with the reader on whole models."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import pytest
from ruamel.yaml import YAML

from maggi.modelfile import json_schema

from .samples import CONTRACT, EVERYTHING, LIBRARY, SIMEON_ROD

SCHEMA = json.loads(json.dumps(json_schema()))


def resolve(schema: dict[str, Any]) -> dict[str, Any]:
    while "$ref" in schema:
        schema = SCHEMA["$defs"][schema["$ref"].removeprefix("#/$defs/")] | {
            k: v for k, v in schema.items() if k != "$ref"
        }
    return schema


TYPES = {"object": dict, "array": list, "string": str, "integer": int, "boolean": bool, "null": type(None)}


def valid(value: Any, schema: dict[str, Any]) -> bool:
    """Validation by the keywords that our schema uses; any other keyword fails the test."""
    schema = resolve(schema)
    known = {"type", "properties", "required", "additionalProperties", "anyOf", "oneOf", "const", "enum", "items"}
    known |= {"prefixItems", "minItems", "maxItems", "minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"}
    known |= {"maxLength", "title", "description", "default", "$schema", "$defs"}
    assert schema.keys() <= known, schema.keys() - known
    kind = schema.get("type")
    if kind == "number":
        if isinstance(value, bool) or not isinstance(value, int | float):
            return False
    elif kind and (not isinstance(value, TYPES[kind]) or (kind == "integer" and isinstance(value, bool))):
        return False
    if "const" in schema and value != schema["const"]:
        return False
    if "enum" in schema and value not in schema["enum"]:
        return False
    if isinstance(value, int | float) and not isinstance(value, bool):
        if value < schema.get("minimum", value) or value > schema.get("maximum", value):
            return False
        if value <= schema.get("exclusiveMinimum", value - 1) or value >= schema.get("exclusiveMaximum", value + 1):
            return False
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            return False
        first = schema.get("prefixItems", [])
        rest = schema.get("items", {})
        if not all(valid(v, first[i] if i < len(first) else rest) for i, v in enumerate(value)):
            return False
    if isinstance(value, dict):
        properties = schema.get("properties", {})
        if schema.get("required", []) != [k for k in schema.get("required", []) if k in value]:
            return False
        more = schema.get("additionalProperties", True)
        for key, part in value.items():
            if key in properties:
                if not valid(part, properties[key]):
                    return False
            elif more is False or (isinstance(more, dict) and not valid(part, more)):
                return False
    if "anyOf" in schema and not any(valid(value, part) for part in schema["anyOf"]):
        return False
    return "oneOf" not in schema or sum(valid(value, part) for part in schema["oneOf"]) == 1


def load(text: str) -> Any:
    return YAML(typ="safe", pure=True).load(text)


@pytest.mark.parametrize(
    "text", [CONTRACT, EVERYTHING, SIMEON_ROD, LIBRARY], ids=["contract", "everything", "ritz", "library"]
)
def test_good_models_are_valid(text: str) -> None:
    assert valid(load(text), SCHEMA)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("density: 7850", "densty: 7850"),
        ("density: 7850", "density: -1"),
        ("kind: elastic", "kind: elastc"),
        ("type: revolute", "type: revolut"),
        ("coupling: average", "coupling: averge"),
        ("mass: 0.4", "mass: true"),
        ("[0, 0, -9.81]", "[0, -9.81]"),
        ("maggi: 1", "maggi: 2"),
        ("{file: rod.msh, unit: mm}", "{}"),
        ("every: 10", "every: 0"),
        ("geometric_stiffening: false", "geometric_stiffening: true"),
    ],
)
def test_bad_models_are_not(old: str, new: str) -> None:
    assert not valid(load(CONTRACT.replace(old, new, 1)), SCHEMA)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("pitch: 5 mm", "pich: 5 mm"),
        ("type: belt", "type: blt"),
        ("crossed: true", "crossed: 1"),
        ("radii: [0.1, 0.05]", "radii: [0.1]"),
        ("joints: [crank, slider]", "joints: [crank, 3]"),
        ("curve: {points: [[0, 0], ", "curve: {points: [3, "),
        ("roller: 4 mm", "roller: -4"),
        ("direction: [1, 0, 0]}", "}"),
        ("{blade: sled.front, g: ground}", "{blade: sled.front, g: 3}"),
        ("constant: 0.1*t", "constant: [1]"),
    ],
)
def test_bad_joints_are_not(old: str, new: str) -> None:
    assert old in LIBRARY
    assert not valid(load(LIBRARY.replace(old, new, 1)), SCHEMA)


def properties(schema: Any, at: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    if isinstance(schema, dict):
        for key, part in schema.get("properties", {}).items():
            yield f"{at}.{key}", part
        for key, part in schema.items():
            yield from properties(part, f"{at}.{key}")
    elif isinstance(schema, list):
        for place, part in enumerate(schema):
            yield from properties(part, f"{at}.{place}")


def test_every_key_and_every_section_is_described() -> None:
    keys = dict(properties(SCHEMA))
    assert len(keys) > 80
    assert [at for at, part in keys.items() if not part.get("description")] == []
    assert [name for name, part in SCHEMA["$defs"].items() if not part.get("description")] == []


def test_references_are_whole_and_used() -> None:
    text = json.dumps(SCHEMA)
    used = set(re.findall(r'"#/\$defs/([^"]+)"', text))
    assert used == set(SCHEMA["$defs"])
    assert SCHEMA["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert SCHEMA["additionalProperties"] is False
    assert set(SCHEMA["required"]) == {"maggi", "bodies"}
