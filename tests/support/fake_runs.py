"""Runs with known answers that need no solver: a slider-crank whose motion and bending are plain formulas."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields

import numpy as np

from maggi.analyses.outline import Outline
from maggi.analyses.recorder import BodyLayout, JointLayout, Layout, Recorder, Rows
from maggi.analyses.scene import Scene, SceneAttachment, SceneBody, SceneJoint

CRANK, ROD, SPEED = 0.05, 0.16, 200.0  # m, m, rad/s
BENDING, TILT = 4e-4, 1e-3  # amplitude (m) and slope of the rod's made-up displacement
FORCE = 750.0  # N, largest crankpin force
MODEL = "maggi: 1\ntitle: Fake slider-crank\n"
HALF_HEIGHT, HALF_WIDTH = 0.008, 0.004
GRAVITY = (0.0, 0.0, -9.81)
# A square on ground beside the clamp, and a line across it on the blade.
OUTLINE = (
    np.array([[0.01, 0.1, 0.01], [-0.01, 0.1, 0.01], [-0.01, 0.1, -0.01], [0.01, 0.1, -0.01], [0.01, 0.1, 0.01]]),
    np.array([[-0.02, 0.0, 0.0], [0.02, 0.0, 0.0]]),
)


def box_mesh(cells: tuple[int, int, int] = (32, 2, 3)) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """A slender hex8 box along x, centred in y and z: nodes (n, 3), cells (c, 8)."""
    axes = [
        np.linspace(0.0, ROD, cells[0] + 1),
        np.linspace(-HALF_WIDTH, HALF_WIDTH, cells[1] + 1),
        np.linspace(-HALF_HEIGHT, HALF_HEIGHT, cells[2] + 1),
    ]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    place = np.arange(len(nodes)).reshape([n + 1 for n in cells])
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    hexes = [place[i : i + cells[0], j : j + cells[1], k : k + cells[2]].ravel() for i, j, k in corners]
    return nodes, {"hex8": np.column_stack(hexes)}


def layout(rows: int) -> Layout:
    nodes, cells = box_mesh()
    return Layout(
        bodies=(
            BodyLayout("crank", "rigid", ("pin",), np.array([[CRANK, 0.0, 0.0]])),
            BodyLayout("rod", "mesh", ("big_end", "small_end"), np.array([[0.0] * 3, [ROD, 0.0, 0.0]]), nodes, cells),
            BodyLayout("piston", "rigid", ("pin",), np.zeros((1, 3))),
            BodyLayout("blade", "ritz", (), np.zeros((0, 3)), modes=2),
        ),
        joints=(
            JointLayout("bearing", "revolute", "ground", "crank", ("rad",)),
            JointLayout("crankpin", "revolute", "crank.pin", "rod.big_end", ("rad",)),
            JointLayout("wristpin", "cylindrical", "rod.small_end", "piston.pin", ("m", "rad")),
            JointLayout("motor", "driver", "ground", "crank", ("rad",)),
            JointLayout("clamp", "weld", "ground", "blade", (), Outline(*OUTLINE)),
        ),
        rows=rows,
        attributes={"title": "Fake slider-crank", "model": MODEL},
        gravity=GRAVITY,
    )


@dataclass(frozen=True, eq=False)
class Row:
    """One row: `Rows` without the index of time."""

    time: float
    origin: np.ndarray
    rotation: np.ndarray
    position: np.ndarray
    attachment_rotation: np.ndarray
    velocity: np.ndarray
    angular_velocity: np.ndarray
    displacement: tuple[np.ndarray, ...]
    modal: tuple[np.ndarray, ...]
    joint_position: np.ndarray
    force: np.ndarray
    torque: np.ndarray
    unique: np.ndarray
    coordinate: tuple[np.ndarray, ...]
    energy: np.ndarray
    residuals: np.ndarray
    iterations: int

    def rows(self) -> Rows:
        """By itself."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return Rows(
            **{
                name: tuple(part[None] for part in value) if isinstance(value, tuple) else np.array([value])
                for name, value in values.items()
            }
        )


