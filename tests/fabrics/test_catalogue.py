"""The catalogue's files, whole files, and the file of a response surface."""

from pathlib import Path

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.base.files import noting_reads, replace_whole, write_whole
from fabrics.surface import ResponseSurface


def test_every_number_of_the_catalogue_has_a_source():
    assert len(catalogue.list_names()) == 8
    for name in catalogue.list_names():
        fabric = catalogue.load(name)
        assert fabric.name == name
        assert len(fabric.sources) >= 14
        for key, entry in fabric.sources.items():
            assert entry["source"], f"{name} {key}"
            assert entry["status"] in catalogue.STATUSES


def test_errata_are_in_the_data():
    assert catalogue.load("S-728").laws[0].a == pytest.approx(4.4e-5)  # E-01
    assert catalogue.load("S-720").laws[1].b == pytest.approx(5.8e-5)  # E-03
    assert catalogue.load("glass-unbalanced").laws[0].F0 == pytest.approx(0.4423, abs=1e-4)  # E-30
    assert catalogue.load("S-720").weave.warp.E == pytest.approx(9.6e10)  # E-25


def test_files_are_whole_or_absent(tmp_path):
    path = tmp_path / "deep" / "file.txt"
    with pytest.raises(RuntimeError), write_whole(path) as file:
        file.write("half")
        raise RuntimeError
    assert list(path.parent.iterdir()) == []
    with write_whole(path) as file:
        file.write("old")
    with pytest.raises(RuntimeError), replace_whole(path) as beside:
        beside.write_text("half of the new")
        raise RuntimeError
    assert path.read_text() == "old"
    assert list(path.parent.iterdir()) == [path]


def test_response_surface_file_keeps_every_bit(tmp_path):
    axes = {"d1": np.linspace(0, 3e-5, 4), "d2": np.linspace(0, 2e-5, 3)}
    columns = axes | {
        name: np.random.default_rng(1).random((4, 3)) for name in ("T1", "T2", "F_c", "h1", "h2")
    }
    ResponseSurface(**columns, fabric="S-720", provenance="a test").write(tmp_path / "surface.h5")
    back = ResponseSurface.read(tmp_path / "surface.h5")
    assert all(np.array_equal(getattr(back, name), column) for name, column in columns.items())
    assert back.fabric == "S-720"
    assert back.provenance == "a test"


def test_a_fabric_is_built_again_only_if_its_file_changes(tmp_path):
    """Each load reads the file, which is noted for the folder of the results."""
    text = (Path(catalogue.__file__).parent / "S-720.toml").read_text()
    own, other = tmp_path / "own.toml", tmp_path / "other.toml"
    own.write_text(text)
    other.write_text(text)
    first = catalogue.load(own)
    with noting_reads() as reads:
        assert catalogue.load(own) is first
    assert own.resolve() in reads
    assert catalogue.load(other) is not first
    assert text.count('"0.32 mm"') == 1
    own.write_text(text.replace('"0.32 mm"', '"0.31 mm"'))
    changed = catalogue.load(own).micrograph["warp"]
    assert changed["thickness"] == pytest.approx(0.31e-3)
    own.write_text(text.replace('"0.32 mm"', '"0.32 kg"'))
    for _ in range(2):
        with pytest.raises(InputError, match=r"own\.toml"):
            catalogue.load(own)
