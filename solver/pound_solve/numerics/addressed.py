"""Tuples of arrays that compiled code receives as a single address: an extension of numba.

When one kernel calls another, numba passes every component of a named tuple separately, seven for every
array.  The calls of a method then have two thousand arguments, which take longer to compile than the bodies
of the kernels and slow down every run.  An `Addressed` tuple is passed as the address of its cells
(`block.Block`), and its parts are read when they are used.  Kernels use it like any tuple, but cannot
create one.

The loads are marked ``invariant.load``, because nothing writes to the cells while a kernel runs.  A loop
therefore reads an address and a length only once, even if it writes to arrays.
"""

from __future__ import annotations

import hashlib
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.datamodel import models, register_default
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import NativeValue, lower_getattr_generic, unbox

CELL = ir.IntType(64)
OWNERS, PLACE = 2, 4  #: offsets of the number of elements and of the address among the cells of an array


class Addressed(types.Type):
    """A named tuple that is passed by address.

    Parameters
    ----------
    parts : numba type of a named tuple
    """

    def __init__(self, parts: Any) -> None:
        self.parts = parts
        key = hashlib.sha256(str(parts).encode()).hexdigest()[:16]  # becomes part of long names
        super().__init__(name=f"{parts.instance_class.__name__}-{key}")


def addressed(kind: Any) -> Any:
    """Return the type with which a kernel receives a value: a named tuple is passed by address unless it
    contains functions.
    """
    return Addressed(kind) if isinstance(kind, types.BaseNamedTuple) and n_cells(kind) else kind


def n_cells(kind: Any) -> int:
    """Return the number of cells of a value of this type in a `block.Block`; 0 if it cannot be stored
    there.
    """
    if isinstance(kind, types.Array):
        return 2 * kind.ndim + PLACE + 1 if kind.layout == "C" else 0
    if isinstance(kind, types.BaseTuple):
        sizes = [n_cells(part) for part in kind.types]
        return sum(sizes) if all(sizes) else 0
    return int(isinstance(kind, types.Number | types.Boolean | types.Record))


@register_default(Addressed)
class AddressedModel(models.OpaqueModel):
    """Data model of an address."""


@unbox(Addressed)
def from_address(kind: Any, number: Any, c: Any) -> Any:
    """Unbox an address that Python passes to a kernel as an integer."""
    return NativeValue(c.pyapi.long_as_voidptr(number))


@infer_getattr
class PartTypes(AttributeTemplate):
    """Types of the parts."""

    key = Addressed

    def generic_resolve(self, owner: Any, name: str) -> Any:
        """Return the type of the part `name`, or None if there is no such part."""
        fields = owner.parts.fields
        return addressed(owner.parts.types[fields.index(name)]) if name in fields else None


@lower_getattr_generic(Addressed)
def part(context: Any, builder: Any, owner: Any, address: Any, name: str) -> Any:
    """Generate code that reads the named part of an addressed tuple."""
    number = owner.parts.fields.index(name)
    before = sum(n_cells(other) for other in owner.parts.types[:number])
    place = builder.gep(builder.bitcast(address, CELL.as_pointer()), [CELL(before)])
    kind = owner.parts.types[number]
    if isinstance(addressed(kind), Addressed):
        return builder.bitcast(place, cgutils.voidptr_t)
    return read(context, builder, kind, place)


def read(context: Any, builder: Any, kind: Any, place: Any) -> Any:
    """Generate code that reads a value of a type from the cells that start at `place`."""
    if isinstance(kind, types.Array):
        return read_array(context, builder, kind, place)
    if isinstance(kind, types.BaseTuple):
        values, before = [], 0
        for field in kind.types:
            values.append(read(context, builder, field, builder.gep(place, [CELL(before)])))
            before += n_cells(field)
        return context.make_tuple(builder, kind, values)
    if isinstance(kind, types.Boolean):
        return builder.trunc(load(builder, place), ir.IntType(1))
    return load(builder, builder.bitcast(place, context.get_value_type(kind).as_pointer()))


def read_array(context: Any, builder: Any, kind: Any, place: Any) -> Any:
    """Generate code that reads the address and shape of an array, which determine all its other fields."""
    layout = context.get_value_type(kind)
    shape = [load(builder, builder.gep(place, [CELL(PLACE + 1 + n)])) for n in range(kind.ndim)]
    size = context.get_abi_sizeof(context.get_data_type(kind.dtype))
    strides = [CELL(size)]
    for length in reversed(shape[1:]):
        strides.insert(0, builder.mul(strides[0], length))
    elements = shape[0]
    for length in shape[1:]:
        elements = builder.mul(elements, length)
    address = builder.gep(place, [CELL(PLACE)])
    address = load(builder, builder.bitcast(address, layout.elements[PLACE].as_pointer()))
    value = ir.Constant(layout, None)  # no owners
    for n, field in enumerate([elements, CELL(size), address], start=OWNERS):
        value = builder.insert_value(value, field, n)
    for n in range(kind.ndim):
        value = builder.insert_value(value, shape[n], [PLACE + 1, n])
        value = builder.insert_value(value, strides[n], [PLACE + 2, n])
    return value


def load(builder: Any, place: Any) -> Any:
    """Generate code that loads a cell and marks it as constant for the compiler."""
    value = builder.load(place)
    value.set_metadata("invariant.load", builder.module.add_metadata([]))
    return value
