"""How kernels are compiled.

    @kernel(...)    a helper: becomes part of the kernels that call it
    @unit(...)      compiled by itself, once, and called through a pointer (`shellfabric.state.unit`)
    @entry(...)     called by Python

Kernels call each other across files: the cache of each file is emptied by a change in any file that
it imports (`kernel_cache`), and a program imports the kernels that it uses and no others.
"""

from __future__ import annotations

import ctypes
import inspect
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import FunctionType
from typing import Any

import llvmlite.binding as llvm
from llvmlite import ir
from numba import config, njit, types
from numba.core import event
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.typing.templates import AbstractTemplate, signature
from numba.extending import intrinsic, lower_builtin

from fabrics.base.kernel_cache import compiling, kernel_cache
from shellfabric.jit.table import GRADED, UNIFORM, Row, RowsType, type_of

_USUAL = {"cache": True, "error_model": "numpy", "no_cfunc_wrapper": True}
# TBB 2021.8 of Debian 12 can wait for its threads for ever when a process ends
config.THREADING_LAYER_PRIORITY = ["omp", "tbb", "workqueue"]  # type: ignore[attr-defined]
UNITS: list[Unit] = []  # in the order in which their files are imported
FAILED = -1  # status by which numba's calling convention tells of an exception
_raised: list[BaseException] = []  # where machine code had Python compile a unit
C_TYPES = {8: ctypes.c_int8, 32: ctypes.c_int32, 64: ctypes.c_int64}


@contextmanager
def compiling_units() -> Iterator[None]:
    """Call machine code in this block: what is raised while it has a unit compiled comes out of it.

    No exception passes through machine code, which ends with numba's SystemError.
    """
    try:
        yield
    except SystemError:
        if not _raised:
            raise
        raise _raised.pop() from None


class _Announcer(event.Listener):
    """Tells the user what is being compiled; a helper belongs to the kernel that calls it."""

    def on_start(self, what):
        self._tell(what.data["dispatcher"], False)

    def on_end(self, what):
        self._tell(what.data["dispatcher"], True)

    def _tell(self, dispatcher, done):
        if not isinstance(dispatcher, _Inner):
            compiling(dispatcher.py_func.__module__, done)


event.register("numba:compile", _Announcer())


def entry(**options):
    """Decorate a kernel that Python calls; options : of numba's njit, besides those of all kernels
    here."""

    def decorated(function):
        chosen = _USUAL | options
        with kernel_cache(function.__code__.co_filename, chosen):
            return njit(**chosen)(function)

    return decorated


def kernel(**options):
    """Decorate a kernel that other kernels call."""

    def decorated(function):
        chosen = _USUAL | {"no_cpython_wrapper": True} | options
        with kernel_cache(function.__code__.co_filename, chosen):
            inner = njit(**chosen)(function)
        inner.__class__ = _Inner
        inner.entry_options = options
        return inner

    return decorated


class _Inner(CPUDispatcher):
    """A kernel that has no way in from Python, and makes itself one when Python calls it, as a test
    does.

    A constant among its arguments does not make it a variant of its own, as it would in numba:
    where it is inlined LLVM sees the constant all the same.
    """

    def get_call_template(self, args, kws):
        plain = {name: types.unliteral(kind) for name, kind in kws.items()}
        return super().get_call_template(tuple(map(types.unliteral, args)), plain)

    def __call__(self, *arguments):
        if not hasattr(self, "_twin"):
            inner = self.py_func
            twin = FunctionType(
                inner.__code__,
                inner.__globals__,
                inner.__name__,
                inner.__defaults__,
                inner.__closure__,
            )
            twin.__module__ = inner.__module__
            twin.__qualname__ = f"{inner.__qualname__}_from_python"  # names its file in the cache
            self._twin = entry(**self.entry_options)(twin)
        return self._twin(*arguments)


