"""One crimped yarn alone, pulled straight (thesis section 3.4.3.1, Figures 3-3, 3-4, 3-7).

The closed form is that of fibres without bending: none until the yarn is straight, then (eq. 4-7)

    T = E A_s ((w + d) / (w (1 + crimp)) - 1)    for d > w crimp.

The choices that the thesis compares are here too: how many of the mesh's fibre lines carry bars,
and one-point instead of full integration of the solid, which leaves zero-energy modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.base.record import Record
from fabrics.fabric import Fabric
from fabrics.yarn import Yarn
from meshing.crossover import Crossover
from unitcell3d.assembly import constraints
from unitcell3d.contact.surfaces import SurfacePairs
from unitcell3d.material import solid_law
from unitcell3d.model import submeshes
from unitcell3d.model.crossover import Load, Numerics, YarnsModel, check
from unitcell3d.solver.path_following import Hook, follow


class YarnModel(YarnsModel):
    """One yarn of a meshed crossover, its ends on the weave's two-fold axes.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover
    fabric : Fabric
    family : 0 warp, 1 weft
    bars : number of fibre lines with bars; all if not given
    numerics, integration, failure : as in a `model.crossover.YarnsModel`

    Raises
    ------
    InputError : no such yarn or number of bars
    """

    def __init__(
        self,
        crossover: Crossover,
        fabric: Fabric,
        family: int,
        *,
        bars: int | None = None,
        numerics: Numerics | None = None,
        **choices: Any,
    ) -> None:
        check(crossover, fabric)
        if family not in (0, 1):
            raise InputError(key="yarn", value=family, allowed="0 (warp) or 1 (weft)")
        mesh = submeshes.single_yarn_mesh(crossover, family)
        if bars is not None:
            across, through = mesh.grids[0].shape[1:]
            if bars not in submeshes.line_numbers(across, through):
                odd = (
                    f"0 to {across}, or {across} and an even number more" if through % 2 else "even"
                )
                raise InputError(
                    key="bars", value=bars, allowed=f"{odd}, up to the mesh's {across * through}"
                )
            mesh = submeshes.with_bars(mesh, int(bars))
        self.family = family
        self.share = crossover.share
        self.w = crossover.w[family]
        held = constraints.build(
            mesh.grids, len(mesh.points), quarter=crossover.domain == "quarter", families=(family,)
        )
        super().__init__(
            mesh,
            fabric,
            numerics,
            held,
            SurfacePairs(()),
            None,
            copies=(1 / crossover.share, 1.0),
            **choices,
        )

    def height(self, x: FloatArray) -> float:
        """Compute the height [m] of the centreline, the middle of the yarn above or below its
        end."""
        (grid,) = self.crossover.grids
        ends, middle = self._columns()
        return float(abs(np.mean(x[grid[middle], 2]) - np.mean(x[grid[ends], 2])))

    def _columns(self):
        (grid,) = self.crossover.grids
        if self.share < 1:  # a quarter begins at the crossing
            return (-1, 0), (0, 0)
        across = grid.shape[1] // 2
        return (-1, across), (grid.shape[0] // 2, across)


def pull(
    crossover: Crossover,
    fabric: Fabric,
    family: int = 0,
    *,
    strain: float | None = None,
    bars: int | None = None,
    integration: int = solid_law.FULL,
    failure: bool = False,
    numerics: Numerics | None = None,
    rows: int = 25,
    hooks: Sequence[Hook] = (),
) -> Record:
    """Pull one yarn straight and on, to the share `strain` of its end distance, or to the failure
    of its fibres.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover
    fabric : Fabric
    family : 0 warp, 1 weft
    strain : [-] at the end; by default, where the straight yarn is at its failure strain, with
        `failure` 10 % beyond
    bars : number of fibre lines with bars; all if not given
    integration : solid_law.FULL or solid_law.ONE_POINT
    failure : fibres fail
    numerics, rows, hooks : see `path_following.follow`

    Returns
    -------
    Record, with the columns of `recorded.MEANINGS` that belong to a yarn

    Raises
    ------
    InputError : no such yarn, or a value is not allowed
    """
    model = YarnModel(
        crossover,
        fabric,
        family,
        bars=bars,
        integration=integration,
        failure=failure,
        numerics=numerics,
    )
    yarn = fabric.weave.yarns[family]
    crimp = crossover.S0[family] / (2 * model.w) - 1
    if strain is None:
        beyond = 1.0
        if failure:
            beyond = 1.1
        strain = (1 + crimp) * (1 + beyond * yarn.failure_strain) - 1
    if not strain > 0:
        raise InputError(key="strain", value=strain, allowed="positive")

    def at(share):
        d = share * strain * model.w
        return Load((d, 0.0) if family == 0 else (0.0, d))

    # most rows where the yarn becomes taut: steps of strain that grow with the distance from the
    # crimp's end
    shares = [0.0, 1.0]
    if strain > crimp:
        shares.insert(1, crimp / strain)
    facts = {
        "case": f"yarn {('warp', 'weft')[family]}",
        "yarn": family,
        "bars": len(model.fibres.pairs),
        "integration": integration,
        "crimp": crimp,
        "EA": yarn.EA,
    }
    return follow(
        model,
        [at(share) for share in shares],
        lambda state, load: _row(model, yarn, crimp, state, load),
        rows=rows,
        facts=facts,
        hooks=hooks,
    )


def _row(model, yarn, crimp, state, load):
    x = model.positions(state.q, load)
    d = load.d[model.family]
    mean = worst = np.nan
    broken = 0.0
    if len(model.fibres.pairs):
        strains, means = model.fibre_strains(x)
        mean = means[0]
        worst = model.fibres.worst(strains)[0]
        broken = float(np.mean(model.fibres.damage > 0))
    return {
        "d": d,
        "strain": d / model.w,
        "T": model.tensions(state.forces)[model.family],
        "T_taut": taut(yarn, model.w, crimp, d),
        "h": model.height(x),
        "fibre_strain_mean": mean,
        "fibre_strain_max": worst,
        "broken": broken,
        "astray": _astray(model, x),
    }


def taut(yarn: Yarn, w: float, crimp: float, d: float) -> float:
    """Compute the tension [N] at end displacements d [m] in closed form."""
    return float(max(0.0, yarn.EA * ((w + d) / (w * (1 + crimp)) - 1)))


def _astray(model, x):
    """[m] Largest quarter of a second difference of the displacement along the yarn: an hourglass'
    amplitude."""
    (grid,) = model.crossover.grids
    u = (x - model.points)[grid]
    return float(abs(u[2:] - 2 * u[1:-1] + u[:-2]).max()) / 4
