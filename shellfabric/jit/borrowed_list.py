"""Borrowed references: items of numba's typed lists without reference counts.

numba counts the references to each array of what is taken out of a list, up and down again, each time an instruction
that all processors wait for. The state of a ply has over a hundred arrays: in a pack of 16 plies of 6,241 elements
that came to a third of what the plies cost alone. What marches is held by Python for as long as it does, so kernels
without reference counts (_nrt=False) may look at it where it lies.
"""

from llvmlite import ir
from numba.core import cgutils
from numba.extending import intrinsic

from shellfabric.jit.by_reference import Reference, referred


@intrinsic
def borrowed_item(typing, items, number):
    """items[number] of a typed list, for kernels that count no references; a number out of range is not caught."""

    def codegen(context, builder, signature, arguments):
        kind, pointer = signature.args[0], cgutils.voidptr_t
        box = cgutils.create_struct_proxy(kind)(context, builder, value=arguments[0])
        first = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(pointer, [box.data.type]), "numba_list_base_ptr"
        )
        part = context.data_model_manager[kind.item_type].get_data_type()
        place = builder.bitcast(builder.call(first, [box.data]), part.as_pointer())
        place = cgutils.gep(builder, place, arguments[1])
        if isinstance(signature.return_type, Reference):
            return builder.bitcast(place, pointer)
        return context.data_model_manager[kind.item_type].load_from_data_pointer(builder, place)

    return referred(items.item_type)(items, number), codegen
