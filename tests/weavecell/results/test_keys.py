"""Result files hold documented keys only; those of the release before are read by the names of today."""

import json
from fnmatch import fnmatchcase
from pathlib import Path

import h5py
import numpy as np
import pytest

from fabrics.errors import InputError
from weavecell.cli import app
from weavecell.results import json_file, keys
from weavecell.results.impact import ImpactRecord
from weavecell.results.impact_shapes import Shape
from weavecell.results.pack import PackRecord
from weavecell.scenes import renamed_keys, toml_writer

DATA = Path(__file__).parent / "data"
BASE = {
    "fabric": {"name": "S-720"},
    "projectile": {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm", "strike_velocity": "400 m/s"},
    "panel": {"opening": "26 mm"},
    "run": {"end_time": "12 us", "snapshot_interval": "4 us", "outputs": []},
}
BLOCK = {"size": ["60 mm", "60 mm", "30 mm"], "min_size": "2 mm", "growth": 1.5}
IMPACTS = {
    "histories": BASE | {"history": {"warp": ["0 mm"]}},
    "bar": BASE | {"projectile": BASE["projectile"] | {"body": "elastic_bar"}, "backing": BLOCK},
    "accuracy": BASE | {"accuracy": {"residual_velocity": "50 %"}},
    "pack": BASE | {"panel": {"opening": "26 mm", "plies": 2}},
    "sliding pack": BASE | {"panel": {"opening": "26 mm", "plies": 2, "crossovers": "sliding"}},
}
FRAME = {"fabric": {"name": "S-720"}, "picture_frame": {"shear_angle": "10 deg", "crossovers": 2}}
PULL = {"fabric": {"name": "S-720"}, "pull_out": {"displacement": "0.1 mm", "samples": 20}, "run": {"outputs": []}}
COUPON = FRAME | {"run": {"steps": 2, "outputs": []}}


def run(folder, verb, scene):
    """The folder of results of a scene."""
    (folder / "scene.toml").write_text(toml_writer.dumps(scene))
    with pytest.raises(SystemExit) as leaving:
        app.main([verb, str(folder / "scene.toml"), "--out", str(folder / "r")])
    assert leaving.value.code == 0
    return folder / "r"


def find(path, table):
    """The first of the keys that a path, by / or by dots, is documented as; a * is one level. None if there is none."""
    parts = path.replace(".", "/").split("/")
    for key in table:
        pattern = key.name.replace(".", "/").split("/")
        if len(parts) == len(pattern) and all(map(fnmatchcase, parts, pattern)):
            return key
    return None


def leaves(value, table, path=""):
    """Paths of the entries of a summary; a documented table is an entry."""
    for name, inner in value.items():
        key = f"{path}.{name}" if path else name
        if isinstance(inner, dict) and find(key, table) is None:
            yield from leaves(inner, table, key)
        else:
            yield key


def check_documented(folder, of_summary, of_datasets):
    """No key without a row in its table, and the unit of every dataset is that of its row."""
    summary = json_file.read_summary(folder / "summary.json")
    table = (*keys.SHARED, *of_summary)
    assert [key for key in leaves(summary, table) if find(key, table) is None] == []
    scalars, attributes = {key.name for key in table}, []

    def see(name, item):
        attributes.extend(f"{name}/{key}" for key in item.attrs if not isinstance(item, h5py.Dataset))
        if isinstance(item, h5py.Dataset):
            assert set(item.attrs) == {"unit"}
            key = find(name, of_datasets)
            assert key is not None, name
            assert key.unit in ("", item.attrs["unit"]), name

    with h5py.File(folder / "histories.h5") as file:
        file.visititems(see)
        assert [key for key in file.attrs if key not in scalars and find(key, keys.ATTRIBUTES) is None] == []
    assert [name for name in attributes if find(name, keys.ATTRIBUTES) is None] == []


@pytest.mark.parametrize("name", IMPACTS)
def test_an_impact_has_documented_keys_only(tmp_path, name):
    check_documented(run(tmp_path, "impact", IMPACTS[name]), keys.IMPACT, keys.DATASETS)


@pytest.mark.parametrize("scene", [COUPON, PULL], ids=["frame", "pull-out"])
def test_a_coupon_has_documented_keys_only(tmp_path, scene):
    check_documented(run(tmp_path, "coupon", scene), keys.COUPON, keys.COUPON_DATASETS)


def test_energies_of_the_solvers_are_documented():
    from shellfabric.sliding_plies.solver import SLIDING_PACK_ENERGIES

    names = [renamed_keys.ENERGIES.get(name, name) for name in SLIDING_PACK_ENERGIES]
    assert [name for name in names if find(name, keys.ENERGIES) is None] == []


def test_keys_follow_the_convention():
    """A quantity with a unit has it at the end of its key in summary.json."""
    units = {"m/s": "m_s", "kg": "kg", "s": "s", "m": "m", "N": "N", "J": "J", "rad": "rad"}
    for key in (*keys.SHARED, *keys.IMPACT):
        if key.unit in units and not key.name.endswith(".*"):
            assert key.name.endswith((f"_{units[key.unit]}", "_ns")), key.name


@pytest.mark.parametrize(("kind", "name"), [(ImpactRecord, "impact-2.h5"), (PackRecord, "pack-2.h5")])
def test_a_file_of_the_release_before_is_read_with_a_warning(kind, name, tmp_path, capsys):
    record = kind.read(DATA / name)
    told = capsys.readouterr().err
    assert told == (
        f"warning: {DATA / name}: format 2 has old names of keys (docs/keys.md); it is read until the next release\n"
    )
    np.testing.assert_array_equal(record.velocity, 100.0 - 5e5 * record.time)
    assert record.energies["error"][-1] == pytest.approx(0.002 * record.absorbed_energy)
    assert set(record.energies) >= {"yarn_strain", "failure_dissipation", "clamp_friction", "boundary_work", "jamming"}
    record.write(tmp_path / "new.h5")
    again = kind.read(tmp_path / "new.h5")
    assert capsys.readouterr().err == ""
    check_same(record, again)


def check_same(one, other):
    for name, value in vars(one).items():
        found = getattr(other, name)
        if isinstance(value, dict):
            assert set(value) == set(found)
            for key, column in value.items():
                np.testing.assert_array_equal(found[key], column)
        elif isinstance(value, np.ndarray):
            np.testing.assert_array_equal(found, value)
        elif isinstance(value, Shape) or hasattr(value, "__dict__"):
            check_same(value, found)
        elif not isinstance(value, tuple):
            assert found == value


def test_what_old_files_hold_is_read():
    record = ImpactRecord.read(DATA / "impact-2.h5")
    assert (record.rigid_check, record.final.t, record.bar.period) == ("rigid", 1e-4, 17e-6)
    assert record.measured.yarns[0].place.shape == (30, 3)
    assert record.backing.gone.tolist() == [False]
    pack = PackRecord.read(DATA / "pack-2.h5")
    assert (pack.z_rest.tolist(), pack.torn_contact.tolist()) == ([0.0, 4e-4], [3.0, 1.0])
    assert pack.cuts[0].t == 1e-5


@pytest.mark.parametrize("name", ["summary-1.json", "summary-pack-1.json"])
def test_an_old_summary_is_read_with_a_warning(name, capsys):
    found = json_file.read_summary(DATA / name)
    assert "has old names of keys" in capsys.readouterr().err
    table = (*keys.SHARED, *keys.IMPACT)
    assert [key for key in leaves(found, table) if find(key, table) is None] == []
    old = json.loads((DATA / name).read_text())
    assert found["absorbed_energy_J"] == old["absorbed"]
    assert found["energies_at_end_J"]["yarn_strain"] == old["energies_at_end"]["stored"]


def test_another_format_is_refused(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.attrs["format"] = "weavecell impact 1"
    with pytest.raises(InputError, match="format = 'weavecell impact 1': must be 'weavecell impact 3'"):
        ImpactRecord.read(tmp_path / "a.h5")
    (tmp_path / "s.json").write_text('{"format": "weavecell summary 9"}')
    with pytest.raises(InputError, match="format = 'weavecell summary 9': must be 'weavecell summary 2'"):
        json_file.read_summary(tmp_path / "s.json")


def test_every_new_name_is_documented():
    summary = (*keys.SHARED, *keys.IMPACT, *keys.COUPON)
    tables = {key.name.partition(".")[0] for key in summary}
    assert [new for new in renamed_keys.SUMMARY_KEYS.values() if find(new, summary) is None and new not in tables] == []
    datasets = (*keys.DATASETS, *keys.COUPON_DATASETS)
    groups = {"/".join(key.name.split("/")[:n]) for key in datasets for n in (1, 2)}
    names = {key.name for key in datasets}
    for new in renamed_keys.HDF5_KEYS.values():
        known = new in names | groups or any(fnmatchcase(name, new) for name in names)
        assert known, new
