"""Lists of named tuples for kernels: the plies of a pack, their contacts, their scratch.

Python writes the tuples to memory as numba lays them out, and a kernel gets the addresses: what it compiles to does not
depend on how many there are, nothing is compiled to make the list, and no references are counted. numba's own list
takes minutes of the compiler for tuples of a hundred arrays, and counts the references to each array of what is taken
out of it, which in a pack of 16 plies came to a third of what the plies cost alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from numba import typeof, types
from numba.core import cgutils
from numba.core.datamodel import models
from numba.core.registry import cpu_target
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import NativeValue, intrinsic, lower_builtin, register_model, unbox

from shellfabric.jit.by_reference import Reference, referred


class Items:
    """A list of named tuples of one numba type, which it keeps; their arrays are shared, not copied.

    Raises
    ------
    TypeError : tuples of different types
    """

    def __init__(self, values: Sequence[Any]) -> None:
        self.values = tuple(values)
        kinds = {getattr(kind, "inner", kind) for kind in map(typeof, self.values)}
        if len(kinds) != 1:
            raise TypeError(f"{len(kinds)} types in one list")
        (self.kind,) = kinds
        self._numba_type_ = ItemsType(
            self.kind
        )  # where numba looks first: a call costs no search for it
        self._memory = [_in_memory(self.kind, value) for value in self.values]
        self._addresses = np.array([memory.ctypes.data for memory in self._memory], np.int64)
        self.address, self.count = self._addresses.ctypes.data, len(self.values)


def _in_memory(kind, value):
    """A tuple as numba keeps it."""
    found = np.zeros(-(-_size(kind) // 8), np.uint64)
    _write(kind, value, found.view(np.uint8), 0)
    return found


@cache  # llvmlite makes a module for each question
def _data_type(kind):
    return cpu_target.target_context.data_model_manager[kind].get_data_type()


@cache
def _size(kind):
    return cpu_target.target_context.get_abi_sizeof(_data_type(kind))


@cache
def _places(kind):
    """[bytes] where the members of a tuple begin."""
    whole = _data_type(kind)
    if hasattr(whole, "element"):  # an array of members of one kind
        return [k * _size(member) for k, member in enumerate(kind)]
    return [
        whole.get_element_offset(cpu_target.target_context.target_data, k) for k in range(len(kind))
    ]


def _write(kind, value, memory, start):
    """Write a value of a numba type to memory (bytes,), from byte `start` on."""
    if isinstance(kind, types.BaseTuple):
        for place, member, part in zip(_places(kind), kind, value):
            _write(member, part, memory, start + place)
        return
    if isinstance(kind, types.Array):  # no owner, no parent: nobody counts references
        words = [0, 0, value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides]
        part = np.array(words, np.int64)
    elif isinstance(kind, types.NoneType):
        return
    else:
        part = np.array(value, np.uint8 if isinstance(kind, types.Boolean) else str(kind))
    part = np.frombuffer(part.tobytes(), np.uint8)
    memory[start : start + part.size] = part


class ItemsType(types.Type):
    """numba type of `Items` of a type of named tuples."""

    def __init__(self, kind):
        self.kind = kind
        super().__init__(name=f"Items({Reference(kind).name})")

    @property
    def mangling_args(self):
        return self.name, ()


@register_model(ItemsType)
class _Model(models.StructModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, [("address", types.voidptr), ("count", types.intp)])


@unbox(ItemsType)
def _unbox(kind, items, c):
    found = cgutils.create_struct_proxy(kind)(c.context, c.builder)
    for name, number in (("address", types.uintp), ("count", types.intp)):
        member = c.pyapi.object_getattr_string(items, name)
        value = c.unbox(number, member).value
        c.pyapi.decref(member)
        setattr(
            found,
            name,
            c.builder.inttoptr(value, cgutils.voidptr_t) if name == "address" else value,
        )
    return NativeValue(
        found._getvalue(), is_error=cgutils.is_not_null(c.builder, c.pyapi.err_occurred())
    )


@infer_global(len)
class _Len(AbstractTemplate):
    def generic(self, args, kws):
        return (
            signature(types.intp, *args)
            if len(args) == 1 and isinstance(args[0], ItemsType)
            else None
        )


@lower_builtin(len, ItemsType)
def _len(context, builder, signature, arguments):
    return cgutils.create_struct_proxy(signature.args[0])(
        context, builder, value=arguments[0]
    ).count


@intrinsic
def borrowed_item(typing, items, number):
    """items[number] of `Items`, where it lies; a number out of range is not caught."""

    def codegen(context, builder, signature, arguments):
        kind, pointer = signature.args[0], cgutils.voidptr_t
        box = cgutils.create_struct_proxy(kind)(context, builder, value=arguments[0])
        addresses = builder.bitcast(box.address, pointer.as_pointer())
        place = builder.load(cgutils.gep(builder, addresses, arguments[1]))
        if isinstance(signature.return_type, Reference):
            return place
        model = context.data_model_manager[kind.kind]
        return model.load_from_data_pointer(
            builder, builder.bitcast(place, model.get_data_type().as_pointer())
        )

    return referred(items.kind)(items, number), codegen
