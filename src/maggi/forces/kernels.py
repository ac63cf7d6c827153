"""Compiled applied forces: springs, dampers, point loads, in the bodies' small coordinates."""

from __future__ import annotations

import math

from maggi.bodies.attachment_kernels import generalised_force
from maggi.bodies.tables import Array, AttachmentState, BodyTable, MotionState
from maggi.liaisons.tables import COORDINATE_JOINT, LiaisonState, LiaisonTable
from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.jets import evaluate

from .tables import ForceTable


@inner_kernel
def _apply(
    bodies: BodyTable, state: MotionState, attachments: AttachmentState, a: int, f: Array, m: Array, Q: Array
) -> None:
    b = bodies.attachment_body[a]
    generalised_force(
        bodies,
        state,
        attachments,
        a,
        f[0],
        f[1],
        f[2],
        m[0],
        m[1],
        m[2],
        Q[bodies.offset[b] : bodies.offset[b + 1]],
    )


@kernel
def applied_forces(
    table: ForceTable,
    bodies: BodyTable,
    liaisons: LiaisonTable,
    state: MotionState,
    attachments: AttachmentState,
    rows: LiaisonState,
    t: float,
    Q: Array,
    power: Array,
) -> None:
    """Set Q (n,) to the generalised applied forces (gravity excepted: it is an acceleration of the frames).

    power (3,): the energy stored in springs (J), the power that dampers dissipate (W), the power of loads (W).
    """
    for i in range(Q.shape[0]):
        Q[i] = 0.0
    f, m, jet, value = rows.scratch[0], rows.scratch[1], rows.scratch[2], rows.scratch[3]
    for i in range(3):
        power[i] = 0.0
        m[i] = 0.0
    for s in range(table.spring_ends.shape[0]):
        p, q = table.spring_ends[s, 0], table.spring_ends[s, 1]
        length = 0.0
        rate = 0.0
        for i in range(3):
            f[i] = attachments.position[q, i] - attachments.position[p, i]
            length += f[i] * f[i]
            rate += f[i] * (attachments.velocity[q, i] - attachments.velocity[p, i])
        length = math.sqrt(length)
        if length > 0.0:
            rate /= length
            tension = table.spring_data[s, 0] * (length - table.spring_data[s, 2]) + table.spring_data[s, 1] * rate
            for i in range(3):
                f[i] *= tension / length
            _apply(bodies, state, attachments, p, f, m, Q)
            for i in range(3):
                f[i] = -f[i]
            _apply(bodies, state, attachments, q, f, m, Q)
        power[0] += 0.5 * table.spring_data[s, 0] * (length - table.spring_data[s, 2]) ** 2
        power[1] += table.spring_data[s, 1] * rate * rate
    for s in range(table.torsion_coordinate.shape[0]):
        c = table.torsion_coordinate[s]
        j = liaisons.coordinate[c, COORDINATE_JOINT]
        angle = rows.coordinate[c, 0] - table.torsion_data[s, 2]
        rate = rows.coordinate[c, 1]
        torque = table.torsion_data[s, 0] * angle + table.torsion_data[s, 1] * rate
        for side in range(2):
            for i in range(3):
                f[i] = -torque * rows.coordinate_wrench[c, side, i]
                m[i] = -torque * rows.coordinate_wrench[c, side, 3 + i]
            _apply(bodies, state, attachments, liaisons.joint[j, side], f, m, Q)
        power[0] += 0.5 * table.torsion_data[s, 0] * angle * angle
        power[1] += table.torsion_data[s, 1] * rate * rate
    for s in range(table.load_attachment.shape[0]):
        a = table.load_attachment[s]
        for i in range(3):
            o, e = table.function_start[3 * s + i], table.function_start[3 * s + i + 1]
            evaluate(table.function_codes[o:e], table.function_values[o:e], t, jet)
            value[i] = jet[0]
        for i in range(3):
            f[i] = 0.0
            m[i] = 0.0
        torque = table.load_kind[s, 0] == 1
        for i in range(3):
            x = value[i]
            if table.load_kind[s, 1] == 1:
                x = 0.0
                for l in range(3):
                    x += attachments.rotation[a, i, l] * value[l]
            if torque:
                m[i] = x
                power[2] += x * attachments.angular_velocity[a, i]
            else:
                f[i] = x
                power[2] += x * attachments.velocity[a, i]
        _apply(bodies, state, attachments, a, f, m, Q)
