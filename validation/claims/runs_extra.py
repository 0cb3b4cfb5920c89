"""The computations that checks share and that neither `runs`, `runs3d` nor `runs_studies` has."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fabrics import catalogue
from fabrics.errors import UnstableError
from fabrics.ply_law import PlyLaw
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.impact.simulation import run as run_impact
from shellfabric.output.histories import HistoryRequest
from shellfabric.panel.boundary import Grip
from shellfabric.plies.gap import ply_gap
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.projectile.projectile import Projectile
from shellfabric.solver.pack_solver import PackSolver
from validation.claims.runs import THESIS, cloth, low_pass

if TYPE_CHECKING:
    from validation.claims.registry import RunResult

OFFSETS = tuple((1e-3 * np.arange(3, 100, 3)).round(6))  # [m] of the weft yarns that are recorded at the edge


def sections(*, fabric: str, size: str = "coarse") -> RunResult:
    """Sections of the yarns of the meshed quarter crossover.

    Returns
    -------
    {"area": (2,) [m2] of warp and weft, their volume over the length of their centreline,
    "crest": (2,) [m2] of the section at the crossing, "fibre": (2,) [m2] of the bars that cut it}, of whole yarns
    """
    from meshing import crossover as mesher

    mesh = mesher.build(catalogue.load(fabric), size=size)
    area, crest, fibre = [], [], []
    rows = zip(mesh.grids, mesh.bars, mesh.bar_area, mesh.S0, (0, 1))
    for number, (grid, pairs, bars, S0, along) in enumerate(rows):
        layer = mesh.points[grid[0]][..., [1 - along, 2]]  # (ny+1, nz+1, 2), at right angles to the yarn at its crest
        crest.append(2 * _quadrilaterals(layer))
        # half of the length and half of the section are meshed
        area.append(4 * _volume(mesh.points[mesh.hexes[mesh.yarn == number]]) / S0)
        cut = np.isin(pairs, grid[0]).any(axis=1)
        fibre.append(float(bars[cut].sum()) / mesh.share)
    return {"area": np.array(area), "crest": np.array(crest), "fibre": np.array(fibre)}


def _volume(corners):
    """[m3] of bricks (m, 8, 3) in VTK order: six tetrahedra each, about the diagonal from corner 0 to corner 6."""
    ring = (1, 2, 3, 7, 4, 5, 1)
    first, last = corners[:, 0], corners[:, 6]
    sixths = [
        np.einsum("ij,ij->i", np.cross(corners[:, a] - first, corners[:, b] - first), last - first)
        for a, b in itertools.pairwise(ring)
    ]
    return float(abs(np.sum(sixths)) / 6)


def _quadrilaterals(p):
    """[m2] area of a grid (n, m, 2) of points in a plane."""
    one, other = p[1:, 1:] - p[:-1, :-1], p[1:, :-1] - p[:-1, 1:]
    return float(0.5 * np.abs(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]).sum())


def frame(*, fabric: str, shear_angle: float, steps: int = 16, cells: int = 4) -> RunResult:
    """The picture frame test: shear angle [rad], shear stress [Pa] and force [N] along the diagonal of the frame.

    The force does the work of the stress: F d(delta) = tau V d(gamma), with the diagonal delta = 2 L sin(beta / 2) of a
    square of side L whose angle between the yarns is beta = 90 degrees + gamma on the side of the diagonal.
    """
    table = CellModel(cloth(fabric)).table(201)
    result = quasistatic.picture_frame(table, cells=cells, shear_angle=shear_angle, steps=steps, tolerance=1e-7)
    stress, weave = quasistatic.frame_stress(result), table.model.fabric.weave
    side = [2 * cells * w for w in weave.w]
    volume = side[0] * side[1] * weave.thickness
    slope = np.sqrt(side[0] * side[1]) * np.cos(0.25 * np.pi + 0.5 * result.prescribed)
    return {"gamma": result.prescribed, "stress": stress, "force": stress * volume / slope, "side": np.array(side)}


def bias_load(*, cloth: str, steps: int = 10) -> RunResult:
    """Load [N] of the bias extension test over its elongation [m]."""
    from validation.published.bias_extension import cases

    result = cases.run(cloth, steps=steps).result
    return {"moved": result.prescribed, "load": np.abs(result.force(1, 1))}


def edged(
    *, fabric: str, velocity: float, warp: str = "clamped", weft: str = "clamped", radius: float | None = None,
    end_time: float = 800e-6,
) -> RunResult:  # fmt: skip
    """One impact on one ply with given edges.

    Parameters
    ----------
    fabric, velocity [m/s], end_time [s]
    warp, weft : "clamped", "free", or the force [N] up to which the clamp holds each yarn
    radius : [m] of the projectile; None its own
    """
    edge = tuple(side if isinstance(side, str) else Grip(side) for side in (warp, weft))
    shot = Projectile() if radius is None else Projectile(radius=radius)
    chosen = ImpactSetup(
        cloth(fabric), velocity, projectile=shot, edge=edge, end_time=end_time, elements_per_crossover=1,
        history=HistoryRequest(1e-6, (0.0,), (0.0, *OFFSETS)),
    )  # fmt: skip
    result = run_impact(chosen)
    X, Y = result.panel.coordinates()
    nodes, (history,) = result.last[0].nodes, result.histories
    ends = sorted((abs(yarn.offset), yarn.tension[:, -1]) for yarn in history.yarns if yarn.family == "weft")
    return {
        "outcome": result.outcome,
        "residual": result.residual_velocity,
        "t": result.t,
        "v": result.v,
        "z": result.nose_position,
        "energies": result.energies,
        "slip": Y[:, -1] - nodes[:, -1, 1],
        "place": X[:, -1],
        "clock": history.t,
        "edge_offset": np.array([place for place, _ in ends]),
        "edge_tension": np.array([tension for _, tension in ends]),
        "balance": result.energy_error_max,
    }


def yarn_in_shell(*, fabric: str, velocity: float, length: float, end_time: float) -> RunResult:
    """The shell's own lone yarns: straight warp under a shot, in a strip whose weft has next to no mass and stiffness.

    The strip is 12 mm wide with free sides, of which the nose meets the middle half, and `length` [m] long between its
    clamps. Kept are the histories of its middle yarn: instants [s], places and deflections [m].
    """
    given = cloth(fabric, straight=True)
    weft = replace(given.weave.weft, linear_density=1e-3 * given.weave.weft.linear_density)
    given = replace(given, weave=replace(given.weave, weft=weft), shear=None)
    chosen = ImpactSetup(
        given, velocity, opening=(length, 12e-3), edge=("clamped", "free"), cell_model="decoupled",
        end_time=end_time, elements_per_crossover=1, failure=False, history=HistoryRequest(1e-6, (0.0,), (0.0,)),
    )  # fmt: skip
    result = run_impact(chosen)
    (history,) = result.histories
    yarn = history.through("warp")
    return {
        "v": result.v,
        "clock": history.t,
        "X": np.asarray(yarn.X),
        "place": np.asarray(yarn.place),
        "deflection": np.asarray(yarn.deflection),
        "balance": result.energy_error_max,
    }


class _Unguarded(PackSolver):
    """A march that goes on where a guard would end it, unless a number is not finite.

    `problem` is the message of the first guard, `failed_then` the cut yarns of the pack at that moment.
    """

    problem, failed_then = "", None

    def stop(self, message, where, when=None):
        if not self.problem:
            self.problem = f"{message}, at {where}, {when or self.when}"
            self.failed_then = float(self.ply_samples[-1][:, 0].sum()) if self.ply_samples else 0.0
        if "finite" in message:
            super().stop(message, where, when)


def noisy_pack(
    *, fabric: str, velocity: float, plies: int, failure_time: float = 0.0, end_time: float = 400e-6
) -> RunResult:
    """One impact on a pack whose plies push node on node, with no guard that ends it where contact makes energy.

    The arguments are those of `runs.pack`.
    """
    base = ImpactSetup(cloth(fabric), velocity, **THESIS)
    ply = base.panel()
    whole = Pack.stacked(
        ply, plies, gap=ply_gap(ply.fabric, PlyLaw.of(ply.fabric)).value, contact=PlyContact(form="nodes")
    )
    march = _Unguarded(whole, velocity, end_time, interval=1e-6, energy_error_limit=np.inf)
    low_pass(march, failure_time)
    outcome = ""
    try:
        march.run()
    except UnstableError as problem:
        outcome = f"unstable: {problem}"
    balance = march.sample("error") / march.strike_energy
    return {
        "outcome": outcome or march.outcome,
        "problem": march.problem,
        "failed_then": np.nan if march.failed_then is None else march.failed_then,
        "t": march.sample("t"),
        "v": march.sample("v"),
        "z": march.sample("z"),
        "plies": {"cut_yarns": march.ply_sample("cut_yarns")},
        "balance": float(np.nanmax(np.abs(balance))),
    }


# name: (function, rough cost, to begin with the longest)
RUNS = {
    "sections": (sections, 3),
    "frame": (frame, 3),
    "bias_load": (bias_load, 20),
    "edged": (edged, 3),
    "noisy_pack": (noisy_pack, 20),
    "yarn_in_shell": (yarn_in_shell, 3),
}
