"""A checkpoint of which a byte was changed is no checkpoint: told in one line, kept, and the run begins anew."""

from unittest import mock

import h5py
import numpy as np
import pytest

from fabrics.base.errors import InputError
from fabrics.base.files import write_hdf5
from fabrics.base.read_formats import read_hdf5
from shellfabric.loop import checkpoint
from tests.scene_text import FRAME, datasets, impact_scene
from weavecell.results import run_folder

COUNT = 64
RUN = 'snapshot_interval = "2 us"\ncheckpoint_interval = "2 us"\noutputs = []'


@pytest.fixture
def shot(command, interrupted, tmp_path):
    """The words that resume an interrupted shot in the folder r."""
    (tmp_path / "scene.toml").write_text(impact_scene(opening="20 mm", end_time="10 us", run=RUN))
    with interrupted(0.6):
        assert command("impact scene.toml --out r")[0] == 130
    return "impact scene.toml"


@pytest.fixture
def coupon(command, tmp_path):
    """The words that resume an interrupted coupon in the folder r."""
    (tmp_path / "scene.toml").write_text(FRAME + "outputs = []\n")
    write = run_folder.write_states

    def interrupted(*arguments):
        write(*arguments)
        raise KeyboardInterrupt

    with mock.patch.object(run_folder, "write_states", interrupted):
        assert command("coupon scene.toml --out r")[0] == 130
    return "coupon scene.toml"


def changed(content, random, number):
    """The bytes with one changed: in the head, at the end, or anywhere."""
    places = [number // 3, len(content) - 1 - number // 3, int(random.integers(len(content)))]
    content = bytearray(content)
    content[places[number % 3]] ^= 1 << int(random.integers(8))
    return bytes(content)


@pytest.mark.parametrize("kind", ["shot", "coupon"])
def test_a_changed_byte_anywhere_is_refused(request, succeed, tmp_path, kind):
    words = request.getfixturevalue(kind)
    path = tmp_path / "r/checkpoint.h5"
    content = path.read_bytes()
    formats = (checkpoint.FORMAT, run_folder.OF_COUPON)
    assert run_folder.is_checkpoint(path.name, path)
    random = np.random.default_rng(7)
    for number in range(COUNT):
        path.write_bytes(changed(content, random, number))
        assert not run_folder.is_checkpoint(path.name, path)
        with (
            pytest.raises(InputError) as refused,
            read_hdf5(path, *formats, what="checkpoint", sealed=True),
        ):
            pass
        assert "\n" not in str(refused.value)
    # by hand, to another state of the same run
    path.write_bytes(content)
    with h5py.File(path, "r+") as file:
        part = file["00000/x" if kind == "coupon" else "steps"]
        part[...] = part[()] + 1e-3
    before = path.read_bytes()
    assert before != content
    out = succeed(f"{words} --out r --resume")
    assert "checkpoint.h5 is not as weavecell wrote it: kept as checkpoint.h5.found" in out
    assert (tmp_path / "r/checkpoint.h5.found").read_bytes() == before
    succeed(f"{words} --out whole")
    assert datasets(tmp_path / "r/histories.h5") == datasets(tmp_path / "whole/histories.h5")


def test_a_file_without_its_digest_is_refused(tmp_path):
    path = tmp_path / "checkpoint.h5"
    for format, words in ((checkpoint.FORMAT, "has no digest"), ("other 1", "format = 'other 1'")):
        with write_hdf5(path, format) as file:
            file["x"] = np.arange(3.0)
        with (
            pytest.raises(InputError, match=words),
            read_hdf5(path, checkpoint.FORMAT, what="checkpoint", sealed=True),
        ):
            pass
