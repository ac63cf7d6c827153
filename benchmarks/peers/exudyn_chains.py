"""The open chain of `chains.py` in Exudyn: bodies and joints with redundant coordinates, and its kinematic tree."""

from __future__ import annotations

from typing import Any

import numpy as np

from .exudyn_runs import Peer, load

LENGTH, MASS, GRAVITY = 0.1, 1.0, [0.0, -9.81, 0.0]
INERTIA = np.diag([0.1, 1.0, 1.0]) * MASS * LENGTH**2 / 12.0
# Rxyz turns about z last, so that a motion about z stays away from its singularity: six coordinates, no constraint
NODES = ("RotationRxyz", "RotationEulerParameters", "RotationRotationVector")


def redundant(links: int) -> list[Peer]:
    """With every kind of rotation coordinates that a 3-D body can have."""
    return [_redundant(links, kind) for kind in NODES]


def _redundant(links: int, kind: str) -> Peer:
    exudyn: Any = load()
    from exudyn.utilities import ObjectGround, RigidBodyInertia

    mbs = exudyn.SystemContainer().AddSystem()
    inertia = RigidBodyInertia(MASS, INERTIA, com=[0.0, 0.0, 0.0])
    previous = mbs.AddObject(ObjectGround())
    for i in range(links):
        body = mbs.CreateRigidBody(
            inertia=inertia,
            referencePosition=[(i + 0.5) * LENGTH, 0.0, 0.0],
            gravity=GRAVITY,
            nodeType=getattr(exudyn.NodeType, kind),
        )
        mbs.CreateRevoluteJoint(itemNumbers=[previous, body], position=[i * LENGTH, 0.0, 0.0], axis=[0.0, 0.0, 1.0])
        previous = body
    mbs.Assemble()

    def tip() -> np.ndarray:
        return np.array(
            mbs.GetObjectOutputBody(
                previous, exudyn.OutputVariableType.Position, [0.5 * LENGTH, 0.0, 0.0], exudyn.ConfigurationType.Current
            )
        )

    return Peer(kind, mbs, tip)


def tree(links: int) -> Peer:
    """In the joints' angles alone."""
    exudyn: Any = load()
    from exudyn.utilities import NodeGenericODE2, ObjectKinematicTree

    mbs = exudyn.SystemContainer().AddSystem()
    zero = [0.0] * links
    node = mbs.AddNode(
        NodeGenericODE2(
            referenceCoordinates=zero, initialCoordinates=zero, initialCoordinates_t=zero, numberOfODE2Coordinates=links
        )
    )
    mbs.AddObject(
        ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=[exudyn.JointType.RevoluteZ] * links,
            linkParents=list(range(-1, links - 1)),
            jointTransformations=exudyn.Matrix3DList([np.eye(3)] * links),
            jointOffsets=exudyn.Vector3DList([[0.0, 0.0, 0.0]] + [[LENGTH, 0.0, 0.0]] * (links - 1)),
            linkInertiasCOM=exudyn.Matrix3DList([INERTIA] * links),
            linkCOMs=exudyn.Vector3DList([[0.5 * LENGTH, 0.0, 0.0]] * links),
            linkMasses=[MASS] * links,
            gravity=GRAVITY,
        )
    )
    mbs.Assemble()

    def tip() -> np.ndarray:
        angles = np.cumsum(mbs.GetNodeOutput(node, exudyn.OutputVariableType.Coordinates))
        return LENGTH * np.array([np.cos(angles).sum(), np.sin(angles).sum(), 0.0])

    return Peer("kinematic tree", mbs, tip)
