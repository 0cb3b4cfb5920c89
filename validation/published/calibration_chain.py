"""What a platen curve leaves open of a shot: critical and residual velocity with the laws of the calibration chain.

    python -m validation.published.calibration_chain CHAIN [--fabric S-720] [--velocity 155] [--out DIR] [--page PAGE]

CHAIN is the folder of `weavecell calibrate --all --fit-solid`. The standard panel of the thesis is shot at with the
published law, with that of the solid of the fabric's file, with that of the fitted solid, and with the laws at both
95 % ends of each principal direction of its constants. The changes of the directions add as squares. Writes shell.csv;
with --page the table goes into that page, between its marks.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from fabrics import catalogue, run_cache
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError
from shellfabric.impact import ballistic_limit
from shellfabric.impact.simulation import ImpactSetup
from unitcell3d.identify.chain import combine
from validation.program import program, write_csv
from weavecell.report.marked_page import markdown, put
from weavecell.results import provenance

TOLERANCE = 1.0  # [m/s] between a stop and a perforation
MARKS = "<!-- shots of the chain -->", "<!-- end of the shots -->"
PUBLISHED, FILE, FITTED = "published", "solid of the file", "fitted solid"
HEAD = ["law", "a, mm", "b, mm N^(1/3)", "critical velocity, m/s", "residual velocity, m/s"]


@dataclass(frozen=True)
class Case:
    """A fabric of the catalogue with a law (a [m], b [m N^(1/3)]), and a strike velocity [m/s]."""

    fabric: str
    a: float
    b: float
    velocity: float


def shoot(case: Case) -> dict:
    """Critical velocity, middle of its bracket, and residual velocity [m/s] at the strike velocity."""
    law = CompressionLaw(case.a, case.b, "regularised")
    fabric = catalogue.load(case.fabric).with_effective_density()
    panel = ImpactSetup(fabric, case.velocity, laws=(law, law)).panel()
    found = ballistic_limit.critical_velocity(panel, tolerance=TOLERANCE)
    (shot,) = ballistic_limit.shoot(panel, [case.velocity])
    return {"critical": found.velocity, "residual": shot.residual_velocity}


def laws(chain: Path, fabric: str) -> tuple[dict, list]:
    """{name: (a, b)} of the three laws, and [((a, b) or None, the same)] of the ends of each direction.

    Raises
    ------
    InputError : the folder has no chain of this fabric
    """
    folder, published = chain / fabric, catalogue.load(fabric).laws
    if not (folder / "law-interval.json").exists():
        raise InputError(f"has no calibration chain of {fabric}", file=chain)
    found = {
        FILE: CompressionLaw.from_json(folder / "solid-of-the-file" / "law.json"),
        FITTED: CompressionLaw.from_json(folder / "law.json"),
    }
    interval = json.loads((folder / "law-interval.json").read_text("utf-8"))
    if published:
        found = {PUBLISHED: published[0], **found}
    middle, fitted = interval["law_of_their_middle"], found[FITTED]

    def about(end):
        """An end's law about the fitted one: the ends are of a mesh of their own."""
        if end is None:
            return None
        return end["a_m"] / middle["a_m"] * fitted.a, end["b_m_N^(1/3)"] / middle["b_m_N^(1/3)"] * fitted.b

    ends = [tuple(map(about, pair)) for pair in interval["laws_of_the_limits_of_solid.json"]]
    return {name: (law.a, law.b) for name, law in found.items()}, ends


def table(named: dict, ends: list, shots: dict) -> list[list[str]]:
    """A header, a row a law, and the intervals of the fitted one; `shots` {(a, b): what `shoot` found}."""
    rows = [HEAD]
    for name, (a, b) in named.items():
        found = shots[a, b]
        rows.append([name, f"{1e3 * a:.4f}", f"{1e3 * b:.4f}", f"{found['critical']:.1f}", f"{found['residual']:.1f}"])
    best = shots[named[FITTED]]
    intervals = []
    for key in ("critical", "residual"):
        pairs = [[None if end is None else shots[end][key] for end in pair] for pair in ends]
        intervals.append("{:.1f} .. {:.1f}".format(*combine(best[key], pairs)))
    rows.append([f"{FITTED}, 95 %", *_law_intervals(named[FITTED], ends), *intervals])
    return rows


def _law_intervals(fitted, ends):
    for i in (0, 1):
        low, high = combine(fitted[i], [[None if end is None else end[i] for end in pair] for pair in ends])
        yield f"{1e3 * low:.4f} .. {1e3 * high:.4f}"


def main(
    chain: Path,
    *,
    fabric: str = "S-720",
    velocity: float = 155.0,
    out: Path = Path("results/chain-shots"),
    jobs: int = 1,
    page: Path | None = None,
) -> None:
    stamp = provenance.stamp()  # before a page of the checkout is written to
    named, ends = laws(chain, fabric)
    pairs = list(dict.fromkeys([*named.values(), *(end for pair in ends for end in pair if end is not None)]))
    cases = [(Case(fabric, a, b, velocity),) for a, b in pairs]
    found = run_cache.results(shoot, cases, folder=out / "runs", jobs=jobs)
    rows = table(named, ends, dict(zip(pairs, found)))
    write_csv(out / "shell.csv", rows)
    made = markdown(rows)
    print(made)
    if page is not None:
        text = (
            f"{fabric}, residual velocity at {velocity:g} m/s; made by `python -m "
            f"validation.published.calibration_chain`, commit {stamp['commit']}, {stamp['date']}."
        )
        put(page, *MARKS, f"\n\n{text}\n\n{made}\n")


if __name__ == "__main__":
    program(main, velocity="strike velocity of the residual velocity [m/s]")
