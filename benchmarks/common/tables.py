"""Tables that read well in a terminal and are Markdown, and the short forms of the figures in them."""

from __future__ import annotations

MISSING = "-"


class Table:
    """A titled table; `note` adds a line below it. Printed at once when it is complete."""

    def __init__(self, title: str, *headers: str) -> None:
        self._title = title
        self._rows = [list(headers)]
        self._notes: list[str] = []

    def row(self, *cells: str | int) -> None:
        """One line; as many cells as there are headers."""
        if len(cells) != len(self._rows[0]):
            raise ValueError(f"{len(cells)} cells under {len(self._rows[0])} headers")
        self._rows.append([str(cell) for cell in cells])

    def note(self, text: str) -> None:
        """A line below the table."""
        self._notes.append(text)

    def show(self) -> None:
        """Print it."""
        widths = [max(len(row[k]) for row in self._rows) for k in range(len(self._rows[0]))]
        print(f"### {self._title}\n")
        for number, row in enumerate(self._rows):
            print("| " + " | ".join(_aligned(cell, widths[k], k == 0) for k, cell in enumerate(row)) + " |")
            if number == 0:
                print(
                    "|" + "|".join((":" if k == 0 else "-") + "-" * w + "-:"[k > 0] for k, w in enumerate(widths)) + "|"
                )
        print()
        for text in self._notes:
            print(text)
        if self._notes:
            print()


def _aligned(cell: str, width: int, left: bool) -> str:
    return cell.ljust(width) if left else cell.rjust(width)


def figure(value: float | None, digits: int = 3) -> str:
    """A number with some significant digits, in powers of ten only where it is tiny; a dash for none."""
    if value is None:
        return MISSING
    if value == 0.0:
        return "0"
    if abs(value) < 1e-4:
        return f"{value:.1e}"
    from math import floor, log10

    decimals = max(0, digits - 1 - floor(log10(abs(value))))
    return f"{value:,.{decimals}f}"


def micro(seconds: float | None) -> str:
    """Microseconds."""
    return MISSING if seconds is None else figure(1e6 * seconds)


def milli(seconds: float | None) -> str:
    """Milliseconds."""
    return MISSING if seconds is None else figure(1e3 * seconds)


def times(value: float | None) -> str:
    """A quotient, such as 12.3×."""
    return MISSING if value is None else f"{figure(value)}×"


def error(value: float | None) -> str:
    """A small number."""
    return MISSING if value is None else f"{value:.1e}"
