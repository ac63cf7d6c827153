"""Computed-torque control of a two-link arm, with rigid and with elastic links: tracking errors, and a picture of them.

Joint angles are to follow smooth functions of time; torques come from inverse dynamics by Maggi's projection.

1. Rigid links, and the controller knows them: errors obey ë + 2ω ė + ω² e = 0 and stay at the integrator's tolerance.
2. Elastic links, and the controller takes them as rigid: it sees the joint angles only.
3. Elastic links, and the controller knows them and their state (feedback linearisation): joints follow exactly again,
   and the links bend as the motion makes them.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import maggi
from maggi.analyses.control import ControlledOde, Measured, computed_torque
from maggi.analyses.initial import initial_motion
from maggi.analyses.inverse_dynamics import coordinate_numbers, inverse_dynamics
from maggi.analyses.ode_solution import solve
from maggi.analyses.quasi_static import quasi_static_start
from maggi.bodies.tables import MotionState
from maggi.integrators.radau_iia import RadauIIA
from maggi.linalg.jets import sample
from maggi.model import Driver, Model, expression
from maggi.stepping.allocate import copy_motion
from maggi.system.build import build_system
from maggi.system.system import System

JOINTS = ("shoulder", "elbow")
WANTED = (expression("1.2*smoothstep(t, 0.05, 0.8)"), expression("-1.5*smoothstep(t, 0.05, 0.8)"))
OMEGA = 40.0  # rad/s, of the error's equation
DURATION = 1.2


def wanted(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angles, rates and accelerations at time t."""
    jets = np.array([sample(function, [t])[0] for function in WANTED])
    return jets[:, 0], jets[:, 1], jets[:, 2]


def rigid_state(system: System, angles: np.ndarray, rates: np.ndarray) -> MotionState:
    """The rigid arm with given joint angles and rates (axes −y)."""
    motion = copy_motion(system.start)
    origin, total, velocity = np.zeros(3), 0.0, np.zeros(3)
    spin = 0.0
    for k, name in enumerate(("upper", "lower")):
        total, spin = total + angles[k], spin + rates[k]
        R = np.array([[np.cos(total), 0.0, -np.sin(total)], [0.0, 1.0, 0.0], [np.sin(total), 0.0, np.cos(total)]])
        b = system.body(name).index
        o = system.bodies.offset[b]
        motion.origin[b], motion.rotation[b] = origin, R
        motion.v[o : o + 3], motion.v[o + 3 : o + 6] = R.T @ velocity, [0.0, -spin, 0.0]
        along = 0.8 * R[:, 0]
        velocity = velocity + np.cross([0.0, -spin, 0.0], along)
        origin = origin + along
    return _with_masses(system, motion)


def _with_masses(system: System, motion: MotionState) -> MotionState:
    """Point masses, which are bodies welded to attachments, moved along."""
    for entry in system.body_entries:
        if entry.visible:
            continue
        host, attachment = entry.name.split(".")[:2]
        b, h = entry.index, system.body(host).index
        place = next(a.index for a in system.attachment_entries if (a.body, a.name) == (host, attachment))
        x = system.bodies.attachment_point[place]
        p, o = system.bodies.offset[b], system.bodies.offset[h]
        motion.origin[b] = motion.origin[h] + motion.rotation[h] @ x
        motion.rotation[b] = motion.rotation[h]
        motion.v[p : p + 3] = motion.v[o : o + 3] + np.cross(motion.v[o + 3 : o + 6], x)
        motion.v[p + 3 : p + 6] = motion.v[o + 3 : o + 6]
    return motion


def sagging(model: Model, system: System) -> MotionState:
    """The elastic arm held at its initial angles, bent by its weight."""
    holding = {f"hold_{name}": Driver(name, "angle", expression(0.0)) for name in JOINTS}
    held = build_system(replace(model, joints={**model.joints, **holding}))
    motion = initial_motion(held, [])
    quasi_static_start(held, motion, [], 1e-3)
    return motion


