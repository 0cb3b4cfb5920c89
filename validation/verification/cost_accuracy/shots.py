"""Impacts on one ply, and on packs, with all options of the explicit code: cases, their runs, and what is read off."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from fabrics.errors import UnstableError
from fabrics.units import si
from shellfabric.cell.model import CellModel
from shellfabric.panel.model import Numerics, Panel
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.solver.pack_solver import PackSolver
from validation.models import variants as comparison
from validation.models.cable import solver as cable_solver
from validation.models.cable.model import CableNet, CableNumerics

LEFT, STOPS = "perforated", "stopped"


@dataclass(frozen=True)
class Shot:
    """A scene: fabric, opening [m], strike velocities [m/s], end [s], how it ends, and an instant to look at [s]."""

    fabric: str
    opening: float
    velocities: tuple
    end: float
    outcome: str
    early: float | None = None


@dataclass(frozen=True)
class Shell:
    """A shot at the explicit shell.

    Parameters
    ----------
    shot : Shot
    elements : a crossover, along each side; below 1: an element of so many crossovers
    model, form, law : of the cell (`CellModel`), and of compression: "regularised" or "printed"
    table : stretches along each side of the cell's table
    cfl, viscosity : see `Numerics`
    symmetry : "quarter", "half" or "whole"
    awake : whether all rows are worked on from the start
    grading : of the panel, see `Panel`, or None
    """

    shot: Shot
    elements: float = 1
    model: str = "compressible"
    form: str = "variational"
    law: str = "regularised"
    table: int = 201
    cfl: float = Numerics.cfl
    viscosity: float = Numerics.stretch_viscosity
    symmetry: str = "quarter"
    awake: bool = False
    grading: tuple[tuple[float, float], ...] | None = None

    def changed(
        self, *, cable: float = 0, time_step: float = 0, grading: Sequence[float] = (), **changes: Any
    ) -> Shell | Cable:
        """With other options; `time_step` is a factor, `cable` one on that of the cable net in place of the shell.

        grading : elements in the first crossover, sides of those in the second zone and beyond [crossovers]
        """
        if cable:
            return Cable(self.shot, cfl=cable * CableNumerics.cfl)
        if time_step:
            changes["cfl"] = time_step * Numerics.cfl
        if grading:
            n, middle, outer = grading
            changes["grading"] = ((12.0, 1 / n), (24.0, middle), (inf, outer))
        return replace(self, **changes)


@dataclass(frozen=True)
class Cable:
    """A shot at the pin-jointed cable net, with its own share of the time step's bound."""

    shot: Shot
    cfl: float = CableNumerics.cfl
    symmetry: str = "quarter"


@dataclass(frozen=True)
class Plies:
    """A shot at a pack.

    Parameters
    ----------
    shell : of each ply, with the shot
    plies : their number
    gap : [m], or None for the fabric's own
    stiffness, points, form : of the contact between plies, see `PlyContact`
    """

    shell: Shell
    plies: int = 4
    gap: float | None = None
    stiffness: float = PlyContact.stiffness
    points: int = PlyContact.points
    form: str = PlyContact.form

    def changed(
        self, *, points: int | None = None, stiffness: float | None = None, contact_form: str = "", **of_shell: Any
    ) -> Plies:
        """With other options of the contact or, as of `Shell.changed`, of the plies."""
        given = {"points": points, "stiffness": stiffness, "form": contact_form or None}
        contact: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
        shell: Any = self.shell.changed(**of_shell)
        return replace(self, shell=shell, **contact)


def read(case: dict[str, Any]) -> Shell | Plies:
    """The default case of a scene of scenes.toml."""
    early = si(case["early"], "s", key="early") if "early" in case else None
    shot = Shot(
        case["fabric"], si(case["opening"], "m", key="opening"),
        tuple(si(v, "m/s", key="velocities") for v in case["velocities"]), si(case["end"], "s", key="end"),
        STOPS if early else LEFT, early,
    )  # fmt: skip
    return Plies(Shell(shot), case["plies"]) if "plies" in case else Shell(shot)


def run(case: Shell | Cable | Plies) -> tuple[dict[str, float], dict[str, float]]:
    """({quantity: value}, {part: CPU time [s]}) of a case.

    Raises
    ------
    UnstableError : a shot that becomes unphysical, or has not the outcome of its scene
    """
    return {Shell: _shell, Cable: _cable, Plies: _pack}[type(case)](case)


