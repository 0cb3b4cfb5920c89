"""The two tests on one ply of S-726, computed with what the thesis's own model leaves out.

    python -m validation.published.tests_s726 [--out results/tests-s726] [--page docs/reports/tests-s726.md]

The thesis's text gives one pair of tests (Figures 2-8 to 2-10): S-726 stopped the projectile at 96 m/s and was
perforated at 110 m/s. It names causes for a model that is too stiff: yarn data from before weaving, and yarns that slip
in the fixture. Each is computed here on its own and together: elastic projectile, edges gripped by friction, weaving
damage on modulus and strength. None of their values is measured, and none is fitted: they are laid down here as round
numbers, before any run. Writes tests-s726.csv; with --page the tables go into that page, between the marks.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from fabrics import catalogue
from fabrics.errors import InputError
from fabrics.yarn import WeavingDamage
from shellfabric.impact.ballistic_limit import critical_velocity, shoot
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.boundary import Grip
from shellfabric.panel.model import Panel
from shellfabric.projectile.projectile import Projectile
from validation.marked_page import markdown, put
from validation.program import program, write_records

FABRIC, TESTS = "S-726", {96.0: "stops", 110.0: "perforates"}  # [m/s]: outcome of the test
WORDS = {"stopped": "stops", "perforated": "perforates"}
TOLERANCE = 1.0  # [m/s] of the critical velocity
GRIPS = (20.0, 40.0, 80.0)  # [N] per yarn: 0.11, 0.21 and 0.42 of the strength of a yarn
SHARES = ((0.9, 0.9), (1.0, 0.9), (0.9, 0.8), (1.0, 0.8))  # retained (modulus, strength)
TOGETHER = (40.0, (0.9, 0.8))  # grip and shares of the case of all three
MESHES = (1, 2)  # elements per crossover, along each side
MARKS = "<!-- tables of validation.published.tests_s726 -->", "<!-- end of the tables -->"


@dataclass(frozen=True)
class Case:
    """A way to compute the tests.

    Parameters
    ----------
    name : in words
    grip : [N] per yarn, of all four sides; None clamps them
    retained : (modulus, strength) [-] after weaving
    elastic : whether the projectile is the elastic-plastic bored bar
    """

    name: str
    grip: float | None = None
    retained: tuple[float, float] = (1.0, 1.0)
    elastic: bool = False

    @property
    def damage(self) -> WeavingDamage:
        """The weaving damage, with its status."""
        return WeavingDamage(*self.retained, source="round number; not measured for this fabric", status="assumed")

    def panel(self, elements: int) -> Panel:
        """The panel of 203 mm and the projectile of 3 g, on a mesh."""
        fabric = catalogue.load(FABRIC).with_effective_density()
        if self.retained != (1.0, 1.0):
            fabric = fabric.with_weaving_damage(self.damage)
        projectile = Projectile()
        if self.elastic:
            projectile = replace(projectile, body=projectile.steel_bar())
        edge = "clamped" if self.grip is None else Grip(self.grip)
        return ImpactSetup(fabric, 100.0, projectile=projectile, edge=edge, elements_per_crossover=elements).panel()


def cases() -> tuple[Case, ...]:
    """Reference, each cause on its own, and all together."""
    force, retained = TOGETHER
    return (
        Case("clamped, yarns before weaving, rigid projectile"),
        Case("elastic projectile", elastic=True),
        *(Case(f"gripped, {grip:g} N per yarn", grip=grip) for grip in GRIPS),
        *(Case(f"weaving leaves {E:.0%} of the modulus, {S:.0%} of the strength", retained=(E, S)) for E, S in SHARES),
        Case(
            f"all three: elastic, {force:g} N per yarn, {retained[0]:.0%} and {retained[1]:.0%}", force, retained, True
        ),
    )


def compute(case: Case, elements: int) -> dict:
    """Outcomes of the tests' velocities, and the critical velocity, as texts."""
    panel, row = case.panel(elements), {"case": case.name, "elements per crossover": f"{elements}"}
    for velocity in TESTS:
        row[f"{velocity:g} m/s"] = _outcome(panel, velocity)
    try:
        found = critical_velocity(panel, tolerance=TOLERANCE, guess=115.0)
        row["critical velocity [m/s]"] = f"{found.velocity:.1f}"
    except InputError as problem:
        row["critical velocity [m/s]"] = str(problem)
    return row


def _outcome(panel, velocity):
    try:
        (shot,) = shoot(panel, [velocity])
    except InputError:
        return "neither within 5 ms"
    word = WORDS[shot.outcome]
    return word if not shot.perforated else f"{word}, {shot.residual_velocity:.0f} m/s left"


def table(rows: list[dict[str, str]]) -> str:
    """Rows as a table; what differs from the test is set bold."""
    heads = ["computed with", "elements per crossover"]
    heads += [f"{velocity:g} m/s (test: {outcome})" for velocity, outcome in TESTS.items()]
    found = [[*heads, "critical velocity, m/s", "tests met"]]
    for row in rows:
        outcomes = [row[f"{velocity:g} m/s"] for velocity in TESTS]
        met = [outcome.startswith(tested) for outcome, tested in zip(outcomes, TESTS.values())]
        shown = [outcome if good else f"**{outcome}**" for outcome, good in zip(outcomes, met)]
        critical = row["critical velocity [m/s]"]
        found.append([row["case"], row["elements per crossover"], *shown, critical, f"{sum(met)} of {len(met)}"])
    return markdown(found)


def main(*, out: Path = Path("results/tests-s726"), page: Path | None = None) -> None:
    rows = []
    for elements in MESHES:
        for case in cases():
            rows.append(compute(case, elements))
            print(" | ".join(rows[-1].values()), flush=True)
    write_records(out / "tests-s726.csv", rows)
    if page is not None:
        put(page, *MARKS, f"\n\n{table(rows)}\n")


if __name__ == "__main__":
    program(main)
