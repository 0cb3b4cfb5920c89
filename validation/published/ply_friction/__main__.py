"""python -m validation.published.ply_friction [--out results/ply-friction] [--page docs/reports/ply-friction.md]

Fires the shots of the study, each kept in the folder as soon as it is done, so that an interrupted study goes on where
it was. With --page the page is written, and its picture into figures/ beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fabrics.files import write_whole
from validation.commits import computed
from validation.program import program
from validation.published.packs.study import Results
from validation.published.ply_friction import pictures, study
from validation.published.ply_friction.page import BEGIN, END
from validation.published.ply_friction.page import page as text_of
from weavecell.results import provenance


def main(
    *, out: Path = Path("results/ply-friction"), page: Path | None = None, fabrics: Sequence[str] = study.FABRICS
) -> None:
    run = computed(f"python -m validation.published.ply_friction --page {page}", provenance.stamp())
    results, seconds = Results(out / "shots"), {}

    def shots(case):
        found = results(case)
        seconds[case] = found["wall"]
        return found

    found = {fabric: study.study(shots, fabric) for fabric in fabrics}
    folder = page.parent / "figures" if page else out
    pictures.chart(found, folder / "ply-friction.png")
    if page:
        before = page.read_text("utf-8") if page.exists() else ""
        cost = before.partition(BEGIN)[2].partition(END)[0]  # of benchmarks/pack.py, which is kept
        with write_whole(page) as file:
            file.write(text_of(found, sum(seconds.values()), cost, run))


if __name__ == "__main__":
    program(main)
