"""Shots of a laboratory, and the statistics of them."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from math import nan
from typing import TYPE_CHECKING, Any

from fabrics import plausible
from fabrics.base import tables
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.base.units import refused
from shellfabric.shot_keys import FASTEST
from weavecell.runs import go_no_go
from weavecell.runs.go_no_go import LimitPosterior, Outcomes
from weavecell.runs.span import Span
from weavecell.studies import lambert_jonas, protocol
from weavecell.studies.lambert_jonas import LambertJonas
from weavecell.studies.protocol import SixShots

if TYPE_CHECKING:
    from pandas import DataFrame

LOG = logging.getLogger("weavecell")
VELOCITY = "velocity"
OUTCOME = "outcome"
RESIDUAL = "residual velocity"
STOPPED = "stopped"
PERFORATED = "perforated"
OUTCOMES = dict.fromkeys(("pp", "partial", "partial penetration", STOPPED), STOPPED)
OUTCOMES |= dict.fromkeys(("cp", "complete", "complete penetration", PERFORATED), PERFORATED)
OUTCOMES |= dict.fromkeys(("stop", "stops", "no perforation"), STOPPED)
OUTCOMES |= dict.fromkeys(("perforation", "through"), PERFORATED)
# beginning of a heading that asks for one outcome: (the outcome of yes, of no)
ASKED = {
    **dict.fromkeys((PERFORATED, "perforation", "complete"), (PERFORATED, STOPPED)),
    **dict.fromkeys((STOPPED, "partial"), (STOPPED, PERFORATED)),
}
YES = dict.fromkeys(("1", "yes", "y", "true"), True)
YES |= dict.fromkeys(("0", "no", "n", "false"), False)
# tests that come again one after the other are a list that was pasted, not chance
FEWEST_PASTED = 3


def read(path: FilePath) -> DataFrame:
    """Read the shots of a laboratory from a table of users (`fabrics.base.tables`), a row a shot.

    The columns are "velocity [m/s]", "outcome" (PP, partial or stopped; CP, complete or perforated)
    and, where it was measured, "residual velocity [m/s]", in any unit of speed. In place of the outcome a
    column "perforated" or "stopped" may have yes or no, 1 or 0.

    Returns
    -------
    DataFrame with "velocity" [m/s], "outcome" ("stopped" or "perforated") and "residual velocity"
    [m/s], 0 of a stopped projectile, NaN where it was not measured

    Raises
    ------
    InputError : one line naming the file, the line, the value and what is allowed
    """
    from pandas import DataFrame

    found = tables.read_table(
        path,
        {VELOCITY: "m/s", OUTCOME: tables.WORDS, RESIDUAL: "m/s"},
        what="a table of tests, CSV",
        example=f"{VELOCITY} [m/s]",
        optional=(RESIDUAL,),
    )
    if not found.lines:
        raise InputError("has no shot", file=path, allowed="a heading and one row for each shot")
    table = DataFrame(_shot_of(found, line, cells) for line, cells in found.rows())
    slowest = plausible.Number(VELOCITY, "strike_velocity", float(table[VELOCITY].min()))
    for note in plausible.judge([slowest], file=path):
        LOG.info(f"note: {path}: {note}")
    return table


def _shot_of(table, line, cells):
    """{column: value} of a line of a Table, in SI."""

    def refusal(name, allowed):
        return refused(cells[name], allowed, file=table.path, key=f"{line}, {name}")

    def speed(name):
        value = table.number(line, name, cells[name])
        if name == RESIDUAL and value < 0:
            raise refusal(name, "at least 0: a projectile that rebounds has stopped")
        if name == VELOCITY and not value > 0:
            raise refusal(name, "above 0")
        if not value <= FASTEST:
            raise refusal(name, f"at most {FASTEST:g} m/s, as projectile.strike_velocity")
        return value

    outcome = _outcome(cells[OUTCOME].lower(), table.headings[OUTCOME].lower().strip("# "), refusal)
    velocity = speed(VELOCITY)
    residual = nan
    if cells.get(RESIDUAL):
        residual = speed(RESIDUAL)
    if outcome == "stopped" and residual > 0:
        raise refusal(RESIDUAL, "left out of a stop, or 0")
    if residual > velocity:
        raise refusal(RESIDUAL, f"at most the velocity of the strike, {cells[VELOCITY]}")
    return {
        VELOCITY: velocity,
        OUTCOME: outcome,
        RESIDUAL: residual if outcome == "perforated" else 0.0,
    }


def _outcome(word, heading, refusal):
    """Return the outcome that a cell says, with yes and no of a heading that asks for one."""
    if word in OUTCOMES:
        return OUTCOMES[word]
    asked = [outcomes for begin, outcomes in ASKED.items() if heading.startswith(begin)]
    if asked and word in YES:
        return asked[0][0 if YES[word] else 1]
    allowed = " or ".join(OUTCOMES)
    if word in YES:
        allowed += (
            f'; {word} stands below a heading that says of what, "{PERFORATED}" or "{STOPPED}"'
        )
    raise refusal(OUTCOME, allowed)


@dataclass(frozen=True)
class ReducedTests:
    """Tests of a laboratory and the statistics of them alone.

    Parameters
    ----------
    table : DataFrame, a row a test: velocity, outcome and residual velocity
    posterior : LimitPosterior of the tests; None where they determine no V50
    six_shots : V50 of six of the tests
    lambert_jonas : fit to the residual velocities
    reason : why there is no V50; "" where there is one
    """

    table: DataFrame
    posterior: LimitPosterior | None
    six_shots: SixShots
    lambert_jonas: LambertJonas
    reason: str = ""

    def summary(self) -> dict[str, Any]:
        """Return all of it as plain numbers, keys with their units."""
        return {
            "tests": len(self.table),
            "confidence": go_no_go.CONFIDENCE,
            **self._velocities_summary(),
            **{f"tested_{name}": value for name, value in self.six_shots.summary().items()},
            "lambert_jonas_tested": asdict(self.lambert_jonas),
        }

    @property
    def v50(self) -> float:
        """[m/s] that half of the shots pass; NaN where the tests do not determine it."""
        if self.posterior is None:
            return nan
        return self.posterior.velocities["V50"].value

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is doubtful of the tests: exchanged outcomes, a list that was pasted several times."""
        rows = [tuple(row) for row in self.table.fillna(-1.0).itertuples(index=False)]
        return tuple(filter(None, [self.six_shots.doubt, doubt_repeats(rows)]))

    def _velocities_summary(self):
        names = [f"V{100 * level:.0f}" for level in go_no_go.LEVELS]
        spans = dict.fromkeys(names, Span(nan, nan, nan))
        if self.posterior is not None:
            spans = self.posterior.velocities
        numbers: dict[str, Any] = {}
        for name, span in spans.items():
            numbers[f"tested_{name.lower()}_m_s"] = span.value
            numbers[f"tested_{name.lower()}_interval_m_s"] = [span.low, span.high]
        return numbers

    def words(self) -> str:
        """Write V50, V10 and V90 with their intervals, or why there are none."""
        if self.posterior is None:
            return f"V50 not determined: {self.reason}"
        return self.posterior.words()

    def lines(self, file: str) -> list[str]:
        """Write the lines that are printed of the tests in a file."""
        return [
            f"tests, {file}: {self.words()}",
            f"tests: {self.six_shots.words()}",
            f"tests, Lambert-Jonas: {self.lambert_jonas.words()}",
        ]


