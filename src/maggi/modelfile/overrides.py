"""``--set key=value``: single values of a model replaced from the command line."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..model.errors import ModelError
from ..model.suggest import nearest
from .compose import Entry, Node, compose


def apply_overrides(root: Node, overrides: Sequence[str]) -> None:
    """Replace or add values in the tree, in order.

    An override is ``simulation.step=1e-6``, ``parameters.speed=3000 rpm``, ``joints.pin.axis.1=0``; the value is read
    as in the file. A section that the file leaves out is made; a parameter, body, joint or force must be there.
    Raises ModelError naming the override.
    """
    for override in overrides:
        path, equals, text = override.partition("=")
        keys = path.strip().split(".")
        shown = f"--set {override[:100]}"
        if not equals or not all(keys) or not text.strip():
            raise ModelError(
                "cannot read this option", file=shown, remedy="write key=value, such as simulation.step=1e-6"
            )
        _replace(root, keys, compose(text.strip(), shown, with_lines=False), shown)


def _replace(root: Node, keys: list[str], new: Node, shown: str) -> None:
    node = root
    for depth, key in enumerate(keys):
        path, last = ".".join(keys[: depth + 1]), depth == len(keys) - 1
        if node.value is None:
            node.value = {}
        if isinstance(node.value, dict):
            if key not in node.value:
                if depth == 1 and keys[0] in ("parameters", "materials", "bodies", "joints", "forces"):
                    raise _unknown(keys[0], key, node.value, path, shown)
                node.value[key] = Entry(new.place, Node({}, new.place))
            if last:
                node.value[key] = Entry(new.place, new)
            else:
                node = node.value[key].node
        elif isinstance(node.value, list):
            if not (key.isascii() and key.isdigit() and int(key[:9]) < len(node.value)):
                raise ModelError(
                    f"'{key[:40]}' is not a place in a list of {len(node.value)}",
                    file=shown,
                    path=path,
                    remedy="count from 0",
                )
            if last:
                node.value[int(key)] = new
            else:
                node = node.value[int(key)]
        else:
            parent = ".".join(keys[:depth])
            raise ModelError(f"{parent} is a single value and has no keys", file=shown, path=path)


def _unknown(section: str, key: str, known: Iterable[str], path: str, shown: str) -> ModelError:
    names = list(known)
    near = nearest(key, names)
    remedy = f"did you mean '{near}'?" if near else f"the file has {', '.join(names[:20]) or 'none'}"
    return ModelError(f"nothing named '{key[:60]}' in {section}", file=shown, path=path, remedy=remedy)
