"""Closures in range-space form, compiled: Λ = A Ŝ⁻¹ Aᵀ over the tree's factor and the blocks' compliances.

The second stage of the double velocity transformation: with the tree's joints removed, what is left of a closure on the
free motions is its column L⁻¹SᵀAᵀ, nonzero between the bodies that it joins and the ground, and Λ is a sum over nodes,
diagonal D⁻¹ on those of the tree, W on blocks. Vectors `g` hold L⁻¹ of forces on the tree's motions and forces on blocks.
"""

from __future__ import annotations

from maggi.bodies.tables import MESH, Array, BodyTable, IntArray
from maggi.linalg.compiling import kernel
from maggi.linalg.small import inner, multiply

from .tree_tables import Tree, TreeWork


@kernel
def closure_compliance(
    tree: Tree, bodies: BodyTable, W: Array, work: TreeWork, kept: IntArray, product: Array, out: Array
) -> None:
    """Λ into skyline storage: row i holds columns skyline_first[i] … i; rows that are not kept stay zero. product (m,): scratch."""
    columns, inverse, incidence, begin = work.columns, work.inverse, tree.incidence, tree.incidence_start
    first, start, node_start = tree.skyline_first, tree.skyline_start, tree.node_start
    count = tree.parent.shape[0]
    for i in range(out.shape[0]):
        out[i] = 0.0
    for node in range(begin.shape[0] - 1):
        if begin[node] == begin[node + 1]:
            continue
        s = node_start[node]
        k = node_start[node + 1] - s
        if k == 1 and node < count:
            for x in range(begin[node], begin[node + 1]):
                value = columns[incidence[x, 1]] * inverse[s]
                if value == 0.0 or kept[incidence[x, 0]] == 0:
                    continue
                o = start[incidence[x, 0]] - first[incidence[x, 0]]
                for y in range(begin[node], x + 1):
                    out[o + incidence[y, 0]] += value * columns[incidence[y, 1]]
            continue
        for x in range(begin[node], begin[node + 1]):
            i = incidence[x, 0]
            if kept[i] == 0:
                continue
            p = incidence[x, 1]
            o = start[i] - first[i]
            if node < count:
                for c in range(k):
                    product[c] = columns[p + c] * inverse[s + c]
            else:
                b = tree.block[node - count]
                block = W[bodies.block[b] : bodies.block[b + 1]].reshape(k, k)
                multiply(block, columns[p : p + k], product[:k])
            for y in range(begin[node], x + 1):
                r = incidence[y, 1]
                out[o + incidence[y, 0]] += inner(product[:k], columns[r : r + k])


@kernel
def apply_compliance(tree: Tree, bodies: BodyTable, W: Array, work: TreeWork, g: Array, out: Array) -> None:
    """out (m,): D⁻¹ g on the tree's motions, W g on blocks."""
    inverse, node_start = work.inverse, tree.node_start
    count = tree.parent.shape[0]
    for d in range(inverse.shape[0]):
        out[d] = inverse[d] * g[d]
    for k in range(tree.block.shape[0]):
        b = tree.block[k]
        s, e = node_start[count + k], node_start[count + k + 1]
        multiply(W[bodies.block[b] : bodies.block[b + 1]].reshape(e - s, e - s), g[s:e], out[s:e])


@kernel
def apply_mesh_compliance(tree: Tree, bodies: BodyTable, W: Array, g: Array, out: Array) -> None:
    """Subtract W g from out (m,) on blocks of meshed bodies, for W_Z and W_D, which others do not have."""
    count = tree.parent.shape[0]
    for k in range(tree.block.shape[0]):
        b = tree.block[k]
        if bodies.kind[b] != MESH:
            continue
        s, e = tree.node_start[count + k], tree.node_start[count + k + 1]
        block = W[bodies.block[b] : bodies.block[b + 1]].reshape(e - s, e - s)
        for i in range(e - s):
            out[s + i] -= inner(block[i], g[s:e])


@kernel
def add_closure_force(tree: Tree, columns: Array, q: int, value: float, out: Array) -> None:
    """Add to out (m,) the force of closure q, `value` times L⁻¹SᵀAᵀ."""
    velocity = tree.column_velocity
    for c in range(tree.column_start[q], tree.column_start[q + 1]):
        out[velocity[c]] += columns[c] * value


@kernel
def add_closure_forces(tree: Tree, columns: Array, x: Array, sign: float, out: Array) -> None:
    """Add to out (m,) the forces ± L⁻¹SᵀAᵀ x of the first closures, as many as x has."""
    for q in range(x.shape[0]):
        if x[q] != 0.0:
            add_closure_force(tree, columns, q, sign * x[q], out)


@kernel
def closure_rates(tree: Tree, columns: Array, z: Array, first: int, out: Array) -> None:
    """out (r,): A L⁻ᵀ z of motions z (m,) as `apply_compliance` leaves them, of closures from the first on."""
    velocity, start = tree.column_velocity, tree.column_start
    for q in range(first, out.shape[0]):
        value = 0.0
        for c in range(start[q], start[q + 1]):
            value += columns[c] * z[velocity[c]]
        out[q] = value


@kernel
def closure_scale(
    tree: Tree, bodies: BodyTable, A: Array, free: Array, sigma: float, W: Array, product: Array, scale: Array
) -> None:
    """Raise scale (r,) to A Ŝ⁻¹ Aᵀ of each row on its ends, each taken alone as if nothing were joined.

    This is what a row's pivot is compared with: at a singular position its diagonal in Λ vanishes too. free (x, 6, 6): σ
    times Ŝ⁻¹ of tree bodies, W (flat blocks): that of blocks. product (m,): scratch.
    """
    count = tree.parent.shape[0]
    for q in range(scale.shape[0]):
        value = 0.0
        for e in range(tree.end_start[q], tree.end_start[q + 1]):
            start, place = tree.end[e, 0], tree.end[e, 1]
            if place < 0:
                continue
            node = tree.path[place, 0]
            if node >= count:
                b = tree.block[node - count]
                k = tree.node_start[node + 1] - tree.node_start[node]
                block = W[bodies.block[b] : bodies.block[b + 1]].reshape(k, k)
                multiply(block, A[start : start + k], product[:k])
                value += inner(product[:k], A[start : start + k])
            else:
                for i in range(6):
                    value += A[start + i] * inner(free[node, i], A[start : start + 6]) / sigma
        scale[q] = max(scale[q], value)
