"""All pictures are made, of whatever was kept; what they show is tested where it is computed."""

from dataclasses import replace

import fake_runs
import numpy as np
import pytest
from matplotlib.image import imread

from maggi.analyses.outline import Outline
from maggi.analyses.recorder import BodyLayout, JointLayout, Layout
from maggi.analyses.scene import Scene, SceneBody, SceneJoint
from maggi.model.errors import ModelError
from maggi.model.joint_kinds import JOINT_COORDINATES
from maggi.results.memory import MemoryRecorder
from maggi.view.energy import energy_figure
from maggi.view.joints import joints_figure
from maggi.view.mechanism import mechanism_figure
from maggi.view.outlines import COUPLERS
from maggi.view.plots import FIGURES, plot_results, plot_scene
from maggi.view.projection import axonometric, facing
from maggi.view.residuals import residuals_figure
from maggi.view.scene import scene_figure
from maggi.view.style import style


@pytest.fixture(autouse=True)
def small_pictures(monkeypatch):
    monkeypatch.setattr("maggi.view.style.DOTS_PER_INCH", 50)


def kept(*quantities, rows=31):
    recorder = MemoryRecorder(quantities or ("bodies", "attachments", "displacement", "joints", "energy", "residuals"))
    fake_runs.record(recorder, rows)
    return recorder.results()


def test_all_pictures(tmp_path):
    written = plot_results(kept(), tmp_path / "pictures", "run")
    assert [path.name for path in written] == [f"run_{name}.png" for name in FIGURES]
    for path in written:
        picture = imread(path)
        assert min(picture.shape[:2]) > 100
        assert picture[..., :3].std() > 0.02  # something is drawn


@pytest.mark.parametrize(
    ("quantities", "names"),
    [
        (("bodies",), {"mechanism"}),
        (("attachments",), {"motion"}),
        (("joints",), {"joints", "motion"}),
        (("displacement",), {"deflection"}),
        (("energy",), {"energy"}),
        (("residuals",), {"residuals"}),
        (("bodies", "attachments"), {"mechanism", "motion"}),
        (("bodies", "displacement"), {"mechanism", "deflection"}),
    ],
)
def test_pictures_of_what_was_kept(quantities, names):
    results = kept(*quantities, rows=5)
    assert {name for name, make in FIGURES.items() if make(results) is not None} == names


@pytest.mark.parametrize("rows", [1, 2])
def test_short_runs(tmp_path, rows):
    assert len(plot_results(kept(rows=rows), tmp_path, "run")) == len(FIGURES)


def test_a_run_without_rows(tmp_path):
    recorder = MemoryRecorder()
    recorder.begin(fake_runs.layout(1))
    with pytest.raises(ModelError, match="nothing to draw"):
        plot_results(recorder.results(), tmp_path, "run")


def test_a_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(ModelError, match="cannot write to"):
        plot_results(kept("energy", rows=2), tmp_path / "taken", "run")


def lines(axes):
    return {line.get_label(): np.asarray(line.get_ydata()) for line in axes.get_lines()}


def test_joint_chart_shows_the_forces():
    figure = joints_figure(kept())
    upper, *_, lower = figure.axes
    assert list(lines(upper)) == ["bearing", "crankpin", "wristpin", "clamp"]  # the motor carries none
    assert lines(upper)["crankpin"].max() == pytest.approx(fake_runs.FORCE)
    assert lines(lower)["motor, Ty"].max() == pytest.approx(12.0, rel=1e-2)


def test_small_energies_get_a_chart_of_their_own():
    figure = energy_figure(kept())
    assert set(lines(figure.axes[1])) == {"strain", "gravity", "dissipated"}
    assert figure.axes[1].get_ylabel() == "energy [mJ]"
    assert np.abs(lines(figure.axes[-1])["balance"]).max() < 1e-9


def test_residuals_are_drawn_on_a_logarithmic_scale():
    figure = residuals_figure(kept())
    assert figure.axes[0].get_yscale() == "log"
    assert "acceleration: at most 6.0e-09" in lines(figure.axes[0])


def test_the_mechanism_is_drawn_in_its_plane():
    with style():
        figure = mechanism_figure(kept())
    panels = [axes for axes in figure.axes if axes.get_title(loc="left")]
    assert len(panels) == 4
    assert panels[0].get_ylabel() == "z [m]"
    assert "×20" in figure.get_suptitle()


def spatial_rows(count):
    """A beam that turns about z while it goes up and bends: no plane."""
    nodes = np.stack([np.linspace(0, 0.1, 6), np.zeros(6), np.zeros(6)], axis=1)
    cells = {"beam2": np.stack([np.arange(5), np.arange(1, 6)], axis=1)}
    body = BodyLayout("beam", "mesh", ("root", "tip"), nodes[[0, -1]], nodes, cells)
    layout = Layout((body,), (), count, {"title": "$ 5 & $x"})
    rows = []
    for t in np.linspace(0.0, 1.0, count):
        a = 4.0 * t
        turn = np.array([[np.cos(a), -np.sin(a), 0.0], [np.sin(a), np.cos(a), 0.0], [0.0, 0.0, 1.0]])
        origin = np.array([0.0, 0.0, 0.1 * t])
        shift = np.zeros((6, 3))
        shift[:, 2] = 1e-3 * t * (nodes[:, 0] / 0.1) ** 2
        ends = origin + (nodes + shift)[[0, -1]] @ turn.T
        some = fake_runs.row(float(t))
        rows.append(
            fake_runs.Row(
                float(t), origin[None], turn[None], ends, np.stack([turn, turn]), np.ones((2, 3)), np.ones((2, 3)),
                (shift,), (), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), (), some.energy, some.residuals, 1,
            )
        )  # fmt: skip
    return layout, rows


