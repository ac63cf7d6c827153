"""The coordinates that are named in models are those that joints measure."""

from __future__ import annotations

import pytest

from maggi.liaisons.registry import JOINTS
from maggi.liaisons.tables import ROTATION, ROTATION_SECOND, ROTATION_VECTOR, TRANSLATION
from maggi.model.joint_kinds import JOINT_COORDINATES, named_coordinates

QUANTITY = {TRANSLATION: "displacement", ROTATION: "angle", ROTATION_SECOND: "angle", ROTATION_VECTOR: "rotation"}


def test_every_joint_is_listed() -> None:
    assert set(JOINT_COORDINATES) == set(JOINTS)


@pytest.mark.parametrize("kind", JOINTS)
def test_coordinates_are_those_of_the_registry(kind: str) -> None:
    assert JOINT_COORDINATES[kind] == tuple(QUANTITY[what] for what, _ in JOINTS[kind].coordinates)


@pytest.mark.parametrize(
    ("kind", "named"),
    [
        ("revolute", ("angle",)),
        ("prismatic", ("displacement",)),
        ("cylindrical", ("angle", "displacement")),
        ("screw", ("angle", "displacement")),
        ("planar", ("angle",)),
        ("universal", ()),
        ("spherical", ()),
        ("weld", ()),
        ("no such joint", ()),
    ],
)
def test_named_coordinates_are_unambiguous(kind: str, named: tuple[str, ...]) -> None:
    assert named_coordinates(kind) == named
