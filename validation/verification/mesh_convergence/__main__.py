"""python -m validation.verification.mesh_convergence [FABRIC ...] [--out FOLDER] [--page FILE]

Writes convergence.csv and convergence.png: critical velocity, residual velocity and absorbed energy at two strike
velocities, and peak tensions with 1, 2, 3, 4 elements per crossover about the impact point, the limit that they
extrapolate to, the observed order and the uncertainty of the finest mesh. Each point is kept in points/, from which an
interrupted study goes on. With --page the tables go into that page, between its marks, the picture into figures/ and
convergence.csv into data/ beside it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from validation.marked_page import markdown
from validation.program import program, publish, save, write_csv
from validation.verification.mesh_convergence.pictures import compose
from validation.verification.mesh_convergence.study import (
    FACTORS,
    LEVELS,
    TARGETS,
    TOLERANCE,
    Point,
    Quantity,
    study,
    velocities,
)
from validation.verification.study import known

MARKS = "<!-- table of validation.verification.mesh_convergence -->", "<!-- end of the table -->"
CHECKED = "<!-- uniform meshes of validation.verification.mesh_convergence -->", "<!-- end of uniform meshes -->"
CHECK = 2  # elements per crossover of the mesh that is run uniform as well


def rows(quantities: Sequence[Quantity]) -> Iterator[list[str]]:
    """The head of convergence.csv, and one row a fabric and quantity."""
    elements = quantities[0].elements
    yield [
        "fabric", "quantity", "unit", *(f"{n} per crossover" for n in elements), "limit", "observed order", "basis",
        "remark", "scatter", *(f"{n} per crossover, deviation %" for n in elements),
        f"uncertainty of {elements[-1]} per crossover, %", "target met",
    ]  # fmt: skip
    for entry in quantities:
        found = entry.extrapolation
        yield [
            entry.fabric, entry.name, entry.unit, *(f"{value:.4f}" for value in entry.values), f"{found.limit:.4f}",
            "" if found.order is None else f"{found.order:.2f}", found.basis, found.remark, f"{found.scatter:.4f}",
            *(f"{100 * value:+.2f}" for value in entry.deviations), f"{100 * entry.share:.2f}",
            "yes" if entry.met else "no",
        ]  # fmt: skip


def describe(entry: Quantity) -> str:
    """One line a quantity."""
    values = "  ".join(f"{value:7.2f}" for value in entry.values)
    deviations = "  ".join(f"{100 * value:+5.2f}" for value in entry.deviations)
    found = entry.extrapolation
    why = f" ({found.remark})" if found.remark else f" {found.order:.2f}"
    missed = "" if entry.met else "  TARGET MISSED"
    text = f"{entry.fabric:6} {entry.name:28} {values} -> {found.limit:7.2f} {entry.unit:4} deviations {deviations} %  "
    return f"{text}{found.basis}{why}, uncertainty {100 * entry.share:.2f} %{missed}"


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


def main(
    fabrics: Sequence[str] = (),
    *,
    elements: Sequence[int] = LEVELS,
    tolerance: float = TOLERANCE,
    no_check: bool = False,
    jobs: int = 1,
    out: Path = Path("results/convergence"),
    page: Path | None = None,
) -> None:
    speeds = velocities()
    for name in fabrics:
        known("FABRIC", name, tuple(speeds))
    chosen = {name: speeds[name] for name in fabrics or speeds}
    check = None if no_check else CHECK
    found, pairs = study(chosen, out / "points", elements=elements, check=check, tolerance=tolerance, jobs=jobs)
    for entry in found:
        print(describe(entry))
    write_csv(out / "convergence.csv", rows(found))
    save(compose, found, to=out / "convergence.png")
    if page is not None:
        save(compose, found, to=page.parent / "figures" / "convergence.png")
        write_csv(page.parent / "data" / "convergence.csv", rows(found))
    publish(f"{counts(found)}\n{table(found)}", page, MARKS)
    if pairs:
        publish(comparison(pairs), page, CHECKED)


if __name__ == "__main__":
    program(
        main,
        fabrics="all by default",
        tolerance="of the critical velocity, m/s",
        no_check="no uniform mesh to compare with",
        jobs="fabrics beside each other",
    )
