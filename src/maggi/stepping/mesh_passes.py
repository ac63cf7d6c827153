"""The passes of meshed bodies, compiled before there is a body: they depend on none."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from maggi.bodies.freedoms import Freedoms
from maggi.bodies.isotropic_inertia import IsotropicInertia
from maggi.bodies.mean_axes import MeanAxes, RigidColumns
from maggi.elements.products import SymmetricBlocks
from maggi.linalg.lanes import WIDTH
from maggi.linalg.shared import crew

from .mesh_kernels import correct, respond, write_attachments
from .nodal_kernels import Columns, NodalStep, correct_nodal, predict_nodal


def compile_passes(*, solids: bool) -> None:
    """Go once through the passes of a step, for two nodes of which an attachment makes one rigid.

    solids : the inertia of solids too; that of beams is compiled for the body.
    """
    nodes = np.zeros((2, 3))
    freedoms = Freedoms.of(nodes, [(np.array([1]), np.zeros(3))])
    n = freedoms.size
    x, out = np.zeros(n), np.zeros(n)
    if solids:
        inertia = IsotropicInertia(nodes, sp.csr_matrix(np.eye(2)), freedoms)
        inertia.forces(x, x, x, out).residual(np.zeros((3, 3)), np.zeros(6))
    diagonal = sp.bsr_matrix((np.zeros((n // 3, 3, 3)), np.arange(n // 3), np.arange(n // 3 + 1)))
    K = SymmetricBlocks.of(diagonal)
    K.add_product(x, out)
    K.squares(np.zeros((n // 3, 3, WIDTH))).find()
    groups = -(-n // WIDTH)
    step = NodalStep(
        linear=np.zeros(1),
        prediction=np.zeros((3, 4)),
        gain=np.zeros(4),
        now=np.zeros((4, groups * WIDTH)),
        following=np.zeros((4, groups * WIDTH)),
        solution=np.zeros(groups * WIDTH),
        implied=np.zeros(2),
        columns=Columns.of(sp.csc_matrix((n, 6))),
        responses=np.zeros((1, groups, 12, WIDTH)),
        damping=np.zeros(2),
        forces=np.zeros((4, 6)),
        loaded=np.zeros(1, np.int64),
        sizes=np.zeros((1, 2)),
    )
    predict_nodal(step, 1)
    columns = RigidColumns(np.zeros(0), np.zeros((0, 3)), np.zeros((n // 3, 3, 6)))
    six = np.zeros(6)
    respond(step, MeanAxes(columns, columns, np.zeros((6, 6))), 1, six)
    correct(step, correct_nodal.entry(step), crew(), six, six, six)
    write_attachments(step, six, six, six, six, six)
