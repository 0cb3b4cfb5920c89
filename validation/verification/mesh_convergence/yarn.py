"""python -m validation.verification.mesh_convergence.yarn [--elements 1 2 3] [--page docs/reports/convergence.md]

Where the limits of S-726, S-727, S-731 converge slowly: the tension of the weft's lines at the middle of the nose, from
yarn to yarn, on several meshes at one velocity and one instant, shortly before the first yarn fails; failure is off.
That yarn is the same on every mesh, beside the edge of the nose. Its tension is the mean over its width, which n lines
sample: with one line a yarn, as in the thesis, it is the line's own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import catalogue
from shellfabric.cloth.failure_kernels import WEFT, yarn_tension
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.solver.pack_solver import PackSolver
from validation.program import program

if TYPE_CHECKING:
    from fabrics.fabric import Fabric

# [m/s], [s]: just before the first yarn fails, and which that is, counted from the one through the middle
SHOTS = {"S-726": (118.0, 223e-6, 2), "S-727": (124.0, 163e-6, 2), "S-731": (112.0, 270e-6, 3)}
_SHOWN = 5  # crossovers


@dataclass(frozen=True)
class Across:
    """Tension across the weft yarns on one mesh.

    Parameters
    ----------
    fabric : name
    elements : a crossover, along each side
    place : (n,) [crossovers] of the lines from the middle
    tension : (n,) [N] of the lines, the mean over the crossover next to the middle
    number : of the yarn that fails first, from the middle
    yarn : [N] tension of that yarn, as failure has it
    edge : (begin, end) [crossovers] of the rounding of the nose's edge
    """

    fabric: str
    elements: int
    place: np.ndarray
    tension: np.ndarray
    number: int
    yarn: float
    edge: tuple[float, float]

    @property
    def middle(self) -> float:
        """[N] tension of the line through the middle of the yarn that fails first."""
        return float(self.tension[self.number * self.elements])


def across(fabric: Fabric, velocity: float, time: float, number: int, n: int, **setup: Any) -> Across:
    """Tension across a Fabric's weft yarns `time` [s] after a strike at `velocity` [m/s], n elements a crossover."""
    panel = replace(ImpactSetup(fabric, velocity, **setup).panel(), elements_per_crossover=n, failure=False)
    march = PackSolver(panel, velocity, time, interval=0.25 * time).run()
    const, state, shot = march.const, march.state, panel.projectile
    rows = state.T[WEFT][: (const.ni + 1) * const.row_stride].reshape(-1, const.row_stride)
    count, pitch = _SHOWN * n + 1, panel.spacing[0] * n
    return Across(
        fabric.name, n, np.arange(count) / n, rows[:count, :n].mean(axis=1),
        number, float(yarn_tension(const, state, WEFT, number * n, 0)),
        ((shot.radius - shot.edge_radius) / pitch, shot.radius / pitch),
    )  # fmt: skip


def main(*, elements: Sequence[int] = (1, 2, 3), page: Path = Path("docs/reports/convergence.md")) -> None:
    from validation.verification.mesh_convergence.pictures import yarns

    found = []
    for name, shot in SHOTS.items():
        for n in elements:
            found.append(across(catalogue.load(name).with_effective_density(), *shot, n))
            print(f"{name} {n}: line {found[-1].middle:.1f} N, yarn {found[-1].yarn:.1f} N", flush=True)
    yarns(found, page.parent / "figures" / "convergence-yarn.png")


if __name__ == "__main__":
    program(main, elements="along a crossover", page="beside which the picture goes")
