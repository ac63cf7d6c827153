"""Places in model texts that messages must point at."""

from __future__ import annotations


def mark(text: str) -> tuple[str, int, int]:
    """The text without its mark, and the mark's line and column (1, 1 without one)."""
    before, sign, after = text.partition("§")
    if not sign:
        return text, 1, 1
    return before + after, before.count("\n") + 1, len(before) - before.rfind("\n")
