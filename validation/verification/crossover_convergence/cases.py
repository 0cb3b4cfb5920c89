"""One case of the study: a crossover meshed, formulated and stepped in one way, pulled along the paths, timed.

End conditions that are not the weave's, to be set beside its two-fold axis:

pin           the middle row of the end face is held along the yarn and in height, the rest of the face is free
upright face  the whole face is held along the yarn, its middle row in height
clamped face  the whole face is held along the yarn and in height
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fabrics.checks import IntArray
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError, UnstableError
from fabrics.fabric import Fabric
from meshing import crossover as mesher
from unitcell3d.assembly.constraints import AXIAL, VERTICAL, WIDTH, Constraints, Ties
from unitcell3d.assembly.linear_solver import DirectSolver
from unitcell3d.identify.calibration import samples
from unitcell3d.material import solid_law
from unitcell3d.model.crossover import CrossoverModel, Load, Numerics
from unitcell3d.solver.load_stepping import Steps, solve_load_path
from validation.models.variants import scale_solids

TWO_FOLD, PIN, UPRIGHT, CLAMPED = "two-fold axis", "pin", "upright face", "clamped face"
QUANTITIES = ("T1", "T2", "F_c")
TRIBUTARY, EQUAL = "tributary areas", "equal areas"


@dataclass(frozen=True)
class Case:
    """What is varied; the values here are the study's base.

    Parameters
    ----------
    size : (nx, ny, nz) of the mesh
    domain : "quarter" or "whole"
    section : of the yarns; None for the fabric's own
    tip_thickness_ratio : [-] of the tips; None for the mesher's own
    end : end condition
    bars : `TRIBUTARY` or `EQUAL`: how the fibre area is shared out
    one_point : one-point integration of the solids
    numerics : pairs (field of model.crossover.Numerics, value)
    steps : pairs (field of load_stepping.Steps, value)
    solids : pairs (field of SolidLaw, factor), on both yarns
    """

    size: tuple = (8, 6, 2)
    domain: str = "quarter"
    section: str | None = None
    tip_thickness_ratio: float | None = None
    end: str = TWO_FOLD
    bars: str = TRIBUTARY
    one_point: bool = False
    numerics: tuple = ()
    steps: tuple = ()
    solids: tuple = ()

    @property
    def full_numerics(self) -> Numerics:
        """The Numerics of the case."""
        return replace(Numerics(), **dict(self.numerics))

    @property
    def full_steps(self) -> Steps:
        """The Steps of the case."""
        return replace(Steps(), **dict(self.steps))


def solve(fabric: Fabric, paths: dict[str, tuple[float, float]], case: Case) -> dict[str, Any]:
    """Solve one case.

    Parameters
    ----------
    fabric : Fabric
    paths : {name: (d1, d2)} [m] where each path ends
    case : Case

    Returns
    -------
    dict of plain types: values {"T1, warp only": [N] ...}, law {"a", "b", "rms"} or None, wall and cpu [s], steps,
    tangents factorised, unknowns, failed {path: why it ended early}
    """
    fabric = scale_solids(fabric, dict(case.solids))
    _warm_up(fabric)
    wall, cpu = time.perf_counter(), time.process_time()
    mesh = _mesh(fabric, case)
    failed: dict[str, str] = {}
    histories, unknowns, tangents = {}, 0, 0
    for name, d in paths.items():
        model = _model(mesh, fabric, case)
        with _counted() as taken:
            try:
                history = solve_load_path(model, Load(), Load(d), case=name, steps=case.full_steps)
                failed |= {name: history.failed} if history.failed else {}
                histories[name] = history
            except UnstableError as problem:  # not even at rest
                failed[name] = str(problem)
        unknowns, tangents = model.size, tangents + len(taken)
    seconds = {"wall": time.perf_counter() - wall, "cpu": time.process_time() - cpu}
    return seconds | {
        "values": {
            f"{q}, {name}": float(getattr(h, q)[-1])
            for name, h in histories.items()
            if not h.failed
            for q in QUANTITIES
        },
        "law": None if failed else _law(histories),
        "failed": failed,
        "steps": sum(h.path.size - 1 for h in histories.values()),
        "tangents": tangents,
        "unknowns": unknowns,
    }


class _counted:
    """Within the block, a list that grows by one with each tangent factorised, those of failed steps too."""

    def __enter__(self):
        self._factor, taken = DirectSolver.factor, []

        def factor(solver):
            taken.append(1)
            return self._factor(solver)

        DirectSolver.factor = factor
        return taken

    def __exit__(self, *_):
        DirectSolver.factor = self._factor


def _warm_up(fabric):
    """Compile and load what every case needs, before its clock starts."""
    mesh = mesher.build(fabric, size=(2, 2, 1))
    solve_load_path(CrossoverModel(mesh, fabric), Load(), Load((1e-7, 1e-7)))


def _mesh(fabric, case):
    choices = {} if case.tip_thickness_ratio is None else {"tip_thickness_ratio": case.tip_thickness_ratio}
    mesh = mesher.build(fabric, domain=case.domain, size=case.size, section=case.section, **choices)
    if case.bars == TRIBUTARY:
        return mesh
    return replace(mesh, bar_area=tuple(np.full_like(area, area.mean()) for area in mesh.bar_area))


def _model(mesh, fabric, case):
    integration = solid_law.ONE_POINT if case.one_point else solid_law.FULL
    model = CrossoverModel(mesh, fabric, case.full_numerics, integration=integration)
    if case.end == TWO_FOLD:
        return model
    return _OtherEnds(mesh, fabric, case.full_numerics, integration=integration, end=case.end)


class _OtherEnds(CrossoverModel):
    """A quarter crossover with another end condition."""

    def __init__(self, mesh, fabric, numerics, *, end, **choices):
        self._end = end
        super().__init__(mesh, fabric, numerics, **choices)

    def _build_pattern(self, *contact):
        # before the tangent is laid out for the first time
        self.constraints = held(self.crossover.grids, len(self.points), self._end)
        super()._build_pattern(*contact)


def held(grids: tuple[IntArray, IntArray], n: int, end: str) -> Constraints:
    """Constraints of a quarter crossover with another end condition.

    Parameters
    ----------
    grids : of warp and weft, node numbers (i along, j across, k through), an even number of elements through
    n : number of nodes
    end : `PIN`, `UPRIGHT` or `CLAMPED`
    """
    ties = Ties(n, 2)
    for yarn, grid in enumerate(grids):
        ties.hold(grid[0], AXIAL[yarn])
        ties.hold(grid[:, 0], WIDTH[yarn])
        face = grid[-1]
        row = face[:, face.shape[1] // 2]
        ties.drive[3 * face + AXIAL[yarn], yarn] = 1.0
        ties.hold(row if end == PIN else face, AXIAL[yarn])
        ties.hold(face if end == CLAMPED else row, VERTICAL)
    return ties.done(tuple(grid[-1].ravel() for grid in grids))


def _law(histories):
    pairs = [samples(history) for history in histories.values()]
    try:
        law = CompressionLaw.fit(*(np.concatenate([pair[i] for pair in pairs]) for i in (0, 1)))
    except InputError:
        return None
    return {"a": law.a, "b": law.b, "rms": law.residual_rms}
