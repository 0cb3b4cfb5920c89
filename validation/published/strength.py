"""Strength of yarns by strain rate: what it changes in a shot.

python -m validation.published.strength [--out results/strength] [--page docs/reports/strength.md]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from fabrics import assumed, catalogue
from fabrics.fabric import Fabric
from fabrics.variants import with_linear_density
from shellfabric.impact.ballistic_limit import critical_velocity
from shellfabric.impact.simulation import ImpactResult, ImpactSetup, run
from validation.marked_page import markdown
from validation.program import program, publish, write_csv
from weavecell.results.impact import ImpactRecord

FABRIC = "S-726"
OPTIONS = {"neither": False, "rate_dependence": True}
HEADS = ("outcome", "velocity at the end, m/s", "cut yarns", "tension at failure over strength",
         "energy error, %", "wall time, s")  # fmt: skip


def woven(name: str = FABRIC) -> Fabric:
    """The fabric with all that the option needs."""
    fabric = assumed.with_shear(with_linear_density(catalogue.load(name)))
    return assumed.with_strain_rate(fabric)


def setup(velocity: float, option: str, fabric: Fabric | None = None, **changes: Any) -> ImpactSetup:
    """A shot of the thesis's cylinder at S-726 with an option of OPTIONS."""
    return ImpactSetup(fabric or woven(), velocity, rate_dependence=OPTIONS[option], **changes)


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
        result.outcome, f"{result.residual_velocity:.1f}", f"{result.cut_yarns[-1]:.1f}",
        text("tension_at_failure_over_strength", ".2f"),
        f"{100 * record.energy_error_max:.3f}",
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


def main(
    *, out: Path = Path("results/strength"), page: Path | None = None, velocities: Sequence[float] = (100.0, 130.0),
    pack: Sequence[float] = (200.0,),
) -> None:  # fmt: skip
    tables = {
        "limits": of_limits, "one-ply": lambda: of_options(1, velocities),
        "four-plies": lambda: of_options(4, pack),
        "meshes": lambda: of_meshes(1.5 * velocities[-1]),
    }  # fmt: skip
    for name, table in tables.items():
        rows = table()
        write_csv(out / f"{name}.csv", rows)
        marks = f"<!-- {name} of validation.published.strength -->", f"<!-- end of {name} -->"
        publish(markdown(rows, numbers=True), page, marks)


if __name__ == "__main__":
    program(main, velocities="[m/s] at one ply", pack="[m/s] at four plies")
