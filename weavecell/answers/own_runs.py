"""Rows of shots of a study of one's own, and what came of them.

The folder of `run`
    shots.csv, shots.h5  a row a shot: what was varied, what was drawn, and what came of it
    runs.json           how many there are, provenance
    runs/                a file for each finished shot, from which `resume` goes on
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

from fabrics.base.counted import counted
from fabrics.base.frozen import explain_frozen
from weavecell.answers.result import WrittenResult
from weavecell.results import one_table

if TYPE_CHECKING:
    from pandas import DataFrame

    from weavecell.runs.table import Row, Shot

NAMES = ("runs.json", "shots.csv", "shots.h5")


@dataclass(frozen=True)
class RunTable(Sequence["Row"]):
    """Shots that are to be fired, a row each; tables add up.

    Parameters
    ----------
    rows : tuple of `weavecell.runs.table.Row`

    Examples
    --------
    >>> table = wc.draw("S-728", 2, velocity="90 m/s") + wc.draw("S-720", 2, velocity="90 m/s")
    >>> len(table)
    4
    """

    rows: tuple[Row, ...]

    def __add__(self, other: RunTable) -> RunTable:
        return RunTable((*self.rows, *other.rows))

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)

    @overload
    def __getitem__(self, index: int) -> Row: ...
    @overload
    def __getitem__(self, index: slice) -> RunTable: ...
    def __getitem__(self, index: int | slice) -> Row | RunTable:
        if isinstance(index, slice):
            return RunTable(self.rows[index])
        return self.rows[index]

    def __repr__(self) -> str:
        return f"RunTable({counted(len(self.rows), 'shot')})"


@explain_frozen
@dataclass(frozen=True, repr=False)
class RunsResult(WrittenResult):
    """The shots of a table; its DataFrame has a row each.

    Parameters
    ----------
    rows : tuple of Row that were fired
    fired : tuple of `weavecell.runs.table.Shot`, of each

    Examples
    --------
    >>> found = wc.run(wc.draw("S-728", 2, velocity="90 m/s", opening="30 mm"))
    >>> found.shots.shape[0]
    2
    """

    kind = "runs"

    rows: tuple[Row, ...]
    fired: tuple[Shot, ...]

    @property
    def shots(self) -> DataFrame:
        """The table: labels, then what was drawn and what came of it."""
        return self.to_dataframe()

    @property
    def title(self) -> str:
        """How many shots there are."""
        return counted(len(self.fired), "shot")

    def summary(self) -> dict[str, Any]:
        """Return how many shots there are and how they ended."""
        return super().summary() | {"outcomes": self.outcomes}

    @property
    def outcomes(self) -> dict[str, int]:
        """{outcome: number of shots}."""
        found = [shot.outcome for shot in self.fired]
        return {outcome: found.count(outcome) for outcome in dict.fromkeys(found)}

    @property
    def doubts(self) -> tuple[str, ...]:
        """How many shots are doubtful or have no outcome, and by what."""
        from weavecell.runs.passing import count_doubts

        return count_doubts(self.fired)

    def _columns(self):
        from weavecell.runs.table import list_drawn

        labels = dict.fromkeys(name for row in self.rows for name in row.labels)
        varied = {name: [row.labels.get(name) for row in self.rows] for name in labels}
        return varied | one_table.columns(self.fired, self.kind) | list_drawn(self.fired)

    _written = NAMES

    def _write(self, folder):
        from fabrics.base import files
        from weavecell.results import json_file, provenance

        files.write(folder / "shots.csv", self.to_csv())
        one_table.write_hdf5(self.shots, folder / "shots.h5", self.kind)
        content = {"format": "weavecell runs 1", **self.summary(), "answer": self.answer.entry()}
        json_file.write(folder / "runs.json", content | {"provenance": provenance.stamp()})

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        ended = ", ".join(f"{count} {outcome}" for outcome, count in self.outcomes.items())
        return [f"{self.title}: {ended}"]
