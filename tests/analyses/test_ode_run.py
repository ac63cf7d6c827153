"""Runs by `method: dop853` and `radau`: the same results as the step's, rows at the nominal instants, energies, failures."""

from dataclasses import replace

import numpy as np
import pytest
from linkages import four_bar
from reference_models import ball_on_turntable, car_axis, disc_in_a_circle, pendulum

import maggi
from maggi.analyses.transient import run
from maggi.model import (
    BoxMesh,
    Driver,
    ElasticBody,
    End,
    Joint,
    Material,
    Outputs,
    PointLoad,
    RigidBody,
    Simulation,
    SimulationError,
    expression,
)
from maggi.results.memory import MemoryRecorder


def results_of(model, method, duration, step, every=1, **keys):
    """Results and summary of a run."""
    recorder = MemoryRecorder()
    timed = replace(model, simulation=Simulation(duration, step, method=method, **keys), outputs=Outputs(every))
    return run(timed, recorder), recorder.results()


@pytest.mark.parametrize("method", ["dop853", "radau"])
@pytest.mark.parametrize("make", [four_bar, car_axis, disc_in_a_circle, ball_on_turntable, pendulum])
def test_everything_as_by_generalised_alpha(make, method):
    """All rows of a short run, joint forces of redundant joints included, to what the step's second order leaves."""
    summary, found = results_of(make(), method, 0.2, 1e-3, 20, tolerance=1e-9)
    _, expected = results_of(make(), "generalized-alpha", 0.2, 1e-4, 200, rho_inf=1.0, tolerance=1e-12)
    np.testing.assert_array_equal(found.time, np.arange(11) * 0.02)
    for name in expected.bodies:
        body = expected.body(name)
        np.testing.assert_allclose(found.body(name).origin, body.origin, atol=2e-6)
        np.testing.assert_allclose(found.body(name).rotation, body.rotation, atol=2e-5)
    for name in expected.joints:
        joint = expected.joint(name)
        size = 1.0 + np.abs(joint.force).max() + np.abs(joint.torque).max()
        np.testing.assert_allclose(found.joint(name).force, joint.force, atol=1e-5 * size)
        np.testing.assert_allclose(found.joint(name).torque, joint.torque, atol=1e-5 * size)
    for what in ("kinetic", "strain", "gravity", "dissipated", "work"):
        values = getattr(expected.energy, what)
        np.testing.assert_allclose(getattr(found.energy, what), values, atol=1e-5 * (1e-3 + np.abs(values).max()))
    assert summary.residuals.max() < 1e-12
    assert summary.iterations > summary.steps > 0


def driven_and_damped():
    """A four-bar driven by a motor, with friction in a joint: work goes in, heat goes out."""
    model = four_bar()
    joints = dict(model.joints) | {"motor": Driver("j0", "angle", expression("0.5*t**2"))}
    friction = maggi.TorsionSpring("j2", 0.0, 0.4)
    return replace(model, joints=joints, forces={"friction": friction})


