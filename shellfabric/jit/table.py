"""Tables of arrays that kernels take: one class for each, one line for each array or number.

    class Ply(Row):
        ni = integer("-", "elements along the warp")
        u = array("3 x slots", "m", "displacement of the nodes", kept=True)

From such a class follow the numba type of its rows, storage (`zeros`), what a checkpoint keeps (`kept`)
and the page for developers. A kernel gets a row as a pointer to words of eight bytes: a number, the
address and shape of an array, the address of a total. Who makes a row keeps its arrays alive; a list of
rows (`Rows`) is a list of such pointers. What does not fit its line is refused where a row is made: a
kernel would read memory that is not there.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, ClassVar

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_setattr_generic
from numba.core.typing.templates import (
    AbstractTemplate,
    AttributeTemplate,
    infer_global,
    signature,
)
from numba.extending import (
    NativeValue,
    infer_getattr,
    intrinsic,
    lower_builtin,
    lower_getattr_generic,
    models,
    register_model,
    unbox,
)
from numba.np import numpy_support

from shellfabric.jit.aligned import aligned_zeros

WORD = ir.IntType(64)
KINDS = ("int64", "int32", "uint8", "boolean", "float32")  # of arrays, besides doubles
# grids: what is one number on a uniform one may be an array on a graded one
UNIFORM = 0
GRADED = 1


@dataclass(frozen=True)
class Field:
    """One line of a table.

    Parameters
    ----------
    shape : "number", "blocks, 4" of an array, "3 x slots" of a tuple of three arrays
    unit, meaning : for the reader
    kinds : numba types, on a uniform and on a graded grid
    kept : whether a checkpoint has it
    table : of a row in a row
    """

    shape: str
    unit: str
    meaning: str
    kinds: tuple[Any, Any]
    kept: bool = False
    table: type[Row] | None = None


def number(unit: str, meaning: str) -> Any:
    """Declare the field of a floating-point number."""
    return Field("number", unit, meaning, (types.float64,) * 2)


def total(unit: str, meaning: str, *, kept: bool = False) -> Any:
    """Make the field of a number that kernels and Python set by its name."""
    return Field("total", unit, meaning, (TOTAL, TOTAL), kept)


def tally(unit: str, meaning: str, *, kept: bool = False) -> Any:
    """Make the field of an integer that kernels and Python set by its name."""
    return Field("tally", unit, meaning, (TALLY, TALLY), kept)


def integer(unit: str, meaning: str) -> Any:
    """Declare the field of an integer."""
    return Field("integer", unit, meaning, (types.int64,) * 2)


def flag(meaning: str) -> Any:
    """Declare the field of a yes or no."""
    return Field("flag", "-", meaning, (types.boolean,) * 2)


def numbers(count: int, unit: str, meaning: str, kind: str = "float64") -> Any:
    """Declare the field of a few numbers that do not change."""
    found = types.UniTuple(getattr(types, kind), count)
    return Field(f"{count} numbers", unit, meaning, (found,) * 2)


def array(shape: str, unit: str, meaning: str, *, kept: bool = False) -> Any:
    """Declare the field of an array, or of a tuple of arrays of one shape: "blocks, 4", "2 x slots
    uint8"."""
    return Field(shape, unit, meaning, (array_type(shape),) * 2, kept)


def per_slot(unit: str, meaning: str) -> Any:
    """Declare the field of one number for all slots of a uniform grid, of an array of slots on a
    graded one."""
    return Field("slots, if graded", unit, meaning, PER_SLOT)


def per_family(unit: str, meaning: str) -> Any:
    """Declare the field of a number for warp and weft on a uniform grid, of an array of slots for
    each on a graded one."""
    kinds = array_type("2"), array_type("2 x slots")
    return Field("2, or 2 x slots if graded", unit, meaning, kinds)


def row(table: type[Row], meaning: str) -> Any:
    """Declare the field of a row of another table."""
    return Field(table.__name__, "-", meaning, table.types, table=table)


def array_type(shape: str) -> Any:
    """Return the numba type of the arrays of a shape, of doubles unless the text ends with another
    type."""
    counts, dimensions, kind = parts_of(shape)
    found: Any = types.Array(getattr(types, kind), len(dimensions), "C")
    for count in reversed(counts):
        found = types.UniTuple(found, count)
    return found


