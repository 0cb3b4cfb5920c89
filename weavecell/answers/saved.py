"""A result that is read from its folder."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics.base.frozen import explain_frozen
from weavecell.answers.result import Result, figure, plain
from weavecell.results.finding import Answer

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from weavecell.results.result_folder import ResultFolder


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
