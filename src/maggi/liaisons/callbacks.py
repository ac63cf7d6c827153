"""Rows from a Python function, called from compiled code through its address.

The compiled rows pass poses and velocities of the ends; the function's A and b come back with their rates along the
motion, taken by central differences of fourth order. An exception in the function is kept and fills the rows with
NaN: the step then fails and the message is that of the exception.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

from maggi.bodies.tables import AttachmentState
from maggi.linalg.rotations import rotation_matrix

from .tables import ROW_FIRST, ROW_SECOND, LiaisonState, LiaisonTable

Array = NDArray[np.float64]
Pointer = ctypes.POINTER(ctypes.c_double)
STATE = 18  # numbers passed for each end: position, rotation, velocity, angular velocity
_DIFFERENCE = 1e-3  # of the time in which the motion changes noticeably


class RowFunction:
    """A Python function of poses that gives A and b, with an address that compiled code can call."""

    def __init__(
        self, name: str, rows: int, ends: int, function: Callable[[float, Array, Array], tuple[Array, Array]]
    ) -> None:
        self.name = name
        self.rows = rows
        self.ends = ends
        self.error: Exception | None = None
        self._function = function
        self._pointer = ctypes.CFUNCTYPE(None, ctypes.c_double, Pointer, Pointer)(self._call)

    @property
    def address(self) -> int:
        """Where compiled code calls it."""
        return int(ctypes.cast(self._pointer, ctypes.c_void_p).value or 0)

    def rows_at(self, t: float, position: Array, rotation: Array) -> tuple[Array, Array]:
        """A (rows, ends, 6) and b (rows,). Raises ValueError where the function gives other shapes."""
        A, b = self._function(t, position, rotation)
        A, b = np.asarray(A, dtype=np.float64), np.asarray(b, dtype=np.float64)
        if A.shape != (self.rows, self.ends, 6) or b.shape != (self.rows,):
            raise ValueError(
                f"the function of {self.name!r} gave A {A.shape} and b {b.shape}, "
                f"expected ({self.rows}, {self.ends}, 6) and ({self.rows},)"
            )
        return A, b

    def _call(self, t: float, state: Any, out: Any) -> None:
        result = np.ctypeslib.as_array(out, (2, self.rows, 6 * self.ends + 1))
        try:
            given = np.ctypeslib.as_array(state, (self.ends, STATE)).copy()
            self._fill(t, given, result)
        except Exception as error:  # whatever the user's function raises must not pass through compiled code
            self.error = self.error or error
            result[:] = np.nan

    def _fill(self, t: float, state: Array, out: Array) -> None:
        position, rotation = state[:, :3], state[:, 3:12].reshape(-1, 3, 3)
        velocity, omega = state[:, 12:15], state[:, 15:]

        def values(dt: float) -> Array:
            turned = np.array([rotation_matrix(w * dt) @ R for w, R in zip(omega, rotation, strict=True)])
            A, b = self.rows_at(t + dt, position + dt * velocity, turned)
            return np.concatenate([A.reshape(self.rows, -1), b[:, None]], axis=1)

        out[0] = values(0.0)
        h = _DIFFERENCE / (1.0 + float(np.abs(omega).max()) + float(np.abs(velocity).max()))
        out[1] = (8.0 * (values(h) - values(-h)) - (values(2 * h) - values(-2 * h))) / (12.0 * h)


def _calling(typing_context: Any, address: Any, t: Any, state: Any, out: Any) -> Any:
    """Call ``void f(double, double*, double*)`` at an address with the data of two arrays."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        double, pointer = ir.DoubleType(), ir.DoubleType().as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [double, pointer, pointer])
        data = [
            context.make_array(array)(context, builder, value).data
            for array, value in zip(signature.args[2:], arguments[2:], strict=True)
        ]
        builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), [arguments[1], *data])
        return context.get_dummy_value()

    return types.void(types.int64, types.float64, state, out), generate


_call_address: Any = intrinsic(_calling)


@njit(cache=True)
def callback_row(table: LiaisonTable, attachments: AttachmentState, i: int, t: float, out: LiaisonState) -> None:
    """Rows of a Python function, all of them where row i is the first.

    `integers` from ROW_FIRST on: the address and the number of rows, which follow each other in the table.
    """
    if table.row[i, ROW_SECOND] > 0:
        return
    o = table.row[i, ROW_FIRST]
    rows = table.integers[o + 1]
    start = table.end_start[i]
    ends = table.end_start[i + 1] - start
    state = np.empty((ends, STATE))
    result = np.empty((2, rows, 6 * ends + 1))
    for k in range(ends):
        a = table.end[start + k, 0]
        for l in range(3):
            state[k, l] = attachments.position[a, l]
            state[k, 12 + l] = attachments.velocity[a, l]
            state[k, 15 + l] = attachments.angular_velocity[a, l]
            for c in range(3):
                state[k, 3 + 3 * l + c] = attachments.rotation[a, l, c]
    _call_address(table.integers[o], t, state, result)
    for r in range(rows):
        value = result[0, r, 6 * ends]
        rate = result[1, r, 6 * ends]
        out.rhs[i + r] = value
        for k in range(ends):
            e = table.end_start[i + r] + k
            a = table.end[e, 0]
            for l in range(6):
                x = result[0, r, 6 * k + l]
                out.wrench[e, l] = x
                if l < 3:
                    u, ud = attachments.velocity[a, l], attachments.acceleration[a, l]
                else:
                    u, ud = attachments.angular_velocity[a, l - 3], attachments.angular_acceleration[a, l - 3]
                value += x * u
                rate += result[1, r, 6 * k + l] * u + x * ud
        out.position[i + r] = 0.0
        out.velocity[i + r] = value
        out.acceleration[i + r] = rate
