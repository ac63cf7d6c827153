"""YAML (and so JSON) text to a tree of values that know their line and column.

Only what a model file needs: mappings with text keys, lists, numbers, texts, true/false, null, by the core schema
of YAML 1.2 (``1e-3`` is a number, ``on`` a text). Tags, merge keys and duplicate keys are refused; aliases count
with all they stand for, so that a small file cannot unfold to a large one. The parser's events are read one by one
and the caps on depth and number of values are checked on the way.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
    StreamEndEvent,
)

from ..model.errors import ModelError

MAX_CHARACTERS = 2_000_000
MAX_VALUES = 100_000
MAX_DEPTH = 40
MAX_ANCHORS = 1000

Scalar = str | int | float | bool | None

_INTEGER = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
_WORDS: dict[str, Scalar] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}


@dataclass(frozen=True)
class Place:
    """A place in a text: file (or option) and 1-based line and column; line 0 where lines mean nothing."""

    file: str
    line: int
    column: int


@dataclass
class Node:
    """A value: a scalar, ``{key: Entry}`` or a list of nodes. `block`: a collection written over indented lines."""

    value: Scalar | dict[str, Entry] | list[Node]
    place: Place
    block: bool = False
    size: int = 1

    def plain(self) -> Any:
        """The value without places: dict, list or scalar; every collection is a new object."""
        if isinstance(self.value, dict):
            return {key: entry.node.plain() for key, entry in self.value.items()}
        if isinstance(self.value, list):
            return [node.plain() for node in self.value]
        return self.value


@dataclass
class Entry:
    """A key's place and its value."""

    place: Place
    node: Node


@dataclass
class _Open:
    """A collection being read; for a mapping `key` is the key whose value comes next."""

    node: Node
    anchor: str | None
    key: tuple[str, Place] | None = None


def compose(text: str, file: str, *, with_lines: bool = True) -> Node:
    """The tree of one YAML document.

    file : its name in messages; with_lines False leaves line and column at 0 (a text from the command line).
    Raises ModelError with the place for a syntax error or anything this module refuses.
    """
    if len(text) > MAX_CHARACTERS:
        raise ModelError(
            f"{len(text)} characters are more than {MAX_CHARACTERS}", file=file, remedy="keep meshes in their own files"
        )
    return _Composer(file, with_lines).run(_json_tabs(text))


