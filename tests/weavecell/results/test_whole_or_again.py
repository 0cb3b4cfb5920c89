"""A folder is whole, or a resumed run makes it so: whatever ends a run at any file, and whatever is lost later."""

import errno
import os
import signal
import subprocess
import sys

import pytest

from fabrics.base import files
from tests.scene_text import FRAME, impact_scene, is_whole
from weavecell.results import file_list

SCENE = impact_scene(opening="30 mm", end_time="20 us", run='outputs = ["paraview", "report"]')
COMMANDS = {
    "impact": "impact scene.toml",
    "coupon": "coupon frame.toml",
    "sweep": "sweep scene.toml --over panel.plies=1,2 --jobs 1",
}


class Killed(BaseException):
    """The end of a process: nothing of weavecell handles it."""


ENDS = {
    "Ctrl-C": KeyboardInterrupt,
    "full disk": lambda: OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)),
    "kill": Killed,
}


@pytest.fixture
def inputs(tmp_path, drawn_once):
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "frame.toml").write_text(FRAME)


def listing(out):
    return sorted(path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file())


def ended_at(monkeypatch, number, end):
    """Raise an exception when the file with a number, from 0, is about to get its name."""
    written = []

    def watcher(path, beside):
        written.append(path)
        if len(written) > number:
            raise end()

    monkeypatch.setattr(files, "watchers", [watcher])
    return written


@pytest.mark.parametrize("name", COMMANDS)
def test_a_run_that_ends_at_any_file_is_made_whole(command, inputs, tmp_path, monkeypatch, name):
    words = COMMANDS[name]
    with monkeypatch.context() as counting:
        # a file more than there are
        written = ended_at(counting, 1000, Killed)
        assert command(f"{words} --out undisturbed")[0] == 0
    expected = listing(tmp_path / "undisturbed")
    assert is_whole(tmp_path / "undisturbed")
    # every file of a shot; of the others some, since they are written by the same functions
    step = 1
    if name != "impact":
        step = 4
    for number in range(0, len(written) - 1, step):
        out = tmp_path / f"out-{number}"
        end = [*ENDS.values()][number // step % len(ENDS)]
        with monkeypatch.context() as ending:
            ended_at(ending, number, end)
            try:
                code, _, err = command(f"{words} --out {out.name}")
                assert code in (2, 130), err
            except Killed:
                pass
        assert not is_whole(out)
        code, printed, err = command(f"{words} --out {out.name} --resume")
        assert code == 0, err
        assert "done before" not in printed
        assert listing(out) == expected
        assert is_whole(out)


@pytest.mark.parametrize("name", ["impact", "coupon"])
def test_what_is_lost_or_cut_is_made_again(succeed, inputs, tmp_path, name):
    words = COMMANDS[name]
    out = tmp_path / "r"
    succeed(f"{words} --out r")
    expected = listing(out)
    assert "done before" in succeed(f"{words} --out r --resume")
    lost = [file for file in expected if file not in ("panel/panel-0000.vtu", file_list.NAME)]
    for number, file in enumerate(lost):
        whole = (out / file).read_bytes()
        if number % 2:
            (out / file).unlink()
        else:
            (out / file).write_bytes(whole[: len(whole) // 2])
        assert "done before" not in succeed(f"{words} --out r --resume")
        kept = out / f"{file}.found"
        if kept.exists():
            assert kept.read_bytes() == whole[: len(whole) // 2]
            kept.unlink()
        assert listing(out) == expected
        assert "done before" in succeed(f"{words} --out r --resume")


def test_without_its_list_a_folder_is_made_anew_and_all_is_kept(succeed, inputs, tmp_path):
    out = tmp_path / "r"
    succeed(f"{COMMANDS['coupon']} --out r")
    (out / file_list.NAME).unlink()
    expected = listing(out)
    contents = [(out / file).read_bytes() for file in expected]
    succeed(f"{COMMANDS['coupon']} --out r --resume")
    assert [(out / f"{file}.found").read_bytes() for file in expected] == contents
    assert is_whole(out)


# the signal comes when the numbers of a shot have been written, however busy the machine is
ENDING = """
import os, sys
from weavecell.cli import app
from weavecell.results import json_file

write = json_file.write_summary

def write_and_end(*words):
    write(*words)
    os.kill(os.getpid(), int(sys.argv[1]))

json_file.write_summary = write_and_end
app.main(sys.argv[2:])
"""


@pytest.mark.parametrize(
    "end", [signal.SIGKILL, pytest.param(signal.SIGTERM, marks=pytest.mark.slow(2))]
)
def test_a_process_that_is_killed_while_it_writes_is_made_whole(succeed, inputs, tmp_path, end):
    words = COMMANDS["impact"]
    succeed(f"{words} --out undisturbed")
    out = tmp_path / "o"
    done = subprocess.run(
        [sys.executable, "-c", ENDING, str(int(end)), *words.split(), "--out", "o"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    assert done.returncode in (130, -signal.SIGKILL)
    assert not is_whole(out)
    assert "done before" not in succeed(f"{words} --out o --resume")
    assert is_whole(out)
    left = [file for file in listing(out) if not file.startswith(".")]
    assert set(listing(tmp_path / "undisturbed")) - {file_list.NAME} <= set(left)
