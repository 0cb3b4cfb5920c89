"""Results on disk: they come back as they were, damage is a miss, and no code of a file is run."""

import io
import json
import os
import pickle
import subprocess
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import fabrics
from fabrics import catalogue
from fabrics.base import run_cache, store
from fabrics.base.assumed_number import Assumed
from fabrics.base.errors import InputError, UnstableError
from shellfabric.projectile.projectile import Projectile
from weavecell.runs.table import Shot

KEY = "0123456789abcdef" * 2
SHOT = Shot(
    61.25,
    float("nan"),
    True,
    number=3,
    drawn={"modulus": 1.02, "crimp_warp": np.float64(1.1)},
    weakest=(0.81, np.float64(0.77)),
    impact_point=(1e-3, -2e-3),
    balance=1e-4,
    doubtful=("viscous energy",),
)
CONTENTS = [
    None,
    True,
    -7,
    10**30,
    0.1,
    float("inf"),
    Assumed(0.2, 0.1, 0.3),
    Projectile(mass=2e-3, edge_radius=2e-4),
    "a\n\u00fc\ud800",
    [1, [2.5, "x"]],
    (1, ("a", None)),
    {"a": {2: (3,)}, ("b", 1): [4]},
    {1, 2},
    frozenset("abcdefgh"),
    Path("a/b"),
    np.arange(12.0).reshape(3, 4)[:, ::2],
    np.float32(0.3),
    np.bool_(False),
    np.array(["a", "bc"]),
    SimpleNamespace(a=1, b=np.zeros(2)),
    SHOT,
    catalogue.load("S-720"),
    InputError("no", file="f", key="k", value=3, allowed="4"),
    UnstableError("the energy error is 12 %", where="element 7"),
]


def written(content):
    file = io.BytesIO()
    store.write(content, file)
    return file.getvalue()


def same(a, b):
    return type(a) is type(b) and written(a) == written(b)


@pytest.mark.parametrize("content", CONTENTS, ids=lambda content: type(content).__name__)
def test_a_result_comes_back_as_it_was(content):
    found = store.read(io.BytesIO(written(content)))
    assert same(found, content)
    if isinstance(content, Exception):
        assert str(found) == str(content)


def test_what_is_written_does_not_depend_on_the_hashes_of_a_process():
    program = (
        "import io; from fabrics.base import store; file = io.BytesIO();"
        "store.write([set('abcdefgh'), {'k': frozenset(map(str, range(20)))}], file);"
        "print(file.getvalue().hex())"
    )
    made = {
        subprocess.run(
            [sys.executable, "-c", program],
            env=os.environ | {"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2", "3")
    }
    assert len(made) == 1


@dataclass
class Foreign:
    """Of a module that is none of ours."""

    value: int = 1


@pytest.mark.parametrize("content", [Foreign(), print, object(), np.array([None]), 1j, b"a"])
def test_what_cannot_be_kept_is_refused_when_it_is_written(content):
    with pytest.raises(TypeError, match="cannot be kept"):
        written([content])


def test_a_file_that_is_cut_or_changed_anywhere_is_a_miss(tmp_path):
    kept = run_cache.RunCache(tmp_path)
    kept[KEY] = content = {"shots": [SHOT], "table": np.linspace(1, 2, 50)}
    whole = kept.file(KEY).read_bytes()
    assert same(kept[KEY], content)
    random = np.random.default_rng(4)
    for place in (0, 1, 40, *random.integers(len(whole), size=100)):
        kept.file(KEY).write_bytes(whole[:place])
        assert KEY not in kept
        changed = bytearray(whole)
        changed[place] ^= 1 << int(random.integers(8))
        kept.file(KEY).write_bytes(changed)
        # bytes of the archive that say nothing may change nothing
        assert KEY not in kept or same(kept[KEY], content)
    kept.file(KEY).unlink()
    kept.file(KEY).mkdir()
    assert KEY not in kept


class Planted:
    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return os.mkdir, (str(self.path),)


def planted_files(path):
    """{what it is: bytes} of files that run code where they are unpickled."""
    yield "a pickle", pickle.dumps(Planted(path))
    file = io.BytesIO()
    np.save(file, np.array([Planted(path)], dtype=object), allow_pickle=True)
    yield "an npy file", file.getvalue()
    file = io.BytesIO()
    np.savez(file, content=np.array([Planted(path)], dtype=object), sha256=np.zeros(32, np.uint8))
    yield "an npz file", file.getvalue()
    for name in ("os:system", "subprocess:Popen", "fabrics.base.run_cache:Path", "antigravity:x"):
        plain = {"object": name, "state": {"dict": [["args", {"tuple": [f"mkdir {path}"]}]]}}
        text = json.dumps({"format": store.FORMAT, "content": plain}).encode()
        named = {"content": np.frombuffer(text, np.uint8)}
        named["sha256"] = np.frombuffer(store._digest(named), np.uint8)
        file = io.BytesIO()
        np.savez(file, **named)
        yield name, file.getvalue()
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("../content.npy", pickle.dumps(Planted(path)))
    yield "a zip file", file.getvalue()


def test_code_that_was_planted_is_not_run(tmp_path):
    hit = tmp_path / "hit"
    kept = run_cache.RunCache(tmp_path / "runs")
    kept[KEY] = 1
    for what, content in planted_files(hit):
        kept.file(KEY).write_bytes(content)
        kept.file(KEY).with_suffix(".pickle").write_bytes(content)
        assert KEY not in kept, what
    assert not hit.exists()


def test_results_that_are_damaged_are_computed_again(tmp_path):
    computed = []

    def square(number):
        computed.append(number)
        return number * number, np.float64(number)

    def compute():
        return run_cache.results(square, [(3,), (4,)], folder=tmp_path)

    first = compute()
    files = sorted(tmp_path.glob("*.npz"))
    files[0].write_bytes(b"")
    files[1].write_bytes(files[1].read_bytes()[:40])
    assert compute() == first == [(9, 3.0), (16, 4.0)]
    assert computed == [3, 4, 3, 4]


def test_nothing_of_the_project_pickles_to_disk():
    root = Path(fabrics.__file__).parents[1]
    found = []
    for package in store.PACKAGES:
        for file in (root / package).rglob("*.py"):
            text = file.read_text("utf-8")
            for word in (
                "import pickle",
                "import joblib",
                "import shelve",
                "import dill",
                "allow_pickle=True",
            ):
                if word in text:
                    found.append((file.name, word))
    assert found == []
