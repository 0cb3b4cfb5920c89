"""What `cost-accuracy` and `stability` share: run some or all studies of a kind, and write them."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from validation.verification.study import known
from weavecell.results import json_file, out_folder, progress, provenance


@dataclass(frozen=True)
class Kind:
    """A kind of study.

    Parameters
    ----------
    modules : function that imports and returns the modules study, tables, pictures, page of a package
        study.NAMES; study.load(name); study.run(name, folder, quick=, resume=, report=, ...) -> result with .key
        tables.write(result, folder, made); tables.kept(name, folder); tables.read(study, folder) -> (result, made)
        pictures.draw(result, path); page.write([(result, made)], path, command)
    command, option : of the command line, and its argument that names studies
    title : of the progress bar
    units : what a study has many of, "cases" or "points"; its folder of kept results as well
    folder : of results of several studies
    prefix : of the names of pictures, and of the folder of a single study
    key : of the results in the record of a command
    tell, plain : what prints a result, and what makes it a dict for the record
    """

    modules: Callable[[], tuple[Any, Any, Any, Any]]
    command: str
    option: str
    title: str
    units: str
    folder: str
    prefix: str
    key: str
    tell: Callable[[Any], object]
    plain: Callable[[Any], dict]


def run(kind: Kind, names: Sequence[str], out: Path | None, *, page: Path | None = None, **options: Any) -> None:
    """Run studies one after the other, write tables, pictures and a record, and print what each found.

    Parameters
    ----------
    names : of studies; none for all
    out : folder, or None for the default
    page : Path of a page to write too, with its figures in figures/ beside it; renews the tables of the package, from
        which the page also tells of the studies that were run before
    options : as of study.run

    Raises
    ------
    InputError : a name of no study
    """
    study, tables, pictures, _ = kind.modules()
    for name in names:
        known(kind.option, name, study.NAMES)
    names = names or study.NAMES
    out = out or Path("results") / (kind.folder if len(names) > 1 else f"{kind.prefix}-{names[0]}")
    out_folder.claim(out, options.get("resume", False))
    found = []
    for name in names:
        with progress.bar(f"{kind.title}: {name}") as advance:
            report = lambda done, total, advance=advance: advance(done / total, f"{done} of {total} {kind.units}")  # noqa: E731
            found.append(study.run(name, out / kind.units / name, report=report, **options))
        pictures.draw(found[-1], out / f"{kind.prefix}-{name}.png")
        tables.write(found[-1], out)
        kind.tell(found[-1])
    stamp = provenance.stamp()
    if page is not None:
        _renew_page(kind, found, page, stamp)
    json_file.write(out / f"{kind.folder}.json", {kind.key: list(map(kind.plain, found)), "provenance": stamp})
    print(f"written to {out}" + (f" and {page}" if page else ""))


def _renew_page(kind, found, page, stamp):
    study, tables, pictures, page_of = kind.modules()
    measured = Path(str(resources.files(study.__package__))) / "measured"
    load = f"load average {os.getloadavg()[0]:.1f}"
    made = f"version {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}, {stamp['processor']}, {load}."
    for result in found:
        tables.write(result, measured, made)
    there = [tables.read(study.load(name), measured) for name in study.NAMES if tables.kept(name, measured)]
    for result, _ in there:
        path = page.parent / "figures" / f"{kind.prefix}-{result.key}.png"
        if getattr(pictures, "pictured", lambda _: True)(result):
            pictures.draw(result, path)
        else:
            path.unlink(missing_ok=True)
    page_of.write(there, page, f"python -m validation {kind.command} --page {page}")
