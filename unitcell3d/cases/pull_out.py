"""One yarn pulled through a crossover under transverse load, with friction: the threshold at which it slips.

The crossing yarn is stretched by the displacement d of its ends, which presses the yarns together; then the other yarn
is moved along its axis, from sticking into full sliding, while d is held (`model.pull_out`). P is the axial force that
it takes from the crossing yarn. The threshold T_f is P where the share of Coulomb's limit that the contact has
mobilised reaches `SLIDING`; F_c is the contact force at that state, not that before the pull: the crossing yarn is
drawn sideways by P and its tension rises. The law T_f = c0 + mu_eff F_c is fitted to several d
(`fabrics.friction.pull_out`).

P has two parts: the friction, and what the normal pressures take along the axis (P_geometric), which is all that there
is without friction. A path without friction gives the same quantities at the same pull.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fabrics.errors import InputError, UnstableError
from fabrics.fabric import Fabric
from fabrics.friction.pull_out import PullOutLaw
from meshing.crossover import Crossover
from unitcell3d.model.crossover import Numerics
from unitcell3d.model.pull_out import PullLoad, PullOutModel
from unitcell3d.solver import path_following
from unitcell3d.solver import record as solver_record
from unitcell3d.solver.record import Hook, Record

MEANINGS = {
    "path": "[-] share of the path",
    "load": "[-] number of the transverse load",
    "d1": "[m] end displacement of the warp, per end",
    "d2": "[m] the same of the weft",
    "pull": "[m] displacement of the pulled yarn along its axis",
    "T1": "[N] tension of the warp, of a pulled yarn at the end that is pulled",
    "T2": "[N] tension of the weft, likewise",
    "P": "[N] axial force that the pulled yarn takes from the crossing yarn",
    "P_geometric": "[N] the part of it that normal pressures take",
    "F_c": "[N] contact force",
    "mobilised": "[-] share of Coulomb's limit that is mobilised, 1 in full sliding",
    "d_c": "[m] compression of one yarn, half of the loss of h1 + h2",
    "deepest": "[m] largest penetration",
    "iterations": "[-] tangents factorised",
    "seconds": "[s] wall time",
}
SLIDING = 0.999  # share of Coulomb's limit from which on the yarn slides
LOADS = (0.25, 0.5, 0.75, 1.0)  # of the largest end displacement of the crossing yarn
PULL = 0.16  # of half the spacing: the crossing yarn gives way sideways before all points slide
ROWS_TO_LOAD, ROWS = 5, 16


def pull_out(
    crossover: Crossover,
    fabric: Fabric,
    displacements: Sequence[float],
    *,
    pulled: int = 0,
    pull: float | None = None,
    numerics: Numerics | None = None,
    rows: int = ROWS,
    hooks: Sequence[Hook] = (),
) -> Record:
    """Pull one yarn through the crossover at each of several end displacements of the crossing yarn.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover, a whole one
    fabric : Fabric
    displacements : (n,) [m] of each end of the crossing yarn
    pulled : 0 pulls the warp, 1 the weft
    pull : [m] displacement along the axis at the end; `PULL` times half the spacing along the yarn if not given
    numerics : Numerics with the friction
    rows : states along the pull
    hooks : called as hook(share of all paths, row) after each row

    Returns
    -------
    Record of all paths one after the other, with the meanings `MEANINGS`; its `failed` is that of the first that ended
    early, after which no other is begun

    Raises
    ------
    InputError : no displacement, one that is not positive, or a pull that is not
    """
    given = [float(value) for value in displacements]
    if not given or not all(np.isfinite(value) and value > 0 for value in given):
        raise InputError(key="displacements", value=tuple(given), allowed="at least one positive length")
    pull = PULL * fabric.weave.w[pulled] if pull is None else float(pull)
    if not 0 < pull < np.inf:
        raise InputError(key="pull", value=pull, allowed="positive")
    numerics = Numerics() if numerics is None else numerics
    points = np.asarray(crossover.points, float)
    found, failed, x = [], "", points
    for number, value in enumerate(given):
        model = PullOutModel(crossover, fabric, numerics, pulled)
        d = (0.0, value) if pulled == 0 else (value, 0.0)
        loads = [PullLoad(), PullLoad(d), PullLoad(d, pull)]
        shift = lambda share, row, number=number: [hook((number + share) / len(given), row) for hook in hooks]  # noqa: E731
        one = path_following.follow(
            model, loads, _row(model, number), rows=[ROWS_TO_LOAD, rows], hooks=[shift]
        )  # fmt: skip
        found += one.rows
        x, failed = one.x, one.failed
        if failed:
            break
    facts = {"pulled": pulled, "friction": numerics.friction, "loads": len(given), "pull": pull}
    return Record(
        solver_record.columns(found), MEANINGS, x - points, fabric.name, "pull-out", failed, facts
    )  # fmt: skip


def displacements(fabric: Fabric, pulled: int) -> tuple[float, ...]:
    """[m] end displacements of the crossing yarn, `LOADS` times those at which its crimp would be taken up if it were
    not compressed and the pulled yarn had none."""
    crossing = 1 - pulled
    largest = fabric.weave.w[crossing] * fabric.weave.yarns[crossing].crimp
    return tuple(share * largest for share in LOADS)


def _row(model, number):
    rest = model.heights(model.points)

    def row(state, load):
        x = model.positions(state.q, load)
        T1, T2 = model.tensions(state.forces)
        mobilised = model.surfaces.mobilised_friction(x, model.numerics)
        return {
            "load": number,
            "d1": load.d[0],
            "d2": load.d[1],
            "pull": load.pull,
            "T1": T1,
            "T2": T2,
            "P": model.axial_force(state.forces),
            "P_geometric": model.geometric_force(x),
            "F_c": state.contact,
            "mobilised": mobilised,
            "d_c": 0.5 * (rest.sum() - model.heights(x).sum()),
            "deepest": model.surfaces.deepest,
        }

    return row


def thresholds(record: Record) -> tuple[np.ndarray, np.ndarray]:
    """(F_c, T_f), each (n,) [N], of the transverse loads at which the yarn came to slide.

    Between the two rows about `SLIDING` forces are interpolated. Without friction, T_f is the largest P of each load.
    """
    found = []
    for number in np.unique(record["load"]):
        of = (record["load"] == number) & (record["pull"] > 0)
        P, F_c, share = (record[key][of] for key in ("P", "F_c", "mobilised"))
        if not P.size:
            continue
        if record.facts["friction"] == 0:
            row = int(np.argmax(P))
            found.append((F_c[row], P[row]))
            continue
        if share.max() < SLIDING:
            continue
        last = int(np.argmax(share >= SLIDING))
        first = max(last - 1, 0)
        part = 1.0 if last == 0 else (SLIDING - share[first]) / (share[last] - share[first])
        found.append(tuple(column[first] + part * (column[last] - column[first]) for column in (F_c, P)))
    F_c, T_f = np.array(found).reshape(-1, 2).T
    return F_c, T_f


def fit(record: Record, mesh: str = "") -> PullOutLaw:
    """The law of the thresholds of a record.

    Parameters
    ----------
    record : of `pull_out`
    mesh : its size, for the provenance

    Raises
    ------
    UnstableError : the yarn slid at fewer than two loads
    """
    F_c, T_f = thresholds(record)
    if F_c.size < 2:
        raise UnstableError(
            f"the yarn slid at {F_c.size} of {record.facts['loads']} transverse loads; a fit needs two",
            where=f"largest share of Coulomb's limit {record['mobilised'].max():.3g}",
            when=f"pull {1e6 * record.facts['pull']:.4g} um",
        )
    yarn = ("warp", "weft")[int(record.facts["pulled"])]
    provenance = f"3D crossover of {record.fabric}, {yarn} pulled" + (f", {mesh} mesh" if mesh else "")
    return PullOutLaw.fit(F_c, T_f, friction=float(record.facts["friction"]), provenance=provenance)
