"""A file larger than any of its kind is refused in one line, before it is read: at every door that takes one."""

import os
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

import weavecell as wc
from fabrics import catalogue
from fabrics.base import files, store
from fabrics.base.errors import InputError
from fabrics.base.read_formats import read_hdf5
from tests.scene_text import FRAME, impact_scene

ROOT = Path(wc.__file__).parents[1]
STL = ROOT / "tests/weavecell/scenes/pyramid.stl"
NOSE = """shape = "stl"
stl = "huge.stl"
stl_unit = "mm"
mass = "3 g"
edge_radius = "0.3 mm"
strike_velocity = "100 m/s"
"""
PLY = "force [N], displacement [mm]\n" + "".join(
    f"{force}, {0.02 * force / (force + 40)}\n" for force in range(20, 1000, 20)
)
# words, and the files in this folder that one after the other is huge
DOORS = {
    "impact scene.toml --check": ["scene.toml"],
    "impact own.toml --check": ["own.toml", "fabric.toml"],
    "impact law.toml --check": ["law.json"],
    "impact contact.toml --check": ["contact.csv"],
    "impact stl.toml --check": ["huge.stl"],
    "impact mass.toml --check": ["nose.toml"],
    "v50 scene.toml --check": ["scene.toml"],
    "sweep scene.toml --over panel.plies=1,2 --check": ["scene.toml"],
    "compare scene.toml own.toml --check": ["scene.toml", "own.toml"],
    "export scene.toml --to lsdyna --out deck": ["scene.toml"],
    "coupon coupon.toml --check": ["coupon.toml"],
    "show fabric.toml": ["fabric.toml"],
    "cite scene.toml": ["scene.toml"],
    "cite out": ["out/tests.json"],
    "biaxial fabric.toml --ratio 1:1": ["fabric.toml"],
    "biaxial S-720 --ratio 1:1 --law law.json": ["law.json"],
    "calibrate S-720 --biaxial biaxial.csv --check": ["biaxial.csv"],
    "calibrate S-720 --platen-curve contact.csv --check": ["contact.csv"],
    "crossover yarn S-720 --mesh mine.msh": ["mine.msh"],
    "crossover path S-720 --path contact.csv": ["contact.csv"],
    "reduce tests tests.csv": ["tests.csv"],
    "reduce shot tests.csv --mass '3 g'": ["tests.csv"],
    "reduce compression tests.csv --platen-area '361 mm^2'": ["tests.csv"],
    "reduce compression small.csv --rig tests.csv --platen-area '361 mm^2'": ["tests.csv"],
    "fabrics new new.toml --from tests.csv": ["tests.csv"],
    "view out/panel.pvd --html a.html": ["out/panel.pvd"],
    "view out/a.vtu --screenshot a.png": ["out/a.vtu"],
}
# files with lines that open a file another way, and the number of these lines
OTHERS = {
    "fabrics/base/files.py": 5,  # the reader, and files that are written
    "fabrics/base/kernel_cache.py": 5,  # source of the package
    "fabrics/base/read_formats.py": 2,  # HDF5, whose numbers are counted
    "fabrics/base/run_cache.py": 2,  # source of the package; what `store` counts
    "shellfabric/part_of_others.py": 1,  # code of an installed package
    "fabrics/base/store.py": 1,
    "weavecell/answers/calibration.py": 1,  # a picture that was just drawn
    "weavecell/decks/mesh_files.py": 1,  # written
    "weavecell/report/page.py": 1,  # a template of the package
    "weavecell/results/file_list.py": 2,  # appended to; a digest, part by part
    "weavecell/results/one_table.py": 2,  # of `result_folder`
    "weavecell/results/out_folder.py": 1,  # the lock, of which nothing is read
    "weavecell/results/result_folder.py": 2,  # behind `check_size`
    "weavecell/results/vtk.py": 1,  # the same
}


