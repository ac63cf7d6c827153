"""Joints, their coordinates and their rows as flat arrays: what the compiled kernels read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.linalg.table import Table

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Columns of LiaisonTable.joint, .coordinate and .end.
FIRST, SECOND = 0, 1
COORDINATE_JOINT, COORDINATE_KIND, COORDINATE_AXIS = 0, 1, 2
END_ATTACHMENT, END_SEGMENT = 0, 1

# Kinds of coordinates: translation along an axis of the first end; rotation about an axis of the first, or of
# the second end (universal joint); a component of the rotation vector (spherical joint); the parameter of the curve's
# point nearest to the second end, or where the second end's face touches the curve (the axis column is the curve).
TRANSLATION, ROTATION, ROTATION_SECOND, ROTATION_VECTOR, CURVE_POINT, CURVE_FACE = 0, 1, 2, 3, 4, 5

# Columns of LiaisonTable.row.
ROW_KIND, ROW_JOINT, ROW_FIRST, ROW_SECOND, ROW_OWNER, ROW_HOLONOMIC, ROW_ANGULAR = 0, 1, 2, 3, 4, 5, 6

# Kinds of rows, and what ROW_FIRST and ROW_SECOND are.
OFFSET = 0  # axis k of the first: position of the second end along it
PRODUCT = 1  # axes k, l: scalar product of axis k of the first with axis l of the second
TWIST = 2  # axes k, l: (k of first)·(l of second) − (l of first)·(k of second), constant-velocity joint
RELATION = 3  # start in `integers`, number of coordinates: a function of joint coordinates and time
RATE_RELATION = 4  # the same of the coordinates' rates, linear in them
DISTANCE = 5  # function: distance of the ends as a function of time
ROLL = 6  # axis k of the first (z: height), start in `data`: radius, side; of a disc about the second's z axis
ROLL_SPHERE = 7  # the same of a sphere
BLADE = 8  # axis k of the second: sideways velocity of a knife edge
CURVE = 9  # 0 or 1: which normal; coordinate: point on a curve
CAM = 10  # start in `data`: signed radius; coordinate: roller or point on a cam
CAM_FACE = 11  # unused; coordinate: flat face (normal: z axis of the second) on a cam
SURFACE = 12  # function F, or minus one minus the start of a spline in `data`: point on a surface
PFAFFIAN = 13  # start in `integers`: sum of functions of time, positions and rotations times velocities
CALLBACK = 14  # start in `integers`, number of the row among those of the function

JETS = 12  # where in the scratch room the jets of functions' variables start

SPECIAL_COORDINATES, SPECIAL_ROWS = 0, 1  # places in LiaisonTable.special

# Columns of LiaisonTable.curve.
CURVE_FUNCTION, CURVE_DATA, CURVE_PIECES, CURVE_CLOSED = 0, 1, 2, 3


@dataclass(frozen=True, eq=False)
class LiaisonTable(Table):
    """Constants of all joints and rows. j joints, c coordinates, r rows, e ends of rows.

    joint (j, 2): attachments of first and second; frame (j, 2, 3, 3): the joint's axes as columns, in the
        attachments' axes, on first and on second.
    coordinate (c, 3): joint, kind, axis (or curve).
    row (r, 7): kind, joint, two integers by kind, owner (the liaison that it belongs to: a driver's row acts between
        its joint's ends but is the driver's), holonomic (1: it has a position residual), angular (1: residuals in rad).
    end_start (r + 1,), end (e, 2): the attachments that a row acts on, and where the coefficients on each one's body
        start in the flat array A.
    incidence_start (b + 1,), incidence (x, 2): row and start in A of every end on each body.
    skyline_first (r,): first row coupled with row i (an envelope); skyline_start (r + 1,).
    function_start (f + 1,), function_codes, function_values: functions of time and other variables, postfix.
    curve (k, 4): first of three functions (or −1), start in `data`, number of spline pieces, closed.
    measured: coordinates that are evaluated with the rows, all or those that rows need.
    special (2,): addresses of `special.special_coordinates` and `special_rows`, 0 where nothing needs them.
    integers, data: what rows and curves need beyond that; see `liaisons` where they are read.
    """

    joint: IntArray
    frame: Array
    coordinate: IntArray
    row: IntArray
    end_start: IntArray
    end: IntArray
    incidence_start: IntArray
    incidence: IntArray
    skyline_first: IntArray
    skyline_start: IntArray
    function_start: IntArray
    function_codes: IntArray
    function_values: Array
    curve: IntArray
    measured: IntArray
    special: IntArray
    integers: IntArray
    data: Array


@dataclass(frozen=True, eq=False)
class LiaisonState(Table):
    """Values of all rows at one state.

    A (flat): coefficients on the bodies' small coordinates (Eq. T7). position, velocity, acceleration (r,):
    Φ, A v + b, A v̇ + γ. rhs (r,): b, for the power of driven rows. wrench (e, 6): the row's coefficients on the
    velocity and angular velocity of each of its ends, global components.
    coordinate (c, 3): joint coordinates, unwrapped, with rate and acceleration. coordinate_wrench (c, 2, 6): the rate's
    coefficients on the twists of first and second. previous (c,): the value that unwrapping starts from.
    scratch (16 or more, 3): room for kernels, of which rows of functions use those from JETS on.
    """

    A: Array
    position: Array
    velocity: Array
    acceleration: Array
    rhs: Array
    wrench: Array
    coordinate: Array
    coordinate_wrench: Array
    previous: Array
    scratch: Array
