"""Springs and dampers in Newton's iteration: stiff ones would make it diverge where β h² k/m exceeds one.

With k' = βh²k + γhd, one on a single free motion of the tree adds k' to that motion's pivot. Every other is a row J of
elongation rates behind the liaisons' rows, so that rank and liaison forces know nothing of springs:

    [ Λ    B           ] [φ]   [A x + (A v̇ + γ)/σ]        Λ = A W Aᵀ,  B = A W Jᵀ
    [ Bᵀ   JWJᵀ + 1/k' ] [ψ] = [J x              ]        δ = x − W(Aᵀφ + Jᵀψ)
"""

from __future__ import annotations

import math

from maggi.bodies.attachment_kernels import generalised_force
from maggi.bodies.tables import Array
from maggi.forces.kernels import applied_forces
from maggi.forces.tables import ForceTable
from maggi.integrators.generalized_alpha import GeneralizedAlpha
from maggi.linalg.compiling import inner_kernel
from maggi.linalg.links import Link
from maggi.projection.closures import add_closure_force, closure_rates
from maggi.projection.tree_tables import Tree

from .prediction import coefficients
from .tables import SmallSystem, StepState, StepWork


@Link
def loads(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Forces of springs, dampers and loads, to `loads`."""
    applied_forces(
        small.forces,
        small.step_bodies,
        small.closures,
        state.motion,
        state.attachments,
        state.rows,
        t,
        work.loads,
        state.power,
    )


@inner_kernel
def spring_constants(forces: ForceTable, tree: Tree, s: int) -> tuple[float, float]:
    """Stiffness and damping of the spring that is row s behind the liaisons' rows."""
    data = forces.spring_data if tree.spring[s, 0] == 0 else forces.torsion_data
    x = tree.spring[s, 1]
    return data[x, 0], data[x, 1]


@inner_kernel
def joint_stiffness(small: SmallSystem, c: GeneralizedAlpha, out: Array) -> None:
    """k' of springs on single free motions of the tree's joints, out (m,)."""
    tree, data = small.tree, small.forces.torsion_data
    for i in range(out.shape[0]):
        out[i] = 0.0
    for z in range(tree.on_joint.shape[0]):
        s = tree.on_joint[z, 0]
        out[tree.on_joint[z, 1]] += c.beta * c.h * c.h * data[s, 0] + c.gamma * c.h * data[s, 1]


@Link
def spring_coefficients(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Rows J of springs, then torsion springs, on the bodies: the rates of their lengths or angles are J v.

    Those on single free motions add to `stiffness`.
    """
    joint_stiffness(small, coefficients(work), work.stiffness)
    tree, bodies, motion, attachments = small.tree, small.step_bodies, state.motion, state.attachments
    A, position = state.rows.A, attachments.position
    for s in range(tree.spring.shape[0]):
        torsion = tree.spring[s, 0] == 1
        n0 = n1 = n2 = 0.0
        coordinate = 0
        if torsion:
            coordinate = small.forces.torsion_coordinate[tree.spring[s, 1]]
        else:
            p, q = tree.spring_end[2 * s, 0], tree.spring_end[2 * s + 1, 0]
            n0, n1, n2 = (
                position[q, 0] - position[p, 0],
                position[q, 1] - position[p, 1],
                position[q, 2] - position[p, 2],
            )
            length = math.sqrt(n0 * n0 + n1 * n1 + n2 * n2)
            one = 1.0 / length if length > 0.0 else 0.0
            n0, n1, n2 = n0 * one, n1 * one, n2 * one
        for side in range(2):
            a, start = tree.spring_end[2 * s + side, 0], tree.spring_end[2 * s + side, 1]
            b = bodies.attachment_body[a]
            width = bodies.offset[b + 1] - bodies.offset[b]
            part = A[start : start + width]
            for i in range(width):
                part[i] = 0.0
            if torsion:
                w = state.rows.coordinate_wrench[coordinate, side]
                generalised_force(bodies, motion, attachments, a, w[0], w[1], w[2], w[3], w[4], w[5], part)
            else:
                sign = -1.0 if side == 0 else 1.0
                generalised_force(bodies, motion, attachments, a, sign * n0, sign * n1, sign * n2, 0.0, 0.0, 0.0, part)


@Link
def add_springs(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Add 1/k' to the springs' diagonal of Λ; those with k' = 0 are taken out."""
    c, tree, L = coefficients(work), small.tree, work.L
    first, start = tree.skyline_first, tree.skyline_start
    r = work.pi.shape[0]
    for s in range(tree.spring.shape[0]):
        q = r + s
        k, d = spring_constants(small.forces, tree, s)
        stiffness = c.beta * c.h * c.h * k + c.gamma * c.h * d
        if stiffness > 0.0:
            L[start[q] + q - first[q]] += 1.0 / stiffness
            continue
        for j in range(start[q], start[q + 1]):
            L[j] = 0.0
        for i in range(q + 1, first.shape[0]):
            if first[i] <= q:
                L[start[i] + q - first[i]] = 0.0
        L[start[q] + q - first[q]] = math.inf  # a pivot of zero: the row is left out


@Link
def spring_forces(small: SmallSystem, state: StepState, work: StepWork, t: float) -> None:
    """Forces Jᵀ(k J Δq + d J Δv) that shifts of positions and velocities cause, to `force`; on joints to `on_joints`."""
    tree, rates, columns = small.tree, work.rates, work.tree.columns
    r = work.pi.shape[0]
    count = tree.spring.shape[0]
    closure_rates(tree, columns, work.shift, r, rates)
    for s in range(count):
        k, _ = spring_constants(small.forces, tree, s)
        add_closure_force(tree, columns, r + s, k * rates[r + s], work.force)
    closure_rates(tree, columns, work.rate_shift, r, rates)
    for s in range(count):
        _, d = spring_constants(small.forces, tree, s)
        add_closure_force(tree, columns, r + s, d * rates[r + s], work.force)


@inner_kernel
def joint_spring_forces(small: SmallSystem, work: StepWork) -> None:
    """Forces on single free motions that their shifts cause in springs there, to `on_joints`."""
    tree, data = small.tree, small.forces.torsion_data
    for z in range(tree.on_joint.shape[0]):
        s, d = tree.on_joint[z, 0], tree.on_joint[z, 1]
        work.on_joints[d] += data[s, 0] * work.shift[d] + data[s, 1] * work.rate_shift[d]
