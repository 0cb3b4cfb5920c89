"""What a measurement leaves of an answer over drawn shots: from the posterior of these, without a new run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple, Self

from shellfabric.plies.pack_keys import MOST_PLIES
from weavecell.runs.go_no_go import LimitPosterior
from weavecell.runs.span import Span

KNOWN = 0.2  # of the range of a friction that a measurement leaves
WORTH = 0.9  # of the interval that is left at most by a measurement that is worth its while


class Count(NamedTuple):
    """Plies: the least that are sure enough, and the range of the least of the draws."""

    plies: int
    low: int
    high: int

    def words(self) -> str:
        """Write it with its range; a count that none reaches as more than the most."""
        shown = [f"{n}" if n <= MOST_PLIES else f">{MOST_PLIES}" for n in self]
        return f"{shown[0]} ({shown[1]} to {shown[2]})"


@dataclass(frozen=True)
class Measurement:
    """An answer now, and once a quantity is known.

    Parameters
    ----------
    answer : what is narrowed, such as "V50 of a cloth"
    now, then : Span of it, with its interval of 90 %, now and once the quantity is known
    unit : of these, as it is written; "" of a share
    quantity : in words
    known : half of the range that is left of it, SI
    known_unit : of that, as it is written; "" of a friction
    test : that measures it
    command : of the command line that takes it, with its options; "" where only an input file does
    key : of the input file that takes it; "" where only a command does
    """

    answer: str
    now: Span
    then: Span
    unit: str
    quantity: str
    known: float
    known_unit: str
    test: str
    command: str = ""
    key: str = ""

    @property
    def known_words(self) -> str:
        """To what it is known then, such as "± 0.02"."""
        return f"± {self.known:.2g} {self.known_unit}".rstrip()

    @property
    def left(self) -> float:
        """[-] width of the interval then, over that of now."""
        return self.then.half / self.now.half if self.now.half else 1.0

    @property
    def is_worth(self) -> bool:
        """Whether it narrows the interval by more than a tenth."""
        return self.left <= WORTH

    @property
    def reader(self) -> str:
        """What takes the measured value: the command, else the key."""
        return f"`weavecell {self.command}`" if self.command else self.key

    def words(self, span: Span) -> str:
        """Write an answer with its interval."""
        if self.unit == "plies":
            return Count(*map(int, span)).words()
        if not self.unit:
            value, low, high = (f"{100 * end:.0f}" for end in span)
            return f"{value} % ({low} to {high})"
        return span.words(self.unit)

    def parts(self, named: bool) -> tuple[str, str, str]:
        """Write what is known then with what is left, what takes it, and the test; `named` names the answer."""
        answer = f"{self.answer} " if named else ""
        left = f"{self.quantity} to {self.known_words}: {answer}{self.words(self.then)}"
        return left, self.reader, self.test

    @property
    def advice(self) -> str:
        """What to do, and what the interval of the answer is now and then."""
        way = f"measure {self.quantity} to {self.known_words}"
        if self.unit == "plies":
            return f"{way} ({self.reader}): then {self.words(self.then)}"
        scale, unit = (1.0, self.unit) if self.unit else (100.0, "%")
        now, then = (scale * span.half for span in (self.now, self.then))
        return f"{way} ({self.reader}): {self.answer} ± {now:.2g} to ± {then:.2g} {unit}"

    def entry(self) -> dict[str, Any]:
        """Return it as plain types, for a JSON file."""
        return asdict(self) | {"now": list(self.now), "then": list(self.then)}

    @classmethod
    def read(cls, entry: Mapping[str, Any]) -> Self:
        """Return the Measurement of an entry of a JSON file."""
        return cls(**{**entry, "now": Span(*entry["now"]), "then": Span(*entry["then"])})


def measure_known(
    posterior: LimitPosterior | None,
    ranges: Mapping[str, tuple[float, float]],
    find: Callable[[LimitPosterior], Span],
    answer: str,
    unit: str,
) -> list[Measurement]:
    """Return a Measurement of each thing that is common to a cloth and that limits are estimated from.

    Parameters
    ----------
    posterior : None where outcomes are all alike, which tell of none
    ranges : {what is drawn: (low, high)}
    find : the answer of a posterior
    answer, unit : as of Measurement
    """
    from weavecell.studies.unknown import FRICTIONS

    if posterior is None:
        return []
    now = find(posterior)
    found = []
    for name, common in zip(posterior.names, posterior.common):
        if common and name in ranges:
            row, (low, high) = FRICTIONS[name], ranges[name]
            then = find(posterior.narrow(name, KNOWN))
            known = 0.5 * KNOWN * (high - low)
            way = row.test, row.command, row.keys[0]
            found.append(Measurement(answer, now, then, unit, name, known, "", *way))
    return found


def rank(found: Iterable[Measurement]) -> tuple[Measurement, ...]:
    """Sort measurements: what leaves least of its interval first."""
    return tuple(sorted(found, key=lambda one: one.left))