@pytest.fixture
def folder(command, tmp_path):
    """The files of `DOORS`, each as it should be, in this folder."""
    texts = {
        "scene.toml": impact_scene(),
        "own.toml": impact_scene().replace('name = "S-720"', 'file = "fabric.toml"'),
        "law.toml": impact_scene().replace("[projectile]", 'law = "law.json"\n[projectile]', 1),
        "contact.toml": impact_scene(panel='plies = 2\nply_contact = "contact.csv"'),
        "contact.csv": "pressure [MPa], thickness [mm]\n0.1, 0.3\n1, 0.25\n10, 0.2\n",
        "stl.toml": re.sub(r"(?s)mass.*?\n\n", NOSE + "\n", impact_scene(), count=1),
        "mass.toml": re.sub(r"(?s)mass.*?edge_radius[^\n]*", 'name = "nose.toml"', impact_scene()),
        "nose.toml": "mass = '3 g'\n",
        "coupon.toml": FRAME,
        "tests.csv": "velocity [m/s], outcome\n80, PP\n120, CP\n",
        "small.csv": PLY,
        "mine.msh": "",
        "biaxial.csv": "strain\n",
        "panel.pvd": "<VTKFile/>",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    shutil.copy(Path(catalogue.__file__).parent / "S-720.toml", tmp_path / "fabric.toml")
    shutil.copy(STL, tmp_path / "huge.stl")
    catalogue.load("S-720").laws[0].to_json(tmp_path / "law.json")
    (tmp_path / "out").mkdir()
    for name in ("tests.json", "panel.pvd", "a.vtu"):
        (tmp_path / "out" / name).write_text("{}")
    return tmp_path


@pytest.mark.parametrize("words", DOORS)
def test_a_file_too_large_is_refused_at_every_door(command, folder, words):
    for name in DOORS[words]:
        path = folder / name
        content = path.read_bytes()
        # of no room on the disk
        os.truncate(path, 10**10)
        before = set(folder.rglob("*"))
        code, out, err = command(*shlex.split(words))
        assert code == 2, (name, out, err)
        line = err.splitlines()[-1]
        assert f"{Path(name).name}: has 10,000 MB; must have " in line, err
        assert set(folder.rglob("*")) == before
        path.write_bytes(content)


def test_numbers_that_a_small_file_only_claims_are_not_read(tmp_path):
    path = tmp_path / "a.h5"
    with files.write_hdf5(path, "kind 1") as file:
        file.create_dataset("x", shape=(10**12,), dtype=float, chunks=(10**4,))
    assert path.stat().st_size < 10**5
    with pytest.raises(InputError, match="8,000,000 MB; must have"), read_hdf5(path, "kind 1"):
        pass
    packed = tmp_path / "a.npz"
    np.savez_compressed(packed, content=np.zeros(10**7))
    with open(packed, "rb") as file, pytest.raises(store.UnreadableResult, match="too large"):
        store.read(file)


def test_a_device_without_an_end_is_refused(monkeypatch):
    monkeypatch.setitem(files.MOST, "text or table", 10**6)
    with pytest.raises(InputError, match="must have 1 MB at most, as a text or table"):
        files.read_text("/dev/zero")


def test_every_file_of_a_user_is_opened_by_one_reader():
    """What opens a file another way reads files of the package, of the system, or such as were judged before."""
    opens = re.compile(
        r"\.read_(?:text|bytes)\(|(?<![\w.])open\((?!\))|\b(?:pyvista\.read|np\.load|read_csv|ElementTree\.parse|"
        r"loadtxt|genfromtxt|fromfile|h5py\.File)\("
    )
    package = re.compile(
        r"__file__|resources|/proc/|with_(?:name|suffix)|>>>|\bfiles\.read_|^\s*def "
    )
    found = {}
    for folder in ("fabrics", "meshing", "unitcell3d", "shellfabric", "weavecell"):
        for path in (ROOT / folder).rglob("*.py"):
            lines = [line.split("#")[0] for line in path.read_text().splitlines()]
            count = sum(bool(opens.search(one) and not package.search(one)) for one in lines)
            if count:
                found[path.relative_to(ROOT).as_posix()] = count
    assert found == OTHERS
