"""One of every liaison between two bodies, and states that hold it: for property tests over the whole joint library."""

from dataclasses import dataclass, replace

import numpy as np
from motions import mesh_body, rigid_body, ritz_body

from maggi.liaisons.registry import JOINTS
from maggi.model.curves import ExpressionCurve, ExpressionSurface, SplineCurve, SplineSurface
from maggi.model.expression import expression, formula
from maggi.model.geometry import Pose
from maggi.model.joints import (
    Cam,
    Coupler,
    Distance,
    Driver,
    End,
    Joint,
    JointCoordinate,
    KnifeEdge,
    Pfaffian,
    PfaffianFunction,
    PfaffianRow,
    Plane,
    PointOnCurve,
    PointOnSurface,
    RollingDisc,
    RollingSphere,
)
from maggi.model.model import Model
from maggi.projection.maggi import restore
from maggi.stepping.allocate import copy_motion
from maggi.stepping.kernels import move
from maggi.system.build import build_system
from maggi.system.dense import dense_rows, velocity_scale

MAKE = {
    "rigid": lambda rng: rigid_body(rng, p=(0.3, -0.2, 0.5)),
    "ritz": lambda rng: ritz_body(rng, 4, p=(0.3, 0.1, -0.4)),
    "mesh": lambda rng: mesh_body(rng),
}
ENDS = [("rigid", "rigid"), ("ground", "rigid"), ("ritz", "rigid"), ("rigid", "mesh")]
PITCH = 0.7
FUNCTION = "0.3*sin(2*t) + 0.1*t*t - 0.2*t"


@dataclass(frozen=True)
class Pair:
    """Two ends and random directions to place a liaison by."""

    first: End
    second: End
    rng: np.random.Generator

    def direction(self):
        return tuple(self.rng.normal(size=3))


def _joint(kind):
    def make(pair):
        axes = np.linalg.qr(pair.rng.normal(size=(3, 3)))[0]
        both = None if kind == "constant-velocity" else (tuple(axes[1]), tuple(axes[2]))
        return {"one": Joint(kind, pair.first, pair.second, axis=tuple(axes[0]), axes=both, pitch=PITCH)}

    return make


def _driven(quantity):
    def make(pair):
        joint = Joint(
            "cylindrical" if quantity != "speed" else "revolute", pair.first, pair.second, axis=pair.direction()
        )
        return {"one": joint, "driver": Driver("one", quantity, expression(FUNCTION))}

    return make


def _coupled(text, rates=False):
    def make(pair):
        joint = Joint("cylindrical", pair.first, pair.second, axis=pair.direction())
        coordinates = {"a": JointCoordinate("one", "angle"), "x": JointCoordinate("one", "displacement")}
        return {"one": joint, "coupler": Coupler("coupler", coordinates, formula(text, ("a", "t", "x")), rates)}

    return make


def _spline(closed):
    angles = np.linspace(0.0, 2.0 * np.pi, 9)[:-1]
    points = [(2 * np.cos(a), 2 * np.sin(a), 0.2 * np.sin(2 * a)) for a in angles]
    return SplineCurve(tuple(points), closed)


HELIX = ExpressionCurve(formula("cos(s)", ("s",)), formula("sin(s)", ("s",)), formula("0.3*s", ("s",)), (-20.0, 20.0))


_RADIUS = "(0.5 + 0.05*cos(s) + 0.02*sin(2*s))"
OVAL = ExpressionCurve(
    formula(f"{_RADIUS}*cos(s)", ("s",)),
    formula(f"{_RADIUS}*sin(s)", ("s",)),
    formula(0.0, ("s",)),
    (-np.pi, np.pi),
    closed=True,
)


def _cam(radius=0.0, face=False):
    """A cam in the first's xy plane; the follower's point is near its rim."""

    def make(pair):
        return {"one": Cam(pair.first, pair.second, OVAL, (0.0, 0.0, 1.0), radius, (0.6, 0.8, 0.0) if face else None)}

    return make


def _surface(surface):
    return lambda pair: {"one": PointOnSurface(pair.first, pair.second, surface)}


def _grid():
    x, y = np.linspace(-9.0, 9.0, 10), np.linspace(-8.0, 8.0, 9)
    z = 0.3 * np.sin(0.5 * x)[:, None] * np.cos(0.4 * y)
    return SplineSurface(tuple(x), tuple(y), tuple(map(tuple, z)))


def _pfaffian(pair):
    names = ("t", "p.x", "p.r12", "q.z", "q.r31")
    row = PfaffianRow(
        {
            ("p", "v.x"): formula("1 + p.x*q.r31", names),
            ("q", "w.y"): formula("cos(t) + p.r12", names),
            ("q", "v.z"): formula("q.z**2", names),
        },
        formula("0.3*sin(t) + p.x", names),
    )
    return {
        "one": Pfaffian({"p": pair.first, "q": pair.second}, (row, PfaffianRow({("q", "w.x"): formula("1", names)})))
    }


