"""Reduced bodies move as the full mesh does, the better the more modes; with all shapes exactly."""

from dataclasses import replace

import numpy as np
import pytest
from elastic_models import GRAVITY, STEEL, axis_offset, bar, end, revolute, simulate, slider_crank, weld

from maggi.analyses.prepare import started
from maggi.model import (
    BeamMesh,
    CraigBampton,
    GivenMotion,
    Model,
    Outputs,
    PointLoad,
    Pose,
    RigidRunMotion,
    Section,
    Simulation,
    Velocity,
    expression,
)
from maggi.system.build import build_system

SHORT = Simulation(2e-3, 1e-4, 1.0, 1e-12, start="undeformed")  # all modes ring


def with_modes(model, body, count):
    """The model with `count` modes of one of its bodies."""
    return replace(model, bodies={**model.bodies, body: replace(model.bodies[body], reduction=CraigBampton(count))})


def pendulum(cell, coupling):
    body = bar(0.3, cell, 2, coupling=coupling, ends=("start",), pose=Pose(tuple((-axis_offset(cell)).tolist())))
    return Model({"bar": body}, {"pivot": revolute("ground", "bar.start")}, gravity=GRAVITY, simulation=SHORT)


def free(cell, coupling):
    spin = Velocity((1.0, 0.0, 0.0), (2.0, 30.0, 5.0))
    return Model({"bar": bar(0.3, cell, 2, ends=(), velocity=spin)}, gravity=GRAVITY, simulation=SHORT)


def turned(cell, coupling):
    turn = GivenMotion(axis=(0.0, 1.0, 0.0), angle=expression("100*t + 2000*t*t"), held=("start",))
    return Model({"bar": bar(0.3, cell, 2, coupling=coupling, motion=turn)}, gravity=GRAVITY, simulation=SHORT)


def welded_on_a_moving_frame(cell, coupling):
    """The frame slides along below the bar, which a weld holds."""
    slide = GivenMotion(origin=(expression("0.1*t*t"), expression(0.0), expression(0.0)))
    body = bar(0.3, cell, 2, coupling=coupling, motion=slide)
    return Model({"bar": body}, {"weld": weld("ground", "bar.start")}, gravity=GRAVITY, simulation=SHORT)


MODELS = {one.__name__: one for one in (pendulum, free, turned, welded_on_a_moving_frame)}
BODIES = [("beam", "rigid"), ("hex8", "rigid"), ("tet4", "average")]


def end_of(model, *, dense):
    """The stepper after all steps of the model, iterated to round-off."""
    simulation = model.simulation
    stepper = started(build_system(model, dense=dense), simulation, [], lambda text: None, exact=True)
    stepper.set_step(simulation.step)
    steps = round(simulation.duration / simulation.step)
    assert stepper.advance(0.0, steps) == steps
    return stepper


def fields(stepper, body):
    """Displacements and velocities on the freedoms of a body, whichever way it is kept."""
    system, b = stepper.system, stepper.system.body(body).index
    if b in system.reduced:
        part = slice(system.bodies.offset[b] + 6, system.bodies.offset[b + 1])
        basis = system.reduced[b].basis
        return basis @ stepper.state.now.e[part], basis @ stepper.state.now.v[part]
    (mesh,) = (mesh for mesh in stepper.meshes if mesh.index == b)
    return mesh.u, mesh.ud


def same(a, b, tolerance):
    np.testing.assert_allclose(a, b, rtol=0, atol=tolerance * max(np.abs(b).max(), 1e-300))


@pytest.mark.parametrize(("cell", "coupling"), BODIES, ids=lambda text: text)
@pytest.mark.parametrize("name", MODELS)
def test_complete_shapes_move_as_the_mesh(name, cell, coupling):
    """The same equations, once with a factorised mesh and once dense with T3 and T5a: the same motion to round-off."""
    model = MODELS[name](cell, coupling)
    mesh, dense = end_of(model, dense=False), end_of(model, dense=True)
    assert mesh.meshes and not dense.meshes
    for one, other in zip(fields(dense, "bar"), fields(mesh, "bar"), strict=True):
        same(one, other, 2e-7)
    index = mesh.system.body("bar").index
    np.testing.assert_allclose(dense.state.now.origin[index], mesh.state.now.origin[index], rtol=0, atol=1e-13)
    np.testing.assert_allclose(dense.state.now.rotation[index], mesh.state.now.rotation[index], rtol=0, atol=1e-12)
    if mesh.system.rows:
        same(dense.state.multipliers, mesh.state.multipliers, 1e-8)


