"""The published shots at panels of one ply and at packs, computed on several meshes, beside the thesis's outcomes.

    python -m validation.published.shots [--out results/published-shots] [--page docs/reports/published-shots.md]
        [--only-packs]

Writes shots.csv (one row a shot) and critical-velocities.csv. With --page the tables made from them go into that page,
between its marks, and the two files into data/ beside it. Runs are kept in the folder under a digest of the case and of
the solver, so that an interrupted study continues where it was. With --only-packs the shots at one ply are not fired:
their rows are taken from data/ beside the page.

The captions of one ply are those of thesis Figures 5-4 to 5-15, of simulations; the two tests on S-726 are those of
Figures 2-8 to 2-10; the captions of packs are those of section 5.2.2.
"""

from __future__ import annotations

import csv
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import catalogue
from fabrics.errors import InputError
from shellfabric.impact import ballistic_limit
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.projectile.projectile import Projectile
from validation.marked_page import markdown
from validation.program import program, publish, write_records
from validation.published.packs import study as packs

if TYPE_CHECKING:
    from shellfabric.panel.model import Panel

STOPS, PERFORATES = "stops", "perforates"
WORDS = {"stopped": STOPS, "perforated": PERFORATES}
CAPTIONS = {  # fabric: [m/s] at which the thesis's simulation of one ply stops and is perforated
    "S-720": (92.5, 155.0),
    "S-726": (96.0, 174.0),
    "S-727": (40.0, 158.0),
    "S-728": (76.0, 170.0),
    "S-731": (116.0, 132.0),
    "S-745": (110.0, 215.0),
}
MESHES = (1, 2, 3)  # elements per crossover, along each side
TESTED, TESTS, TEST_MESHES = "S-726", (96.0, 110.0), (1, 2, 3, 4)  # [m/s] stopped and perforated in the test
BAR_MESHES = {"S-720": MESHES}  # of the shots with an elastic bar; one element elsewhere
TOLERANCE = 0.25  # [m/s] between a stop and a perforation
ONE_PLY, TEST, PACK = "caption, one ply", "test, one ply", "caption, pack"
FILES = ("shots.csv", "critical-velocities.csv")
MARKS = tuple((f"<!-- {name} of validation.published.shots -->", f"<!-- end of {name} -->")
              for name in ("captions", "bars", "tests", "packs"))  # fmt: skip


@dataclass(frozen=True)
class Case:
    """One shot at one ply.

    Parameters
    ----------
    fabric, velocity : [-, m/s]
    elements : per crossover, along each side
    body : of the projectile, "rigid" or "elastic_bar"
    """

    fabric: str
    velocity: float
    elements: int = 1
    body: str = "rigid"


@dataclass(frozen=True)
class Search:
    """Bisection for the critical velocity of one ply; `guess` [m/s] as in `ballistic_limit.critical_velocity`."""

    fabric: str
    elements: int
    guess: float | None = None


@cache
def panel(fabric: str, elements: int, body: str) -> Panel:
    """The clamped panel of 203 mm and the projectile of 3 g of one case."""
    setup = ImpactSetup(
        catalogue.load(fabric).with_effective_density(),
        100.0,
        projectile=Projectile(body=body),
        elements_per_crossover=elements,
    )
    return setup.panel()


def fire(case: Case) -> dict[str, Any]:
    """One shot: a dict of numbers, for a file."""
    began = time.process_time()
    (shot,) = ballistic_limit.shoot(panel(case.fabric, case.elements, case.body), [case.velocity])
    return asdict(shot) | {"failed": [shot.cut_yarns], "cpu": time.process_time() - began}


def search(case: Search) -> dict[str, Any]:
    """Critical velocity: a dict of numbers, for a file."""
    near: dict[str, Any] = {} if case.guess is None else {"guess": case.guess, "step": 1.02}
    began = time.process_time()
    found = ballistic_limit.critical_velocity(panel(case.fabric, case.elements, "rigid"), tolerance=TOLERANCE, **near)
    return {
        "low": found.low, "high": found.high, "failed": [0], "time": 0.0, "cpu": time.process_time() - began,
        "outcome": f"critical velocity {found.velocity:.1f} m/s",
    }  # fmt: skip