def _function(pair):
    def rows(t, position, rotation):
        A = np.zeros((2, 2, 6))
        A[0, 1, :3] = rotation[0][:, 1]
        A[0, 0, 3:] = np.cross(position[1], rotation[1][:, 0])
        A[1, 0, 0] = np.sin(t) + position[0, 2]
        A[1, 1, 5] = 1.0
        return A, np.array([np.cos(2 * t), rotation[1][0, 0]])

    return {"one": PfaffianFunction({"p": pair.first, "q": pair.second}, 2, rows)}


LIAISONS = {
    **{kind: _joint(kind) for kind in JOINTS if kind != "free"},
    "driven angle": _driven("angle"),
    "driven displacement": _driven("displacement"),
    "driven speed": _driven("speed"),
    "linear coupler": _coupled("2*a - 0.5*x"),
    "coupler": _coupled("a + 0.3*sin(x*a) - x*x + 0.1*t*a"),
    "rate coupler": _coupled("2*a - (1 + 0.2*t)*x + sin(t)", rates=True),
    "distance": lambda pair: {"one": Distance(pair.first, pair.second)},
    "moving distance": lambda pair: {"one": Distance(pair.first, pair.second, expression("1.5 + 0.2*sin(3*t)"))},
    "point on a closed spline": lambda pair: {"one": PointOnCurve(pair.first, pair.second, _spline(True))},
    "point on a helix": lambda pair: {"one": PointOnCurve(pair.first, pair.second, HELIX)},
    "point on a surface": _surface(
        ExpressionSurface(formula("x**2 + 2*y**2 + 0.5*z**2 + 0.1*x*y*z - 3", ("x", "y", "z")))
    ),
    "point on a spline surface": _surface(_grid()),
    "cam with point": _cam(),
    "cam with roller": _cam(radius=0.2),
    "cam with flat face": _cam(face=True),
    "rolling disc": lambda pair: {
        "one": RollingDisc(pair.first, pair.second, 0.7, pair.direction(), Plane(pair.direction(), pair.direction()))
    },
    "rolling sphere": lambda pair: {
        "one": RollingSphere(pair.first, pair.second, 0.7, Plane(pair.direction(), pair.direction()))
    },
    "knife edge": lambda pair: {"one": KnifeEdge(pair.first, pair.second, pair.direction(), pair.direction())},
    "pfaffian": _pfaffian,
    "pfaffian function": _function,
}


def pair_with(name, ends, seed):
    """A system of two bodies, or ground and a body, at random poses with one liaison of the zoo."""
    rng = np.random.default_rng(seed)
    bodies = {f"{end}{i}": MAKE[end](rng) for i, end in enumerate(ends) if end != "ground"}
    first, second = (End("ground") if end == "ground" else End(f"{end}{i}", "p") for i, end in enumerate(ends))
    if name.startswith("cam"):
        # profiles are in the axes of their body, the cam's axis is global: let them be the same
        bodies = {key: _upright(body) if key.endswith("0") else body for key, body in bodies.items()}
    return build_system(Model(bodies, LIAISONS[name](Pair(first, second, rng))))


def _upright(body):
    return replace(body, pose=Pose(body.pose.origin))


def unknown(system):
    """Which small coordinates the liaisons may move: all but those of prescribed frames."""
    bodies = system.bodies
    frames = [
        np.arange(bodies.offset[b], bodies.offset[b] + 6) for b in range(1, bodies.kind.size) if not bodies.floating[b]
    ]
    held = np.concatenate([np.empty(0, dtype=np.int64), *frames])
    return np.setdiff1d(np.arange(system.coordinates), held)


def held_state(system, seed, t, speed=1.0, spread=0.2):
    """A random state that holds every liaison at time t: positions, velocities and accelerations; or None.

    From the initial pose a random small step, back to Φ = 0, then random velocities and accelerations made admissible.
    """
    rng = np.random.default_rng(seed)
    free = unknown(system)
    state = copy_motion(system.start)
    state.v[:] = 0.0
    scale = velocity_scale(system)[free]
    previous = np.zeros(len(system.liaisons.coordinate))

    def moved(step):
        full = np.zeros(system.coordinates)
        full[free] = step
        move(system.bodies, state, full, state)
        rows = dense_rows(system, state, t, previous)
        return rows.A[system.holonomic][:, free], rows.position[system.holonomic]

    start = np.zeros(system.coordinates)
    start[free] = spread * rng.normal(size=free.size)
    move(system.bodies, state, start, state)
    if restore(moved, np.diag(scale**2), scale, 1e-13, attempts=40) > 1e-13:
        return None
    rows = dense_rows(system, state, t, previous)
    A = rows.A[:, free]
    v = speed * rng.normal(size=free.size)
    state.v[free] = v - np.linalg.lstsq(A, A @ v + rows.b, rcond=1e-12)[0]
    vd = speed * rng.normal(size=free.size)
    state.vd[free] = vd
    rows = dense_rows(system, state, t, previous)
    state.vd[free] = vd - np.linalg.lstsq(A, rows.acceleration, rcond=1e-12)[0]
    return state


def along(system, state, dt):
    """The state a little later (or earlier) on the curve with these velocities and accelerations."""
    later = copy_motion(state)
    move(system.bodies, state, dt * state.v + 0.5 * dt * dt * state.vd, later)
    later.v[:] = state.v + dt * state.vd
    return later
