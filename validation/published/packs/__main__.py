"""python -m validation.published.packs [--out results/packs] [--page docs/reports/packs.md]

Fires the shots of the study, each kept in the folder as soon as it is done, so that an interrupted study goes on where
it was. With --page the page is written, and its pictures into figures/ beside it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fabrics.files import write_whole
from validation.commits import computed
from validation.program import program
from validation.published.packs import pictures, study
from validation.published.packs.page import page as text_of
from validation.published.packs.study import Results
from weavecell.results import provenance


def gather(results: Results) -> dict[str, Any]:
    """All results of the study."""
    return {
        "outcomes": study.outcomes(results),
        "torn": study.torn(results),
        "stackings": study.stackings(results),
        "gaps": study.gaps(results),
    }


def draw(found: dict[str, Any], folder: Path) -> None:
    """All pictures of the page."""
    gaps = {f"gap {1e3 * gap:.2f} mm": one for gap, one in found["gaps"].items()}
    pictures.velocities(gaps, folder / "packs-gaps.png")
    pictures.forces(gaps, folder / "packs-gap-forces.png")
    pictures.velocities(found["stackings"], folder / "packs-stacking.png")


def main(*, out: Path = Path("results/packs"), page: Path | None = None) -> None:
    run = computed(f"python -m validation.published.packs --page {page}", provenance.stamp())
    found = gather(study.Results(out / "shots"))
    draw(found, out)
    if page:
        draw(found, page.parent / "figures")
        with write_whole(page) as file:
            file.write(text_of(found, run))


if __name__ == "__main__":
    program(main)
