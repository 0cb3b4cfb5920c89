"""What studies say of an answer beside its numbers: what moves it, and that its outcomes differ."""

from __future__ import annotations

from dataclasses import dataclass

DEPENDS = "depends"  # outcome of shots that differ


@dataclass(frozen=True)
class Mover:
    """What moves an answer.

    Parameters
    ----------
    what : in a few words
    settle : what to measure, give or run, with options as the command line names them
    moved : [m/s] by which it alone moves the answer; None if that was not computed
    """

    what: str
    settle: str = ""
    moved: float | None = None

    def __str__(self) -> str:
        if self.moved is None:
            return self.what
        return f"{self.what} {self.moved:.3g} m/s"
