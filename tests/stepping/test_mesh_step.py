"""A mesh through a step: the product with K that a factor makes unnecessary, energies, and what damping takes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from maggi.analyses.prepare import prepare
from maggi.elements.assembly import assemble_solids
from maggi.elements.products import Product, Squares
from maggi.linalg.lanes import WIDTH
from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import ElasticBody, GivenMotion
from maggi.model.expression import expression
from maggi.model.joints import End, Joint
from maggi.model.materials import Damping, Material
from maggi.model.meshes import BeamMesh, BoxMesh, Section
from maggi.model.model import Model
from maggi.model.simulation import Simulation
from maggi.stepping.damping_power import DampingPower
from maggi.stepping.stepper import Stepper

STEP, STEPS = 1e-3, 12
MATERIAL = Material(2700.0, 7e9, 0.3)
DAMPING = [Damping(stiffness=1e-5), Damping(mass=2.0), Damping(mass=2.0, stiffness=1e-5)]


def falling_bar(damping: Damping) -> Stepper:
    body = ElasticBody(
        BoxMesh((0.5, 0.02, 0.02), (4, 1, 1), "hex20"),
        replace(MATERIAL, damping=damping),
        attachments={"root": Attachment(nodes=NamedSet("x_min"))},
    )
    hinge = Joint("revolute", End("ground"), End("bar", "root"), axis=(0.0, 1.0, 0.0))
    model = Model({"bar": body}, {"hinge": hinge}, gravity=(0.0, 0.0, -9.81), simulation=Simulation(1.0, STEP))
    stepper = prepare(model)[0]
    stepper.set_step(STEP)
    return stepper


@pytest.mark.parametrize("damping", DAMPING, ids=["stiffness", "mass", "both"])
def test_dissipated_energy_is_the_trapezoidal_sum_of_powers(damping: Damping) -> None:
    stepper = falling_bar(damping)
    mesh = stepper.meshes[0]
    D = damping.mass * mesh.body.inertia.matrix + damping.stiffness * mesh.body.K.matrix()
    powers = [mesh.ud @ (D @ mesh.ud)]
    for k in range(STEPS):
        assert stepper.advance(k * STEP, 1) == 1
        powers.append(mesh.ud @ (D @ mesh.ud))
    expected = STEP * (0.5 * powers[0] + sum(powers[1:-1]) + 0.5 * powers[-1])
    assert expected > 0.0
    assert stepper.dissipated() == pytest.approx(expected, rel=1e-11, abs=0)


@pytest.mark.parametrize("damping", [*DAMPING, Damping()], ids=["stiffness", "mass", "both", "none"])
def test_energies_are_those_of_dense_matrices(damping: Damping) -> None:
    stepper = falling_bar(damping)
    assert stepper.advance(0.0, 1) == 1
    stepper.meshes[0].energies(
        stepper.state.now, stepper.system.forces.gravity
    )  # what is kept of an instant ends with it
    assert stepper.advance(STEP, STEPS - 1) == STEPS - 1
    mesh, now = stepper.meshes[0], stepper.state.now
    body, first = mesh.body, int(stepper.system.bodies.offset[mesh.index])
    K = body.K.matrix()
    gravity = np.array([0.0, 0.0, -9.81])
    kinetic, strain, potential = mesh.energies(now, gravity)
    round_off = 1e-15 * np.abs(mesh.u) @ (abs(K) @ np.abs(mesh.u))
    assert strain == pytest.approx(0.5 * mesh.u @ (K @ mesh.u), rel=0, abs=round_off)
    assert strain > 1e5 * round_off
    # T = ½ ∫ρ |v + ω × (X + u) + u̇|² with the consistent mass of all nodes, tied ones included
    mu = assemble_solids(body.mesh.nodes, body.mesh.cells, MATERIAL).mass
    v, w = now.v[first : first + 3], now.v[first + 3 : first + 6]
    places = body.mesh.nodes + body.nodal_displacement(mesh.u)
    velocities = v + np.cross(w, places) + body.nodal_displacement(mesh.ud)
    assert kinetic == pytest.approx(0.5 * np.sum(velocities * (mu @ velocities)), rel=1e-12, abs=0)
    weights = np.asarray(mu.sum(axis=1)).ravel()
    center = now.origin[mesh.index] + now.rotation[mesh.index] @ (weights @ places) / weights.sum()
    assert potential == pytest.approx(-weights.sum() * (gravity @ center), rel=1e-12, abs=0)


@pytest.mark.parametrize("damping", DAMPING, ids=["stiffness", "mass", "both"])
def test_dissipated_energy_does_not_depend_on_how_a_run_is_split(damping: Damping) -> None:
    whole, split = falling_bar(damping), falling_bar(damping)
    assert whole.advance(0.0, STEPS) == STEPS
    for first, count in ((0, 1), (1, 4), (5, STEPS - 5)):
        assert split.advance(first * STEP, count) == count
        assert split.dissipated() == split.dissipated() > 0.0
    np.testing.assert_array_equal(whole.meshes[0].ud, split.meshes[0].ud)
    assert whole.dissipated() == split.dissipated()
    assert whole.dissipated() > 0.0


def test_an_interrupt_while_an_instant_is_kept_leaves_the_balance(monkeypatch: pytest.MonkeyPatch) -> None:
    clean, stopped = falling_bar(DAMPING[0]), falling_bar(DAMPING[0])
    for stepper in (clean, stopped):
        assert stepper.advance(0.0, 2) == 2
    keep = DampingPower.keep

    def interrupted(power: DampingPower, place: int, velocities: np.ndarray) -> None:
        keep(power, place, velocities)
        raise KeyboardInterrupt

    monkeypatch.setattr(DampingPower, "keep", interrupted)
    with pytest.raises(KeyboardInterrupt):
        stopped.advance(2 * STEP, 1)
    assert stopped.dissipated() == clean.dissipated() > 0.0


def test_what_a_step_that_failed_has_left_does_not_matter() -> None:
    """The end of the step that was tried is where the last accelerations were kept: nothing of them may be extrapolated."""
    clean, failed = falling_bar(DAMPING[0]), falling_bar(DAMPING[0])
    for stepper in (clean, failed):
        assert stepper.advance(0.0, STEPS) == STEPS
    mesh = failed.meshes[0]
    for field in (mesh.u_next, mesh.ud_next, mesh.udd_next, mesh.a_next):
        field[:] = np.nan
    for stepper in (clean, failed):
        stepper.set_step(STEP / 2)
        assert stepper.advance(STEPS * STEP, 4) == 4
    for name in ("u", "ud", "udd", "a"):
        np.testing.assert_array_equal(getattr(mesh, name), getattr(clean.meshes[0], name))
    assert np.abs(mesh.u).max() > 0.0


def test_a_step_that_cannot_be_made_is_not_extrapolated_from(monkeypatch: pytest.MonkeyPatch) -> None:
    stepper = falling_bar(DAMPING[0])
    assert stepper.advance(0.0, STEPS) == STEPS
    converge = stepper._converge
    monkeypatch.setattr(stepper, "_converge", lambda c, t, exact: converge(c, t, exact) and False)
    before = stepper.meshes[0].u.copy()
    assert stepper.advance(STEPS * STEP, 3) == 0
    assert stepper._alike == 0
    np.testing.assert_array_equal(stepper.meshes[0].u, before)


# body: solid or beam, hanging on a hinge or at a frame that turns
BODIES = {
    "solid": (BoxMesh((0.5, 0.02, 0.02), (4, 1, 1), "hex20"), NamedSet("x_min")),
    "beam": (BeamMesh(0.5, Section.rectangle(0.02, 0.03), 6), NamedSet("start")),
}


@pytest.mark.parametrize("damping", [*DAMPING, Damping()], ids=["stiffness", "mass", "both", "none"])
@pytest.mark.parametrize("floating", [True, False], ids=["floating", "prescribed"])
@pytest.mark.parametrize("kind", BODIES)
def test_what_the_factor_says_of_K_is_what_a_product_says(kind: str, floating: bool, damping: Damping) -> None:
    """Ŝ⁻¹ of a residual with K s left out and put in afterwards, against one with K s, for fields of a moving body."""
    mesh, root = BODIES[kind]
    body = ElasticBody(
        mesh,
        replace(MATERIAL, damping=damping),
        attachments={"root": Attachment(nodes=root)},
        motion=None if floating else GivenMotion(axis=(0.0, 1.0, 0.0), angle=expression("3*t"), held=("root",)),
    )
    hinge = Joint("revolute", End("ground"), End("bar", "root"), axis=(0.0, 1.0, 0.0))
    joints = {"hinge": hinge} if floating else {}
    model = Model({"bar": body}, joints, gravity=(0.0, 0.0, -9.81), simulation=Simulation(1.0, STEP))
    stepper = prepare(model)[0]
    stepper.set_step(STEP)
    assert stepper.advance(0.0, STEPS) == STEPS
    step, c, group = stepper.meshes[0], stepper.coefficients, stepper.mesh_groups[0]
    motion, gravity, work = stepper.trial.motion, np.array(model.gravity), stepper.work
    step.predict(c, 1.0)

    def increment() -> np.ndarray:
        step.residual(c, motion, gravity, work.base, work.W)
        group.solve()
        step.respond(work.base)
        return step.solution.copy()

    assert step.constants.stiff
    by_factor = increment()
    step._use(replace(step.constants, stiff=False), work.W, work.W_Z, work.W_D)
    by_product = increment()
    # round-off of K u of the stiffest motions reaches the softest, which M alone holds; what is found is much larger
    k1, k2 = step.constants.weights
    reach = np.abs(step.u_next).max() / k2
    ratio = k2 / k1 * (step.body.K.diagonal() / step.body.inertia.matrix.diagonal()).max()
    np.testing.assert_allclose(by_factor, by_product, rtol=0, atol=1e-14 * ratio * reach)
    assert 1e-14 * ratio < 1e-9
    assert np.abs(by_product).max() > 1e-6 * reach


@pytest.mark.parametrize("damping", [DAMPING[0], Damping()], ids=["stiffness", "none"])
def test_how_often_K_is_read(damping: Damping, monkeypatch: pytest.MonkeyPatch) -> None:
    """Never for a residual, once in four steps for the damping, and once for the strain energy where it is asked for."""
    stepper, read = falling_bar(damping), []
    for table, method in ((Product, "add"), (Squares, "find")):
        original = getattr(table, method)
        monkeypatch.setattr(
            table, method, lambda self, original=original, m=method: (read.append(m), original(self))[1]
        )
    assert stepper.advance(0.0, STEPS) == STEPS
    assert read == (["find"] * (STEPS // WIDTH) if damping.stiffness else [])
    read.clear()
    stepper.dissipated()
    stepper.meshes[0].energies(stepper.state.now, np.array(stepper.system.forces.gravity))
    assert read == (["find"] if damping.stiffness else []) + ["add"]
    stepper.set_step(1e-9)
    read.clear()
    assert stepper.advance(STEPS * STEP, 1) == 1
    assert read.count("add") == stepper.last_iterations


def test_a_step_in_which_the_body_is_not_stiff_multiplies_K() -> None:
    stepper = falling_bar(DAMPING[0])
    assert stepper.meshes[0].constants.stiff
    stepper.set_step(1e-9)
    assert not stepper.meshes[0].constants.stiff


def test_the_correction_is_that_of_the_forces_at_the_attachments() -> None:
    """δ = −x − Yφ − Zπ − Z_Dκ, whatever the number of freedoms; forces that are not finite are seen."""
    stepper = falling_bar(DAMPING[2])
    mesh, c, rng = stepper.meshes[0], stepper.coefficients, np.random.default_rng(1)
    assert mesh.u.size % WIDTH
    responses = mesh.constants.responses.transpose(0, 2, 1, 3).reshape(2, 6, -1)[:, :, : mesh.u.size]
    Y, Z = (part.reshape(6, -1).T for part in responses)
    y, z = mesh.constants.damping
    mesh.solution[:] = x = rng.normal(size=mesh.u.size)
    forces = np.zeros((3, stepper.work.base.size))
    forces[:, mesh._start + 6 : mesh._end] = rng.normal(size=(3, 6)) * [[1.0], [1e3], [1e2]]
    phi, pi, kappa = forces[:, mesh._start + 6 : mesh._end]
    delta = -x - Y @ phi - Z @ pi - (y * Y + z * Z) @ kappa
    mesh.correct(c, *forces)
    np.testing.assert_allclose(mesh.a_next, delta, rtol=0, atol=1e-13 * np.abs(delta).max())
    rates = c.gamma * c.h * delta + Y @ kappa
    np.testing.assert_allclose(mesh.ud_next, rates, rtol=0, atol=1e-13 * np.abs(rates).max())
    assert mesh.correction == pytest.approx(np.sqrt(np.mean(delta**2)), rel=1e-12)
    for one in range(3):  # forces of one kind alone count too
        alone = np.zeros_like(forces)
        alone[one] = forces[one]
        mesh.solution[:] = 0.0
        mesh.correct(c, *alone)
        assert mesh.correction > 0.0
    forces[1, mesh._start + 7] = np.nan
    mesh.correct(c, *forces)
    assert np.isnan(mesh.correction)
