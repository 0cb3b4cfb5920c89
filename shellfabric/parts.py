"""What joins a run besides membrane, nose and other plies: one plug for all of it. Yarns that bend or lie
packed, resolved yarns, a block, a projectile that deforms, and whatever force a Panel is given: each is
a `Part` with units for the phases of a step in which it acts. `own` is its row:

    flight(state, const, own, force)                   as the projectile flies on
    forces(state, const, own, first, last, acting)     with the forces of its ply
    nose(state, const, own)                            in place of the membrane's contact with the nose
    after(state, const, own)                           when all have moved

All units of a phase have one signature, so that kernels call them through addresses (`state.PartTable`):
a new part compiles its own file and nothing else.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from math import ceil
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.jit.compile import PythonCell, Unit
from shellfabric.jit.table import Row
from shellfabric.state import Constants, PartTable, State

ROUNDING = 1e-9  # share by which a step may pass its bound


class Part:
    """A body or a force that joins the steps of a run. What a part does not have stays as it is
    here.

    `flight` takes the force [N] on the projectile along its axis, sets state.projectile_velocity,
    and keeps `motion`. `forces` returns the energy [J] that is stored at the node rows first ..
    last, and adds its forces to state.f_int if acting. `nose` sets state.f_contact_nose. `after`
    may add to state.f_int: nodes take it up in the next step. A part that needs shorter steps than
    the run makes several in one of its units (`subcycle_kernels.subcycle`).

    Attributes
    ----------
    name : for checkpoints, and by which a solver finds it
    numbers : of the panel (`PanelNumbers`) that bring it about: a part of `membrane.forces` with such
        numbers is made where one of them is not at its default
    energy : name, among the energies of a run, of what `forces` returns
    of_ply : whether its energies are its ply's; else they stand beside those of the plies
    ply : number of the ply in whose step a part that is not of a ply acts; -1 is the last
    row : its arrays and numbers, of which a checkpoint keeps what the table says
    stiffness : [1/s2] bound of its stiffness over the mass of a node, a quarter of the square of
        the highest frequency, which bounds the time step
    flight, forces, nose, after : its units; None where it does not act
    steps_in_python : whether its phase `after` is the method `step`
    goes_on : whether it may go on alone once the rest has left it (`has_left`); one part of a run
    meets_nose : whether it meets the projectile by itself: a run with it goes on though no held
        fabric is left ahead of the nose
    motion : (6,) of a body of the projectile, as `Stack.motion`
    contacts : {energy: name in messages} of its contacts, which can store and lose energy but not
        give any
    nose_of_block : of a body of the projectile whose shape changes, the Nose that a block behind the
        plies meets
    """

    name: str = ""
    numbers: tuple[str, ...] = ()
    energy: str = ""
    of_ply: bool = True
    ply: int = 0
    row: Any = None
    stiffness: float = 0.0
    flight: Unit | None = None
    forces: Unit | None = None
    nose: Unit | None = None
    after: Unit | None = None
    steps_in_python: bool = False
    goes_on: bool = False
    meets_nose: bool = False
    motion: FloatArray | None = None
    contacts: Mapping[str, str] = {}
    nose_of_block: Any = None

    def cut(self, state: State) -> None:
        """Take out of a state at rest what the part stands in for."""

    def seen(self, const: Constants, ply: int) -> Constants:
        """Return the constants of a ply with what it sees of the part."""
        return const

    def join(self, parts: Iterable[Part]) -> None:
        """Find what the part needs of the other parts of its run, once all are made."""

    def begin(self, state: State, const: Constants, stack: Any) -> None:
        """Do what comes before the first step, once the time step and the forces at rest are known:
        the number of own steps, such as `own_steps` finds it."""

    def step(self, state: State) -> None:
        """Act when all have moved, if `steps_in_python`."""
        raise NotImplementedError

    def has_left(self, state: State) -> bool:
        """Tell at a sample whether the rest of the run acts on the part no more, so that it goes on
        alone (`go_on`) and the rest stays as it is."""
        return False

    def go_on(self, duration: float) -> float:
        """Go on alone by about `duration` [s]; return by how much."""
        raise NotImplementedError

    def rows(self) -> dict[str, Row]:
        """Return {name: row} of the rows that a checkpoint keeps."""
        if self.row is None:
            return {}
        return {"row": self.row}

    def identity(self) -> tuple[Any, ...]:
        """Return what determines the part besides the constants of its ply: values, no
        addresses."""
        return self.name, self.stiffness

    def energies(self) -> dict[str, float]:
        """Return {name: [J]} of its energies besides that of `forces`; those of a name that its ply
        or the run has are added to it."""
        return {}

    def energy_made(self) -> dict[str, float]:
        """Return {place, in words: [J]} of what the part has made or lost by the books of its own,
        for the message of a run that does not keep its energy."""
        return {}

    def pushed(self, state: State) -> float:
        """Return the kinetic energy [J] at the present whole step that `energies` leaves out: that of
        what others push the part by, through nodes of a state which it places; the contact forces of
        the state are those of all that touches the ply."""
        return 0.0

    def samples(self) -> dict[str, float]:
        """Return {name: value} of what a sample has of the part besides energies."""
        return {}

    def show(self, state: State) -> None:
        """Write into a state what pictures and histories are to show of the part."""

    def speeds(self, strike_velocity: float) -> tuple[FloatArray, float] | None:
        """Return the speeds (n,) [m/s] of its nodes and the highest that a run goes on with."""
        return None

    def where(self, node: int) -> str:
        """Return text that says where one of these nodes is."""
        return f"node {int(node)} of {self.name}"

    def guard(self, state: State) -> tuple[str, str] | None:
        """Return what is wrong with the part after a sample, and where; None if all is well."""
        return None

    def indicators(self) -> tuple[Any, ...]:
        """Return the quality indicators (`membrane.indicator.Indicator`) of the part."""
        return ()

    def result(self, clock: FloatArray, steps: FloatArray) -> dict[str, Any]:
        """Return {field of the result of a shot: value}, from times (n,) [s] and the history of
        steps (n, columns)."""
        return {}


def own_steps(dt: float, longest: float) -> int:
    """Return the number of equal steps in one of `dt` [s] of the run, none above `longest` [s]."""
    return max(1, ceil(dt / longest * (1 - ROUNDING)))


def make_table(parts: Iterable[Part], graded: bool, state: State | None = None) -> PartTable:
    """Make what the kernels of a uniform or a graded panel take of parts.

    In another process a copy has the addresses of that process.

    Parameters
    ----------
    state : which parts step that do so in Python; they wait for a table that is made with one. It
        shares its arrays with the state that gets the table

    Raises
    ------
    ValueError : two parts would stand in for the membrane under the nose
    """
    listed = tuple(parts)
    grid = int(graded)
    found = {name: np.zeros(len(listed), np.int64) for name in (*PHASES, "own")}
    python_cells = []
    for number, part in enumerate(listed):
        for phase in PHASES:
            unit = getattr(part, phase)
            if unit is not None:
                found[phase][number] = unit.cell(grid).place
        if part.row is not None:
            found["own"][number] = part.row._address
        if part.steps_in_python and state is not None:
            cell = PythonCell(partial(part.step, state), State.types[grid], Constants.types[grid])
            python_cells.append(cell)
            found["after"][number] = cell.place
    at_nose = np.count_nonzero(found["nose"])
    if at_nose > 1:
        raise ValueError(f"{at_nose} parts are to stand in for the membrane under the nose")
    table = PartTable(**found, replaces_membrane=bool(at_nose))
    table.__dict__["_remake"] = make_table, (listed, graded)
    table.__dict__["_python_cells"] = python_cells  # kept alive: kernels have their addresses
    return table


PHASES = ("flight", "forces", "nose", "after")


def parts_of(table: PartTable) -> tuple[Part, ...]:
    """Return the parts of which a table was made."""
    parts: tuple[Part, ...] = table._remake[1][0]
    return parts
