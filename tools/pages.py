"""What the documentation takes from code and from the data of studies.

    python tools/pages.py [--check]

Writes what stands between two marks of a page, and the reference pages in docs/generated (`reference_pages`).
With --check it names the pages that are out of date and ends with 1. A mark is a comment of Markdown,
`<!-- NAME of tools/pages.py --> ... <!-- end of NAME -->`; numbers and rows of tables: `page_values`.
"""

from __future__ import annotations

import subprocess
import sys
import textwrap
import tomllib
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from math import hypot, isfinite, nan
from pathlib import Path

ROOT = Path(__file__).parents[1]
DATA, GENERATED = ROOT / "docs" / "reports" / "data", ROOT / "docs" / "generated"
sys.path[:0] = [str(ROOT), str(ROOT / "tools")]

import architecture  # noqa: E402
import claims_page  # noqa: E402
import keyword_class  # noqa: E402
import page_values  # noqa: E402
import reference_pages  # noqa: E402
from claims_page import markdown  # noqa: E402

from fabrics.base.counted import counted  # noqa: E402
from shellfabric.impact.proposals import PROPOSALS  # noqa: E402
from shellfabric.membrane import quality  # noqa: E402
from shellfabric.membrane.indicator import Check  # noqa: E402
from validation import stale as moved  # noqa: E402
from validation.csv_file import read  # noqa: E402
from validation.measured import scores, statistics  # noqa: E402
from weavecell.studies import (  # noqa: E402
    biaxial_fit,
    contact_share,
    crossover_checks,
    limit_scan,
)

TESTED = 110  # [m/s] at which a ply of S-726 was perforated


QUANTITIES = {  # of convergence-means.csv, in words
    "critical_velocity": "critical velocity",
    "residual_velocity": "residual velocity",
    "absorbed_energy": "absorbed energy",
    "cut_yarns": "cut yarns",
}
TARGETS = {
    "critical_velocity": (2.0, 2.0),
    "absorbed_energy": (3.0, 5.0),
}  # [%] of one ply, of packs


def table(name: str) -> list[dict[str, str]]:
    """Read the rows of a file of docs/reports/data."""
    return read(DATA / name)[1]


@dataclass(frozen=True)
class Deviation:
    """How far a quantity of a case on the default mesh is from that on the finer one: {mesh: (value, error)}."""

    plies: int
    quantity: str
    values: dict[str, tuple[float, float]]

    @property
    def percent(self) -> tuple[float, float]:
        """(deviation, its error) [%] of the value on the finer mesh."""
        (value, error), (reference, reference_error) = (
            self.values[mesh] for mesh in ("default", "finer")
        )
        if reference == 0:
            return (0.0, 0.0) if value == 0 else (nan, nan)
        return 100 * (value / reference - 1), 100 * hypot(
            error, value / reference * reference_error
        ) / abs(reference)

    @property
    def met(self) -> bool:
        """Whether the default mesh is within the target; a value that is not known is not."""
        targets = TARGETS.get(self.quantity)
        return targets is None or abs(self.percent[0]) <= targets[self.plies > 1]


def deviations() -> dict[tuple[int, str], list[Deviation]]:
    """Collect the deviation of each quantity: {(plies, fabric): [Deviation]}."""
    meshes: dict[tuple[int, str], dict[str, dict[str, str]]] = {}
    for row in table("convergence-means.csv"):
        meshes.setdefault((int(row["plies"]), row["fabric"]), {})[row["mesh"]] = row
    return {
        (plies, fabric): [
            Deviation(plies, name, {mesh: measured(row, name) for mesh, row in rows.items()})
            for name in QUANTITIES
        ]
        for (plies, fabric), rows in meshes.items()
    }


def measured(row: dict[str, str], quantity: str) -> tuple[float, float]:
    """Read (value, error) of a quantity in a row of convergence-means.csv."""
    column = next(name for name in row if name.startswith(quantity))
    value, error = (float(row[name] or "nan") for name in (column, f"{column}_error"))
    return value, error


def mesh_errors() -> str:
    """Tabulate what plies and packs on the default mesh differ by from elements half as long, in
    %."""
    rows = [["fabric", *QUANTITIES.values()]]
    for (plies, fabric), quantities in deviations().items():
        cells = []
        for deviation in quantities:
            share, error = deviation.percent
            text = f"{share:+.1f} ± {error:.1f}" if isfinite(share) else ""
            cells.append(text if deviation.met or not text else f"**{text}**")
        rows.append([fabric if plies == 1 else f"{plies} plies, {fabric}", *cells])
    return f"\n\n{markdown(rows)}\n"


