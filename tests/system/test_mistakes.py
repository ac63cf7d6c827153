"""What cannot be built: each mistake with its place in the model, what is wrong and what helps."""

from dataclasses import replace

import numpy as np
import pytest

from maggi.bodies import mesh_body
from maggi.model.attachments import Attachment, BoxSet, NamedSet
from maggi.model.bodies import ElasticBody, RigidBody, RitzBody
from maggi.model.errors import ModelError
from maggi.model.expression import expression
from maggi.model.forces import PointLoad, SpringDamper, TorsionSpring
from maggi.model.joints import Driver, End, Joint
from maggi.model.materials import Material
from maggi.model.meshes import BeamMesh, BoxMesh, FileMesh, Section
from maggi.model.model import Model
from maggi.model.shapes import LineQuadrature, RitzIntegrals
from maggi.system.build import build_system

STEEL = Material(7800.0, 2e11, 0.3)
PIN = {"pin": Attachment(at=(1.0, 0.0, 0.0))}
BOX = BoxMesh((1.0, 1.0, 1.0), (1, 1, 1))
ZERO = (expression(0.0),) * 3


def shapes(x):
    return np.concatenate([x[:, :, None], np.ones_like(x)[:, :, None]], axis=2)


def ritz(**changes):
    integrals = RitzIntegrals(1000.0, LineQuadrature(1.0, 0.01, 3), np.eye(2))
    return replace(RitzBody(integrals, shapes, attachments=PIN), **changes)


def elastic(mesh=BOX, material=STEEL, **attachments):
    return ElasticBody(mesh, material, attachments=attachments)


PARTS = {
    "arm": RigidBody(1.0, attachments=PIN),
    "leg": RigidBody(1.0, attachments={"foot": Attachment(at=(0.0, 3.0, 0.0))}),
    "plate": elastic(low=Attachment(nodes=NamedSet("x_min"))),
}
PLACE, AXIS = (0.5, 0.0, 0.0), (0.0, 0.0, 1.0)
END = {name: End(*name.split(".")) for name in ("ground", "arm", "leg", "plate", "arm.pin", "leg.foot", "plate.low")}
HINGE = {"hinge": Joint("revolute", END["ground"], END["arm"], at=PLACE, axis=AXIS)}


def bodies(**new):
    return Model(PARTS | new)


def joint(kind, first, second, **keys):
    ends = (END.get(end) or End(*end.split(".")) for end in (first, second))
    return Model(PARTS, {"j": Joint(kind, *ends, **keys)})


def driven(kind, what, of="j"):
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    joined = Joint(kind, END["ground"], END["arm"], at=PLACE, axis=AXIS, axes=axes)
    return Model(PARTS, {"j": joined, "d": Driver(of, what, expression("t"))})


def force(made):
    return Model(PARTS, HINGE, {"f": made})


