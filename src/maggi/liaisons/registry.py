"""The joint library as data: for every kind of joint between two frames, which motions it locks and what it measures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .tables import OFFSET, PRODUCT, ROTATION, ROTATION_SECOND, ROTATION_VECTOR, TRANSLATION, TWIST


@dataclass(frozen=True)
class JointKind:
    """A kind of joint.

    rows : (OFFSET, k, 0) locks the offset along axis k of the first end; (PRODUCT, k, l) keeps axis k of the
        first normal to axis l of the second; (TWIST, k, l) locks the turn about the third axis. Eq. T7.
    coordinates : (kind, axis), translations first; what drivers, couplers, torsion springs and results refer to.
    placed_by : the model's key that gives the joint's frame: ``axis`` is its z axis; ``axes`` are x on the
        first and y on the second; ``shafts`` an axis, or the z axes on the first and on the second; ``""`` takes the
        global axes.
    screw : displacement and angle are coupled by the joint's pitch.
    """

    name: str
    rows: tuple[tuple[int, int, int], ...]
    coordinates: tuple[tuple[int, int], ...]
    placed_by: Literal["axis", "axes", "shafts", ""]
    screw: bool = False


def lower_pair(
    name: str, translations: str, rotations: str, placed_by: Literal["axis", ""] = "axis", screw: bool = False
) -> JointKind:
    """The lower pair that leaves the named relative motions free (letters of ``xyz``; z is the joint's axis)."""
    rows = [(OFFSET, k, 0) for k in range(3) if "xyz"[k] not in translations]
    if rotations == "":
        rows += [(PRODUCT, 0, 1), (PRODUCT, 1, 2), (PRODUCT, 2, 0)]
    elif rotations == "z":
        rows += [(PRODUCT, 0, 2), (PRODUCT, 1, 2)]
    elif rotations != "xyz":
        raise ValueError(f"no lower pair is free to rotate about {rotations!r} alone")
    coordinates = [(TRANSLATION, "xyz".index(k)) for k in translations]
    if rotations == "z":
        coordinates.append((ROTATION, 2))
    elif rotations == "xyz":
        coordinates += [(ROTATION_VECTOR, k) for k in range(3)]
    return JointKind(name, tuple(rows), tuple(coordinates), placed_by, screw)


def row_label(kind: int, k: int, l: int) -> str:
    """What a row of a joint locks, for messages and reports."""
    if kind == OFFSET:
        return f"offset along its {'xyz'[k]} axis"
    return f"rotation about its {'xyz'[3 - k - l]} axis"


_OFFSETS = ((OFFSET, 0, 0), (OFFSET, 1, 0), (OFFSET, 2, 0))

JOINTS: dict[str, JointKind] = {
    kind.name: kind
    for kind in (
        lower_pair("revolute", "", "z"),
        lower_pair("prismatic", "z", ""),
        lower_pair("cylindrical", "z", "z"),
        lower_pair("screw", "z", "z", screw=True),
        lower_pair("spherical", "", "xyz", ""),
        lower_pair("planar", "xy", "z"),
        lower_pair("weld", "", "", ""),
        lower_pair("free", "xyz", "xyz", ""),
        JointKind("universal", (*_OFFSETS, (PRODUCT, 0, 1)), ((ROTATION, 0), (ROTATION_SECOND, 1)), "axes"),
        JointKind("constant-velocity", (*_OFFSETS, (TWIST, 0, 1)), (), "shafts"),
    )
}