def limits_of_meshes() -> list[float]:
    """Read the middles [m/s] of the intervals of S-726 with 1, 2, ... elements per crossover."""
    rows = table("published-critical-velocities.csv")
    return [
        0.5 * (float(row["stops at [m/s]"]) + float(row["perforates at [m/s]"])) for row in rows
    ]


def tested_ply() -> str:
    """Tabulate the ply of S-726 beside its test."""
    rows = [
        [
            "elements per crossover",
            "computed, m/s",
            f"above {TESTED} m/s",
            "above the middle, 103 m/s",
        ]
    ]
    for n, V in enumerate(limits_of_meshes(), 1):
        rows.append(
            [f"{n}", f"{V:.1f}", f"{100 * (V / TESTED - 1):.1f} %", f"{100 * (V / 103 - 1):.1f} %"]
        )
    return f"\n\n{markdown(rows)}\n"


def share_above(velocity: float) -> str:
    """Say how far a limit is above the perforating test, in %."""
    return f"{100 * (velocity / TESTED - 1):.0f} %"


def front_page() -> str:
    """Tabulate how good the results are: tests first, then the mesh, then the thesis."""
    limit, v50 = s726()
    [growth] = [row for row in table("measured-quantities.csv") if row["quantity"] == GROWTH]
    ply = [quantities for (plies, _), quantities in deviations().items() if plies == 1]
    limits = [each[0].percent[0] for each in ply]
    energies = [each[2].percent[0] for each in ply]
    beyond = sum(not each[2].met for each in ply)
    packs = [quantities[2] for (plies, _), quantities in deviations().items() if plies > 1]
    of_packs = [each.percent[0] for each in packs]
    shares = claims_page.shares()
    equations = shares["equations"]
    behaviour = shares["behaviour"]
    rows = [
        ["compared with", "weavecell", "verdict"],
        [
            f"tests of S-726: stopped at 96, perforated at {TESTED}, V50 {v50['measured']} ± {v50['sigma']} m/s",
            f"limit {limit:.0f}, V50 of {v50['shots']} drawn shots {drawn(v50)} m/s",
            verdict_of_tests(v50),
        ],
        packs_of_twaron(),
        [
            "tests: growth of V50, 2 to 8 plies",
            f"{100 * (float(growth['bias']) - 1):+.0f} % in a panel of 100 mm, "
            f"{growth_in_the_panel_of_tests()} in one of 381 mm",
            count_within(
                [
                    row
                    for row in table("measured.csv")
                    if row["quantity"].startswith(GROWTH) and row["E"]
                ]
            ),
        ],
        [
            "a finer mesh, one ply, six fabrics",
            f"limit {min(limits):+.1f} to {max(limits):+.1f} %, energy {min(energies):+.1f} to {max(energies):+.1f} %",
            f"energy **missed** (3 %) for {counted(beyond, 'fabric')}",
        ],
        [
            f"a finer mesh, {len(packs)} packs of 2 to 8 plies",
            f"energy {min(of_packs):+.1f} to {max(of_packs):+.1f} %",
            f"**missed** (5 %) for {sum(not each.met for each in packs)}",
        ],
        [
            f"statements of the thesis on behaviour: {behaviour.decided} decided",
            f"{behaviour.reproduced} reproduced",
            f"{behaviour.missed} **missed**",
        ],
        [
            f"equations and closed forms of the thesis: {equations.decided}",
            f"{equations.reproduced} as there",
            f"{equations.missed} differ",
        ],
    ]
    return f"\n\n{markdown(rows)}\n{of_earlier_code(OF_TESTS)}\n"


# {study: what pages say of it}
LIMIT = "limit of one ply"
LIMITS = "its limits over the meshes"
OF_STUDIES = {"one-ply": LIMIT, "published-critical-velocities": LIMITS}
# what the front page has of tests
GROWTH = "growth of V50 from 2 to 8 plies"  # in a panel of 100 mm
OF_TESTS = (LIMIT, "V50 of packs", GROWTH, f"{GROWTH} in 381 mm")


