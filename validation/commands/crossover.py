"""Cost against error of the 3D crossover, by all its choices: meshes, contact, load steps.

    python -m validation crossover --level full

The folder
    crossover.csv, orders.csv   one row a case; one row a limit
    crossover.md, figures/      the page of the documentation (docs/reports/crossover.md) with its pictures
    chart.json                  Pareto-optimal methods, the reference, provenance
    cases/                      a file for each case as soon as it is done: `--resume` begins with them
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from weavecell.cli.from_signature import CORES
from weavecell.results import json_file, out_folder, progress, provenance

NOTES = {"level": "how fine the mesh of the finest reference is", "only": "choices to vary; all if none is given"}


def main(
    *, level: Literal["quick", "full", "fine"] = "full", only: Sequence[str] = (), jobs: int = CORES,
    executor: str = "local", resume: bool = False, out: Path = Path("results/chart-crossover"),
) -> None:  # fmt: skip
    """Run the study, write its tables, pictures and page, and print the Pareto-optimal choices."""
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
    command = " ".join(["python -m validation crossover", f"--level {level}", *(["--only", *only] if only else [])])
    made = f"Version {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}, {stamp['processor']}."
    page.write(found, out / "crossover.md", made, command, drawn)
    best = [{"method": study.name(found, e), "cpu_s": e.result["cpu"], "error": e.error} for e in found.best]
    content: dict[str, Any] = {
        "scene": "crossover",
        "level": level,
        "fabric": found.fabric,
        "best": best,
        "provenance": stamp,
    }
    content["reference"] = {
        name: {"value": value, "half_width": half} for name, (value, half) in found.reference.items()
    }
    json_file.write(out / "chart.json", content)
    print(f"{len(found.entries)} cases; Pareto-optimal in time and error:")
    for entry in best:
        print(f"  {entry['method']:<28}{entry['cpu_s']:8.1f} s {100 * entry['error']:8.2f} %")
    print(f"written to {out}")
