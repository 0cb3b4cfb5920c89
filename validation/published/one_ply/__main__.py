"""python -m validation.published.one_ply [--out results/one-ply] [--page docs/reports/one-ply.md]

One ply of the six Kevlar fabrics: critical and residual velocities, histories and energies of the captions' shots,
back-face profiles, wave fronts, reactions. Writes a table (.csv) and a picture (.png) of each. With --page the tables
go into that page, between its marks, and the pictures beside it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fabrics.files import write_whole
from validation.commits import computed
from validation.program import program, publish, write_csv
from validation.published.one_ply import pictures, study, tables
from validation.published.shots import CAPTIONS
from weavecell.report.marked_page import markdown, put
from weavecell.report.pictures import render
from weavecell.results import provenance

OUT = Path("results/one-ply")


def marks(name: str) -> tuple[str, str]:
    """The marks of a page between which the table of that name is."""
    return f"<!-- {name} of validation.published.one_ply -->", f"<!-- end of {name} -->"


def main(*, out: Path = OUT, page: Path | None = None) -> None:
    made_by = provenance.stamp()  # before a page of the checkout is written to
    curves = [study.curve(fabric) for fabric in CAPTIONS]
    shots = study.captions()
    made = {
        "limits": tables.limits(curves), "residual": tables.residual(curves), "captions": tables.captions(shots),
        "waves": tables.waves(shots),
    }  # fmt: skip
    for name, rows in made.items():
        write_csv(out / f"{name}.csv", rows)
        publish(markdown(rows), page, marks(name))
    folders = [out] + ([page.parent / "figures"] if page else [])
    drawn: list[Any] = [(draw, curves) for draw in (pictures.residual, pictures.limits)]
    of_shots = (
        pictures.velocities, pictures.energies, pictures.profiles, pictures.fronts, pictures.reactions,
    )  # fmt: skip
    drawn += [(draw, shots) for draw in of_shots]
    for draw, content in drawn:
        image = render(draw, content, kind="png")
        for folder in folders:
            prefix = "" if folder == out else "validation-"
            with write_whole(folder / f"{prefix}{draw.__name__}.png", "wb") as file:
                file.write(image)
    if page is not None:
        line = computed(f"python -m validation.published.one_ply --page {page}", made_by)
        put(page, *marks("stamp"), f"\n\n{line}\n\n")


if __name__ == "__main__":
    program(main)
