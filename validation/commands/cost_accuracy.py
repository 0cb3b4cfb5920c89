"""Cost against error of the methods: the standard cases, each with every method of the project.

Folder of `weavecell cost-accuracy --scene NAME`, or `--all`
    NAME.csv, NAME-references.csv   one row a method; one row a quantity
    chart-NAME.png                  CPU time against error
    charts.json                     Pareto-optimal methods, references, provenance
    cases/NAME/                     a file for each case as soon as it is done: `--resume` begins with them

Folder of `weavecell cost-accuracy --scene crossover`, the long study of the 3D crossover
    crossover.csv, orders.csv   one row a case; one row a limit
    crossover.md, figures/      the page of the documentation (docs/reports/crossover.md) with its pictures
    chart.json                  Pareto-optimal methods, the reference, provenance
    cases/                      a file for each case as soon as it is done: `--resume` begins with them
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fabrics.errors import InputError
from validation.commands import studies
from weavecell.results import json_file, out_folder, progress, provenance

LONG = "crossover"


def chart_command(
    scenes: Sequence[str],
    out: Path | None,
    *,
    everything: bool = False,
    quick: bool = False,
    page: Path | None = None,
    level: str,
    only: Sequence[str],
    jobs: int,
    executor: str,
    resume: bool,
) -> None:
    """Run scenes, write their tables and charts to the folder `out`, and print what was found.

    Parameters
    ----------
    scenes : names, of validation.verification.cost_accuracy.study.NAMES or `LONG`
    out : folder, or None
    everything : all standard scenes
    quick : coarser references
    page : Path of a page to write too, with its figures in figures/ beside it; renews the tables of the package, from
        which the page also tells of the scenes that were run before
    level, only, jobs, executor : of the long study
    resume : begin with the cases of an interrupted run
    """
    if LONG in scenes:
        if everything or page is not None or len(scenes) > 1:
            raise InputError(key="--scene", value=LONG, allowed="by itself: it has a page of its own")
        crossover(out or Path("results/chart-crossover"), level, only, jobs, executor, resume)
    else:
        studies.run(KIND, scenes, out, everything=everything, page=page, quick=quick, resume=resume)


def _tell(chart):
    for group, front in chart.fronts.items():
        quantities = chart.scene.groups[group]
        print(f"{chart.scene.title}, {group}; reference known to {100 * chart.unsure(group):.2g} %; Pareto-optimal:")
        for entry in front:
            print(f"  {entry.method.name:<40}{entry.sample.cpu:9.3f} s {100 * entry.worst(quantities):8.2f} %")


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
    return {"scene": chart.key, "fronts": fronts, "references": references, "failed": failed}


def _modules():
    from validation.verification.cost_accuracy import page, pictures, study, tables

    return study, tables, pictures, page


KIND = studies.Kind(
    _modules, "cost-accuracy", "--scene", "Chart", "cases", "charts", "chart", "charts", _tell, _plain, (LONG,)
)


def crossover(out: Path, level: str, only: Sequence[str], jobs: int, executor: str, resume: bool) -> None:
    """The 3D crossover by all its choices."""
    from validation.verification.crossover_convergence import page, pictures, study, tables

    out_folder.claim(out, resume)
    with progress.bar("Study of the 3D crossover") as advance:
        found = study.run(
            out, level=level, only=only or None, resume=resume, jobs=jobs, executor=executor,
            report=lambda done, total: advance(done / total, f"{done} of {total} cases"),
        )  # fmt: skip
    stamp = provenance.stamp()
    tables.write(found, out / "crossover.csv")
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
    print(f"{len(found.entries)} cases; Pareto-optimal in time and error:")
    for entry in best:
        print(f"  {entry['method']:<28}{entry['cpu_s']:8.1f} s {100 * entry['error']:8.2f} %")
    print(f"written to {out}")
