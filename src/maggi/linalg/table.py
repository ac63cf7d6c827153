"""Named arrays that compiled code receives as one pointer.

numba takes a named tuple of arrays apart into seven machine words an array, at every call and in every kernel that it is
handed on to: most of the compiler's time went into that, and a call from Python cost 10 µs and more. A `Table` is handed
over as the address of its *directory*, where the kernels look an array up when they name it. `table.mass[b]` reads the
same in Python and in a kernel.
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any, Self, TypeVar

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import NativeValue, intrinsic, models, register_model, unbox
from numba.np import arrayobj
from numpy.typing import NDArray

WORD = ir.IntType(64)
NO_ARRAY = -1  # in place of the number of dimensions
KINDS = {np.dtype(np.float64): types.float64, np.dtype(np.int64): types.int64, np.dtype(np.int32): types.int32}


class TableType(types.Type):
    """What numba knows of a table: its fields with their types and their places in the directory."""

    def __init__(self, title: str, places: tuple[tuple[str, Any, int], ...]) -> None:
        self.places = {name: (kind, place) for name, kind, place in places}
        text = ",".join(f"{name}:{kind}:{place}" for name, kind, place in places)
        super().__init__(name=f"{title}_{hashlib.sha256(text.encode()).hexdigest()[:10]}")


@dataclass(frozen=True, eq=False)
class Table:
    """Base of frozen dataclasses whose fields are arrays, numbers or other tables.

    Arrays are C-contiguous, of float64, int64 or int32. Kernels write into them; nothing puts another array in their place.
    In a kernel an array is looked up whenever it is named: name it once before a loop.
    """

    def __post_init__(self) -> None:
        """Make the directory: address and shape of every array, in words of 64 bits."""
        words: list[int] = []
        kinds: list[tuple[Any, int]] = []  # of array with its dimensions, or of table, or number, with none
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray):
                kind = KINDS.get(value.dtype)
                if not value.flags.c_contiguous or kind is None:
                    raise TypeError(
                        f"{type(self).__name__}.{field.name} is to be a contiguous array of float64, int64 or int32, "
                        f"not of {value.dtype} with strides {value.strides}"
                    )
                kinds.append((kind, value.ndim))
                words += [value.__array_interface__["data"][0], *value.shape]
            elif isinstance(value, Table):
                kinds.append((value.__dict__["_numba_type_"], NO_ARRAY))
                words.append(value.__dict__["_address"])
            else:
                kinds.append((types.float64, NO_ARRAY))
                words.append(struct.unpack("q", struct.pack("d", float(value)))[0])
        directory = np.array(words, dtype=np.int64)
        self.__dict__.update(
            _directory=directory,
            _address=directory.ctypes.data,
            _numba_type_=_table_type(type(self), tuple(kinds)),
        )

    def __iter__(self) -> Iterator[Any]:
        """The fields' values in their order."""
        return (getattr(self, field.name) for field in fields(self))

    def copy(self) -> Self:
        """A table of copies of all arrays."""
        return type(self)(*(value.copy() if isinstance(value, np.ndarray | Table) else value for value in self))


T = TypeVar("T", bound=Table)


def packed(table: T) -> tuple[T, NDArray[np.float64]]:
    """The same with all arrays one behind the other in one array of numbers, of which they are views, and that array.

    For arrays of float64 and int64, the bits of which then stand for numbers.
    """
    flat = np.empty(_words(table))
    made, _ = _moved(table, flat, 0)
    return made, flat


def _words(table: Table) -> int:
    return sum(_words(v) if isinstance(v, Table) else v.size for v in table if isinstance(v, np.ndarray | Table))


def _moved(table: T, flat: NDArray[np.float64], place: int) -> tuple[T, int]:
    values: list[Any] = []
    for value in table:
        if isinstance(value, Table):
            value, place = _moved(value, flat, place)
        elif isinstance(value, np.ndarray):
            view = flat[place : place + value.size].view(value.dtype).reshape(value.shape)
            view[...] = value
            value, place = view, place + value.size
        values.append(value)
    return type(table)(*values), place


_types: dict[tuple[object, tuple[tuple[Any, int], ...]], TableType] = {}


def _table_type(table: type[Table], kinds: tuple[tuple[Any, int], ...]) -> TableType:
    """What numba knows of tables of one class whose fields are of these kinds: to make it takes a hundred times as long as a table."""
    known = _types.get((table, kinds))
    if known is not None:
        return known
    places: list[tuple[str, Any, int]] = []
    place = 0
    for field, (kind, ndim) in zip(fields(table), kinds, strict=True):
        is_array = ndim != NO_ARRAY
        places.append((field.name, types.Array(kind, ndim, "C") if is_array else kind, place))
        place += 1 + ndim if is_array else 1
    made = _types[table, kinds] = TableType(table.__name__, tuple(places))
    return made


def numba_type(table: Table) -> TableType:
    """The type of a table for signatures."""
    kind: TableType = table.__dict__["_numba_type_"]
    return kind


register_model(TableType)(models.OpaqueModel)


@unbox(TableType)  # type: ignore[no-untyped-call, untyped-decorator]
def _unbox(kind: TableType, table: Any, c: Any) -> NativeValue:
    """The directory's address; the caller holds the table, and so its arrays, for as long as the kernel runs."""
    number = c.pyapi.object_getattr_string(table, "_address")
    address = c.pyapi.long_as_voidptr(number)
    c.pyapi.decref(number)
    failed = cgutils.is_not_null(c.builder, c.pyapi.err_occurred())  # type: ignore[no-untyped-call]
    return NativeValue(address, is_error=failed)  # type: ignore[no-untyped-call]


@infer_getattr
class _TableAttribute(AttributeTemplate):
    key = TableType

    def generic_resolve(self, table: TableType, name: str) -> Any:  # type: ignore[override]
        """The type of a field, None for a name that is none."""
        return table.places[name][0] if name in table.places else None


@lower_getattr_generic(TableType)  # type: ignore[no-untyped-call, untyped-decorator]
def _field(context: Any, builder: Any, table: TableType, value: Any, name: str) -> Any:
    """A field's value: a number, the address of a table's directory, or an array that owns nothing."""
    kind, place = table.places[name]
    words = builder.bitcast(value, WORD.as_pointer())

    def word(k: int) -> Any:
        loaded = builder.load(builder.gep(words, [ir.Constant(ir.IntType(32), k)]))
        loaded.set_metadata("invariant.load", builder.module.add_metadata([]))
        return loaded

    if isinstance(kind, TableType):
        return builder.inttoptr(word(place), ir.IntType(8).as_pointer())
    if kind == types.float64:
        return builder.bitcast(word(place), ir.DoubleType())
    array = arrayobj.make_array(kind)(context, builder)  # type: ignore[no-untyped-call]
    data = context.get_data_type(kind.dtype)
    size = context.get_abi_sizeof(data)
    shape = [word(place + 1 + i) for i in range(kind.ndim)]
    strides = [ir.Constant(WORD, size)]
    for extent in reversed(shape[1:]):
        strides.insert(0, builder.mul(strides[0], extent, flags=["nsw"]))
    arrayobj.populate_array(  # type: ignore[no-untyped-call]
        array,
        data=builder.inttoptr(word(place), data.as_pointer()),
        shape=shape,
        strides=strides,
        itemsize=size,
        meminfo=None,
    )
    return array._getvalue()


def _address_of(typing_context: Any, table: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.ptrtoint(values[0], WORD)

    return types.int64(table), code


address: Any = intrinsic(_address_of)
"""``address(table)``: of its directory, in compiled code."""
