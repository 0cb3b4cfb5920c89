"""The first line of a CSV: what made it, for each file of the documentation."""

import re
import subprocess

import pytest

from fabrics.base.errors import InputError
from validation import csv_file, origin, runner

FILES = sorted(csv_file.DATA.rglob("*.csv"))
# files that are older say "unknown" of what nobody wrote down
RULE = "2026-11-28 22:00 UTC"


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(csv_file.DATA)))
def test_every_file_says_what_made_it_or_that_it_is_history(path):
    with open(path, encoding="utf-8") as file:
        first = file.readline()
    assert first.startswith("# ")
    made = first[2:].strip()
    if made.startswith(origin.HISTORY):
        return
    parts = origin.read(made)
    assert parts, made
    if parts["date"] > RULE:
        assert origin.UNKNOWN not in made
        assert "changes" not in parts["commit"]


def test_every_commit_that_a_file_names_is_in_the_history_of_this_checkout():
    """A file that was made on a branch names a commit that no clone has, once the branch was rebased: it
    then takes that with which it landed, `git log -1 FILE`."""
    root = csv_file.DATA.parents[2]
    found = subprocess.run(
        ["git", "-C", root, "rev-list", "HEAD"], capture_output=True, text=True, check=False
    )
    whole = subprocess.run(
        ["git", "-C", root, "rev-parse", "--is-shallow-repository"],
        capture_output=True,
        text=True,
        check=False,
    )
    if found.returncode or whole.stdout.strip() != "false":
        pytest.skip("no checkout with its history")
    history = found.stdout.split()
    lost = {}
    for path in FILES:
        made = csv_file.read(path)[0]
        commit = origin.read(made).get("commit", origin.UNKNOWN)
        if not made.startswith(origin.HISTORY) and not commit.startswith(origin.UNKNOWN):
            named = re.findall(r"\b[0-9a-f]{8,40}\b", commit)
            gone = [one for one in named if not any(known.startswith(one) for known in history)]
            if gone:
                lost[path.name] = gone
    assert lost == {}


def test_pages_say_which_data_are_history():
    docs = csv_file.DATA.parents[1]
    pages = docs.rglob("*.md")
    quoting = [page for page in pages if "data/kept/" in page.read_text("utf-8")]
    assert quoting
    for page in quoting:
        assert "history, not repeated" in page.read_text("utf-8"), page
    history = csv_file.DATA / "kept"
    assert all(csv_file.read(path)[0].startswith(origin.HISTORY) for path in history.glob("*.csv"))


def test_a_line_is_read_as_it_was_written(monkeypatch):
    monkeypatch.setattr(origin, "commit", lambda: "0123456789ab")
    made = origin.write("study edges", "ba9876543210", "45.2", [3, 12])
    parts = origin.read(made)
    assert parts["command"] == "python -m validation study edges"
    assert parts["commit"] == "0123456789ab"
    assert (parts["inputs"], parts["cpu_s"], parts["golden"]) == ("ba9876543210", "45.2", "3, 12")
    assert parts["numba"][0].isdigit()
    assert origin.read("by hand") == {}


def test_data_of_the_documentation_take_committed_code_alone(monkeypatch, tmp_path):
    monkeypatch.setattr(origin, "changes", lambda: ["validation/studies/new.toml"])
    with pytest.raises(InputError, match=r"validation/studies/new\.toml is not as committed"):
        runner.main(["pull-out-load"])
    origin.refuse_changes(tmp_path)


def test_what_the_programs_write_themselves_is_no_change_of_code(monkeypatch, tmp_path):
    """Rows are computed one after another in one checkout; a changed file of the code still counts."""
    for name in (*origin.WRITTEN, "validation/cases/shot.py", "fabrics/sheet.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("1\n")
    for words in (
        ["init", "-q"],
        ["add", "."],
        ["-c", "user.name=a", "-c", "user.email=a", "commit", "-qm", "b"],
    ):
        subprocess.run(["git", "-C", tmp_path, *words], check=True)
    monkeypatch.setattr(origin, "ROOT", tmp_path)
    for name in origin.WRITTEN:
        (tmp_path / name).write_text("2\n")
    assert origin.changes() == []
    assert "changes" not in origin.commit()
    (tmp_path / "validation/cases/shot.py").write_text("2\n")
    assert origin.changes() == ["validation/cases/shot.py"]
    assert origin.commit().endswith(" + changes")
