"""`maggi check --formulations`, with the real core."""

import json

import pytest
from click.testing import CliRunner

from maggi.cli.main import main

PENDULUM = """\
maggi: 1
title: Double pendulum
gravity: [0, 0, -9.81]
bodies:
  upper: {kind: rigid, mass: 2, center_of_mass: [0.5, 0, 0], inertia: [0, 0.2, 0.2], velocity: {angular: [0, 3, 0]}}
  lower: {kind: rigid, mass: 1, center_of_mass: [0.5, 0, 0], inertia: [0, 0.1, 0.1], pose: {origin: [1, 0, 0]}}
joints:
  hinge: {type: revolute, between: [ground, upper], at: [0, 0, 0], axis: [0, 1, 0]}
  knee: {type: revolute, between: [upper, lower], at: [1, 0, 0], axis: [0, 1, 0]}
"""


@pytest.fixture
def maggi_check(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def run(text, *options):
        (tmp_path / "model.yml").write_text(text)
        return CliRunner().invoke(main, ["check", "model.yml", *options])

    return run


def test_text(maggi_check):
    said = maggi_check(PENDULUM, "--formulations")
    assert said.exit_code == 0
    assert "true freedoms" in said.stdout
    for name in ("Lagrange", "Gibbs–Appell", "Kane", "Newton–Euler"):
        assert name in said.stdout
    assert "all five agree" in said.stdout


def test_only_where_asked_for(maggi_check):
    assert "Newton–Euler" not in maggi_check(PENDULUM).stdout


def test_json(maggi_check):
    said = json.loads(maggi_check(PENDULUM, "--formulations", "--json").stdout)
    assert said["status"] == "complete"
    assert said["formulations"]["agree"] is True
    assert said["formulations"]["velocities"] == 12
    assert said["formulations"]["freedoms"] == 2
    assert max(d["accelerations"] for d in said["formulations"]["differences"]) < 1e-10


def test_a_disagreement_ends_with_status_one(maggi_check, monkeypatch):
    """As it would with a mistake in the program: here the limit is put below round-off."""
    monkeypatch.setattr("maggi.analyses.compare_formulations.AGREEMENT", 1e-30)
    said = maggi_check(PENDULUM, "--formulations")
    assert said.exit_code == 1
    assert "THEY DISAGREE" in said.stdout
    assert "please report it" in said.stderr


def test_problems_of_the_model_come_first(maggi_check):
    """Joints that do not meet: told as without the option, and nothing is compared."""
    apart = PENDULUM.replace("velocity:", "attachments: {tip: {at: [1, 0, 0]}}, velocity:")
    apart = apart.replace("pose: {origin: [1, 0, 0]}", "attachments: {top: {at: [0, 0, 0]}}, pose: {origin: [2, 0, 0]}")
    apart = apart.replace("[upper, lower], at: [1, 0, 0]", "[upper.tip, lower.top]")
    said = maggi_check(apart, "--formulations")
    assert said.exit_code == 2
    assert "do not meet" in said.stderr
    assert "Newton–Euler" not in said.stdout