def single_shots(results: Callable[..., dict[str, Any]]) -> list[dict[str, str]]:
    """Rows of the shots at one ply."""
    rows = []
    for fabric, velocities in CAPTIONS.items():
        for velocity, expected in zip(velocities, (STOPS, PERFORATES)):
            for elements in MESHES:
                rows.append(_row(ONE_PLY, results, Case(fabric, velocity, elements), expected))
        for elements in BAR_MESHES.get(fabric, (1,)):
            rows.append(_row(ONE_PLY, results, Case(fabric, velocities[1], elements, "elastic_bar"), PERFORATES))
    for velocity, expected in zip(TESTS, (STOPS, PERFORATES)):
        for elements in TEST_MESHES:
            rows.append(_row(TEST, results, Case(TESTED, velocity, elements), expected))
    return rows


def _row(kind, results, case, expected):
    found = results(case, fire)
    return {
        "kind": kind, "fabric": case.fabric, "plies": "1", "strike velocity [m/s]": f"{case.velocity:g}",
        "elements per crossover": f"{case.elements}", "projectile": case.body, "thesis": expected,
        "computed": WORDS[found["outcome"]], "time [us]": f"{1e6 * found['time']:.0f}",
        "residual velocity [m/s]": f"{found['residual_velocity']:.1f}", "cut yarns": f"{found['failed'][0]:.1f}",
        "energy balance [%]": f"{100 * found['balance']:.3f}",
    }  # fmt: skip


def pack_shots(results: Callable[..., dict[str, Any]]) -> list[dict[str, str]]:
    """Rows of the nine shots at packs."""
    rows = []
    for fabric, plies, velocity, published, found in packs.outcomes(results):
        rows.append({
            "kind": PACK, "fabric": fabric, "plies": f"{plies}", "strike velocity [m/s]": f"{velocity:g}",
            "elements per crossover": "2 about the impact point", "projectile": "rigid", "thesis": published.split()[0],
            "computed": WORDS[found["outcome"]], "time [us]": f"{1e6 * found['time']:.0f}",
            "residual velocity [m/s]": f"{found['residual_velocity']:.1f}",
            "cut yarns": f"{sum(found['failed']):.1f}",
            "energy balance [%]": f"{100 * found['balance']:.3f}",
        })  # fmt: skip
    return rows


def critical_velocities(results: Callable[..., dict[str, Any]]) -> list[dict[str, str]]:
    """Rows of the critical velocity of the tested fabric on its meshes."""
    rows, guess = [], None
    for elements in TEST_MESHES:
        found = results(Search(TESTED, elements, guess), search)
        guess = 0.5 * (found["low"] + found["high"])
        rows.append({
            "fabric": TESTED, "elements per crossover": f"{elements}", "stops at [m/s]": f"{found['low']:.2f}",
            "perforates at [m/s]": f"{found['high']:.2f}",
        })  # fmt: skip
    return rows


def captions(shots: list[dict[str, str]]) -> str:
    """One row a caption of one ply, one column a mesh; what differs from the caption is set bold."""
    rows = [["fabric", "strike, m/s", "thesis", *(f"computed, {_elements(n)}" for n in MESHES)]]
    for fabric, velocities in CAPTIONS.items():
        for velocity in velocities:
            found = [s for s in _of(shots, ONE_PLY, fabric, velocity) if s["projectile"] == "rigid"]
            rows.append([fabric, f"{velocity:g}", found[0]["thesis"], *map(_outcome, found)])
    counts = []
    for n in MESHES:
        found = [s for s in shots if s["kind"] == ONE_PLY and s["projectile"] == "rigid"
                 and s["elements per crossover"] == f"{n}"]  # fmt: skip
        counts.append(f"{sum(s['computed'] == s['thesis'] for s in found)} of {len(found)}")
    return markdown([*rows, ["as the caption says", "", "", *counts]])


def bars(shots: list[dict[str, str]]) -> str:
    """One row a perforating caption and mesh: rigid projectile and elastic bar."""
    rows = [["fabric", "strike, m/s", "elements per crossover", "thesis", "computed, rigid", "computed, elastic bar"]]
    for fabric, (_, velocity) in CAPTIONS.items():
        found = _of(shots, ONE_PLY, fabric, velocity)
        for bar in (s for s in found if s["projectile"] == "elastic_bar"):
            n = bar["elements per crossover"]
            (rigid,) = (s for s in found if s["elements per crossover"] == n and s["projectile"] == "rigid")
            rows.append([fabric, f"{velocity:g}", n, bar["thesis"], _outcome(rigid), _outcome(bar)])
    return markdown(rows)


