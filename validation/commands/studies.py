"""What `weavecell cost-accuracy` and `weavecell stability` share: run some or all studies of a kind, and write them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from fabrics.errors import InputError
from validation.verification.study import known
from weavecell.results import json_file, progress, provenance


@dataclass(frozen=True)
class Kind:
    """A kind of study.

    Parameters
    ----------
    option : of the command line that names a study, as "--map"
    title : of the progress bar
    units : what a study has many of, "cases" or "points"; its folder of kept results as well
    folder : of results of several studies
    prefix : of the names of pictures, and of the folder of a single study
    study, tables, pictures, page : modules of the package
        study.NAMES; study.load(name); study.run(name, folder, quick=, resume=, report=, ...) -> result with .key
        tables.write(result, folder, made); tables.kept(name, folder); tables.read(study, folder) -> (result, made)
        pictures.draw(result, path); page.write([(result, made)], path, command)
    """

    option: str
    title: str
    units: str
    folder: str
    prefix: str
    command: str
    study: Any
    tables: Any
    pictures: Any
    page: Any

    @property
    def measured(self) -> Path:
        """Folder of the package with the tables of the last run of each study."""
        return Path(str(resources.files(self.study.__package__))) / "measured"


def chosen(kind: Kind, names: Sequence[str], everything: bool, besides: Sequence[str] = ()) -> list[str]:
    """Names of the studies to run.

    Raises
    ------
    InputError : a name of no study, or none is named; `besides` : further names that there are
    """
    there = (*kind.study.NAMES, *besides)
    for name in names:
        known(kind.option, name, there)
    if not names and not everything:
        raise InputError(f"say --all, or which {kind.option}: {', '.join(there)}")
    return list(kind.study.NAMES) if everything else list(names)


def run(
    kind: Kind,
    names: Sequence[str],
    out: Path | None,
    page: Path | None,
    *,
    tell: Callable[[Any], object],
    quick: bool = False,
    resume: bool = False,
    **options: Any,
) -> tuple[list[Any], Path, dict[str, str]]:
    """Run studies one after the other, write their tables and pictures, and print what each found.

    Parameters
    ----------
    names : of `chosen`
    out : folder, or None for the default
    page : Path of a page to write too, or None; renews the tables of the package, from which the page also tells of
        the studies that were run before
    tell : called with each result, to print it
    quick, resume, options : as of study.run

    Returns
    -------
    (results, folder, stamp of provenance)
    """
    out = out or Path("results") / (kind.folder if len(names) > 1 else f"{kind.prefix}-{names[0]}")
    found = []
    for name in names:
        with progress.bar(f"{kind.title}: {name}") as advance:
            report = lambda done, total, advance=advance: advance(done / total, f"{done} of {total} {kind.units}")  # noqa: E731
            found.append(
                kind.study.run(name, out / kind.units / name, quick=quick, resume=resume, report=report, **options)
            )
        kind.pictures.draw(found[-1], out / f"{kind.prefix}-{name}.png")
        kind.tables.write(found[-1], out)
        tell(found[-1])
    stamp = provenance.stamp()
    if page is not None:
        _renew_page(kind, found, page, stamp)
    return found, out, stamp


def finish(kind: Kind, key: str, contents: list, out: Path, page: Path | None, stamp: Mapping[str, str]) -> None:
    """Write the record of a command, {key: contents} with its provenance, and say where everything is."""
    json_file.write(out / f"{kind.folder}.json", {key: contents, "provenance": stamp})
    print(f"written to {out}" + (f" and {page}" if page else ""))


def _renew_page(kind, found, page, stamp):
    load = f"load average {os.getloadavg()[0]:.1f}"
    made = f"version {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}, {stamp['processor']}, {load}."
    for result in found:
        kind.tables.write(result, kind.measured, made)
    there = [
        kind.tables.read(kind.study.load(name), kind.measured)
        for name in kind.study.NAMES
        if kind.tables.kept(name, kind.measured)
    ]
    for result, _ in there:
        path = page.parent / "figures" / f"{kind.prefix}-{result.key}.png"
        if getattr(kind.pictures, "pictured", lambda _: True)(result):
            kind.pictures.draw(result, path)
        else:
            path.unlink(missing_ok=True)
    kind.page.write(there, page, f"weavecell {kind.command} --all --page {page}")
