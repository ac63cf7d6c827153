"""Chains of rigid links on revolute joints: the compiled step's time, and how it grows with the number of links."""

from __future__ import annotations

import argparse
import time

import numpy as np

from maggi.analyses.transient import prepare
from maggi.model.bodies import RigidBody
from maggi.model.geometry import Pose
from maggi.model.joints import End, Joint
from maggi.model.model import Model
from maggi.model.simulation import Simulation

STEP = 1e-3
LENGTH = 0.1


def chain(links: int) -> Model:
    """An open chain along x, 0.1 m and 1 kg a link, hinged about y, released from rest under gravity."""
    inertia = LENGTH**2 / 12.0
    bodies = {
        f"link{i}": RigidBody(
            1.0,
            (LENGTH / 2.0, 0.0, 0.0),
            ((inertia / 10.0, 0.0, 0.0), (0.0, inertia, 0.0), (0.0, 0.0, inertia)),
            pose=Pose((i * LENGTH, 0.0, 0.0)),
        )
        for i in range(links)
    }
    joints = {
        f"joint{i}": Joint(
            "revolute",
            End("ground") if i == 0 else End(f"link{i - 1}"),
            End(f"link{i}"),
            at=(i * LENGTH, 0.0, 0.0),
            axis=(0.0, 1.0, 0.0),
        )
        for i in range(links)
    }
    return Model(bodies=bodies, joints=joints, gravity=(0.0, 0.0, -9.81), simulation=Simulation(1.0, STEP))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--links", type=int, nargs="+", default=(1, 10, 50))
    parser.add_argument("--chunks", type=int, default=7)
    arguments = parser.parse_args()
    print(f"rigid chains, revolute joints in 3-D, h = {STEP:g} s (medians; process time)")
    print("  links    µs a step   µs a link and step   iterations")
    for links in arguments.links:
        stepper, _, _, _ = prepare(chain(links))
        stepper.set_step(STEP)
        steps = max(10, 1000 // links)
        spent, done = [], 0
        stepper.advance(0.0, steps)
        before = stepper.counts.corrections
        for _ in range(arguments.chunks):
            done += steps
            began = time.process_time()
            stepper.advance(done * STEP, steps)
            spent.append(1e6 * (time.process_time() - began) / steps)
        iterations = (stepper.counts.corrections - before) / (arguments.chunks * steps)
        median = float(np.median(spent))
        print(f"  {links:5d}   {median:10.1f}   {median / links:18.2f}   {iterations:10.1f}")


if __name__ == "__main__":
    main()
