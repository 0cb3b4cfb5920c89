"""python -m validation.verification.mesh_convergence [FABRIC ...] [--out FOLDER] [--resume] [--page FILE]

Writes points.json (the results on each mesh, with the key of their inputs and of the code, by which --resume finds
them), convergence.csv and convergence.png: critical velocity, residual velocity and absorbed energy at two strike
velocities, and peak tensions with 1, 2, 3, 4 elements per crossover about the impact point, the limit that they
extrapolate to, the observed order and the uncertainty of the finest mesh. With --page the tables go into that page,
between its marks, the picture into figures/ and convergence.csv into data/ beside it.
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
from validation.verification.mesh_convergence.study import FACTORS, LEVELS, TARGETS, TOLERANCE, Point, study, velocities
from weavecell.report.marked_page import markdown, put

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


def describe(entry: Quantity) -> str:
    """One line a quantity."""
    values = "  ".join(f"{value:7.2f}" for value in entry.values)
    deviations = "  ".join(f"{100 * value:+5.2f}" for value in entry.deviations)
    found = entry.extrapolation
    why = f" ({found.remark})" if found.remark else f" {found.order:.2f}"
    missed = "" if entry.met else "  TARGET MISSED"
    text = f"{entry.fabric:6} {entry.name:28} {values} -> {found.limit:7.2f} {entry.unit:4} deviations {deviations} %  "
    return f"{text}{found.basis}{why}, uncertainty {100 * entry.share:.2f} %{missed}"


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


def table(quantities: Sequence[Quantity]) -> str:
    """The table of the page, in Markdown; bold where a deviation from the limit or an uncertainty misses its target."""
    elements = quantities[0].elements
    finest = elements[-1]
    rows = [["fabric", "quantity", *(f"{n} per crossover" for n in elements), "limit", "found by",
             *(f"at {n}, % off" for n in elements), f"uncertainty at {finest}, %"]]  # fmt: skip
    for entry in quantities:
        target = TARGETS[entry.unit]
        found = entry.extrapolation
        order = f"order {found.order:.1f}" if found.order is not None else ""
        basis = order if found.basis == "Richardson" else f"{found.basis} ({found.remark})"
        values = (f"{value:.4g}" for value in entry.values)
        rows.append(
            [entry.fabric, f"{entry.name}, {entry.unit}", *values, f"{found.limit:.4g}", basis,
             *(_marked(f"{100 * off:+.1f}", abs(off) <= target) for off in entry.deviations),
             _marked(f"{100 * entry.share:.1f}", entry.met)]
        )  # fmt: skip
    return markdown(rows)


def counts(quantities: Sequence[Quantity]) -> str:
    """How many fabrics are within the targets, by quantity."""
    elements = quantities[0].elements
    kinds = list(dict.fromkeys(_kind(entry) for entry in quantities))
    rows = [["quantity", "target, %", "of", *(f"deviation at {n} within it" for n in elements),
             f"uncertainty at {elements[-1]} within it", "observed order between 0.5 and 2.1"]]  # fmt: skip
    for kind in kinds:
        found = [entry for entry in quantities if _kind(entry) == kind]
        target = TARGETS[found[0].unit]
        within = (sum(abs(entry.deviations[i]) <= target for entry in found) for i in range(len(elements)))
        regular = sum(entry.extrapolation.basis == "Richardson" for entry in found)
        rows.append([kind, f"{100 * target:g}", f"{len(found)}", *map(str, within), f"{sum(e.met for e in found)}",
                     f"{regular}"])  # fmt: skip
    return markdown(rows)


def _kind(entry):
    return entry.name.partition(" at ")[0]


def _marked(text, met):
    return text if met else f"**{text}**"


def comparison(pairs: Sequence[Sequence[Point]]) -> str:
    """The level that was run on graded and on uniform meshes."""
    n = pairs[0][0].elements
    kinds = [name.partition(" at ")[0] for name, *_ in pairs[0][0].results]
    names = [
        f"{kind} at {FACTORS[kinds[:i].count(kind)]} of it" if kinds.count(kind) > 1 else kind
        for i, kind in enumerate(kinds)
    ]
    rows = [["fabric", "elements, graded and uniform", *names, "CPU time, graded over uniform"]]
    for graded, uniform in pairs:
        off = [a[2] / b[2] - 1 for a, b in zip(graded.results, uniform.results)]
        targets = [TARGETS[unit] for _, unit, *_ in graded.results]
        rows.append([graded.fabric, f"{graded.cells}, {uniform.cells}",
                     *(_marked(f"{100 * x:+.2f}", abs(x) <= t) for x, t in zip(off, targets)),
                     f"{graded.seconds / uniform.seconds:.2f}"])  # fmt: skip
    return f"{n} elements per crossover; graded over uniform, less 1, in %:\n\n{markdown(rows)}"


def write_page(quantities: Sequence[Quantity], pairs: Sequence[Sequence[Point]], page: Path) -> None:
    """Put the tables between the marks of a page."""
    put(page, *MARKS, f"\n\n{counts(quantities)}\n{table(quantities)}\n")
    if pairs:
        put(page, *CHECKED, f"\n\n{comparison(pairs)}\n")


def main() -> None:
    speeds = velocities()
    parser = argparse.ArgumentParser(
        prog="python -m validation.verification.mesh_convergence",
        description="Convergence of impact results with the mesh.",
    )
    parser.add_argument("fabrics", nargs="*", default=list(speeds), metavar="FABRIC")
    parser.add_argument("--elements", nargs="+", type=int, default=list(LEVELS), metavar="N")
    parser.add_argument("--tolerance", type=float, default=TOLERANCE, help="of the critical velocity, m/s")
    parser.add_argument("--no-check", action="store_true", help="no uniform mesh to compare with")
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
    pairs: list[Sequence[Point]] = []
    points = read_points(kept) if options.resume else {}
    check = None if options.no_check else CHECK
    wanted = [(n, False) for n in options.elements] + [(n, True) for n in (check,) if n is not None]
    for name in options.fabrics:
        fabric = catalogue.load(name).with_effective_density()
        keys = {one: key_of(fabric, speeds[name], *one, options.tolerance) for one in wanted}

        def keep(point, keys=keys):
            points[keys[point.elements, point.uniform]] = point
            write_points(points, kept)  # after each mesh: the fine ones take minutes

        found, pair = study(
            fabric, speeds[name], elements=options.elements, keep=keep, tolerance=options.tolerance, check=check,
            known=[points[key] for key in keys.values() if key in points], jobs=options.jobs,
            executor=options.executor,
        )  # fmt: skip
        quantities += found
        pairs += [pair] if pair else []
        for entry in found:
            print(describe(entry), flush=True)
        write_csv(quantities, options.out / "convergence.csv")
    picture(quantities, options.out / "convergence.png")
    if options.page is not None:
        picture(quantities, options.page.parent / "figures" / "convergence.png")
        write_csv(quantities, options.page.parent / "data" / "convergence.csv")
        write_page(quantities, pairs, options.page)


if __name__ == "__main__":
    run_program(main)
