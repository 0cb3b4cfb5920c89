"""Impacts on one ply with all options of the explicit code: cases, their runs, and what is read off."""

from __future__ import annotations

import time
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib import resources
from math import inf
from typing import Any

import numpy as np

from fabrics import catalogue, variants
from fabrics.checks import FloatArray
from fabrics.errors import UnstableError
from fabrics.units import si
from shellfabric.cell.model import FILL, CellModel
from shellfabric.panel.model import Numerics, Panel
from shellfabric.solver.pack_solver import PackSolver
from validation.models.cable import solver as cable_solver
from validation.models.cable.model import CableNet, CableNumerics
from validation.verification.cost_accuracy.core import Method

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
    cfl, viscosity, precision : see `Numerics`
    symmetry : "quarter", "half" or "whole"
    awake : whether all rows are worked on from the start
    grading : of the panel, see `Panel`, or None
    fill : how the table is filled, see `CellTable.fill`
    """

    shot: Shot
    elements: float = 1
    model: str = "compressible"
    form: str = "variational"
    law: str = "regularised"
    table: int = 201
    cfl: float = Numerics.cfl
    viscosity: float = Numerics.stretch_viscosity
    precision: str = "double"
    symmetry: str = "quarter"
    awake: bool = False
    grading: tuple[tuple[float, float], ...] | None = None
    fill: str = FILL


@dataclass(frozen=True)
class Cable:
    """A shot at the pin-jointed cable net, with its own share of the time step's bound."""

    shot: Shot
    cfl: float = CableNumerics.cfl
    symmetry: str = "quarter"


def read(name: str) -> Shot:
    """The shot of a scene of scenes.toml."""
    content = tomllib.loads(
        (resources.files("validation.verification.cost_accuracy") / "scenes.toml").read_text("utf-8")
    )
    shot = content["ply"] | content[name]
    early = si(shot["early"], "s", key="early") if "early" in shot else None
    return Shot(
        shot["fabric"], si(shot["opening"], "m", key="opening"),
        tuple(si(v, "m/s", key="velocities") for v in shot["velocities"]), si(shot["end"], "s", key="end"),
        STOPS if "early" in shot else LEFT, early,
    )  # fmt: skip


def run(case: Shell | Cable) -> tuple[dict[str, float], dict[str, float]]:
    """({quantity: value}, {part: CPU time [s]}) of a Shell or Cable.

    Raises
    ------
    UnstableError : a shot that becomes unphysical, or has not the outcome of its scene
    """
    return (_shell if isinstance(case, Shell) else _cable)(case)


def panel(case: Shell) -> Panel:
    """The panel of a case; fills the table of its cell."""
    fabric = catalogue.load(case.shot.fabric).with_effective_density()
    fabric = variants.with_law_form(fabric, case.law)
    if case.elements < 1:
        fabric = variants.homogenised(fabric, round(1 / case.elements))
    numerics = Numerics(
        cfl=case.cfl, stretch_viscosity=case.viscosity, precision=case.precision, threads=1,
        contact_points=8 if case.elements < 1 else None,  # coarse models are to be cheap ones
    )  # fmt: skip
    return Panel(
        CellModel(fabric, model=case.model, form=case.form).table(case.table, case.fill),
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
    short = replace(case.shot, velocities=case.shot.velocities[:1], end=1e-6, outcome="")
    if isinstance(case, Cable):
        return Cable(short)
    return Shell(short, table=8, precision=case.precision, form=case.form, grading=case.grading, fill=case.fill)


def methods(shot: Shot, meshes: Sequence[float] = (2, 3)) -> tuple[Method, ...]:
    """All methods for a shot; the first is the default."""
    base = Shell(shot)

    def one(choice, name, **changes):
        return Method(choice, name, replace(base, **changes))

    return (
        one("default", "default"),
        one("default", "default of version 0.2", fill="nested"),
        Method("cell", "cable net", Cable(shot)),
        Method("time step", "cable net, steps x 2", Cable(shot, cfl=2 * CableNumerics.cfl)),
        one("cell", "decoupled", model="decoupled"),
        one("cell", "incompressible", model="incompressible"),
        one("cell", "printed law", law="printed"),
        one("cell", "equilibrium form", form="equilibrium"),
        one("cell", "equilibrium, printed", form="equilibrium", law="printed"),
        *(one("table", f"table {n}", table=n) for n in (26, 51, 101, 401)),
        *(
            one("elements", f"{label} per crossover, table {n}", elements=e, table=n)
            for label, e in (("1/2 element", 0.5), *((f"{m} elements", m) for m in meshes))
            for n in (51, 201)
        ),
        one("combined", "decoupled, 1/2, table 26", model="decoupled", elements=0.5, table=26),
        one("combined", "1/2 element per crossover, table 26", elements=0.5, table=26),
        one("combined", "equilibrium, table 51", form="equilibrium", table=51),
        one("combined", "float32, table 51", precision="single", table=51),
        *(
            one(
                "grading",
                f"graded from 1/{n} crossover, table 51",
                table=51,
                grading=((12.0, 1 / n), (24.0, 1.0), (inf, 2.0)),
            )
            for n in (1, 2, 3, 4)
        ),
        *(one("time step", f"steps x {f:g}", cfl=f * Numerics.cfl) for f in (0.25, 0.5)),
        *(one("viscosity", f"viscosity {x:g}", viscosity=x) for x in (0.05, 0.2)),
        one("storage", "float32", precision="single"),
        one("symmetry", "half", symmetry="half"),
        one("symmetry", "whole", symmetry="whole"),
        one("activity", "all rows awake", awake=True),
    )


def references(shot: Shot, finest: tuple[int, ...]) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """(meshes, finer) for `core.Scene`: the meshes, and a finer table and time step at the first of them."""
    base = Shell(shot)
    meshes = tuple((1 / n, replace(base, elements=n)) for n in finest)
    first = replace(base, elements=finest[0])
    return meshes, ((first, replace(first, table=401)), (first, replace(first, cfl=0.5 * Numerics.cfl)))
