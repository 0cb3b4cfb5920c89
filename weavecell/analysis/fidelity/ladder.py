"""The ladders of models that scenes can be answered with, one of single plies and one of packs: from the cheapest to
the one that all others are held against.

Meshes are named by elements a crossover, along each side. "graded" has one of them about the impact point alone,
"graded, 1/3" three, and longer ones further away; "near" has the smallest fine region, and "long" elements of 4
crossovers at the edge. All but the full model have a table of the cell of 51 stretches a side, where filling one of 201
costs more than a short run, and look at their energies every 20 us, since an audit goes over the whole panel. What that
changes is in their errors.
"""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass, replace
from math import ceil, inf
from typing import TYPE_CHECKING, Any

from fabrics.errors import InputError
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.model import SYMMETRIES, Panel

if TYPE_CHECKING:
    from shellfabric.cell.model import CellTable

FULL = "3 elements, table 201"
PACK_DEFAULT, PACK_FULL = "default mesh of packs", "finer mesh of packs, table 201"


@dataclass(frozen=True)
class Model:
    """One way to run an impact.

    Parameters
    ----------
    name : in words
    changes : ((field of ImpactSetup, value), ...)
    answers : whether it may be chosen, or serves as a scout alone
    near : times the elements per crossover near the impact point of the default mesh of packs; None of other meshes
    """

    name: str
    changes: tuple
    answers: bool = True
    near: float | None = None

    @property
    def coarse(self) -> bool:
        """Whether its elements are crossovers, or more, everywhere."""
        return dict(self.changes).get("elements_per_crossover") == 1 and not self.refined

    @property
    def refined(self) -> bool:
        """Whether it has elements shorter than a crossover about the impact point alone."""
        return any(side < 1 for _, side in dict(self.changes).get("grading", ()))

    @property
    def full(self) -> bool:
        """Whether it is the model that all others of its ladder are held against."""
        return self.name in (FULL, PACK_FULL)

    def of(self, setup: ImpactSetup) -> ImpactSetup:
        """The set-up as this model runs it.

        Raises
        ------
        InputError : with `near`, as `ImpactSetup.meshed`
        """
        this = replace(setup, **dict(self.changes))
        if self.near is None:
            return this
        this = replace(this, elements_per_crossover=None, grading=None).meshed
        if this.grading is None:
            return replace(this, elements_per_crossover=ceil(self.near * this.resolved_elements_per_crossover))
        (until, side), *rest = this.grading
        return replace(this, grading=((until, 1 / ceil(self.near / side - 1e-9)), *rest))

    def panel(self, setup: ImpactSetup, table: CellTable) -> Panel | None:
        """The panel, of a pack the first ply, as this model meshes it; None where it cannot be: longer elements begin
        beyond the shot."""
        try:
            return self.of(setup).panel(table)
        except InputError:
            return None

    def leaves(self, setup: ImpactSetup, fixed: Container[str]) -> bool:
        """Whether the model leaves those fields as they are that the user has set by hand."""
        if self.refined and "elements_per_crossover" in fixed:
            return False
        if self.near is not None and any(key in fixed for key in ("elements_per_crossover", "grading")):
            return False
        return all(getattr(setup, key) == value for key, value in self.changes if key in fixed)


def ladder_of(setup: ImpactSetup) -> tuple[Model, ...]:
    """The models that a set-up can be answered with, the full model last."""
    return LADDER if setup.plies == 1 else PACK_LADDER


def _about_the_nose(n):
    """Sides of 1/n crossover up to 12 crossovers from the impact point, of 1 up to 24, then of 2."""
    return (12, 1 / n), (24, 1), (inf, 2)


def _near_the_nose(n):
    """Sides of 1/n crossover up to 8 crossovers from the impact point, of 1 up to 16, of 2 up to 32, then of 4."""
    return (8, 1 / n), (16, 1), (32, 2), (inf, 4)


def _mesh(name, elements, *, answers=True, **changes):
    return Model(name, (("elements_per_crossover", elements), *changes.items()), answers)


SCOUT = "2 x 2 crossovers"
_QUICK: dict[str, Any] = {"table_size": 51, "audit_interval": 20e-6}
LADDER = (
    _mesh(SCOUT, 1, answers=False, grading=((inf, 2),), **_QUICK),
    _mesh("graded", 1, grading=((16, 1), (32, 2), (inf, 4)), **_QUICK),
    _mesh("1 element, decoupled", 1, answers=False, cell_model="decoupled", **_QUICK),
    _mesh("1 element", 1, **_QUICK),
    *(_mesh(f"graded, 1/{n}, near", 1, grading=_near_the_nose(n), **_QUICK) for n in (2, 3)),
    _mesh("graded, 1/2, long", 1, grading=((12, 1 / 2), (20, 1), (40, 2), (inf, 4)), **_QUICK),
    *(_mesh(f"graded, 1/{n}", 1, grading=_about_the_nose(n), **_QUICK) for n in (2, 3)),
    _mesh("2 elements", 2, **_QUICK),
    _mesh("3 elements", 3, **_QUICK),
    _mesh(FULL, 3, table_size=201),
)
# of packs, whose errors no coarser mesh foretells: the answer, and the mesh that it is held against
PACK_LADDER = (
    Model(PACK_DEFAULT, tuple(_QUICK.items()), answers=False, near=1.0),
    Model(PACK_FULL, (("table_size", 201),), near=1.5),
)
BY_NAME = {model.name: model for model in (*LADDER, *PACK_LADDER)}
_SCOUTS = SCOUT, "graded", "1 element", PACK_DEFAULT


def scouts(known: Container[str]) -> tuple[Model, ...]:
    """The two cheapest meshes, coarser first, of those whose names are `known`, which tell how hard a scene is; of a
    pack its default mesh."""
    found = [BY_NAME[name] for name in _SCOUTS if name in known]
    return tuple(found[:2])


def partner(model: Model, two: tuple[Model, ...]) -> Model:
    """The scout that a model's answer is held against, and mixed with: of two, the next coarser mesh."""
    coarse, fine = two
    return coarse if model.coarse else fine


class Tables:
    """Tables of the cell, each filled once for all set-ups that share it."""

    _CELL = ("fabric", "laws", "surface", "gap", "cell_model", "form", "profile", "table_size")

    def __init__(self) -> None:
        self._known: list[Any] = []

    def of(self, setup: ImpactSetup) -> CellTable:
        """The CellTable of a set-up."""
        for known, table in self._known:
            if all(getattr(known, key) == getattr(setup, key) for key in self._CELL):
                return table
        self._known.append((setup, setup.table()))
        return self._known[-1][1]

    def cheap(self, setup: ImpactSetup) -> CellTable:
        """A table of the cell for panels that are looked at, not run: the one that the cheap models have."""
        return self.of(replace(setup, table_size=_QUICK["table_size"]))


def simplest(setup: ImpactSetup, tables: Tables) -> ImpactSetup:
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


def effort(panel: Panel, end_time: float) -> float:
    """Elements times steps of a run that goes on to `end_time` [s]."""
    return panel.elements * end_time / panel.time_step
