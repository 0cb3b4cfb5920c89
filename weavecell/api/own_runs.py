"""A study of one's own: rows of shots that are drawn, put together and fired, as one table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack

from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from weavecell.answers.own_runs import NAMES, RunsResult, RunTable
from weavecell.api import quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.entrance import public
from weavecell.api.execution import ResumableKeywords
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import StudySize
from weavecell.api.target import resolve_target

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.runs.table import Row


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
class RunsPlan(Plan[RunsResult]):
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
