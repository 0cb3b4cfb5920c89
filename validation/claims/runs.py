"""The computations that claims share: each a kind of run in claims.toml, with what it is made of and its keywords.

Fabrics are those of the thesis's shell runs (`Fabric.with_effective_density`, erratum E-07), with its mesh of one
element per crossover. All other settings are the defaults of weavecell: nothing is set to suit a claim.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

import weavecell as wc
from fabrics import catalogue, variants
from fabrics.errors import UnstableError
from fabrics.ply_law import PlyLaw
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from shellfabric.impact import ballistic_limit, simulation
from shellfabric.output.snapshots import yarn_tensions
from shellfabric.panel.model import Numerics, Panel
from shellfabric.plies.gap import ply_gap
from shellfabric.projectile.bar import Bar
from shellfabric.solver.pack_solver import PackSolver
from validation.models import variants as comparison
from validation.models.cable import smith
from validation.models.cable.model import CableNet
from validation.models.cable.solver import run as run_cable
from validation.published.bias_extension import cases as bias_cases

if TYPE_CHECKING:
    from fabrics.fabric import Fabric
    from shellfabric.impact.ballistic_limit import Limit
    from shellfabric.impact.simulation import ImpactSetup

PROJECTILE = {"mass": 3e-3, "diameter": 5.5e-3, "edge_radius": 0.3e-3}  # of the thesis
HISTORY = {"interval": 1e-6, "warp": [0.0], "weft": [0.0]}


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
    fabric = variants.with_linear_density(catalogue.load(name), denier)
    fabric = variants.scale_yarns(fabric, E=modulus, failure_strain=strain, crimp=crimp)
    fabric = variants.scale_areal_density(fabric, mass)
    if straight:
        fabric = comparison.with_straight_yarns(fabric)
    elif crimps:
        fabric = fabric.with_yarns(crimp=crimps)
    return variants.with_shear(fabric, **shear) if shear else fabric


def setup(
    fabric: str, velocity: float, *, change: dict[str, Any] | None = None, struck: dict[str, Any] | None = None,
    wider: float | None = None, projectile: dict[str, Any] | str | None = None, history: dict[str, Any] | None = None,
    **keywords: Any,
) -> ImpactSetup:  # fmt: skip
    """`weavecell.setup` of a shot.

    Parameters
    ----------
    fabric, velocity : name, [m/s]
    change : of the fabric, arguments of `cloth`
    struck : of the struck ply of a pack, beside `change`
    wider : [m] that the gap between plies has beside that of their compression data (erratum E-02)
    projectile : keys beside those of PROJECTILE; or "full bar", elastic without a bore (`Bar.full`)
    history : keys beside those of HISTORY
    **keywords : of `weavecell.setup`
    """
    used, plies = cloth(fabric, **change or {}), keywords.get("plies", 1)
    keywords = {"elements_per_crossover": 1} | keywords
    if wider is not None:
        keywords["ply_gap"] = ply_gap(used, PlyLaw.of(used)).value + wider
    own = {} if isinstance(projectile, str) else projectile or {}
    made = wc.setup(
        used, velocity, projectile=PROJECTILE | own,
        history=HISTORY | (history or {}), **keywords,
    )  # fmt: skip
    if projectile == "full bar":
        made = replace(made, projectile=replace(made.projectile, body=Bar.full()))
    if struck is not None:
        rest = (simulation.Ply(used),) * (plies - 1)
        made = replace(made, lay_up=(simulation.Ply(cloth(fabric, **(change or {}) | struck)), *rest))
        made = replace(made, fabric=made.lay_up[0].fabric, laws=made.lay_up[0].laws)
    return made


class _Watch:
    """Hook: times [s] after which a warp and a weft segment of the struck ply have failed, and at each audit the mean
    tension [N] of the weft through the impact point from 5 to 15 mm beside it, on a quarter of a panel."""

    def __init__(self):
        self.times, self.beside = np.full(2, np.nan), []

    def __call__(self, solver):
        tension = yarn_tensions(solver.const, solver.state)[0, :, 1]
        middle = (np.arange(tension.size) + 0.5) * solver.const.dy
        self.beside.append(float(tension[(middle > 5e-3) & (middle < 15e-3)].mean()))
        for family, failed in enumerate(solver.state.failed):
            if np.isnan(self.times[family]) and failed.any():
                self.times[family] = solver.time


@dataclass(frozen=True, kw_only=True)
class Shot(simulation.ImpactResult):
    """One impact.

    Parameters
    ----------
    first_failure : (2,) [s] after which a warp and a weft segment of the struck ply have failed; nan where none has
    beside : (n - 1,) [N] mean tension of the weft through the impact point from 5 to 15 mm beside it
    """

    first_failure: np.ndarray
    beside: np.ndarray


def shot(fabric: str, velocity: float, *, failure_time: float = 0.0, **scene: Any) -> Shot:
    """One impact on one ply or several.

    Parameters
    ----------
    fabric, velocity, **scene : of `setup`
    failure_time : [s] over which tensions are low-passed before they are held against the strength, in place of the
        time that follows from the failure length; 0 leaves that
    """
    made, hook = setup(fabric, velocity, **scene), _Watch()
    if failure_time:
        solver = PackSolver(made.target(), velocity, made.end_time, interval=made.sample_interval)
        for lines in (lines for const in solver.consts for lines in (const.warp_lines, const.weft_lines)):
            lines.filter_factor[:] = -np.expm1(-solver.const.dt / failure_time)
        solver.run((hook,))
        result = simulation.collect_result(made, solver)
    else:
        result = simulation.run(made, hooks=(hook,))
    plain = made.target(made.plain_table())  # whose table of the cell, which takes 15 MB, is not needed any more
    return Shot(**vars(result) | {"target": plain}, first_failure=hook.times, beside=np.array(hook.beside))


def limit(fabric: str, *, tolerance: float = 1.0, guess: float | None = None, **scene: Any) -> Limit:
    """Critical velocity of one ply, within `tolerance` [m/s]."""
    target = setup(fabric, 100.0, **scene).panel()
    return ballistic_limit.critical_velocity(target, tolerance=tolerance, guess=guess)


def shots(fabric: str, velocities: Sequence[float], **scene: Any) -> SimpleNamespace:
    """(n,) strike and residual velocities [m/s], and which shots stopped."""
    fired = ballistic_limit.shoot(setup(fabric, 100.0, **scene).panel(), velocities)
    residual = np.array([shot.residual_velocity for shot in fired])
    stopped = np.array([not shot.perforated for shot in fired])
    return SimpleNamespace(strike=np.array(velocities), residual=residual, stopped=stopped)


def net(fabric: str, velocity: float, **change: Any) -> SimpleNamespace:
    """One impact on the pin-jointed cable net of a changed fabric (`cloth`)."""
    made = simulation.ImpactSetup(cloth(fabric, **change), velocity, elements_per_crossover=1)
    found = run_cable(CableNet.of(made), velocity, 800e-6)
    return SimpleNamespace(step_history=found.step_history, reactions=found.reactions)


def struck_yarn(fabric: str, velocity: float) -> SimpleNamespace:
    """A lone straight yarn struck at constant velocity: what was computed, and Smith's closed form, `theory`."""
    yarn = catalogue.load(fabric).with_effective_density().weave.warp
    run = smith.strike(yarn, velocity)
    return SimpleNamespace(**vars(run.computed), X=run.X, nodes=run.nodes, theory=smith.smith(yarn, velocity))