@dataclass
class _Composer:
    file: str
    with_lines: bool
    stack: list[_Open] = field(default_factory=list)
    anchors: dict[str, Node] = field(default_factory=dict)
    count: int = 0
    root: Node | None = None

    def run(self, text: str) -> Node:
        try:
            for event in _events(text):
                self._take(event)
        except ModelError:
            raise
        except MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            place = Place(self.file, mark.line + 1, mark.column + 1) if mark else Place(self.file, 0, 0)
            what = error.problem or error.context or "not YAML"
            remedy = "indent with spaces, not tabs" if r"'\t'" in str(what) else _hint(str(what))
            raise self._refuse(f"not valid YAML: {what}", place, remedy) from None
        except YAMLError as error:
            what = str(error).splitlines()[0]
            raise self._refuse(f"not valid YAML: {what}", Place(self.file, 0, 0)) from None
        except (ValueError, RecursionError, AttributeError, KeyError, IndexError, TypeError, AssertionError):
            # What the parser does with some malformed directives and escapes.
            raise self._refuse("not valid YAML", Place(self.file, 0, 0)) from None
        if self.root is None:
            raise self._refuse("the file is empty", Place(self.file, 1, 1), "begin with the line 'maggi: 1'")
        return self.root

    def _take(self, event: Any) -> None:
        place = self._place(event)
        match event:
            case DocumentStartEvent() if self.root is not None:
                raise self._refuse("a second document begins here", place, "keep one model in a file")
            case AliasEvent():
                node = self.anchors.get(event.anchor)
                if node is None:
                    raise self._refuse(f"unknown alias '*{event.anchor}'", place)
                self.count += node.size - 1  # an alias counts with all it stands for
                self._add(node, place, None)
            case ScalarEvent():
                self._check_tag(event, place)
                if not event.value and not event.style and self.stack and self.stack[-1].key:
                    place = self.stack[-1].key[1]  # an empty value has no place but its key's
                self._add(Node(self._scalar(event, place), place), place, event.anchor, plain=event.value)
            case MappingStartEvent() | SequenceStartEvent():
                self._check_tag(event, place)
                if len(self.stack) >= MAX_DEPTH:
                    raise self._refuse(f"nested more than {MAX_DEPTH} deep", place)
                value: dict[str, Entry] | list[Node] = {} if isinstance(event, MappingStartEvent) else []
                self.stack.append(_Open(Node(value, place, block=not event.flow_style), event.anchor))
                self._expect_no_key(place)
            case MappingEndEvent() | SequenceEndEvent():
                done = self.stack.pop()
                self._add(done.node, done.node.place, done.anchor)
            case StreamEndEvent():
                return

    def _expect_no_key(self, place: Place) -> None:
        """A collection has just been opened: it must not stand where a key is expected."""
        if len(self.stack) > 1:
            parent = self.stack[-2]
            if isinstance(parent.node.value, dict) and parent.key is None:
                raise self._refuse("a key must be a name, not a list or mapping", place)

    def _add(self, node: Node, place: Place, anchor: str | None, plain: str | None = None) -> None:
        """A finished value to the collection around it (as a key, if one is due)."""
        if anchor is not None:
            if len(self.anchors) >= MAX_ANCHORS:
                raise self._refuse(f"more than {MAX_ANCHORS} anchors", place)
            self.anchors[anchor] = node
        self.count += 1
        if self.count > MAX_VALUES:
            raise self._refuse(f"more than {MAX_VALUES} values", place, "keep meshes in their own files")
        if not self.stack:
            self.root = node
            return
        parent = self.stack[-1]
        parent.node.size += node.size
        if isinstance(parent.node.value, list):
            parent.node.value.append(node)
        elif isinstance(parent.node.value, dict):
            if parent.key is None:
                parent.key = self._key(node, place, plain, parent.node.value)
            else:
                key, key_place = parent.key
                parent.node.value[key] = Entry(key_place, node)
                parent.key = None

    def _key(self, node: Node, place: Place, plain: str | None, siblings: dict[str, Entry]) -> tuple[str, Place]:
        key = plain if plain is not None else str(node.value)
        if isinstance(node.value, (dict, list)):
            raise self._refuse("a key must be a name, not a list or mapping", place)
        if key == "<<":
            raise self._refuse("merge keys (<<) are not part of the format", place, "repeat the keys")
        if key in siblings:
            first = siblings[key].place
            where = f" (first in line {first.line}, column {first.column})" if first.line else ""
            raise self._refuse(f"key '{key[:80]}' is given twice{where}", place, "keep one of them")
        return key, place

    def _scalar(self, event: Any, place: Place) -> Scalar:
        text: str = event.value
        if any("\ud800" <= character <= "\udfff" for character in text):
            try:
                text = text.encode("utf-16", "surrogatepass").decode("utf-16")  # JSON writes 😀 as two escapes
            except UnicodeDecodeError:
                raise self._refuse("a text holds half a character (a lone surrogate)", place) from None
        if event.style or not event.implicit[0]:
            return text
        if text in _WORDS:
            return _WORDS[text]
        if len(text) > 100:
            return text
        if _INTEGER.fullmatch(text):
            return int(text, 0) if text[:2] in ("0o", "0x") else int(text)
        if _FLOAT.fullmatch(text):
            number = float(text)
            if math.isfinite(number):
                return number
        elif not _NOT_FINITE.fullmatch(text):
            return text
        raise self._refuse(f"the number {text} is not finite", place, "give a finite number")

    def _check_tag(self, event: Any, place: Place) -> None:
        tag = event.tag
        if tag is not None:
            shown = str(tag).replace("tag:yaml.org,2002:", "!!")[:60]
            raise self._refuse(
                f"the tag {shown} is not accepted", place, "write plain values; a model file runs no code"
            )

    def _place(self, event: Any) -> Place:
        if not self.with_lines:
            return Place(self.file, 0, 0)
        mark = event.start_mark
        return Place(self.file, mark.line + 1, mark.column + 1)

    def _refuse(self, message: str, place: Place, remedy: str = "") -> ModelError:
        line, column = (place.line, place.column) if self.with_lines else (0, 0)
        return ModelError(message, file=place.file, line=line, column=column, remedy=remedy)


def _events(text: str) -> Iterator[Any]:
    return iter(YAML(typ="safe", pure=True).parse(text))


def _hint(problem: str) -> str:
    if "mapping values are not allowed" in problem:
        return "put a text with ': ' in quotes, or check the indentation of this line and the one before"
    if "expected <block end>" in problem or "could not find expected ':'" in problem:
        return "check the indentation and that every key has its ':'"
    if "flow" in problem or "expected ','" in problem:
        return "check that every [ and { is closed"
    return ""


def _json_tabs(text: str) -> str:
    """JSON may be indented with tabs, YAML not: in a text that is one bracketed value they become spaces.

    JSON has no raw tab inside a string, so nothing else changes, and columns stay.
    """
    return text.replace("\t", " ") if text.lstrip()[:1] in ("{", "[") else text
