"""A command line in this process: what it prints, and the code it exits with."""

import pytest

from weavecell.cli import app


@pytest.fixture
def command(capsys, tmp_path, monkeypatch):
    """Run `weavecell ...` in an empty folder; returns (exit code, stdout, stderr)."""
    monkeypatch.chdir(tmp_path)

    def run(*words):
        with pytest.raises(SystemExit) as leaving:
            app.main([str(word) for word in words])
        out, err = capsys.readouterr()
        return leaving.value.code, out, err

    return run