@cache
def parts_of(shape: str) -> tuple[list[int], list[str], str]:
    """Split a shape such as "2 x slots uint8": (counts of tuples, names of dimensions, type)."""
    *counts, rest = shape.split(" x ")
    kind = "float64"
    words = rest.split()
    if words and words[-1] in KINDS:
        kind = words.pop()
    return [int(count) for count in counts], " ".join(words).split(", "), kind


class TotalType(types.Type):
    """numba type of the place of a number that kernels set."""

    def __init__(self, name: str, number: Any) -> None:
        self.number = number  # numba type of what stands there
        super().__init__(name=name)


TOTAL = TotalType("total", types.float64)
TALLY = TotalType("tally", types.int64)
PER_SLOT = types.float64, array_type("slots")  # on a uniform and on a graded grid


def type_of(text: str, grid: int) -> Any:
    """Return the numba type of a parameter or result: "number", "flag", "3 numbers", "per slot", "2
    x per slot", the shape of an array, or several of these between semicolons."""
    if ";" in text:
        return types.Tuple([type_of(part.strip(), grid) for part in text.split(";")])
    if text in NAMED:
        return NAMED[text]
    if text.endswith(" numbers"):
        return types.UniTuple(types.float64, int(text.split()[0]))
    if text.endswith("per slot"):
        count = text.removesuffix("per slot").removesuffix(" x ")
        if count:
            return types.UniTuple(PER_SLOT[grid], int(count))
        return PER_SLOT[grid]
    return array_type(text)


NAMED = {
    "number": types.float64,
    "integer": types.int64,
    "flag": types.boolean,
    "nothing": types.none,
}


class RowType(types.Type):
    """numba type of the rows of a table on a uniform or a graded grid: a pointer to words."""

    def __init__(self, table: type[Row], grid: int) -> None:
        self.members: dict[str, tuple[Any, int]] = {}  # {name: (numba type, its first word)}
        self.words = 0
        for name, field in table.fields.items():
            self.members[name] = field.kinds[grid], self.words
            self.words += width(field.kinds[grid])
        layout = hashlib.sha256(str(self.members).encode()).hexdigest()[:16]
        super().__init__(name=f"{table.__name__}{('', '_graded')[grid]}_{layout}")

    @property
    def mangling_args(self):
        return self.name, ()


