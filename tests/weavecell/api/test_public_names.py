"""The solvers' own public names: each is there, and the stub that type checkers read has the same ones."""

from pathlib import Path

import pytest

import fabrics
import meshing
import shellfabric
import unitcell3d


@pytest.mark.parametrize("package", [fabrics, meshing, shellfabric, unitcell3d], ids=lambda one: one.__name__)
def test_every_name_is_there(package):
    if package is unitcell3d:
        pytest.importorskip("dolfinx")
    assert set(package.__all__) <= set(dir(package))
    for name in package.__all__:
        assert getattr(package, name).__doc__, name
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        package.nothing  # noqa: B018


@pytest.mark.parametrize("package", [fabrics, meshing, shellfabric, unitcell3d], ids=lambda one: one.__name__)
def test_the_stub_has_the_same_names(package):
    text = Path(package.__file__).with_suffix(".pyi").read_text("utf-8")
    namespace: dict = {}
    exec(text[text.index("__all__") :], namespace)
    assert namespace["__all__"] == package.__all__
    assert all(f"{name}" in text.split("__all__")[0] for name in package.__all__)
