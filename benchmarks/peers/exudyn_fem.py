"""An elastic body on our own mesh, mass and stiffness in Exudyn, hinged about z at one end: reduced, or full mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from .exudyn_runs import Peer, load

Array = NDArray[np.float64]
GRAVITY = [0.0, -9.81, 0.0]


@dataclass(frozen=True, eq=False)
class Mesh:
    """What Exudyn needs of a body: nodes (n, 3), M and K (3n, 3n), the nodes of each place held, the node at the tip."""

    nodes: Array
    mass: sp.csr_matrix
    stiffness: sp.csr_matrix
    held: tuple[NDArray[np.int64], ...]
    tip: int


def reduced_rod(mesh: Mesh, modes: Array, node: str = "RotationRxyz") -> Peer:
    """`ObjectFFRFreducedOrder` with the columns of `modes` (3n, m) as its shapes."""
    exudyn: Any = load()
    from exudyn.FEM import ObjectFFRFreducedOrderInterface

    mbs = exudyn.SystemContainer().AddSystem()
    fem = _interface(mesh, modes)
    interface = ObjectFFRFreducedOrderInterface(fem, rigidBodyNodeType=getattr(exudyn.NodeType, node))
    added = interface.AddObjectFFRFreducedOrder(mbs, gravity=GRAVITY)
    body = added["oFFRFreducedOrder"]
    _hinge(mbs, body, mesh)
    mbs.Assemble()
    return _peer(f"{modes.shape[1]} modes, {node}", mbs, body, mesh)


def full_rod(mesh: Mesh) -> Peer:
    """`ObjectFFRF` with its Tisserand frame; a ball joint in the mean of the nodes of each place held.

    Gravity by the nodes' shares of the mass: a load in proportion to mass does not move an `ObjectFFRF` whose frame is
    off its centre of mass. Joints that hold rotations cannot act on it.
    """
    from exudyn.FEM import ObjectFFRFinterface
    from exudyn.utilities import Force, MarkerBodyPosition, MarkerSuperElementPosition, ObjectGround, SphericalJoint

    exudyn: Any = load()
    mbs = exudyn.SystemContainer().AddSystem()
    added = ObjectFFRFinterface(_interface(mesh, np.zeros((3 * len(mesh.nodes), 0)))).AddObjectFFRF(exudyn, mbs)
    body = added["oFFRF"]
    shares = np.asarray(mesh.mass[::3, ::3].sum(axis=1)).ravel()
    weights = list(shares / shares.sum())
    everywhere = list(range(len(mesh.nodes)))
    all_nodes = MarkerSuperElementPosition(bodyNumber=body, meshNodeNumbers=everywhere, weightingFactors=weights)
    mbs.AddLoad(Force(markerNumber=mbs.AddMarker(all_nodes), loadVector=list(shares.sum() * np.array(GRAVITY))))
    for nodes in mesh.held:
        ground = mbs.AddObject(ObjectGround(referencePosition=list(mesh.nodes[nodes].mean(axis=0))))
        fixed = mbs.AddMarker(MarkerBodyPosition(bodyNumber=ground))
        held = mbs.AddMarker(MarkerSuperElementPosition(bodyNumber=body, **_mean(nodes)))
        mbs.AddObject(SphericalJoint(markerNumbers=[fixed, held]))
    mbs.Assemble()
    return _peer("ObjectFFRF", mbs, body, mesh)


def _interface(mesh: Mesh, modes: Array) -> Any:
    from exudyn.FEM import FEMinterface

    fem = FEMinterface()
    fem.nodes = {"Position": mesh.nodes}
    fem.massMatrix, fem.stiffnessMatrix = mesh.mass, mesh.stiffness
    fem.modeBasis = {"matrix": modes, "type": "NormalModes"}
    return fem


def _mean(nodes: NDArray[np.int64]) -> dict[str, Any]:
    return {"meshNodeNumbers": [int(node) for node in nodes], "weightingFactors": [1.0 / len(nodes)] * len(nodes)}


def _hinge(mbs: Any, body: Any, mesh: Mesh) -> None:
    """A full 3-D revolute between ground and the mean of the nodes held."""
    from exudyn.utilities import MarkerBodyRigid, MarkerSuperElementRigid, ObjectGround, ObjectJointRevoluteZ

    (nodes,) = mesh.held
    held = mbs.AddMarker(MarkerSuperElementRigid(bodyNumber=body, **_mean(nodes)))
    ground = mbs.AddObject(ObjectGround(referencePosition=list(mesh.nodes[nodes].mean(axis=0))))
    fixed = mbs.AddMarker(MarkerBodyRigid(bodyNumber=ground))
    mbs.AddObject(ObjectJointRevoluteZ(markerNumbers=[fixed, held]))


def _peer(name: str, mbs: Any, body: Any, mesh: Mesh) -> Peer:
    exudyn: Any = load()
    from exudyn.utilities import SensorSuperElement

    position = exudyn.OutputVariableType.Position
    sensor = mbs.AddSensor(
        SensorSuperElement(bodyNumber=body, meshNodeNumber=mesh.tip, outputVariableType=position, storeInternal=True)
    )
    mbs.Assemble()

    def tip() -> Array:
        return np.array(mbs.GetObjectOutputSuperElement(body, position, mesh.tip))

    return Peer(name, mbs, tip, sensor=sensor)
