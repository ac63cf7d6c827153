"""Elastic mechanisms in motion: energy, order of convergence, independence of the mesh's frame, free flight."""

from pathlib import Path

import numpy as np
import pytest
from elastic_models import GRAVITY, STEEL, bar, revolute, simulate, slider_crank, weld, with_simulation
from scipy.integrate import solve_ivp

from maggi.analyses.prepare import prepare
from maggi.elements.assembly import assemble_solids
from maggi.linalg.rotations import rotation_matrix
from maggi.mesh.parametric import box
from maggi.model import (
    Attachment,
    BoxMesh,
    Damping,
    ElasticBody,
    FileMesh,
    Material,
    Model,
    NamedSet,
    Pose,
    Simulation,
    Velocity,
)

SIDE = 0.02


def soft_slider_crank(duration, steps, damping=None, start="undeformed"):
    """A rod of two soft beams, whose highest mode has 2733 rad/s; it bends by 1.5 mm. ρ∞ = 1."""
    material = Material(7850.0, 2e8, 0.3, damping or Damping())
    simulation = Simulation(duration, duration / steps, 1.0, 1e-10, start=start)
    return slider_crank(20.0, simulation, cells=2, material=material)


@pytest.mark.slow
@pytest.mark.parametrize("damping", [Damping(), Damping(mass=500.0), Damping(stiffness=1e-4)])
def test_energy_balance_closes_with_second_order(damping):
    """Kinetic + strain + gravity + dissipated − work of a ringing mechanism, to 1e-6 of the energy exchanged."""
    defects = []
    for steps in (200, 400, 800):
        results, summary = simulate(soft_slider_crank(0.01, steps, damping))
        defects.append(summary.energy_balance)
    energy = results.energy
    assert energy.strain.max() > 0.05 * np.ptp(energy.kinetic)
    if damping != Damping():
        assert energy.dissipated[-1] > 0.05 * energy.strain.max()
    assert defects[-1] < 1e-6
    np.testing.assert_allclose(np.array(defects[:-1]) / np.array(defects[1:]), 4.0, rtol=0.05)


# A cantilever that is let go undeformed under its weight ends in balance: what it loses is the strain energy there,
# q²L⁵/40EI + q²L³/6kGA, half of the work of its weight.
WEIGHT = STEEL.density * SIDE**2 * 9.81
SETTLED_ENERGY = WEIGHT**2 * (
    0.5**5 / (40 * STEEL.young * SIDE**4 / 12) + 0.5**3 / (6 * 5 / 6 * SIDE**2 * STEEL.young / 2.6)
)


def falling_cantilever(simulation, damping=None):
    material = Material(STEEL.density, STEEL.young, STEEL.poisson, damping or Damping())
    body = bar(0.5, cells=16, material=material)
    return Model({"bar": body}, {"root": weld("ground", "bar.start")}, gravity=GRAVITY, simulation=simulation)


@pytest.mark.parametrize(("damping", "left"), [(Damping(mass=1e4), 2e-3), (Damping(stiffness=2.4e-3), 1e-5)])
def test_damping_takes_what_a_released_cantilever_must_lose(damping, left):
    """`left`: what has not decayed yet. Mass damping acts relative to the frame, which carries most of the first mode."""
    simulation = Simulation(0.15, 1.5e-4, 1.0, 1e-10, start="undeformed")
    results, summary = simulate(falling_cantilever(simulation, damping))
    np.testing.assert_allclose(results.energy.strain[-1], SETTLED_ENERGY, rtol=left)
    np.testing.assert_allclose(results.energy.dissipated[-1], SETTLED_ENERGY, rtol=3e-3)  # (hω)²/2 = 2e-3 of the step
    assert abs(summary.numerical_loss) < 2e-3 * SETTLED_ENERGY


def test_numerical_dissipation_is_reported_by_itself():
    """Steps of 2 rad of the first mode: ρ∞ = 0.3 takes the whole ringing, ρ∞ = 1 nothing, and neither is `dissipated`."""
    simulation = Simulation(0.5, 5e-3, 0.3, 1e-10, start="undeformed")
    results, summary = simulate(falling_cantilever(simulation))
    np.testing.assert_allclose(summary.numerical_loss, SETTLED_ENERGY, rtol=1e-3)
    assert (results.energy.dissipated == 0.0).all()
    _, summary = simulate(
        with_simulation(falling_cantilever(simulation), Simulation(0.5, 5e-3, 1.0, 1e-10, start="undeformed"))
    )
    assert abs(summary.numerical_loss) < 1e-5 * SETTLED_ENERGY  # of a linear system it would be nothing