def test_a_spatial_mechanism_of_beams_without_joints(tmp_path):
    layout, rows = spatial_rows(12)
    recorder = MemoryRecorder()
    recorder.begin(layout)
    for row in rows:
        recorder.write(row.rows())
    recorder.end("complete")
    results = recorder.results()
    assert joints_figure(results) is None
    assert mechanism_figure(results).axes[0].axison is False  # the paper's axes are not the global ones
    assert len(plot_results(results, tmp_path, "run")) == len(FIGURES) - 1  # dollar signs in a title do no harm


def test_scene_of_a_planar_mechanism(tmp_path):
    figure = scene_figure(fake_runs.scene())
    plane, above = figure.axes
    assert (plane.get_xlabel(), plane.get_ylabel()) == ("x [m]", "z [m]")
    written = {text.get_text() for text in plane.texts}
    assert {"crank", "rod", "piston", "crankpin (revolute)", "bearing (revolute)\nmotor (driver)", "g"} <= written
    assert not above.axison
    (path,) = plot_scene(fake_runs.scene(), tmp_path, "model")
    assert path.name == "model_model.png"


def test_labels_do_not_overlap():
    figure = scene_figure(fake_runs.scene())
    figure.draw_without_rendering()
    labels = [text for text in figure.axes[0].texts if len(text.get_text()) > 1]
    boxes = [text.get_bbox_patch().get_window_extent() for text in labels]
    for i, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[:i])


KINDS = [
    *(kind for kind in JOINT_COORDINATES),
    "driver",
    "distance",
    "point-on-curve",
    "point-on-surface",
    "cam",
    "rolling-disc",
    "rolling-sphere",
    "knife-edge",
    "pfaffian",
]


def artists(figure):
    return len(figure.axes[-1].collections) + len(figure.axes[-1].lines)


ONE = SceneBody("one", "rigid", np.zeros(3), np.eye(3), np.array([0.1, 0.0, 0.0]))


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_joint_has_a_symbol(kind):
    axis = None if kind in ("spherical", "weld") else np.array([1.0, 2.0, 0.5])
    joint = SceneJoint("pin", kind, "ground", "one", np.zeros(3), axis)
    bare = scene_figure(Scene("", np.zeros(3), (ONE,), (), ()))
    assert artists(scene_figure(Scene("", np.zeros(3), (ONE,), (), (joint,)))) > artists(bare)


