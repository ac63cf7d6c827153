"""A hinged bar released from horizontal, full mesh: the time of a step against its limit, and the error of stopping early.

The limit of any implicit step is one forward/back-substitution and one product with K. Both are measured in this
process, between the steps' own chunks, so that the ratio holds on a noisy machine.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass

import numpy as np

from maggi.analyses.transient import prepare
from maggi.elements.products import stiffness_product
from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import ElasticBody
from maggi.model.joints import End, Joint
from maggi.model.materials import Material
from maggi.model.meshes import BoxMesh
from maggi.model.model import Model
from maggi.model.simulation import Simulation

STEP = 1e-3
CHUNK = 20


@dataclass(frozen=True)
class Outcome:
    """What one run showed: tip positions (m) after every chunk, medians in ms, back-substitutions per step."""

    freedoms: int
    tip: np.ndarray
    step: float
    solve: float
    product: float
    substitutions: float

    @property
    def ratio(self) -> float:
        """Time of a step over its back-substitutions times (one solve + one product with K)."""
        return self.step / (self.substitutions * (self.solve + self.product))


def model(cells: tuple[int, int, int], steps: int) -> Model:
    """A steel bar 1 m × 50 mm × 50 mm, hinged at one end about y, at rest along x under gravity along −z."""
    bar = ElasticBody(
        BoxMesh((1.0, 0.05, 0.05), cells, "hex8"),
        Material(7850.0, 2.1e11, 0.3),
        attachments={
            "hinge": Attachment(nodes=NamedSet("x_min"), coupling="rigid"),
            "tip": Attachment(nodes=NamedSet("x_max"), coupling="average"),
        },
    )
    return Model(
        bodies={"bar": bar},
        joints={"hinge": Joint("revolute", End("ground"), End("bar", "hinge"), axis=(0.0, 1.0, 0.0))},
        gravity=(0.0, 0.0, -9.81),
        simulation=Simulation(steps * STEP, STEP),
    )


def simulate(cells: tuple[int, int, int], steps: int, *, exact: bool) -> Outcome:
    """Run, timing chunks of steps and, in between, the solve and the product that bound them."""
    stepper, _, _, _ = prepare(model(cells, steps), exact=exact)
    stepper.set_step(STEP)
    mesh = stepper.meshes[0]
    tip = next(a.index for a in stepper.system.attachment_entries if a.name == "tip")
    vector, out = np.random.default_rng(0).standard_normal(mesh.body.size), np.empty(mesh.body.size)
    path, step, solve, product = [], [], [], []
    counted = stepper.counts.back_substitutions
    for k in range(0, steps, CHUNK):
        began = time.perf_counter()
        if stepper.advance(k * STEP, CHUNK) < CHUNK:
            raise stepper.failure(k * STEP)
        step.append((time.perf_counter() - began) / CHUNK)
        path.append(stepper.state.attachments.position[tip].copy())
        solve.append(_time(lambda: mesh.constants.factor.solve(vector)))
        product.append(_time(lambda: stiffness_product(mesh.body.K, vector, out)))
    return Outcome(
        mesh.body.size,
        np.array(path),
        1e3 * float(np.median(step)),
        1e3 * float(np.median(solve)),
        1e3 * float(np.median(product)),
        (stepper.counts.back_substitutions - counted) / steps,
    )


def _time(action) -> float:  # type: ignore[no-untyped-def]
    began = time.perf_counter()
    action()
    return time.perf_counter() - began


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, nargs=3, default=(120, 12, 12))
    parser.add_argument("--steps", type=int, default=500)
    arguments = parser.parse_args()
    cells = tuple(arguments.cells)
    once = simulate(cells, arguments.steps, exact=False)
    reference = simulate(cells, arguments.steps, exact=True)
    error = float(np.abs(once.tip - reference.tip).max())
    print(f"hinged bar, hex8, {once.freedoms:,} freedoms, h = {STEP:g} s, {arguments.steps} steps (medians)")
    print(f"  back-substitutions per step      {once.substitutions:8.2f}")
    print(f"  step                             {once.step:8.2f} ms")
    print(f"  one solve, one product with K    {once.solve:8.2f} ms, {once.product:.2f} ms")
    print(f"  step / (substitutions × (solve + product)) {once.ratio:.2f}")
    print(f"  same run iterated to round-off   {reference.substitutions:8.2f} back-substitutions per step")
    print(f"  largest difference of the tip    {error:8.1e} m")


if __name__ == "__main__":
    main()
