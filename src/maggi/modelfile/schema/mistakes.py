"""Pydantic's findings as the program's own errors, with dotted path, value found and remedy."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from ...model.errors import ModelError
from ...model.expression import Parameter
from ...model.suggest import nearest

KEY = "[key]"
"""Pydantic's mark, behind a key, for an error in the key itself."""


MAX_MISTAKES = 100


@dataclass
class Context:
    """What validation knows beyond the value at hand.

    parameters : resolved, SI. folder : where paths of files start. sections : for every mapping met (by identity) the class that says its keys.
    """

    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    folder: str = "."
    sections: dict[int, type[BaseModel]] = field(default_factory=dict)

    @cached_property
    def values(self) -> dict[str, float]:
        """The parameters' values alone."""
        return {name: parameter.value for name, parameter in self.parameters.items()}


@dataclass(frozen=True)
class Located:
    """An error and whether its path's key, not its value, is what is wrong."""

    error: ModelError
    at_key: bool = False


def mistake(
    message: str, remedy: str = "", at: Sequence[str | int] = (), file: str = "", line: int = 0
) -> PydanticCustomError:
    """An error to raise inside a validator; `at` leads from the validated value to the wrong part of it.

    file, line : where the mistake is, if in another file than the model's.
    """
    found = {"text": message, "remedy": remedy, "at": tuple(at), "file": file, "line": line}
    return PydanticCustomError("mistake", "{text}", found)


def shown(value: Any) -> str:
    """A value for a message: short."""
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return str(value).lower()
    text = repr(value) if isinstance(value, str) else f"{value:.12g}" if isinstance(value, float) else str(value)[:80]
    return text if len(text) <= 80 else text[:80] + "…"


def suggestion(name: str, known: Iterable[str], what: str) -> str:
    """``did you mean 'steel'?``, or the known names."""
    names = list(known)
    near = nearest(name, names)
    if near:
        return f"did you mean '{near}'?"
    return f"{what} are {', '.join(names[:20])}" if names else f"there are no {what}"


def to_model_errors(found: ValidationError, data: Any, context: Context) -> list[Located]:
    """The first MAX_MISTAKES findings of a validation of `data`; a misspelt key does not count as a missing one too."""
    findings = found.errors(include_url=False)
    meant = {_misspelt(details, data, context) for details in findings if details["type"] == "extra_forbidden"}
    kept = [_convert(details, data, context) for details in findings[:MAX_MISTAKES]]
    return [each for each, details in zip(kept, findings, strict=False) if not _is_meant(each, details, meant)]


def _misspelt(details: ErrorDetails, data: Any, context: Context) -> str:
    """The path of the key that an unknown key may have been meant for."""
    keys = _without_marks(details["loc"], data)
    section = context.sections[id(_descend(data, keys[:-1]))]
    return ".".join(map(str, [*keys[:-1], nearest(str(keys[-1]), section.model_fields)]))


def _is_meant(located: Located, details: ErrorDetails, meant: set[str]) -> bool:
    return details["type"] == "missing" and located.error.path in meant


def _convert(details: ErrorDetails, data: Any, context: Context) -> Located:
    kind, value = details["type"], details.get("input")
    extra = details.get("ctx", {})
    whole = [*details["loc"], *extra.get("at", ())] if kind == "mistake" else list(details["loc"])
    keys = _without_marks(whole, data)
    at_key = len(whole) > 0 and whole[-1] == KEY
    message, remedy = details["msg"], ""
    file, line = extra.get("file", ""), extra.get("line", 0)
    if kind == "mistake":
        message, remedy = extra["text"], extra["remedy"]
    elif kind == "extra_forbidden":
        at_key = True
        allowed = context.sections[id(_descend(data, keys[:-1]))].model_fields
        message = f"unknown key '{str(keys[-1])[:80]}'"
        near = nearest(str(keys[-1]), allowed)
        if near:
            message += f"; did you mean '{near}'?"
            remedy = f"write '{near}'"
        else:
            remedy = f"known keys are {', '.join(allowed)}"
    elif kind == "missing":
        message = f"missing key '{keys[-1]}'"
        section = context.sections.get(id(_descend(data, keys[:-1])))
        if section is not None:
            remedy = f"add '{keys[-1]}': {section.model_fields[str(keys[-1])].description}"
    elif value is None:
        message = "no value given"
        remedy = "give a value or leave the key out"
    elif kind == "literal_error":
        message = f"{message}, found {shown(value)}"
        near = nearest(str(value), re.findall("'([^']*)'", str(extra.get("expected", ""))))
        remedy = f"did you mean '{near}'?" if near else ""
    else:
        message = f"{message}, found {shown(value)}"
        remedy = _meaning(keys, data, context)
    path = ".".join(str(key) for key in keys)
    return Located(ModelError(message, path=path, remedy=remedy, file=file, line=line), at_key)


def _meaning(keys: Sequence[str | int], data: Any, context: Context) -> str:
    """What the innermost key of a path that has a description stands for."""
    for depth in range(len(keys), 0, -1):
        section = context.sections.get(id(_descend(data, keys[: depth - 1])))
        field_info = section.model_fields.get(str(keys[depth - 1])) if section else None
        if field_info is not None and field_info.description:
            return f"'{keys[depth - 1]}' means: {field_info.description}"
    return ""


def _without_marks(whole: Sequence[str | int], data: Any) -> list[str | int]:
    """The path in the document: without tags of unions (written <tag>) and marks of keys, which it does not have."""
    keys: list[str | int] = []
    for key in whole:
        known = isinstance(data, dict) and key in data
        if not known and isinstance(key, str) and (key[:1] == "<" or key == KEY):
            continue
        keys.append(key)
        listed = isinstance(data, list) and isinstance(key, int) and key < len(data)
        data = data[key] if known or listed else None
    return keys


def _descend(data: Any, keys: Sequence[str | int]) -> Any:
    for key in keys:
        data = data[key]
    return data
