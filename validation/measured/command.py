"""Compute the rows of validation/measured/rows.csv and hold them against the tests.

Writes measured.csv (measured, computed, E and u_val of each row), measured-clamps.csv and measured.png. With --page the
tables go into that page, the files into data/ and figures/ beside it, and what `weavecell impact --uncertainty` prints
of the tests into weavecell/report/against_tests.csv. Rows that are not computed anew stay as they are there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot, isnan
from pathlib import Path
from typing import Any

from pandas import read_csv

from fabrics import run_cache
from validation.marked_page import markdown
from validation.measured import clamps, statistics
from validation.measured.pictures_scatter import draw
from validation.measured.rows import Row, compute, number, read
from validation.program import publish_all, save, write_records
from weavecell.report.chapters_discretisation import AGAINST_TESTS
from weavecell.results import provenance

NOTES = {
    "quick": "the cheap run of each row alone, at most 10 minutes on two cores; nothing is written for the release",
    "parts": "of crossover, ply, pack, backing, clamps: what is computed; the rest is as it is in measured.csv",
}
PARTS = ("crossover", "ply", "pack", "backing", "clamps")
DATA = Path(__file__).parents[2] / "docs" / "reports" / "data"
FILES = "measured.csv", "measured-clamps.csv"
RUN = ("computed", "coarse", "error", "energy_error", "commit")  # columns that a run fills


def main(
    parts: Sequence[str] = (),
    *,
    out: Path = Path("results/measured"),
    page: Path | None = None,
    quick: bool = False,
    jobs: int = 1,
) -> None:
    parts, stamp, rows = parts or PARTS[: -1 if quick else None], provenance.stamp(), read()
    runs: dict[str, Any] = {"folder": out / "runs", "jobs": jobs}
    cases = {row.id: (None if quick else row.case, row.coarse_case) for row in rows if row.level in parts}
    wanted = list(dict.fromkeys(case for pair in cases.values() for case in pair if case is not None))
    found = dict(zip(wanted, run_cache.results(compute, [(case,) for case in wanted], **runs)))
    kept = {row["id"]: row for row in _table(FILES[0])}
    new = {id: _ran(found, *pair, stamp["commit"]) for id, pair in cases.items() if any(pair)}
    table = [held(row, new.get(row.id) or kept.get(row.id, {})) for row in rows]
    shots = _table(FILES[1])
    if "clamps" in parts:
        varied, each = zip(*clamps.shots())
        fired = run_cache.results(clamps.fire, [(case,) for case in each], **runs)
        shots = [one | shot | {"commit": stamp["commit"]} for one, shot in zip(varied, fired)]
    figures, data = (out, out) if page is None else (page.parent / "figures", page.parent / "data")
    write_records(data / FILES[0], table)
    write_records(data / FILES[1], shots)
    quantities = summary(table)
    save(draw, table, quantities, to=figures / "measured.png")
    if page is not None and not quick:
        write_records(AGAINST_TESTS, quantities)
    texts = {"quantities": markdown(in_words(quantities)), "clamps": markdown(of_clamps(shots))}
    publish_all(texts, page, "validation measured", stamp)


def _table(name):
    return read_csv(DATA / name, dtype=str, keep_default_na=False).to_dict("records")


def _ran(found, case, coarse, commit):
    """The columns of RUN from the results of a row's two cases."""
    value, error, balance = found[case or coarse]
    cheap = "" if coarse is None else found[coarse][0]
    cells = dict(zip(RUN, ("" if case is None else value, cheap, error, balance, commit)))
    return {key: f"{cell:.4g}" if isinstance(cell, float) else cell for key, cell in cells.items()}