def doubt_repeats(rows: Sequence[object]) -> str:
    """Say that a list of tests is a shorter one several times over, as by pasting; else ""."""
    count = len(rows)
    for length in range(FEWEST_PASTED, count // 2 + 1):
        if count % length == 0 and list(rows) == list(rows[:length]) * (count // length):
            return f"the {counted(count, 'test')} are the same {counted(length, 'test')} {count // length} times"
    return ""


def reduce(tests: DataFrame) -> ReducedTests:
    """Compute the statistics of tests that `read` returns."""
    table = tests.rename(
        columns={
            VELOCITY: "strike_velocity_m_s",
            OUTCOME: "tested",
            RESIDUAL: "tested_residual_velocity_m_s",
        }
    )
    velocities = table["strike_velocity_m_s"]
    perforated = table["tested"] == "perforated"
    outcomes = Outcomes.of_tests(velocities, perforated)
    posterior, reason = None, f"all {counted(len(table), 'shot')} end alike"
    if outcomes.mixed:
        posterior = go_no_go.fit(outcomes, float(velocities.median()))
        v50, reason = posterior.velocities["V50"].value, ""
        if v50 > FASTEST:
            # of tests whose share of perforations hardly grows: no shot can have it
            allowed = f"{FASTEST:g} m/s at most, as projectile.strike_velocity"
            posterior, reason = None, f"these tests put it at {v50:.0f} m/s; must be {allowed}"
    six_shots = protocol.six_shots(velocities, perforated)
    return ReducedTests(table, posterior, six_shots, _fit(table), reason)


def _fit(table):
    """Lambert-Jonas fit to stops, and to perforations of which the residual velocity is known."""
    shots = table.dropna(subset=["tested_residual_velocity_m_s"])
    residual = shots["tested_residual_velocity_m_s"].where(shots["tested"] == PERFORATED, 0.0)
    fit = lambert_jonas.fit(shots["strike_velocity_m_s"], residual, limit=None)
    through = int((table["tested"] == PERFORATED).sum())
    known = int((shots["tested"] == PERFORATED).sum())
    if fit.reason and known < through:
        reason = f"{through - known} of {counted(through, 'perforation')} have no residual velocity"
        return replace(fit, reason=reason)
    return fit
