"""The quasi-static start: elastic mechanisms of every topology begin in balance and do not ring."""

import numpy as np
import pytest
from elastic_models import (
    GRAVITY,
    STEEL,
    bar,
    end,
    four_bar,
    revolute,
    simulate,
    slider_crank,
    weld,
    with_simulation,
)

from maggi.model import (
    Attachment,
    BoxSet,
    GivenMotion,
    Model,
    NamedSet,
    PointLoad,
    PointMass,
    Pose,
    RigidRunMotion,
    Simulation,
    SpringDamper,
    Velocity,
    expression,
)
from maggi.model.joints import End

pytestmark = pytest.mark.slow  # many short runs

QUIET = Simulation(1e-3, 2e-5, 1.0)
RINGING = Simulation(1e-3, 2e-5, 1.0, start="undeformed")
BENDING = STEEL.young * 0.02**4 / 12  # EI, N m²
WEIGHT = STEEL.density * 0.02**2 * 9.81  # N/m
SHEAR = 5.0 / 6.0 * 0.02**2 * STEEL.young / 2.6  # kGA, N
SPIN = Velocity(angular=(3.0, 5.0, 60.0))


def ends_and_middle():
    sets = {
        "start": NamedSet("start"),
        "middle": BoxSet((0.249, -1.0, -1.0), (0.251, 1.0, 1.0)),
        "end": NamedSet("end"),
    }
    return {key: Attachment(nodes=chosen) for key, chosen in sets.items()}


def held(kind, *ends):
    return {
        f"at_{at}": revolute("ground", f"bar.{at}") if kind == "hinge" else weld("ground", f"bar.{at}") for at in ends
    }


def heavy_tip():
    mass = PointMass(2.0, (0.0, 0.0, 0.1))
    return {
        "start": Attachment(nodes=NamedSet("start")),
        "end": Attachment(nodes=NamedSet("end"), point_masses=(mass,)),
    }


def spinning(**turn):
    motion = GivenMotion(axis=(0.0, 1.0, 0.0), angle=expression("100*t"), **turn)
    return Model({"bar": bar(0.5, motion=motion)}, gravity=GRAVITY)


SLOW = {  # loads that stay the same: what is found at t = 0 must stay, to the tolerance given
    "cantilever": (Model({"bar": bar(0.5)}, held("weld", "start"), gravity=GRAVITY), 1e-9),
    "clamped at both ends": (Model({"bar": bar(0.5)}, held("weld", "start", "end"), gravity=GRAVITY), 1e-9),
    "hinged at both ends": (Model({"bar": bar(0.5)}, held("hinge", "start", "end"), gravity=GRAVITY), 1e-9),
    "hinged at both ends, solid": (
        Model({"bar": bar(0.5, "hex8")}, held("hinge", "start", "end"), gravity=GRAVITY),
        1e-9,
    ),
    "pendulum": (Model({"bar": bar(0.5)}, held("hinge", "start"), gravity=GRAVITY), 1e-5),
    "pendulum with a single attachment": (
        Model({"bar": bar(0.5, ends=("start",))}, held("hinge", "start"), gravity=GRAVITY),
        1e-5,
    ),
    "offset mass at the tip": (
        Model({"bar": bar(0.5, attachments=heavy_tip())}, held("weld", "start"), gravity=GRAVITY),
        1e-9,
    ),
    "two in series, hinged": (
        Model(
            {"bar": bar(0.5), "other": bar(0.5, pose=Pose((0.5, 0.0, 0.0)))},
            held("hinge", "start") | {"middle": revolute("bar.end", "other.start")},
            gravity=GRAVITY,
        ),
        1e-5,
    ),
    "two in series, welded": (
        Model(
            {"bar": bar(0.5), "other": bar(0.5, pose=Pose((0.5, 0.0, 0.0)))},
            held("hinge", "start") | {"middle": weld("bar.end", "other.start")},
            gravity=GRAVITY,
        ),
        1e-5,
    ),
    "four-bar at rest, two elastic links": (four_bar(0.0, QUIET, driven=False), 1e-5),
    "free flight, no attachment": (Model({"bar": bar(0.5, ends=(), velocity=SPIN)}, gravity=GRAVITY), 2e-5),
    "free flight, solid": (Model({"bar": bar(0.5, "hex8", ends=(), velocity=SPIN)}, gravity=GRAVITY), 2e-5),
    "prescribed rotation": (spinning(held=("start",)), 0.02),  # gravity turns by 0.1 rad in the frame
    "prescribed rotation, both ends held": (spinning(held=("start", "end")), 0.02),
}


def deflections(results):
    """The largest displacement of every elastic body over time, (bodies, n)."""
    bodies = [results.body(name) for name in results.bodies]
    fields = [np.asarray(body.displacement) for body in bodies if body.kind == "mesh"]
    return np.array([np.linalg.norm(field, axis=2).max(axis=1) for field in fields])


