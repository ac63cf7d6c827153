"""Full-mesh models of any size: a hinged bar, several of it, and a slider-crank with an elastic rod."""

from __future__ import annotations

from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import CraigBampton, ElasticBody, RigidBody
from maggi.model.expression import expression
from maggi.model.geometry import Pose
from maggi.model.joints import Driver, End, Joint
from maggi.model.materials import Damping, Material
from maggi.model.meshes import BoxMesh
from maggi.model.model import Model
from maggi.model.simulation import Simulation

STEEL = Material(7850.0, 2.1e11, 0.3)
# A hundredth of critical damping at some 3 kHz: a rod that rings for ever is nobody's model
DAMPED = Material(7850.0, 2.1e11, 0.3, Damping(0.0, 1e-6))
Y = (0.0, 1.0, 0.0)
BAR_STEP = 1e-3  # s: the bar swings with a period of about 2 s
CRANK_STEP = 4e-5  # s: 500 steps a turn at 3000 rpm


def cells_for(freedoms: int, cell: str) -> tuple[int, int, int]:
    """Cells of a bar 20 times as long as it is wide, for about so many freedoms."""
    across = 2
    while _freedoms((20 * (across + 1) // 2, across + 1, across + 1), cell) < freedoms:
        across += 1
    along = 1
    while _freedoms((along, across, across), cell) < freedoms:
        along += 1
    return along, across, across


def _freedoms(cells: tuple[int, int, int], cell: str) -> int:
    a, b, c = cells
    corners = (a + 1) * (b + 1) * (c + 1)
    if cell == "hex8":
        return 3 * corners
    if cell == "hex20":
        edges = a * (b + 1) * (c + 1) + (a + 1) * b * (c + 1) + (a + 1) * (b + 1) * c
        return 3 * (corners + edges)
    return 3 * (2 * a + 1) * (2 * b + 1) * (2 * c + 1)  # tet10


def hinged_bars(cells: tuple[int, int, int], cell: str, count: int = 1) -> Model:
    """Steel bars 1 m × 50 mm × 50 mm side by side, each hinged at one end about y, at rest along x, gravity along −z."""
    bodies, joints = {}, {}
    for k in range(count):
        bodies[f"bar{k}"] = ElasticBody(
            BoxMesh((1.0, 0.05, 0.05), cells, cell),
            STEEL,
            Pose((0.0, 0.1 * k, 0.0)),
            attachments={
                "hinge": Attachment(nodes=NamedSet("x_min"), coupling="rigid"),
                "tip": Attachment(nodes=NamedSet("x_max"), coupling="average"),
            },
        )
        joints[f"hinge{k}"] = Joint("revolute", End("ground"), End(f"bar{k}", "hinge"), axis=Y)
    return Model(bodies, joints, gravity=(0.0, 0.0, -9.81), simulation=Simulation(1.0, BAR_STEP))


def slider_crank(cells: tuple[int, int, int], cell: str, reduction: CraigBampton | None = None) -> Model:
    """A rigid crank of 75 mm at 3000 rpm, an elastic rod of 300 mm × 15 mm × 15 mm, a rigid piston; in the x-z plane."""
    rod = ElasticBody(
        BoxMesh((0.3, 0.015, 0.015), cells, cell),
        DAMPED,
        Pose((0.075, -0.0075, -0.0075)),
        attachments={
            "big": Attachment(nodes=NamedSet("x_min"), coupling="rigid"),
            "small": Attachment(nodes=NamedSet("x_max"), coupling="rigid"),
        },
        reduction=reduction,
    )
    crank = RigidBody(
        1.2,
        (0.02, 0.0, 0.0),
        ((1e-3, 0.0, 0.0), (0.0, 2e-3, 0.0), (0.0, 0.0, 2e-3)),
        attachments={"pin": Attachment(at=(0.075, 0.0, 0.0))},
    )
    piston = RigidBody(
        0.8, inertia=((4e-4, 0.0, 0.0), (0.0, 4e-4, 0.0), (0.0, 0.0, 4e-4)), pose=Pose((0.375, 0.0, 0.0))
    )
    joints = {
        "bearing": Joint("revolute", End("ground"), End("crank"), at=(0.0, 0.0, 0.0), axis=Y),
        "crankpin": Joint("revolute", End("crank", "pin"), End("rod", "big"), axis=Y),
        "wristpin": Joint("revolute", End("rod", "small"), End("piston"), axis=Y),
        "cylinder": Joint("prismatic", End("ground"), End("piston"), at=(0.375, 0.0, 0.0), axis=(1.0, 0.0, 0.0)),
        "motor": Driver("bearing", "angle", expression("100*pi*t")),
    }
    return Model(
        {"crank": crank, "rod": rod, "piston": piston},
        joints,
        gravity=(0.0, 0.0, -9.81),
        simulation=Simulation(0.06, CRANK_STEP),
    )