def of_earlier_code(quantities: Collection[str]) -> str:
    """Say which of these quantities are of earlier code, and before what; nothing if none is.

    Parameters
    ----------
    quantities : of measured.csv and of OF_STUDIES
    """
    quantity_of = {row["id"]: row["quantity"] for row in table("measured.csv")}
    found: dict[str, list[str]] = {}
    for entry in moved.read():
        name = None
        if entry["study"] == moved.MEASURED:
            name = quantity_of[entry["row"]]
        elif entry["column"] == moved.INPUTS:
            name = OF_STUDIES.get(entry["study"])
        names = found.setdefault(entry["reason"], [])
        if name in quantities and name not in names:
            names.append(name)
    told = [f"{listing(names)}, from before {reason}" for reason, names in found.items() if names]
    if not told:
        return ""
    return textwrap.fill(f"To be computed again: {'; '.join(told)}.", 120)


def listing(names: Sequence[str]) -> str:
    """Write names with commas, and "and" before the last."""
    *others, last = names
    if not others:
        return last
    return f"{', '.join(others)} and {last}"


def packs_of_twaron() -> list[str]:
    """Write the row of the computed V50 of packs against their tests."""
    rows = [
        row
        for row in table("measured.csv")
        if row["quantity"] == "V50 of packs" and row["computed"]
    ]
    first = rows[0]
    last = rows[-1]
    plies = f"{first['id'].split()[1]} to {last['id'].split()[1]}"
    measured = f"{first['measured']} ± {first['sigma']} to {last['measured']} ± {last['sigma']}"
    computed = f"{float(first['computed']):.0f} to {float(last['computed']):.0f}"
    return [
        f"tests of {len(rows)} Twaron packs of {plies} plies: V50 {measured} m/s",
        f"{computed} m/s",
        count_within(rows),
    ]


def count_within(rows: Sequence[dict[str, str]]) -> str:
    """Say how many measured rows are within, and how wide u_val is."""
    shares = [100 * float(row["u_val"]) / float(row["computed"]) for row in rows]
    ends = dict.fromkeys(f"{end:.0f}" for end in (min(shares), max(shares)))
    within = sum(map(statistics.is_within, rows))
    return f"{within} of {len(rows)} within (u_val {' to '.join(ends)} %)"


def s726() -> tuple[float, dict[str, str]]:
    """Read the critical velocity of one ply of S-726 [m/s], and the row of scored.csv of its V50."""
    ply = next(row for row in table("one-ply.csv") if row["fabric"] == "S-726")
    v50 = next(row for row in table("scored.csv") if row["id"] == "S-726 V50")
    return float(ply["critical velocity [m/s]"]), v50


def drawn(row: dict[str, str]) -> str:
    """Write the middle of a drawn number, and the ends of its 90 % interval."""
    low, middle, high = (float(row[f"{level} %"]) for level in (5, 50, 95))
    return f"{middle:.0f} ({low:.0f} to {high:.0f})"


def verdict_of_tests(row: dict[str, str]) -> str:
    """Return the verdict on the two tests of a ply and on their V50, a row of scored.csv."""
    off = 100 * (float(row["50 %"]) / float(row["measured"]) - 1)
    return f"perforation **missed**; V50 {off:+.0f} %, {place_of_test(row)}"


def place_of_test(row: dict[str, str]) -> str:
    """Say whether a test lies in the 90 % interval of what was drawn."""
    if row["inside 90 %"] == "yes":
        return "test in the 90 % interval"
    return "test **outside** of the 90 % interval"


def scored() -> str:
    """Say what drawn predictions of tests come to."""
    return "\n" + textwrap.fill(scores.write_sentence(table("scored.csv")), 120) + "\n"


def two_tests() -> str:
    """Say what the two tests of one ply say; the same words stand on every page."""
    limit, v50 = s726()
    text = (
        f"one ply of S-726 stopped the cylinder at 96 m/s and was perforated at {TESTED} m/s. "
        f"The computed critical velocity, of yarns of equal strength, is {limit:.0f} m/s: the stop is met, the "
        f"perforation **missed**. V50 of {v50['shots']} drawn shots, and its 90 % interval, is {drawn(v50)} m/s, "
        f"that of the tests {v50['measured']} ± {v50['sigma']} m/s: {place_of_test(v50)}. "
        f"{of_earlier_code((LIMIT, LIMITS))}"
    )
    return "\n" + textwrap.fill(text, 120)


