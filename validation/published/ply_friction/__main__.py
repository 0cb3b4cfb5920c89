"""python -m validation.published.ply_friction [--out results/ply-friction] [--page docs/ply-friction.md]

Fires the shots of the study, each kept in the folder as soon as it is done, so that an interrupted study goes on where
it was. With --page the page is written, and its picture into figures/ beside it.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from fabrics.errors import run_program
from fabrics.files import write_whole
from validation.published.packs.study import Results
from validation.published.ply_friction import pictures, study
from validation.published.ply_friction.page import BEGIN, END, page


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--out", type=Path, default=Path("results/ply-friction"))
    arguments.add_argument("--page", type=Path)
    arguments.add_argument("--fabrics", nargs="+", default=study.FABRICS)
    chosen = arguments.parse_args()
    results, seconds = Results(chosen.out / "shots"), {}

    def shots(case):
        found = results(case)
        seconds[case] = found["wall"]
        return found

    found = {fabric: study.study(shots, fabric) for fabric in chosen.fabrics}
    folder = chosen.page.parent / "figures" if chosen.page else chosen.out
    pictures.chart(found, folder / "ply-friction.png")
    if chosen.page:
        before = chosen.page.read_text("utf-8") if chosen.page.exists() else ""
        cost = before.partition(BEGIN)[2].partition(END)[0]  # of benchmarks/pack.py, which is kept
        with write_whole(chosen.page) as file:
            file.write(page(found, sum(seconds.values()), cost))


if __name__ == "__main__":
    run_program(main)