@pytest.mark.slow
@pytest.mark.parametrize("start", ["undeformed", "quasi-static"])
def test_second_order_of_an_elastic_mechanism(start):
    """Piston and rod, at hω ≤ 0.27 of the rod's highest mode.

    The order is that of successive differences, log₂ (x_h − x_h/2)/(x_h/2 − x_h/4).
    """
    found = []
    for steps in (100, 200, 400, 800):
        results, _ = simulate(soft_slider_crank(0.01, steps, start=start))
        found.append(np.concatenate([results.body("piston").origin[-1], results.body("rod").displacement[-1].ravel()]))
    differences = np.linalg.norm(np.diff(found, axis=0), axis=1)
    orders = np.log2(differences[:-1] / differences[1:])
    assert abs(orders[-1] - 2.0) < 0.05
    assert abs(orders[0] - 2.0) < 0.2


# the same rod, its mesh in another frame


def shifted_rod(folder, origin, rotation):
    """A box mesh whose nodes are given in a frame at `origin`, `rotation` of the box's own, as an Abaqus file."""
    mesh = box((0.3, SIDE, SIDE), (6, 1, 1), "hex8")
    nodes = (mesh.nodes - origin) @ rotation
    lines = ["*NODE", *(f"{n + 1}, {x:.17g}, {y:.17g}, {z:.17g}" for n, (x, y, z) in enumerate(nodes))]
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=ALL")
    lines += [", ".join(str(v) for v in (e + 1, *(cell + 1))) for e, cell in enumerate(mesh.cells["hex8"])]
    for name, members in (("start", mesh.node_sets["x_min"]), ("end", mesh.node_sets["x_max"])):
        lines += [f"*NSET, NSET={name}", ", ".join(str(n + 1) for n in members)]
    path = Path(folder) / "rod.inp"
    path.write_text("\n".join(lines) + "\n")
    return FileMesh(str(path))


@pytest.mark.parametrize("coupling", ["rigid", "average"])
def test_motion_does_not_depend_on_the_meshs_frame(tmp_path, coupling):
    """Node positions of a slider-crank whose rod's mesh is given in its own and in a displaced, turned frame."""
    place = np.array([0.075, -SIDE / 2, -SIDE / 2])
    shift, turn = np.array([0.11, -0.07, 0.05]), rotation_matrix(np.array([0.4, -1.1, 0.7]))
    positions, forces = [], []
    for number, (origin, rotation) in enumerate(((np.zeros(3), np.eye(3)), (shift, turn))):
        folder = tmp_path / str(number)
        folder.mkdir()
        model = slider_crank(150.0, Simulation(2e-3, 4e-5, 0.9, start="undeformed"))
        ends = {key: Attachment(nodes=NamedSet(key), coupling=coupling) for key in ("start", "end")}
        pose = Pose(tuple((place + origin).tolist()), tuple(tuple(row) for row in rotation.tolist()))
        bodies = {
            **model.bodies,
            "rod": ElasticBody(shifted_rod(folder, origin, rotation), STEEL, pose, attachments=ends),
        }
        results, _ = simulate(Model(bodies, model.joints, gravity=GRAVITY, simulation=model.simulation), exact=True)
        rod = results.body("rod")
        deformed = rod.nodes + np.asarray(rod.displacement)
        positions.append(rod.origin[:, None] + np.einsum("nij,nkj->nki", rod.rotation, deformed))
        forces.append(results.joint("wristpin").force)
    # the rod vibrates with 1e-5 m
    assert np.abs(positions[0] - positions[1]).max() < 1e-12
    assert np.abs(forces[0] - forces[1]).max() < 1e-7 * np.abs(forces[0]).max()


# free flight

BLOCK = (0.3, 0.2, 0.1)
SPIN = (3.0, 40.0, 5.0)  # near the middle axis of inertia: it tumbles


def flying_block(simulation, young=2e9, cells=(3, 2, 1)):
    material = Material(7850.0, young, 0.3)
    velocity = Velocity((1.0, -2.0, 0.5), SPIN)
    return Model(
        {"block": ElasticBody(BoxMesh(BLOCK, cells, "hex8"), material, velocity=velocity)}, simulation=simulation
    )