def held(row: Row, ran: Mapping[str, str]) -> dict[str, Any]:
    """A row of measured.csv: with E, u_num, u_input and u_val where a number is computed.

    u_num is the difference of the two runs of the row and its standard error, where both runs are there.
    """
    known: dict[str, Any] = {key: getattr(row, key) for key in ("id", "level", "quantity", "unit")}
    known |= {"measured": row.value, "sigma": row.sigma} | {key: ran.get(key, "") for key in RUN}
    known |= dict.fromkeys(("E", "u_num", "u_input", "u_val", "E_over_u_val"), "")
    computed = number(known["computed"] or known["coarse"])
    if not isnan(computed) and not isnan(number(row.value)):
        step = abs(number(known["computed"]) - number(known["coarse"]))
        u_num = hypot(number(known["error"]), 0.0 if isnan(step) else step)
        u_input, u_test = float(row.u_input or 0) * abs(computed), float(row.sigma)
        u_val = hypot(u_num, u_input, u_test)
        values = computed - number(row.value), u_num, u_input, u_val, (computed - number(row.value)) / u_val
        known |= {key: f"{x:.3g}" for key, x in zip(("E", "u_num", "u_input", "u_val", "E_over_u_val"), values)}
    return known | {"source": row.source, "assumed": row.assumed}


def summary(table: Sequence[Mapping[str, str]]) -> list[dict[str, Any]]:
    """A row a quantity that is computed: n, how many rows are met, bias and sigmas; "" where there is none.

    An outcome is met where it is the same, a number where it is within 2 u_val. Numbers that may be 0 have no bias.
    """
    found = []
    for name in dict.fromkeys(row["quantity"] for row in table if row["computed"] or row["coarse"]):
        rows = [row for row in table if row["quantity"] == name and (row["computed"] or row["coarse"])]
        values = [row["computed"] or row["coarse"] for row in rows]
        met = [row["measured"] == value or abs(number(row["E_over_u_val"])) <= 2 for row, value in zip(rows, values)]
        one: dict[str, Any] = {"level": rows[0]["level"], "quantity": name, "words": "", "n": len(rows)}
        one |= {"met": sum(met), "bias": "", "sigma_model": "", "sigma_test": ""}
        words = f"{sum(met)} within the uncertainty"
        measured, computed = ([*map(number, each)] for each in ((row["measured"] for row in rows), values))
        if min(*measured, *computed) > 0:
            of = statistics.of(measured, computed, [float(row["sigma"]) for row in rows])
            one |= {key: "" if isnan(value) else f"{value:.3f}" for key, value in vars(of).items()}
            words = f"bias {of.bias:.2f}" + ("" if isnan(of.sigma_model) else f", sigma {of.sigma_model:.0%}")
        one["words"] = f"{words}, n = {len(rows)}"
        found.append(one | {"commit": " ".join(dict.fromkeys(row["commit"] for row in rows))})
    return found


def in_words(quantities: Sequence[Mapping[str, Any]]) -> list[list[Any]]:
    """The table of the page."""
    heads = ["quantity", "n", "within 2 u_val", "bias", "sigma of the model", "sigma of the tests"]
    keys = ("quantity", "n", "met", "bias", "sigma_model", "sigma_test")
    return [heads, *([one[key] if one[key] != "" else "–" for key in keys] for one in quantities)]


def of_clamps(shots: Sequence[Mapping[str, Any]], friction: str = "0.15") -> list[list[Any]]:
    """Outcomes of S-726 and slip of S-728 by the force of the clamps, with one friction; bold what the test has not."""
    keys = "clamp_N", "struck", "velocity_m_s"
    at = {tuple(str(row[key]) for key in keys): row for row in shots if str(row["friction"]) == friction}
    columns = [(aim, v) for aim in ("beside", "on") for v in ("96", "110")]
    table = [["clamps, N per yarn", *(f"{v} m/s, {aim} a crossover" for aim, v in columns), "slip of S-728, mm"]]
    for force in dict.fromkeys(force for force, *_ in at):
        slow = at.get((force, "beside", "36.9"), {"slip_warp_mm": "", "slip_weft_mm": ""})
        cells = [_outcome(at[force, *column]) for column in columns]
        table.append([force, *cells, f"{slow['slip_warp_mm']} / {slow['slip_weft_mm']}"])
    return table


def _outcome(row):
    left = f", {float(row['residual_velocity_m_s']):.0f} m/s left" if row["outcome"] == "perforated" else ""
    return f"{row['outcome']}{left}" if row["outcome"] == row["tested"] else f"**{row['outcome']}{left}**"
