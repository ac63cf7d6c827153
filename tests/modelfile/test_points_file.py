"""Curves from files of points: what is read, and where mistakes are."""

from __future__ import annotations

from pathlib import Path

import pytest

from maggi.model import Cam, ModelError, ModelErrors, PointOnCurve, SplineCurve
from maggi.modelfile import read
from maggi.modelfile.points_file import read_points

MODEL = """\
maggi: 1
bodies: {cam: {kind: rigid, mass: 1}, lever: {kind: rigid, mass: 1}}
joints:
  slot: {type: point-on-curve, between: [ground, lever], at: [0, 0, 0], curve: {file: slot.csv, unit: mm}}
  lift: {type: cam, between: [cam, lever], at: [0, 0, 0], axis: [0, 0, 1], profile: {file: cam.txt, unit: 10 mm}}
"""
SLOT = "x,y,z\n0,0,0\n10, 1e1,-5.\n\n# the end\n20,.5,0 # last\n"
CAM = "\ufeff1 0\n0\t1\n-1;0\n0,-1"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "model.yml").write_text(MODEL, encoding="utf-8")
    (tmp_path / "slot.csv").write_text(SLOT, encoding="utf-8")
    (tmp_path / "cam.txt").write_text(CAM, encoding="utf-8")
    return tmp_path


def test_points_in_their_unit(folder: Path) -> None:
    model, _ = read(folder / "model.yml")
    slot, lift = model.joints["slot"], model.joints["lift"]
    assert isinstance(slot, PointOnCurve)
    assert slot.curve == SplineCurve(((0.0, 0.0, 0.0), (0.01, 0.01, -0.005), (0.02, 0.0005, 0.0)))
    assert isinstance(lift, Cam)
    assert lift.profile == SplineCurve(
        ((0.01, 0.0, 0.0), (0.0, 0.01, 0.0), (-0.01, 0.0, 0.0), (0.0, -0.01, 0.0)), closed=True
    )


def test_lines_are_counted_as_editors_do(folder: Path) -> None:
    _, lines = read_points(folder / "slot.csv", 1.0)
    assert lines == (2, 3, 6)


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("0,0\n1,a\n", 2, "expected a number, found 'a'"),
        ("0,0\n1,\n", 2, "expected a number, found ''"),
        ("0,0\n1,nan\n", 2, "expected a number, found 'nan'"),
        ("0,0\n1,1_0\n", 2, "expected a number, found '1_0'"),
        ("0,0\n1,1e999\n", 2, "the number 1e999 is too large"),
        ("0,0\n1,1,1\n", 2, "expected 2 numbers, found 3: '1,1,1'"),
        ("x,y,z\n\n1\n", 3, "expected 2 or 3 numbers, found 1: '1'"),
        ("s,x,y\n", 1, "expected a number, found 's'"),
        ("0,0\nx,y\n", 2, "expected a number, found 'x'"),
        ("1,5;2,5\n", 1, "expected 2 or 3 numbers, found 4"),
        ("0,0\n1,1\n1,1\n", 3, "points 2 and 3 are the same"),
        ("0,0\n", 0, "a curve needs at least 2 points, found 1"),
        ("", 0, "a curve needs at least 2 points, found 0"),
    ],
)
def test_mistakes_are_named_with_their_line_in_the_file(folder: Path, text: str, line: int, message: str) -> None:
    (folder / "slot.csv").write_text(text, encoding="utf-8")
    with pytest.raises(ModelErrors) as caught:
        read(folder / "model.yml")
    (error,) = caught.value.errors
    assert message in error.message
    assert (error.file, error.line) == (str(folder / "slot.csv"), line)
    assert error.path.startswith("joints.slot.curve")


def test_a_profile_that_repeats_its_first_point(folder: Path) -> None:
    (folder / "cam.txt").write_text(CAM + "\n1,0\n", encoding="utf-8")
    with pytest.raises(ModelErrors) as caught:
        read(folder / "model.yml")
    (error,) = caught.value.errors
    assert "the last point is the first again" in error.message
    assert (error.file, error.line) == (str(folder / "cam.txt"), 5)


def test_files_that_cannot_be_read(folder: Path) -> None:
    def found() -> ModelError:
        with pytest.raises(ModelErrors) as caught:
            read(folder / "model.yml")
        (error,) = caught.value.errors
        assert error.path == "joints.slot.curve.file"
        assert (error.file, error.line) == (str(folder / "model.yml"), 4)
        return error

    slot = folder / "slot.csv"
    slot.write_bytes(b"\xff\xfe0,0\n")
    assert "is not a text in UTF-8" in found().message
    slot.write_bytes(b"0" * 10_000_001)
    assert "more than 10000000 bytes" in found().message
    slot.unlink()
    assert f"no file '{slot}'" in found().message
    assert "model file's folder" in found().remedy
    slot.mkdir()
    assert "is a folder" in found().message


def test_a_pipe_is_not_waited_for(folder: Path) -> None:
    import os

    if not hasattr(os, "mkfifo"):
        pytest.skip("no pipes on this system")
    (folder / "slot.csv").unlink()
    os.mkfifo(folder / "slot.csv")
    with pytest.raises(ModelErrors, match="not a regular file"):
        read(folder / "model.yml")


def test_a_wrong_unit_is_said_once(folder: Path) -> None:
    (folder / "model.yml").write_text(MODEL.replace("unit: mm", "unit: kg"), encoding="utf-8")
    with pytest.raises(ModelErrors) as caught:
        read(folder / "model.yml")
    (error,) = caught.value.errors
    assert (error.path, error.message) == ("joints.slot.curve.unit", "expected a length, got a mass: 1 kg")
