"""Where in the model file a dotted path is."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import TypeVar

from ..model.errors import ModelError, ModelErrors
from .compose import Node, Place

E = TypeVar("E", bound=ModelError)


@dataclass(frozen=True)
class SourceMap:
    """The places of a model file's values, by dotted path (``bodies.crank.inertia.0``)."""

    root: Node

    def place(self, path: str, *, key: bool = False) -> Place:
        """The place of a path's value, or of its key (`key`); of the nearest existing ancestor if it does not exist.

        A collection over several lines is pointed at by its key, a value in the line by itself.
        """
        node, key_place = self.root, self.root.place
        rest, found = path, True
        while rest and found:
            value, found = node.value, False
            if isinstance(value, dict):
                for name in sorted(value, key=len, reverse=True):
                    if rest == name or rest.startswith(name + "."):
                        key_place, node = value[name].place, value[name].node
                        rest, found = rest[len(name) + 1 :], True
                        break
            elif isinstance(value, list):
                head, _, tail = rest.partition(".")
                if head.isascii() and head.isdigit() and int(head[:9]) < len(value):
                    node = value[int(head[:9])]
                    key_place, rest, found = node.place, tail, True
        return key_place if (key and not rest) or node.block else node.place

    def locate(self, error: E, *, key: bool = False) -> E:
        """A copy of the error with file, line and column of its path; unchanged if it has a file already."""
        located = copy.copy(error)
        if isinstance(located, ModelErrors):
            located.errors = tuple(self.locate(single) for single in located.errors)
            first = located.errors[0]
            located.file, located.line, located.column = first.file, first.line, first.column
        elif not located.file:
            place = self.place(located.path, key=key)
            located.file, located.line, located.column = place.file, place.line, place.column
        return located
