"""python -m validation.verification.mesh_convergence [--fabrics NAME ...] [--plies N ...] [--out FOLDER] [--page PAGE]

Convergence with the mesh, on means: the critical velocity of plies and packs on the default and a finer mesh, and
absorbed energy, residual velocity and cut yarns as means over 9 strike velocities within +-8 % of 1.5 times the
critical velocity of the default mesh, with their standard errors.

Writes convergence.csv and convergence.png. With --page the tables go into that page, between its marks, the picture
into figures/ and the CSV into data/ beside it, as convergence-means. With --weaves, one mass in a coarse, a middle and
a fine ply is computed instead, and with --filter the map of failure length and time step: a table each. Bisections
and shots are kept in points/ of the folder, from which --resume goes on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import hypot, isfinite, nan
from pathlib import Path

from fabrics import run_cache
from validation.commits import computed
from validation.marked_page import markdown
from validation.program import marks, program, publish, save, write_records
from validation.verification.mesh_convergence.pictures import compose
from validation.verification.mesh_convergence.study import FACTORS, Case, Measured, measure
from validation.verification.study import known
from weavecell.results import provenance
from weavecell.studies import window

MODULE = "validation.verification.mesh_convergence"
NAME = "convergence-means"  # of the files beside the page
FABRICS = "S-720", "S-726", "S-727", "S-728", "S-731", "S-745"  # of one ply
PACK_FABRICS = "S-726", "S-728", "S-731"
QUANTITIES = {"critical_velocity": ("", "critical velocity", "m/s")} | window.QUANTITIES
TARGETS = {"critical_velocity": (2.0, 2.0), "absorbed_energy": (3.0, 5.0)}  # [%] of one ply, of packs
WEAVES = {"coarse": (2.0, 4.0), "middle": (1.0, 2.0), "fine": (0.5, 1.0)}  # size, mass of yarns of one ply of S-728
WEAVE_OPENING, WEAVE_PROJECTILE, WEAVE_TARGET = 0.12, "FSP 1.10 g", 5.0  # [m], name, [%] of the energy
LENGTHS, COURANT = (0.375e-3, 0.75e-3, 1.5e-3), (0.45, 0.9)  # [m] failure lengths, Courant factors


@dataclass(frozen=True)
class Deviation:
    """How far a quantity is from its value on the finer mesh.

    Parameters
    ----------
    plies, fabric : of the case
    quantity : of `QUANTITIES`
    values : {mesh: (value, standard error or half the width of the bracket)}, in the unit of the quantity
    """

    plies: int
    fabric: str
    quantity: str
    values: dict[str, tuple[float, float]]

    @property
    def target(self) -> float | None:
        """[%] for the default mesh, or None."""
        return TARGETS[self.quantity][self.plies > 1] if self.quantity in TARGETS else None

    def percent(self, mesh: str) -> tuple[float, float]:
        """(deviation of the value on a mesh, its error) [%] of the value on the finer mesh."""
        (value, error), (reference, reference_error) = self.values[mesh], self.values["finer"]
        if reference == 0:
            return (0.0, 0.0) if value == 0 else (nan, nan)
        return 100 * (value / reference - 1), 100 * hypot(error, value / reference * reference_error) / abs(reference)

    @property
    def met(self) -> bool:
        """Whether the default mesh is within the target; a value that is not known is not."""
        return self.target is None or abs(self.percent("default")[0]) <= self.target


def records(groups: Sequence[Sequence[Measured]]) -> list[dict[str, object]]:
    """Rows of convergence.csv, one a case."""
    rows: list[dict[str, object]] = []
    for measured in (measured for group in groups for measured in group):
        case, middle = measured.case, "" if measured.window is None else measured.window.strike_velocity
        row = {"fabric": case.fabric, "plies": case.plies, "mesh": case.mesh, "elements": measured.elements}
        row |= {"window_middle_m_s": middle, "not_perforated": measured.not_perforated}
        for name, (_, _, unit) in QUANTITIES.items():
            key = f"{name}_{unit.replace('/', '_')}".rstrip("_")
            row[key], row[f"{key}_error"] = (f"{value:.6g}" for value in measured.mean(name))
        costs = {"cpu_of_a_shot_s": f"{measured.cpu:.3f}", "viscous_share": f"{measured.viscous:.4f}"}
        rows.append(row | costs | {"problem": measured.limit.problem})
    return rows


def tables(groups: Sequence[Sequence[Measured]]) -> str:
    """How many targets are met, the deviations, and what the meshes cost, in Markdown."""
    rows = [
        Deviation(case.plies, case.fabric, name, {measured.case.mesh: measured.mean(name) for measured in group})
        for group in groups for case in [group[0].case] for name in QUANTITIES
    ]  # fmt: skip
    meshes = list(rows[0].values)
    counts = [["quantity", "plies", "target, %", "within it"]]
    for name in TARGETS:
        for words, several in (("1", False), ("several", True)):
            judged = [row for row in rows if row.quantity == name and (row.plies > 1) == several]
            if judged:
                met = f"{sum(row.met for row in judged)} of {len(judged)}"
                counts.append([QUANTITIES[name][1], words, f"{judged[0].target:g}", met])
    lines = [["plies", "fabric", "quantity", *meshes, *(f"{mesh} off, %" for mesh in meshes[:-1]), "target, %"]]
    for row in rows:
        _, words, unit = QUANTITIES[row.quantity]
        shares = map(row.percent, meshes[:-1])
        off = [f"{share:+.1f} ± {error:.1f}" if isfinite(share) else "not known" for share, error in shares]
        off[-1] = off[-1] if row.met else f"**{off[-1]}**"
        values = [plus_minus(row.values[mesh]) for mesh in meshes]
        name = f"{words}, {unit}".rstrip(", ")
        lines.append([f"{row.plies}", row.fabric, name, *values, *off, f"{row.target:g}" if row.target else ""])
    costs = [["plies", "fabric", "mesh", "elements", "CPU of a shot, s", "viscous energy until the first failure, %",
              "shots that did not perforate"]]  # fmt: skip
    for measured in (measured for group in groups for measured in group):
        case, left = measured.case, f"{measured.not_perforated} of {len(FACTORS)}"
        costs.append([f"{case.plies}", case.fabric, case.mesh, f"{measured.elements}", f"{measured.cpu:.2f}",
                      f"{100 * measured.viscous:.1f}", measured.limit.problem or left])  # fmt: skip
    note = "Off: from the finer mesh. Bold: missed. ±: standard error; of a critical velocity half its bracket.\n"
    return "\n".join([*map(markdown, (counts, lines)), note, markdown(costs)])


def plus_minus(mean: tuple[float, float]) -> str:
    """A value and its error as text."""
    value, error = mean
    return f"{value:.4g} ± {error:.2g}" if isfinite(value) else "not known"


def weave_table(group: Sequence[Measured]) -> str:
    """Critical velocity, the energy at it, and the mean absorbed energy against the first weave, in Markdown."""
    rows = [["weave", "size", "mass of a yarn", "critical velocity, m/s", "off coarse, %", "its energy off coarse, %",
             "absorbed energy, J", "off coarse, %"]]  # fmt: skip
    velocities, energies = ([measured.mean(name) for measured in group] for name in TARGETS)
    for (name, factors), velocity, energy in zip(WEAVES.items(), velocities, energies):
        ratio = velocity[0] / velocities[0][0]
        off, mark = 100 * (ratio**2 - 1), "" if abs(100 * (ratio**2 - 1)) <= WEAVE_TARGET else "**"
        rows.append([name, *(f"{factor:g}" for factor in factors), plus_minus(velocity), f"{100 * (ratio - 1):+.1f}",
                     f"{mark}{off:+.1f}{mark}", plus_minus(energy),
                     f"{100 * (energy[0] / energies[0][0] - 1):+.1f}"])  # fmt: skip
    return markdown(rows)


def filter_table(group: Sequence[Measured]) -> str:
    """Critical velocity and mean absorbed energy by failure length and Courant factor, in Markdown."""
    columns = [(name, factor) for name in TARGETS for factor in COURANT]
    head = (", ".join(filter(None, QUANTITIES[name][1:])) for name, _ in columns)
    rows = [["failure length, mm", *(f"{words}, at {factor:g}" for words, (_, factor) in zip(head, columns))]]
    cases = {(measured.case.failure_length, measured.case.cfl): measured for measured in group}
    for length in LENGTHS:
        means = (cases[length, factor].mean(name) for name, factor in columns)
        rows.append([f"{1e3 * length:g}", *map(plus_minus, means)])
    case = group[0].case
    return f"{case.plies} x {case.fabric}, Courant factors {COURANT[0]:g} and {COURANT[1]:g}:\n\n{markdown(rows)}"


def main(
    *, fabrics: Sequence[str] = (), plies: Sequence[int] = (1, 2, 4, 8), coarser: bool = False, weaves: bool = False,
    filter: bool = False, opening: float | None = None, table_size: int = 201, jobs: int = 1,
    out: Path = Path("results/convergence"), page: Path | None = None, resume: bool = False,
) -> None:  # fmt: skip
    for fabric in fabrics:
        known("--fabrics", fabric, FABRICS)
    study = "weaves" if weaves else "filter" if filter else "means"
    stamp, points = provenance.stamp(), out / "points" / study
    if not resume:
        run_cache.RunCache(points).clear()
    base = Case("S-728", opening=opening or (WEAVE_OPENING if weaves else Case.opening), table_size=table_size)
    if weaves:
        base = replace(base, projectile=WEAVE_PROJECTILE)
        group = [replace(base, size=size, mass=mass) for size, mass in WEAVES.values()]
        text = weave_table(measure([group], points, jobs)[0])
    elif filter:
        base = replace(base, fabric=(*fabrics, base.fabric)[0])
        keys = sorted(product(LENGTHS, COURANT), key=lambda key: key != (LENGTHS[1], Case.cfl))  # the default first
        group = [replace(base, failure_length=length, cfl=factor) for length, factor in keys]
        text = filter_table(measure([group], points, jobs)[0])
    else:
        meshes = ("default", "finer", *(["coarser"] * coarser))
        cases = [
            [replace(base, fabric=fabric, plies=count, mesh=mesh) for mesh in meshes]
            for count in plies for fabric in fabrics or (FABRICS if count == 1 else PACK_FABRICS)
        ]  # fmt: skip
        groups = [sorted(group, key=lambda measured: measured.case.mesh) for group in measure(cases, points, jobs)]
        text = tables(groups)
        files = [(out / "convergence.csv", out / "convergence.png")]
        if page is not None:
            files += [(page.parent / "data" / f"{NAME}.csv", page.parent / "figures" / f"{NAME}.png")]
            text += f"\n![CPU time of a shot against the deviation of its absorbed energy](figures/{NAME}.png)\n"
        for data, figure in files:
            write_records(data, records(groups))
            save(compose, groups, TARGETS["absorbed_energy"], to=figure)
    options = [f"--{study}"] if study != "means" else ["--plies", *map(str, plies), *(["--coarser"] * coarser)]
    options += [*(["--fabrics", *fabrics] if fabrics else []), *(["--page", f"{page}"] if page else [])]
    command = " ".join(["python -m", MODULE, *options])
    publish(f"{text}\n{computed(command, stamp)}\n", page, marks(study, MODULE))


if __name__ == "__main__":
    program(
        main,
        fabrics="those of the study by default; of --filter the first",
        coarser="also one element per crossover",
        weaves="one mass in three weaves instead",
        filter="failure length and time step instead",
        opening="of the panel, m; that of the study by default",
        table_size="of the cell's table; a smaller one for a look",
        resume="go on with what the folder holds",
    )
