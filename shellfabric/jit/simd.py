"""8-wide SIMD type of doubles for numba, and its operations: a loop is written as it is to run, in one
pass without checks for overlap, every element alike wherever it stands, so that results do not depend
on how work is cut. LLVM gives up on vector instructions in loops with many arrays or a look-up.

    x = load(array, k)          array[k], ..., array[k + 7]
    store(array, k, 2.0 * x)
    fma(x, y, z)                x y + z, rounded once where the processor can
    gather_rows4(table, cell)   c0, ..., c3 with c_m = table[cell, m] of eight cells
    load_or_broadcast(x, k)     load(x, k) of an array, x itself of a float

+, -, * and / take two of these or one and a float, as functions do that say so: a formula is one for a
point and for eight. Processors with narrower registers do the same in several instructions.
"""

import operator

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import ConcreteTemplate, infer_global
from numba.extending import intrinsic, lower_builtin, models, overload, register_model

from shellfabric.jit.compile import kernel

WIDTH = 8
_DOUBLE = ir.DoubleType()
_INT = ir.IntType(64)
_FLOAT64X8 = ir.VectorType(_DOUBLE, WIDTH)
_INT64X8 = ir.VectorType(_INT, WIDTH)
_INT32X8 = ir.VectorType(ir.IntType(32), WIDTH)


class VectorType(types.Type):
    """Vector of eight numbers or booleans."""


_MODELS = {
    "Lanes": _FLOAT64X8,
    "Cells": _INT32X8,
    "Mask": ir.VectorType(ir.IntType(1), WIDTH),
}
FLOAT64X8 = VectorType("Lanes")
INT32X8 = VectorType("Cells")  # row numbers of a table
MASK = VectorType("Mask")


@register_model(VectorType)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, _MODELS[kind.name])


def _splat(builder, value, vector):
    """A number in all lanes of a vector."""
    first = ir.Constant(ir.IntType(32), 0)
    one = builder.insert_element(ir.Constant(vector, ir.Undefined), value, first)
    return builder.shuffle_vector(one, one, ir.Constant(_INT32X8, [0] * WIDTH))


def _vectors(builder, arguments, signature):
    """Arguments as vectors: a float in all lanes, others as they are."""
    found = list(arguments)
    for number, kind in enumerate(signature.args):
        if kind == types.float64:
            found[number] = _splat(builder, found[number], _FLOAT64X8)
    return found


def _alike(builder, arguments, signature):
    """Arguments as vectors, unless there is none among arguments and result."""
    if {FLOAT64X8, MASK} & {signature.return_type, *signature.args}:
        return _vectors(builder, arguments, signature)
    return arguments


def _operator(symbol, instruction):
    """Both operands vectors, or one a float. Typed and lowered like numba's own operators: an
    `overload` would have its function compiled from byte code at every place that it is used."""
    pairs = (FLOAT64X8, FLOAT64X8), (FLOAT64X8, types.float64), (types.float64, FLOAT64X8)

    class Operator(ConcreteTemplate):
        cases = tuple(FLOAT64X8(*pair) for pair in pairs)

    infer_global(symbol)(Operator)

    def codegen(context, builder, signature, arguments):
        return getattr(builder, instruction)(*_vectors(builder, arguments, signature))

    for pair in pairs:
        lower_builtin(symbol, *pair)(codegen)


for _symbol, _instruction in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _operator(_symbol, _instruction)


def _function(name, count):
    """An LLVM function of `count` numbers that works lane by lane."""

    def codegen(context, builder, signature, arguments):
        if signature.return_type is not FLOAT64X8:
            function = _llvm_function(builder, f"llvm.{name}.f64", _DOUBLE, count)
            return builder.call(function, arguments)
        function = _llvm_function(builder, f"llvm.{name}.v{WIDTH}f64", _FLOAT64X8, count)
        return builder.call(function, _vectors(builder, arguments, signature))

    return codegen


def _llvm_function(builder, name, number, count):
    """A function of LLVM's from `count` numbers to one."""
    kind = ir.FunctionType(number, [number] * count)
    return cgutils.get_or_insert_function(builder.module, kind, name)


