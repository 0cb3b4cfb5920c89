"""python -m validation.verification.mesh_convergence [FABRIC ...] [--out FOLDER] [--resume] [--page FILE]

Writes points.json (the results on each mesh, with the key of their inputs and of the code, by which --resume finds
them), convergence.csv and convergence.png: critical velocity, residual velocity and absorbed energy at two strike
velocities, and peak tensions with 1, 2, 3, 4 elements per crossover about the impact point, the limit that they
extrapolate to, the observed order and the uncertainty of the finest mesh. With --page the tables go into that page,
between its marks, the picture into figures/ and convergence.csv into data/ beside it.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from fabrics import catalogue, run_cache
from fabrics.errors import InputError
from fabrics.files import write_whole
from validation.program import program
from validation.verification.mesh_convergence.pictures import picture
from validation.verification.mesh_convergence.study import LEVELS, TOLERANCE, Point, study, velocities
from validation.verification.mesh_convergence.tables import comparison, counts, describe, table
from weavecell.report.marked_page import put

if TYPE_CHECKING:
    from fabrics.fabric import Fabric
    from validation.verification.mesh_convergence.study import Quantity, Strikes

MARKS = "<!-- table of validation.verification.mesh_convergence -->", "<!-- end of the table -->"
CHECKED = "<!-- uniform meshes of validation.verification.mesh_convergence -->", "<!-- end of uniform meshes -->"
CHECK = 2  # elements per crossover of the mesh that is run uniform as well


def write_csv(quantities: Sequence[Quantity], path: Path) -> None:
    """One row a fabric and quantity."""
    elements = quantities[0].elements
    with write_whole(path) as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow([
            "fabric", "quantity", "unit", *(f"{n} per crossover" for n in elements), "limit", "observed order", "basis",
            "remark", "scatter", *(f"{n} per crossover, deviation %" for n in elements),
            f"uncertainty of {elements[-1]} per crossover, %", "target met",
        ])  # fmt: skip
        for entry in quantities:
            found = entry.extrapolation
            rows.writerow([
                entry.fabric, entry.name, entry.unit, *(f"{value:.4f}" for value in entry.values),
                f"{found.limit:.4f}", "" if found.order is None else f"{found.order:.2f}", found.basis, found.remark,
                f"{found.scatter:.4f}", *(f"{100 * value:+.2f}" for value in entry.deviations),
                f"{100 * entry.share:.2f}", "yes" if entry.met else "no",
            ])  # fmt: skip


def key_of(fabric: Fabric, strikes: Strikes, elements: int, uniform: bool, tolerance: float) -> str:
    """Key of a point: of what is run, and of the code."""
    inputs = (fabric, strikes, elements, uniform, tolerance)
    return run_cache.key(inputs, "validation.verification.mesh_convergence.study")


def read_points(path: Path) -> dict[str, Point]:
    """{key: Point} of an earlier run."""
    try:
        return {one.pop("key"): _point(one) for one in json.loads(path.read_text("utf-8"))}
    except (OSError, ValueError, TypeError, KeyError) as problem:
        raise InputError(f"no points to resume from ({problem})", file=path) from None


def _point(row):
    return Point(**{name: tuple(value) if isinstance(value, list) else value for name, value in row.items()})


def write_points(points: dict[str, Point], path: Path) -> None:
    """Keep points, sorted."""
    rows = sorted(points.items(), key=lambda item: (item[1].fabric, item[1].elements, item[1].uniform))
    with write_whole(path) as file:
        json.dump([{**asdict(one), "key": key} for key, one in rows], file, indent=1)


def write_page(quantities: Sequence[Quantity], pairs: Sequence[Sequence[Point]], page: Path) -> None:
    """Put the tables between the marks of a page."""
    put(page, *MARKS, f"\n\n{counts(quantities)}\n{table(quantities)}\n")
    if pairs:
        put(page, *CHECKED, f"\n\n{comparison(pairs)}\n")


def main(
    fabrics: Sequence[str] = (),
    *,
    elements: Sequence[int] = LEVELS,
    tolerance: float = TOLERANCE,
    no_check: bool = False,
    jobs: int = 1,
    executor: str = "local",
    out: Path = Path("results/convergence"),
    resume: bool = False,
    page: Path | None = None,
) -> None:
    speeds = velocities()
    unknown = [name for name in fabrics if name not in speeds]
    if unknown:
        raise InputError(key="FABRIC", value=unknown[0], allowed=f"one of {', '.join(speeds)}")
    kept = out / "points.json"
    quantities: list[Quantity] = []
    pairs: list[Sequence[Point]] = []
    points = read_points(kept) if resume else {}
    check = None if no_check else CHECK
    wanted = [(n, False) for n in elements] + [(n, True) for n in (check,) if n is not None]
    for name in fabrics or speeds:
        fabric = catalogue.load(name).with_effective_density()
        keys = {one: key_of(fabric, speeds[name], *one, tolerance) for one in wanted}

        def keep(point, keys=keys):
            points[keys[point.elements, point.uniform]] = point
            write_points(points, kept)  # after each mesh: the fine ones take minutes

        found, pair = study(
            fabric, speeds[name], elements=elements, keep=keep, tolerance=tolerance, check=check,
            known=[points[key] for key in keys.values() if key in points], jobs=jobs,
            executor=executor,
        )  # fmt: skip
        quantities += found
        pairs += [pair] if pair else []
        for entry in found:
            print(describe(entry), flush=True)
        write_csv(quantities, out / "convergence.csv")
    picture(quantities, out / "convergence.png")
    if page is not None:
        picture(quantities, page.parent / "figures" / "convergence.png")
        write_csv(quantities, page.parent / "data" / "convergence.csv")
        write_page(quantities, pairs, page)


if __name__ == "__main__":
    program(
        main,
        fabrics="all by default",
        tolerance="of the critical velocity, m/s",
        no_check="no uniform mesh to compare with",
        resume="do not run again what points.json holds of this code",
    )
