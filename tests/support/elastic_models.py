"""Small mechanisms with elastic parts, and their runs in memory."""

import numpy as np

from maggi.analyses.transient import run
from maggi.model import (
    Attachment,
    BeamMesh,
    BoxMesh,
    Driver,
    ElasticBody,
    End,
    Joint,
    Material,
    Model,
    NamedSet,
    Outputs,
    Pose,
    RigidBody,
    Section,
    expression,
)
from maggi.results.memory import MemoryRecorder

STEEL = Material(7850.0, 210e9, 0.3)
GRAVITY = (0.0, 0.0, -9.81)


def simulate(model, *, exact=False):
    """Results and summary of a run."""
    recorder = MemoryRecorder()
    summary = run(model, recorder, exact=exact)
    return recorder.results(), summary


def with_simulation(model, simulation, every=1):
    """The model with another simulation."""
    return Model(
        model.bodies,
        model.joints,
        model.forces,
        model.gravity,
        simulation,
        Outputs(every),
        text=model.text,
        folder=model.folder,
    )


def bar(length, cell="beam", cells=10, material=STEEL, side=0.02, coupling="rigid", ends=("start", "end"), **keys):
    """A bar of square section along x with attachments at the named ends; `cell` is beam or a solid cell (2 × 2 across)."""
    if cell == "beam":
        mesh = BeamMesh(length, Section.rectangle(side, side), cells)
        sets = {"start": "start", "end": "end"}
    else:
        mesh = BoxMesh((length, side, side), (cells, 2, 2), cell)
        sets = {"start": "x_min", "end": "x_max"}
    attachments = {end: Attachment(nodes=NamedSet(sets[end]), coupling=coupling) for end in ends}
    return ElasticBody(mesh, material, attachments=keys.pop("attachments", attachments), **keys)


def axis_offset(cell, side=0.02):
    """Where the bar's axis runs in its frame, (3,)."""
    return np.zeros(3) if cell == "beam" else np.array([0.0, side / 2, side / 2])


def end(text):
    """``body``, ``body.attachment``."""
    return End(*text.split("."))


def revolute(first, second, axis=(0.0, 1.0, 0.0), at=None):
    return Joint("revolute", end(first), end(second), at=at, axis=axis)


def weld(first, second):
    return Joint("weld", end(first), end(second))


def turn_y(angle):
    """Rotation matrix about y as nested tuples."""
    c, s = float(np.cos(angle)), float(np.sin(angle))
    return ((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c))


def slider_crank(speed, simulation, cell="beam", cells=8, material=STEEL, gravity=GRAVITY, angle="w*t", **keys):
    """Crank of 0.075 m, rod of 0.3 m, in the x-z plane; starts stretched, piston at x = 0.375 m. keys: of the rod."""
    place = np.array([0.075, 0.0, 0.0]) - axis_offset(cell)
    bodies = {
        "crank": RigidBody(
            1.2,
            (0.02, 0.0, 0.0),
            ((1e-3, 0.0, 0.0), (0.0, 2e-3, 0.0), (0.0, 0.0, 2e-3)),
            attachments={"pin": Attachment(at=(0.075, 0.0, 0.0))},
        ),
        "rod": bar(0.3, cell, cells, material, pose=Pose(tuple(place.tolist())), **keys),
        "piston": RigidBody(
            0.8,
            inertia=((4e-4, 0.0, 0.0), (0.0, 4e-4, 0.0), (0.0, 0.0, 4e-4)),
            pose=Pose((0.375, 0.0, 0.0)),
            attachments={"pin": Attachment(at=(0.0, 0.0, 0.0))},
        ),
    }
    joints = {
        "bearing": revolute("ground", "crank", at=(0.0, 0.0, 0.0)),
        "crankpin": revolute("crank.pin", "rod.start"),
        "wristpin": revolute("rod.end", "piston.pin"),
        "cylinder": Joint("prismatic", end("ground"), end("piston"), at=(0.375, 0.0, 0.0), axis=(1.0, 0.0, 0.0)),
        "motor": Driver("bearing", "angle", expression(angle, w=speed)),
    }
    return Model(bodies, joints, gravity=gravity, simulation=simulation)


def four_bar(speed, simulation, cell="beam", cells=8, gravity=GRAVITY, driven=True):
    """Rigid crank of 0.2 m, elastic coupler of 0.5 m and rocker of 0.35 m, ground of 0.5 m; crank starts upright."""
    crank_end, ground_end = np.array([0.0, 0.0, 0.2]), np.array([0.5, 0.0, 0.0])
    # the circles of 0.5 m about the crank's end and of 0.35 m about the rocker's bearing, upper crossing
    between = ground_end - crank_end
    distance = np.linalg.norm(between)
    along = (0.5**2 - 0.35**2 + distance**2) / (2 * distance)
    normal = np.array([-between[2], 0.0, between[0]]) / distance
    pin = crank_end + along * between / distance + np.sqrt(0.5**2 - along**2) * normal
    bodies = {"crank": RigidBody(1.0, (0.0, 0.0, 0.1), ((1e-3, 0.0, 0.0), (0.0, 1e-3, 0.0), (0.0, 0.0, 1e-3)))}
    for name, length, start in (("coupler", 0.5, crank_end), ("rocker", 0.35, ground_end)):
        rotation = turn_y(-np.arctan2(pin[2] - start[2], pin[0] - start[0]))
        origin = start - np.array(rotation) @ axis_offset(cell)
        bodies[name] = bar(length, cell, cells, pose=Pose(tuple(origin.tolist()), rotation))
    joints = {
        "bearing": revolute("ground", "crank", at=(0.0, 0.0, 0.0)),
        "crankpin": revolute("crank", "coupler.start"),
        "pin": revolute("coupler.end", "rocker.end"),
        "pivot": revolute("ground", "rocker.start"),
    }
    if driven:
        joints["motor"] = Driver("bearing", "angle", expression("w*t", w=speed))
    return Model(bodies, joints, gravity=gravity, simulation=simulation)
