"""A study of scatter put between its marks of a page: picture, what the command prints, table.

    python -m validation scatter docs/reports/scatter.md "v50 S-720 --shots 120 --seed 1"

The command is run in a folder, with its other files.
"""

from __future__ import annotations

import csv
import io
import shlex
from contextlib import redirect_stdout
from pathlib import Path

from fabrics.errors import InputError
from fabrics.files import write
from validation import marked_page
from weavecell.cli import app
from weavecell.results import provenance

STUDIES = {"v50": "v50", "sensitivity": "sobol"}  # name of the files that a command writes
NOTES = {"command": "of weavecell, with its arguments: v50 or sensitivity"}


def main(page: Path, command: str, *, out: Path = Path("results/scatter")) -> None:
    """Run the command, and put its results into the page.

    Raises
    ------
    InputError : another command, or a page without its marks
    """
    words = shlex.split(command)
    name = STUDIES.get(words[0] if words else "")
    if name is None:
        raise InputError(key="command", value=command, allowed=f"one of {', '.join(STUDIES)}, with its arguments")
    marks = f"<!-- {name} -->", f"<!-- end of {name} -->"
    marked_page.split(page, *marks)
    printed = io.StringIO()
    try:
        with redirect_stdout(printed):
            app.main([*words, "--out", str(out)])
    except SystemExit as leaving:
        if leaving.code:
            raise
    *remarks, _ = printed.getvalue().splitlines()
    rows = list(csv.reader((out / f"{name}.csv").open(encoding="utf-8")))
    picture = f"figures/{page.stem}-{name}.png"
    write(page.parent / picture, (out / f"{name}.png").read_bytes())
    stamp = provenance.stamp()
    made = f"Made by `weavecell {command}`. Version {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}."
    lines, table = "\n".join(f"- {line}" for line in remarks), marked_page.markdown(rows)
    marked_page.put(page, *marks, f"\n\n![{words[0]}]({picture})\n\n{lines}\n\n{table}\n{made}\n\n")
