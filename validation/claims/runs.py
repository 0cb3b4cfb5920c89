"""The computations that claims share: each a kind of run in claims.toml, with what it is made of and its keywords.

Fabrics are those of the thesis's shell runs (`Fabric.with_effective_density`, erratum E-07), with its mesh of one
element per crossover. All other settings are the defaults of weavecell: nothing is set to suit a claim. The runs of the
3D crossover and of its packs need gmsh, and all but `meshes` and `sections` dolfinx; woven solids need gmsh.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import process_time
from types import SimpleNamespace
from typing import Any

import numpy as np

import weavecell as wc
from fabrics import ply_laws, variants
from fabrics.assumed import friction_between_yarns
from fabrics.base.errors import UnstableError
from fabrics.fabric import Fabric
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from shellfabric.impact.result import ImpactResult, collect_result
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.loop.snapshots import yarn_tensions
from shellfabric.membrane.model import Panel
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.gap import ply_gap
from shellfabric.projectile.bar import Bar
from validation.cases import block, noses
from validation.cases.small_patch import StepClock
from validation.claims import changed_fabrics
from validation.models.cable import smith
from validation.models.cable.net import CableNet, NetResult
from validation.models.solids import step_kernels
from validation.models.solids.mesh import SolidMesh
from validation.models.solids.model import SolidPatch
from validation.models.solids.solver import SolidSolver
from validation.models.variants import with_straight_yarns
from validation.published import bias_extension
from validation.values import Values
from weavecell.studies import ballistic_limit

# of the thesis
PROJECTILE = {"mass": 3e-3, "diameter": 5.5e-3, "edge_radius": 0.3e-3, "friction": 0.0}
HISTORY = {"interval": 1e-6, "warp": [0.0], "weft": [0.0]}
SIZE = "coarse"  # mesh of a quarter crossover
ROWS = 30  # of the loading of a pack of crossovers, and of its unloading


def changed_fabric(
    name: str,
    *,
    modulus: float = 1.0,
    crimp: float = 1.0,
    mass: float = 1.0,
    crimps: Sequence[float] | None = None,
    straight: bool = False,
    shear: dict[str, float] | None = None,
    denier: str = "effective",
) -> Fabric:
    """Change a fabric of the catalogue.

    Parameters
    ----------
    modulus, crimp : factors on fibre modulus and crimps
    mass : factor on the areal density that leaves the stiffness of the yarns alone
    crimps : (warp, weft) [-] instead
    straight : yarns without crimp; the trellis keeps its stiffness per width
    shear : {"G1", "G2", "gamma1", "gamma2": values} that replace those of the fabric
    denier : "effective", the linear density that the thesis's tables imply (erratum E-07), or "nominal"
    """
    fabric = variants.with_linear_density(changed_fabrics.load(name), denier)
    fabric = variants.scale_yarns(fabric, E=modulus, crimp=crimp)
    fabric = variants.scale_areal_density(fabric, mass)
    if straight:
        fabric = with_straight_yarns(fabric)
    elif crimps:
        fabric = fabric.with_yarns(crimp=crimps)
    if shear:
        return variants.with_shear(fabric, **shear)
    return fabric


def setup(
    fabric: str,
    velocity: float,
    *,
    change: Values | None = None,
    struck: Values | None = None,
    wider: float | None = None,
    projectile: Values | str | None = None,
    history: Values | None = None,
    **keywords: Any,
) -> ImpactSetup:
    """Build `weavecell.setup` of a shot.

    Parameters
    ----------
    fabric, velocity : name, [m/s]
    change : of the fabric, arguments of `changed_fabric`
    struck : of the struck ply of a pack, beside `change`
    wider : [m] that the gap between plies has beside that of their compression data (erratum E-02)
    projectile : keys beside those of PROJECTILE; or "full bar", elastic without a bore (`Bar.full`)
    history : keys beside those of HISTORY
    **keywords : of `weavecell.setup`
    """
    change = change or {}
    used = changed_fabric(fabric, **change)
    keywords = {"elements_per_crossover": 1, "length_effect": False} | keywords
    if wider is not None:
        keywords["ply_gap"] = ply_gap(used, ply_laws.default(used)).value + wider
    keywords["projectile"] = PROJECTILE
    if isinstance(projectile, dict):
        keywords["projectile"] = PROJECTILE | projectile
    made = wc.setup(used, velocity, history=HISTORY | (history or {}), **keywords)
    # the shots of the thesis have no friction between plies either
    made = noses.with_friction(made)
    if projectile == "full bar":
        made = replace(made, projectile=replace(made.projectile, body=Bar.full()))
    if struck is not None:
        first = Ply(changed_fabric(fabric, **change | struck))
        rest = [Ply(used)] * (made.plies - 1)
        made = replace(made, lay_up=(first, *rest), fabric=first.fabric, laws=first.laws)
    return made


@dataclass(frozen=True, kw_only=True)
class Shot(ImpactResult):
    """One impact.

    Parameters
    ----------
    first_failure : (2,) [s] after which a warp and a weft segment of the struck ply have failed; nan where none has
    beside : (n - 1,) [N] at each audit, mean tension of the weft through the impact point from 5 to 15 mm beside it, on
        a quarter of a panel
    """

    first_failure: np.ndarray
    beside: np.ndarray


def shot(fabric: str, velocity: float, *, failure_time: float = 0.0, **scene: Any) -> Shot:
    """Fire one impact on one ply or several.

    Parameters
    ----------
    fabric, velocity, **scene : of `setup`
    failure_time : [s] over which tensions are low-passed before they are held against the strength, in place of the
        time that follows from the failure length; 0 leaves that
    """
    made = setup(fabric, velocity, **scene)
    times = np.full(2, np.nan)
    beside = []

    def watch(solver):
        tension = yarn_tensions(solver.const, solver.state)[0, :, 1]
        middle = (np.arange(tension.size) + 0.5) * solver.const.dy
        beside.append(float(tension[(middle > 5e-3) & (middle < 15e-3)].mean()))
        for family, failed in enumerate(solver.state.failed):
            if np.isnan(times[family]) and failed.any():
                times[family] = solver.time

    if failure_time:
        solver = PackSolver(made.target(), velocity, made.end_time, interval=made.sample_interval)
        factor = -np.expm1(-solver.const.dt / failure_time)
        for const in solver.consts:
            const.warp_lines.filter_factor[:] = factor
            const.weft_lines.filter_factor[:] = factor
        solver.run((watch,))
        result = collect_result(made, solver)
    else:
        result = run_impact(made, hooks=(watch,))
    # the table of the cell takes 15 MB and is not needed any more
    plain = made.target(made.plain_table())
    return Shot(**vars(result) | {"target": plain}, first_failure=times, beside=np.array(beside))


def limit(
    fabric: str, *, tolerance: float = 1.0, guess: float | None = None, **scene: Any
) -> ballistic_limit.Limit:
    """Find the critical velocity of one ply, within `tolerance` [m/s]."""
    target = setup(fabric, 100.0, **scene).panel()
    return ballistic_limit.critical_velocity(target, tolerance=tolerance, guess=guess)


def shots(
    fabric: str, velocities: Sequence[float], **scene: Any
) -> tuple[ballistic_limit.Shot, ...]:
    """Fire shots at one ply at some velocities [m/s]."""
    return ballistic_limit.shoot(setup(fabric, 100.0, **scene).panel(), velocities)


def net(fabric: str, velocity: float, **change: Any) -> NetResult:
    """Fire one impact on the pin-jointed cable net of a fabric (`changed_fabric`)."""
    made = ImpactSetup(
        changed_fabric(fabric, **change),
        velocity,
        end_time=800e-6,
        elements_per_crossover=1,
        length_effect=False,
    )
    return CableNet(made).run()


def struck_yarn(fabric: str, velocity: float) -> SimpleNamespace:
    """Strike a lone straight yarn at constant velocity: what was computed, and Smith's closed form,
    `theory`."""
    yarn = changed_fabrics.load(fabric).with_effective_density().weave.warp
    run = smith.strike(yarn, velocity)
    return SimpleNamespace(
        **vars(run.computed), X=run.X, nodes=run.nodes, theory=smith.smith(yarn, velocity)
    )


def strip(fabric: str, velocity: float, length: float, end_time: float) -> SimpleNamespace:
    """Strike the shell's own lone yarns: straight warp under a shot, in a strip whose weft has next
    to no mass and stiffness.

    The strip is 12 mm wide with free sides, of which the nose meets the middle half, and `length` [m] long between its
    clamps. Kept is the history of its middle yarn.
    """
    made = setup(
        fabric,
        velocity,
        change={"straight": True},
        opening=(length, 12e-3),
        boundary={"warp": "clamped", "weft": "free"},
        cell_model="decoupled",
        end_time=end_time,
        yarn_failure=False,
        history={"weft": []},
    )
    given = made.fabric
    weft = replace(given.weave.weft, linear_density=1e-3 * given.weave.weft.linear_density)
    given = replace(given, weave=replace(given.weave, weft=weft), shear=None)
    return SimpleNamespace(measured=run_impact(replace(made, fabric=given)).measured)


def bias(name: str, *, steps: int = 20) -> SimpleNamespace:
    """Run the bias extension test on one of its fabrics, by load steps."""
    fabric, model, trellis = bias_extension.coupon_fabric(name)
    # without a trellis there is no equilibrium to be found: two steps of 6000 iterations at most
    options = {"steps": steps}
    if name == "none":
        options = {"steps": 2, "max_iterations": 6000}
    table = CellModel(fabric, cell_model=model).table(201)
    try:
        # at a tolerance of 1e-4 of the load the halves of the coupon still differ by 2e-6 of its width
        result = quasistatic.bias_extension(table, trellis=trellis, tolerance=1e-5, **options)
    except UnstableError as found:
        result = found.result
    values = bias_extension.measured(result)
    values["angles"] = np.radians(values["angles"])
    return SimpleNamespace(**values, asymmetry=bias_extension.asymmetry(result))


def frame(fabric: str, *, shear_angle: float, steps: int, cells: int) -> SimpleNamespace:
    """Run the picture frame test: shear angle [rad], shear stress [Pa] and force [N] along the
    diagonal of the frame.

    The force does the work of the stress: F d(delta) = tau V d(gamma), with the diagonal delta = 2 L sin(beta / 2) of a
    square of side L whose angle between the yarns is beta = 90 degrees + gamma on the side of the diagonal.
    """
    table = CellModel(changed_fabric(fabric)).table(201)
    result = quasistatic.picture_frame(
        table, crossovers=cells, shear_angle=shear_angle, steps=steps, tolerance=1e-7
    )
    weave = table.model.fabric.weave
    gamma = result.prescribed
    stress = quasistatic.frame_stress(result)
    side = 2 * cells * np.array(weave.w)
    area = side[0] * side[1]
    slope = np.sqrt(area) * np.cos(0.25 * np.pi + 0.5 * gamma)
    force = stress * area * weave.thickness / slope
    return SimpleNamespace(gamma=gamma, stress=stress, force=force, side=side)


def stability(fabric: str, velocity: float, *, factor: float, end_time: float) -> SimpleNamespace:
    """Tell whether a panel of straight yarns stays in balance at `factor` times its critical step.

    Nothing damps it and its yarns are taut, so that the bound is that of its highest mode; in the equilibrium form, for
    in the variational one half of the stiffness sees means over two elements, which leaves room of a root of 2.
    """

    class Paced(Panel):
        @property
        def time_step(self):
            return factor * self.critical_step

    table = CellModel(
        changed_fabric(fabric, straight=True),
        cell_model="decoupled",
        cell_formulation="equilibrium",
    ).table(201)
    panel = Paced(
        table, numerics=Numerics(stretch_viscosity=0.0), trellis=False, yarn_failure=False
    )
    try:
        PackSolver(panel, velocity, end_time).run()
    except UnstableError:
        return SimpleNamespace(stable=False)
    return SimpleNamespace(stable=True)


def pace(fabric: str, velocity: float) -> SimpleNamespace:
    """Time shell and cable net over 250 us of the same impact, CPU time [s] of the steps, run three
    times in turns; the least."""
    made = ImpactSetup(
        changed_fabric(fabric),
        velocity,
        end_time=250e-6,
        elements_per_crossover=1,
        length_effect=False,
    )
    shell = []
    cable = []
    for _ in range(3):
        clock = StepClock()
        run_impact(made, hooks=[clock])
        shell.append(clock.seconds)
        netted = CableNet(made)
        began = process_time()
        netted.run()
        cable.append(process_time() - began)
    return SimpleNamespace(shell=min(shell), cable=min(cable))


def woven(
    fabric: str,
    velocity: float,
    *,
    crossings: int,
    size: Sequence[int],
    end_time: float,
    clamped: bool = True,
) -> SimpleNamespace:
    """Strike a patch of woven solid yarns with the projectile of the thesis.

    Parameters
    ----------
    fabric, velocity : name, [m/s]
    crossings : of each family; a quarter of an odd number is computed if it is clamped
    size : hexahedra along, across and through a quarter of a yarn in one crossing
    end_time : [s]
    clamped : whether the ends of the yarns are held

    Returns
    -------
    t, hourglass, internal (n,) : [s], [J] energy of the hourglass control, and of fibres and solids
    seconds : [s] of CPU time a crossover and us
    bricks : number a crossover
    failed : number of bars that have failed
    strain : the largest of the whole bars over that of failure
    mass, fibre_mass : [kg] of the nodes, and of the fibres that were meshed
    momentum : [N s] of yarns and projectile
    """
    from meshing import patch

    given = changed_fabrics.load(fabric)
    mesh: Any = patch.build(given, (crossings, crossings), size=tuple(size))
    model = SolidPatch(
        SolidMesh.of(mesh, quarter=clamped and crossings % 2 == 1),
        given,
        setup(fabric, velocity).projectile,
        friction=friction_between_yarns(given).value,
        fibre_fractions=tuple(mesh.Vf0),
        clamped=clamped,
    )
    solver = SolidSolver(model, velocity, end_time)
    clock = StepClock()
    solver.run([clock])
    row = solver.row
    momentum = row.mass @ row.v + row.projectile_mass * row.nose_velocity
    step_kernels.forces(row)  # bars are removed by their strain at these positions
    strains = []
    fibre_mass = 0.0
    for grid, family, area in zip(model.mesh.grids, model.mesh.families, model.mesh.bar_area):
        rest, now = (
            np.linalg.norm(np.diff(x[grid], axis=0), axis=-1) for x in (model.mesh.points, row.x)
        )
        yarn = given.weave.yarns[family]
        strains.append(((now / rest - 1) / yarn.failure_strain).ravel())
        fibre_mass += float(yarn.fibre_density * (area * rest).sum())
    crossovers = crossings**2 * model.mesh.share
    return SimpleNamespace(
        t=solver.sample("t"),
        hourglass=solver.sample("hourglass"),
        internal=solver.sample("fibres") + solver.sample("solids"),
        seconds=clock.seconds / (crossovers * 1e6 * end_time),
        bricks=model.mesh.bricks / crossovers,
        failed=int(np.count_nonzero(~row.bar_intact)),
        strain=float(np.concatenate(strains)[row.bar_intact].max()),
        mass=float(row.mass.sum()),
        fibre_mass=fibre_mass,
        momentum=float(momentum[2]),
    )


def pencil(plies: int, **target: Any) -> SimpleNamespace:
    """Repeat a run of Table 6-2 before its block, or the bare block without plies
    (`cases.block.target`); wall in rad."""
    found = block.target(plies, **target)
    found["wall"] = np.radians(found["wall"])
    return SimpleNamespace(**found)


def _meshed(fabric, size=SIZE, **options):
    """(mesh of the quarter crossover, fabric)"""
    from meshing import crossover as mesher

    given = changed_fabrics.load(fabric)
    return mesher.build(given, size=size, **options), given


class PathColumns(SimpleNamespace):
    """The columns of a path, by attribute as the texts of claims name them, and by key as a `Record` has them."""

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)


def stretched(
    fabric: str,
    *,
    ratio: Sequence[float],
    reach: float | None = None,
    fibre_fraction: str = "mesh",
) -> PathColumns:
    """Follow a biaxial path to fibre failure or to `reach` [m]; at its end the centrelines and the
    thickness of the yarns.

    `fibre_fraction` is that of `unitcell3d.material.numerics.Numerics`.
    """
    from unitcell3d.cases import biaxial_and_platens
    from unitcell3d.material.numerics import Numerics

    mesh, given = _meshed(fabric)
    numerics = Numerics(fibre_fraction=fibre_fraction)
    found = biaxial_and_platens.biaxial(
        mesh, given, ratio, max_displacement=reach, numerics=numerics
    )
    x = mesh.points + found.last["u"]
    lines = []
    for axis, (grid, sign) in enumerate(zip(mesh.grids, (1, -1))):
        middle = _middle(x, grid)
        lines.append(np.stack([middle[:, axis], sign * middle[:, 2]]))
    return PathColumns(
        **found.columns,
        failed=found.failed,
        lines=lines,
        thickness=_thickness(mesh, mesh.points),
        thickness_end=_thickness(mesh, x),
    )


def _middle(points, grid):
    """(n, 3) [m] axis of a yarn over the plane of symmetry across it, from each column through the thickness."""
    return 0.5 * (points[grid[:, 0, 0]] + points[grid[:, 0, -1]])


def _thickness(mesh, points):
    """(2,) [m] height of the first section of each yarn."""
    return np.array([np.ptp(points[grid[0, 0], 2]) for grid in mesh.grids])


def plates(fabric: str) -> PathColumns:
    """Press the crossover between plates."""
    from unitcell3d.cases import biaxial_and_platens

    found = biaxial_and_platens.plate_compression(*_meshed(fabric))
    return PathColumns(**found.columns, failed=found.failed)


def lone(
    fabric: str,
    *,
    family: int,
    bars: int | None = None,
    one_point: bool = False,
    moved: float = 0.0,
) -> SimpleNamespace:
    """Pull one yarn alone straight and on.

    Parameters
    ----------
    fabric, family : name, 0 warp or 1 weft
    bars : 0 takes its fibres away
    one_point : the solids have one point of integration
    moved : standard deviation of a random move of nodes that no symmetry holds, over the thickness

    Returns
    -------
    strain, T : [-], [N] the path
    zigzag : [-] amplitude at its end from node to node along the yarn, over the thickness
    """
    from unitcell3d.cases import single_yarn
    from unitcell3d.material import solid_law

    integration = solid_law.FULL
    if one_point:
        integration = solid_law.ONE_POINT
    strain = None
    if bars == 0:
        strain = 0.06
    mesh, given = _meshed(fabric)
    grid = mesh.grids[family]
    thickness = _thickness(mesh, mesh.points)[family]
    if moved:
        inner = grid[1:-1, 1:]
        points = mesh.points.copy()
        points[inner] += np.random.default_rng(1).normal(0.0, moved * thickness, (*inner.shape, 3))
        mesh = replace(mesh, points=points)
    found = single_yarn.pull(mesh, given, family, bars=bars, integration=integration, strain=strain)
    return SimpleNamespace(
        strain=found.columns["strain"],
        T=found.columns["T"],
        zigzag=float(found.columns["astray"][-1] / thickness),
    )


def sections(fabric: str) -> SimpleNamespace:
    """Measure the sections of whole yarns, warp and weft: `area` (2,) [m2] their volume over the
    length of their centreline, `fibre` (2,) [m2] of the bars that cut the section at the
    crossing."""
    mesh, _ = _meshed(fabric)
    area = []
    fibre = []
    for number, (grid, pairs, bars, S0) in enumerate(
        zip(mesh.grids, mesh.bars, mesh.bar_area, mesh.S0)
    ):
        # half of the length and half of the section are meshed
        area.append(4 * _volume(mesh.points[mesh.hexes[mesh.yarn == number]]) / S0)
        fibre.append(float(bars[np.isin(pairs, grid[0]).any(axis=1)].sum()) / mesh.share)
    return SimpleNamespace(area=np.array(area), fibre=np.array(fibre))


def _volume(corners):
    """[m3] of bricks (m, 8, 3) in VTK order: six tetrahedra each, about the diagonal from corner 0 to corner 6."""
    first = corners[:, 0]
    last = corners[:, 6]
    sixths = [
        np.einsum("ij,ij->i", np.cross(corners[:, a] - first, corners[:, b] - first), last - first)
        for a, b in itertools.pairwise((1, 2, 3, 7, 4, 5, 1))
    ]
    return float(abs(np.sum(sixths)) / 6)


def meshes(fabric: str, *, sections: Sequence[str]) -> SimpleNamespace:
    """Measure what the mesher makes of a fabric, by section: deviation of the axis from a cosine
    and spread of the thickness over that at the crest [-], deepest point of the weft in the warp
    [m]; and the yarns of each domain."""
    from meshing import patch

    found: Values = {}
    for section in sections:
        mesh, given = _meshed(fabric, section=section)
        errors = []
        spread = []
        for grid, w, h, axis in zip(mesh.grids, mesh.w, mesh.h0, (0, 1)):
            middle = _middle(mesh.points, grid)
            errors.append(
                np.ptp(abs(middle[:, 2]) - h * np.cos(np.pi * middle[:, axis] / (2 * w))) / h
            )
            heights = mesh.points[grid[:, :, -1], 2] - mesh.points[grid[:, :, 0], 2]
            spread.append(np.ptp(heights, axis=0).max() / heights.max())
        found[section] = {"cosine": max(errors), "spread": max(spread), "overlap": _overlap(mesh)}
    return SimpleNamespace(sections=found, four=len(patch.build(given, (2, 2), size=SIZE).names))


def _overlap(mesh):
    """[m] deepest point of the weft's upper face within the warp, on the nodes of the quarter; 0 if none."""
    from scipy.interpolate import LinearNDInterpolator

    warp, weft = (mesh.points[grid] for grid in mesh.grids)
    lower = warp[:, :, 0].reshape(-1, 3)
    upper = weft[:, :, -1].reshape(-1, 3)
    below = LinearNDInterpolator(lower[:, :2], lower[:, 2])(upper[:, :2])
    return float(max(np.nanmax(upper[:, 2] - below), 0.0))


