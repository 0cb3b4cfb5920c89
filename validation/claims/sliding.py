"""python -m validation.claims.sliding [--page docs/reports/sliding.md] [--out results/claims-sliding] [--most-limits 3]

Checks claims of the thesis a second time with sliding crossovers (mu = 0.2), and puts a table of the verdicts that
change into the page. The thesis pins its crossovers, so that this is no reading of it: a verdict that changes says what
the claim depends on.

Claims are chosen by a rule: all runs are shots at one ply, none of which has what sliding crossovers refuse (slipping
sides, bending of yarns, several elements a crossover, the other cell formulation), and at most so many searches of a
critical velocity. What is done is kept in the folder, from which an interrupted run goes on.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from validation.claims import claims as data
from validation.claims import runner, variants
from validation.claims.claims import Claim
from validation.claims.judge import Record
from validation.marked_page import markdown, put
from validation.program import program
from weavecell.results import provenance

BEGIN, END = "<!-- verdicts of validation.claims.sliding -->\n", "<!-- end of verdicts -->"
(OPTION,) = variants.OPTIONS
MOST_LIMITS = 3  # searches of a critical velocity in a claim


def chosen(claims: Sequence[Claim], most_limits: int = MOST_LIMITS) -> list[Claim]:
    """The claims that the rule chooses."""
    found = [claim for claim in claims if claim.check and variants.can_slide(claim)]
    limits = {claim.id: sum(run.name == "limit" for run in variants.runs(claim).values()) for claim in found}
    return [claim for claim in found if limits[claim.id] <= most_limits]


def judged(claims: Sequence[Claim], out: Path) -> list[tuple[Claim, Record, Record]]:
    """(claim, its record with pinned crossovers, with sliding ones), in the order of the claims."""
    (out / runner.RUNS_FOLDER).mkdir(parents=True, exist_ok=True)
    tasks = [(claim, name) for claim in claims for name in (None, OPTION)]
    for run in runner.wanted(tasks, out):
        runner.make(run, out)
        print(run.name, *run.keywords.values(), flush=True)
    return [(claim, runner.check(claim, out), runner.check(claim, out, None, OPTION)) for claim in claims]


def table(rows: Sequence[tuple[Claim, Record, Record]], left_out: int, command: str) -> str:
    """The section: how many verdicts change, and a row for each that does."""
    changed = [(claim, pinned, slid) for claim, pinned, slid in rows if pinned.verdict != slid.verdict]
    mu = variants.OPTIONS[OPTION][1]
    cells = [("claim", "pinned", "sliding", "computed, pinned", "computed, sliding")]
    cells += [
        (f"`{claim.id}`", pinned.verdict, slid.verdict, _short(pinned), _short(slid)) for claim, pinned, slid in changed
    ]
    better = sum(variants.holds(slid.verdict) for _, _, slid in changed)
    commit = provenance.stamp()["commit"]
    head = (
        f"Made by `{command}` at commit {commit}.\n"
        f"{len(rows)} claims of shots at one ply were checked with mu = {mu:g}; {left_out} others that rest on shots\n"
        "were left out, by the rule in the head of `validation/claims/sliding.py`.\n"
        f"{len(changed)} verdicts change, {better} of them to one that holds.\n\n"
    )
    return head + (markdown(cells) if changed else "")


def _short(record):
    """What was computed, in one line of a table."""
    text = " ".join((record.text or record.note or "").split()).replace("|", "/")
    return text if len(text) <= 160 else text[:157] + "..."


def main(
    *, page: Path | None = None, out: Path = Path("results/claims-sliding"), most_limits: int = MOST_LIMITS
) -> None:
    """Run it."""
    claims = data.load()
    of = chosen(claims, most_limits)
    rows = judged(of, out)
    others = sum(variants.applies(claim) for claim in claims) - len(of)
    limits = "" if most_limits == MOST_LIMITS else f" --most-limits {most_limits}"
    command = f"python -m validation.claims.sliding --page {page}{limits}"
    text = table(rows, others, command)
    print(text)
    if page:
        put(page, BEGIN, END, text)


if __name__ == "__main__":
    program(main, most_limits="searches of a critical velocity in a claim")
