"""A scene with [history]: histories in the file, fronts in it and in the report, pictures; the rest as without it."""

import h5py
import numpy as np
import pytest

from shellfabric.output.histories import EDGES
from shellfabric.output.wave_fronts import fronts
from tests.scene_text import impact_scene
from weavecell.results.impact import ImpactRecord

MEASURE = """
[history]
interval = "1 us"
warp = ["0 mm", "5 mm"]
report_positions = ["5 mm", "20 mm", "90 mm"]
"""


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Results without and with [history]."""
    from weavecell.cli import app

    folder = tmp_path_factory.mktemp("measured")
    for name, text in (("without", ""), ("with", MEASURE)):
        scene = impact_scene("100 m/s", "80 mm", "80 us", run='outputs = ["pictures", "report"]', extra=text)
        (folder / f"{name}.toml").write_text(scene)
        with pytest.raises(SystemExit) as leaving:
            app.main(["impact", str(folder / f"{name}.toml"), "--out", str(folder / name)])
        assert leaving.value.code == 0
    return folder / "without", folder / "with"


def test_file(folders):
    """Every dataset has its unit, and what is read back is what fronts are read off."""
    with h5py.File(folders[0] / "histories.h5") as file:
        assert "measured" not in file
    with h5py.File(folders[1] / "histories.h5") as file:
        group = file["measured/00"]
        assert sorted(group) == ["edges", "fronts", "time", "yarns"]
        assert sorted(group["edges"]) == sorted(EDGES)
        assert [name.split("-")[1] for name in sorted(group["yarns"])] == ["warp", "warp", "weft"]
        for inner in group["yarns"].values():
            np.testing.assert_array_equal(inner["strain"][()], inner["tension"][()] / inner.attrs["EA"])
        group.visititems(lambda _, item: item.attrs["unit"] if isinstance(item, h5py.Dataset) else None)
        speeds = {name: inner.attrs["speed"] for name, inner in group["fronts"].items()}
    (measured,) = ImpactRecord.read(folders[1] / "histories.h5").measured
    again = {f"{front.family}-{front.kind}": front.speed for front in fronts(measured)}
    assert set(again) == {f"{f}-{k}" for f in ("warp", "weft") for k in ("longitudinal", "transverse")}
    for name, speed in again.items():
        np.testing.assert_equal(speed, speeds[name])
    assert 800 < again["warp-longitudinal"] < again["weft-longitudinal"] < 4000  # the weft has less crimp


def test_record_survives_its_file(folders, tmp_path):
    record = ImpactRecord.read(folders[1] / "histories.h5")
    record.write(tmp_path / "again.h5")
    (again,), (first,) = ImpactRecord.read(tmp_path / "again.h5").measured, record.measured
    np.testing.assert_array_equal(again.t, first.t)
    for one, other in zip(again.yarns, first.yarns):
        assert (one.family, one.offset, one.EA, one.crimp) == (other.family, other.offset, other.EA, other.crimp)
        np.testing.assert_array_equal(one.tension, other.tension)
        np.testing.assert_array_equal(one.deflection, other.deflection)
    assert ImpactRecord.read(folders[0] / "histories.h5").measured == ()


def test_report_and_pictures(folders):
    names = [{path.stem for path in (folder / "pictures").iterdir()} for folder in folders]
    assert names[1] - names[0] == {"tensions", "fronts", "profiles", "edges"}
    pages = [(folder / "report.html").read_text() for folder in folders]
    assert 'id="measures"' in pages[1]
    assert 'id="measures"' not in pages[0]
    assert "speed along the yarn [m/s]" in pages[1]


def test_measuring_changes_nothing_else(folders):
    one, other = (ImpactRecord.read(folder / "histories.h5") for folder in folders)
    assert (one.outcome, one.steps) == (other.outcome, other.steps)
    np.testing.assert_array_equal(one.final[0].nodes, other.final[0].nodes)
    np.testing.assert_array_equal(one.final[0].tension, other.final[0].tension)
