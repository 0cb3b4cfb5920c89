"""Named tuples that go to kernels as one pointer to their members in memory.

numba passes a tuple by value: each scalar, and seven numbers of each array, is an argument of its own. Constants, state
and scratch of a panel come to two thousand, which every kernel that hands them on takes apart and puts together again,
in text of its own: two thirds of the time that LLVM and numba's lowering took for the kernels of a panel. A tuple of a
class that is given to `by_reference` is written to memory once, where Python calls a kernel, and from there on is one
pointer; a kernel loads the members that it names. The loads are marked as invariant, since no kernel writes to them.
"""

import hashlib

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.datamodel import models
from numba.core.imputils import impl_ret_borrowed
from numba.core.pythonapi import NativeValue, unbox
from numba.core.typing.templates import AttributeTemplate
from numba.core.typing.typeof import typeof_impl
from numba.extending import infer_getattr, lower_getattr_generic, register_model

from shellfabric.jit.numba_internals import KNOWN

if KNOWN:
    from numba.core.typing.typeof import _typeof_tuple

_VIA: set[type] = set()  # classes of named tuples that are passed by reference


class Reference(types.Type):
    """Pointer to a named tuple."""

    def __init__(self, inner):
        self.inner = inner
        digest = hashlib.sha256(str(inner).encode()).hexdigest()[:16]
        super().__init__(name=f"{inner.instance_class.__name__}_{digest}")

    @property
    def mangling_args(self):
        return self.name, ()


def by_reference(*classes):
    """Have the tuples of these classes passed by reference, by a numba that is known."""
    for one in classes if KNOWN else ():
        _VIA.add(one)
        typeof_impl.register(one)(lambda value, c: Reference(_typeof_tuple(value, c)))


def referred(kind):
    """The type of a reference to a named tuple, where its class is passed so; else the type itself."""
    return (
        Reference(kind)
        if isinstance(kind, types.BaseNamedTuple) and kind.instance_class in _VIA
        else kind
    )


@register_model(Reference)
class _Model(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, cgutils.voidptr_t)


_places: dict = {}  # {(type of tuple, data layout): ([offset of each member], size)} [bytes]


def _layout(context, kind):
    key = kind.name, str(context.target_data)
    if key not in _places:
        data = context.data_model_manager[kind.inner].get_data_type()
        if isinstance(data, ir.ArrayType):  # of members of one kind
            offsets = [k * context.get_abi_sizeof(data.element) for k in range(len(kind.inner))]
        else:
            offsets = [
                data.get_element_offset(context.target_data, k) for k in range(len(kind.inner))
            ]
        _places[key] = offsets, context.get_abi_sizeof(data)
    return _places[key]


def _pointer(context, builder, kind, value, index):
    place = builder.gep(value, [ir.Constant(ir.IntType(64), _layout(context, kind)[0][index])])
    return builder.bitcast(
        place, context.data_model_manager[kind.inner[index]].get_data_type().as_pointer()
    )


@infer_getattr
class _Attribute(AttributeTemplate):
    key = Reference

    def generic_resolve(self, kind, name):
        if name in kind.inner.fields:
            return kind.inner[kind.inner.fields.index(name)]
        return None


@lower_getattr_generic(Reference)
def _member(context, builder, kind, value, name):
    """Load of one member, all its parts marked as invariant."""
    index, load, none = kind.inner.fields.index(name), builder.load, builder.module.add_metadata([])

    def invariant(*arguments, **words):
        found = load(*arguments, **words)
        found.set_metadata("invariant.load", none)
        return found

    builder.load = invariant
    try:
        model = context.data_model_manager[kind.inner[index]]
        found = model.load_from_data_pointer(
            builder, _pointer(context, builder, kind, value, index)
        )
    finally:
        del builder.load
    return impl_ret_borrowed(context, builder, kind.inner[index], found)


@unbox(Reference)
def _unbox(kind, tuple_, c):
    """Write the members to the stack of the function that Python calls."""
    builder, context = c.builder, c.context
    size = _layout(context, kind)[1]
    room = cgutils.alloca_once(builder, ir.ArrayType(ir.IntType(64), -(-size // 8)))
    base, failed, found = builder.bitcast(room, cgutils.voidptr_t), cgutils.false_bit, []
    for k, member in enumerate(kind.inner):
        native = c.unbox(member, c.pyapi.tuple_getitem(tuple_, k))
        failed = builder.or_(failed, native.is_error)
        data = context.data_model_manager[member].as_data(builder, native.value)
        builder.store(data, _pointer(context, builder, kind, base, k))
        found.append((member, native))
    # what is behind the pointer is hidden, or an invariant load could be moved before these stores
    launder = ir.InlineAsm(
        ir.FunctionType(cgutils.voidptr_t, [cgutils.voidptr_t]),
        "",
        "=r,0,~{memory}",
        side_effect=True,
    )
    hidden = builder.call(launder, [base])

    def cleanup():
        for member, native in reversed(found):
            if native.cleanup is not None:
                native.cleanup()
            if context.enable_nrt:
                context.nrt.decref(builder, member, native.value)

    return NativeValue(hidden, is_error=failed, cleanup=cleanup)