def row(t: float, iterations: int = 1) -> Row:
    """The state at t; plane x-z, turning about y."""
    nodes, _ = box_mesh()
    a = SPEED * t
    pin = CRANK * np.array([math.cos(a), 0.0, math.sin(a)])
    b = -math.asin(CRANK * math.sin(a) / ROD)  # the rod's angle in the x-z plane
    piston = np.array([pin[0] + ROD * math.cos(b), 0.0, 0.0])
    sway = math.sin(a)
    x, z = nodes[:, 0], nodes[:, 2]
    u = np.zeros_like(nodes)
    u[:, 2] = BENDING * sway * np.sin(np.pi * x / ROD) + TILT * sway * x
    u[:, 0] = -z * BENDING * sway * np.pi / ROD * np.cos(np.pi * x / ROD)
    # The frame turns back by the tilt, so that the small end stays where the mechanism wants it (to first order).
    turn = _about_y(b)
    ends = [nodes[x == place].mean(axis=0) + u[x == place].mean(axis=0) for place in (0.0, ROD)]
    kinetic, strain = 20.0 + 5.0 * math.cos(2 * a), 0.5 * sway**2
    gravity, dissipated = 0.1 * math.sin(a), 2.0 * t
    force = np.array([FORCE * math.cos(a), 0.0, FORCE * math.sin(a) * 0.4])
    rotation = np.stack([_about_y(a), turn, np.eye(3), np.eye(3)])
    return Row(
        time=t,
        origin=np.stack([np.zeros(3), pin, piston, np.array([0.0, 0.1, 0.0])]),
        rotation=rotation,
        position=np.stack([pin, pin + turn @ ends[0], pin + turn @ ends[1], piston]),
        attachment_rotation=rotation[[0, 1, 1, 2]],
        velocity=SPEED * np.stack([np.cross([0, -1, 0], pin)] * 4),
        angular_velocity=np.tile([0.0, -SPEED, 0.0], (4, 1)),
        displacement=(u,),
        modal=(np.array([1e-3 * sway, 1e-4 * sway**2]),),
        joint_position=np.stack([np.zeros(3), pin, piston, np.zeros(3), np.array([0.0, 0.1, 0.0])]),
        force=np.stack([1.2 * force, force, 0.8 * force, np.zeros(3), 0.1 * force]),
        torque=np.stack([np.zeros(3), np.zeros(3), np.zeros(3), [0.0, 12.0 * sway, 0.0], np.zeros(3)]),
        unique=np.ones(5, dtype=np.int64),
        coordinate=(np.array([a]), np.array([b - a]), np.array([0.01 * sway, -b]), np.array([a]), np.zeros(0)),
        energy=np.array([kinetic, strain, gravity, dissipated, kinetic + strain + gravity + dissipated - 25.0]),
        residuals=np.array([2e-16, 4e-13, 4e-9]) * (1.0 + 0.5 * sway),
        iterations=iterations,
    )


def _about_y(angle: float) -> np.ndarray:
    """Turns x towards z."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])


def times(rows: int, turns: float = 2.0) -> np.ndarray:
    return np.linspace(0.0, turns * 2 * math.pi / SPEED, rows)


def rows(count: int, turns: float = 2.0) -> Iterator[Row]:
    return (row(float(t)) for t in times(count, turns))


def record(recorder: Recorder, count: int = 101, turns: float = 2.0, status: str = "complete") -> None:
    recorder.begin(layout(count))
    for one in rows(count, turns):
        recorder.write(one.rows())
    recorder.end(status)


def scene() -> Scene:
    """The same mechanism before its run."""
    start, nodes_cells = row(0.4 / SPEED), box_mesh()
    names = ("crank", "rod", "piston")
    bodies = tuple(
        SceneBody(
            name,
            "mesh" if name == "rod" else "rigid",
            start.origin[i],
            start.rotation[i],
            start.origin[i] + start.rotation[i] @ np.array([0.02, 0.0, 0.0]) * (name == "crank"),
            *(nodes_cells if name == "rod" else (None, None)),
        )
        for i, name in enumerate(names)
    )
    owners = [("crank", "pin"), ("rod", "big_end"), ("rod", "small_end"), ("piston", "pin")]
    attachments = tuple(SceneAttachment(*owner, start.position[i]) for i, owner in enumerate(owners))
    y, x = np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0])
    joints = (
        SceneJoint("bearing", "revolute", "ground", "crank", np.zeros(3), y),
        SceneJoint("crankpin", "revolute", "crank.pin", "rod.big_end", start.position[0], y),
        SceneJoint("wristpin", "spherical", "rod.small_end", "piston.pin", start.position[3], None),
        SceneJoint("guide", "prismatic", "ground", "piston", start.position[3], x),
        SceneJoint("motor", "driver", "ground", "crank", np.zeros(3), y),
    )
    return Scene("Fake slider-crank", np.array(GRAVITY), bodies, attachments, joints)
