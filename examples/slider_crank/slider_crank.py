"""The model of ``slider_crank.yml`` through the Python interface.

python slider_crank.py
"""

from pathlib import Path

import numpy as np

import maggi
from maggi import Attachment, ElasticBody, End, FileMesh, Joint, NamedSet, Pose, RigidBody

Y = (0.0, 1.0, 0.0)
STEEL = maggi.Material(density=7850.0, young=210e9, poisson=0.3, damping=maggi.Damping(stiffness=1e-6))


def model(duration: float = 0.06) -> maggi.Model:
    """The slider-crank at 3000 rpm."""
    crank = RigidBody(
        mass=1.2,
        center_of_mass=(0.02, 0.0, 0.0),
        inertia=((1e-3, 0.0, 0.0), (0.0, 2e-3, 0.0), (0.0, 0.0, 2e-3)),
        attachments={"pin": Attachment(at=(0.075, 0.0, 0.0))},
    )
    rod = ElasticBody(
        mesh=FileMesh("rod.msh"),
        material=STEEL,
        pose=Pose(origin=(0.075, 0.0, 0.0)),
        attachments={name: Attachment(nodes=NamedSet(name)) for name in ("big_end", "small_end")},
    )
    piston = RigidBody(
        mass=0.8,
        inertia=((4e-4, 0.0, 0.0), (0.0, 4e-4, 0.0), (0.0, 0.0, 4e-4)),
        pose=Pose(origin=(0.375, 0.0, 0.0)),
        attachments={"pin": Attachment(at=(0.0, 0.0, 0.0))},
    )
    return maggi.Model(
        title="Slider-crank with an elastic connecting rod",
        gravity=(0.0, 0.0, -9.81),
        bodies={"crank": crank, "rod": rod, "piston": piston},
        joints={
            "bearing": Joint("revolute", End("ground"), End("crank"), at=(0.0, 0.0, 0.0), axis=Y),
            "crankpin": Joint("revolute", End("crank", "pin"), End("rod", "big_end"), axis=Y),
            "wristpin": Joint("revolute", End("rod", "small_end"), End("piston", "pin"), axis=Y),
            "cylinder": Joint("prismatic", End("ground"), End("piston"), at=(0.375, 0.0, 0.0), axis=(1.0, 0.0, 0.0)),
            "motor": maggi.Driver("bearing", "angle", maggi.expression("speed*t", speed="3000 rpm")),
        },
        outputs=maggi.Outputs(every=10),
        simulation=maggi.Simulation(duration=duration, step=4e-5),
        folder=str(Path(__file__).parent),
    )


if __name__ == "__main__":
    results = maggi.run(model())
    force = np.linalg.norm(results.joint("wristpin").force, axis=1)
    print(f"largest wrist-pin force {force.max():.1f} N at t = {results.time[force.argmax()]:.4f} s")