@pytest.mark.slow
def test_free_flight_conserves_momentum_and_mean_axes():
    """Ten thousand steps of a tumbling soft block; momenta by nodal sums over the mesh, in global axes.

    The step is of second order in body axes and keeps no momentum exactly: the defect must fall with h².
    """
    cells = (2, 1, 1)
    stepper, *_ = prepare(flying_block(Simulation(1.0, 1e-4, 1.0), cells=cells))
    mesh = box(BLOCK, cells, "hex8")
    mu = assemble_solids(mesh.nodes, mesh.cells, Material(7850.0, 2e9, 0.3)).mass
    body, index = stepper.meshes[0], stepper.meshes[0].index
    o = int(stepper.system.bodies.offset[index])

    def momenta():
        now = stepper.state.now
        R, r = now.rotation[index], now.origin[index]
        c = mesh.nodes + body.u.reshape(-1, 3)
        w = (now.v[o : o + 3] + np.cross(now.v[o + 3 : o + 6], c) + body.ud.reshape(-1, 3)) @ R.T
        impulse = mu @ w
        return impulse.sum(axis=0), np.cross(r + c @ R.T, impulse).sum(axis=0)

    linear, angular = momenta()
    defects = []
    for h, steps in ((2e-4, 5000), (1e-4, 10000)):
        stepper, *_ = prepare(flying_block(Simulation(1.0, h, 1.0), cells=cells))
        stepper.set_step(h)
        body = stepper.meshes[0]
        assert stepper.advance(0.0, steps) == steps
        later, turned = momenta()
        defects.append(
            [
                np.linalg.norm(later - linear) / np.linalg.norm(linear),
                np.linalg.norm(turned - angular) / np.linalg.norm(angular),
            ]
        )
    assert (np.array(defects[1]) < 1e-3).all()
    np.testing.assert_allclose(np.array(defects[0]) / np.array(defects[1]), 4.0, rtol=0.1)
    mean = body.body.C.T @ body.u
    assert np.abs(body.u).max() > 5e-6
    assert np.abs(mean).max() < 1e-12 * np.abs(body.body.C).sum(axis=0).max() * np.abs(body.u).max()


def test_stiff_body_tumbles_as_euler_says():
    """Against Euler's equations by an eighth-order method; the error falls with h² and ends at the block's compliance."""
    duration = 0.2
    inertia = (
        7850.0 * np.prod(BLOCK) / 12 * np.array([BLOCK[1] ** 2 + BLOCK[2] ** 2, 0.13 - BLOCK[1] ** 2 - 0.03, 0.13])
    )
    inertia[1] = 7850.0 * np.prod(BLOCK) / 12 * (BLOCK[0] ** 2 + BLOCK[2] ** 2)

    def rates(_, y):
        w, R = y[:3], y[3:].reshape(3, 3)
        tilde = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
        return np.concatenate([np.cross(inertia * w, w) / inertia, (R @ tilde).ravel()])

    start = np.concatenate([SPIN, np.eye(3).ravel()])
    exact = solve_ivp(rates, (0.0, duration), start, "DOP853", rtol=1e-12, atol=1e-12).y[3:, -1].reshape(3, 3)
    errors = []
    for steps in (200, 400, 800):
        results, _ = simulate(flying_block(Simulation(duration, duration / steps, 0.9), young=2e15))
        errors.append(np.abs(results.body("block").rotation[-1] - exact).max())
    assert errors[-1] < 1e-4
    np.testing.assert_allclose(np.array(errors[:-1]) / np.array(errors[1:]), 4.0, rtol=0.05)


# solids, beams


def hanging(cell, cells):
    """A soft bar let go from the horizontal."""
    shift = 0.0 if cell == "beam" else -SIDE / 2
    body = bar(0.5, cell, cells, Material(7850.0, 2e9, 0.0), pose=Pose((0.0, shift, shift)))
    return Model(
        {"bar": body}, {"hinge": revolute("ground", "bar.start")}, gravity=GRAVITY, simulation=Simulation(0.1, 5e-4)
    )


def test_solid_and_beam_pendulums_bend_alike():
    """Deflection of the end in the axes of the hinged section: hex20 with ν = 0 against Timoshenko's beam, 1 %."""
    sags = []
    for cell, cells in (("beam", 16), ("hex20", 8)):
        rod = simulate(hanging(cell, cells))[0].body("bar")
        start, tip = rod.attachment("start"), rod.attachment("end")
        sags.append(np.einsum("nji,nj->ni", start.rotation, tip.position - start.position)[:, 2])
    assert np.abs(sags[0]).max() > 5e-4
    np.testing.assert_allclose(sags[1], sags[0], atol=0.01 * np.abs(sags[0]).max())