@pytest.mark.parametrize("method", ["dop853", "radau"])
def test_work_and_heat_of_a_mechanism_without_freedoms(method):
    """The motor's work is what the friction takes and what the links gain; no freedom is left to be integrated."""
    summary, found = results_of(driven_and_damped(), method, 1.0, 1e-2, 10)
    assert summary.energy_balance < 1e-8
    _, expected = results_of(driven_and_damped(), "generalized-alpha", 1.0, 1e-4, 1000, rho_inf=1.0)
    for what in ("work", "dissipated"):
        values = getattr(expected.energy, what)
        assert values.max() > 1e-3
        np.testing.assert_allclose(getattr(found.energy, what), values, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(found.joint("j0").coordinate[:, 0], 0.5 * found.time**2, atol=1e-12)
    np.testing.assert_allclose(found.joint("motor").torque, expected.joint("motor").torque, atol=1e-4)


def test_rows_do_not_depend_on_their_number():
    """The integrator's steps are its own: a finer grid of rows is read off the same motion."""
    _, coarse = results_of(pendulum(), "dop853", 1.0, 0.1)
    _, fine = results_of(pendulum(), "dop853", 1.0, 0.01)
    np.testing.assert_allclose(fine.body("mass").origin[::10], coarse.body("mass").origin, atol=1e-12)
    lengths = np.linalg.norm(fine.body("mass").origin, axis=1)
    np.testing.assert_allclose(lengths, 1.0, atol=1e-14)


def test_a_meshed_body_with_dense_coordinates():
    """A small mesh hinged to ground swings as it does by the step for full meshes."""
    beam = ElasticBody(
        BoxMesh((0.4, 0.02, 0.02), (2, 1, 1)),
        Material(density=1000.0, young=1e8, poisson=0.3),
        attachments={"end": maggi.Attachment(nodes=maggi.NamedSet("x_min"))},
    )
    hinge = Joint("revolute", End("ground"), End("beam", "end"), axis=(0.0, 1.0, 0.0))
    model = maggi.Model({"beam": beam}, {"hinge": hinge}, gravity=(0.0, 0.0, -9.81))
    summary, found = results_of(model, "dop853", 0.004, 1e-3, tolerance=1e-6)
    _, expected = results_of(model, "generalized-alpha", 0.004, 1e-5, 100, rho_inf=1.0)
    np.testing.assert_allclose(found.body("beam").origin, expected.body("beam").origin, atol=1e-6)
    np.testing.assert_allclose(found.joint("hinge").force, expected.joint("hinge").force, atol=2e-2)
    assert summary.energy_balance < 1e-5


class Progress:
    """Keeps what it is told; may interrupt."""

    def __init__(self, interrupt_at=np.inf):
        self.steps, self.interrupt_at = [], interrupt_at

    def stage(self, text):
        pass

    def advance(self, step, steps, time, note):
        self.steps.append((step, steps, note))
        if time > self.interrupt_at:
            raise KeyboardInterrupt


def test_progress_and_interruption():
    timed = replace(pendulum(), simulation=Simulation(5.0, 0.01, method="dop853"))
    recorder, progress = MemoryRecorder(), Progress()
    run(timed, recorder, progress)
    assert progress.steps[-1][:2] == (500, 500)
    assert "steps of the integrator" in progress.steps[-1][2]
    recorder = MemoryRecorder()
    long = replace(pendulum(), simulation=Simulation(1e5, 0.01, method="dop853"))
    with pytest.raises(KeyboardInterrupt):
        run(long, recorder, Progress(interrupt_at=1.0))
    assert recorder.results().status == "interrupted"


def test_a_failure_keeps_what_was_computed():
    """A force that becomes infinite at 1 s."""
    load = PointLoad(End("m"), "force", (expression("1/(1 - t)**2"), expression(0.0), expression(0.0)))
    body = RigidBody(1.0, inertia=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    model = maggi.Model(
        {"m": body}, forces={"push": load}, simulation=Simulation(2.0, 0.1, method="dop853", tolerance=1e-4)
    )
    recorder = MemoryRecorder()
    with pytest.raises(SimulationError, match=r"cannot be continued beyond t = (0\.99|1)"):
        run(model, recorder)
    assert len(recorder.results().time) == 10


def test_the_facade_and_the_model_file(tmp_path):
    """`method: radau` in a file, run by `maggi.run` into a result file."""
    text = """
maggi: 1
gravity: [0, 0, -9.81]
bodies: {bob: {kind: rigid, mass: 2, center_of_mass: [0.5, 0, 0]}}
joints: {hinge: {type: revolute, between: [ground, bob], at: [0, 0, 0], axis: [0, 1, 0]}}
simulation: {duration: 0.5, step: 0.1, method: radau, tolerance: 1e-7}
"""
    path = tmp_path / "swing.yml"
    path.write_text(text)
    with maggi.run(maggi.load(path), tmp_path / "swing.h5") as results:
        angle = results.joint("hinge").coordinate[:, 0]
        assert results.attributes["method"] == "radau"
    reference = maggi.ode(maggi.load(path)).solve((0.0, 0.5), rtol=1e-11, t_eval=np.arange(6) * 0.1)
    np.testing.assert_allclose(angle, reference.coordinates[:, 0], atol=1e-5)
