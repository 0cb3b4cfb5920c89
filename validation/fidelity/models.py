"""The ladder of models that a scene can be answered with, from the cheapest to the one that all are held against.

Meshes are named by elements a crossover, along each side. The cell's table has 51 stretches a side on the cheap ones,
where filling one of 201 costs more than the run; what that changes is in their errors.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

from fabrics.errors import InputError
from shellfabric.panel import SYMMETRIES, Panel

FULL = "3 elements"


@dataclass(frozen=True)
class Model:
    """One way to run an impact.

    Parameters
    ----------
    name : in words
    changes : ((field of ImpactSetup, value), ...)
    check : name of the coarser model whose answer says how far off this one's may be; empty if there is none
    finer : name of the model that is next if this one does not do; empty for the finest
    answers : whether it may be chosen, or serves as a check alone
    """

    name: str
    changes: tuple
    check: str = ""
    finer: str = ""
    answers: bool = True

    def of(self, setup):
        """The set-up as this model runs it."""
        return replace(setup, **dict(self.changes))

    def panel(self, setup, table):
        """The panel as this model meshes it, or None where it cannot be: longer elements begin beyond the shot."""
        try:
            return self.of(setup).panel(table)
        except InputError:
            return None

    def leaves(self, setup, fixed):
        """Whether the model leaves those fields as they are that the user has set by hand."""
        return all(getattr(setup, key) == value for key, value in self.changes if key in fixed)


def _mesh(name, elements, check="", finer="", *, answers=True, **changes):
    return Model(name, (("elements_per_crossover", elements), *changes.items()), check, finer, answers)


_COARSE, _PLAIN, _TABLE = "2 x 2 crossovers", "1 element", {"table_size": 51}
LADDER = (
    _mesh(_COARSE, 1, answers=False, grading=((inf, 2),), **_TABLE),
    _mesh("graded", 1, _COARSE, _PLAIN, grading=((16, 1), (32, 2), (inf, 4)), **_TABLE),
    _mesh("1 element, decoupled", 1, _COARSE, _PLAIN, cell_model="decoupled", **_TABLE),
    _mesh(_PLAIN, 1, _COARSE, "2 elements", **_TABLE),
    _mesh("2 elements", 2, _PLAIN, FULL),
    _mesh(FULL, 3, "2 elements"),
)
BY_NAME = {model.name: model for model in LADDER}


class Tables:
    """Tables of the cell, each filled once for all set-ups that share it."""

    _CELL = ("fabric", "laws", "surface", "gap", "cell_model", "form", "profile", "table_size")

    def __init__(self):
        self._known = []

    def of(self, setup):
        """The CellTable of a set-up."""
        for known, table in self._known:
            if all(getattr(known, key) == getattr(setup, key) for key in self._CELL):
                return table
        self._known.append((setup, setup.table()))
        return self._known[-1][1]

    def cheap(self, setup):
        """A table of the cell for panels that are looked at, not run: the one that the cheap models have."""
        return self.of(replace(setup, **_TABLE))


def simplest(setup, tables):
    """The set-up with the smallest part of the panel that shot, edges and weave let stand for all of it.

    Raises
    ------
    InputError : a set-up that is wrong with any symmetry
    """
    for symmetry in SYMMETRIES:
        found = replace(setup, symmetry=symmetry)
        try:
            found.panel(tables.cheap(setup))
        except InputError:
            if symmetry == "whole":
                raise
        else:
            return found
    raise AssertionError("a whole panel has no symmetry to refuse")


def effort(panel: Panel, end_time):
    """Elements times steps of a run that goes on to `end_time` [s]."""
    return panel.elements * end_time / panel.time_step