def units(tables: Mapping[str, type[Row]]) -> Callable[..., Any]:
    """Make the decorator of kernels that are compiled by themselves, whose parameters may have the
    names of these tables.

    A parameter that is named after the plural of a table is a list of its rows.
    """

    def unit(returns="nothing", *, later=False, **kinds):
        """returns : type of the result;  later : whether few runs call it, so that it is compiled when one does;
        kinds : of parameters that are neither rows nor integers, as texts of `table.type_of`, or
        the table that a row is of."""

        def decorated(function):
            names = inspect.signature(function).parameters
            known = {**tables, **kinds}
            grids = [
                tuple(_type_on(grid, name, known) for name in names) for grid in (UNIFORM, GRADED)
            ]
            found = Unit(function, type_of(returns, UNIFORM), dict.fromkeys(grids), later)
            UNITS.append(found)
            return found

        return decorated

    return unit


def _type_on(grid, name, known):
    """numba type of a parameter of a unit on a grid."""
    kind = known.get(name, "integer")
    if name not in known and name.removesuffix("s") in known:
        return RowsType(known[name.removesuffix("s")].types[grid])
    if isinstance(kind, str):
        return type_of(kind, grid)
    return kind.types[grid]


class Unit:
    """A kernel that is compiled by itself for the types of its parameters.

    A unit has the types that the tables of `shellfabric.state` give to the names of its parameters,
    known where its file is imported. Callers hold no code of it, but a symbol: the address of a
    cell with the address of its machine code. At first the cell leads to Python, which loads the
    code from the cache or compiles it, and puts its address there: a run compiles what it calls,
    and nothing has to be listed. A unit whose tables have `per_slot` numbers has two cells, of a
    uniform and of a graded panel.

    function, returns : the plain function, numba type of its result;  grids : types of its
        parameters on each grid
    later : see `units`
    """

    def __init__(self, function, returns, grids, later):
        self.py_func = function
        self.returns = returns
        self.later = later
        self.__module__ = function.__module__
        chosen = _USUAL | {"no_cpython_wrapper": True, "_nrt": False}
        with kernel_cache(function.__code__.co_filename, chosen):
            self.dispatcher = njit(**chosen)(function)
        self.cells = {kinds: Cell(self, kinds, number) for number, kinds in enumerate(grids)}
        self._numba_type_ = types.Function(_template_of(self))
        lower_builtin(self, types.VarArg(types.Any))(self.lower)

    def cell(self, grid):
        """Return the cell of a uniform or a graded panel, which may be one."""
        cells = list(self.cells.values())
        return cells[min(grid, len(cells) - 1)]

    def __reduce__(self):
        """A unit of another process is the one of its own file there."""
        return self.py_func.__qualname__

    def kinds_for(self, given):
        """Return the types of the parameters on the grid that arguments are of."""
        for kinds in self.cells:
            if len(kinds) == len(given) and all(map(_fits, kinds, given)):
                return kinds
        names = ", ".join(map(str, given))
        raise TypeError(f"{self.py_func.__qualname__} is not compiled for ({names})")

    def lower(self, context, builder, sig, arguments):
        """Lower a call: load the address from the cell, and call what is there by numba's own
        convention."""
        symbol = self.cells[sig.args].symbol
        kind = context.call_conv.get_function_type(sig.return_type, sig.args).as_pointer()
        cell = builder.module.globals.get(symbol) or ir.GlobalVariable(builder.module, kind, symbol)
        return _call(context, builder, builder.load(cell), sig.return_type, sig.args, arguments)

    def __call__(self, *arguments):
        """From Python, as a test calls it."""
        if not hasattr(self, "_caller"):
            unit = self
            self._caller = njit(lambda *given: unit(*given))
        with compiling_units():
            return self._caller(*arguments)


def _template_of(unit):
    class Template(AbstractTemplate):
        key = unit

        def generic(self, args, kws):
            return signature(unit.returns, *unit.kinds_for(args))

    return Template


def _fits(kind, given):
    """Whether an argument can be passed as a parameter of a type; numbers are converted."""
    given = types.unliteral(given)
    if isinstance(kind, (types.Integer, types.Boolean)):
        return isinstance(given, (types.Integer, types.Boolean))
    if isinstance(kind, types.Float):
        return isinstance(given, types.Number)
    return given == kind


