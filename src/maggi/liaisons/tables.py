"""Joints, their coordinates and their rows as flat arrays: what the compiled kernels read."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Kinds of rows. Position of the second end along axis k of the first; scalar product of axis k of the first
# with axis l of the second; a coordinate as a function of time; a coordinate's rate as a function of time.
OFFSET, PRODUCT, DRIVEN, DRIVEN_RATE = 0, 1, 2, 3

# Kinds of coordinates: translation along an axis of the first end; rotation about an axis of the first, or of
# the second end (universal joint); a component of the rotation vector (spherical joint).
TRANSLATION, ROTATION, ROTATION_SECOND, ROTATION_VECTOR = 0, 1, 2, 3


class LiaisonTable(NamedTuple):
    """Constants of all joints and rows. j joints, c coordinates, r rows, a attachments.

    first, second (j,): attachments; first_frame, second_frame (j, 3, 3): the joint's axes as columns, in the
    attachments' axes; they coincide in the initial pose.
    coordinate_joint, coordinate_kind, coordinate_axis (c,).
    row_kind (r,); row_joint (r,): the joint it acts between; row_first, row_second (r,): axes k and l, or for
    driven rows row_first is the coordinate and row_second the function; row_owner (r,): the liaison that it
    belongs to (a driver's row acts between its joint's ends but is the driver's).
    holonomic (r,): 1 where the row has a position residual.
    segment (r, 2): where the coefficients on the two bodies' small coordinates start in the flat array A.
    incidence_start (b + 1,), incidence_row, incidence_segment: the rows that touch each body.
    skyline_first (r,): first row coupled with row i (an envelope); skyline_start (r + 1,).
    function_start (f + 1,), function_codes, function_values: the functions of time, postfix.
    """

    first: IntArray
    second: IntArray
    first_frame: Array
    second_frame: Array
    coordinate_joint: IntArray
    coordinate_kind: IntArray
    coordinate_axis: IntArray
    row_kind: IntArray
    row_joint: IntArray
    row_first: IntArray
    row_second: IntArray
    row_owner: IntArray
    holonomic: IntArray
    segment: IntArray
    incidence_start: IntArray
    incidence_row: IntArray
    incidence_segment: IntArray
    skyline_first: IntArray
    skyline_start: IntArray
    function_start: IntArray
    function_codes: IntArray
    function_values: Array


class LiaisonState(NamedTuple):
    """Values of all rows at one state.

    A (flat): coefficients on the bodies' small coordinates (Eq. T7). position, velocity, acceleration (r,):
    Φ, A v + b, A v̇ + γ. rhs (r,): b, for the power of driven rows. force, moment (r, 2, 3): the row's
    coefficients on the twists of its two ends, global components.
    coordinate (c,): unwrapped joint coordinates; rate (c,); previous (c,): the value that unwrapping starts from.
    """

    A: Array
    position: Array
    velocity: Array
    acceleration: Array
    rhs: Array
    force: Array
    moment: Array
    coordinate: Array
    rate: Array
    previous: Array