def strip(fabric: str, velocity: float, length: float, end_time: float) -> SimpleNamespace:
    """The shell's own lone yarns: straight warp under a shot, in a strip whose weft has next to no mass and stiffness.

    The strip is 12 mm wide with free sides, of which the nose meets the middle half, and `length` [m] long between its
    clamps. Kept is the history of its middle yarn.
    """
    made = setup(
        fabric, velocity, change={"straight": True}, opening=(length, 12e-3),
        boundary={"warp": "clamped", "weft": "free"}, cell_model="decoupled", end_time=end_time, yarn_failure=False,
        history={"weft": []},
    )  # fmt: skip
    given = made.fabric
    weft = replace(given.weave.weft, linear_density=1e-3 * given.weave.weft.linear_density)
    given = replace(given, weave=replace(given.weave, weft=weft), shear=None)
    return SimpleNamespace(histories=simulation.run(replace(made, fabric=given)).histories)


def bias(cloth: str, *, steps: int = 20) -> SimpleNamespace:
    """The bias extension test on one of its cloths, by load steps."""
    case = bias_cases.run(cloth, steps=steps)
    result, count = case.result, range(len(case.result.states))
    return SimpleNamespace(
        moved=result.prescribed,
        angles=np.radians([case.means(k) for k in count]),
        concentration=np.array([case.concentration(k) for k in count]),
        asymmetry=bias_cases.asymmetry(result) if not case.problem else np.nan,
        load=np.abs(result.force(1, 1)),
    )


