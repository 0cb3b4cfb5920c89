"""python -m validation.published.ply_friction [--out results/ply-friction] [--page docs/reports/ply-friction.md]

Fires the shots of the study, each kept in the folder as soon as it is done, so that an interrupted study goes on where
it was. With --page the page is written, and its picture into figures/ beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from fabrics.errors import UndecidedError
from meshing.pictures_style import BLUE, GREEN, ORANGE, RED
from validation.program import program, publish_all, save
from validation.published.packs import study as packs
from validation.published.packs.study import Case
from weavecell.report.marked_page import markdown
from weavecell.results import provenance

FABRICS, PLIES = ("S-726", "S-728"), 4
FRICTIONS = (0.0, 0.1, 0.2, 0.3)
END = 1.5e-3  # [s] by which a shot has stopped or perforated
STEP = 1.15  # first factor from the guess
TOLERANCE = 2.0  # [m/s] of the bracket of the ballistic limit
STRIDE = 0.02  # between the velocities of the scan, of the limit without friction
SHARES = tuple(1 + STRIDE * n for n in range(-6, 7))
Shots = Callable[[Case], dict[str, Any]]


@dataclass(frozen=True)
class Found:
    """What friction does to one pack.

    Parameters
    ----------
    friction : [-]
    onset : [m/s] strike velocity at which the first yarn fails
    limit : [m/s] ballistic limit: as many perforations below it as stops above, in the scan
    perforation, stop : [m/s] lowest perforation and highest stop of the scan
    rubbed : [-] work of friction between plies over the strike energy, of the highest stop
    balance : [-] largest error of the energy balance over the strike energy, of the scan
    unstable : number of its shots that a guard stopped, which count as perforations
    """

    friction: float
    onset: float
    limit: float
    perforation: float
    stop: float
    rubbed: float
    balance: float
    unstable: int


def perforates(found: dict[str, Any]) -> bool:
    """Whether a shot perforated; one that a guard stopped counts as one.

    Raises
    ------
    UndecidedError : it is still in flight at its end
    """
    if found["outcome"] == "in flight":
        raise UndecidedError(f"{found['case']} has neither stopped nor perforated after {found['time'] * 1e6:.0f} us")
    return found["outcome"] != "stopped"


def bracket(shots: Shots, case: Case, guess: float) -> list[dict[str, Any]]:
    """Shots about the ballistic limit, the last stop and the first perforation of which are `TOLERANCE` apart."""
    fired: dict[float, dict[str, Any]] = {}

    def through(velocity):
        fired[velocity] = shots(replace(case, velocity=velocity, end_time=END))
        return perforates(fired[velocity])

    low = high = round(guess, 1)
    if through(low):
        while through(low := round(low / STEP, 1)):
            high = low
    else:
        while not through(high := round(high * STEP, 1)):
            low = high
    while high - low > TOLERANCE:
        middle = round(0.5 * (low + high), 1)
        low, high = (low, middle) if through(middle) else (middle, high)
    return list(fired.values())


def scan(shots: Shots, case: Case, centre: float) -> list[dict[str, Any]]:
    """The shots at `SHARES` of a velocity [m/s], slowest first."""
    return [shots(replace(case, velocity=round(share * centre, 1), end_time=END)) for share in SHARES]


def summed(friction: float, onset: float, fired: Sequence[dict[str, Any]]) -> Found:
    """The Found of a scan, slowest shot first."""
    velocity = [one["case"]["velocity"] for one in fired]
    through = [perforates(one) for one in fired]
    stops = [v for v, one in zip(velocity, through) if not one]
    step = (velocity[-1] - velocity[0]) / (len(velocity) - 1)
    last = fired[velocity.index(max(stops))] if stops else fired[0]
    return Found(
        friction, onset, velocity[0] + (len(stops) - 0.5) * step,
        min((v for v, one in zip(velocity, through) if one), default=velocity[-1] + step),
        max(stops, default=velocity[0] - step), last["rubbed"], max(one["balance"] for one in fired),
        sum(one["outcome"] == "unstable" for one in fired),
    )  # fmt: skip


def study(shots: Shots, fabric: str) -> list[Found]:
    """One Found for each friction."""
    rows: list[Found] = []
    centre = 0.0
    for friction in FRICTIONS:
        case = Case(fabric, PLIES, 0.0, friction=friction)
        onset = packs.onset(shots, case, guess=rows[-1].onset if rows else None)
        if not rows:
            fired = bracket(shots, case, 1.1 * onset)
            ends = [[one["case"]["velocity"] for one in fired if perforates(one) == through] for through in (0, 1)]
            centre = 0.5 * (max(ends[0]) + min(ends[1]))
        rows.append(summed(friction, onset, scan(shots, case, centre)))
    return rows


LITERATURE = 0.10  # of V50
COST_MARKS = "<!-- cost of benchmarks/pack.py -->\n", "<!-- end of cost -->"


def rows(found: Mapping[str, Sequence[Found]]) -> str:
    """One row a fabric and coefficient."""
    lines = [[
        "fabric", "friction between plies", "first failure, m/s", "change", "ballistic limit, m/s", "change",
        "lowest perforation, m/s", "highest stop, m/s", "work of friction at the highest stop, % of the strike energy",
        "energy error, %", "stopped by a guard",
    ]]  # fmt: skip
    for fabric, of in found.items():
        for one in of:
            lines.append([
                fabric, f"{one.friction:g}", f"{one.onset:.1f}", change(one.onset, of[0].onset), f"{one.limit:.1f}",
                change(one.limit, of[0].limit), f"{one.perforation:.1f}", f"{one.stop:.1f}", f"{100 * one.rubbed:.2f}",
                f"{100 * one.balance:.2f}", f"{one.unstable}",
            ])  # fmt: skip
    return markdown(lines)


def change(value: float, first: float) -> str:
    """Change against the pack without friction."""
    return f"{100 * (value / first - 1):+.1f} %"


def overlap(of: Sequence[Found]) -> str:
    """How far the zone of mixed outcomes reaches at most."""
    most = max(one.stop - one.perforation for one in of)
    return f"overlap by up to {most:.0f} m/s" if most > 0 else "do not overlap"


def answer(found: Mapping[str, Sequence[Found]]) -> str:
    """What the table says, beside the literature."""
    texts = []
    for fabric, of in found.items():
        last, over = of[-1], [round(100 * (one.limit / one.onset - 1), 1) + 0.0 for one in (of[0], of[-1])]
        texts.append(
            f"- {fabric}: from 0 to {last.friction:g} the first failure moves by {change(last.onset, of[0].onset)} and "
            f"the ballistic limit by\n  {change(last.limit, of[0].limit)}; stops and perforations {overlap(of)}.\n"
            f"  Limit against first failure: {over[0]:+.1f} % without friction, {over[1]:+.1f} % at {last.friction:g}."
        )
    texts.append(f"- The strike velocities resolve a ballistic limit to ±{50 * STRIDE:g} %, and no smaller changes.")
    changes = [one.limit / of[0].limit - 1 for of in found.values() for one in of[1:]]
    met = "reproduces it" if max(changes) > 0.5 * LITERATURE else "does not reproduce it"
    met = "has the opposite sign" if max(changes) < 0 else met
    texts.append(
        f"- The literature has about {100 * LITERATURE:+.0f} % in V50 for all friction together. Friction between "
        f"plies alone changes the\n  limit by {100 * min(changes):+.1f} to {100 * max(changes):+.1f} %, which {met}. "
        "The literature's\n  figure includes friction at crossovers, which are pinned here, and at the nose."
    )
    return "\n".join(texts) + "\n"


def chart(pyplot: Any, found: Mapping[str, Sequence[Found]]) -> Any:
    """First failure (open) and ballistic limit (full) against friction, of {fabric: rows}.

    Bars go from the lowest perforation to the highest stop where they overlap.
    """
    figure, axes = pyplot.subplots(figsize=(9.4, 4.6))
    for (fabric, rows), colour, mark in zip(found.items(), (BLUE, ORANGE, GREEN, RED), "os^D"):
        mu = [one.friction for one in rows]
        limits = [one.limit for one in rows]
        zone = [[max(one.limit - one.perforation, 0) for one in rows], [max(one.stop - one.limit, 0) for one in rows]]
        axes.errorbar(
            mu, limits, zone, fmt=f"{mark}-", color=colour, capsize=4, lw=1.8, label=f"{fabric}, ballistic limit"
        )
        axes.plot(
            mu,
            [one.onset for one in rows],
            f"{mark}--",
            color=colour,
            lw=1.8,
            mfc="white",
            label=f"{fabric}, first failure",
        )
    axes.set(xlabel="friction coefficient between plies", ylabel="strike velocity [m/s]", title="four plies, 203 mm")
    axes.set_xticks(sorted({one.friction for rows in found.values() for one in rows}))
    figure.legend(loc="outside right upper")
    return figure


def main(
    *, out: Path = Path("results/ply-friction"), page: Path | None = None, fabrics: Sequence[str] = FABRICS
) -> None:
    stamp, fired = provenance.stamp(), packs.kept(out / "shots")
    seconds: dict[Case, float] = {}

    def shots(case):
        found = fired(case)
        seconds[case] = found["wall"]
        return found

    found = {fabric: study(shots, fabric) for fabric in fabrics}
    save(chart, found, to=(page.parent / "figures" if page else out) / "ply-friction.png", dpi=130)
    minutes = f"All shots took {sum(seconds.values()) / 60:.1f} minutes on one core."
    texts = {"table": rows(found), "answer": answer(found), "minutes": minutes}
    publish_all(texts, page, "validation.published.ply_friction", stamp)


if __name__ == "__main__":
    program(main)
