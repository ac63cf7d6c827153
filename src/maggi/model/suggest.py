"""The nearest known name to a misspelt one."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

CANDIDATES = 60


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The known name most like `name`, or None if none is near.

    Only names of about the same length are compared, and not too many: files may hold thousands of names.
    """
    if len(name) > 80:
        return None
    similar: list[str] = []
    for other in known:
        if other.lower() == name.lower():
            return other
        if abs(len(other) - len(name)) <= 4 and len(similar) < CANDIDATES:
            similar.append(other)
    near = get_close_matches(name, similar, 1)
    return near[0] if near else None
