"""Result files hold documented keys only; a file of another format is refused."""

from fnmatch import fnmatchcase
from pathlib import Path

import h5py
import pytest
import tomlkit

from fabrics.errors import InputError
from weavecell.cli import app
from weavecell.results import json_file, keys
from weavecell.results.impact import ImpactRecord

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
    (folder / "scene.toml").write_text(tomlkit.dumps(scene))
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
    from shellfabric.solver.pack_solver import BETWEEN_PLIES, ENERGIES, SLIP_WORK

    assert [
        name for name in (*ENERGIES, *BETWEEN_PLIES, *SLIP_WORK, "error") if find(name, keys.ENERGIES) is None
    ] == []


def test_keys_follow_the_convention():
    """A quantity with a unit has it at the end of its key in summary.json."""
    units = {"m/s": "m_s", "kg": "kg", "s": "s", "m": "m", "N": "N", "J": "J", "rad": "rad"}
    for key in (*keys.SHARED, *keys.IMPACT):
        if key.unit in units and not key.name.endswith(".*"):
            assert key.name.endswith((f"_{units[key.unit]}", "_ns")), key.name


def test_another_format_is_refused(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.attrs["format"] = "weavecell impact 1"
    with pytest.raises(InputError, match="format = 'weavecell impact 1': must be 'weavecell impact 7'"):
        ImpactRecord.read(tmp_path / "a.h5")
    (tmp_path / "s.json").write_text('{"format": "weavecell summary 9"}')
    with pytest.raises(InputError, match="format = 'weavecell summary 9': must be 'weavecell summary 2'"):
        json_file.read_summary(tmp_path / "s.json")
