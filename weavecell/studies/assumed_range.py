"""Ranges of residual and critical velocity that follow from assumed laws.

A law that no data sheet states is assumed with a range (`fabrics.families`). The shot, or the search of the critical
velocity, is repeated with the soft and the stiff end of each assumed law, in all combinations: two runs for one assumed
law, four for two. Where the crimp was computed from the thickness, the shot is repeated with each end of the thickness
and of the warp's share too, and with each end of an assumed failure length, one at a time and with the nominal laws.
The range is the envelope of these and the nominal run. It is a statement about these runs and no bound, since the
outcome need not be monotonic in a law. How a limit changes with the failure length is said in a sentence too, without
a run (`limit_sensitivity`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

from fabrics import assumed, data_sheet
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError, UnstableError, WeavecellError
from fabrics.fabric import Fabric
from shellfabric.impact import simulation
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel import quality
from weavecell.studies import inputs

NEXT_STEP = 1.05  # first factor of a search that begins at the nominal critical velocity


@dataclass(frozen=True)
class Row:
    """One run: its laws and outcome in words, and the velocity [m/s], None where there is none."""

    laws: str
    outcome: str
    velocity: float | None


@dataclass(frozen=True)
class AssumedRange:
    """Range of a velocity over the assumed laws.

    Parameters
    ----------
    quantity : "residual velocity" or "critical velocity"
    tables : names of what was varied
    rows : tuple of Row, the nominal run first
    """

    quantity: str
    tables: tuple[str, ...]
    rows: tuple[Row, ...]

    @property
    def low(self) -> float:
        """[m/s]"""
        return min(row.velocity for row in self.rows if row.velocity is not None)

    @property
    def high(self) -> float:
        """[m/s]"""
        return max(row.velocity for row in self.rows if row.velocity is not None)

    def words(self) -> str:
        """The range in one line."""
        outcomes = sorted({row.outcome for row in self.rows if row.outcome})
        tables = ", ".join(self.tables[:-1]) + (" and " if self.tables[1:] else "") + self.tables[-1]
        over = f"over the assumed range of {tables}"
        if outcomes == ["stopped"]:
            return f"stopped in all {len(self.rows)} runs {over}"
        more = f"; {' or '.join(outcomes)}" if outcomes else ""
        ordered = sorted((row.velocity, row.laws) for row in self.rows if row.velocity is not None)
        return (
            f"{self.quantity} {self.low:.1f} to {self.high:.1f} m/s {over} "
            f"(lowest: {ordered[0][1]}; highest: {ordered[-1][1]}){more}"
        )

    def summary(self) -> dict:
        """As plain types."""
        return {
            "quantity": self.quantity,
            "assumed": list(self.tables),
            "low_m_s": self.low,
            "high_m_s": self.high,
            "runs": [{"laws": r.laws, "outcome": r.outcome, "velocity_m_s": r.velocity} for r in self.rows],
        }


def limit_sensitivity(fabrics: Iterable[Fabric]) -> str:
    """How a limit changes over the range of the failure length, in a sentence; "" where no fabric assumes it."""
    if not any("failure_length" in fabric.assumed for fabric in fabrics):
        return ""
    length = data_sheet.entries()["failure_length"]
    changes = [
        f"{100 * ((length.low / length.value) ** one.value - 1):+.0f} to "
        f"{100 * ((length.high / length.value) ** one.value - 1):+.0f} % (power {one.value:g}, {name})"
        for name, one in inputs.table("limit_exponent").items()
    ]
    return (
        f"The failure length of {1e3 * length.value:g} mm is assumed: over its range of {1e3 * length.low:g} to "
        f"{1e3 * length.high:g} mm the limit changes by about {' or '.join(changes)}."
    )


def with_ends(setup: ImpactSetup, choice: bool | str) -> ImpactSetup | None:
    """The set-up whose range is computed, None where it has no ends, by a choice of True, False and "laws", all but the
    ends of the failure length; InputError: another choice."""
    if choice not in (True, "laws", False):
        raise InputError(key="assumed_range", value=choice, allowed='True, False or "laws"')
    if choice == "laws":
        setup = replace(setup, fabric=assumed.given(setup.fabric, "failure_length"))
    return setup if choice and corners(setup.fabric, setup.laws) else None


def corners(
    fabric: Fabric, laws: tuple[CompressionLaw, CompressionLaw] | None
) -> dict[str, tuple[Fabric, tuple[CompressionLaw, CompressionLaw] | None]]:
    """{words: (fabric, laws)} of all combinations of the ends of assumed laws, and of each end of an assumed crimp and
    failure length.

    Empty where nothing is assumed.

    Parameters
    ----------
    fabric : Fabric, completed by `fabrics.assumed`
    laws : (warp, weft) that it is run with; they carry the range of an assumed solid law
    """
    shears = {f"trellis {end}": changed for end, changed in assumed.shear_ends(fabric).items()} or {"": fabric}
    pairs: dict = {"": laws}
    if laws is not None and laws[0].assumed_range is not None:
        ends = [law.ends() or dict.fromkeys(("soft", "stiff"), law) for law in laws]
        pairs = {f"yarns {end}": (ends[0][end], ends[1][end]) for end in ("soft", "stiff")}
    ends_of_laws = {
        ", ".join(filter(None, names)): (shears[names[0]], pairs[names[1]]) for names in product(shears, pairs)
    }
    ends_of_laws.pop("", None)
    others = assumed.crimp_ends(fabric) | assumed.failure_length_ends(fabric)
    return ends_of_laws | {name: (changed, laws) for name, changed in others.items()}


def varied(fabric: Fabric, laws: tuple[CompressionLaw, CompressionLaw] | None) -> tuple[str, ...]:
    """What `corners` varies, in words."""
    solid = laws is not None and laws[0].assumed_range is not None
    return (
        *(("the trellis law",) if "shear" in fabric.assumed else ()),
        *(("the solid law",) if solid else ()),
        *(("the crimp",) if "crimp" in fabric.assumed else ()),
        *(("the failure length",) if "failure_length" in fabric.assumed else ()),
    )


def residual_velocity(
    setup: ImpactSetup, outcome: str, velocity: float, on_progress: Callable[[float], object] | None = None
) -> AssumedRange | None:
    """Range of the residual velocity of a shot; None where nothing is assumed.

    Parameters
    ----------
    setup : ImpactSetup of the nominal shot
    outcome, velocity : of the nominal shot, [m/s]
    on_progress : called as on_progress(share of the shots) after each
    """

    def shot(changed):
        try:
            result = simulation.run(replace(changed, snapshot_interval=None, history=None))
        except UnstableError:
            return "unstable", None
        return result.outcome + " (doubtful)" * doubtful(result), float(result.residual_velocity)

    return _over_corners("residual velocity", setup, outcome, velocity, shot, on_progress)


def critical_velocity(
    setup: ImpactSetup,
    velocity: float,
    *,
    tolerance: float = 1.0,
    on_progress: Callable[[float], object] | None = None,
    **beside: Any,
) -> AssumedRange | None:
    """Range of the critical velocity of a panel or pack; None where nothing is assumed.

    Parameters
    ----------
    setup : ImpactSetup of any shot at the panel
    velocity : [m/s] nominal critical velocity
    tolerance, beside : as of `ballistic_limit.critical_velocity`
    on_progress : called as on_progress(share of the searches) after each
    """
    from shellfabric.impact import ballistic_limit  # with the kernels of packs, which a shot on one ply does not use

    def search(changed):
        try:
            limit = ballistic_limit.critical_velocity(
                changed.target(), guess=velocity, step=NEXT_STEP, tolerance=tolerance, **beside
            )
        except WeavecellError as problem:
            return str(problem), None
        return "bracket on a doubtful shot" * any(map(doubtful, limit.ends)), float(limit.velocity)

    return _over_corners("critical velocity", setup, "", velocity, search, on_progress)


def doubtful(shot: Any) -> bool:
    """Whether a quality check of a shot is beyond its limit."""
    return quality.status(shot.checks) == quality.DOUBTFUL


def _over_corners(quantity, setup, outcome, velocity, run, on_progress):
    """The AssumedRange of run(set-up) -> (outcome, velocity); None where nothing is assumed."""
    rows, changes = [Row("nominal", outcome, velocity)], corners(setup.fabric, setup.laws)
    for number, (words, (fabric, laws)) in enumerate(changes.items(), 1):
        rows.append(Row(words, *run(replace(setup, fabric=fabric, laws=laws))))
        if on_progress is not None:
            on_progress(number / len(changes))
    return AssumedRange(quantity, varied(setup.fabric, setup.laws), tuple(rows)) if changes else None