@pytest.mark.parametrize("kind", COUPLERS)
def test_relations_are_lines_between_joints(kind):
    joints = tuple(
        SceneJoint(name, "revolute", "ground", "one", np.array([x, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
        for name, x in (("a", 0.0), ("one", 1.0), ("c", 3.0))  # a joint may be called like a body
    )
    coupler = SceneJoint("relation", kind, "a, one", "c", np.array([3.0, 0.0, 0.0]), None)
    figure = scene_figure(Scene("", np.zeros(3), (ONE,), (), (*joints, coupler)))
    dashed = [line for line in figure.axes[0].lines if line.get_linestyle() == "--"]
    assert [line.get_xdata().tolist() for line in dashed] == [[0.0, 1.0, 3.0]]


def wheel_of(radius, place=(0.0, 0.0, 0.0)):
    angles = np.linspace(0.0, 2.0 * np.pi, 37)
    rim = np.stack([np.cos(angles), 0 * angles, np.sin(angles)], axis=1)
    return Outline(second=np.array(place) + radius * rim)


def test_wheels_and_rods_of_a_scene():
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # x to y, y to −x
    wheel = SceneBody("wheel", "rigid", np.array([3.0, 0.0, 0.5]), turn, np.array([3.0, 0.0, 0.5]))
    up = np.array([0.0, 0.0, 1.0])
    rod = Outline(np.array([[0.0, 1.0, 0.0]]), np.array([[0.0, 0.0, 2.0]]))
    joints = (
        SceneJoint("rolls", "rolling-disc", "ground", "wheel", wheel.origin, None, wheel_of(0.5)),
        SceneJoint("rod", "distance", "wheel", "[0, 0, 2]", 2.0 * up, None, rod),
        SceneJoint("bearing", "revolute", "ground", "one", np.zeros(3), np.array([1.0, 0.0, 0.0])),
    )
    figure = scene_figure(Scene("", -9.81 * up, (ONE, wheel), (), joints))
    camera = facing(np.array([1.0, 0.0, 0.0]), up)
    drawn = [np.asarray(line.get_xydata()) for line in figure.axes[0].lines]
    rim = next(one for one in drawn if len(one) == 37)
    assert np.linalg.norm(rim - [0.0, 0.5], axis=1) == pytest.approx(np.full(37, 0.5))
    assert rim[:, 1].min() == pytest.approx(0.0, abs=1e-12)
    # the rod's first end is at (0, 1, 0) of the turned wheel
    assert any(
        len(one) == 2 and np.allclose(one, camera.flat(np.array([[2.0, 0.0, 0.5], [0.0, 0.0, 2.0]]))) for one in drawn
    )
    # a body that is a wheel needs no block at its centre
    blade = replace(joints[0], kind="knife-edge")
    rolling, sliding = (scene_figure(Scene("", up, (wheel,), (), (joint,))) for joint in (joints[0], blade))
    assert artists(sliding) == artists(rolling) + 1


def rolling(rows, speed):
    """Two wheels 1 m apart that roll along x while the line between them turns a little about z."""
    bodies = tuple(BodyLayout(name, "rigid", (), np.zeros((0, 3))) for name in ("rear", "front"))
    joints = tuple(
        JointLayout(f"{name}_rolls", "rolling-disc", "ground", name, (), wheel_of(0.25)) for name in ("rear", "front")
    )
    recorder = MemoryRecorder(("bodies", "joints"))
    recorder.begin(Layout(bodies, joints, rows, {}, (0.0, 0.0, 9.81)))
    for t in np.linspace(0.0, 5.0, rows):
        a, some = 0.2 * np.sin(t), fake_runs.row(float(t))
        origin = np.array([[speed * t, 0.0, -0.25], [speed * t + np.cos(a), np.sin(a), -0.25 - 0.1 * np.sin(2 * t)]])
        nothing = np.zeros((2, 3))
        recorder.write(
            replace(
                some, origin=origin, rotation=np.stack([np.eye(3)] * 2), position=nothing[:0], attachment_rotation=np.zeros((0, 3, 3)),
                velocity=nothing[:0], angular_velocity=nothing[:0], displacement=(), modal=(), joint_position=origin,
                force=nothing, torque=nothing, unique=np.ones(2, dtype=np.int64), coordinate=(np.zeros(0),) * 2,
            ).rows()
        )  # fmt: skip
    recorder.end("complete")
    return recorder.results()


def test_the_view_goes_along_with_what_travels():
    figure = mechanism_figure(rolling(40, 5.0))
    assert "the view goes along" in figure.get_suptitle()
    camera = axonometric(vertical=np.array([0.0, 0.0, -1.0]))  # gravity is along +z
    for axes in figure.axes:
        rims = [np.asarray(line.get_xydata()) for line in axes.lines if len(line.get_xdata()) == 37]
        assert len(rims) == 2
        (low, high), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        assert high - low < 3.0
        for rim in rims:
            assert (low < rim[:, 0]).all() and (rim[:, 0] < high).all()
            assert (bottom < rim[:, 1]).all() and (rim[:, 1] < top).all()
            half = 0.25 * np.linalg.norm(camera.flat(np.array([0.0, 0.0, 1.0])))
            assert np.ptp(rim[:, 1]) >= 2 * half - 1e-12
    still = mechanism_figure(rolling(40, 0.5))
    assert all(len(axes.lines) >= 4 for axes in still.axes)  # two rims and the ways of the two centres
    assert "the view goes along" not in still.get_suptitle()
    assert len({axes.get_xlim() for axes in still.axes}) == 1


def test_bodies_that_only_turn_are_seen_to_turn():
    body = BodyLayout("wheel", "rigid", (), np.zeros((0, 3)))
    recorder = MemoryRecorder(("bodies",))
    recorder.begin(Layout((body,), (), 30, {}))
    for t in np.linspace(0.0, 1.5, 30):
        c, s = np.cos(t), np.sin(t)
        turn, none, some = (
            np.array([[[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]]),
            np.zeros((0, 3)),
            fake_runs.row(float(t)),
        )
        recorder.write(
            replace(
                some, origin=np.zeros((1, 3)), rotation=turn, position=none, attachment_rotation=np.zeros((0, 3, 3)), velocity=none,
                angular_velocity=none, displacement=(), modal=(), joint_position=none, force=none, torque=none,
                unique=np.zeros(0, dtype=np.int64), coordinate=(),
            ).rows()
        )  # fmt: skip
    recorder.end("complete")
    assert len(mechanism_figure(recorder.results()).axes) == 4


def test_scenes_with_next_to_nothing(tmp_path):
    empty = Scene("", np.zeros(3), (), (), ())
    assert len(plot_scene(empty, tmp_path, "empty")) == 1
    nodes, cells = np.array([[0.0, 0, 0], [1, 0, 0]]), {"beam2": np.array([[0, 1]])}
    body = SceneBody("beam", "mesh", np.zeros(3), np.eye(3), np.zeros(3), nodes, cells)
    assert len(plot_scene(replace(empty, bodies=(body,)), tmp_path, "beam")) == 1
