"""Good model files become the descriptions that they say."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

from maggi.elements.ritz import ritz_terms
from maggi.model import (
    IDENTITY,
    QUANTITIES,
    Attachment,
    BeamMesh,
    BoxMesh,
    BoxSet,
    CraigBampton,
    Driver,
    ElasticBody,
    End,
    FileMesh,
    GivenMotion,
    Joint,
    Model,
    ModelError,
    NamedSet,
    PlaneSet,
    PointLoad,
    PointMass,
    RigidBody,
    RigidRunMotion,
    RitzBody,
    RitzIntegrals,
    RitzTerms,
    Section,
    SpringDamper,
    TorsionSpring,
)
from maggi.model.expression import value_at
from maggi.modelfile import read, read_text

from .samples import CONTRACT, EVERYTHING, SIMEON_ROD


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rod.msh").write_text("")
    (tmp_path / "model.yml").write_text(CONTRACT, encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("none", None),
        ("{method: craig-bampton, modes: 12}", CraigBampton(12)),
        ("{modes: 2*n, method: craig-bampton}", CraigBampton(6)),
        ("{method: craig-bampton, modes: 0}", CraigBampton(0)),
    ],
)
def test_reductions(text: str, expected: CraigBampton | None) -> None:
    mesh = "{beam: {length: 1, section: {circle: {diameter: 0.1}}, elements: 3}}"
    model, _ = read_text(
        f"maggi: 1\nparameters: {{n: 3}}\nbodies:\n  bar: {{kind: elastic, mesh: {mesh}, "
        f"material: {{density: 1000, young: 1e9, poisson: 0.3}}, reduction: {text}}}\n"
    )
    bar = model.bodies["bar"]
    assert isinstance(bar, ElasticBody) and bar.reduction == expected


def test_the_contract(folder: Path) -> None:
    model, _ = read(folder / "model.yml")
    assert (model.title, model.gravity) == ("Slider-crank with an elastic connecting rod", (0.0, 0.0, -9.81))
    assert (model.folder, model.text) == (str(folder), CONTRACT)
    crank, rod = model.bodies["crank"], model.bodies["rod"]
    assert isinstance(crank, RigidBody)
    assert (crank.mass, crank.center_of_mass) == (0.4, (0.05, 0.0, 0.0))
    assert crank.inertia == ((1e-4, 0.0, 0.0), (0.0, 4e-4, 0.0), (0.0, 0.0, 4e-4))
    c, s = math.sqrt(3) / 2, 0.5  # 30 degrees about y
    np.testing.assert_allclose(crank.pose.rotation, [[c, 0, s], [0, 1, 0], [-s, 0, c]], atol=1e-15)
    assert crank.velocity.linear == (0.0, 0.0, 0.0)
    assert crank.attachments == {"pin": Attachment(at=(0.1, 0.0, 0.0))}
    assert isinstance(rod, ElasticBody)
    assert rod.mesh == FileMesh("rod.msh", 1e-3)
    assert rod.material is not None
    assert (rod.material.density, rod.material.young, rod.material.poisson) == (7850.0, 210e9, 0.3)
    assert (rod.material.damping.mass, rod.material.damping.stiffness) == (0.0, 1e-6)
    assert rod.velocity.linear is None
    assert rod.motion is None
    assert rod.attachments == {
        "big_end": Attachment(nodes=NamedSet("big_end")),
        "small_end": Attachment(nodes=NamedSet("small_end"), coupling="average"),
    }
    assert model.joints["bearing"] == Joint("revolute", End("ground"), End("crank"), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    assert model.joints["crankpin"] == Joint(
        "revolute", End("crank", "pin"), End("rod", "big_end"), None, (0.0, 1.0, 0.0)
    )
    motor = model.joints["motor"]
    assert isinstance(motor, Driver)
    assert (motor.joint, motor.quantity, motor.function.text) == ("bearing", "angle", "speed*t")
    assert value_at(motor.function, [0.04]) == pytest.approx([2 * math.pi])  # one turn of 1500 rpm
    assert model.forces["spring"] == SpringDamper(
        End("crank", "pin"), End("ground", point=(0.0, 0.0, 0.3)), 1e4, 10.0, 0.2
    )
    assert (model.outputs.every, model.outputs.quantities) == (10, ("bodies", "joints"))
    assert model.simulation is not None
    assert (model.simulation.duration, model.simulation.step, model.simulation.rho_inf) == (0.1, 1e-5, 0.9)


def test_json_says_the_same(folder: Path) -> None:
    data = YAML(typ="safe", pure=True).load(CONTRACT)
    for indent in (None, 2, "\t"):
        model, _ = read_text(json.dumps(data, indent=indent), folder=str(folder))
        same, _ = read(folder / "model.yml")
        assert model.bodies == same.bodies
        assert model.joints == same.joints
        assert model.simulation == same.simulation


def test_byte_order_mark_and_windows_lines(folder: Path) -> None:
    (folder / "bom.yml").write_bytes(b"\xef\xbb\xbf" + CONTRACT.replace("\n", "\r\n").encode())
    assert read(folder / "bom.yml")[0].bodies == read(folder / "model.yml")[0].bodies


@pytest.fixture(scope="module")
def everything() -> Model:
    return read_text(EVERYTHING)[0]


def test_meshes_and_selections(everything: Model) -> None:
    beam, block, tube, profile = (everything.bodies[name] for name in ("beam", "block", "tube", "profile"))
    assert isinstance(beam, ElasticBody) and isinstance(block, ElasticBody)
    assert isinstance(tube, ElasticBody) and isinstance(profile, ElasticBody)
    assert beam.mesh == BeamMesh(0.5, Section.rectangle(0.01, 0.02), 4)
    assert block.mesh == BoxMesh((1.0, 0.1, 0.1), (4, 1, 1), "hex20")
    assert tube.mesh == BeamMesh(1.0, Section.circle(0.02), 3)
    assert profile.mesh == BeamMesh(1.0, Section(1e-4, 1e-8, 2e-8, 3e-8, 0.8, 0.4), 3)
    assert beam.attachments["tip"].nodes == BoxSet((0.4, -1.0, -1.0), (1.0, 1.0, 1.0))
    assert beam.attachments["tip"].point_masses == (
        PointMass(1.0, (0.0, 0.1, 0.0), ((1e-3, 0.0, 0.0), (0.0, 1e-3, 0.0), (0.0, 0.0, 1e-3))),
    )
    assert block.attachments["plane"].nodes == PlaneSet((0.25, 0.0, 0.0), (1.0, 0.0, 0.0), 1e-3)
    assert block.material is not None
    assert block.material.damping.stiffness == 1e-3
    assert tube.pose.rotation == ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))


def test_prescribed_frames(everything: Model) -> None:
    beam, block, table = (everything.bodies[name] for name in ("beam", "block", "table"))
    assert isinstance(beam, ElasticBody) and isinstance(beam.motion, GivenMotion)
    assert beam.motion.origin is not None
    assert [f.text for f in beam.motion.origin] == ["0", "0", "0.1*sin(t)"]
    assert beam.motion.axis == (0.0, 0.0, 1.0)
    assert beam.motion.held == ("root",)
    assert isinstance(block, ElasticBody)
    assert block.motion == RigidRunMotion(("left",))
    assert isinstance(table, RigidBody) and table.motion is not None
    assert table.motion.origin is None


def test_joints_and_forces(everything: Model) -> None:
    kinds = [joint.kind for joint in everything.joints.values() if isinstance(joint, Joint)]
    assert kinds == ["cylindrical", "prismatic", "spherical", "universal", "planar", "weld"]
    universal = everything.joints["d"]
    assert isinstance(universal, Joint)
    assert universal.axes == ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    drivers = {name: joint.quantity for name, joint in everything.joints.items() if isinstance(joint, Driver)}
    assert drivers == {"turn": "angle", "lift": "displacement", "push": "speed"}
    load, coil, strut = (everything.forces[name] for name in ("load", "coil", "strut"))
    assert isinstance(load, PointLoad)
    assert (load.on, load.kind, load.frame) == (End("beam", "tip"), "force", "body")
    assert value_at(load.value[1], [0.0]) == [10.0]
    assert coil == TorsionSpring("a", 5.0, 0.1, math.radians(10))
    assert strut == SpringDamper(End("disc", "rim"), End("slab"), 5e3)


def test_defaults() -> None:
    model, _ = read_text("maggi: 1\nbodies: {a: {kind: rigid, mass: 1}}\njoints:\nforces:\nmaterials:\nparameters:\n")
    a = model.bodies["a"]
    assert isinstance(a, RigidBody)
    assert (a.center_of_mass, a.pose.origin, a.pose.rotation) == ((0.0,) * 3, (0.0,) * 3, IDENTITY)
    assert (a.velocity.linear, a.velocity.angular) == (None, None)
    assert (model.gravity, model.simulation, model.outputs.every) == ((0.0,) * 3, None, 1)
    assert model.outputs.quantities == QUANTITIES
    model, _ = read_text("maggi: 1\nbodies: {a: {kind: rigid, mass: 1}}\nsimulation: {duration: 1, step: 0.1}")
    assert model.simulation is not None
    assert (model.simulation.rho_inf, model.simulation.tolerance) == (0.9, 1e-8)
    assert (model.simulation.start, model.simulation.method) == ("quasi-static", "generalized-alpha")


def test_yaml_words_are_what_yaml_1_2_says() -> None:
    text = "maggi: 1\ntitle: on\nbodies: {no: {kind: rigid, mass: 1e-3}, 1: {kind: rigid, mass: 1E+1}, y: {kind: rigid, mass: 0x10}}"
    model, _ = read_text(text)
    assert model.title == "on"
    assert {name: body.mass for name, body in model.bodies.items() if isinstance(body, RigidBody)} == {
        "no": 1e-3,
        "1": 10.0,
        "y": 16.0,
    }


def test_aliases_repeat_what_they_stand_for() -> None:
    model, _ = read_text("maggi: 1\nbodies:\n  a: &link {kind: rigid, mass: 2}\n  b: *link\n")
    assert model.bodies["a"] == model.bodies["b"]


def test_a_rotation_matrix_of_few_digits_becomes_a_rotation() -> None:
    text = "maggi: 1\nbodies: {a: {kind: rigid, mass: 1, pose: {rotation: [[0.8660254, -0.5, 0], [0.5, 0.8660254, 0], [0, 0, 1]]}}}"
    R = np.array(read_text(text)[0].bodies["a"].pose.rotation)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(R[0], [math.sqrt(3) / 2, -0.5, 0.0], atol=1e-7)


def test_a_prescribed_frame_starts_where_its_functions_begin() -> None:
    text = "maggi: 1\nbodies: {a: {kind: rigid, mass: 1, frame: {origin: [1 + t, 0, cos(t)]}}}"
    assert read_text(text)[0].bodies["a"].pose.origin == (1.0, 0.0, 1.0)


def test_simeons_rod_from_a_file() -> None:
    rod = read_text(SIMEON_ROD)[0].bodies["rod"]
    assert isinstance(rod, RitzBody)
    assert isinstance(rod.terms, RitzIntegrals)
    # Tabulated data of CASES C1: FM = ρbhl, K33 = 16/3 Ebh/l; ∫ρNᵀN of the sines is FM/2, of the quadratics FM/15 [8 1; 1 2].
    rho, b, length, E = 7870.0, 0.008, 0.30, 0.2e12
    FM, FK = rho * b * b * length, E * b * b / length
    terms = ritz_terms(rod.shapes, rod.terms)
    m = FM * np.array([[0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 8 / 15, 1 / 15], [0, 0, 1 / 15, 2 / 15]])
    np.testing.assert_allclose(terms.m, m, rtol=1e-12, atol=1e-15)
    assert terms.mass == pytest.approx(0.151104, rel=1e-12)
    assert terms.J0[2, 2] == 0.0045339259
    K11 = FK * math.pi**4 / 24 * (b / length) ** 2
    np.testing.assert_allclose(np.diag(terms.k), [K11, 16 * K11, 16 / 3 * FK, 7 / 3 * FK], rtol=1e-14)
    assert rod.initial == ((0.0, 0.0, 0.103339863e-4, 0.169327969e-4), (0.0,) * 4)
    np.testing.assert_allclose(
        rod.shapes(np.array([[0.15, 0, 0]]))[0], [[0, 0, 1, 0], [1, 0, 0, 0], [0] * 4], atol=1e-15
    )


def ritz_with_constants(**changes: object) -> str:
    n = 2
    body = {
        "mass": 2.0,
        "S0": [1, 0, 0],
        "J0": [0, 1, 1],
        "m": [[2, 0.5], [0.5, 1]],
        "k": [["10 * 1", 0], [0, 20]],
        "m_O": [[1, 0, 0], [0, 1, 0]],
        "G": [[[0, k + 1.0], [-k - 1.0, 0]] for k in range(3)],
        "H": np.zeros((3, 3, n, n)).tolist(),
        "s": np.ones((3, n)).tolist(),
        "s2": np.ones((3, 3, n)).tolist(),
    }
    shapes = {"x": ["x", 0], "y": [0, "x"], "z": [0, 0]}
    rod = {
        "kind": "ritz",
        "constants": {**body, **changes},
        "shapes": shapes,
        "attachments": {"end": {"at": [1, 0, 0]}},
    }
    return json.dumps({"maggi": 1, "bodies": {"rod": rod}})


def test_constants_given_directly() -> None:
    rod = read_text(ritz_with_constants())[0].bodies["rod"]
    assert isinstance(rod, RitzBody)
    assert isinstance(rod.terms, RitzTerms)
    np.testing.assert_array_equal(rod.terms.k, [[10, 0], [0, 20]])
    np.testing.assert_array_equal(rod.terms.D, np.zeros((2, 2)))
    np.testing.assert_array_equal(rod.terms.G[2], [[0, 3], [-3, 0]])
    assert rod.terms.H.shape == (3, 3, 2, 2)
    np.testing.assert_array_equal(rod.terms.J0, np.diag([0, 1, 1]))


@pytest.mark.parametrize(
    ("changes", "path", "message"),
    [
        ({"m": [[1, 0.5], [0.4, 1]]}, "m", "m is not symmetric"),
        ({"m": [[1, 0], [0, -1]]}, "m", "m is not positive: its lowest eigenvalue is -1"),
        ({"m": [[1, 1], [1, 1]]}, "m", "m is not positive"),
        ({"k": [[1, 0], [0, -1e-3]]}, "k", "k is not positive"),
        ({"k": [[1]]}, "k", "k has the shape (1, 1), but 2 shape functions need (2, 2)"),
        ({"k": [[1, 2], [3]]}, "k.1", "expected a list of 2 as in the first row, found a list of 1"),
        ({"k": [1, 2]}, "k", "expected lists nested 2 deep, found 1"),
        ({"k": "k.npy"}, "k", "expected nested lists of numbers, found 'k.npy'"),
        ({"k": [[1, None], [3, 3]]}, "k.0.1", "expected a number, found nothing"),
        ({"k": [[1, "a"], [3, 3]]}, "k.0.1", "unknown name 'a'"),
        ({"k": [[1, True], [3, 3]]}, "k.0.1", "expected a number, found true"),
        ({"k": []}, "k", "expected lists nested 2 deep"),
        ({"G": [[[0, 1], [1, 0]]] * 3}, "G.0", "G[0] is not skew"),
        ({"H": [[[[0, 1], [0, 0]]] * 3] * 3}, "H", "H[0][0] is not the transpose of H[0][0]"),
        ({"mass": -1}, "mass", "greater than 0, found -1"),
        ({"J0": [1, 1, 5]}, "J0", "no body has this tensor of inertia"),
    ],
)
def test_wrong_constants(changes: dict[str, object], path: str, message: str) -> None:
    with pytest.raises(ModelError) as caught:
        read_text(ritz_with_constants(**changes))
    assert caught.value.path == f"bodies.rod.constants.{path}"
    assert message in caught.value.message