MISTAKES = {
    "rigid attachment without a point": (
        lambda: bodies(new=RigidBody(1.0, attachments={"pin": Attachment()})),
        ("bodies.new.attachments.pin", "needs a point", "give `at: [x, y, z]`"),
    ),
    "ritz attachment without a point": (
        lambda: bodies(new=ritz(attachments={"pin": Attachment()})),
        ("bodies.new.attachments.pin", "needs a point", "give `at: [x, y, z]`"),
    ),
    "shape functions not finite at the attachment": (
        lambda: bodies(new=ritz(shapes=lambda x: np.where(x[0, 0] == 1.0, np.nan, shapes(x)))),
        ("bodies.new.attachments.pin", "not finite here", "move the attachment"),
    ),
    "shape functions of a wrong size": (
        lambda: bodies(new=ritz(shapes=lambda x: shapes(x)[:, :2])),
        ("bodies.new", "shapes gave an array of shape (3, 2, 2) at 3 points", "return (3, 3, n)"),
    ),
    "elastic attachment without nodes": (
        lambda: bodies(new=elastic(pin=Attachment(at=PLACE))),
        ("bodies.new.attachments.pin", "needs nodes", "named set"),
    ),
    "elastic attachment with an unknown set": (
        lambda: bodies(new=elastic(pin=Attachment(nodes=NamedSet("x_mim")))),
        ("bodies.new.attachments.pin.nodes", "x_mim", "x_min"),
    ),
    "elastic attachment on an edge": (
        lambda: bodies(new=elastic(pin=Attachment(nodes=BoxSet((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))))),
        ("bodies.new.attachments.pin", "2 nodes lie on one line or are too few", "at least three nodes"),
    ),
    "rigid attachments that overlap": (
        lambda: bodies(new=elastic(low=Attachment(nodes=NamedSet("x_min")), side=Attachment(nodes=NamedSet("y_min")))),
        ("bodies.new.attachments.side", "'low' and 'side' share nodes", "average"),
    ),
    "no material": (
        lambda: bodies(new=elastic(material=None)),
        ("bodies.new", "has no material, and neither has its mesh file", "add `material:`"),
    ),
    "beam without a material": (
        lambda: bodies(new=elastic(BeamMesh(1.0, Section.circle(0.1), 2), None)),
        ("bodies.new", "a beam needs a material", "add `material:`"),
    ),
    "beam attachment of several nodes": (
        lambda: bodies(
            new=elastic(
                BeamMesh(1.0, Section.circle(0.1), 2), pin=Attachment(nodes=BoxSet((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
            )
        ),
        ("bodies.new.attachments.pin", "selects 3 nodes of a beam", "`start` and `end`"),
    ),
    "missing mesh file": (
        lambda: bodies(new=elastic(FileMesh("nowhere.msh"))),
        ("bodies.new.mesh.file", "nowhere.msh", ""),
    ),
    "unknown joint type": (
        lambda: joint("hinge", "ground", "arm", at=PLACE),
        ("joints.j.type", "there is no joint type 'hinge'", "revolute, prismatic, cylindrical"),
    ),
    "joint without a place": (
        lambda: joint("revolute", "ground", "arm", axis=AXIS),
        ("joints.j", "has no place", "give `at: [x, y, z]`"),
    ),
    "joint with two places": (
        lambda: joint("revolute", "arm.pin", "leg.foot", at=PLACE, axis=AXIS),
        ("joints.j.at", "both attachments are named (3.16 m apart)", "leave out `at`"),
    ),
    "joint without an axis": (
        lambda: joint("revolute", "ground", "arm", at=PLACE),
        ("joints.j", "has no axis", "give `axis: [x, y, z]`"),
    ),
    "universal joint without axes": (
        lambda: joint("universal", "ground", "arm", at=PLACE, axis=AXIS),
        ("joints.j", "has no axes", "give `axes: [on first, on second]`"),
    ),
    "universal joint with a skew cross": (
        lambda: joint("universal", "ground", "arm", at=PLACE, axes=((1.0, 0.0, 0.0), (3.0, 4.0, 0.0))),
        ("joints.j.axes", "not at right angles (cosine 0.6)", "perpendicular"),
    ),
    "joint to an unknown body": (
        lambda: joint("spherical", "ground", "nose", at=PLACE),
        ("joints.j.between", "there is no body 'nose'", "ground, arm, leg, plate"),
    ),
    "joint to an unknown attachment": (
        lambda: joint("spherical", "ground", "arm.tip"),
        ("joints.j.between", "body 'arm' has no attachment 'tip'", "it has pin"),
    ),
    "joint to an attachment of ground": (
        lambda: joint("spherical", "ground.post", "arm"),
        ("joints.j.between", "body 'ground' has no attachment 'post'", "add it under `attachments:`"),
    ),
    "elastic body joined at no attachment": (
        lambda: joint("spherical", "ground", "plate", at=PLACE),
        ("joints.j.between", "elastic body 'plate' is held without", "write `plate.<attachment>`"),
    ),
    "driver of nothing": (
        lambda: driven("revolute", "angle", of="hinge"),
        ("joints.d.joint", "there is no joint 'hinge'", "name a joint"),
    ),
    "driver of another driver": (
        lambda: driven("revolute", "angle", of="d"),
        ("joints.d.joint", "there is no joint 'd'", "name a joint"),
    ),
    "angle of a prismatic joint": (
        lambda: driven("prismatic", "angle"),
        ("joints.d.joint", "'j' (prismatic) has 0 coordinates that `angle` could mean", "revolute or cylindrical"),
    ),
    "displacement of a planar joint": (
        lambda: driven("planar", "displacement"),
        ("joints.d.joint", "(planar) has 2 coordinates that `displacement` could mean", "prismatic or cylindrical"),
    ),
    "speed of a cylindrical joint": (
        lambda: driven("cylindrical", "speed"),
        ("joints.d.joint", "(cylindrical) has 2 coordinates that `speed` could mean", ""),
    ),
    "angle of a spherical joint": (
        lambda: driven("spherical", "angle"),
        ("joints.d.joint", "(spherical) has 0 coordinates", ""),
    ),
    "load on an elastic body at no attachment": (
        lambda: force(PointLoad(END["plate"], "force", ZERO)),
        ("forces.f.on", "elastic body 'plate' is held without", "write `plate.<attachment>`"),
    ),
    "load on an unknown attachment": (
        lambda: force(PointLoad(End("arm", "tip"), "force", ZERO)),
        ("forces.f.on", "no attachment 'tip'", "it has pin"),
    ),
    "load on an unknown body": (
        lambda: force(PointLoad(End("nose"), "torque", ZERO)),
        ("forces.f.on", "there is no body 'nose'", "bodies are ground"),
    ),
    "spring between coinciding points": (
        lambda: force(SpringDamper(END["arm.pin"], End("ground", point=(1.0, 0.0, 0.0)))),
        ("forces.f.between", "ends coincide", "torsion spring"),
    ),
    "torsion spring on no joint": (
        lambda: force(TorsionSpring("knee")),
        ("forces.f.joint", "there is no joint 'knee'", "name a joint"),
    ),
}


@pytest.mark.parametrize(("make", "expected"), MISTAKES.values(), ids=MISTAKES)
def test_mistake(make, expected):
    path, message, remedy = expected
    with pytest.raises(ModelError) as error:
        build_system(make())
    assert error.value.path == path
    assert message in error.value.message
    assert remedy in error.value.remedy


def file_mesh(monkeypatch, **changes):
    """A body whose mesh file holds one hexahedron, changed."""
    cube = mesh_body.load_mesh(BOX, ".", "")
    monkeypatch.setattr(mesh_body, "load_mesh", lambda *_: replace(cube, **changes))


def test_beam_cells_in_a_file(monkeypatch):
    """Nothing in a file says what section they have."""
    file_mesh(monkeypatch, cells={"beam2": np.array([[0, 1]])})
    with pytest.raises(ModelError, match="beam cells") as error:
        build_system(Model({"new": elastic()}))
    assert error.value.path == "bodies.new.mesh"
    assert "use `beam:`" in error.value.remedy


def test_cells_without_a_material_of_the_file(monkeypatch):
    file_mesh(monkeypatch, materials={"steel": STEEL}, cell_materials={"hex8": np.array([-1])})
    with pytest.raises(
        ModelError, match="1 hex8 cells have no material in the mesh file, the first is cell 1"
    ) as error:
        build_system(Model({"new": elastic(material=None)}))
    assert "SOLID SECTION" in error.value.remedy


def test_materials_of_the_file_are_used(monkeypatch):
    file_mesh(monkeypatch, materials={"steel": STEEL}, cell_materials={"hex8": np.array([0])})
    system = build_system(Model({"new": elastic(material=None)}))
    assert system.bodies.mass[1] == pytest.approx(7800.0)
