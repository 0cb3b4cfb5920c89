"""Maps of where each method fails, found by running it.

Folder of `weavecell stability --map NAME`, or `--all`
    stability-NAME.png      the map
    NAME.csv, NAME-edges.csv   one row a point; one row an edge of a default
    stability.json          edges and margins, provenance
    points/NAME/            a file for each point as soon as it is done: `--resume` begins with them
"""

from __future__ import annotations

from dataclasses import asdict
from importlib import resources
from pathlib import Path

from fabrics.errors import InputError
from weavecell.results import json_file, progress, provenance


def stability_command(names, out, *, everything=False, quick=False, page=None, jobs=1, executor="local", resume=False):
    """Run maps, write their tables and pictures to the folder `out`, and print the margins of the defaults.

    Parameters
    ----------
    names : of validation.verification.stability.study.MAPS
    out : folder, or None
    everything : all maps
    quick : fewer points
    page : Path of a page to write too, with its figures in figures/ beside it; renews the tables of the package, from
        which the page also tells of the maps that were run before
    jobs, executor : as of `fabrics.executors.open_executor`
    resume : begin with the points of an interrupted run
    """
    from validation.verification.stability import pictures, study, tables

    known = ", ".join(study.MAPS)
    for name in names:
        if name not in study.MAPS:
            raise InputError(key="--map", value=name, allowed=f"one of {known}")
    if not names and not everything:
        raise InputError(f"say --all, or which --map: {known}")
    names = list(study.MAPS) if everything else names
    out = out or Path("results") / ("stability" if len(names) > 1 else f"stability-{names[0]}")
    maps = []
    for name in names:
        with progress.bar(f"Stability: {name}") as advance:
            maps.append(
                study.run(
                    name, out / "points" / name, quick=quick, jobs=jobs, executor=executor, resume=resume,
                    report=lambda done, total, advance=advance: advance(done / total, f"{done} of {total} points"),
                )
            )  # fmt: skip
        pictures.draw(maps[-1], out / f"stability-{name}.png")
        tables.write(maps[-1], out)
        _tell(maps[-1])
    stamp = provenance.stamp()
    json_file.write(out / "stability.json", {"maps": [_plain(found) for found in maps], "provenance": stamp})
    if page is not None:
        made = f"version {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}, {stamp['processor']}."
        _write_page(maps, page, made)
    print(f"written to {out}" + (f" and {page}" if page else ""))


def _write_page(maps, page, made):
    """Renew the tables of the package and the page, which also tells of the maps that were run before."""
    from validation.verification.stability import page as pages
    from validation.verification.stability import pictures, study, tables

    folder = Path(str(resources.files("validation.verification.stability"))) / "measured"
    for found in maps:
        tables.write(found, folder, made)
    known = [tables.read(study.load(key), folder) for key in study.MAPS if tables.kept(key, folder)]
    for found, _ in known:
        pictures.draw(found, page.parent / "figures" / f"stability-{found.map.key}.png")
    pages.write(known, page, f"weavecell stability --all --page {page}")


def _tell(found):
    counts = ", ".join(f"{found.count(kind)} {kind}" for kind in ("stable", "wrong", "failed"))
    print(f"{found.map.title}: {counts}")
    for edge in found.edges:
        where = f"{found.map.x.name} {found.map.default[0] / found.map.x.unit:g}"
        where += "" if edge.y == found.map.default[1] else f", {found.map.y.label(edge.y)}"
        reach = f"edge at {edge.value / found.map.x.unit:.3g}" if edge.met else "no edge met"
        missed = "" if edge.enough else "  LESS THAN ASKED"
        print(f"  {where}: {reach} {edge.side}, margin {edge.margin:.2f}{missed}")


def _plain(found):
    edges = [
        {key: value for key, value in asdict(edge).items() if key != "beyond"} | {"enough": edge.enough}
        for edge in found.edges
    ]
    counts = {kind: found.count(kind) for kind in ("stable", "wrong", "failed")}
    return {"map": found.map.key, "default": found.map.default, "edges": edges, "points": counts}
