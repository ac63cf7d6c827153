"""All pictures are made, of whatever was kept; what they show is tested where it is computed."""

from dataclasses import replace

import fake_runs
import numpy as np
import pytest
from matplotlib.image import imread

from maggi.analyses.recorder import BodyLayout, Layout, Row
from maggi.analyses.scene import Scene, SceneBody, SceneJoint
from maggi.model.errors import ModelError
from maggi.results.memory import MemoryRecorder
from maggi.view.energy import energy_figure
from maggi.view.joints import joints_figure
from maggi.view.mechanism import mechanism_figure
from maggi.view.plots import FIGURES, plot_results, plot_scene
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
            Row(
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
        recorder.write(row)
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


@pytest.mark.parametrize(
    "kind", ["revolute", "prismatic", "cylindrical", "spherical", "planar", "universal", "weld", "driver", "gear"]
)
def test_every_kind_of_joint_has_a_symbol(kind):
    axis = None if kind in ("spherical", "weld") else np.array([1.0, 2.0, 0.5])
    body = SceneBody("one", "rigid", np.zeros(3), np.eye(3), np.array([0.1, 0.0, 0.0]))
    joint = SceneJoint("pin", kind, "ground", "one", np.zeros(3), axis)
    bare = scene_figure(Scene("", np.zeros(3), (body,), (), ()))
    figure = scene_figure(Scene("", np.zeros(3), (body,), (), (joint,)))

    def artists(one):
        return len(one.axes[-1].collections) + len(one.axes[-1].lines)

    assert artists(figure) > artists(bare)


def test_scenes_with_next_to_nothing(tmp_path):
    empty = Scene("", np.zeros(3), (), (), ())
    assert len(plot_scene(empty, tmp_path, "empty")) == 1
    nodes, cells = np.array([[0.0, 0, 0], [1, 0, 0]]), {"beam2": np.array([[0, 1]])}
    body = SceneBody("beam", "mesh", np.zeros(3), np.eye(3), np.zeros(3), nodes, cells)
    assert len(plot_scene(replace(empty, bodies=(body,)), tmp_path, "beam")) == 1
