"""Prescribed and floating frames, beams and shape functions; one-way against fully coupled."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from elastic_models import end, simulate, slider_crank

from maggi.model import (
    Attachment,
    BeamMesh,
    ElasticBody,
    GivenMotion,
    Joint,
    LineQuadrature,
    Material,
    Model,
    NamedSet,
    RigidBody,
    RigidRunMotion,
    RitzBody,
    RitzIntegrals,
    Section,
    Simulation,
    expression,
)

# A cantilever on a hub that is spun up to 2 rad/s in 0.2 s; first bending frequency 51 rad/s.
LENGTH, SIDE = 0.5, 0.005
MATERIAL = Material(7850.0, 50e9, 0.3)
SECTION = Section(SIDE**2, SIDE**4 / 12, SIDE**4 / 12, SIDE**4 / 6)  # no shear flexibility
POWERS = np.arange(2, 7)


def hub(speed):
    """Angle about z with a smooth start: speed · t · smoothstep."""
    return {"axis": (0.0, 0.0, 1.0), "angle": expression("w*t*smoothstep(t, 0, 0.2)", w=speed)}


def shapes(points):
    """Lateral powers x², …, x⁶ of x/L: clamped at the hub."""
    x = points[:, 0] / LENGTH
    result = np.zeros((len(points), 3, POWERS.size))
    result[:, 1, :] = x[:, None] ** POWERS
    return result


def blade(kind, speed):
    """The cantilever on a prescribed frame, on a floating one welded to the hub, or by shape functions in the hub."""
    simulation = Simulation(0.3, 1e-3, 0.9)
    ends = {"start": Attachment(nodes=NamedSet("start")), "tip": Attachment(nodes=NamedSet("end"))}
    mesh = BeamMesh(LENGTH, SECTION, 10)
    if kind == "prescribed":
        return Model(
            {"blade": ElasticBody(mesh, MATERIAL, attachments=ends, motion=GivenMotion(**hub(speed), held=("start",)))},
            simulation=simulation,
        )
    if kind == "floating":
        carrier = RigidBody(1.0, motion=GivenMotion(**hub(speed)), attachments={"root": Attachment(at=(0.0, 0.0, 0.0))})
        root = Joint("weld", end("hub.root"), end("blade.start"))
        return Model(
            {"hub": carrier, "blade": ElasticBody(mesh, MATERIAL, attachments=ends)},
            {"root": root},
            simulation=simulation,
        )
    i, j = POWERS[:, None], POWERS[None, :]
    stiffness = MATERIAL.young * SECTION.Iz / LENGTH**3 * i * (i - 1) * j * (j - 1) / (i + j - 3)
    terms = RitzIntegrals(MATERIAL.density, LineQuadrature(LENGTH, SIDE**2, 10), stiffness)
    body = RitzBody(
        terms, shapes, attachments={"tip": Attachment(at=(LENGTH, 0.0, 0.0))}, motion=GivenMotion(**hub(speed))
    )
    return Model({"blade": body}, simulation=simulation)


def tip_deflection(kind, speed):
    """Lateral position of the tip in the hub's axes, over time."""
    results, _ = simulate(blade(kind, speed))
    t = results.time
    s = np.clip(t / 0.2, 0.0, 1.0)
    angle = speed * t * s**3 * (s * (s * 6 - 15) + 10)
    tip = results.body("blade").attachment("tip").position
    return -np.sin(angle) * tip[:, 0] + np.cos(angle) * tip[:, 1]


def test_shape_functions_and_beams_agree_on_a_prescribed_frame():
    """The same linear equations (T2): they differ by the beam's rotary inertia, (side/L)², and the polynomials' reach."""
    ritz, beam = tip_deflection("ritz", 2.0), tip_deflection("prescribed", 2.0)
    assert np.abs(beam).max() > 0.005 * LENGTH
    assert np.abs(ritz - beam).max() < 1e-3 * np.abs(beam).max()


def test_prescribed_and_floating_frames_agree_for_small_deflections():
    """The floating frame follows the bent blade, which the linear T2 does not: a difference of higher order.

    Relative differences fall with the square of the speed, as the deflection and ω²/ω₁² do.
    """
    differences = []
    for speed in (2.0, 1.0):
        prescribed, floating = tip_deflection("prescribed", speed), tip_deflection("floating", speed)
        differences.append(np.abs(prescribed - floating).max() / np.abs(prescribed).max())
    assert differences[1] < 3e-3
    assert differences[0] / differences[1] > 3.0


def soft_mechanism(young, motion):
    """Mid deflection relative to the chord, wrist-pin force and piston position of the slider-crank at 150 rad/s."""
    material = Material(7850.0, young, 0.3)
    results, _ = simulate(slider_crank(150.0, Simulation(0.02, 5e-5), cells=6, material=material, motion=motion))
    return np.linalg.norm(results.joint("wristpin").force, axis=1), results.body("piston").origin[:, 0]


@pytest.mark.slow
def test_one_way_coupling_errs_by_the_order_of_the_deformation():
    """Rods of 1, 1/10 and 1/100 of steel's stiffness: the difference in force, relative, grows in proportion."""
    differences = []
    for young in (210e9, 21e9, 2.1e9):
        coupled, piston = soft_mechanism(young, None)
        one_way, follows = soft_mechanism(young, RigidRunMotion())
        differences.append(np.abs(one_way - coupled).max() / coupled.max())
        assert np.abs(follows - piston).max() < 2e-5
    assert differences[0] < 2e-4
    growth = np.array(differences[1:]) / np.array(differences[:-1])
    assert ((growth > 5.0) & (growth < 20.0)).all()


@pytest.mark.slow
def test_one_way_and_coupled_example():
    """The first tenth of a turn of examples/slider_crank, with the measures of its compare.py (docs/one-way.md)."""
    path = Path(__file__).parents[2] / "examples" / "slider_crank" / "compare.py"
    spec = importlib.util.spec_from_file_location("compare", path)
    compare = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(compare)
    short = "simulation.duration=0.002"
    coupled, one_way = compare.measure(short), compare.measure(short, compare.ONE_WAY)
    for key, difference in (("deflection", 1.5e-3), ("force", 3e-4), ("piston", 2e-8)):
        assert 0.0 < np.abs(one_way[key] - coupled[key]).max() < difference * np.abs(coupled[key]).max()
    assert np.abs(coupled["deflection"]).max() > 5e-5