class _Total:
    """Reads and sets a total or a tally of a row in Python as kernels do, by its name."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __get__(self, row: Row | None, table: type[Row]) -> Any:
        """Return the number, not the array in which kernels have it."""
        if row is None:
            return self
        return vars(row)[self.name][()]

    def __set__(self, row: Row, value: float) -> None:
        vars(row)[self.name][()] = value


class Row:
    """Arrays and numbers by name, as the class lists them. A row does not change; its arrays do.

    Raises
    ------
    TypeError : a name is missing or unknown, or a value is not what its line says: strided, of
        another type or shape. A total or a tally may be left out, it begins at zero
    """

    fields: ClassVar[dict[str, Field]] = {}
    types: ClassVar[tuple[RowType, RowType]]
    _fields: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls, *, kept: bool = False) -> None:
        cls.fields = {name: part for name, part in vars(cls).items() if isinstance(part, Field)}
        if kept:
            rows = [name for name, part in cls.fields.items() if isinstance(part.kinds[0], RowType)]
            cls.fields = {
                name: replace(part, kept=name not in rows) for name, part in cls.fields.items()
            }
        cls._fields = tuple(cls.fields)
        for name, field in cls.fields.items():
            delattr(cls, name)
            if isinstance(field.kinds[UNIFORM], TotalType):
                setattr(cls, name, _Total(name))
        uniform = RowType(cls, UNIFORM)
        graded = RowType(cls, GRADED)
        if graded.members == uniform.members:
            graded = uniform
        cls.types = uniform, graded

    def __init__(self, **values: Any) -> None:
        table = type(self)
        # a total or a tally begins at zero, or at the number that is given
        for name, zero in table.totals().items():
            if not isinstance(values.get(name), np.ndarray):
                values[name] = np.array(values.get(name, 0), zero.dtype)
        if values.keys() != table.fields.keys():
            wrong = sorted(values.keys() ^ table.fields.keys())
            raise TypeError(f"{table.__name__}: missing or unknown: {', '.join(wrong)}")
        for name, field in table.fields.items():
            if isinstance(field.kinds[UNIFORM], types.UniTuple):
                values[name] = _as_tuples(field.kinds[UNIFORM], values[name])
        kind = table.types[_grid_of(table, values)]
        words: list[int] = []
        for name, (member, _) in kind.members.items():
            words += words_of(member, values[name], f"{table.__name__}.{name}")
        _check_lengths(table, values)
        memory = np.array(words, np.int64)
        own = self.__dict__
        own.update(values)
        own["_numba_type_"] = kind  # where numba looks first
        own["_memory"] = memory
        own["_address"] = memory.ctypes.data

    def __setattr__(self, name, value):
        """Set a total or a tally; refuse to set what else a row has."""
        if not isinstance(vars(type(self)).get(name), _Total):
            raise AttributeError(
                f"{type(self).__name__}.{name} cannot be set: kernels have its address"
            )
        object.__setattr__(self, name, value)

    def __iter__(self) -> Iterator[Any]:
        return (self.__dict__[name] for name in self._fields)

    def __getattr__(self, name: str) -> Any:  # for mypy: the names are those of the class
        raise AttributeError(f"{type(self).__name__} has no {name}")

    def __reduce__(self):
        """A copy, also in another process, has memory of its own."""
        return self.__dict__.get("_remake", (_made, (type(self), self._asdict())))

    def _asdict(self) -> dict[str, Any]:
        return {name: self.__dict__[name] for name in self._fields}

    def nested(self) -> dict[str, Any]:
        """Return {name: value}, of rows in it too."""
        values = self._asdict()
        rows = {name: value for name, value in values.items() if isinstance(value, Row)}
        return values | {name: value.nested() for name, value in rows.items()}

    def _replace(self, **changes: Any) -> Any:
        """A row with other values; the arrays that are not named are shared."""
        return type(self)(**{**self._asdict(), **changes})

    @classmethod
    def zeros(cls, **sizes: int) -> dict[str, Any]:
        """Allocate {name: zeros} of all arrays of the table whose shapes have no other sizes than
        these. Flat arrays of slots begin with a cache line."""
        found = {name: _zeros(field.shape, sizes) for name, field in cls.fields.items()}
        arrays = {name: value for name, value in found.items() if value is not None}
        return arrays | cls.totals()

    @classmethod
    def empty(cls, **rows: Row) -> Any:
        """Make a row of zeros, in which whatever has a length by name has none.

        rows : the rows that it has
        """
        others = {name: field for name, field in cls.fields.items() if name not in rows}
        return cls(**{name: _nothing(field) for name, field in others.items()}, **rows)

    @classmethod
    def totals(cls) -> dict[str, Any]:
        """Return {name: zero} of its totals and tallies."""
        kinds = {name: field.kinds[UNIFORM] for name, field in cls.fields.items()}
        return {name: _zero(kind) for name, kind in kinds.items() if isinstance(kind, TotalType)}

    @classmethod
    def kept(cls) -> list[str]:
        """Return the names of what a checkpoint has."""
        return [name for name, field in cls.fields.items() if field.kept]


def _check_lengths(table, values):
    """Hold the arrays of a row to the lengths that their shapes name: one of each name but `n`, or
    none at all.

    Raises
    ------
    TypeError : one has another length
    """
    known = {}
    for name, field in table.fields.items():
        value = values[name]
        if isinstance(value, tuple):
            arrays = value
        else:
            arrays = (value,)
        if not isinstance(arrays[0], np.ndarray) or len(set(field.kinds)) > 1:
            continue
        _, dimensions, _ = parts_of(field.shape)
        for found in arrays:
            for word, length in zip(dimensions, found.shape):
                if word[0] == "n" or not found.size:
                    continue
                if word.isdigit():
                    needed = int(word)
                else:
                    needed = known.setdefault(word, length)
                if length != needed:
                    place = f"{table.__name__}.{name}"
                    raise TypeError(f"{place}: {length} instead of {needed} of {word}")


def _made(table, values):
    return table(**values)


def _nothing(field):
    """The least value of a field."""
    kind = field.kinds[UNIFORM]
    if isinstance(kind, TotalType):
        return _zero(kind)
    if field.table:
        return field.table.empty()
    if kind == array_type(field.shape):
        return _zeros(field.shape, dict.fromkeys(parts_of(field.shape)[1], 0))
    if isinstance(kind, types.UniTuple):
        return (0,) * kind.count
    return numpy_support.as_dtype(kind).type(0)


def _zero(kind):
    """Return the array without dimensions of a total or a tally, at zero."""
    return np.zeros((), numpy_support.as_dtype(kind.number))


def _as_tuples(kind, value):
    """Lists, and arrays of arrays, as the tuples that a numba type needs."""
    if not isinstance(kind, types.UniTuple):
        return value
    if isinstance(value, (tuple, list)) or (isinstance(value, np.ndarray) and value.ndim > 1):
        return tuple(_as_tuples(kind.dtype, part) for part in value)
    return value


def _grid_of(table, values):
    """Whether the values are those of a graded grid."""
    for name, field in table.fields.items():
        uniform, graded = field.kinds
        if uniform == graded:
            continue
        if isinstance(uniform, types.Float):
            if isinstance(values[name], np.ndarray):
                return GRADED
            return UNIFORM
        if isinstance(uniform, RowType):
            if values[name]._numba_type_ == graded:
                return GRADED
            return UNIFORM
    return UNIFORM


def _zeros(shape, sizes):
    """Zeros of a shape, or None where one of its sizes is not known."""
    counts, dimensions, kind = parts_of(shape)
    known = sizes | {name: int(name) for name in dimensions if name.isdigit()}
    if not known.keys() >= set(dimensions):
        return None
    lengths = [known[name] for name in dimensions]
    dtype = np.dtype(kind.replace("boolean", "bool"))
    if not counts and dimensions != ["slots"]:
        return np.zeros(lengths, dtype)
    found = aligned_zeros(*counts or [1], *lengths, dtype)
    if counts:
        return found
    return found[0]


def width(kind: Any) -> int:
    """Count the words of a value of a numba type."""
    if isinstance(kind, types.UniTuple):
        return kind.count * width(kind.dtype)
    if isinstance(kind, types.Array):
        return 1 + kind.ndim
    return 1


def words_of(kind: Any, value: Any, name: str) -> list[int]:
    """Return the words of a value, which has to be of the numba type.

    Raises
    ------
    TypeError : it is not
    """
    if isinstance(kind, types.UniTuple):
        if not isinstance(value, tuple) or len(value) != kind.count:
            raise TypeError(f"{name} must be {kind.count} values, not {_said(value)}")
        return [word for part in value for word in words_of(kind.dtype, part, name)]
    if isinstance(kind, RowType):
        if getattr(value, "_numba_type_", None) != kind:
            raise TypeError(f"{name} must be a row of {kind}, not {_said(value)}")
        return [value._address]
    if isinstance(kind, TotalType):
        dtype = numpy_support.as_dtype(kind.number)
        if not (isinstance(value, np.ndarray) and value.dtype == dtype and value.shape == ()):
            needed = f"an array of {dtype} without dimensions"
            raise TypeError(f"{name} must be {needed}, not {_said(value)}")
        return [value.ctypes.data]
    if isinstance(kind, types.Array):
        dtype = numpy_support.as_dtype(kind.dtype)
        if not (
            isinstance(value, np.ndarray)
            and value.dtype == dtype
            and value.ndim == kind.ndim
            and value.flags.carray
        ):
            needed = f"a contiguous, writable array of {dtype} with {kind.ndim} dimensions"
            raise TypeError(f"{name} must be {needed}, not {_said(value)}")
        return [value.ctypes.data, *value.shape]
    if isinstance(kind, types.Float) and isinstance(value, (float, int, np.floating)):
        return [int(np.float64(value).view(np.int64))]
    if isinstance(kind, types.Boolean) and isinstance(value, (bool, np.bool_)):
        return [int(value)]
    if isinstance(kind, types.Integer) and isinstance(value, (int, np.integer)):
        return [int(value)]
    raise TypeError(f"{name} must be of {kind}, not {_said(value)}")


def _said(value):
    """What a value is, in a message."""
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} with shape {value.shape} and strides {value.strides}"
    return f"{value!r}"


class Rows:
    """A list of rows of one type for kernels, which it keeps; their arrays are shared.

    Raises
    ------
    TypeError : rows of different types
    """

    def __init__(self, values: Sequence[Any]) -> None:
        self.values = tuple(values)
        kinds = {value._numba_type_ for value in self.values}
        if len(kinds) != 1:
            raise TypeError(f"{len(kinds)} types in one list: {', '.join(sorted(map(str, kinds)))}")
        self._numba_type_ = RowsType(kinds.pop())
        addresses = [value._address for value in self.values]
        self._memory = np.array([len(addresses), *addresses], np.int64)
        self._address = self._memory.ctypes.data


class RowsType(types.Type):
    """numba type of `Rows`: a pointer to words, their number and their addresses."""

    def __init__(self, kind: RowType) -> None:
        self.kind = kind
        super().__init__(name=f"Rows_{kind.name}")

    @property
    def mangling_args(self):
        return self.name, ()


@register_model(RowType)
@register_model(RowsType)
class _PointerModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, WORD.as_pointer())


@unbox(RowType)
@unbox(RowsType)
def _unbox_row(kind, value, c):
    member = c.pyapi.object_getattr_string(value, "_address")
    address = c.unbox(types.intp, member).value
    c.pyapi.decref(member)
    failed = cgutils.is_not_null(c.builder, c.pyapi.err_occurred())
    return NativeValue(c.builder.inttoptr(address, WORD.as_pointer()), is_error=failed)


@infer_global(len)
class _Len(AbstractTemplate):
    def generic(self, args, kws):
        if len(args) == 1 and isinstance(args[0], RowsType):
            return signature(types.intp, *args)
        return None


@lower_builtin(len, RowsType)
def _len(context, builder, sig, arguments):
    return _load_word(builder, arguments[0], 0)


@intrinsic
def row_of(typing, rows, number):
    """Return rows[number] of `Rows`; a number out of range is not caught."""

    def codegen(context, builder, sig, arguments):
        pointer, number = arguments
        address = builder.load(builder.gep(pointer, [builder.add(number, ir.Constant(WORD, 1))]))
        return builder.inttoptr(address, WORD.as_pointer())

    return rows.kind(rows, number), codegen


@infer_getattr
class _Attribute(AttributeTemplate):
    key = RowType

    def generic_resolve(self, kind, name):
        if name not in kind.members:
            return None
        member = kind.members[name][0]
        if isinstance(member, TotalType):
            return member.number
        return member


@lower_getattr_generic(RowType)
def _member(context, builder, kind, pointer, name):
    member, first = kind.members[name]
    if isinstance(member, TotalType):
        return builder.load(_place_of_total(context, builder, member, pointer, first))
    return _loaded(context, builder, member, pointer, first)


@lower_setattr_generic(RowType)
def _set_total(context, builder, sig, arguments, name):
    member, first = sig.args[0].members[name]
    if not isinstance(member, TotalType):
        raise TypeError(f"{sig.args[0]}.{name} is no total: kernels cannot set it")
    value = context.cast(builder, arguments[1], sig.args[1], member.number)
    builder.store(value, _place_of_total(context, builder, member, arguments[0], first))


def _place_of_total(context, builder, kind, pointer, first):
    """Return the pointer to a total or a tally, whose address is word number `first`."""
    address = _load_word(builder, pointer, first)
    return builder.inttoptr(address, context.get_data_type(kind.number).as_pointer())


def _loaded(context, builder, kind, pointer, first):
    """The value of a numba type whose words begin with number `first`."""
    if isinstance(kind, types.UniTuple):
        size = width(kind.dtype)
        parts = [
            _loaded(context, builder, kind.dtype, pointer, first + k * size)
            for k in range(kind.count)
        ]
        return context.make_tuple(builder, kind, parts)
    if isinstance(kind, types.Array):
        return _loaded_array(context, builder, kind, pointer, first)
    word = _load_word(builder, pointer, first)
    if isinstance(kind, RowType):
        return builder.inttoptr(word, WORD.as_pointer())
    if isinstance(kind, types.Float):
        return builder.bitcast(word, ir.DoubleType())
    if isinstance(kind, types.Boolean):
        return builder.trunc(word, ir.IntType(1))
    return word


def _loaded_array(context, builder, kind, pointer, first):
    """An array without an owner, whose references nobody counts."""
    found = context.make_array(kind)(context, builder)
    item = context.get_abi_sizeof(context.get_data_type(kind.dtype))
    shape = [_load_word(builder, pointer, first + 1 + k) for k in range(kind.ndim)]
    step = ir.Constant(WORD, item)
    strides = []
    for length in reversed(shape):
        strides.insert(0, step)
        step = builder.mul(step, length)
    address = _load_word(builder, pointer, first)
    found.data = builder.inttoptr(address, context.get_data_type(kind.dtype).as_pointer())
    found.shape = cgutils.pack_array(builder, shape)
    found.strides = cgutils.pack_array(builder, strides)
    found.itemsize = ir.Constant(WORD, item)
    found.nitems = builder.udiv(step, ir.Constant(WORD, item))
    return found._getvalue()


def _load_word(builder, pointer, number):
    found = builder.load(builder.gep(pointer, [ir.Constant(WORD, number)]))
    found.set_metadata("invariant.load", builder.module.add_metadata([]))
    return found