def _constant(kind, value):
    """The same number in all lanes."""
    if isinstance(kind, ir.VectorType):
        value = [value] * WIDTH
    return ir.Constant(kind, value)


def _signature(*kinds):
    """Of a function of floats, or of vectors and floats."""
    if FLOAT64X8 in kinds:
        return FLOAT64X8(*kinds)
    return types.float64(*(types.float64,) * len(kinds))


@intrinsic
def fma(typing, a, b, c):
    """Compute a b + c, of vectors or of floats."""
    return _signature(a, b, c), _function("fmuladd", 3)


@intrinsic
def sqrt(typing, a):
    """Take the square root of a vector or of a float."""
    return _signature(a), _function("sqrt", 1)


@intrinsic
def rsqrt(typing, a):
    """Compute 1 / sqrt(a), for numbers between 1e-38 and 1e38: the root of seven digits, and one
    step of third order from it.

    That is exact but for the last digit, and half as dear as a root and a division of sixteen
    digits.
    """

    def codegen(context, builder, signature, arguments):
        (a,) = arguments
        wide = _DOUBLE
        small = ir.FloatType()
        suffix = ""
        if signature.return_type is FLOAT64X8:
            wide = _FLOAT64X8
            small = ir.VectorType(small, WIDTH)
            suffix = f"v{WIDTH}"
        number = lambda value, kind=wide: _constant(kind, value)  # noqa: E731
        root = _llvm_function(builder, f"llvm.sqrt.{suffix}f32", small, 1)
        fuse = _llvm_function(builder, f"llvm.fmuladd.{suffix}f64", wide, 3)
        root = builder.call(root, [builder.fptrunc(a, small)])
        guess = builder.fpext(builder.fdiv(number(1.0, small), root), wide)
        off = builder.call(fuse, [builder.fneg(builder.fmul(a, guess)), guess, number(1.0)])
        step = builder.call(fuse, [off, number(0.375), number(0.5)])
        return builder.call(fuse, [builder.fmul(guess, off), step, guess])

    return _signature(a), codegen


@intrinsic
def floor(typing, a):
    """Round a vector or a float down."""
    return _signature(a), _function("floor", 1)


@intrinsic
def fabs(typing, a):
    """Take the absolute value of a vector or of a float."""
    return _signature(a), _function("fabs", 1)


@intrinsic
def copysign(typing, a, b):
    """Return the size of a with the sign of b."""
    return FLOAT64X8(a, b), _function("copysign", 2)


def _select(symbol):
    def codegen(context, builder, signature, arguments):
        a, b = _alike(builder, arguments, signature)
        return builder.select(builder.fcmp_ordered(symbol, a, b), a, b)

    return codegen


@intrinsic
def minimum(typing, a, b):
    """Take the smaller of two vectors, lane by lane, or of two floats."""
    return _signature(a, b), _select("<")


@intrinsic
def maximum(typing, a, b):
    """Take the larger of two vectors, lane by lane, or of two floats."""
    return _signature(a, b), _select(">")


@intrinsic
def greater(typing, a, b):
    """Compare two vectors, a > b: a mask; of two floats a boolean."""

    def codegen(context, builder, signature, arguments):
        a, b = _alike(builder, arguments, signature)
        return builder.fcmp_ordered(">", a, b)

    if FLOAT64X8 in (a, b):
        return MASK(a, b), codegen
    return types.boolean(types.float64, types.float64), codegen


@intrinsic
def both(typing, a, b):
    """Combine two masks, or two booleans: where a and b hold."""

    def codegen(context, builder, signature, arguments):
        return builder.and_(*arguments)

    return a(a, b), codegen


@intrinsic
def any_lane(typing, mask):
    """Tell whether any lane of a mask is set."""

    def codegen(context, builder, signature, arguments):
        return builder.icmp_unsigned(
            "!=", builder.bitcast(arguments[0], ir.IntType(8)), ir.Constant(ir.IntType(8), 0)
        )

    return types.boolean(mask), codegen


@intrinsic
def movemask(typing, mask):
    """Return the mask as bits of an integer, lane 0 lowest."""

    def codegen(context, builder, signature, arguments):
        return builder.zext(builder.bitcast(arguments[0], ir.IntType(8)), _INT)

    return types.int64(mask), codegen