def tests(shots: list[dict[str, str]], limits: list[dict[str, str]]) -> str:
    """One row a mesh: the two tests on S-726, and the critical velocity over what they say of it."""
    low, high = TESTS
    middle = 0.5 * (low + high)
    heads = ["elements per crossover", *(f"{v:g} m/s (test: {t})" for v, t in zip(TESTS, (STOPS, PERFORATES)))]
    rows = [[*heads, "critical velocity, m/s", f"above {high:g} m/s by", f"above the middle, {middle:g} m/s, by"]]
    for one in limits:
        n = one["elements per crossover"]
        found = [s for v in TESTS for s in _of(shots, TEST, TESTED, v) if s["elements per crossover"] == n]
        V = 0.5 * (float(one["stops at [m/s]"]) + float(one["perforates at [m/s]"]))
        over = (f"{100 * (V / x - 1):.1f} %" for x in (high, middle))
        rows.append([n, *map(_outcome, found), f"{V:.1f}", *over])
    return markdown(rows)


def multi_ply(shots: list[dict[str, str]]) -> str:
    """One row a shot at a pack."""
    rows = [["plies", "fabric", "strike, m/s", "thesis", "computed", "erratum E-21 on the caption"]]
    found = [s for s in shots if s["kind"] == PACK]
    judged = {row[:3]: row[3].partition("(")[2].partition(",")[0] for row in packs.PUBLISHED}
    for s in found:
        key = (s["fabric"], int(s["plies"]), float(s["strike velocity [m/s]"]))
        rows.append([s["plies"], s["fabric"], s["strike velocity [m/s]"], s["thesis"], _outcome(s), judged[key]])
    same = sum(s["computed"] == s["thesis"] for s in found)
    return markdown([*rows, ["as the caption says", "", "", "", f"{same} of {len(found)}", ""]])


def tables(shots: list[dict[str, str]], limits: list[dict[str, str]]) -> tuple[str, ...]:
    """The tables of the page, one between each pair of MARKS."""
    return captions(shots), bars(shots), tests(shots, limits), multi_ply(shots)


def _of(shots, kind, fabric, velocity):
    return [s for s in shots if (s["kind"], s["fabric"], float(s["strike velocity [m/s]"])) == (kind, fabric, velocity)]


def _outcome(shot):
    text = shot["computed"]
    if text == PERFORATES:
        text += f", {float(shot['residual velocity [m/s]']):.0f} m/s left"
    return text if shot["computed"] == shot["thesis"] else f"**{text}**"


def _elements(n):
    return f"{n} element{'s' * (n > 1)} per crossover"


def read(path: Path) -> list[dict[str, str]]:
    """Rows of a table written by this study, as dicts of texts."""
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def content_of(results: Callable[..., dict[str, Any]], data: Path | None = None) -> tuple[list[dict[str, str]], ...]:
    """Rows of both tables; those of one ply from a folder with tables of this study, where one is given."""
    if data is None:
        single, limits = single_shots(results), critical_velocities(results)
    else:
        stored, limits = (read(data / f"published-{name}") for name in FILES)
        single = [row for row in stored if row["kind"] != PACK]
    return [*single, *pack_shots(results)], limits


def main(*, out: Path = Path("results/published-shots"), page: Path | None = None, only_packs: bool = False) -> None:
    if only_packs and page is None:
        raise InputError(key="--only-packs", value=True, allowed="with --page, which has the rows of one ply beside it")
    content = content_of(packs.kept(out / "shots"), page.parent / "data" if page and only_packs else None)
    made = tables(*content)
    for rows, name in zip(content, FILES):
        write_records(out / name, rows)
        if page is not None:
            write_records(page.parent / "data" / f"published-{name}", rows)
    for marks, table in zip(MARKS, made):
        publish(table, page, marks)


if __name__ == "__main__":
    program(main, only_packs="fire the shots at packs alone, and keep the rows of one ply of the page")