def measured_of_earlier_code() -> str:
    """Say which measured rows are of earlier code."""
    quantities = {row["quantity"] for row in table("measured.csv")}
    return f"\n\n{of_earlier_code(quantities)}\n\n"


def coverage_by_level() -> str:
    """Tabulate how many measured numbers with a u_val lie in the intervals of 50 and 90 %, by level."""
    judged = [row for row in table("measured.csv") if row["E_over_u_val"]]
    rows = [["level", "numbers", "in the interval of 50 %", "of 90 %"]]
    for level in (*dict.fromkeys(row["level"] for row in judged), "all"):
        own = [row for row in judged if level in (row["level"], "all")]
        numbers = [level, str(len(own))]
        for coverage in (statistics.MIDDLE, statistics.COVERAGE):
            inside = sum(statistics.is_within(row, coverage) for row in own)
            numbers.append(f"{inside} ({inside / len(own):.0%})")
        rows.append(numbers)
    return f"\n\n{markdown(rows)}\n"


def critical_velocities() -> str:
    """Tabulate the critical velocities of one ply of the six fabrics, beside the shots of the
    captions."""
    rows = [["fabric", "default mesh", "elements half as long", "simulated in the thesis"]]
    shots = [row for row in table("published-shots.csv") if row["kind"] == "caption, one ply"]
    for (plies, fabric), quantities in deviations().items():
        if plies > 1:
            continue
        velocity = next(
            deviation for deviation in quantities if deviation.quantity == "critical_velocity"
        )
        at = {
            end: [
                row["strike velocity [m/s]"]
                for row in shots
                if (row["fabric"], row["thesis"]) == (fabric, end)
            ]
            for end in ("stops", "perforates")
        }
        ends = f"{max(at['stops'], key=float)} to {min(at['perforates'], key=float)}"
        rows.append(
            [fabric, *(f"{velocity.values[mesh][0]:.1f}" for mesh in ("default", "finer")), ends]
        )
    return f"\n\n{markdown(rows)}\n"


def compression_laws() -> str:
    """Tabulate a and b of the 3D crossover over the published ones, by what the solid law has."""
    heads = ("fibre fraction stated", "of the mesh", "solid fitted to its own platen curve")
    rows = [["a, b over published", *heads]]
    laws = {(row["fabric"], row["fibre_fraction"]): row for row in table("calibration.csv")}
    fitted = {row["fabric"]: row for row in table("calibration-chain.csv")}
    for fabric, own in fitted.items():
        columns = (laws[fabric, "stated"], laws[fabric, "mesh"], own)
        ratios = [[float(row[f"{key} / published"]) for key in "ab"] for row in columns]
        rows.append([fabric, *("{:.2f}, {:.2f}".format(*pair) for pair in ratios)])
    return f"\n\n{markdown(rows)}\n"


# of runs, then of studies; a test finds those that are missing here
CHECKS: tuple[Check, ...] = (
    *quality.CHECKS.values(),
    limit_scan.MIXED,
    contact_share.WITHOUT_CONTACT,
    biaxial_fit.WIDEST,
    biaxial_fit.LIKENESS,
    biaxial_fit.PREDICTION,
    crossover_checks.DISTORTION,
    crossover_checks.OVERLAP,
    crossover_checks.MISSED,
    crossover_checks.CUT_SHORT,
    crossover_checks.PRESSED,
    crossover_checks.BEYOND_STRENGTH,
)


def doubtful_results() -> str:
    """Tabulate what to do about each check that is beyond its limit; checks of one advice share a
    row."""
    names: dict[str, list[str]] = {}
    for check in CHECKS:
        words = {name: f"`{proposal.words}`" for name, proposal in PROPOSALS.items()}
        names.setdefault(check.advice.format(**words), []).append(check.name)
    rows = [["indicator", "what to do"]]
    rows += [[", ".join(checks), advice] for advice, checks in names.items()]
    return f"\n\n{markdown(rows)}\n"


def quality_checks() -> str:
    """Tabulate limit and meaning of each check."""
    rows = [["indicator", "doubtful above", "its value is"]]
    for check in CHECKS:
        limit = f"{check.limit:g} {check.unit}".strip()
        if check.note is not None:
            limit += f" (noted: {check.note:g})"
        rows.append([check.name, limit, check.meaning])
    return f"\n\n{markdown(rows)}\n"


