"""What to measure first of what an answer rests on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fabrics.base.frozen import explain_frozen
from weavecell.answers.result import Result
from weavecell.results.finding import Answer

if TYPE_CHECKING:
    from pandas import DataFrame

    from weavecell.runs.measurement import Measurement
LISTED = 3  # measurements that are printed


@explain_frozen
@dataclass(frozen=True, repr=False)
class MeasureFirst(Result):
    """What measurements would leave of an answer; the table has a row a measurement.

    Parameters
    ----------
    title : of the answer
    found : tuple of `weavecell.runs.measurement.Measurement`, what narrows the answer most first
    doubts : of the answer

    Examples
    --------
    >>> found = wc.v50("S-728", shots=8, opening="30 mm", projectile="sphere 5.5 mm")
    >>> wc.measure_first(found).to_dataframe()["quantity"].tolist()
    ['friction between yarns', 'friction on the nose']
    """

    kind = "measure_first"

    title: str
    found: tuple[Measurement, ...]
    doubts: tuple[str, ...] = ()

    @property
    def answer(self) -> Answer:
        """The answer now, and what is left of it once each quantity is known."""
        subject = f"what to measure first: {self.title}"
        if not self.found:
            value = (
                "not determined: all outcomes are alike, or all that limits follow from is given"
            )
            return Answer(subject, value, self.doubts)
        worth = [one for one in self.found if one.is_worth]
        listed = (worth or self.found)[:LISTED]
        now = {one.answer: one.words(one.now) for one in listed}
        said = [f"{name} {words} now" for name, words in now.items()]
        value = ", ".join(said[:2])
        others = len(self.found) - len(listed)
        if not worth:
            value += "; none narrows it by a tenth: fire more shots"
        elif others:
            value += f"; {others} more " + (
                "narrow it less" if len(worth) > LISTED else "by less than a tenth"
            )
        of_several = len(now) > 1
        parts = tuple(one.parts(named=of_several) for one in listed)
        return Answer(subject, value, self.doubts, listed=parts)

    def summary(self) -> dict[str, Any]:
        """Return the answer, and what is measured first."""
        first = self.found[0].quantity if self.found else None
        return {"answer": self.answer.value, "first": first} | self._what_is_doubtful()

    def lines(self) -> list[str]:
        """Write the lines that are printed: each measurement."""
        return [f"{self.answer.value}."] + ["; ".join(one.parts(named=True)) for one in self.found]

    def _items(self) -> Any:
        return self.found

    def table(self) -> DataFrame:
        """Return the table, columns with their units."""
        return self._labelled_columns()

    def _notebook_table(self):
        return self.table()
