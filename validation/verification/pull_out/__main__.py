"""python -m validation.verification.pull_out [--out results/pull-out] [--page docs/pull-out.md] [--further]

Solves the paths of the study, each kept in the folder as soon as it is done. With --page the page is written, and its
picture into figures/ beside it. --without leaves choices of the table of dependences out. With --further only the finer
mesh and the platens are computed, and put between their marks into the page.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from fabrics import run_cache
from fabrics.errors import run_program
from fabrics.files import write_whole
from validation.verification.pull_out import pictures, study
from validation.verification.pull_out.page import BEGIN, END, page, section
from weavecell.report.marked_page import put
from weavecell.results import provenance


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--out", type=Path, default=Path("results/pull-out"))
    arguments.add_argument("--page", type=Path)
    arguments.add_argument("--without", nargs="*", default=(), choices=tuple(study.VARIANTS), metavar="CHOICE")
    arguments.add_argument("--further", action="store_true")
    chosen = arguments.parse_args()
    for name in chosen.without:
        del study.VARIANTS[name]
    kept = run_cache.RunCache(chosen.out / "runs", run_cache.JSON)

    def runs(case):
        name = run_cache.key(case, study.__name__)
        if name not in kept:
            kept[name] = study.run(case)
            print(case, kept[name]["T_f"], f"{kept[name]['seconds']:.0f} s", flush=True)
        return kept[name]

    if chosen.further:
        commit = provenance.stamp()["commit"]
        text = section({name: runs(case) for name, case in study.FURTHER.items()}, commit)
        print(text)
        if chosen.page:
            put(chosen.page, BEGIN, END, text)
        return
    found = study.gather(runs)
    folder = chosen.page.parent / "figures" if chosen.page else chosen.out
    pictures.chart(found, folder / "pull-out.png")
    if chosen.page:
        before = chosen.page.read_text("utf-8") if chosen.page.exists() else ""
        kept_section = before.partition(BEGIN)[2].partition(END)[0]
        with write_whole(chosen.page) as file:
            file.write(page(found, chosen.without, kept_section))


if __name__ == "__main__":
    run_program(main)
