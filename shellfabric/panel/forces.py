"""Forces on a ply that plug into its step by one table: bending, packing, and what a Panel is
given.

A module is a unit, the name of the energy that it stores, and what it adds to the highest
frequency. All units have one signature, so that kernels call them through addresses
(`state.ModuleTable`): a new module compiles its own file and nothing else.

    @unit("number", own=Springs)
    def springs(state, const, own, first, last, acting):

returns the energy [J] stored at the node rows first .. last, and adds its forces to state.f_int
where `acting`. `own` is a row of a table of the module's own, of whose arrays a checkpoint has what
is kept.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from shellfabric.cloth.bending_kernels import bending_forces
from shellfabric.cloth.packing_kernels import packing_forces
from shellfabric.jit.compile import Unit
from shellfabric.jit.table import Row
from shellfabric.state import ModuleTable


@dataclass(frozen=True)
class Module:
    """A force on a ply besides those of membrane, nose and other plies.

    Parameters
    ----------
    energy : name of what its unit returns, among the energies of a run
    act : its unit; None where it does not act
    own : its row, or None
    stiffness : [1/s2] bound of its stiffness over the mass of a node, a quarter of the square of
        the highest frequency, which bounds the time step
    nose : a unit that is called in place of the membrane's contact with the nose, or None
    books : a function that returns further energies {name: [J]} of its row, or None; those of a
        ply are added to
    """

    energy: str
    act: Unit | None
    own: Row | None = None
    stiffness: float = 0.0
    nose: Unit | None = None
    books: Callable[[Any], dict[str, float]] | None = None


def bending(panel: Any) -> Module:
    """Yarns that resist bending.

    A yarn that turns to and fro at every node has the energy 1/2 n EI / L (4 w / L)^2 a node.
    """
    mass = panel.weave.areal_density
    spacing = panel.spacing
    parts = zip(panel.yarns_a_line, panel.bending, spacing, spacing[::-1])
    stiffness = sum(4 * n * EI / (mass * d**4 * across) for n, EI, d, across in parts)
    acts = None
    if any(panel.bending):
        acts = bending_forces
    return Module("bending", acts, stiffness=stiffness)


def packing(panel: Any) -> Module:
    """Yarns that lie side by side: no stiffer than the membrane, whose bound holds for it."""
    return Module("packing", packing_forces)


USUAL = bending, packing  # of every panel


def make_modules(panel: Any) -> tuple[Module, ...]:
    """The modules of a panel, each with a row of its own."""
    return tuple(make(panel) for make in (*USUAL, *panel.modules))


def make_table(modules: Iterable[Module], graded: bool) -> ModuleTable:
    """What the kernels of a uniform or a graded panel take of modules; in another process a copy
    has the addresses of that process."""
    listed = tuple(modules)
    cells = np.zeros(len(listed), np.int64)
    rows = np.zeros(len(listed), np.int64)
    nose = np.zeros(2, np.int64)
    for m, module in enumerate(listed):
        if module.act:
            cells[m] = module.act.cell(int(graded)).place
        if module.own:
            rows[m] = module.own._address
        if module.nose:
            nose[0] = module.nose.cell(int(graded)).place
            nose[1] = rows[m]
    found = ModuleTable(cell=cells, own=rows, behind=np.zeros(1, np.int64), nose=nose)
    found.__dict__["_remake"] = make_table, (listed, graded)
    return found


def modules_of(found: ModuleTable) -> tuple[Module, ...]:
    """The modules of which a table was made."""
    modules: tuple[Module, ...] = found._remake[1][0]
    return modules
