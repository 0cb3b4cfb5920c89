"""SIGTERM ends a run as Ctrl-C does; what a run that was killed has kept is gone on with."""

import os
import signal
import subprocess
import sys
from contextlib import contextmanager
from unittest import mock

import pytest

from shellfabric.loop import checkpoint
from tests.scene_text import datasets, impact_scene
from weavecell.results import progress, termination

SHARE = 0.45  # of the run at which the signal comes
SCENE = impact_scene(
    opening="40 mm", end_time="40 us", run='checkpoint_interval = "5 us"\noutputs = []'
)
LINE = "interrupted; --resume goes on from its last checkpoint"


@contextmanager
def signalled(number):
    """This process gets a signal in the middle of its run, which writes checkpoints."""

    def advance(done, _text=""):
        if done >= SHARE:
            os.kill(os.getpid(), number)

    @contextmanager
    def bar(*_, **__):
        yield advance

    with mock.patch.object(progress, "bar", bar), mock.patch.object(checkpoint, "LEAST_WALL", 0.0):
        yield


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


def test_sigterm_is_an_interrupt_with_a_checkpoint(command, scene, tmp_path):
    with signalled(signal.SIGTERM):
        code, _, err = command("impact", scene, "--out", "r")
    # kernels that are not in the cache yet are announced
    said = [line for line in err.splitlines() if "compiling the kernels" not in line]
    assert (code, said) == (130, [f"error: {LINE}"])
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    assert (tmp_path / "r" / "checkpoint.h5").exists()


def test_a_handler_of_the_program_stays():
    def own(*_):
        raise RuntimeError

    before = signal.signal(signal.SIGTERM, own)
    try:
        with termination.interrupt_on_sigterm():
            assert signal.getsignal(signal.SIGTERM) is own
    finally:
        signal.signal(signal.SIGTERM, before)


KILLED = """
import signal, sys
from tests.weavecell.results.test_termination import signalled
from weavecell.cli.app import main
with signalled(signal.SIGKILL):
    main(["impact", "scene.toml", "--out", "r"])
"""


@pytest.mark.parametrize("plies", [1, pytest.param(3, marks=pytest.mark.slow(4))])
def test_a_killed_run_goes_on_from_its_checkpoint(succeed, scene, plies, tmp_path):
    """To the bit, of one ply and of a pack."""
    scene.write_text(SCENE.replace("[panel]", f"[panel]\nplies = {plies}"))
    paths = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    killed = subprocess.run([sys.executable, "-c", KILLED], cwd=tmp_path, env=paths, check=False)
    assert killed.returncode == -signal.SIGKILL
    succeed("impact", scene, "--out", "r", "--resume")
    assert not (tmp_path / "r" / "checkpoint.h5").exists()
    succeed("impact", scene, "--out", "whole")
    whole = datasets(tmp_path / "whole" / "histories.h5")
    assert datasets(tmp_path / "r" / "histories.h5") == whole
