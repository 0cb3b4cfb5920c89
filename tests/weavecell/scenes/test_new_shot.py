"""The first input file that `weavecell new` writes: it can be run as it stands, and its comments name keys."""

import re
import tomllib

from fabrics.base.schema import entries
from weavecell.scenes import impact


def test_the_first_input_file_is_read_back(command, succeed, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert command("new", "shot.toml")[:2] == (0, "written to shot.toml\n")
    printed = succeed("impact", "shot.toml", "--check")
    assert "my first shot: nothing is run" in printed
    assert command("new", "shot.toml")[0] == 2
    assert command("new", "shot.txt")[0] == 2


def test_what_it_has_in_comments_are_keys(command, tmp_path):
    path = tmp_path / "shot.toml"
    command("new", str(path))
    written = path.read_text("utf-8")
    whole = tomllib.loads(re.sub(r"^# (?=\[|\w+ = )", "", written, flags=re.MULTILINE))
    assert {"backing"} <= set(whole)
    keys = set(entries(impact.Scene))
    for table, content in whole.items():
        if isinstance(content, dict):
            tables = {key.rpartition(".")[0] for key in keys}
            known = {f"{table}.{key}" for key in content}
            assert known <= keys | tables, known - keys
