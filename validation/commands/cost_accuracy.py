"""Cost against error of the methods: the standard scenes, each with every method of the project.

    python -m validation cost-accuracy ply-stopped

All scenes if none is named. They are timed, one after the other.

The folder
    NAME.csv, NAME-references.csv   one row a method; one row a quantity
    chart-NAME.png                  CPU time against error
    charts.json                     Pareto-optimal methods, references, provenance
    cases/NAME/                     a file for each case as soon as it is done: `--resume` begins with them
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from validation.commands import studies


def main(
    scenes: Sequence[str] = (), *, quick: bool = False, resume: bool = False, out: Path | None = None,
    page: Path | None = None,
) -> None:  # fmt: skip
    """Run scenes, write their tables and charts to the folder `out`, and print what was found."""
    studies.run(KIND, scenes, out, page=page, quick=quick, resume=resume)


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


KIND = studies.Kind(_modules, "cost-accuracy", "scenes", "Chart", "cases", "charts", "chart", "charts", _tell, _plain)
