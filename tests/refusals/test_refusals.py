"""Input that is refused: exit code 2, one line that says what is wrong and what is allowed, and nothing written.

The rows stand in *.toml beside this file; `[default]` holds what all rows of a file share. A row:

    run     the command, run in an empty folder; a list of commands that all say the same
    base    the table of bases.toml that is written to `file`, "scene.toml" if not given; "" for none
    change  what the table holds besides, or in place of its own
    drop    keys that it does not hold
    files   {name: text} of files besides it, also in its place
    replace [old, new] of these texts
    line    the line after "error: ", or all lines; " ..." at its end stands for any rest. The number of the line
            that a message names behind its file is left out: it has to be one that has the key
    needs   a module without which the row is skipped

"{root}" stands for the folder of the repository.
"""

import re
import shlex
import tomllib
from pathlib import Path

import pytest

from tests.scene_text import merged, table_of, toml

FOLDER = Path(__file__).parent
ROOT = str(FOLDER.parents[1])


def here(value):
    """A value of a row, through its tables and lists, with the folder of the repository in it."""
    if isinstance(value, dict):
        return {key: here(part) for key, part in value.items()}
    if isinstance(value, list):
        return [here(part) for part in value]
    return value.replace("{root}", ROOT) if isinstance(value, str) else value


BASES = here(tomllib.loads((FOLDER / "bases.toml").read_text()))


def listed(value):
    return value if isinstance(value, list) else [value]


def rows():
    for path in sorted(FOLDER.glob("*.toml")):
        table = tomllib.loads(path.read_text())
        for row in table.get("row", ()):
            row = {"file": "scene.toml"} | table.get("default", {}) | row
            for run in listed(row["run"]):
                line = listed(row["line"])[0].removeprefix(row["file"] + ": ")
                yield pytest.param(
                    here(row | {"run": run}), id=f"{path.stem}-{run.split()[0]}-{line[:40]}"
                )


def write(row, folder):
    table = BASES[row["base"]] if row.get("base") else {}
    for key in row.get("drop", ()):
        table = merged(table, table_of(key, None))
    table = merged(table, row.get("change", {}))
    texts = ({row["file"]: toml(table)} if table else {}) | row.get("files", {})
    for name, text in texts.items():
        (folder / name).write_text(text.replace(*row.get("replace", ("", ""))))


def unnumbered(text):
    """A message without the number of the line behind its file, where the last name of its key stands, or of
    the table that it is in."""
    found = re.match(r"error: ([^:= ]+):([0-9]+): (\[?[\w. -]+)", text)
    if found is None:
        return text
    file, number, key = found.groups()
    line = Path(file).read_text().split("\n")[int(number) - 1]
    names = re.findall(r"\w+", key)
    assert any(name in line for name in names), (text, line)
    return text.replace(f"{file}:{number}:", f"{file}:", 1)


@pytest.mark.parametrize("row", list(rows()))
def test_refused(row, command, tmp_path):
    for name in listed(row.get("needs", [])):
        pytest.importorskip(name)
    write(row, tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    code, out, err = command(*shlex.split(row["run"]))
    # in the first run alone
    said = [text for text in err.splitlines() if not text.startswith("compiling ")]
    expected = [f"error: {line}" for line in listed(row["line"])]
    assert len(said) == len(expected), err
    for text, line in zip([unnumbered(text) for text in said], expected):
        assert text.startswith(line[:-4]) if line.endswith(" ...") else text == line
    assert code == 2
    assert all(
        line.startswith(("projectile: ", "assumed: ", "guessed, ", "note: "))
        for line in out.splitlines()
    )
    assert {path: path.read_bytes() for path in tmp_path.rglob("*")} == before
