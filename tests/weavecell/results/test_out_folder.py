"""The folder of --out: probed before anything is computed, kept from other runs, and what it replaces is named."""

import os
import subprocess
import sys

import pytest

from fabrics.errors import InputError
from weavecell.results import out_folder

HOLD = (
    "import sys; from pathlib import Path; from weavecell.results import out_folder; "
    "out_folder.claim(Path(sys.argv[1])); print('held', flush=True); input()"
)
INPUTS = {
    "scene.toml": '[fabric]\nname = "S-720"\n[panel]\nopening = "203 mm"\n'
    '[projectile]\nname = "FSP 1.10 g"\nstrike_velocity = "90 m/s"\n',
    "coupon.toml": '[fabric]\nname = "S-720"\n[picture_frame]\nshear_angle = "10 deg"\n',
    "shots.csv": "velocity [m/s], outcome\n80, PP\n120, CP\n",
    "velocity.csv": "time [us], velocity [m/s]\n1, 92\n2, 91\n3, 90\n4, 89\n5, 88\n",
}
CALLS = (
    "impact scene.toml", "impact scene.toml --draws 2", "coupon coupon.toml", "biaxial S-720", "v50 S-720",
    "critical-velocity S-720", "sensitivity S-720", "sweep S-720 --over panel.plies=1,2", "compare shots.csv S-720",
    "export S-720 --to lsdyna",
)  # fmt: skip


@pytest.fixture(autouse=True)
def released():
    yield
    out_folder.release()


@pytest.mark.parametrize("call", CALLS)
def test_a_folder_that_cannot_be_made_is_refused_before_the_run(command, tmp_path, monkeypatch, call):
    def computed(*_, **__):
        raise AssertionError("something is computed")

    monkeypatch.setattr("shellfabric.cell.model.CellTable.fill", computed)
    for name, text in INPUTS.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "file").write_text("")
    code, _, err = command(*call.split(), "--out", "file/out")
    assert err == "error: --out = 'file/out': must be a folder that can be written to (Not a directory)\n"
    assert code == 2


def test_a_run_is_kept_from_the_folder_of_another_until_that_ends(tmp_path):
    folder = tmp_path / "made" / "out"
    other = subprocess.Popen([sys.executable, "-c", HOLD, folder], stdin=-1, stdout=-1, text=True)
    assert other.stdout.readline() == "held\n"
    with pytest.raises(InputError, match="must be another folder: another run is writing to this one"):
        out_folder.claim(folder)
    other.kill()  # the system frees the lock
    other.communicate()
    out_folder.claim(folder)
    out_folder.claim(folder)
    assert os.listdir(folder) == [out_folder.LOCK]
    out_folder.release()
    assert os.listdir(folder) == []


def test_a_folder_that_was_made_and_is_empty_goes(tmp_path):
    out_folder.claim(tmp_path / "made" / "out")
    out_folder.release()
    assert os.listdir(tmp_path) == []


def test_what_is_replaced_is_named(command):
    assert command("biaxial", "S-731", "--ratio", "1:1", "--out", "b")[1].startswith("1:1 ")
    code, out, _ = command("biaxial", "S-731", "--ratio", "1:1", "--out", "b")
    assert code == 0
    assert out.startswith("replaces the results of S-731 of 20")
    assert out.splitlines()[0].endswith(" UTC in b")
