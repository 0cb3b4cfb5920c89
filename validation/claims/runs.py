"""The computations that checks share, each by name, from arguments that JSON can hold to a dict of numbers and arrays.

Fabrics are those of the thesis's shell runs (`Fabric.effective`, erratum E-07). All other settings are the defaults of
`shellfabric`: nothing is set to suit a claim.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import catalogue, variants
from fabrics.ply_law import PlyLaw
from shellfabric.cell.model import CellModel
from shellfabric.impact import ballistic_limit as limits
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.impact.simulation import run as run_impact
from shellfabric.output import snapshots as output_snapshots
from shellfabric.output.histories import HistoryRequest
from shellfabric.panel.boundary import PullIn
from shellfabric.panel.model import Numerics, Panel
from shellfabric.plies.gap import ply_gap
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.projectile import dynamics as bodies
from shellfabric.projectile.bar import Bar
from shellfabric.projectile.projectile import Projectile
from shellfabric.sliding.model import CrossoverFriction
from shellfabric.solver.pack_solver import PLY_SAMPLES, PackSolver
from validation.models import variants as comparison
from validation.models.cable import smith
from validation.models.cable.model import CableNet
from validation.models.cable.solver import run as run_cable
from validation.published.bias_extension import cases as bias_cases

if TYPE_CHECKING:
    from fabrics.fabric import Fabric
    from validation.claims.registry import RunResult

THESIS: dict[str, Any] = {"elements_per_crossover": 1}  # its mesh


def cloth(
    name: str, *, modulus: float = 1.0, crimp: float = 1.0, mass: float = 1.0, strain: float = 1.0,
    crimps: Sequence[float] | None = None, straight: bool = False, shear: dict[str, float] | None = None,
    denier: str = "effective",
) -> Fabric:  # fmt: skip
    """A fabric of the catalogue, changed.

    Parameters
    ----------
    modulus, crimp, strain : factors on fibre modulus, crimps and failure strain
    mass : factor on the areal density that leaves the stiffness of the yarns alone
    crimps : (warp, weft) [-] instead
    straight : yarns without crimp; the trellis keeps its stiffness per width
    shear : {"G1", "G2", "gamma1", "gamma2": values} that replace those of the fabric
    denier : "effective", the linear density that the thesis's tables imply (erratum E-07), or "nominal"
    """
    fabric = catalogue.load(name)
    if denier == "effective":
        fabric = fabric.with_effective_density()
    fabric = variants.scale_yarns(fabric, E=modulus, failure_strain=strain, crimp=crimp)
    fabric = variants.scale_areal_density(fabric, mass)
    if straight:
        fabric = comparison.with_straight_yarns(fabric)
    elif crimps:
        fabric = variants.with_yarns(fabric, crimp=crimps)
    return variants.with_shear(fabric, **shear) if shear else fabric


class _FirstFailures:
    """Hook: time [s] after which a warp and a weft segment have failed."""

    def __init__(self):
        self.times = [np.nan, np.nan]

    def __call__(self, march):
        for family, failed in enumerate(march.state.failed):
            if np.isnan(self.times[family]) and failed.any():
                self.times[family] = march.time


def setup(
    fabric: str, velocity: float, *, cell_model: str = "compressible", form: str | None = None,
    pull: dict[str, float] | None = None, symmetry: str = "quarter", end_time: float = 800e-6,
    offsets: Sequence[float] = (), snapshots: float | None = None, interval: float = 1e-6, elements: int = 1,
    bending: float = 0.0, body: str = "rigid", crossovers: float | None = None, **changes: Any,
) -> ImpactSetup:  # fmt: skip
    """ImpactSetup of a shot; the arguments are those of `shot`."""
    options: dict[str, Any] = {"form": form} if form else {}
    if pull:
        slipping = PullIn(pull["length"], pull["start"], pull["end"])
        options["edge"] = ("clamped", slipping)  # weft, as in section 6.4.3
    if crossovers is not None:
        options["crossovers"] = CrossoverFriction(crossovers)
    projectile = Projectile()
    if body == "bored":
        projectile = replace(projectile, body=projectile.steel_bar())
    return ImpactSetup(
        cloth(fabric, **changes),
        velocity,
        projectile=projectile,
        cell_model=cell_model,
        symmetry=symmetry,
        end_time=end_time,
        elements_per_crossover=elements,
        bending=bending,
        snapshot_interval=snapshots,
        history=HistoryRequest(interval, (0.0,), (0.0, *offsets)),
        **options,
    )


def shot(**scene: Any) -> RunResult:
    """One impact on one ply.

    Parameters
    ----------
    fabric, velocity [m/s] and the changes of `cloth`
    cell_model, form, symmetry, end_time, elements, bending : as in ImpactSetup; form None is its default
    body : of the projectile, "rigid" or "bored", the elastic-plastic bar of steel
    crossovers : coefficient of friction of crossovers that slide; None pins them
    pull : {"length" [m], "start", "end" [s]} of the weft edges
    offsets : [m] of further weft yarns to record at the edge
    snapshots, interval : [s]
    """
    chosen, hook = setup(**scene), _FirstFailures()
    result = run_impact(chosen, hooks=(hook,))
    (history,) = result.histories
    yarns = {
        yarn.family: {
            name: np.asarray(getattr(yarn, name)) for name in ("X", "tension", "place", "deflection", "strength")
        }
        for yarn in history.yarns
        if yarn is history.through(yarn.family)
    }
    weave, panel = chosen.fabric.weave, result.panel
    edge = sorted((abs(yarn.offset), yarn.tension[:, -1]) for yarn in history.yarns if yarn.family == "weft")
    return {
        "outcome": result.outcome,
        "residual": result.residual_velocity,
        "t": result.t,
        "v": result.v,
        "z": result.nose_position,
        "energies": result.energies,
        "reactions": result.reactions,
        "failed": result.cut_yarns,
        "peak": np.array(result.peak_tension),
        "strength": np.array([yarn.strength for yarn in weave.yarns]),
        "fine": result.step_history,
        "first_failure": np.array(hook.times),
        "steps": result.steps,
        "clock": history.t,
        "yarns": yarns,
        "edge_offset": np.array([place for place, _ in edge]),
        "edge_tension": np.array([tension for _, tension in edge]),
        "half": np.array([yarns[f]["X"][-1] for f in ("warp", "weft")]),
        "snapshots": [_shape(panel, taken) for (taken,) in result.snapshots],
        "eroded": int(result.last[0].failed[..., 2].sum()),
        "balance": result.energy_error_max,
    }


def _shape(panel, taken):
    """What is kept of a snapshot."""
    a = np.diff(taken.nodes, axis=0)
    b = np.diff(taken.nodes, axis=1)
    warp, weft = 0.5 * (a[:, :-1] + a[:, 1:]), 0.5 * (b[:-1] + b[1:])
    sine = np.einsum("ijk,ijk->ij", warp, weft) / (np.linalg.norm(warp, axis=2) * np.linalg.norm(weft, axis=2))
    return {
        "t": taken.t,
        "pyramid": np.array(output_snapshots.pyramid(panel, taken)),
        "gamma": np.abs(np.arcsin(sine)),
        "x": panel.coordinates()[0][:, 0],
        "y": panel.coordinates()[1][0],
        "z": taken.nodes[..., 2].astype(np.float32),
        "whole": ~taken.failed.any(axis=2),
    }


def limit(*, fabric: str, tolerance: float = 1.0, guess: float | None = None, **scene: Any) -> RunResult:
    """Critical velocity of a panel, within `tolerance` [m/s]."""
    panel = setup(fabric, 100.0, **scene).panel()
    found = limits.critical_velocity(panel, tolerance=tolerance, guess=guess)
    return {
        "velocity": found.velocity,
        "low": found.low,
        "high": found.high,
        "single": found.single,
        "shots": np.array([(s.strike_velocity, s.residual_velocity, s.perforated) for s in found.shots]),
    }


def shots(*, fabric: str, velocities: Sequence[float], **scene: Any) -> RunResult:
    """Residual velocities [m/s], failure and end times at several velocities."""
    panel = setup(fabric, 100.0, **scene).panel()
    fired = limits.shoot(panel, velocities)
    return {
        "strike": np.array(velocities),
        "residual": np.array([s.residual_velocity for s in fired]),
        "stopped": np.array([not s.perforated for s in fired]),
    }


def net(*, fabric: str, velocity: float, end_time: float = 800e-6, **changes: Any) -> RunResult:
    """One impact on the pin-jointed cable net."""
    found = run_cable(CableNet.of(ImpactSetup(cloth(fabric, **changes), velocity, **THESIS)), velocity, end_time)
    return {
        "outcome": found.outcome,
        "t": found.t,
        "v": found.v,
        "z": found.nose_position,
        "fine": found.step_history,
        "reactions": found.reactions,
        "seconds": found.wall_time,
        "bars": found.net.bars,
    }


def struck_yarn(*, fabric: str, velocity: float) -> RunResult:
    """A lone straight yarn struck at constant velocity, with Smith's closed form beside it."""
    yarn = catalogue.load(fabric).with_effective_density().weave.warp
    run, theory = smith.strike(yarn, velocity), smith.smith(yarn, velocity)
    return {
        "c": run.computed.c,
        "U": run.computed.U,
        "force": run.computed.force,
        "strain": run.computed.strain,
        "theory_c": theory.c,
        "theory_U": theory.U,
        "theory_strain": theory.strain,
        "X": run.X,
        "nodes": run.nodes,
    }