def brick(fabric: str, *, stretch: Sequence[float]) -> SimpleNamespace:
    """Compute the Cauchy stress [Pa] along the fibre of one brick of warp at three stretches, and
    its fibre fraction."""
    from unitcell3d.assembly.compat import Assembler, HexSpace
    from unitcell3d.material.solid_law import forms

    law = changed_fabrics.load(fabric).solid_laws[0]
    # of the unit cube, in the order of VTK
    corners = np.array([*itertools.product((0.0, 1.0), repeat=3)])[[0, 4, 6, 2, 1, 5, 7, 3]]
    space = HexSpace.build(corners, np.arange(8)[None])
    constants = space.cell_constants(
        np.array([[law.E_a, law.a_E, law.b_E, law.Vf0, law.V_c, law.G]])
    )
    solid = Assembler(space, *forms(space, constants))
    a, b, c = stretch
    space.set_displacement(corners * (np.array(stretch) - 1))
    nominal = (solid.residual().T @ corners)[0, 0]
    return SimpleNamespace(
        stress=nominal / (b * c), V_f=law.Vf0 / (b * c), strain=float(np.log(a)), E_a=law.E_a
    )


def released(fabric: str, *, plies: int, friction: float, closed: float) -> SimpleNamespace:
    """Close and open aligned plies between plates again: (closure [m], pressure [Pa]) of both
    branches.

    Parameters
    ----------
    fabric, plies : name, number
    friction : [-] Coulomb's coefficient between yarns, and between yarns and plates
    closed : [-] share of the first distance of the plates by which they close
    """
    from unitcell3d.cases.stack import StackModel
    from unitcell3d.model.crossover import Load, Numerics
    from unitcell3d.solver.path_following import follow

    mesh, given = _meshed(fabric, size=(4, 3, 2))
    model = StackModel(mesh, given, plies, Numerics(friction=friction))
    rest = model.plates.at_rest
    area = given.weave.cell_area

    def row(state, load):
        force = model.copies[1] * float(np.mean(state.plates))
        return {"closure": 2 * (rest - load.plates), "pressure": force / area}

    loads = [Load(plates=share * rest) for share in (1.0, 1.0 - closed, 1.0)]
    found = follow(model, loads, row, rows=(ROWS, ROWS))
    branches = np.array([found["closure"], found["pressure"]])
    turn = int(np.argmax(branches[0]))
    return SimpleNamespace(loading=branches[:, : turn + 1], unloading=branches[:, turn:])
