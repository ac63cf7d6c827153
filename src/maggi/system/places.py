"""Names of bodies and attachments to rows of the tables, and new attachments where a joint or a force needs them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from maggi.model.errors import ModelError
from maggi.model.joints import GROUND, End

from .body_list import BodyList

Array = NDArray[np.float64]


class Places:
    """Where bodies and attachments are, by name; `extent` collects the points that span the mechanism."""

    def __init__(self, bodies: BodyList) -> None:
        self._bodies = bodies
        self._index: dict[str, int] = {GROUND: 0}
        self._attachments: dict[tuple[str, str], int] = {}
        self.extent: list[Array] = []

    def add_body(self, name: str, index: int) -> None:
        """A body by name."""
        self._index[name] = index

    def add_attachment(self, body: str, name: str, row: int) -> None:
        """A named attachment."""
        self._attachments[body, name] = row
        self.extent.append(self._bodies.attachment_position(row))

    def body(self, name: str, path: str) -> int:
        """The row of a body. Raises ModelError if there is none of that name."""
        if name not in self._index:
            raise ModelError(f"there is no body {name!r}", path=path, remedy=f"bodies are {', '.join(self._index)}")
        return self._index[name]

    def attachment(self, end: End, path: str) -> int:
        """The row of a named attachment. Raises ModelError if there is none of that name."""
        self.body(end.body, path)
        key = (end.body, end.attachment or "")
        if key not in self._attachments:
            has = [name for body, name in self._attachments if body == end.body]
            raise ModelError(
                f"body {end.body!r} has no attachment {end.attachment!r}",
                path=path,
                remedy=f"it has {', '.join(has)}" if has else "add it under `attachments:`",
            )
        return self._attachments[key]

    def marker(self, end: End, place: Array, path: str, elsewhere: bool = True) -> int:
        """The attachment of a joint's end: the named one, or a point of a rigid body or of ground.

        place : global. elsewhere : it was given by itself, and may be another point of a named rigid body.
        """
        if end.attachment is not None:
            attachment = self.attachment(end, path)
            index = self._index[end.body]
            if not elsewhere or self._bodies.is_elastic(index):
                return attachment
            return self._bodies.add_attachment(index, self._bodies.to_body(index, place))
        index = self._rigid(end, path)
        return self._bodies.add_attachment(index, self._bodies.to_body(index, place))

    def point(self, end: End, path: str) -> int:
        """The attachment that a force or a rod acts on: a fixed point, a named one, or a rigid body's origin."""
        if end.point is not None:
            self.extent.append(np.array(end.point))
            return self._bodies.add_attachment(0, np.array(end.point))
        if end.attachment is not None:
            return self.attachment(end, path)
        return self._bodies.add_attachment(self._rigid(end, path), np.zeros(3))

    def _rigid(self, end: End, path: str) -> int:
        index = self.body(end.body, path)
        if self._bodies.is_elastic(index):
            raise ModelError(
                f"the elastic body {end.body!r} is held without naming an attachment",
                path=path,
                remedy=f"write `{end.body}.<attachment>`: elastic bodies are held at attachments only",
            )
        return index
