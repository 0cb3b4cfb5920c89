"""python -m validation.published.packs [--out results/packs] [--page docs/reports/packs.md]

Fires the shots of the study, each kept in the folder as soon as it is done, so that an interrupted study goes on where
it was. With --page the tables go into that page, between its marks, and the pictures into figures/ beside it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from meshing.pictures_style import BLUE, GREEN, ORANGE, RED
from validation.marked_page import markdown
from validation.program import program, publish_all, save
from validation.published.packs import study
from validation.published.packs.study import GAPS
from weavecell.results import provenance


def agreement(rows: Iterable[Any]) -> str:
    """How many computed outcomes differ from the captions, and what fails where the projectile stops."""
    rows = list(rows)
    words = {"stopped": "stops", "perforated": "perforates"}
    other = sum(words.get(one["outcome"]) != published.split()[0] for *_, published, one in rows)
    stop = [one for *_, one in rows if one["outcome"] == "stopped"]
    torn = sum(any(one["failed"]) for one in stop)
    return (
        f"**{other} of the {len(rows)} computed outcomes differ from the captions.** {len(stop)} of {len(rows)} shots "
        f"stop; {f'in {torn} of these yarns fail' if torn else 'no yarn of these fails'}.\n"
    )


def outcomes(rows: Iterable[Any]) -> str:
    """One row a published shot."""
    lines = [["plies", "fabric", "strike, m/s", "thesis", "computed", "at, µs", "cut yarns by ply",
              "highest tension / strength", "deepest / thickness", "energy error, %"]]  # fmt: skip
    for fabric, plies, velocity, published, one in rows:
        lines.append([
            plies, fabric, f"{velocity:g}", published, outcome_text(one), f"{1e6 * one['time']:.0f}",
            by_ply(one["failed"]), f"{max(one['peaks']):.2f}", f"{one['deepest']:.2f}", f"{100 * one['balance']:.2f}",
        ])  # fmt: skip
    return markdown(lines)


def crossings(rows: Iterable[dict[str, Any]]) -> str:
    """One row a shot that tears yarns."""
    lines = [["plies", "fabric", "strike, m/s", "until, µs", "failed segments of the quarter", "impulses of the guard",
              "with, % of the strike energy", "**crossings**, most at a sample"]]  # fmt: skip
    for one in rows:
        case = one["case"]
        lines.append([
            case["plies"], case["fabric"], f"{case['velocity']:g}", f"{1e6 * one['time']:.0f}", f"{one['failed'][0]:g}",
            f"{one['impulses']:g}", f"{100 * one['taken']:.2f}", f"**{max(one['crossings'])}**",
        ])  # fmt: skip
    return markdown(lines)


def outcome_text(one: dict[str, Any]) -> str:
    """The outcome, with the velocity where the shot goes on."""
    word = {"stopped": "**stops**", "perforated": "**perforates**"}.get(one["outcome"], f"**{one['outcome']}**")
    return word if one["outcome"] == "stopped" else f"{word}, {one['residual_velocity']:.0f} m/s left"


def by_ply(cut: Sequence[float]) -> str:
    """Numbers of cut yarns, equal ones of neighbouring plies drawn together."""
    if not any(cut):
        return "none"
    parts, start = [], 0
    for end in range(1, len(cut) + 1):
        if end == len(cut) or cut[end] != cut[start]:
            count = end - start
            parts.append(f"{cut[start]:.1f}" if count == 1 else f"{count} x {cut[start]:.1f}")
            start = end
    return ", ".join(parts)


def gaps(found: dict[float, dict[str, Any]]) -> str:
    """One row a gap."""
    lines = [["gap, mm", "outcome", "at, µs", "deflection, mm", "highest force, kN (2 µs mean)",
              "jumps of the force, kN rms", "cut yarns"]]  # fmt: skip
    for gap in GAPS:
        one = found[gap]
        force, slow = smoothed(one, 2e-6), smoothed(one, 20e-6)
        first = np.array(one["t"]) < 100e-6
        jumps = float(np.sqrt(np.mean((force - slow)[first] ** 2)))
        lines.append([
            f"{1e3 * gap:.2f}", outcome_text(one), f"{1e6 * one['time']:.0f}", f"{1e3 * one['deflection']:.1f}",
            f"{1e-3 * force.max():.1f}", f"{1e-3 * jumps:.2f}", by_ply(one["failed"]),
        ])  # fmt: skip
    return markdown(lines)


def smoothed(one: dict[str, Any], width: float) -> np.ndarray:
    """(n,) [N] force that slows the projectile, averaged over `width` [s]."""
    t, force = np.array(one["t"]), -np.array(one["force"])
    count = max(1, round(width / (t[1] - t[0])))
    return np.convolve(force, np.ones(count) / count, "same")


def stacking(found: dict[str, Any]) -> str:
    """One row a stacking, and the difference."""
    instants = (100e-6, 150e-6, 200e-6)
    lines = [["stacking", "stops at, µs", "deflection, mm", *(f"absorbed by {1e6 * t:.0f} µs, J" for t in instants)]]
    absorbed = {}
    for name, one in found.items():
        absorbed[name] = np.interp(instants, one["instants"], one["absorbed"])
        lines.append([
            name, f"{1e6 * one['time']:.0f}" if one["outcome"] == "stopped" else outcome_text(one),
            f"{1e3 * one['deflection']:.1f}", *(f"{energy:.2f}" for energy in absorbed[name]),
        ])  # fmt: skip
    more = 100 * (absorbed["alternating"] / absorbed["aligned"] - 1)
    lines.append(["alternating against aligned", "", "", *(f"{value:+.1f} %" for value in more)])
    return markdown(lines)


def velocities(pyplot: Any, runs: dict[str, Any]) -> Any:
    """Velocity of the projectile over time, one line a run.

    Parameters
    ----------
    runs : {label: found}, as study.shoot gives them
    """
    figure, axes = pyplot.subplots(figsize=(9.4, 4.4))
    for (label, found), colour, dash in zip(runs.items(), (BLUE, ORANGE, GREEN, RED), ("-", "--", "-.", ":")):
        axes.plot(1e6 * np.array(found["t"]), found["v"], dash, color=colour, label=label)
    axes.set(xlabel="time after strike [µs]", ylabel="velocity of the projectile [m/s]")
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.legend()
    return figure


def forces(pyplot: Any, runs: dict[str, Any], width: float = 2e-6) -> Any:
    """Force on the projectile, averaged over `width` [s], one panel a run.

    Parameters
    ----------
    runs : {label: found}
    """
    figure, column = pyplot.subplots(len(runs), 1, figsize=(9.4, 1.0 + 1.9 * len(runs)), sharex=True, sharey=True)
    for axes, (label, found), colour in zip(np.atleast_1d(column), runs.items(), (BLUE, ORANGE, GREEN, RED)):
        t, force = np.array(found["t"]), -np.array(found["force"])
        count = max(1, round(width / (t[1] - t[0])))
        mean = np.convolve(force, np.ones(count) / count, "valid")  # no window reaches beyond the ends
        axes.plot(1e6 * (t[: mean.size] + 0.5 * (count - 1) * (t[1] - t[0])), 1e-3 * mean, color=colour, lw=1.6)
        axes.set_title(label, fontsize=11)
    column = np.atleast_1d(column)
    column[-1].set_xlabel("time after strike [µs]")
    column[-1].set(xlim=(0, None), ylim=(0, None))
    figure.supylabel("force on the projectile [kN]", fontsize=12)
    return figure


def main(*, out: Path = Path("results/packs"), page: Path | None = None) -> None:
    stamp, results = provenance.stamp(), study.kept(out / "shots")
    shots, torn = study.outcomes(results), study.torn(results)
    stackings, by_gap = study.stackings(results), study.gaps(results)
    runs = {f"gap {1e3 * gap:.2f} mm": one for gap, one in by_gap.items()}
    folder = page.parent / "figures" if page else out
    save(velocities, runs, to=folder / "packs-gaps.png")
    save(forces, runs, to=folder / "packs-gap-forces.png")
    save(velocities, stackings, to=folder / "packs-stacking.png")
    texts = {
        "outcomes": f"{agreement(shots)}\n{outcomes(shots)}", "crossings": f"{crossings(torn)}\n",
        "gaps": gaps(by_gap), "stackings": stacking(stackings),
    }  # fmt: skip
    publish_all(texts, page, "validation.published.packs", stamp)


if __name__ == "__main__":
    program(main)
