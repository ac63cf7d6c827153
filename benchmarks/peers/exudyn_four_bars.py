"""The N-four-bar of `four_bars.py` in Exudyn, in 3-D: rods with redundant coordinates, its joints' rows with or without
those that repeat others.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .exudyn_runs import Peer, load

# Rxyz turns about z last: no singularity in this plane
NODES = ("RotationRxyz", "RotationEulerParameters", "RotationRotationVector")
INERTIA = np.diag([0.1, 1.0, 1.0]) / 12.0
UPRIGHT = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
AXIS = [0.0, 0.0, 1.0]


@dataclass
class FourBars:
    """The system, how far its rods are from parallel (rad) at the end of a run, and what has it store what our results hold."""

    peer: Peer
    spread: Callable[[], float]
    watch: Callable[[], None]


def four_bars(windows: int, *, full: bool) -> list[FourBars]:
    """With every kind of rotation coordinates. full : 3-D revolutes everywhere, whose Jacobian is singular; else one
    joint of each loop holds its two displacements in the plane only.
    """
    return [_four_bars(windows, kind, full) for kind in NODES]


def _four_bars(windows: int, kind: str, full: bool) -> FourBars:
    exudyn: Any = load()
    from exudyn.utilities import ObjectGround, RigidBodyInertia

    mbs = exudyn.SystemContainer().AddSystem()
    inertia = RigidBodyInertia(1.0, INERTIA, com=[0.0, 0.0, 0.0])
    common = {"inertia": inertia, "gravity": [0.0, -9.81, 0.0], "nodeType": getattr(exudyn.NodeType, kind)}
    ground = mbs.AddObject(ObjectGround())
    rods = [
        mbs.CreateRigidBody(
            referencePosition=[i, 0.5, 0.0],
            referenceRotationMatrix=UPRIGHT,
            initialVelocity=[0.5, 0.0, 0.0],
            initialAngularVelocity=[0.0, 0.0, -1.0],
            **common,
        )
        for i in range(windows + 1)
    ]
    couplers = [
        mbs.CreateRigidBody(referencePosition=[i + 0.5, 1.0, 0.0], initialVelocity=[1.0, 0.0, 0.0], **common)
        for i in range(windows)
    ]
    for i, rod in enumerate(rods):
        mbs.CreateRevoluteJoint(itemNumbers=[ground, rod], position=[i, 0.0, 0.0], axis=AXIS)
    for i, coupler in enumerate(couplers):
        mbs.CreateRevoluteJoint(itemNumbers=[rods[i], coupler], position=[i, 1.0, 0.0], axis=AXIS)
        ends = {"itemNumbers": [coupler, rods[i + 1]], "position": [i + 1.0, 1.0, 0.0]}
        if full:
            mbs.CreateRevoluteJoint(axis=AXIS, **ends)
        else:
            mbs.CreateGenericJoint(constrainedAxes=[1, 1, 0, 0, 0, 0], **ends)
    mbs.Assemble()

    def output(body: object, kind: object, place: list[float]) -> np.ndarray:
        return np.array(mbs.GetObjectOutputBody(body, kind, place, exudyn.ConfigurationType.Current))

    def corner() -> np.ndarray:
        return output(rods[0], exudyn.OutputVariableType.Position, [0.5, 0.0, 0.0])

    def spread() -> float:
        kind = exudyn.OutputVariableType.RotationMatrix
        along = np.array([output(rod, kind, [0.0, 0.0, 0.0]).reshape(3, 3)[:, 0] for rod in rods])
        return float(np.linalg.norm(np.cross(along, along[0]), axis=1).max())

    def watch() -> None:
        from exudyn.utilities import SensorBody, SensorObject

        kinds = exudyn.OutputVariableType
        of_body = (kinds.Position, kinds.RotationMatrix, kinds.Velocity, kinds.AngularVelocity)
        joints = [k for k in range(mbs.systemData.NumberOfObjects()) if "Joint" in mbs.GetObject(k)["objectType"]]
        for body in (*rods, *couplers):
            for place, wanted in (([0.0, 0.0, 0.0], of_body), ([0.5, 0.0, 0.0], of_body)):
                for what in wanted:
                    mbs.AddSensor(
                        SensorBody(bodyNumber=body, localPosition=place, outputVariableType=what, storeInternal=True)
                    )
        for joint in joints:
            for what in (kinds.ForceLocal, kinds.TorqueLocal):
                mbs.AddSensor(SensorObject(objectNumber=joint, outputVariableType=what, storeInternal=True))
        mbs.Assemble()

    return FourBars(Peer(kind, mbs, corner), spread, watch)
