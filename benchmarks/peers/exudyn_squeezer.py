"""Andrews' squeezer in Exudyn: of planar bodies, and of 3-D bodies whose loops are closed without redundant rows."""

from __future__ import annotations

from typing import Any

import numpy as np

from common import squeezer_data as data

from .exudyn_runs import Peer, load

# Rxyz turns about z last: no singularity in this plane
NODES = ("RotationRxyz", "RotationEulerParameters")


def squeezers() -> list[Peer]:
    """All the ways; the compared point is the seven bodies' angles."""
    return [_squeezer("planar bodies", None), *(_squeezer(f"3-D bodies, {node}", node) for node in NODES)]


def _squeezer(name: str, node: str | None) -> Peer:
    exudyn: Any = load()
    from exudyn.utilities import MarkerBodyRigid, ObjectGround, ObjectJointRevolute2D, RigidBodyInertia

    mbs = exudyn.SystemContainer().AddSystem()
    planar = node is None
    bodies = {"ground": mbs.AddObject(ObjectGround())}
    links = data.links()
    for key, link in links.items():
        # the frame in the centre of mass: Exudyn's mass matrix is constant there
        c, s = np.cos(link.angle), np.sin(link.angle)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        place = np.array([*link.at, 0.0]) + turn @ [*link.center, 0.0]
        bodies[key] = mbs.CreateRigidBody(
            inertia=RigidBodyInertia(link.mass, link.inertia * np.eye(3), com=[0.0, 0.0, 0.0]),
            referencePosition=place,
            referenceRotationMatrix=turn,
            nodeType=exudyn.NodeType.RotationEulerParameters if planar else getattr(exudyn.NodeType, node),
            create2D=planar,
        )
    for hinge, (first, second) in zip(data.hinges(), data.HINGES, strict=True):
        pair = [bodies[hinge.first], bodies[hinge.second]]
        place = [*hinge.at, 0.0]
        if planar:
            markers = []
            for end in (first, second):
                key, _, point = end.partition(".")
                at = [*hinge.at, 0.0] if not point else _local(links[key], point)
                markers.append(mbs.AddMarker(MarkerBodyRigid(bodyNumber=bodies[key], localPosition=at)))
            mbs.AddObject(ObjectJointRevolute2D(markerNumbers=markers))
        elif hinge.closes:
            mbs.CreateGenericJoint(itemNumbers=pair, position=place, constrainedAxes=[1, 1, 0, 0, 0, 0])
        else:
            mbs.CreateRevoluteJoint(itemNumbers=pair, position=place, axis=[0.0, 0.0, 1.0])
    stiffness, length = data.SPRING
    mbs.CreateSpringDamper(
        itemNumbers=[bodies["ground"], bodies["K3"]],
        localPosition0=[*data.ANCHOR, 0.0],
        localPosition1=_local(links["K3"], "D"),
        referenceLength=length,
        stiffness=stiffness,
    )
    mbs.CreateTorque(bodyNumber=bodies["K1"], loadVector=[0.0, 0.0, data.MOTOR])
    mbs.Assemble()

    def angles() -> np.ndarray:
        kind, now = exudyn.OutputVariableType.RotationMatrix, exudyn.ConfigurationType.Current
        found = [mbs.GetObjectOutputBody(bodies[key], kind, [0.0, 0.0, 0.0], now) for key in data.NAMES]
        return np.array([np.arctan2(R[3], R[0]) for R in found])

    return Peer(name, mbs, angles)


def _local(link: data.Link, point: str) -> list[float]:
    x, y = link.points[point]
    return [x - link.center[0], y - link.center[1], 0.0]
