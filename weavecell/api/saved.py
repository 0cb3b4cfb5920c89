"""Results of an earlier run: opened again from their folder, and several in one picture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from weavecell.answers.result import Result, figure, plain
from weavecell.api.entrance import public
from weavecell.api.shots import ShotResult
from weavecell.api.target import read_target
from weavecell.results import finding
from weavecell.results.finding import Answer

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from weavecell.results.result_folder import ResultFolder


@public
def load(folder: FilePath | Result, *, changed: bool = False) -> ShotResult | SavedResult:
    """Open the results of an earlier run, wherever their folder is now.

    The files are compared with the digests that were written with them. A scene that names files of
    your own, such as a fabric, is read with the copies that the folder keeps of them.

    Parameters
    ----------
    folder : that a command or function wrote, its `out`; or a result that was written, whose
        `folder` it is
    changed : take files that were changed since they were written, and say which; else they are
        refused

    Returns
    -------
    ShotResult of an impact: histories, cuts and the shapes at the end; the shapes of other instants
    are in panel.pvd. SavedResult of anything else

    Raises
    ------
    InputError : no such folder, none with results, or files that are missing, cut or changed

    Examples
    --------
    >>> _ = wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us", out="yesterday")
    >>> wc.load("yesterday").outcome
    'in flight'
    """
    from weavecell.results import result_folder

    place = _folder_of(folder) if isinstance(folder, Result) else folder
    found = result_folder.open_folder(
        place, changed=changed, allowed="a folder of results, the out of a run"
    )
    if found.is_impact:
        if not found.has(result_folder.SCENE):
            return cast(ShotResult, found.read_impact(ShotResult))
        scene = str(found.folder / result_folder.SCENE)
        copies = found.changes_of_scene()
        target = read_target(scene, found.folder, "shot", changes=copies)
        return ShotResult.of_folder(found, target.nominal())
    kind = found.find_kind()
    if kind is not None:
        return SavedResult.read(found, kind)
    allowed = f"a folder with one of histories.h5, {', '.join(result_folder.KINDS)}"
    raise InputError(key="folder", value=str(folder), allowed=allowed)


def _folder_of(result: Result) -> Path:
    """Return the folder of a result.

    Raises
    ------
    InputError : it was not written
    """
    if result.folder is None:
        allowed = "a result that was written: with out=..., or by its method save"
        raise InputError(key="folder", value=type(result).__name__, allowed=allowed)
    return result.folder


@explain_frozen
@dataclass(frozen=True, repr=False)
class SavedResult(Result):
    """What a folder has of a result that is no single impact.

    Parameters
    ----------
    folder : that was opened
    name : of the JSON file that has its numbers
    content : of that file
    tables : {name: DataFrame} of all CSV files
    main : name of the table of `to_dataframe`; "" without one

    Examples
    --------
    >>> quick = {"scan": False, "residual_shots": 0, "opening": "50 mm", "tolerance": "20 m/s"}
    >>> _ = wc.critical_velocity("S-720", out="limit", **quick)
    >>> list(wc.load("limit").to_dataframe())[:2]
    ['strike_velocity_m_s', 'residual_velocity_m_s']
    """

    # always given, though a Result has it as None
    folder: Path = field()
    name: str
    content: dict[str, Any]
    tables: dict[str, DataFrame]
    main: str

    @classmethod
    def read(cls, found: ResultFolder, name: str) -> SavedResult:
        """Read the JSON file of a name and all tables of a folder."""
        from weavecell.results.result_folder import KINDS, LAW, MADE_LAW

        content = found.read_json(name)
        if name == LAW and found.has(MADE_LAW):
            # a law says in a text what is doubtful of it; what made it has the list
            content["doubts"] = found.read_json(MADE_LAW).get("doubts", [])
        kind = OF_KINDS.get(KINDS[name].table, cls)
        return kind(found.folder, name, content, found.read_tables(), KINDS[name].csv)

    @property
    def shots(self) -> DataFrame:
        """The table of its shots, a row each; without rows of a result that has none."""
        from pandas import DataFrame

        return self.tables.get("shots.csv", DataFrame())

    @property
    def kind(self) -> str:  # type: ignore[override]
        """Table of results/keys.toml that says what it has."""
        from weavecell.results.result_folder import KINDS

        return KINDS[self.name].table

    @property
    def read_from(self) -> Path:
        """The folder that was opened."""
        return self.folder

    @property
    def title(self) -> str:
        """What the result is called."""
        return self.content.get("title", self.folder.name)

    @property
    def answer(self) -> Answer:
        """What it came to, as it was written."""
        if "answer" in self.content:
            return Answer.read(self.content["answer"])
        return Answer(self.title, "its file says no answer", self.doubts)

    def __str__(self) -> str:
        return super().__str__() if "answer" in self.content else self.details()

    @property
    def outcome(self) -> str:
        """How a test or shots ended; "" of a result without an outcome."""
        return self.content.get("outcome", "")

    @property
    def report(self) -> Path | None:
        """The page of the result, None without one."""
        page = self.folder / "report.html"
        if page.is_file():
            return page
        return None

    @property
    def doubts(self) -> tuple[str, ...]:
        """What was doubtful of the result."""
        found = self.content.get("doubts") or ()
        return (found,) if isinstance(found, str) else tuple(found)

    def summary(self) -> dict[str, Any]:
        """Return the numbers and texts of its JSON file; what is in tables there is in `content`."""
        numbers = {key: value for key, value in self.content.items() if plain(value)}
        if "answer" in self.content:
            numbers = {"answer": self.answer.value} | numbers
        return numbers

    def table(self) -> DataFrame:
        """Return the table of `to_dataframe`, columns with their units."""
        return self._labelled_columns()

    def _columns(self):
        if self.main in self.tables:
            return self.tables[self.main]
        return {key: [value] for key, value in self.content.items() if plain(value)}

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        lines = [self.answer.line, f"read from {self.folder / self.name}"]
        lines += [f"{key}: {value}" for key, value in self.summary().items() if value is not None]
        return lines


class SavedPlies(SavedResult):
    """A SavedResult of `weavecell plies`, with its picture."""

    def plot(self) -> Figure:
        """Draw a matplotlib figure: the share that stops against the number of plies, a panel a fabric."""
        from weavecell.report import pictures_uncertainty

        shares = self.tables["shares.csv"]
        counts = self.tables[self.main]
        return figure(pictures_uncertainty.plies, shares, counts, self.content["sure"])


# {table of keys.toml: class of what is loaded of it}
OF_KINDS = {"ply_counts": SavedPlies}


def overlay(*results: Any) -> Figure:
    """Draw several results in one picture: shots by their velocity, deflection and contact force over
    time; limits and V50 by their shots.

    Parameters
    ----------
    *results : shots of `impact` or `load`; or results with strike and residual velocities

    Raises
    ------
    InputError : nothing, or results that have no picture in common

    Examples
    --------
    >>> shots = [wc.impact("S-720", v, opening="20 mm", end_time="10 us") for v in (100, 150)]
    >>> len(wc.overlay(*shots).axes)
    3
    """
    from weavecell.report import pictures_comparison as pictures

    draw: Callable[..., Any] = pictures.draw_shots
    if all(isinstance(result, ShotResult) for result in results) and results:
        return figure(draw, {_name_of(result, k): result for k, result in enumerate(results, 1)})
    for number, result in enumerate(results, 1):
        if not isinstance(result, Result):
            allowed = "a result, such as of impact, critical_velocity or load(folder)"
            raise InputError(key=f"results[{number - 1}]", value=result, allowed=allowed)
    tables = {}
    for number, result in enumerate(results, 1):
        table = result.to_dataframe()
        strike, residual = (table.get(f"{word}_velocity_m_s") for word in ("strike", "residual"))
        if strike is None or residual is None:
            allowed = (
                "shots, or results with strike and residual velocities, such as limits and V50"
            )
            raise InputError(
                key=f"results[{number - 1}]", value=type(result).__name__, allowed=allowed
            )
        tables[_name_of(result, number)] = strike, residual
    if not tables:
        raise InputError("is missing", key="results", allowed="one result or more")
    return figure(pictures.draw_residuals, tables)


def _name_of(result, number):
    """What a curve is called."""
    folder = getattr(result, "read_from", None)
    if isinstance(result, SavedResult):
        folder = result.folder
    title = Path(folder).name if folder else getattr(result, "title", type(result).__name__)
    return finding.tag(f"{number}: {title}", result.doubts)
