"""Compiled rows that are sums: relations of joint coordinates or of their rates, and pfaffian rows."""

from __future__ import annotations

from maggi.bodies.tables import AttachmentState
from maggi.linalg.compiling import inner_kernel, kernel
from maggi.linalg.jets import evaluate_jet

from .tables import JETS, RELATION, ROW_FIRST, ROW_KIND, ROW_SECOND, LiaisonState, LiaisonTable

POSE = 12  # variables of one end: x, y, z, r11, r12, …, r33


@inner_kernel
def relation_row(table: LiaisonTable, i: int, t: float, out: LiaisonState) -> None:
    """g(t, q₁ … q_n) = 0 of joint coordinates, or g(t, q̇₁ … q̇_n) = 0, linear in the rates.

    `integers` from ROW_FIRST on: the function, then the coordinates. The row's ends are theirs, first and second of each.
    """
    o = table.row[i, ROW_FIRST]
    n = table.row[i, ROW_SECOND]
    f = table.integers[o]
    a, b = table.function_start[f], table.function_start[f + 1]
    codes, values = table.function_codes[a:b], table.function_values[a:b]
    level = 0 if table.row[i, ROW_KIND] == RELATION else 1
    jets, jet = out.scratch[JETS : JETS + n + 1], out.scratch[0]
    for k in range(n + 1):
        for l in range(3):
            jets[k, l] = 0.0
    jets[0, 0] = t
    for k in range(n):
        jets[k + 1, 0] = out.coordinate[table.integers[o + 1 + k], level]
    for k in range(n):
        jets[k + 1, 1] = 1.0
        evaluate_jet(codes, values, jets, jet)
        jets[k + 1, 1] = 0.0
        wrench = out.coordinate_wrench[table.integers[o + 1 + k]]
        for side in range(2):
            for l in range(6):
                out.wrench[table.end_start[i] + 2 * k + side, l] = jet[1] * wrench[side, l]
    jets[0, 1] = 1.0
    if level == 0:
        evaluate_jet(codes, values, jets, jet)
        out.rhs[i] = jet[1]
        for k in range(n):
            c = table.integers[o + 1 + k]
            jets[k + 1, 1] = out.coordinate[c, 1]
            jets[k + 1, 2] = out.coordinate[c, 2]
        evaluate_jet(codes, values, jets, jet)
        out.position[i] = jet[0]
        out.velocity[i] = jet[1]
        out.acceleration[i] = jet[2]
    else:
        for k in range(n):
            jets[k + 1, 1] = out.coordinate[table.integers[o + 1 + k], 2]
        evaluate_jet(codes, values, jets, jet)
        out.position[i] = 0.0
        out.velocity[i] = jet[0]
        out.acceleration[i] = jet[1]
        for k in range(n):
            jets[k + 1, 0] = 0.0
        evaluate_jet(codes, values, jets, jet)
        out.rhs[i] = jet[0]


@kernel
def pfaffian_row(table: LiaisonTable, attachments: AttachmentState, i: int, t: float, out: LiaisonState) -> None:
    """Σ a_k(t, poses) u_k + b(t, poses) = 0 on velocity components u_k of the row's ends.

    `integers` from ROW_FIRST on: the function b (or −1), then for each of ROW_SECOND terms the end, the component and the
    function. Variables: t, then POSE of each end.
    """
    o = table.row[i, ROW_FIRST]
    start = table.end_start[i]
    ends = table.end_start[i + 1] - start
    jets, jet = out.scratch[JETS : JETS + 1 + POSE * ends], out.scratch[0]
    for k in range(1 + POSE * ends):
        for l in range(3):
            jets[k, l] = 0.0
    jets[0, 0] = t
    jets[0, 1] = 1.0
    for k in range(ends):
        a = table.end[start + k, 0]
        w = attachments.angular_velocity[a]
        R = attachments.rotation[a]
        for l in range(3):
            jets[1 + POSE * k + l, 0] = attachments.position[a, l]
            jets[1 + POSE * k + l, 1] = attachments.velocity[a, l]
            m, n = (l + 1) % 3, (l + 2) % 3
            for c in range(3):
                jets[1 + POSE * k + 3 + 3 * l + c, 0] = R[l, c]
                jets[1 + POSE * k + 3 + 3 * l + c, 1] = w[m] * R[n, c] - w[n] * R[m, c]
        for l in range(6):
            out.wrench[start + k, l] = 0.0
    value = 0.0
    rate = 0.0
    out.rhs[i] = 0.0
    f = table.integers[o]
    if f >= 0:
        a, b = table.function_start[f], table.function_start[f + 1]
        evaluate_jet(table.function_codes[a:b], table.function_values[a:b], jets, jet)
        out.rhs[i] = jet[0]
        value = jet[0]
        rate = jet[1]
    for k in range(table.row[i, ROW_SECOND]):
        end = table.integers[o + 1 + 3 * k]
        component = table.integers[o + 2 + 3 * k]
        f = table.integers[o + 3 + 3 * k]
        a, b = table.function_start[f], table.function_start[f + 1]
        evaluate_jet(table.function_codes[a:b], table.function_values[a:b], jets, jet)
        out.wrench[start + end, component] += jet[0]
        attachment = table.end[start + end, 0]
        if component < 3:
            u = attachments.velocity[attachment, component]
            ud = attachments.acceleration[attachment, component]
        else:
            u = attachments.angular_velocity[attachment, component - 3]
            ud = attachments.angular_acceleration[attachment, component - 3]
        value += jet[0] * u
        rate += jet[1] * u + jet[0] * ud
    out.position[i] = 0.0
    out.velocity[i] = value
    out.acceleration[i] = rate