@pytest.mark.parametrize(("cell", "coupling"), [("beam", "rigid"), ("hex8", "rigid")])
def test_complete_shapes_in_a_closed_loop(cell, coupling):
    """Coarser: a step leaves 1e-12 of the size at the joints' positions, to which stiff modes answer."""
    model = slider_crank(150.0, SHORT, cell=cell, cells=2, coupling=coupling)
    mesh, dense = end_of(model, dense=False), end_of(model, dense=True)
    for one, other in zip(fields(dense, "rod"), fields(mesh, "rod"), strict=True):
        same(one, other, 2e-6)
    same(dense.state.multipliers, mesh.state.multipliers, 1e-8)
    # 1e-12 of the size, 0.45 m: what a step may leave, whichever side of it either run ends on
    np.testing.assert_allclose(dense.state.now.origin, mesh.state.now.origin, rtol=0, atol=4.5e-13)


@pytest.mark.parametrize("name", ["pendulum", "free", "turned"])
def test_complete_shapes_start_in_the_same_balance(name):
    model = MODELS[name]("hex8", "rigid")
    model = replace(model, simulation=replace(SHORT, start="quasi-static"))
    mesh, dense = (
        started(build_system(model, dense=d), model.simulation, [], print, exact=True) for d in (False, True)
    )
    same(fields(dense, "bar")[0], fields(mesh, "bar")[0], 1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("motion", [None, RigidRunMotion(held=("start",))], ids=["coupled", "one-way"])
@pytest.mark.parametrize(("cell", "coupling"), [("beam", "rigid"), ("hex8", "average")])
def test_more_modes_come_closer(cell, coupling, motion):
    """Deflection of the rod and force at the crank pin over a turn, against the full mesh (docs/reduction.md)."""
    simulation = Simulation(2 * np.pi / 150.0, 2 * np.pi / 150.0 / 400, 0.9)
    model = slider_crank(150.0, simulation, cell=cell, cells=6, coupling=coupling, motion=motion)
    model = replace(model, outputs=Outputs(10))
    full, _ = simulate(model)
    expected = np.asarray(full.body("rod").displacement)
    force = full.joint("crankpin").force
    bending, forces = [], []
    for count in (0, 2, 6, 16):
        results, _ = simulate(with_modes(model, "rod", count))
        difference = np.asarray(results.body("rod").displacement) - expected
        bending.append(np.abs(difference).max() / np.abs(expected).max())
        forces.append(np.abs(results.joint("crankpin").force - force).max() / np.abs(force).max())
    assert (np.diff(bending) < 0.0).all()
    assert bending[0] > 0.1  # without modes the rod bends between its ends as if it had no mass there
    assert bending[-1] < 2e-3
    assert forces[-1] < 1e-5 < forces[0]


def test_tip_load_without_modes():
    """A beam clamped to its frame under a load at its tip: Timoshenko's deflection, F L³/3EI + F L/kGA."""
    length, force, side = 0.5, 1000.0, 0.02
    body = bar(length, "beam", 5, motion=GivenMotion(held=("start",)), reduction=CraigBampton(0))
    load = PointLoad(end("bar.end"), "force", (expression(0.0), expression(0.0), expression(force)))
    model = Model({"bar": body}, forces={"load": load}, simulation=Simulation(1e-3, 1e-4))
    results, summary = simulate(model)
    section = Section.rectangle(side, side)
    assert isinstance(body.mesh, BeamMesh) and body.mesh.section == section
    shear = STEEL.young / (2 * (1 + STEEL.poisson))
    expected = force * length**3 / (3 * STEEL.young * section.Iy) + force * length / (section.kz * shear * section.area)
    tip = results.body("bar").attachment("end").position
    np.testing.assert_allclose(tip[:, 2], expected, rtol=1e-6)
    np.testing.assert_allclose(results.body("bar").attachment("start").position, 0.0, atol=1e-15)
    assert results.body("bar").modal.shape == (11, 12)
    assert summary.energy_balance < 1e-6


def test_damping_is_that_of_the_mesh():
    """Rayleigh damping of both kinds: energy dissipated by all shapes and by the mesh."""
    damped = replace(STEEL, damping=replace(STEEL.damping, mass=20.0, stiffness=1e-5))
    spin = Velocity((0.0, 0.0, 0.0), (0.0, 200.0, 0.0))
    body = bar(0.3, "beam", 3, damped, ends=("start",), velocity=spin)
    model = Model({"bar": body}, simulation=SHORT)
    full, _ = simulate(model, exact=True)
    reduced, _ = simulate(with_modes(model, "bar", 18), exact=True)
    assert full.energy.dissipated[-1] > 1e-6 * full.energy.kinetic[0]
    np.testing.assert_allclose(reduced.energy.dissipated, full.energy.dissipated, rtol=1e-6, atol=1e-12)