@pytest.mark.parametrize("name", SLOW)
def test_balance_stays(name):
    """Displacements keep their first value; from an undeformed start they swing by more than once their mean."""
    model, tolerance = SLOW[name]
    quiet = deflections(simulate(with_simulation(model, QUIET))[0])
    assert (quiet[:, 0] > 0.0).all()
    assert (np.ptp(quiet, axis=1) < tolerance * quiet[:, 0]).all()
    ringing = deflections(simulate(with_simulation(model, RINGING))[0])
    assert (np.ptp(ringing, axis=1) > ringing.mean(axis=1)).all()


def span(results, joint):
    """Force of a joint: its first value, and mean and half width of its norm over the run."""
    force = np.linalg.norm(results.joint(joint).force, axis=1)
    return force[0], force.mean(), 0.5 * np.ptp(force)


FAST = {
    "slider-crank": (lambda simulation: slider_crank(150.0, simulation), "wristpin"),
    "slider-crank, solid rod": (lambda simulation: slider_crank(150.0, simulation, "hex8"), "wristpin"),
    "slider-crank, averaged attachments": (
        lambda simulation: slider_crank(150.0, simulation, "hex8", coupling="average"),
        "wristpin",
    ),
    "slider-crank, rod on the rigid run's frame": (
        lambda simulation: slider_crank(150.0, simulation, motion=RigidRunMotion()),
        "wristpin",
    ),
    "slider-crank, rod held to the rigid run's frame": (
        lambda simulation: slider_crank(150.0, simulation, motion=RigidRunMotion(held=("start",))),
        "wristpin",
    ),
    "four-bar": (lambda simulation: four_bar(50.0, simulation, "hex8"), "pivot"),
}


@pytest.mark.parametrize("name", FAST)
def test_closed_loops_do_not_ring(name):
    """Redundant revolutes in the plane. In 1 ms forces change by a few per cent; undeformed they swing by their mean."""
    build, joint = FAST[name]
    first, mean, width = span(simulate(build(QUIET))[0], joint)
    assert abs(first / mean - 1.0) < 0.05
    assert width < 0.05 * mean
    first, mean, width = span(simulate(build(RINGING))[0], joint)
    assert first < 0.1 * mean
    assert width > 0.7 * mean


@pytest.mark.parametrize("step", [1e-4, 4e-4])
def test_rates_of_the_start_satisfy_the_joints_at_any_step(step):
    """The rates come from differences over the step; what they miss of the joints' rates must be put right."""
    for build in (slider_crank, four_bar):
        results, summary = simulate(build(150.0, Simulation(2 * step, step)))
        assert results.residuals.velocity[0] < 1e-12
        assert not summary.warnings


def test_springs_that_hold_a_body():
    """A bar on two springs: released where they are at rest it begins to fall, free of strain; stretched they carry it."""
    springs = {
        f"spring_{at}": SpringDamper(End("ground", point=(x, 0.0, 0.3)), end(f"bar.{at}"), 1e3)
        for at, x in (("start", 0.0), ("end", 0.5))
    }
    model = Model({"bar": bar(0.5)}, {}, springs, GRAVITY, QUIET)
    results, _ = simulate(model)
    assert deflections(results)[0, 0] < 1e-15
    stretched = {
        key: SpringDamper(spring.first, spring.second, spring.stiffness, length=0.3 - 0.25 * WEIGHT / 1e3)
        for key, spring in springs.items()
    }
    results, _ = simulate(Model({"bar": bar(0.5)}, {}, stretched, GRAVITY, QUIET))
    found = deflections(results)[0]
    assert found[0] > 1e-7
    # balanced with the springs' forces on the undeformed bar, which are off by stiffness × deflection
    assert np.ptp(found) < 2.5 * (1e3 * found[0] / (0.25 * WEIGHT)) * found[0]


@pytest.mark.parametrize(
    ("joints", "load", "expected"),
    [
        ("hinge", False, 5 * WEIGHT * 0.5**4 / (384 * BENDING) + WEIGHT * 0.5**2 / (8 * SHEAR)),
        ("weld", False, WEIGHT * 0.5**4 / (384 * BENDING) + WEIGHT * 0.5**2 / (8 * SHEAR)),
        ("hinge", True, 500.0 * 0.5**3 / (48 * BENDING) + 500.0 * 0.5 / (4 * SHEAR)),
        ("weld", True, 500.0 * 0.5**3 / (192 * BENDING) + 500.0 * 0.5 / (4 * SHEAR)),
    ],
)
def test_sag_of_a_beam(joints, load, expected):
    """Weight, or a point force on an attachment in the middle, against Timoshenko's closed forms."""
    forces = {}
    if load:
        forces["push"] = PointLoad(end("bar.middle"), "force", tuple(expression(v) for v in (0.0, 0.0, -500.0)))
    model = Model(
        {"bar": bar(0.5, attachments=ends_and_middle())},
        held(joints, "start", "end"),
        forces,
        (0.0, 0.0, 0.0) if load else GRAVITY,
        QUIET,
    )
    results, _ = simulate(model)
    sag = -results.body("bar").attachment("middle").position[:, 2]
    np.testing.assert_allclose(sag, expected, rtol=1e-6)
    reaction = results.joint("at_start").force[:, 2] + results.joint("at_end").force[:, 2]
    np.testing.assert_allclose(reaction, 500.0 if load else WEIGHT * 0.5, rtol=1e-8)
