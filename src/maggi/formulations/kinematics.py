"""Where bodies, mass points and markers are and how they move, in Taylor arithmetic (Eq. T1; paper (5))."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maggi.model.bodies import GivenMotion

from .bodies import Marker, PointBody
from .programs import at_time
from .taylor import SKEW, Taylor, constant, cosine, partial_rotations, product, rotation_matrix, sine, stack

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BodyState:
    """One body's part in the unknowns and in the state.

    start : place of its first velocity. origin (3,), rotation (3, 3): of its frame, global. e (n,): elastic
    coordinates. v (6 + n,): twist (v, ω) of the frame in body axes, and ė. frame_rate (6,): v̇ of a frame that moves as
    in another run; None for others.
    """

    start: int
    origin: Array
    rotation: Array
    e: Array
    v: Array
    frame_rate: Array | None = None

    @property
    def size(self) -> int:
        """Number of velocities."""
        return len(self.v)


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame that moves with a body: position (3,) and axes (3, 3) as columns, both global."""

    body: str
    position: Taylor
    axes: Taylor

    def axis(self, k: int) -> Taylor:
        """Axis k, a unit vector."""
        return self.axes[:, k]


@dataclass(frozen=True, eq=False)
class MovingBody:
    """A body's frame and its elastic coordinates e (n,) in time."""

    frame: Frame
    e: Taylor


GROUND = MovingBody(Frame("ground", constant(np.zeros(3)), constant(np.eye(3))), constant(np.zeros(0)))


def moving(body: PointBody, state: BodyState, t: float, order: int, first: int, count: int) -> MovingBody:
    """A body's motion in `count` unknowns, of which its own begin at `first`.

    order 2: the unknowns are v̇; order 1: they are v, and the state's velocities are not looked at. The six of a
    prescribed frame are no unknowns.
    """
    return MovingBody(_frame(body, state, t, order, first, count), _elastic(state, order, first + 6, count))


def _frame(body: PointBody, state: BodyState, t: float, order: int, first: int, count: int) -> Frame:
    if body.motion is not None:
        return _given(body, body.motion, t, order)
    R = state.rotation
    v, w = state.v[:3], state.v[3:6]
    position, axes = np.zeros((1 + count, 3)), np.zeros((1 + count, 3, 3))
    given = state.frame_rate
    if given is None:
        position[1 + first : 4 + first] = R.T
        axes[4 + first : 7 + first] = R @ SKEW
    spin = np.einsum("k,kij->ij", w, SKEW)
    if order == 1:
        if given is not None:
            position[0], axes[0] = R @ v, R @ spin
        return Frame(body.name, Taylor((state.origin,), position), Taylor((R,), axes))
    rate = np.zeros(6) if given is None else given
    position[0] = R @ (rate[:3] + np.cross(w, v))
    axes[0] = R @ (np.einsum("k,kij->ij", rate[3:], SKEW) + spin @ spin)
    return Frame(body.name, Taylor((state.origin, R @ v), position), Taylor((R, R @ spin), axes))


def _given(body: PointBody, motion: GivenMotion, t: float, order: int) -> Frame:
    """A frame prescribed by functions of time: ``origin(t)``, ``rotation · exp(angle(t) axis~)``."""
    position = constant(body.origin, order)
    if motion.origin is not None:
        position = stack([at_time(component, t, order) for component in motion.origin])
    if motion.angle is None or motion.axis is None:
        return Frame(body.name, position, constant(body.rotation, order))
    angle = at_time(motion.angle, t, order)
    start = float(at_time(motion.angle, 0.0, order).value)
    axis = np.array(motion.axis) / np.linalg.norm(motion.axis)
    matrix = np.einsum("k,kij->ij", axis, SKEW)
    turned = angle - start  # the body's rotation is that at t = 0
    turn = (
        product(",ij->ij", sine(turned), matrix)
        + product(",ij->ij", -cosine(turned) + 1.0, matrix @ matrix)
        + np.eye(3)
    )
    return Frame(body.name, position, product("jk,ij->ik", turn, body.rotation))


def _elastic(state: BodyState, order: int, first: int, count: int) -> Taylor:
    n = len(state.e)
    highest = np.zeros((1 + count, n))
    highest[1 + first : 1 + first + n] = np.eye(n)
    return Taylor((state.e, state.v[6:])[:order], highest)


def point_positions(body: PointBody, motion: MovingBody) -> Taylor:
    """Positions (p, 3) of a body's mass points: ``r_O + R (X + N e)``."""
    local = product("a,pia->pi", motion.e, body.shapes) + body.points
    turned = product("ij,pj->pi", motion.frame.axes, local)
    return turned + product("i,p->pi", motion.frame.position, np.ones(len(body.points)))


def marker_frame(marker: Marker, motion: MovingBody) -> Frame:
    """Where a marker is: displaced by ``d = T e`` and turned by ``exp(θ̃)``, θ = Ψ e, in its body."""
    frame = motion.frame
    local = product("a,ia->i", motion.e, marker.translation) + marker.point
    position = frame.position + product("ij,j->i", frame.axes, local)
    axes = frame.axes
    if marker.rotation.any():
        axes = product("ij,jk->ik", axes, rotation_matrix(product("a,ia->i", motion.e, marker.rotation)))
    return Frame(marker.body, position, product("ij,jk->ik", axes, marker.axes))


def partials(frame: Frame, count: int) -> tuple[Array, Array]:
    """Slopes of a frame's velocity and angular velocity to all `count` velocities, (count, 3) each, global."""
    velocity, rotation = np.zeros((count, 3)), np.zeros((count, 3))
    for rows, slopes in ((velocity, frame.position.highest[1:]), (rotation, partial_rotations(frame.axes))):
        rows[: len(slopes)] = slopes
    return velocity, rotation