def simulate(
    model: Model, rigid_controller: bool, duration: float = DURATION
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (n,), joint errors (n, 2) in rad and the tip's bending (n,) in m."""
    system = build_system(model)
    if rigid_controller:
        known = build_system(model, rigid=frozenset(model.bodies))

        def control(measured: Measured) -> np.ndarray:
            y, yd, ydd = wanted(measured.t)
            angles, rates = measured.coordinates[numbers], measured.rates[numbers]
            acceleration = ydd + 2.0 * OMEGA * (yd - rates) + OMEGA**2 * (y - angles)
            state = rigid_state(known, angles, rates)
            return inverse_dynamics(known, state, measured.t, JOINTS, JOINTS, acceleration).forces
    else:
        control = computed_torque(system, JOINTS, JOINTS, wanted, OMEGA**2, 2.0 * OMEGA)
    numbers = coordinate_numbers(system, JOINTS)
    elastic = bool(system.reduced)
    start = sagging(model, system) if elastic else None
    ode = ControlledOde(system, JOINTS, control, start)
    times = np.linspace(0.0, duration, 241)
    path = solve(ode, (0.0, duration), method=RadauIIA if elastic else "DOP853", rtol=1e-6, t_eval=times)
    errors = path.coordinates[:, numbers] - np.array([wanted(t)[0] for t in times])
    return times, errors, _bending(system, path)


def _bending(system: System, path: object) -> np.ndarray:
    """How far the tip is from where rigid links with these joint angles would have it (m)."""
    numbers = coordinate_numbers(system, JOINTS)
    angles = np.cumsum(path.coordinates[:, numbers], axis=1)
    rigid = 0.8 * np.stack([np.cos(angles[:, 0]), np.sin(angles[:, 0])]).T
    rigid = rigid + 0.6 * np.stack([np.cos(angles[:, 1]), np.sin(angles[:, 1])]).T
    mass = next(entry.index for entry in system.body_entries if entry.name.startswith("lower.tip"))
    return np.linalg.norm(path.origin[:, mass][:, [0, 2]] - rigid, axis=1)


def main() -> None:
    folder = Path(__file__).parent
    model = maggi.load(folder / "two_link_arm.yml")
    stiff = build_rigid(model)
    cases = {
        "rigid links": simulate(stiff, False),
        "elastic links, controller for rigid ones": simulate(model, True),
        "elastic links, controller for elastic ones": simulate(model, False),
    }
    print(f"{'largest error':<46}{'shoulder':>12}{'elbow':>12}{'bending':>12}")
    for name, (_, errors, bending) in cases.items():
        worst = np.abs(errors).max(axis=0)
        print(f"{name:<46}{worst[0]:>8.1e} rad{worst[1]:>8.1e} rad{bending.max():>10.1e} m")
    if len(sys.argv) > 1:
        draw(cases, sys.argv[1])


def build_rigid(model: Model) -> Model:
    """The same arm with links that do not bend: rigid bodies of the same mass, centre and inertia."""
    system = build_system(model, rigid=frozenset(model.bodies))
    bodies = {}
    for name, body in model.bodies.items():
        b = system.body(name).index
        mass = float(system.bodies.mass[b])
        center = system.bodies.S0[b] / mass
        inertia = system.bodies.J0[b] - mass * (center @ center * np.eye(3) - np.outer(center, center))
        points = [a for a in system.attachment_entries if a.body == name]
        attachments = {
            a.name: maggi.Attachment(
                at=tuple(system.bodies.attachment_point[a.index]), point_masses=body.attachments[a.name].point_masses
            )
            for a in points
        }
        bodies[name] = maggi.RigidBody(
            mass, tuple(center), tuple(map(tuple, inertia)), body.pose, attachments=attachments
        )
    return replace(model, bodies=bodies)


def draw(cases: dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]], path: str) -> None:
    """Tracking errors of both joints and the tip's bending over time."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 5.2), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    for (name, (t, errors, bending)), color in zip(cases.items(), ("#222222", "#c0392b", "#2471a3"), strict=True):
        above.semilogy(t[1:], np.maximum(np.abs(errors[1:]).max(axis=1), 1e-12), color=color, label=name)
        below.plot(t, 1e3 * bending, color=color)
    above.set_ylabel("tracking error [rad]")
    above.legend(frameon=False, fontsize=8, loc="center", bbox_to_anchor=(0.6, 0.6))
    below.set_ylabel("tip off by bending [mm]")
    below.set_xlabel("t [s]")
    for axes in (above, below):
        axes.spines[["top", "right"]].set_visible(False)
    FigureCanvasAgg(figure).print_figure(path, dpi=140)


if __name__ == "__main__":
    main()
