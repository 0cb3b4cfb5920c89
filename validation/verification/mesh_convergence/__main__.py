"""python -m validation.verification.mesh_convergence [FABRIC ...] [--out FOLDER] [--resume] [--page FILE]

Writes points.json (what each mesh gave, with the key of its inputs and of the code, by which --resume takes it),
convergence.csv and convergence.png: critical velocity and peak tensions with
1, 2, 3 elements a crossover, the limit that they extrapolate to, and the order observed. With --page the table goes
into that page, between its marks, and the picture beside it into figures/.
"""

from __future__ import annotations

import argparse
import csv
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from fabrics import catalogue, run_cache
from fabrics.errors import InputError, run_program
from fabrics.files import write_whole
from validation.verification.mesh_convergence.pictures import picture
from validation.verification.mesh_convergence.study import ALLOWED, TOLERANCE, Point, study, velocities
from weavecell.report.marked_page import put

if TYPE_CHECKING:
    from fabrics.fabric import Fabric
    from validation.verification.mesh_convergence.study import Quantity

MARKS = "<!-- table of validation.verification.mesh_convergence -->", "<!-- end of the table -->"


def write_csv(quantities: Sequence[Quantity], path: Path) -> None:
    """One row a fabric and quantity."""
    elements = quantities[0].elements
    with write_whole(path) as file:
        rows = csv.writer(file)
        rows.writerow([
            "fabric", "quantity", "unit", *(f"{n} a crossover" for n in elements), "limit", "observed order", "basis",
            "remark", "scatter", *(f"{n} a crossover, deviation %" for n in elements), "target met",
        ])  # fmt: skip
        for entry in quantities:
            found = entry.extrapolation
            rows.writerow([
                entry.fabric, entry.name, entry.unit, *(f"{value:.4f}" for value in entry.values),
                f"{found.limit:.4f}", "" if found.order is None else f"{found.order:.2f}", found.basis, found.remark,
                f"{found.scatter:.4f}", *(f"{100 * value:+.2f}" for value in entry.deviations),
                "yes" if entry.met else "no",
            ])  # fmt: skip


def tell(entry: Quantity) -> None:
    """One line a quantity."""
    values = "  ".join(f"{value:7.2f}" for value in entry.values)
    deviations = "  ".join(f"{100 * value:+5.2f}" for value in entry.deviations)
    found = entry.extrapolation
    why = f" ({found.remark})" if found.remark else f" {found.order:.2f}"
    missed = "" if entry.met else "  TARGET MISSED"
    print(f"{entry.fabric:6} {entry.name:18} {values} -> {found.limit:7.2f} {entry.unit:4} ", end="")
    print(f"deviations {deviations} %  {found.basis}{why}{missed}", flush=True)


def key_of(fabric: Fabric, speed: float, elements: int, tolerance: float) -> str:
    """Key of a point: of what is run, and of the code."""
    return run_cache.key((fabric, speed, elements, tolerance), "validation.verification.mesh_convergence.study")


def read_points(path: Path) -> dict[str, Point]:
    """{key: Point} of an earlier run."""
    try:
        return {one.pop("key"): Point(**one) for one in json.loads(path.read_text("utf-8"))}
    except (OSError, ValueError, TypeError, KeyError) as problem:
        raise InputError(f"no points to resume from ({problem})", file=path) from None


def write_points(points: dict[str, Point], path: Path) -> None:
    """Keep points, sorted."""
    rows = sorted(points.items(), key=lambda item: (item[1].fabric, item[1].elements))
    with write_whole(path) as file:
        json.dump([{**asdict(one), "key": key} for key, one in rows], file, indent=1)


def table(quantities: Sequence[Quantity]) -> str:
    """The table of the page, in Markdown."""
    elements = quantities[0].elements
    heads = ["fabric", "quantity", *(f"{n} a crossover" for n in elements), "limit", "found by"]
    heads += [f"at {n}, % off" for n in ALLOWED if n in elements]
    rows = [heads, ["---"] * len(heads)]
    for entry in quantities:
        off = dict(zip(entry.elements, entry.deviations))
        texts = (f"{100 * off[n]:+.1f}" if abs(off[n]) <= ALLOWED[n] else f"**{100 * off[n]:+.1f}**" for n in ALLOWED)
        found = entry.extrapolation
        basis = f"order {found.order:.1f}" if found.basis == "Richardson" else f"{found.basis} ({found.remark})"
        rows.append(
            [entry.fabric, f"{entry.name}, {entry.unit}", *(f"{value:.1f}" for value in entry.values),
             f"{found.limit:.1f}", basis, *texts]
        )  # fmt: skip
    return "\n".join("| " + " | ".join(row) + " |" for row in rows) + "\n"


def write_page(quantities: Sequence[Quantity], page: Path) -> None:
    """Put the table between the marks of a page."""
    put(page, *MARKS, f"\n\n{table(quantities)}\n")


def main() -> None:
    speeds = velocities()
    parser = argparse.ArgumentParser(
        prog="python -m validation.verification.mesh_convergence", description=__doc__.splitlines()[2]
    )
    parser.add_argument("fabrics", nargs="*", default=list(speeds), metavar="FABRIC")
    parser.add_argument("--elements", nargs="+", type=int, default=[1, 2, 3], metavar="N")
    parser.add_argument("--tolerance", type=float, default=TOLERANCE, help="of the critical velocity, m/s")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--executor", default="local", help="local, mpi, parsl, dask or MODULE:FUNCTION")
    parser.add_argument("--out", type=Path, default=Path("results/convergence"))
    parser.add_argument("--resume", action="store_true", help="do not run again what points.json holds of this code")
    parser.add_argument("--page", type=Path, help="put table and picture into this page")
    options = parser.parse_args()
    unknown = [name for name in options.fabrics if name not in speeds]
    if unknown:
        raise InputError(key="FABRIC", value=unknown[0], allowed=f"one of {', '.join(speeds)}")
    kept = options.out / "points.json"
    quantities: list[Quantity] = []
    points = read_points(kept) if options.resume else {}
    for name in options.fabrics:
        fabric = catalogue.load(name).with_effective_density()
        keys = {n: key_of(fabric, speeds[name], n, options.tolerance) for n in options.elements}

        def keep(point, keys=keys):
            points[keys[point.elements]] = point
            write_points(points, kept)  # after each mesh: the fine ones take minutes

        found = study(
            fabric, speeds[name], elements=options.elements, keep=keep, tolerance=options.tolerance,
            known=[points[key] for key in keys.values() if key in points], jobs=options.jobs,
            executor=options.executor,
        )  # fmt: skip
        quantities += found
        for entry in found:
            tell(entry)
        write_csv(quantities, options.out / "convergence.csv")
    picture(quantities, options.out / "convergence.png")
    if options.page is not None:
        picture(quantities, options.page.parent / "figures" / "convergence.png")
        write_page(quantities, options.page)


if __name__ == "__main__":
    run_program(main)