@intrinsic
def mask_from_bits(typing, number):
    """Return the mask from the bits of an integer, lane 0 lowest."""

    def codegen(context, builder, signature, arguments):
        eight = builder.trunc(arguments[0], ir.IntType(8))
        return builder.bitcast(eight, ir.VectorType(ir.IntType(1), WIDTH))

    return MASK(types.int64), codegen


@intrinsic
def equal_bytes(typing, array, k, value):
    """Return the mask of array[k : k + 8] == value; array of bytes."""

    def codegen(context, builder, signature, arguments):
        part = ir.VectorType(ir.IntType(8), WIDTH)
        array, k, value = arguments
        found = builder.load(_pointer(context, builder, signature.args[0], array, k, part), align=1)
        sought = _splat(builder, builder.trunc(value, ir.IntType(8)), part)
        return builder.icmp_unsigned("==", found, sought)

    return MASK(array, k, types.int64), codegen


@intrinsic
def head_mask(typing, count):
    """Return the mask of the first `count` lanes."""

    def codegen(context, builder, signature, arguments):
        count = _splat(builder, builder.sext(arguments[0], _INT), _INT64X8)
        return builder.icmp_signed("<", ir.Constant(_INT64X8, list(range(WIDTH))), count)

    return MASK(types.int64), codegen


@intrinsic
def where(typing, mask, a, b):
    """Take a where the mask holds, else b; floats if it is a boolean."""

    def codegen(context, builder, signature, arguments):
        return builder.select(*_alike(builder, arguments, signature))

    if isinstance(mask, types.Boolean):
        return types.float64(types.boolean, types.float64, types.float64), codegen
    return FLOAT64X8(mask, a, b), codegen


@intrinsic
def lane_numbers(typing):
    """Return 0, 1, ..., 7."""

    def codegen(context, builder, signature, arguments):
        return ir.Constant(_FLOAT64X8, [float(lane) for lane in range(WIDTH)])

    return FLOAT64X8(), codegen


@intrinsic
def broadcast(typing, a):
    """Broadcast a float to all lanes."""

    def codegen(context, builder, signature, arguments):
        return _splat(builder, arguments[0], _FLOAT64X8)

    return FLOAT64X8(types.float64), codegen


def _pointer(context, builder, kind, array, index, part):
    """Pointer to array[index], as one to `part`."""
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), ir.PointerType(part))


@intrinsic
def load(typing, array, k):
    """Load array[k : k + 8] of a flat array of floats; float32 is widened."""

    def codegen(context, builder, signature, arguments):
        kind = signature.args[0]
        small = kind.dtype == types.float32
        if small:
            part = ir.VectorType(ir.FloatType(), WIDTH)
        else:
            part = _FLOAT64X8
        pointer = _pointer(context, builder, kind, *arguments, part)
        found = builder.load(pointer, align=4 if small else 8)
        if small:
            return builder.fpext(found, _FLOAT64X8)
        return found

    return FLOAT64X8(array, k), codegen


@intrinsic
def store(typing, array, k, value):
    """Store array[k : k + 8] = value; float32 arrays take it rounded."""

    def codegen(context, builder, signature, arguments):
        kind = signature.args[0]
        array, k, _ = arguments
        _, _, value = _vectors(builder, arguments, signature)
        small = kind.dtype == types.float32
        part = _FLOAT64X8
        if small:
            part = ir.VectorType(ir.FloatType(), WIDTH)
            value = builder.fptrunc(value, part)
        builder.store(
            value, _pointer(context, builder, kind, array, k, part), align=4 if small else 8
        )
        return context.get_dummy_value()

    return types.void(array, k, value), codegen


@intrinsic
def shift_in_prev(typing, last, x):
    """Shift by one lane towards higher lanes: lane 0 comes from lane 7 of `last`, the vector before
    x."""

    def codegen(context, builder, signature, arguments):
        return builder.shuffle_vector(
            *arguments, ir.Constant(_INT32X8, list(range(WIDTH - 1, 2 * WIDTH - 1)))
        )

    return FLOAT64X8(last, x), codegen


