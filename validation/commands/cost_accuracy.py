"""Speed against accuracy: the standard scenes, each with every method that the project has for it.

Folder of `weavecell cost-accuracy --scene NAME`, or `--all`
    NAME.csv, NAME-references.csv   one row a method; one row a quantity
    chart-NAME.png                  CPU time against error
    charts.json                     the methods that none beats, references, provenance
    cases/NAME/                     a file for each case as soon as it is done: `--resume` begins with them

Folder of `weavecell cost-accuracy --scene crossover`, the long study of the 3D crossover
    crossover.csv, orders.csv   one row a case; one row a limit
    crossover.md, figures/      the page of the documentation (docs/crossover.md) with its pictures
    chart.json                  which methods none beats, the reference, provenance
    cases/                      a file for each case as soon as it is done: `--resume` begins with them
"""

from __future__ import annotations

import os
from importlib import resources
from pathlib import Path

from fabrics.errors import InputError
from weavecell.results import json_file, progress, provenance

LONG = "crossover"


def chart_command(scenes, out, *, everything=False, quick=False, page=None, level, only, jobs, executor, resume):
    """Run scenes, write their tables and charts to the folder `out`, and print what was found.

    Parameters
    ----------
    scenes : names, of validation.verification.cost_accuracy.study.SCENES or `LONG`
    out : folder, or None
    everything : all standard scenes
    quick : coarser references
    page : Path of a page to write too, with its figures in figures/ beside it; renews the tables of the package, from
        which the page also tells of the scenes that were run before
    level, only, jobs, executor : of the long study
    resume : begin with the cases of an interrupted run
    """
    from validation.verification.cost_accuracy import study

    known = ", ".join((*study.SCENES, LONG))
    for name in scenes:
        if name not in study.SCENES and name != LONG:
            raise InputError(key="--scene", value=name, allowed=f"one of {known}")
    if not scenes and not everything:
        raise InputError(f"say --all, or which --scene: {known}")
    if LONG in scenes:
        if everything or page is not None or len(scenes) > 1:
            raise InputError(key="--scene", value=LONG, allowed="by itself: it has a page of its own")
        return crossover(out or Path("results/chart-crossover"), level, only, jobs, executor, resume)
    return charts(list(study.SCENES) if everything else scenes, out, quick, page, resume)


def charts(names, out, quick, page, resume):
    """Scenes by short runs."""
    from validation.verification.cost_accuracy import study

    out = out or Path("results") / ("charts" if len(names) > 1 else f"chart-{names[0]}")
    found = []
    for name in names:
        with progress.bar(f"Chart: {name}") as advance:
            found.append(
                study.run(
                    name, out / "cases" / name, quick=quick, resume=resume,
                    report=lambda done, total: advance(done / total, f"{done} of {total} cases"),
                )
            )  # fmt: skip
        _write(found[-1], out, out)
        _tell(found[-1])
    stamp = provenance.stamp()
    json_file.write(out / "charts.json", {"charts": [_plain(chart) for chart in found], "provenance": stamp})
    if page is not None:
        _write_page(found, page, _made(stamp))
    print(f"written to {out}" + (f" and {page}" if page else ""))


def _made(stamp):
    load = f"load average {os.getloadavg()[0]:.1f}"
    return f"version {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}, {stamp['processor']}, {load}."


def _write_page(charts, page, made):
    """Renew the tables of the package and the page, which also tells of the scenes that were run before."""
    from validation.verification.cost_accuracy import page as pages
    from validation.verification.cost_accuracy import pictures, study, tables

    kept = Path(str(resources.files("validation.verification.cost_accuracy"))) / "measured"
    for chart in charts:
        _write(chart, page.parent / "figures", kept, made)
    known = [tables.read(study.scene(key), kept) for key in study.SCENES if tables.kept(key, kept)]
    for chart, _ in known:
        pictures.draw(chart, page.parent / "figures" / f"chart-{chart.scene.key}.png")
    pages.write(known, page, f"weavecell cost-accuracy --all --page {page}")


def _write(chart, pictures_folder, tables_folder, made=""):
    from validation.verification.cost_accuracy import pictures, tables

    name = chart.scene.key
    pictures.draw(chart, pictures_folder / f"chart-{name}.png")
    tables.write_methods(chart, tables_folder / f"{name}.csv")
    tables.write_references(chart, tables_folder / f"{name}-references.csv", made)


def _tell(chart):
    for group, front in chart.fronts.items():
        asked = chart.scene.groups[group]
        print(f"{chart.scene.title}, {group}; reference known to {100 * chart.unsure(group):.2g} %; beaten by none:")
        for entry in front:
            print(f"  {entry.method.name:<40}{entry.sample.cpu:9.3f} s {100 * entry.worst(asked):8.2f} %")


def _plain(chart):
    fronts = {
        group: [
            {"method": e.method.name, "cpu_s": e.sample.cpu, "error": e.worst(chart.scene.groups[group])} for e in front
        ]
        for group, front in chart.fronts.items()
    }
    references = {
        name: {"value": found.value, "half_width": found.half_width} for name, found in chart.references.items()
    }
    failed = {e.method.name: e.sample.failed for e in chart.entries if e.sample.failed}
    return {"scene": chart.scene.key, "fronts": fronts, "references": references, "failed": failed}


def crossover(out, level, only, jobs, executor, resume):
    """The 3D crossover by all its choices."""
    from validation.verification.crossover_convergence import page, pictures, study, tables

    with progress.bar("Study of the 3D crossover") as advance:
        found = study.run(
            out, level=level, only=only or None, resume=resume, jobs=jobs, executor=executor,
            report=lambda done, total: advance(done / total, f"{done} of {total} cases"),
        )  # fmt: skip
    stamp = provenance.stamp()
    tables.write_csv(found, out / "crossover.csv")
    tables.write_orders(found, out / "orders.csv")
    drawn = pictures.draw_all(found, out / "figures")
    words = [f"--only '{','.join(only)}'"] if only else []
    command = " ".join(["weavecell cost-accuracy --scene crossover", f"--level {level}", *words])
    made = f"Version {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}, {stamp['processor']}."
    page.write(found, out / "crossover.md", made, command, drawn)
    best = [{"method": study.name(found, e), "cpu_s": e.result["cpu"], "error": e.error} for e in found.best]
    content = {"scene": "crossover", "level": level, "fabric": found.fabric, "best": best, "provenance": stamp}
    content["reference"] = {
        name: {"value": value, "half_width": half} for name, (value, half) in found.reference.items()
    }
    json_file.write(out / "chart.json", content)
    print(f"{len(found.entries)} cases; none beats, in time and error:")
    for entry in best:
        print(f"  {entry['method']:<28}{entry['cpu_s']:8.1f} s {100 * entry['error']:8.2f} %")
    print(f"written to {out}")
