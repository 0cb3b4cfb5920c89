"""One rule for all kept results: the key changes with what is computed and with the code that computes it, alone."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from fabrics import catalogue, run_cache, source_code
from fabrics.errors import InputError

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Case:
    name: str
    value: float
    array: np.ndarray = None


def test_equal_inputs_have_one_digest_and_others_another():
    long = np.arange(5000.0)  # numpy prints the ends of such an array alone
    other = long.copy()
    other[2500] += 1e-9
    values = [
        None, True, 1, 1.0, -0.0, 0.0, "1", b"1", (1, 2), ((1,), 2), [1, 2, 3], {"a": 1}, {"a": 2}, {"b": 1}, {1, 2},
        long, other, long.astype(np.float32), long.reshape(2, -1), Case("a", 1.0), Case("b", 1.0), Case("a", 1.0, long),
        Case("a", 1.0, other),
    ]  # fmt: skip
    digests = [run_cache.inputs_digest(value) for value in values]
    assert len(set(digests)) == len(values)
    assert run_cache.inputs_digest({"b": 1, "a": 2}) == run_cache.inputs_digest({"a": 2, "b": 1})
    assert run_cache.inputs_digest(np.float64(2.5)) == run_cache.inputs_digest(2.5)
    assert run_cache.inputs_digest((1, 2)) == run_cache.inputs_digest([1, 2])  # JSON gives back lists
    fabric = catalogue.load("S-720")
    assert run_cache.inputs_digest(fabric) == run_cache.inputs_digest(replace(fabric))
    assert run_cache.inputs_digest(fabric) != run_cache.inputs_digest(replace(fabric, section="ellipse"))


@pytest.mark.parametrize("value", [print, lambda: 1, object(), Case, np.array([None])])
def test_what_has_no_value_of_its_own_is_no_part_of_a_key(value):
    with pytest.raises(TypeError, match="part of a key"):
        run_cache.inputs_digest(("a", [value]))


FILES = {
    "fabrics/__init__.py": "",
    "fabrics/yarn.py": "import math\n",
    "fabrics/files.py": "from importlib import resources\nfind = resources.files('fabrics')\n",
    "fabrics/data.toml": "a = 1\n",
    "shellfabric/__init__.py": "",
    "shellfabric/march.py": "def run():\n    from fabrics.yarn import Yarn\n",
    "shellfabric/reader.py": "from fabrics import files\n",
    "shellfabric/pictures.py": "",
    "shellfabric/jit/__init__.py": "",
    "shellfabric/jit/a_kernels.py": "from . import b_kernels\nfrom ..march import run\n",
    "shellfabric/jit/b_kernels.py": "",
    "meshing/grid.py": "",
    "validation/__init__.py": "",
    "validation/alone.py": "",
    "validation/study.py": "from importlib import import_module\n",
}


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """A tree of our packages in a folder of its own."""
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(source_code, "ROOT", tmp_path)
    for name in ("file_of", "closure", "data_of", "name_of", "imports"):
        function = getattr(source_code, name)
        defaults = tuple(tmp_path if value == ROOT else value for value in function.__defaults__)
        monkeypatch.setattr(function, "__defaults__", defaults)
    return tmp_path


@pytest.mark.parametrize(
    ("module", "changed", "counts"),
    [
        ("shellfabric.march", "shellfabric/march.py", True),
        ("shellfabric.march", "fabrics/yarn.py", True),  # imported in a function
        ("shellfabric.march", "shellfabric/__init__.py", True),
        ("shellfabric.march", "shellfabric/reader.py", True),  # its objects may be handed to the march
        ("shellfabric.march", "fabrics/data.toml", True),
        ("shellfabric.march", "shellfabric/pictures.py", False),
        ("shellfabric.march", "meshing/grid.py", False),
        ("shellfabric.jit.a_kernels", "shellfabric/jit/b_kernels.py", True),  # by relative imports
        ("shellfabric.jit.a_kernels", "fabrics/yarn.py", True),
        ("validation.study", "validation/alone.py", True),  # by a computed name
        ("validation.alone", "fabrics/yarn.py", False),
    ],
)
def test_what_counts_as_the_code_of_a_module(tree, module, changed, counts):
    def digest():
        run_cache.code.cache_clear()
        return run_cache.code(module)

    before = digest()
    assert digest() == before
    with open(tree / changed, "a") as file:
        file.write("# changed\n")
    assert (digest() != before) == counts
    run_cache.code.cache_clear()
    with pytest.raises(ModuleNotFoundError):
        source_code.closure(["shellfabric.nothing"])


def test_a_key_changes_with_inputs_version_and_code(monkeypatch):
    first = run_cache.key(("a", 1.0), "fabrics.yarn")
    assert first == run_cache.key(("a", 1.0), "fabrics.yarn")
    assert first != run_cache.key(("a", 2.0), "fabrics.yarn")
    assert first != run_cache.key(("a", 1.0), "meshing.grid")
    monkeypatch.setattr(run_cache, "__version__", "9.9")
    assert first != run_cache.key(("a", 1.0), "fabrics.yarn")
    assert run_cache.version("fabrics.yarn").startswith("9.9 (code ")


@pytest.mark.parametrize("form", [run_cache.PICKLE, run_cache.JSON])
def test_results_come_back(tmp_path, form):
    kept = run_cache.RunCache(tmp_path, form)
    assert "k" not in kept
    kept["k"] = {"a": [1.0, "b"]}
    assert run_cache.RunCache(tmp_path, form)["k"] == {"a": [1.0, "b"]}
    assert [path.name for path in tmp_path.iterdir()] == [f"k.{form.suffix}"]


def test_a_stamp_tells_other_inputs_from_other_code(monkeypatch, tmp_path):
    wanted = run_cache.stamp("a", "fabrics.yarn")
    run_cache.check_stamp(wanted, wanted, tmp_path)
    with pytest.raises(InputError, match="of another run"):
        run_cache.check_stamp(run_cache.stamp("b", "fabrics.yarn"), wanted, tmp_path)
    with pytest.raises(InputError, match="earlier version") as caught:
        run_cache.check_stamp({"identity": wanted["identity"]}, wanted, tmp_path)
    assert "\n" not in str(caught.value)
