"""One rule for all kept results: the key changes with what is computed and with the code that computes it, alone."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.base import run_cache
from fabrics.base.errors import InputError


@dataclass(frozen=True)
class Case:
    name: str
    value: float
    array: np.ndarray = None


@dataclass(frozen=True)
class Other:
    """Another thing with the same fields."""

    name: str
    value: float
    array: np.ndarray = None


def test_equal_inputs_have_one_digest_and_others_another():
    long = np.arange(5000.0)  # numpy prints the ends of such an array alone
    other = long.copy()
    other[2500] += 1e-9
    values = [
        None,
        True,
        1,
        1.0,
        -0.0,
        0.0,
        "1",
        b"1",
        (1, 2),
        ((1,), 2),
        [1, 2, 3],
        {"a": 1},
        {"a": 2},
        {"b": 1},
        {1, 2},
        long,
        other,
        long.astype(np.float32),
        long.reshape(2, -1),
        Case("a", 1.0),
        Other("a", 1.0),
        ("a", 1.0, None),
        Case("b", 1.0),
        Case("a", 1.0, long),
        Case("a", 1.0, other),
    ]
    digests = [run_cache.inputs_digest(value) for value in values]
    assert len(set(digests)) == len(values)
    assert run_cache.inputs_digest({"b": 1, "a": 2}) == run_cache.inputs_digest({"a": 2, "b": 1})
    assert run_cache.inputs_digest(np.float64(2.5)) == run_cache.inputs_digest(2.5)
    # JSON gives back lists
    assert run_cache.inputs_digest((1, 2)) == run_cache.inputs_digest([1, 2])
    fabric = catalogue.load("S-720")
    assert run_cache.inputs_digest(fabric) == run_cache.inputs_digest(replace(fabric))
    assert run_cache.inputs_digest(fabric) != run_cache.inputs_digest(
        replace(fabric, section="ellipse")
    )


@pytest.mark.parametrize("value", [print, lambda: 1, object(), Case, np.array([None])])
def test_what_has_no_value_of_its_own_is_no_part_of_a_key(value):
    with pytest.raises(TypeError, match="part of a key"):
        run_cache.inputs_digest(("a", [value]))


@pytest.mark.parametrize(
    "module, file, counts",
    [
        ("shellfabric.impact.run", "shellfabric/new.py", True),
        ("shellfabric.impact.run", "fabrics/catalogue/new.toml", True),
        ("shellfabric.impact.run", "shellfabric/pictures_new.py", False),
        ("shellfabric.impact.run", "weavecell/studies/new.py", False),
        ("weavecell.runs.v50", "weavecell/scenes/new.py", True),
        ("weavecell.runs.v50", "weavecell/report/new.py", False),
        ("validation.claims.runner", "validation/published/new.py", True),
    ],
)
def test_what_counts_as_the_code_of_a_module(tmp_path, monkeypatch, module, file, counts):
    monkeypatch.setattr(run_cache, "ROOT", tmp_path)
    for name in (file, "fabrics/yarn.py", f"{module.partition('.')[0]}/__init__.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    before = run_cache.code.__wrapped__(module)
    (tmp_path / file).write_text("changed")
    assert (run_cache.code.__wrapped__(module) != before) == counts


def test_the_code_of_a_function_of_the_user_is_its_file():
    assert Path(__file__) in run_cache.files_of(__name__)
    assert run_cache.code(__name__)


def test_a_key_changes_with_inputs_version_and_code(monkeypatch):
    first = run_cache.key(("a", 1.0), "fabrics.yarn")
    assert first == run_cache.key(("a", 1.0), "fabrics.yarn")
    assert first != run_cache.key(("a", 2.0), "fabrics.yarn")
    assert first != run_cache.key(("a", 1.0), "weavecell.runs.v50")
    monkeypatch.setattr(run_cache, "__version__", "9.9")
    assert first != run_cache.key(("a", 1.0), "fabrics.yarn")
    assert run_cache.version("fabrics.yarn").startswith("9.9 (code ")


def test_results_come_back(tmp_path):
    kept = run_cache.RunCache(tmp_path)
    assert "k" not in kept
    kept["k"] = {"a": [1.0, "b"]}
    assert run_cache.RunCache(tmp_path)["k"] == {"a": [1.0, "b"]}
    assert [path.name for path in tmp_path.iterdir()] == ["k.npz"]


def test_a_stamp_tells_other_inputs_from_other_code(monkeypatch, tmp_path):
    wanted = run_cache.stamp("a", "fabrics.yarn")
    run_cache.check_stamp(wanted, wanted, tmp_path)
    with pytest.raises(InputError, match="of another run"):
        run_cache.check_stamp(run_cache.stamp("b", "fabrics.yarn"), wanted, tmp_path)
    with pytest.raises(InputError, match="earlier version") as caught:
        run_cache.check_stamp({"identity": wanted["identity"]}, wanted, tmp_path)
    assert "\n" not in str(caught.value)


def test_results_of_other_code_are_computed_again(tmp_path, monkeypatch):
    computed = []

    def square(number):
        computed.append(number)
        return number * number

    def compute():
        found = run_cache.results(square, [(1,), (2,)], folder=tmp_path)
        assert found == [1, 4]
        return computed

    assert compute() == [1, 2]
    assert compute() == [1, 2]  # nothing again
    monkeypatch.setattr(run_cache, "code", lambda *modules: "other code")
    assert compute() == [1, 2, 1, 2]
