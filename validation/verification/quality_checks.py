"""What the quality indicators (`shellfabric.panel.quality`) flag: tables of docs/reports/checks.md.

    python -m validation.verification.quality_checks [--out results/checks] [--page docs/reports/checks.md]

Points of the maps that end quietly wrong, which indicators should flag, and examples at default settings, which they
should not; of random input files `make fuzz` counts the doubtful ones. Runs are kept in the folder and not made twice.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from fabrics import run_cache
from shellfabric.impact import simulation
from shellfabric.panel.quality import LIMITS, NOTES
from validation.marked_page import markdown
from validation.program import marks, program, publish
from validation.verification.stability import study
from validation.verification.stability.core import STABLE, WRONG
from weavecell.scenes import build
from weavecell.scenes import impact as scenes

# maps with points that end quietly wrong; the product has no way to what OUTSIDE names
MAPS = ("time-step", "viscosity", "penalty", "edge-radius", "newton", "printed-law", "bars", "plies")
OUTSIDE = {"newton": "a method of the thesis that is not used", "plies": "no key of an input file"}


def of_map(key: str) -> list[tuple[str, list[str]]]:
    """(kind of the outcome, names of the indicators beyond their limits) of a map's points."""
    chart = study.load(key)
    outcomes = [chart.point(x, y) for x, y in chart.points]
    return [(outcome.kind, [check.name for check in outcome.checks if not check.ok]) for outcome in outcomes]


def of_example(path: str) -> list[str]:
    """Indicators of an input file that are beyond their limits."""
    asked, _ = scenes.load(Path(path))
    setup = build.setup(build.build(asked, Path(path), path), Path(path))
    setup = replace(setup, numerics=replace(setup.numerics, threads=1), snapshot_interval=None)
    return [str(check) for check in simulation.run(setup).checks if not check.ok]


def limits() -> str:
    """Every indicator with its limit."""
    rows = [[name, f"{NOTES[name]:g}" if name in NOTES else "", f"{row[0]:g}", row[2]] for name, row in LIMITS.items()]
    return markdown([["indicator", "noted above", "doubtful above", "value"], *rows], numbers=True)


def shares(maps: dict[str, list[tuple[str, list[str]]]]) -> str:
    """How many wrong points of each map are flagged, and by what."""
    rows = [["map", "wrong points flagged", "stable points flagged", "by", "outside the product"]]
    for key, points in maps.items():
        wrong = [names for kind, names in points if kind == WRONG]
        stable = [names for kind, names in points if kind == STABLE]
        by = ", ".join(sorted({name for names in wrong for name in names}))
        rows.append([key, _share(wrong), f"{sum(map(bool, stable))} of {len(stable)}", by, OUTSIDE.get(key, "")])
    for title, without in (("all", ()), ("all that an input file can reach", tuple(OUTSIDE))):
        points = [point for key in maps if key not in without for point in maps[key]]
        rows.append([f"**{title}**", _share([names for kind, names in points if kind == WRONG]), "", "", ""])
    return markdown(rows, numbers=True)


def _share(runs):
    """How many of the runs are flagged, by what is flagged of each."""
    count = sum(map(bool, runs))
    return f"{count} of {len(runs)} ({100 * count / max(len(runs), 1):.0f} %)"


def main(*, out: Path = Path("results/checks"), page: Path | None = None) -> None:
    """Run what the folder does not hold, and write the tables."""
    maps = dict(zip(MAPS, run_cache.results(of_map, [(key,) for key in MAPS], folder=out), strict=True))
    paths = sorted(map(str, Path("examples").glob("*.toml")))
    flagged = run_cache.results(of_example, [(path,) for path in paths], folder=out)
    lines = [f"{_share(flagged)} are flagged.", *(f"- {p}: {'; '.join(f)}" for p, f in zip(paths, flagged) if f)]
    for name, text in (("limits", limits()), ("maps", shares(maps)), ("examples", "\n".join(lines) + "\n")):
        publish(text, page, marks(name, "validation.verification.quality_checks"))


if __name__ == "__main__":
    program(main)
