"""The folder of a result, read: what it holds is compared with its list before anything is taken.

This is the only way to the files of a result. `open_folder` compares the numbers of a folder, its
input and the files that this names, with the digests that were written with them
(`results.file_list`); pictures and pages are for the reader alone. No other module of weavecell may
open the files of a result: the import contracts of pyproject.toml hold it.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.files import parse_toml, read_bytes
from fabrics.base.read_formats import format_of_hdf5, read_hdf5
from weavecell.results import file_list, keys, one_table, run_folder
from weavecell.results.file_list import FileList
from weavecell.results.finding import Answer
from weavecell.results.impact import FORMAT, ImpactRecord
from weavecell.scenes import kept_files

if TYPE_CHECKING:
    from pandas import DataFrame

SCENE = "scene.toml"
HISTORIES = "histories.h5"
SUMMARY = "summary.json"
LAW = "law.json"
MADE_LAW = "provenance.json"  # beside it, of what `calibrate` says of it
# what is computed, and what it was computed from
NUMBERS = ("*.h5", "*.json", "*.csv", *file_list.INPUT)
# the shapes of all instants
SERIES = ("*.pvd", "*/*.vtu", "*.vtu")


class Kind(NamedTuple):
    """A kind of result.

    Parameters
    ----------
    table : of keys.toml, that says what it has
    csv : name of its table; "" of one whose table is its summary
    """

    table: str
    csv: str


# {JSON file: kind of result}; a folder has the first that is there
KINDS = {
    "difference.json": Kind("difference", "difference.csv"),
    "critical-velocity.json": Kind("critical_velocity", "shots.csv"),
    "v50.json": Kind("v50", "shots.csv"),
    "plies.json": Kind("ply_counts", "plies.csv"),
    "runs.json": Kind("runs", "shots.csv"),
    "sweep.json": Kind("sweep", "sweep.csv"),
    "tests.json": Kind("tests", "shots.csv"),
    "compression.json": Kind("compression", "packs.csv"),
    "pull-out.json": Kind("pull_outs", "pull-outs.csv"),
    "shot.json": Kind("shot", "motion.csv"),
    "biaxial.json": Kind("biaxial", "biaxial.csv"),
    "biaxial-fit.json": Kind("biaxial_fit", "tests.csv"),
    LAW: Kind("law", "paths.csv"),
    "surface.json": Kind("surface", "surface.csv"),
    "case.json": Kind("case", "case.csv"),
    "mesh.json": Kind("mesh", ""),
    SUMMARY: Kind("coupon", "coupon.csv"),
}
# {table that several kinds of result may have: table of keys.toml that says what it has}
BESIDE = {"draws.csv": "v50"}
WITHOUT_LIST = f"has no {file_list.NAME}: whether its files were changed cannot be told"


@dataclass(frozen=True)
class ResultFolder:
    """A folder of a result, whose files are those that were written.

    Parameters
    ----------
    folder : that was opened
    listed : FileList of it
    changed : names of the files that are not as they were written, which the user takes all the same
    """

    folder: Path
    listed: FileList = field(default_factory=FileList)
    changed: tuple[str, ...] = ()

    def has(self, name: str) -> bool:
        """Say whether there is a file of a name."""
        return (self.folder / name).is_file()

    def find_kind(self) -> str | None:
        """Find the JSON file that says what kind of result it is; None without one."""
        return next((name for name in KINDS if self.has(name)), None)

    @property
    def is_impact(self) -> bool:
        """Whether the histories are those of an impact, as this version writes them."""
        return self.has(HISTORIES) and format_of_hdf5(self.folder / HISTORIES) == FORMAT

    def read_json(self, name: str) -> dict[str, Any]:
        """Read a JSON file.

        Raises
        ------
        InputError : no such file, it is no table, or a summary of another format
        """
        path = self.folder / name
        allowed = "results of weavecell"
        try:
            content = json.loads(read_bytes(path).decode("utf-8-sig"))
        except (OSError, ValueError, RecursionError) as problem:
            message = f"{allowed} ({problem})"
            raise InputError("is not JSON", file=path, allowed=message) from problem
        if not isinstance(content, dict):
            raise InputError("is no table", file=path, allowed=allowed)
        stated = content.get("format")
        if name == SUMMARY and stated != keys.SUMMARY_FORMAT:
            raise InputError(
                file=path, key="format", value=stated, allowed=repr(keys.SUMMARY_FORMAT)
            )
        return content

    def read_table(self, name: str, table: str = "") -> DataFrame:
        """Read a CSV file, that of a kind of result with all its digits.

        Parameters
        ----------
        name : of the file
        table : of keys.toml, whose columns it has; "" of another file

        Raises
        ------
        InputError : one that cannot be read
        """
        from pandas import read_csv
        from pandas.errors import EmptyDataError, ParserError

        path = self.folder / name
        try:
            files.check_size(path, path.stat().st_size, "text or table")
            if table:
                return one_table.read_csv(path, table)
            return read_csv(path, comment="#")
        except (EmptyDataError, ParserError, UnicodeDecodeError, OSError) as problem:
            raise InputError(f"is not a readable table ({problem})", file=path) from problem

    def read_tables(self) -> dict[str, DataFrame]:
        """Read all CSV files: {name: table}.

        Raises
        ------
        InputError : one that cannot be read
        """
        name = self.find_kind()
        of_kind = dict(BESIDE)
        if name is not None:
            of_kind[KINDS[name].csv] = KINDS[name].table
        tables = {}
        for path in sorted(self.folder.glob("*.csv")):
            tables[path.name] = self.read_table(path.name, of_kind.get(path.name, ""))
        return tables

    def read_impact(self, kind: type[ImpactRecord] = ImpactRecord) -> ImpactRecord:
        """Read the record of an impact, as an ImpactRecord or a class that is derived from it.

        Raises
        ------
        InputError : no histories.h5 of an impact
        """
        return read_record(self.folder / HISTORIES, kind)

    def read_answer(self) -> Answer | None:
        """Read the answer that its summary.json says; None of an impact of an older version."""
        if not self.has(SUMMARY):
            return None
        entry = json.loads(read_bytes(self.folder / SUMMARY)).get("answer")
        return Answer.read(entry) if isinstance(entry, dict) else None

    def read_histories(self, *names: str) -> dict[str, Any]:
        """Read some histories (n,) of an impact of any version: {name: values}.

        Raises
        ------
        InputError : no histories.h5 with these
        """
        path = self.folder / HISTORIES
        stated = format_of_hdf5(path)
        with read_hdf5(path, stated, what="file of histories") as content:
            return {name: content[f"histories/{name}"][:] for name in names}

    def changes_of_scene(self) -> dict[str, Any]:
        """Return {table of scene.toml: what it says}, of tables that name files, with the copies that
        the folder keeps of these.

        Raises
        ------
        InputError : scene.toml, or the list of the copies, is damaged
        """
        path = self.folder / SCENE
        try:
            table = parse_toml(files.read_text(path))
        except ValueError as problem:
            raise InputError(f"is not TOML ({problem})", file=path) from problem
        used = kept_files.use_copies(table, kept_files.read_named(self.folder))
        return {name: used[name] for name in kept_files.KEYS if name in used}


def open_folder(
    folder: FilePath, *patterns: str, changed: bool = False, allowed: str = "a folder of results"
) -> ResultFolder:
    """Open the folder of a result.

    Parameters
    ----------
    folder : that a command or function wrote
    patterns : names of files that are compared beside the numbers, with wildcards
    changed : whether to take files that are not as they were written, which is told; else they are
        refused
    allowed : what is named if there is no such folder

    Raises
    ------
    InputError : no such folder, or files that were changed, cut or lost
    """
    place = Path(folder)
    if not place.is_dir():
        message = "is no folder" if place.exists() else "is not there"
        raise InputError(message, file=place, allowed=allowed)
    listed = FileList.read(place)
    found = ResultFolder(place, listed, tuple(_find_changed(place, listed, patterns)))
    log = logging.getLogger("weavecell")
    if not listed.digests and found.find_kind() is not None:
        log.warning(f"{place} {WITHOUT_LIST}")
    for name in found.changed:
        state = "is not as weavecell wrote it"
        if not found.has(name):
            state = "is missing"
        if not changed:
            way = "the folder as it was written; in Python load(folder, changed=True) takes it as it is"
            raise InputError(state, file=place / name, allowed=way)
        log.warning(f"{place / name} {state}")
    return found


def _find_changed(place, listed, patterns):
    """The names of the numbers that are not what was written last, and of a kind of result that
    weavecell did not write where it wrote others."""
    wrong = []
    for name in listed.damaged(place, [*NUMBERS, *patterns]):
        # the state of a run under way goes when it ends
        if not file_list.matches(name, [run_folder.CHECKPOINTS]):
            wrong.append(name)
    if listed.digests:
        # scene.toml may be the user's own, which a run in its folder leaves as it is
        for name in (*KINDS, HISTORIES):
            if (place / name).is_file() and name not in listed.digests:
                wrong.append(name)
    return wrong


def find_whole(folder: Path, names: Iterable[str], key: str) -> ResultFolder | None:
    """Find the results that a folder holds of the run with a `run_cache.key`; None if it has not
    ended, was unstable, or if a file is missing or not what was written.

    Parameters
    ----------
    names : of the files of the run, with wildcards
    """
    listed = FileList.read(folder)
    if listed.whole != key or listed.damaged(folder, names):
        return None
    found = ResultFolder(folder, listed)
    if found.read_json(SUMMARY)["outcome"] == "unstable":
        return None
    return found


def read_record(path: FilePath, kind: type[ImpactRecord] = ImpactRecord) -> ImpactRecord:
    """Read the file of histories of an impact, as an ImpactRecord or a class that is derived from it.

    Raises
    ------
    InputError : no such file, or one of another format
    """
    with read_hdf5(path, FORMAT) as content:
        return kind.from_hdf5(content)


def name_results(folder: Path) -> str | None:
    """Name what a folder has the results of, with their date; None if it has none that can be read."""
    found = ResultFolder(folder)
    dated: list[tuple[str, str]] = []
    for path in folder.glob("*.json"):
        content: dict[str, Any] = {}
        with suppress(InputError):
            content = found.read_json(path.name)
        stamp = content.get("provenance", content)
        if isinstance(stamp, dict) and "date" in stamp:
            title = content.get("title") or content.get("fabric") or path.stem
            dated.append((str(stamp["date"]), str(title)))
    if dated:
        return "{1} of {0}".format(*max(dated))
    return None
