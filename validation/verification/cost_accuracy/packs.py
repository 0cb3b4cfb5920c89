"""Impacts on packs of plies: cases, their runs, and what is read off."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from shellfabric.panel.model import Numerics
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.solver.pack_solver import PackSolver
from validation.verification.cost_accuracy import shots
from validation.verification.cost_accuracy.core import Method

if TYPE_CHECKING:
    from validation.verification.cost_accuracy.shots import Shot


@dataclass(frozen=True)
class Plies:
    """A shot at a pack.

    Parameters
    ----------
    shell : shots.Shell, of each ply, with the shot
    plies : their number
    gap : [m], or None for the fabric's own
    stiffness, points, form : of the contact between plies, see `PlyContact`
    """

    shell: shots.Shell
    plies: int = 4
    gap: float | None = None
    stiffness: float = PlyContact.stiffness
    points: int = PlyContact.points
    form: str = PlyContact.form


def run(case: Any) -> tuple[dict[str, float], dict[str, float]]:
    """({quantity: value}, {part: CPU time [s]}).

    Raises
    ------
    UnstableError : a shot that becomes unphysical, or has not the outcome of its scene
    """
    begun = time.process_time()
    ply = shots.panel(case.shell)
    contact = PlyContact(stiffness=case.stiffness, points=case.points, form=case.form)
    pack = Pack.stacked(ply, case.plies, gap=case.gap, contact=contact)
    found: dict[str, Any] = {}
    filled, shot = time.process_time(), case.shell.shot
    yarns = max(1, round(1 / case.shell.elements))  # a thick yarn stands for so many
    for velocity in shot.velocities:
        march = PackSolver(pack, velocity, shot.end)
        if case.shell.awake:
            _wake(march)
        march.run()
        fine = np.concatenate(march.step_history)
        peak = march.peak_tensions[..., 0].max(axis=0) / yarns
        found |= shots.read_off(
            shot, velocity, march.outcome, fine[:, 0], fine[:, 1], march.const.dt, ply.projectile.mass, peak
        )
    return found, {"table": filled - begun, "march": time.process_time() - filled}


def _wake(march):
    march.stack.awake[:] = True
    for state, const in zip(march.states, march.consts):
        state.active_rows[:] = 0, const.ni


def warm(case: Any) -> Any:
    """A short run that compiles what a case needs."""
    return replace(case, shell=shots.warm(case.shell), plies=2, gap=1e-4)


def methods(shot: Shot) -> tuple[Method, ...]:
    """All methods for a pack; the first is the default.

    Single precision is on the charts of one ply alone: for a pack it is another program, minutes to compile.
    """
    base = Plies(shots.Shell(shot))

    def one(choice, name, shell=None, **changes):
        return Method(choice, name, replace(base, shell=replace(base.shell, **(shell or {})), **changes))

    return (
        one("default", "default"),
        one("default", "default of version 0.2", {"fill": "nested"}),
        one("cell", "decoupled", {"model": "decoupled"}),
        one("cell", "incompressible", {"model": "incompressible"}),
        one("cell", "printed law", {"law": "printed"}),
        one("cell", "equilibrium form", {"form": "equilibrium"}),
        *(one("table", f"table {n}", {"table": n}) for n in (26, 51)),
        one("elements", "1/2 element per crossover", {"elements": 0.5}),
        one("elements", "2 elements per crossover", {"elements": 2}),
        one("grading", "graded from 1/1 crossover", {"grading": ((12.0, 1.0), (24.0, 2.0), (inf, 4.0))}),
        one("grading", "graded from 1/2 crossover", {"grading": ((12.0, 0.5), (24.0, 1.0), (inf, 2.0))}),
        one("combined", "1/2, decoupled, table 26", {"elements": 0.5, "model": "decoupled", "table": 26}),
        one("time step", "steps x 0.5", {"cfl": 0.5 * Numerics.cfl}),
        one("activity", "all plies awake", {"awake": True}),
        one("contact", "contact: 1 point", points=1),
        one("contact", "contact: stiffness / 2", stiffness=0.5),
        one("contact", "contact: facets", form="facets"),
        one("contact", "contact: nodes", form="nodes"),
    )


def references(shot: shots.Shot, finest: tuple[float, ...]) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """(meshes, finer) for `core.Scene`: the meshes, and a finer table, time step and contact at the first of them."""
    base = Plies(shots.Shell(shot))

    def of(**changes):
        return replace(base, shell=replace(base.shell, **changes))

    meshes = tuple((1 / n, of(elements=n)) for n in finest)
    first = meshes[0][1]
    slower = replace(first, shell=replace(first.shell, cfl=0.5 * Numerics.cfl))
    return meshes, ((first, slower), (first, replace(first, points=4)))