def bias(*, cloth: str, steps: int = 20) -> RunResult:
    """The bias extension test on one of its cloths."""
    case = bias_cases.run(cloth, steps=steps)
    result = case.result
    means = np.array([case.means(k) for k in range(len(result.states))])
    return {
        "problem": case.problem or "",
        "moved": result.prescribed,
        "angles": np.radians(means),
        "concentration": np.array([case.concentration(k) for k in range(len(result.states))]),
        "asymmetry": bias_cases.asymmetry(result) if not case.problem else np.nan,
        "inextensible": np.radians([case.inextensible(k) for k in range(len(result.states))]),
        "x": result.states[-1].x,
        "quads": result.coupon.quads,
        "gamma": result.shear(),
    }


def stability(*, fabric: str, velocity: float, factor: float, end_time: float) -> RunResult:
    """Whether a panel of straight yarns stays in balance at `factor` times its critical step.

    Nothing damps it and its yarns are taut, so that the bound is that of its highest mode; in the equilibrium form, for
    in the variational one half of the stiffness sees means over two elements, which leaves room of a root of 2.
    """
    from fabrics.errors import UnstableError
    from shellfabric.solver.pack_solver import PackSolver

    class Paced(Panel):
        @property
        def time_step(self):
            return factor * self.critical_step

    table = CellModel(cloth(fabric, straight=True), model="decoupled", form="equilibrium").table(201)
    panel = Paced(table, numerics=Numerics(stretch_viscosity=0.0), trellis=False, failure=False)
    try:
        PackSolver(panel, velocity, end_time).run()
    except UnstableError as problem:
        return {"stable": False, "message": str(problem)}
    return {"stable": True, "message": ""}