def load_or_broadcast(values, k):
    """Load values[k : k + 8] of an array; a float is broadcast."""


@overload(load_or_broadcast, inline="always")
def _load_or_broadcast(values, k):
    if isinstance(values, types.Float):
        return lambda values, k: values
    return lambda values, k: load(values, k)


def item_or_scalar(values, k):
    """Return values[k] of an array; a float as it is."""


@overload(item_or_scalar, inline="always")
def _item_or_scalar(values, k):
    if isinstance(values, types.Float):
        return lambda values, k: values
    return lambda values, k: values[k]


@intrinsic
def lane_of(typing, value, number):
    """Return one lane of eight."""

    def codegen(context, builder, signature, arguments):
        return builder.extract_element(arguments[0], builder.trunc(arguments[1], ir.IntType(32)))

    return types.float64(value, types.int64), codegen


@kernel()
def masked_store(array, k, value, count):
    """Store with a mask: array[k : k + count] = value, for the last, incomplete vector of an
    array."""
    if count >= WIDTH:
        store(array, k, value)
    else:
        for number in range(count):
            array[k + number] = lane_of(value, number)


@intrinsic
def to_int32(typing, a):
    """Convert doubles, or one, to int32."""

    def codegen(context, builder, signature, arguments):
        if signature.return_type is INT32X8:
            return builder.fptosi(arguments[0], _INT32X8)
        return builder.fptosi(arguments[0], ir.IntType(32))

    if a == FLOAT64X8:
        return INT32X8(a), codegen
    return types.int32(types.float64), codegen


@intrinsic
def store_int32(typing, array, k, cell):
    """Store eight int32: array[k : k + 8] = cell."""

    def codegen(context, builder, signature, arguments):
        array, k, cell = arguments
        builder.store(
            cell, _pointer(context, builder, signature.args[0], array, k, _INT32X8), align=4
        )
        return context.get_dummy_value()

    return types.void(array, k, cell), codegen


@intrinsic
def gather8_indexed(typing, table, array, k):
    """Gather the rows of a table (n, 8) whose numbers are array[k : k + 8], transposed: eight vectors."""

    def codegen(context, builder, signature, arguments):
        table, array, k = arguments
        data = context.make_array(signature.args[1])(context, builder, array).data
        numbers = [
            builder.load(builder.gep(data, [builder.add(k, ir.Constant(_INT, lane))]))
            for lane in range(WIDTH)
        ]
        found = _numbered_rows(context, builder, signature.args[0], table, numbers, 8, 8)
        return context.make_tuple(builder, signature.return_type, _transposed(builder, found, 8))

    return types.UniTuple(FLOAT64X8, 8)(table, array, k), codegen


@intrinsic
def gather(typing, array, cell):
    """Gather: array[cell] of eight indices into a flat array."""

    def codegen(context, builder, signature, arguments):
        array, cell = arguments
        data = context.make_array(signature.args[0])(context, builder, array).data
        found = ir.Constant(_FLOAT64X8, ir.Undefined)
        for lane in range(WIDTH):
            number = ir.Constant(ir.IntType(32), lane)
            place = builder.gep(data, [builder.zext(builder.extract_element(cell, number), _INT)])
            found = builder.insert_element(found, builder.load(place), number)
        return found

    return FLOAT64X8(array, cell), codegen


@intrinsic
def gather_runs(typing, array, cell):
    """Gather array[cell : cell + 4] of eight places in a flat array, transposed: four vectors."""

    def codegen(context, builder, signature, arguments):
        array, cell = arguments
        numbers = _lanes(builder, cell)
        found = _numbered_rows(context, builder, signature.args[0], array, numbers, 4, 1)
        return context.make_tuple(builder, signature.return_type, _transposed(builder, found, 4))

    return types.UniTuple(FLOAT64X8, 4)(array, cell), codegen