def frame(fabric: str, *, shear_angle: float, steps: int = 16, cells: int = 4) -> SimpleNamespace:
    """The picture frame test: shear angle [rad], shear stress [Pa] and force [N] along the diagonal of the frame.

    The force does the work of the stress: F d(delta) = tau V d(gamma), with the diagonal delta = 2 L sin(beta / 2) of a
    square of side L whose angle between the yarns is beta = 90 degrees + gamma on the side of the diagonal.
    """
    table = CellModel(cloth(fabric)).table(201)
    result = quasistatic.picture_frame(table, cells=cells, shear_angle=shear_angle, steps=steps, tolerance=1e-7)
    stress, weave = quasistatic.frame_stress(result), table.model.fabric.weave
    side = np.array([2 * cells * w for w in weave.w])
    slope = np.sqrt(side[0] * side[1]) * np.cos(0.25 * np.pi + 0.5 * result.prescribed)
    force = stress * side[0] * side[1] * weave.thickness / slope
    return SimpleNamespace(gamma=result.prescribed, stress=stress, force=force, side=side)


def stability(fabric: str, velocity: float, *, factor: float, end_time: float) -> SimpleNamespace:
    """Whether a panel of straight yarns stays in balance at `factor` times its critical step.

    Nothing damps it and its yarns are taut, so that the bound is that of its highest mode; in the equilibrium form, for
    in the variational one half of the stiffness sees means over two elements, which leaves room of a root of 2.
    """

    class Paced(Panel):
        @property
        def time_step(self):
            return factor * self.critical_step

    table = CellModel(cloth(fabric, straight=True), model="decoupled", form="equilibrium").table(201)
    panel = Paced(table, numerics=Numerics(stretch_viscosity=0.0), trellis=False, failure=False)
    try:
        PackSolver(panel, velocity, end_time).run()
    except UnstableError:
        return SimpleNamespace(stable=False)
    return SimpleNamespace(stable=True)


def pace(fabric: str, velocity: float, *, repeats: int = 3) -> SimpleNamespace:
    """Seconds that shell and cable net need for 250 us of the same impact, run in turns; the least of each."""
    made = simulation.ImpactSetup(cloth(fabric), velocity, end_time=250e-6, elements_per_crossover=1)
    shell, cable = [], []
    for _ in range(repeats):
        shell.append(simulation.run(made).wall_time)
        cable.append(run_cable(CableNet.of(made), velocity, 250e-6).wall_time)
    return SimpleNamespace(shell=min(shell), cable=min(cable))


def pencil(
    fabric: str, *, plies: int, modulus: float = 1.0, mass: float = 0.0, elements: int = 2, edge: str = "free",
    layer: float | None = None,
) -> Any:  # fmt: skip
    """One run of Table 6-2 before its block; without plies the block alone.

    Parameters
    ----------
    plies, modulus, mass : of `pencilling.study.Case`
    elements, edge, layer : of `pencilling.study.march`
    """
    from validation.published.pencilling.study import FABRIC, Case, bare, shoot

    assert fabric == FABRIC
    return bare() if plies == 0 else shoot(Case(plies, modulus, mass), elements=elements, edge=edge, layer=layer)
