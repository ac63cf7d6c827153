"""A bar that rotates about its end stretches: ρω²L³/(3E) to first order, in every element and on every kind of frame."""

import numpy as np
import pytest
from elastic_models import axis_offset, bar, revolute, simulate

from maggi.model import BoxMesh, Driver, GivenMotion, Material, Model, NamedSet, Pose, Simulation, Velocity, expression
from maggi.model.attachments import Attachment
from maggi.model.bodies import ElasticBody

LENGTH = 0.5
MATERIAL = Material(7850.0, 210e9, 0.0)
SPEED = float(np.sqrt(1e-4 * MATERIAL.young / MATERIAL.density)) / LENGTH  # ρω²L²/E = 1e-4
FIRST_ORDER = MATERIAL.density * SPEED**2 * LENGTH**3 / (3 * MATERIAL.young)
CELLS = ["beam", "hex8", "hex20", "tet10"]


def exact_stretch():
    """u'' + k²(x + u) = 0, u(0) = 0, u'(L) = 0 with k = ω√(ρ/E): u(L) = tan(kL)/k − L, which is 4e-5 above first order."""
    k = SPEED * np.sqrt(MATERIAL.density / MATERIAL.young)
    return np.tan(k * LENGTH) / k - LENGTH


def rotating(cell, frame):
    """The bar, turning about the z axis through the centroid of its first section."""
    shift = axis_offset(cell)
    simulation = Simulation(20e-5, 1e-5)
    if frame == "prescribed":
        turning = GivenMotion(
            origin=(
                expression("y*sin(w*t)", y=float(shift[1]), w=SPEED),
                expression("-y*cos(w*t)", y=float(shift[1]), w=SPEED),
                expression(float(-shift[2])),
            ),
            axis=(0.0, 0.0, 1.0),
            angle=expression("w*t", w=SPEED),
            held=("start",),
        )
        return Model({"bar": bar(LENGTH, cell, 16, MATERIAL, motion=turning)}, simulation=simulation)
    keys = {"pose": Pose(tuple((-shift).tolist()))}
    joints = {"hinge": revolute("ground", "bar.start", axis=(0.0, 0.0, 1.0))}
    if frame == "driven":
        joints["motor"] = Driver("hinge", "speed", expression(SPEED))
    else:
        keys["velocity"] = Velocity(angular=(0.0, 0.0, SPEED))
    return Model({"bar": bar(LENGTH, cell, 16, MATERIAL, **keys)}, joints, simulation=simulation)


def stretch(results):
    """Distance of the end attachments less the length, over time."""
    body = results.body("bar")
    span = body.attachment("end").position - body.attachment("start").position
    return np.linalg.norm(span, axis=1) - LENGTH


@pytest.mark.parametrize("frame", ["driven", "given velocity", "prescribed"])
@pytest.mark.parametrize("cell", CELLS)
def test_stretch_of_a_rotating_bar(cell, frame):
    results, _ = simulate(rotating(cell, frame))
    found = stretch(results)
    np.testing.assert_allclose(found, FIRST_ORDER, rtol=1e-3)
    # the softening k(ω) of T2 makes up the rest; 16 cells leave 1e-7
    np.testing.assert_allclose(found, exact_stretch(), rtol=1e-6)
    assert np.ptp(found) < 1e-8 * FIRST_ORDER  # in balance from the start


def test_steady_rotation_needs_no_work():
    """A prescribed frame that turns the bar about an axis beside its own: bent and stretched, but nothing is exchanged."""
    turning = GivenMotion(axis=(0.0, 0.0, 1.0), angle=expression("w*t", w=SPEED), held=("start",))
    model = Model({"bar": bar(LENGTH, "hex8", 16, MATERIAL, motion=turning)}, simulation=Simulation(20e-5, 1e-5))
    results, _ = simulate(model)
    energy = results.energy
    assert energy.strain[0] > 0.01
    assert np.abs(energy.work).max() < 1e-9 * energy.strain[0]


def test_averaged_attachments_differ_by_an_end_effect():
    """RBE3 spreads the joint's force by nodes, not by areas: an end effect, that halves when the bar is twice as long."""
    errors = []
    for length in (0.25, 0.5):
        ends = {
            "start": Attachment(nodes=NamedSet("x_min"), coupling="average"),
            "end": Attachment(nodes=NamedSet("x_max"), coupling="average"),
        }
        mesh = BoxMesh((length, 0.02, 0.02), (round(length * 80), 2, 2), "hex8")
        body = ElasticBody(
            mesh, MATERIAL, Pose((0.0, -0.01, -0.01)), Velocity(angular=(0.0, 0.0, SPEED)), attachments=ends
        )
        hinge = revolute("ground", "bar.start", axis=(0.0, 0.0, 1.0))
        results, _ = simulate(Model({"bar": body}, {"hinge": hinge}, simulation=Simulation(1e-5, 1e-5)))
        at = results.body("bar")
        found = np.linalg.norm(at.attachment("end").position - at.attachment("start").position, axis=1)[0] - length
        errors.append(found / (MATERIAL.density * SPEED**2 * length**3 / (3 * MATERIAL.young)) - 1.0)
    assert 0.0 < errors[1] < errors[0] < 0.02
    np.testing.assert_allclose(errors[0] / errors[1], 2.0, rtol=0.05)