@intrinsic
def add_at(typing, array, cell, value):
    """Add eight numbers to array[cell] of a flat array, lane after lane: cells may be alike."""

    def codegen(context, builder, signature, arguments):
        array, cell, value = arguments
        data = context.make_array(signature.args[0])(context, builder, array).data
        for number, own in zip(_lanes(builder, cell), _lanes(builder, value)):
            place = builder.gep(data, [builder.zext(number, _INT)])
            builder.store(builder.fadd(builder.load(place), own), place)
        return context.get_dummy_value()

    return types.void(array, cell, value), codegen


def _lanes(builder, vector):
    """The eight lanes of a vector."""
    return [
        builder.extract_element(vector, ir.Constant(ir.IntType(32), lane)) for lane in range(WIDTH)
    ]


@intrinsic
def gather_rows4(typing, table, cell):
    """Gather the rows `cell` of a table (n, 4), transposed: four vectors; four floats of one row."""

    def one(context, builder, signature, arguments):
        table, cell = arguments
        data = context.make_array(signature.args[0])(context, builder, table).data
        first = builder.mul(builder.sext(cell, _INT), ir.Constant(_INT, 4))
        places = [builder.add(first, ir.Constant(_INT, column)) for column in range(4)]
        found = [builder.load(builder.gep(data, [place])) for place in places]
        return context.make_tuple(builder, signature.return_type, found)

    if isinstance(cell, types.Integer):
        return types.UniTuple(types.float64, 4)(table, types.int32), one

    def codegen(context, builder, signature, arguments):
        found = _table_rows(context, builder, signature.args[0], arguments, 4)
        return context.make_tuple(builder, signature.return_type, _transposed(builder, found, 4))

    return types.UniTuple(FLOAT64X8, 4)(table, cell), codegen


def _table_rows(context, builder, kind, arguments, count):
    """The rows of a table of `count` columns, each as a vector."""
    table, cell = arguments
    return _numbered_rows(context, builder, kind, table, _lanes(builder, cell), count, count)


def _numbered_rows(context, builder, kind, table, numbers, count, stride):
    """The rows of given numbers, of `count` columns, each `stride` behind the one before."""
    array = context.make_array(kind)(context, builder, table)
    part = ir.VectorType(_DOUBLE, count)
    found = []
    for number in numbers:
        row = builder.zext(number, _INT)
        place = builder.gep(array.data, [builder.mul(row, ir.Constant(_INT, stride))])
        pointer = builder.bitcast(place, ir.PointerType(part))
        found.append(builder.load(pointer, align=8))
    return found


def _transposed(builder, rows, count):
    """Eight rows of `count` numbers as `count` columns of eight."""

    def shuffle(a, b, lanes):
        return builder.shuffle_vector(a, b, ir.Constant(_INT32X8, lanes))

    if count == 4:  # rows r and r + 4 side by side
        rows = [shuffle(rows[r], rows[r + 4], list(range(WIDTH))) for r in range(4)]
    # blocks of one, two, four numbers beside the diagonal change places
    block = 1
    while block < count:
        low = list(range(WIDTH))
        for lane in range(WIDTH):
            if lane & block:
                low[lane] += WIDTH - block
        high = [lane + block for lane in low]
        for r in range(count):
            if not r & block:
                a = rows[r]
                b = rows[r + block]
                rows[r] = shuffle(a, b, low)
                rows[r + block] = shuffle(a, b, high)
        block *= 2
    return rows


def _tree_reduction(combine):
    """Make a function from eight lanes to one number: halves are combined, then halves of these; of
    a float that itself."""

    @intrinsic
    def reduced(typing, a):
        def codegen(context, builder, signature, arguments):
            if signature.args[0] is not FLOAT64X8:
                return arguments[0]
            numbers = (ir.Constant(ir.IntType(32), lane) for lane in range(WIDTH))
            parts = [builder.extract_element(arguments[0], number) for number in numbers]
            while len(parts) > 1:
                half = len(parts) // 2
                parts = [combine(builder, *pair) for pair in zip(parts[:half], parts[half:])]
            return parts[0]

        return types.float64(a), codegen

    return reduced


def _larger(builder, a, b):
    return builder.select(builder.fcmp_ordered(">", a, b), a, b)


reduce_add = _tree_reduction(ir.IRBuilder.fadd)
reduce_max = _tree_reduction(_larger)