def not_here() -> str:
    """List what weavecell does not have (docs/not_here.toml)."""
    entries = tomllib.loads((ROOT / "docs" / "not_here.toml").read_text("utf-8"))["entry"]
    lines = [f"- {entry['text']}" for entry in entries]
    return "\n\n" + "\n".join(lines) + "\n\n"


# page -> {name of a mark: text between it and its end}
MARKED: dict[str, dict[str, Callable[[], str]]] = {
    "README.md": {"scored": scored, "accuracy": front_page},
    "docs/accuracy.md": {"mesh errors": mesh_errors, "quality checks": quality_checks},
    "docs/from-other-codes.md": {"not here": not_here},
    "docs/questions.md": {"doubtful results": doubtful_results},
    "docs/validation.md": {
        "scored": scored,
        "two tests": two_tests,
        "tested ply": tested_ply,
        "critical velocities": critical_velocities,
        "claims": claims_page.in_words,
    },
    "docs/reports/measured.md": {
        "earlier code": measured_of_earlier_code,
        "coverage": coverage_by_level,
    },
    "docs/reports/material-tests.md": {"compression laws": compression_laws},
    "validation/reports/claims.md": {
        "how they were made": claims_page.made,
        "verdicts": claims_page.verdicts,
        "missed claims": claims_page.missed,
        "open claims": claims_page.open_claims,
        "turned claims": claims_page.turned,
    },
    "weavecell/api/keywords.py": {"keywords": keyword_class.text},
}
PAGES = [*MARKED, *(page for page in page_values.pages() if page not in MARKED)]


def growth_in_the_panel_of_tests():
    """Say how far the growth of V50 is off the tests in a panel of 381 mm."""
    rows = {row["id"]: row for row in table("measured.csv")}
    off = []
    for name, nose in ((FRAGMENTS, "fragment"), (SPHERES, "sphere")):
        row = rows[f"{name}, 381 mm"]
        off.append(f"{100 * (float(row['computed']) / float(row['measured']) - 1):+.0f} % ({nose})")
    return " and ".join(off)


FRAGMENTS = "Prosser, fragment simulator"
SPHERES = "Prosser, rounded .22"


def made(page: str) -> str:
    """Make the text that a page should have."""
    text = (ROOT / page).read_text("utf-8")
    for name, content in MARKED.get(page, {}).items():
        begin, end = f"<!-- {name} of tools/pages.py -->", f"<!-- end of {name} -->"
        before, begins, rest = text.partition(begin)
        _, ends, after = rest.partition(end)
        if not (begins and ends):
            raise SystemExit(f"{page} has no marks {begin} ... {end}")
        text = before + begin + content() + end + after
    return page_values.filled(text)


# tables of studies that the product reads: {copy: the file of docs/reports/data}
COPIES = {"weavecell/studies/models_of_scenes.csv": "models-of-scenes.csv"}


def stale_copies() -> list[str]:
    """List the copies of tables that are out of date."""
    found = []
    for copy, name in COPIES.items():
        path = ROOT / copy
        if not path.is_file() or path.read_bytes() != (DATA / name).read_bytes():
            found.append(copy)
    return found


def stale() -> list[str]:
    """List the pages that are out of date."""
    marked = [page for page in PAGES if (ROOT / page).read_text("utf-8") != made(page)]
    kept = reference_pages.stale(GENERATED, reference_pages.kept_pages())
    return marked + stale_copies() + [f"docs/generated/{name}" for name in kept]


def main() -> None:
    """Run the command line."""
    pages = stale()
    if sys.argv[1:] == ["--check"]:
        sys.exit("".join(f"out of date: {page}\n" for page in pages) or 0)
    for page in set(pages) & set(PAGES):
        (ROOT / page).write_text(made(page), "utf-8")
    for copy in stale_copies():
        (ROOT / copy).write_bytes((DATA / COPIES[copy]).read_bytes())
    # by a process that imports the keywords of Python as they are now
    subprocess.run([sys.executable, str(ROOT / "tools" / "reference_pages.py")], check=True)
    for page in pages:
        print(f"written: {page}")
    architecture.diagram()


if __name__ == "__main__":
    main()
