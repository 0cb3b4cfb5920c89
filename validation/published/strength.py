"""Strength of yarns by strain rate and by bending over the nose: indenters, and what each option changes in a shot.

python -m validation.published.strength [--out results/strength] [--page docs/reports/strength.md]

The radii of the indenters are those of published tests of yarns: razor blade about 2 um, 20 um, 200 um and round 3.8 mm
(Fibers 8(10) 66, 2020), and the ball of 1 mm of tests of single fibres (Thomas et al.). Nothing is fitted to them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from fabrics import assumed, catalogue
from fabrics.fabric import Fabric
from fabrics.families import list_families
from fabrics.families.strain_rate import RateLaw
from fabrics.variants import with_linear_density
from shellfabric.impact.ballistic_limit import critical_velocity
from shellfabric.impact.simulation import ImpactResult, ImpactSetup, run
from shellfabric.projectile.projectile import Projectile
from validation.program import program, publish, write_csv
from weavecell.report.marked_page import markdown
from weavecell.results.impact import ImpactRecord

FABRIC = "S-726"
FAMILY_STRAINS = {"para-aramid": 0.030, "UHMWPE": 0.035, "E-glass": 0.030}  # of S-726; others: examples, no source
INDENTERS = {
    "razor blade, about 2 µm": 2e-6, "20 µm": 20e-6, "200 µm": 200e-6, "edge of the thesis's cylinder, 0.3 mm": 0.3e-3,
    "ball of 1 mm, 0.5 mm": 0.5e-3, "round, 3.8 mm": 3.8e-3,
}  # fmt: skip
OPTIONS = {
    "neither": (False, False),
    "rate_dependence": (True, False),
    "nose_bending": (False, True),
    "both": (True, True),
}
HEADS = ("outcome", "velocity at the end, m/s", "failed segments", "tension at failure over strength",
         "bending, %", "energy error, %", "wall time, s")  # fmt: skip


def woven(name: str = FABRIC) -> Fabric:
    """The fabric with all that the two options need."""
    fabric = assumed.with_shear(with_linear_density(catalogue.load(name)))
    return assumed.with_fibre_diameter(assumed.with_strain_rate(fabric))


def indenters() -> list[Sequence[str]]:
    """Strain of bending of the fibres of each family on each indenter, and what it leaves of the failure strain."""
    found: list[Sequence[str]] = [("indenter", *(
        f"{family.name}, {1e6 * family.entries['fibre_diameter'].value:g} µm: bending, % (left of "
        f"{100 * FAMILY_STRAINS[family.name]:g} %)" for family in list_families()
    ))]  # fmt: skip
    for name, radius in INDENTERS.items():
        cells = []
        for family in list_families():
            d, limit = family.entries["fibre_diameter"].value, FAMILY_STRAINS[family.name]
            bent = d / (2 * radius + d)
            cells.append(f"{100 * bent:.3g} ({100 * max(1 - bent / limit, 0):.0f} %)")
        found.append((name, *cells))
    return found


def setup(velocity: float, option: str, fabric: Fabric | None = None, **changes: Any) -> ImpactSetup:
    """A shot of the thesis's cylinder at S-726 with an option of OPTIONS.

    Either alone is run with data of the other that change no digit (tests/shellfabric/impact/test_strength.py), so that
    two variants of the kernels do for all.
    """
    (rate, nose), fabric = OPTIONS[option], fabric or woven()
    fabric = replace(fabric, strain_rate=fabric.strain_rate if rate else RateLaw((1.0,), (1.0,)))
    fabric = replace(fabric, fibre_diameter=fabric.fibre_diameter if nose else 1e-300)
    used = rate or nose
    return ImpactSetup(fabric, velocity, rate_dependence=used, nose_bending=used, **changes)


def shot(velocity: float, option: str, **changes: Any) -> ImpactResult:
    """The result of such a shot."""
    result = run(setup(velocity, option, **changes))
    print(velocity, option, changes, result.outcome, f"{result.residual_velocity:.1f}", flush=True)
    return result


def cells(result: ImpactResult) -> tuple[str, ...]:
    """A row under HEADS."""
    record = ImpactRecord.of(result, "", "")
    text = lambda key, form, factor=1.0: (  # noqa: E731
        "–" if record.failure.get(key) is None else format(factor * record.failure[key], form)
    )
    return (
        result.outcome, f"{result.residual_velocity:.1f}", f"{result.failed_segments[-1]:.0f}",
        text("tension_at_failure_over_strength", ".2f"),
        text("bending_strain_at_failure", ".2f", 100), f"{100 * record.energy_error_max:.3f}",
        f"{result.wall_time:.1f}",
    )  # fmt: skip


def of_options(plies: int, velocities: Sequence[float]) -> list[Sequence[str]]:
    """Shots with each option."""
    rows: list[Sequence[str]] = [("strike, m/s", "option", *HEADS)]
    for velocity in velocities:
        rows += [(f"{velocity:g}", name, *cells(shot(velocity, name, plies=plies))) for name in OPTIONS]
    return rows


def of_limits() -> list[Sequence[str]]:
    """Critical velocity of one ply with each option; and with the rate alone where the modulus stays."""
    plain = woven()
    assert plain.strain_rate is not None
    slow = replace(plain, strain_rate=replace(plain.strain_rate, modulus=()))
    rows: list[Sequence[str]] = [("option", "critical velocity, m/s")]
    cases = {name: (plain, name) for name in OPTIONS}
    cases["rate_dependence, modulus as in the data sheet"] = (slow, "rate_dependence")
    for name, (fabric, option) in cases.items():
        limit = critical_velocity(setup(100.0, option, fabric).panel(), tolerance=1.0)
        rows.append((name, f"{limit.velocity:.1f} ± {limit.half_width:.1f}"))
        print(*rows[-1], flush=True)
    return rows


def of_meshes(velocity: float) -> list[Sequence[str]]:
    """Shots on meshes, without and with the strain rate."""
    rows: list[Sequence[str]] = [("elements per crossover", "option", *HEADS)]
    for elements in (1, 2, 3):
        for name in ("neither", "rate_dependence"):
            rows.append((f"{elements}", name, *cells(shot(velocity, name, elements_per_crossover=elements))))
    return rows


def of_rims(velocity: float) -> list[Sequence[str]]:
    """The same cylinder with other edges: the strain of bending that the solver finds beside that of the radius."""
    d = woven().fibre_diameter or 0.0
    rows: list[Sequence[str]] = [("edge radius, mm", "d / (2 R + d), %", *HEADS)]
    for radius in (0.1e-3, 0.2e-3, 0.3e-3, 0.5e-3, 1e-3, 2.7e-3):
        result = shot(velocity, "nose_bending", projectile=Projectile(edge_radius=radius))
        rows.append((f"{1e3 * radius:g}", f"{100 * d / (2 * radius + d):.2f}", *cells(result)))
    return rows


def main(
    *, out: Path = Path("results/strength"), page: Path | None = None, velocities: Sequence[float] = (100.0, 130.0),
    pack: Sequence[float] = (200.0,),
) -> None:  # fmt: skip
    tables = {
        "indenters": indenters, "limits": of_limits, "one-ply": lambda: of_options(1, velocities),
        "edges": lambda: of_rims(velocities[-1]), "four-plies": lambda: of_options(4, pack),
        "meshes": lambda: of_meshes(1.5 * velocities[-1]),
    }  # fmt: skip
    for name, table in tables.items():
        rows = table()
        write_csv(out / f"{name}.csv", rows)
        marks = f"<!-- {name} of validation.published.strength -->", f"<!-- end of {name} -->"
        publish(markdown(rows, numbers=True), page, marks)


if __name__ == "__main__":
    program(main, velocities="[m/s] at one ply", pack="[m/s] at four plies")
