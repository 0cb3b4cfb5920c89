"""The ladder of models that a scene can be answered with, from the cheapest to the one that all are held against.

Meshes are named by elements a crossover, along each side. All but the full model have a table of the cell of 51
stretches a side, where filling one of 201 costs more than a short run, and look at their energies every 20 us: an
audit goes over the whole panel, and every 2 us costs more than the steps between. What that changes is in their errors.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

from fabrics.errors import InputError
from shellfabric.panel.model import SYMMETRIES, Panel

FULL = "3 elements, table 201"


@dataclass(frozen=True)
class Model:
    """One way to run an impact.

    Parameters
    ----------
    name : in words
    changes : ((field of ImpactSetup, value), ...)
    answers : whether it may be chosen, or serves as a scout alone
    """

    name: str
    changes: tuple
    answers: bool = True

    @property
    def coarse(self):
        """Whether its elements are crossovers, or more."""
        return dict(self.changes).get("elements_per_crossover") == 1

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


def _mesh(name, elements, *, answers=True, **changes):
    return Model(name, (("elements_per_crossover", elements), *changes.items()), answers)


SCOUT = "2 x 2 crossovers"
_QUICK = {"table_size": 51, "audit_interval": 20e-6}
LADDER = (
    _mesh(SCOUT, 1, answers=False, grading=((inf, 2),), **_QUICK),
    _mesh("graded", 1, grading=((16, 1), (32, 2), (inf, 4)), **_QUICK),
    _mesh("1 element, decoupled", 1, answers=False, cell_model="decoupled", **_QUICK),
    _mesh("1 element", 1, **_QUICK),
    _mesh("2 elements", 2, **_QUICK),
    _mesh("3 elements", 3, **_QUICK),
    _mesh(FULL, 3, table_size=201),
)
BY_NAME = {model.name: model for model in LADDER}
_SCOUTS = SCOUT, "graded", "1 element"


def scouts(known):
    """The two cheapest meshes, coarser first, of those whose names are `known`: what tells how hard a scene is."""
    found = [BY_NAME[name] for name in _SCOUTS if name in known]
    return tuple(found[:2])


def partner(model, two):
    """The scout that a model's answer is held against, and mixed with: of two, the next coarser mesh."""
    coarse, fine = two
    return coarse if model.coarse else fine


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
        return self.of(replace(setup, table_size=_QUICK["table_size"]))


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
