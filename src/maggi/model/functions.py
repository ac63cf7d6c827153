"""Functions of time, or of named variables, as postfix programs: data, so that a model file cannot run code."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class TimeFunction:
    """A function of time, compiled to postfix form; evaluated with its two derivatives by `linalg.jets`.

    codes[i] is an operation (see `model.operations`), values[i] its constant where it has one.
    """

    text: str
    codes: tuple[int, ...]
    values: tuple[float, ...]


@dataclass(frozen=True)
class Formula:
    """A function of named variables; `values` of a VARIABLE operation is its place in `variables`.

    Names may have dots, such as ``hub.r11`` for an entry of the rotation of the attachment called hub.
    """

    text: str
    variables: tuple[str, ...]
    codes: tuple[int, ...]
    values: tuple[float, ...]