def panel(case: Shell) -> Panel:
    """The panel of a case; fills the table of its cell."""
    fabric = catalogue.load(case.shot.fabric).with_effective_density()
    fabric = comparison.with_law_form(fabric, case.law)
    if case.elements < 1:
        fabric = comparison.homogenised(fabric, round(1 / case.elements))
    numerics = Numerics(
        cfl=case.cfl, stretch_viscosity=case.viscosity, threads=1,
        contact_points=8 if case.elements < 1 else None,  # coarse models are to be cheap ones
    )  # fmt: skip
    return Panel(
        CellModel(fabric, model=case.model, form=case.form).table(case.table),
        (case.shot.opening, case.shot.opening), symmetry=case.symmetry,
        elements_per_crossover=max(1, int(case.elements)), numerics=numerics,
        grading=case.grading,
    )  # fmt: skip


def _shell(case):
    begun = time.process_time()
    made = panel(case)
    filled = time.process_time()
    found, yarns = {}, max(1, round(1 / case.elements))  # a thick yarn stands for so many
    for velocity in case.shot.velocities:
        march = PackSolver(made, velocity, case.shot.end)
        if case.awake:
            march.state.active_rows[:] = 0, march.const.ni
        march.run()
        fine = np.concatenate(march.step_history)
        peak = [float(tension) / yarns for tension in march.state.peak_tension]
        found |= read_off(
            case.shot, velocity, march.outcome, fine[:, 0], fine[:, 1], march.const.dt, made.projectile.mass, peak
        )
    return found, {"table": filled - begun, "march": time.process_time() - filled}


def _cable(case):
    begun = time.process_time()
    fabric, side = catalogue.load(case.shot.fabric).with_effective_density(), case.shot.opening
    net = CableNet(fabric, (side, side), symmetry=case.symmetry, numerics=CableNumerics(cfl=case.cfl))
    found = {}
    for velocity in case.shot.velocities:
        result = cable_solver.run(net, velocity, case.shot.end)
        t, z, v, _ = result.step_history.T
        found |= read_off(case.shot, velocity, result.outcome, z, v, t[0], net.projectile.mass, result.peak_tension)
    return found, {"table": 0.0, "march": time.process_time() - begun}


def _pack(case):
    begun = time.process_time()
    ply = panel(case.shell)
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
        found |= read_off(
            shot, velocity, march.outcome, fine[:, 0], fine[:, 1], march.const.dt, ply.projectile.mass, peak
        )
    return found, {"table": filled - begun, "march": time.process_time() - filled}


def _wake(march):
    march.stack.awake[:] = True
    for state, const in zip(march.states, march.consts):
        state.active_rows[:] = 0, const.ni


def read_off(
    shot: Shot, velocity: float, outcome: str, z: FloatArray, v: FloatArray, dt: float, mass: float,
    peak: Sequence[float],
) -> dict[str, float]:  # fmt: skip
    """Quantities of a shot from the projectile's place [m] and velocity [m/s] after each step."""
    if shot.outcome == "":
        return {}
    if shot.outcome != outcome:
        raise UnstableError(f"the shot at {velocity:g} m/s ends {outcome}, not {shot.outcome}")
    energy = 0.5 * mass * velocity**2
    if shot.outcome == LEFT:
        absorbed = energy - 0.5 * mass * float(v[-1]) ** 2
        return {f"residual velocity at {velocity:g} m/s": float(v[-1]), f"energy at {velocity:g} m/s": absorbed}
    early = float(np.interp(shot.early, dt * (np.arange(len(v)) + 0.5), v))  # velocities stand at half steps
    return {
        "stop time": dt * len(v),
        "deflection": float(z.max()),
        "energy absorbed early": energy - 0.5 * mass * early**2,
        "warp tension": float(peak[0]),
        "weft tension": float(peak[1]),
    }


def warm(case: Any) -> Any:
    """A short run that compiles what a case needs."""
    if isinstance(case, Plies):
        return replace(case, shell=warm(case.shell), plies=2, gap=1e-4)
    short = replace(case.shot, velocities=case.shot.velocities[:1], end=1e-6, outcome="")
    if isinstance(case, Cable):
        return Cable(short)
    return Shell(short, table=8, form=case.form, grading=case.grading)
