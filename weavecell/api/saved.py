"""Results of an earlier run: opened again from their folder, and several in one picture."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.files import read_bytes
from weavecell.api.result import Result, figure, plain
from weavecell.api.shots import ShotResult
from weavecell.api.target import read_target
from weavecell.scenes import honoured

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

# what a folder has of one kind of result, the first that is there: its JSON file, and its table
KINDS = {
    "difference.json": "difference.csv",
    "comparison.json": "shots.csv",
    "critical-velocity.json": "shots.csv",
    "v50.json": "shots.csv",
    "sweep.json": "sweep.csv",
    "tests.json": "shots.csv",
    "compression.json": "platen-curve.csv",
    "shot.json": "motion.csv",
    "biaxial.json": "",
    "law.json": "",
    "surface.json": "",
    "case.json": "",
    "mesh.json": "",
    "summary.json": "",
}


def load(folder: FilePath) -> ShotResult | SavedResult:
    """Open the results of an earlier run.

    Parameters
    ----------
    folder : that a command or function wrote, its `out`

    Returns
    -------
    ShotResult of an impact: histories, cuts and the shapes at the end; the shapes of other instants
    are in panel.pvd. SavedResult of anything else

    Raises
    ------
    InputError : no such folder, or none with results

    Examples
    --------
    >>> _ = wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us", out="yesterday")
    >>> wc.load("yesterday").outcome
    'in flight'
    """
    from weavecell.results.impact import FORMAT

    place = Path(folder)
    if not place.is_dir():
        message = "is no folder" if place.exists() else "is not there"
        raise InputError(message, file=place, allowed="a folder of results, the out of a run")
    histories = place / "histories.h5"
    if histories.is_file() and _format_of(histories) == FORMAT:
        scene = place / "scene.toml"
        if scene.is_file():
            return ShotResult.read_folder(place, read_target(str(scene), place, honoured.IMPACT))
        return ShotResult.read(histories)
    for name, table in KINDS.items():
        if (place / name).is_file():
            return SavedResult.read(place, name, table)
    allowed = f"a folder with one of histories.h5, {', '.join(KINDS)}"
    raise InputError(key="folder", value=str(folder), allowed=allowed)


def _read_json(path):
    """The table of a JSON file, of any format and version."""
    allowed = "results of weavecell"
    try:
        content = json.loads(read_bytes(path).decode("utf-8-sig"))
    except (OSError, ValueError, RecursionError) as problem:
        raise InputError("is not JSON", file=path, allowed=f"{allowed} ({problem})") from problem
    if not isinstance(content, dict):
        raise InputError("is no table", file=path, allowed=allowed)
    return content


def _format_of(path):
    """The format that an HDF5 file names; "" without one."""
    import h5py

    with h5py.File(path, "r", locking=False) as file:
        return str(file.attrs.get("format", ""))


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
    ['strike velocity [m/s]', 'outcome']
    """

    folder: Path
    name: str
    content: dict[str, Any]
    tables: dict[str, DataFrame]
    main: str

    @classmethod
    def read(cls, folder: Path, name: str, main: str = "") -> SavedResult:
        """Read the JSON file of a name and all tables of a folder."""
        from pandas import read_csv

        content = _read_json(folder / name)
        tables = {}
        for path in sorted(folder.glob("*.csv")):
            tables[path.name] = read_csv(path, comment="#")
        return cls(folder, name, content, tables, main)

    @property
    def report(self) -> Path | None:
        """The page of the result, None without one."""
        page = self.folder / "report.html"
        if page.is_file():
            return page
        return None

    def summary(self) -> dict[str, Any]:
        """Return the numbers and texts of its JSON file; what is in tables there is in `content`."""
        return {key: value for key, value in self.content.items() if plain(value)}

    def _columns(self):
        if self.main in self.tables:
            return self.tables[self.main]
        return {key: [value] for key, value in self.summary().items()}

    def __str__(self) -> str:
        lines = [f"{self.folder}, {self.name}"]
        lines += [f"{key}: {value}" for key, value in self.summary().items() if value is not None]
        return "\n".join(lines)


def overlay(*results: Any) -> Figure:
    """Draw several results in one picture: shots by their velocity, deflection and contact force over
    time; limits and V50 by their shots.

    Parameters
    ----------
    results : shots of `impact` or `load`; or results with strike and residual velocities

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
        strike, residual = (_column(table, f"{word} velocity") for word in ("strike", "residual"))
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
    folder = getattr(result, "folder", None) or getattr(result, "read_from", None)
    title = Path(folder).name if folder else getattr(result, "title", type(result).__name__)
    return f"{number}: {title}"


def _column(table, words):
    """The column of a table whose name begins with these words, in either way of writing; None
    without one."""
    for name in () if table is None else table:
        if str(name).replace("_", " ").startswith(words):
            return table[name]
    return None
