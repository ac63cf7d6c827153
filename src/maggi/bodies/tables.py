"""Bodies and attachments as flat arrays: what the compiled kernels read.

Every body b, whatever its kind, has the *small coordinates* ``(t, ė)`` at ``offset[b] : offset[b + 1]``: the
twist of its frame ``t = (v, ω)`` (body axes, six slots even where the frame is prescribed) and the rates of
its elastic coordinates e: none for a rigid body, the shape-function amplitudes of a Ritz body, the six
displacements (d, θ) of each attachment of a mesh body. Body 0 is ground.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.linalg.table import Table

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

FIXED, RIGID, RITZ, MESH = 0, 1, 2, 3


@dataclass(frozen=True, eq=False)
class BodyTable(Table):
    """Constants of all bodies. b bodies, n small coordinates, a attachments.

    kind (b,): FIXED, RIGID, RITZ or MESH. floating (b,): 1 where the frame's twist is unknown. offset (b + 1,).
    mass (b,) kg; S0 (b, 3), J0 (b, 3, 3) first moment and inertia about the frame's origin, undeformed.
    block (b + 1,): where a body's square matrix over its small coordinates starts in a flat array.
    ritz (b,): where a Ritz body's constants start, in units of one coordinate (m at ``ritz_square[b]``).
    attachment_body (a,), attachment_point (a, 3) body axes; psi_offset (a,): start of Ψ (6, n_e) in `psi`.
    attachment_axes (a, 3, 3): an attachment's axes as columns in the body's where attachment_turned (a,) is 1: those of
    rigid bodies whose frame has been put into a joint (`projection.relative_system`).
    """

    kind: IntArray
    floating: IntArray
    offset: IntArray
    block: IntArray
    mass: Array
    S0: Array
    J0: Array
    ritz: IntArray
    ritz_square: IntArray
    m: Array
    k: Array
    D: Array
    m_O: Array
    G: Array
    H: Array
    s: Array
    s2: Array
    attachment_body: IntArray
    attachment_point: Array
    attachment_axes: Array
    attachment_turned: IntArray
    psi_offset: IntArray
    psi: Array


@dataclass(frozen=True, eq=False)
class MotionState(Table):
    """Positions, velocities and accelerations of all bodies at one instant.

    origin (b, 3) global; rotation (b, 3, 3) body to global; e (n,) elastic coordinates (frame slots unused);
    v (n,) velocities (t, ė); vd (n,) their rates.
    """

    origin: Array
    rotation: Array
    e: Array
    v: Array
    vd: Array


@dataclass(frozen=True, eq=False)
class AttachmentState(Table):
    """Motion of all attachments, global components.

    position (a, 3), rotation (a, 3, 3), velocity, angular_velocity, acceleration, angular_acceleration (a, 3);
    arm (a, 3): from the frame's origin to the deformed attachment, body axes; tangent (a, 3, 3): T_l(θ).
    scratch (3, 18): room for kernels.
    """

    position: Array
    rotation: Array
    velocity: Array
    angular_velocity: Array
    acceleration: Array
    angular_acceleration: Array
    arm: Array
    tangent: Array
    scratch: Array