class Cell:
    """Where the address of the machine code of a unit stands: at first that of a way to Python,
    which compiles it."""

    def __init__(self, unit, kinds, number):
        self.unit = unit
        self.kinds = kinds
        self.full = False
        name = f"{unit.py_func.__module__}.{unit.py_func.__qualname__}"
        self.symbol = f"unit_{name}_{number}".replace(".", "_")
        self.way_to_python = self._way_to_python()  # kept: its machine code lives as long
        self.address = ctypes.cast(self.way_to_python, ctypes.c_void_p)
        self.place = ctypes.addressof(self.address)
        llvm.add_symbol(self.symbol, self.place)

    def fill(self):
        """Load or compile the machine code, and put its address into the cell; whether it was
        compiled just now."""
        if self.full:
            return False
        dispatcher = self.unit.dispatcher
        returns = self.unit.returns
        dispatcher.compile(self.kinds)
        found = dispatcher.overloads[self.kinds]
        if found.signature.return_type != returns:
            given = f"{found.signature.return_type}, not {returns}"
            raise TypeError(f"{self.unit.py_func.__qualname__} returns {given}")
        name = found.fndesc.llvm_func_name
        self.address.value = found.library.get_pointer_to_function(name)
        self.full = True
        return self.kinds in dispatcher.stats.cache_misses

    def _way_to_python(self):
        """A function of C's that fills the cell, and goes on to what is there then."""

        def compile_and_call(*arguments):
            self.fill()
            return type(self.way_to_python)(self.address.value)(*arguments)

        return _code(self.unit.returns, self.kinds, compile_and_call)


@intrinsic
def call_flight(typing, cell, own, state, const, force):
    """Call the unit of a part (`parts.Part`) that acts as the projectile flies on."""
    return _call_through(types.none, state, const, types.float64)


@intrinsic
def call_forces(typing, cell, own, state, const, first, last, acting):
    """Call the unit of a part that acts with the forces of its ply; the energy that it returns."""
    return _call_through(types.float64, state, const, types.int64, types.int64, types.int64)


@intrinsic
def call_phase(typing, cell, own, state, const):
    """Call the unit of a part that meets the nose, or acts when all have moved."""
    return _call_through(types.none, state, const)


def _call_through(returns, state, const, *others):
    """Signature and code of a call of the unit that a cell leads to, given by its address, with the
    row at the address `own`."""
    kinds = state, const, types.voidptr, *others

    def codegen(context, builder, sig, arguments):
        kind = context.call_conv.get_function_type(returns, kinds).as_pointer()
        unit = builder.load(builder.inttoptr(arguments[0], kind.as_pointer()))
        own = builder.inttoptr(arguments[1], context.get_value_type(types.voidptr))
        given = [*arguments[2:4], own, *arguments[4:]]
        return _call(context, builder, unit, returns, kinds, given)

    return returns(types.int64, types.int64, state, const, *others), codegen


class PythonCell:
    """A cell that leads to a Python function without parameters, in place of a unit that
    `call_phase` calls.

    state, const : numba types of the rows that it is called with
    """

    def __init__(self, function: Callable[[], object], state: Any, const: Any) -> None:
        def call(*arguments):
            function()
            return 0

        self._code = _code(types.none, (state, const, types.voidptr), call)
        self.address = ctypes.cast(self._code, ctypes.c_void_p)
        self.place = ctypes.addressof(self.address)


def _call(context, builder, unit, returns, kinds, arguments):
    """Call machine code by numba's own convention; an exception goes on to the caller."""
    convention = context.call_conv
    status, found = convention.call_function(builder, unit, returns, kinds, arguments)
    with builder.if_then(status.is_error, likely=False):
        convention.return_status_propagate(builder, status)
    return found


def _code(returns, kinds, function):
    """A function of C's that calls one of Python's, by numba's convention; what that raises is
    kept."""
    kind = cpu_target.target_context.call_conv.get_function_type(returns, kinds)

    def call(*arguments):
        try:
            return function(*arguments)
        except BaseException as problem:
            _raised.append(problem)
            return FAILED

    return ctypes.CFUNCTYPE(ctypes.c_int32, *map(_c_type, kind.args))(call)


def _c_type(kind):
    """What ctypes calls an LLVM type."""
    if isinstance(kind, ir.PointerType):
        return ctypes.c_void_p
    if isinstance(kind, ir.IntType):
        return C_TYPES[kind.width]
    if isinstance(kind, ir.FloatType):
        return ctypes.c_float
    return ctypes.c_double