def pace(*, fabric: str, velocity: float, repeats: int = 3) -> RunResult:
    """Seconds that shell and cable net need for the same impact, run in turns; the least of each."""
    shell, cables = [], []
    scene, given = ImpactSetup(cloth(fabric), velocity, end_time=250e-6, **THESIS), cloth(fabric)
    for _ in range(repeats):
        shell.append(run_impact(scene).wall_time)
        cables.append(run_cable(CableNet.of(ImpactSetup(given, velocity, **THESIS)), velocity, 250e-6).wall_time)
    return {"shell": min(shell), "cable": min(cables)}


def low_pass(march: PackSolver, failure_time: float) -> None:
    """Low-pass tensions over failure_time [s] before they are held against the strength, in place of the time that
    follows from the failure length; 0 leaves that."""
    for lines in (lines for const in march.consts for lines in (const.warp_lines, const.weft_lines)):
        if failure_time > 0:
            lines.filter_factor[:] = -np.expm1(-march.const.dt / failure_time)


def pack(
    *, fabric: str, velocity: float, plies: int, stacking: str = "aligned", added: float = 0.0, body: str = "rigid",
    end_time: float = 400e-6, face: dict[str, Any] | None = None, form: str = "smooth", failure_time: float = 0.0,
) -> RunResult:  # fmt: skip
    """One impact on a pack of plies, with the gap of its compression data (erratum E-02).

    Parameters
    ----------
    fabric, velocity [m/s], plies, end_time [s]
    stacking : "aligned" or "alternating"
    added : [m] to that gap
    body : of the projectile, "rigid", "elastic_bar" (bored), or "full" (`Bar.full`)
    face : {"modulus", "strain": factors} of the ply that is struck, None where all are alike
    form : of the contact between plies
    failure_time : as of `low_pass`
    """
    shot = Projectile(body=Bar.full() if body == "full" else body)
    base = ImpactSetup(cloth(fabric), velocity, projectile=shot, **THESIS)
    ply = base.panel()
    gap = (ply_gap(ply.fabric, PlyLaw.of(ply.fabric)).value if plies > 1 else 0.0) + added
    whole = Pack.stacked(ply, plies, stacking=stacking, gap=gap, contact=PlyContact(form=form))
    if face is not None:
        struck = replace(base, fabric=cloth(fabric, **face)).panel()
        whole = replace(whole, plies=(struck, *whole.plies[1:]))
    march = PackSolver(whole, velocity, end_time, interval=1e-6)
    low_pass(march, failure_time)
    cones, tensions = [], []

    def look(march):
        tensions.append(_beside(march.consts[0], march.states[0]))
        if len(march.samples) % 20 == 0:
            shots = [output_snapshots.snapshot(p, s, march.time) for p, s in zip(march.pack.plies, march.states)]
            cones.append((march.time, [output_snapshots.pyramid(p, shot) for p, shot in zip(march.pack.plies, shots)]))

    march.run((look,))
    fine = np.concatenate(march.step_history)
    bar = ply.projectile.bar
    return {
        "outcome": march.outcome,
        "residual": float(march.sample("v")[-1]),
        "gap": gap,
        "t": march.sample("t"),
        "v": march.sample("v"),
        "z": march.sample("z"),
        "fine": np.column_stack([march.const.dt * np.arange(1, len(fine) + 1), fine]),
        "energies": {name: march.sample(name) for name in march.energy_names},
        "plies": {name: march.ply_sample(name) for name in PLY_SAMPLES},
        "tension": np.array(tensions),
        "peak": march.peak_tensions[..., 0],
        "deepest": march.deepest,
        "cones": cones,
        "swing": _swing(fine, march, bar) if bar else np.nan,
        "balance": float(np.abs(march.sample("error")).max()) / march.strike_energy,
        "seconds": march.wall_time,
        "steps": march.steps,
    }


def _beside(const, state):
    """[N] mean tension of the weft through the impact point from 5 to 15 mm beside it, on a quarter of a panel."""
    tension = output_snapshots.yarn_tensions(const, state)[0, :, 1]
    middle = (np.arange(tension.size) + 0.5) * const.dy
    return float(tension[(middle > 5e-3) & (middle < 15e-3)].mean())


def _swing(fine, march, bar):
    """[s] in which tip and tail of an elastic projectile swing."""
    return bodies.history(march.const.dt * np.arange(1, len(fine) + 1), fine, march.state, bar).swing


# name: (function, rough cost, to begin with the longest)
RUNS = {
    "shot": (shot, 2),
    "limit": (limit, 8),
    "shots": (shots, 6),
    "net": (net, 2),
    "struck_yarn": (struck_yarn, 1),
    "bias": (bias, 40),
    "stability": (stability, 1),
    "pace": (pace, 9),
    "pack": (pack, 20),
}
