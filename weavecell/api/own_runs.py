"""A study of one's own: rows of shots that are drawn, put together and fired, as one table.

The folder of `run`
    shots.csv, shots.h5  a row a shot: what was varied, what was drawn, and what came of it
    runs.json           how many there are, provenance
    runs/                a file for each finished shot, from which `resume` goes on
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack, overload

from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.answers.result import Result
from weavecell.api import quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.entrance import public
from weavecell.api.execution import ResumableKeywords
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import StudySize
from weavecell.api.target import resolve_target
from weavecell.results import one_table, out_folder

if TYPE_CHECKING:
    from pandas import DataFrame

    from shellfabric.impact.setup import ImpactSetup
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


@explain_keywords(Keywords)
@public
def draw(
    target: Fabric | FilePath | ImpactSetup | None,
    shots: int = 16,
    *,
    velocity: float | str | None = None,
    seed: int = 1,
    labels: Mapping[str, Any] | None = None,
    **options: Unpack[Keywords],
) -> RunTable:
    """Draw the rows of a study of one's own: shots at panels of which all that nobody gave is drawn, as
    `v50` draws them.

    Parameters
    ----------
    target : a set-up of `setup`, an input file of a ply or pack, or a Fabric, its name or file
    shots : number of rows
    velocity : [m/s] of the strike of a fabric, or a text such as "92.5 m/s"
    seed : of all that is drawn: rows of one seed share what both of them draw, row for row
    labels : {name: value} of what is varied, which become columns of the table
    **options : keywords of `setup` beside a fabric

    Returns
    -------
    RunTable, a row a shot

    Raises
    ------
    InputError : as `v50`

    Examples
    --------
    >>> table = wc.draw("S-728", 3, velocity="90 m/s", opening="30 mm", labels={"side": "30 mm"})
    >>> wc.run(table).shots["side"].tolist()
    ['30 mm', '30 mm', '30 mm']
    """
    from weavecell.runs import table

    named = {} if labels is None else labels
    texts = isinstance(named, Mapping) and all(isinstance(name, str) for name in named)
    if not texts or labels == {}:
        raise InputError(key="labels", value=labels, allowed='a dict such as {"nose": "sphere"}')
    count = quantities.read_whole(shots, "shots", 1)
    first = quantities.read_whole(seed, "seed", 0)
    panel = resolve_target(target, options, "shot", velocity, function="draw", one_shot=True)
    setup = panel.resolved().setup
    with panel.name_problems():
        return RunTable(tuple(table.draw(setup, count, seed=first, **named)))


@dataclass(frozen=True)
class RunsPlan(Plan["RunsResult"]):
    """Rows that are about to be fired.

    Parameters
    ----------
    rows : tuple of Row
    """

    files = NAMES

    rows: tuple[Row, ...]

    @property
    def inputs(self) -> Sequence[object]:
        """Nothing that marks the folder: each row is found by itself."""
        return [("rows",)]

    def forecast(self) -> StudySize:
        """Forecast the CPU time of all rows."""
        sizes: dict[int, list[Any]] = {}
        for row in self.rows:
            sizes.setdefault(id(row.setup), [row.setup, 0])[1] += 1
        parts = [
            StudySize.estimate(setup, setup.title, count, 0, drawn=True)
            for setup, count in sizes.values()
        ]
        names = [f"set-up {number}" for number in range(1, len(parts) + 1)]
        return StudySize.add_up(counted(len(self.rows), "shot"), names, parts)

    def run(self, running: Running) -> RunsResult:
        """Fire."""
        from weavecell.runs import table

        with running.count(counted(len(self.rows), "shot")) as part:
            shots = table.run(self.rows, report=part(), **running.cache)
        return running.save(RunsResult(self.rows, tuple(shots)))


@command(RunsPlan)
def run(table: RunTable, *, check: bool = False, **options: Unpack[ResumableKeywords]) -> RunsPlan:
    """Fire the rows of a table that `draw` made.

    Parameters
    ----------
    table : RunTable, of one or several calls of `draw`
    check : run nothing and write nothing: forecast CPU time
    **options : jobs, executor, out and resume

    Returns
    -------
    RunsResult, with a row a shot

    Raises
    ------
    InputError : anything but a table with rows

    Examples
    --------
    >>> slow, fast = (wc.draw("S-728", 1, velocity=v, opening="30 mm") for v in ("30 m/s", "120 m/s"))
    >>> wc.run(slow + fast).shots["outcome"].tolist()
    ['stopped', 'perforated']
    """
    if not isinstance(table, RunTable) or not table.rows:
        raise InputError(key="table", value=table, allowed="a table of draw(...), with rows")
    return RunsPlan(table.rows)


@explain_frozen
@dataclass(frozen=True, repr=False)
class RunsResult(Result):
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

    @out_folder.saving(*NAMES)
    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of the module to a folder."""
        from fabrics.base import files
        from weavecell.results import json_file, provenance

        folder = Path(out)
        files.write(folder / "shots.csv", self.to_csv())
        one_table.write_hdf5(self.shots, folder / "shots.h5", self.kind)
        content = {"format": "weavecell runs 1", **self.summary(), "answer": self.answer.entry()}
        json_file.write(folder / "runs.json", content | {"provenance": provenance.stamp()})

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        ended = ", ".join(f"{count} {outcome}" for outcome, count in self.outcomes.items())
        return [f"{self.title}: {ended}"]
