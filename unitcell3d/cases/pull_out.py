"""One yarn pulled through a crossover under transverse load, with friction: the threshold at which it
slips.

The transverse load is that of the crossing yarn, stretched by the displacement d of its ends, or of
two platens without friction. Then one yarn is moved along its axis (`model.pull_out`), from sticking
into full sliding, while d or the distance of the platens is held. P is the axial force that it takes
from the crossing yarn; the threshold T_f is P where the share of Coulomb's limit that the contact has
mobilised reaches `SLIDING`, F_c the contact force at that state, not before the pull: the crossing yarn
is drawn sideways by P and its tension rises. T_f = c0 + mu_eff F_c is fitted to several loads
(`fabrics.friction.pull_out`). P has two parts: the friction, and what the normal pressures take along
the axis (P_geometric), which a path without friction gives at the same pull.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fabrics.base.errors import InputError, UnstableError
from fabrics.base.record import Record
from fabrics.fabric import Fabric
from fabrics.friction.pull_out import PullOutLaw
from meshing.crossover import Crossover
from unitcell3d.cases.biaxial_and_platens import MIN_PLATE_GAP
from unitcell3d.model.crossover import Numerics
from unitcell3d.model.pull_out import PullLoad, PullOutModel
from unitcell3d.solver.path_following import Hook, follow
from unitcell3d.solver.recorded import crossover_row

SLIDING = 0.999  # share of Coulomb's limit from which on the yarn slides
# of the largest end displacement of the crossing yarn
LOADS = (0.25, 0.5, 0.75, 1.0)
# of half the spacing: the crossing yarn gives way sideways before all points slide
PULL = 0.16
# of half the spacing between platens, where the crossing yarn has no tension before the pull
PULL_PRESSED = 0.24
ROWS_TO_LOAD = 5
ROWS = 16
ROWS_TO_PRESS = 40  # of the way of the platens to `MIN_PLATE_GAP`


def pull_out(
    crossover: Crossover,
    fabric: Fabric,
    displacements: Sequence[float] = (),
    *,
    pressures: Sequence[float] = (),
    pulled: int = 0,
    pull: float | None = None,
    numerics: Numerics | None = None,
    rows: int = ROWS,
    hooks: Sequence[Hook] = (),
) -> Record:
    """Pull one yarn through the crossover at each of several transverse loads.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover, a whole one
    fabric : Fabric
    displacements : (n,) [m] of each end of the crossing yarn
    pressures : (n,) [Pa] of platens on the area of the cell before the pull, in place of the
        displacements
    pulled : 0 pulls the warp, 1 the weft
    pull : [m] displacement along the axis at the end; `PULL` times half the spacing along the yarn
        if not given, `PULL_PRESSED` times it between platens
    numerics : Numerics with the friction
    rows : states along the pull
    hooks : called as hook(share of all paths, row) after each row

    Returns
    -------
    Record of all paths one after the other; its `failed` is that of the first that ended
    early, after which no other is begun

    Raises
    ------
    InputError : neither displacements nor pressures, both, one that is not positive, or a pull that
        is not
    UnstableError : the platens reach none of the pressures
    """
    given = _transverse(displacements, pressures)
    if pull is None:
        share = PULL
        if len(pressures):
            share = PULL_PRESSED
        pull = share * fabric.weave.w[pulled]
    pull = float(pull)
    if not 0 < pull < np.inf:
        raise InputError(key="pull", value=pull, allowed="positive")
    numerics = numerics or Numerics()
    rest = PullLoad()
    failed = ""
    if len(pressures):
        rest, loaded, failed = _pressed(crossover, fabric, numerics, pulled, given)
    else:
        loaded = [PullLoad((0.0, value) if pulled == 0 else (value, 0.0)) for value in given]
    found = []
    for number, load in enumerate(loaded):
        model = PullOutModel(crossover, fabric, numerics, pulled, platens=len(pressures) > 0)

        def shift(share, row, number=number):
            for hook in hooks:
                hook((number + share) / len(given), row)

        loads = [rest, load, replace(load, pull=pull)]
        row = _row(model, number)
        found.append(follow(model, loads, row, rows=[ROWS_TO_LOAD, rows], hooks=[shift]))
        if found[-1].failed:
            break
    if not found:
        raise UnstableError(failed)
    facts = {
        "case": "pull-out",
        "pulled": pulled,
        "friction": numerics.friction,
        "loads": len(given),
        "pull": pull,
    }
    if len(pressures):
        facts["pressures"] = given
    return _joined(found, facts, failed)


def _joined(records, facts, failed):
    """One Record of several, one after the other, with the first reason why one ended early."""
    last = records[-1]
    names = last.columns
    joined = {name: np.concatenate([record[name] for record in records]) for name in names}
    failed = failed or last.failed
    return replace(last, columns=joined, facts=last.facts | facts, failed=failed)


def _transverse(displacements, pressures):
    """The transverse loads, numbers in m or Pa; InputError as `pull_out`."""
    key = "displacements"
    unit = "length"
    values = displacements
    if len(pressures):
        key = "pressures"
        unit = "pressure"
        values = pressures
    given = np.asarray(values, float).tolist()
    if not given or not 0 < min(given) <= max(given) < np.inf:
        raise InputError(key=key, value=tuple(given), allowed=f"at least one positive {unit}")
    if len(pressures) and len(displacements):
        raise InputError(
            key="pressures", value=tuple(given), allowed="left out if displacements are given"
        )
    return given


def _pressed(crossover, fabric, numerics, pulled, pressures):
    """(load at rest, loads at which platens press by `pressures` [Pa], why not all of them were
    reached or "").

    One path without the pull goes up to the highest pressure; the distances at the others are
    interpolated on it.
    """
    model = PullOutModel(crossover, fabric, numerics, pulled, platens=True)
    assert model.plates is not None
    rest = PullLoad(plates=model.plates.at_rest)
    area = fabric.weave.cell_area

    def mean(row):
        return float(np.mean(row["F_plate"])) / area

    pressed = follow(
        model,
        [rest, replace(rest, plates=MIN_PLATE_GAP * rest.plates)],
        _row(model, 0),
        rows=ROWS_TO_PRESS,
        stop=lambda row: mean(row) / max(pressures),
    )
    met = pressed["F_plate"].mean(axis=1) / area
    at = pressed["plates"]
    reached = [value for value in pressures if value <= met.max() * (1 + 1e-3)]
    loads = [replace(rest, plates=float(np.interp(value, met, at))) for value in reached]
    short = ""
    if len(reached) < len(pressures):
        short = f"platens reach {met.max():.4g} Pa at {at[-1]:.4g} m"
    return rest, loads, pressed.failed or short


def displacements(fabric: Fabric, pulled: int) -> tuple[float, ...]:
    """Compute end displacements [m] of the crossing yarn, `LOADS` times those at which its crimp
    would be taken up if it were not compressed and the pulled yarn had none."""
    crossing = 1 - pulled
    largest = fabric.weave.w[crossing] * fabric.weave.yarns[crossing].crimp
    return tuple(share * largest for share in LOADS)


def _row(model, number):
    def row(state, load):
        x = model.positions(state.q, load)
        mobilised = model.surfaces.mobilised_friction(x, model.numerics)
        return crossover_row(model, state, load) | {
            "load": number,
            "pull": load.pull,
            "P": model.axial_force(state.forces),
            "P_geometric": model.geometric_force(x),
            "mobilised": mobilised,
            "deepest": model.surfaces.deepest,
        }

    return row


def thresholds(record: Record) -> tuple[np.ndarray, np.ndarray]:
    """Compute (F_c, T_f), each (n,) [N], of the transverse loads at which the yarn came to slide.

    Between the two rows about `SLIDING` forces are interpolated. Without friction, T_f is the
    largest P of each load.
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
        part = 1.0
        if last > 0:
            part = (SLIDING - share[first]) / (share[last] - share[first])
        found.append(
            tuple(column[first] + part * (column[last] - column[first]) for column in (F_c, P))
        )
    F_c, T_f = np.array(found).reshape(-1, 2).T
    return F_c, T_f


def fit(record: Record) -> PullOutLaw:
    """Fit the thresholds of a record of `pull_out`.

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
    return PullOutLaw.fit(F_c, T_f)
