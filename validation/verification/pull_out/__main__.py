"""python -m validation.verification.pull_out [--out results/pull-out] [--page docs/reports/pull-out.md] [--further]

Solves the paths of the study, each kept in the folder as soon as it is done. With --page the page is written, and its
picture into figures/ beside it. --without leaves choices of the table of dependences out. With --further only the finer
mesh and the platens are computed, and put between their marks into the page.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fabrics import run_cache
from fabrics.files import write_whole
from validation.commits import computed
from validation.program import program
from validation.verification.pull_out import pictures, study
from validation.verification.pull_out.page import BEGIN, END, section
from validation.verification.pull_out.page import page as text_of
from validation.verification.study import known
from weavecell.report.marked_page import put
from weavecell.results import provenance


def main(
    *,
    out: Path = Path("results/pull-out"),
    page: Path | None = None,
    without: Sequence[str] = (),
    further: bool = False,
) -> None:
    for name in without:
        known("--without", name, tuple(study.VARIANTS))
        del study.VARIANTS[name]
    kept = run_cache.RunCache(out / "runs", run_cache.JSON)

    def runs(case):
        name = run_cache.key(case, study.__name__)
        if name not in kept:
            kept[name] = study.run(case)
            print(case, kept[name]["T_f"], f"{kept[name]['seconds']:.0f} s", flush=True)
        return kept[name]

    if further:
        commit = provenance.stamp()["commit"]
        text = section({name: runs(case) for name, case in study.FURTHER.items()}, commit)
        print(text)
        if page:
            put(page, BEGIN, END, text)
        return
    run = computed(f"python -m validation.verification.pull_out --page {page}", provenance.stamp())
    found = study.gather(runs)
    folder = page.parent / "figures" if page else out
    pictures.chart(found, folder / "pull-out.png")
    if page:
        before = page.read_text("utf-8") if page.exists() else ""
        kept_section = before.partition(BEGIN)[2].partition(END)[0]
        with write_whole(page) as file:
            file.write(text_of(found, without, kept_section, run))


if __name__ == "__main__":
    program(
        main, without="choices of the table of dependences to leave out", further="only the finer mesh and the platens"
    )
