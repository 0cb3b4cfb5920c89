"""Each key of an input file sets its own field of the set-up, in SI units, and no other."""

import tomllib
from dataclasses import fields, is_dataclass
from operator import attrgetter
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.base import schema
from fabrics.base.errors import InputError
from fabrics.base.units import si
from fabrics.materials import IsotropicKeys
from shellfabric.cell.model import CellModel
from tests.scene_text import merged, table_of
from weavecell.scenes import build
from weavecell.scenes.coupon import CouponScene, PullOutTable
from weavecell.scenes.fabric_table import FabricTable, Reader
from weavecell.scenes.impact import Scene, check
from weavecell.studies import pull_out

ROOT = Path(__file__).parents[3]


def read(value):
    """A value of the tables: "" is None, and {root} is the folder of the repository."""
    if isinstance(value, dict):
        return {key: read(part) for key, part in value.items()}
    if isinstance(value, list):
        return [read(part) for part in value]
    if isinstance(value, str):
        return value.replace("{root}", str(ROOT)) or None
    return value


TABLES = read(tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8")))
SCENES = TABLES["scenes"]
SHOT = SCENES["shot"]
GRIP = {"clamp_force": "10 N"}
PULL = {"pull_in": "1 mm", "start": "1 us", "end": "40 us", "zone": "50 mm"}
OF_BACKING = schema.declared(IsotropicKeys)
# what the set-up of the solver does not hold: the checked scene does
OF_THE_RUN = {
    "title",
    "history.report_positions",
    "run.checkpoint_interval",
    "run.outputs",
}
ENTRIES = schema.entries(Scene)
# what a table needs to be one: a block without a material is refused
LEAST = {"backing": {"modulus": "100 MPa"}}


def row(key):
    """What else the scene says, the value, fields of the set-up with what they hold, beginnings of others."""
    table, _, name = key.rpartition(".")
    if table.startswith("panel.boundary") and name in TABLES["sides"]:
        side = TABLES["sides"][name]
        held = {"panel.boundary": (0, 1), "panel.boundary.warp": (0,), "panel.boundary.weft": (1,)}
        holds = {f"boundary.{k}.{name}": side["holds"] for k in held[table]}
        slips = GRIP if name == "clamp_force" else PULL
        return table_of(table, slips), side["value"], holds, ()
    if key in TABLES["rows"]:
        found = TABLES["rows"][key]
        scene = found.get("scene", {})
        if isinstance(scene, str):
            scene = SCENES[scene]
        return scene, found["value"], found.get("holds", {}), tuple(found.get("also", ()))
    value = TABLES["values"].get(key) or ENTRIES[key].examples[0]
    where = {
        "fabric": "",
        "panel": "",
        "run": "",
        "backing": "backing.material." if name in OF_BACKING else "backing.",
    }
    return {}, value, {where.get(table, f"{table}.") + name: in_si(key, value)}, ()


def in_si(key, value):
    """A value as it stands in a file, in SI units."""
    if isinstance(value, list):
        return tuple(in_si(key, part) for part in value)
    unit = schema.unit_of(ENTRIES[key])
    return value if unit is None else si(value, "" if unit == "1" else unit)


def fields_of(thing, name=""):
    """{path: value} of a set-up, through the objects and the tuples of objects that it holds."""
    if is_dataclass(thing):
        parts = {field.name: getattr(thing, field.name) for field in fields(thing) if field.compare}
    elif isinstance(thing, tuple) and any(map(is_dataclass, thing)):
        parts = dict(enumerate(thing))
    else:
        return {name: thing}
    found = {}
    for key, value in parts.items():
        found |= fields_of(value, f"{name}.{key}".lstrip("."))
    return found


def setup_of(table):
    """The fields of the set-up of `weavecell impact`."""
    return fields_of(build.setup(build.build(check(table, None, "shot"), None, "s"), None))


def with_value(table, key, value):
    """A scene with a value of a key; of [[panel.ply]] that of its first table."""
    name = key.removeprefix("panel.ply.")
    if name == key:
        return merged(table, table_of(key, value))
    first, *others = table["panel"]["ply"]
    return merged(table, {"panel": {"ply": [merged(first, table_of(name, value)), *others]}})


@pytest.mark.parametrize(
    "key", [key for key in ENTRIES if key not in OF_THE_RUN and not key.startswith("accuracy.")]
)
def test_a_key_sets_its_field_and_no_other(key, monkeypatch):
    """Fields that change are those named, and hold what is named; the unit of the value is that of the schema."""
    monkeypatch.chdir(ROOT)
    context, value, named, within = row(key)
    table = key.partition(".")[0]
    base = merged(merged(SHOT, {table: LEAST.get(table, {})}), context)
    plain = setup_of(base)
    made = setup_of(with_value(base, key, value))
    changed = {
        path: new
        for path, new in made.items()
        if path not in plain or not np.array_equal(plain[path], new)
    }
    assert changed
    assert {path: changed.get(path) for path in named} == {
        path: about(found) for path, found in named.items()
    }
    # the modelled part follows from the shot where none is asked for (`test_modelled_part`)
    others = [path for path in changed if path not in named and path != "symmetry"]
    assert [path for path in others if not path.startswith(within)] == []


def about(value):
    """A number within the rounding of an STL file, which is of single precision; all else exactly."""
    if isinstance(value, list):
        return tuple(map(tuple, value)) if value and isinstance(value[0], list) else tuple(value)
    return pytest.approx(value, rel=3e-7) if isinstance(value, float) else value


@pytest.mark.parametrize(
    "key", [key for key in ENTRIES if key in OF_THE_RUN or key.startswith("accuracy.")]
)
def test_a_key_that_the_run_reads_stands_in_the_scene(key):
    context, value, *_ = row(key)
    scene = with_value(merged(SHOT, context), key, value)
    assert attrgetter(key)(check(scene, None)) == in_si(key, value)


def test_marks_of_unread_keys_name_readers_alone():
    """A key whose mark names no reader would be read by all, in silence."""
    named = set()
    for model in (Scene, CouponScene):
        for table in schema.tables(model).values():
            for entry in table.model_fields.values():
                for mark in entry.metadata:
                    if isinstance(mark, schema.Unread):
                        named |= set(mark.by.split())
    assert named == set(get_args(Reader)) - {"shot"}


def test_a_reader_refuses_a_key_by_its_words_and_passes_over_what_means_nothing_to_it():
    """The same scene: a V50 draws strengths itself, a limit does not, and to neither [run] outputs mean a thing."""
    table = merged(
        SHOT,
        {
            "panel": {"strength": {"weibull_shape": 12.0}, "symmetry": "whole"},
            "run": {"outputs": ["report"], "end_time": "70 us"},
        },
    )
    assert check(table, None, "limit").run.end_time == pytest.approx(70e-6)
    with pytest.raises(InputError, match="must be left out: a V50 draws the strengths itself"):
        check(table, None, "v50")
    with pytest.raises(InputError, match=r"panel\.strength: must be left out: cards have one"):
        check(table, None, "export")


def test_what_is_set_is_found():
    """Tables without a key, and keys at their default, count as not set."""
    changes = {
        "panel": {"boundary": {"warp": [GRIP, "clamped"]}, "plies": 1},
        "history": {},
        "numerics": {},
    }
    found = set(schema.changed(check(merged(SHOT, changes), None)))
    assert {"panel.boundary.warp.clamp_force", "history"} <= found
    assert not {"panel.plies", "numerics", "fabric", "run.snapshot_interval"} & found


def test_keys_of_fabric_reach_the_cell_of_a_coupon():
    table = FabricTable.model_validate(
        {
            "cell_model": "incompressible",
            "crossover_gap": "0.01 mm",
        }
    )
    fabric = catalogue.load("S-720")
    cell = CellModel(fabric, fabric.laws, *build.cell_of(table))
    assert cell.cell_model == "incompressible"
    assert cell.cell_formulation == "variational"
    assert cell.crossover_gap == pytest.approx(1e-5)


def test_keys_of_a_pull_out_reach_its_model(monkeypatch):
    monkeypatch.setattr("shellfabric.coupon.pull_out.PullOut", lambda **values: values)
    monkeypatch.setattr(
        "shellfabric.coupon.pull_out.follow", lambda *values, samples: (*values, samples)
    )
    given = {
        "crossings": 10,
        "displacement": "5 mm",
        "pre_tension": "7 N",
        "crossover_friction": 0.3,
        "crossover_cohesion": "0.1 N",
        "samples": 100,
    }
    inputs = PullOutTable.model_validate(given)
    assert set(inputs.model_fields_set) == set(PullOutTable.model_fields)
    model, displacement, samples = pull_out.run("cell", inputs, bending=1e-6)
    assert model == {
        "table": "cell",
        "crossings": 10,
        "pre_tension": 7.0,
        "mu": 0.3,
        "cohesion": 0.1,
        "bending": (1e-6, 1e-6),
    }
    assert displacement == pytest.approx(5e-3)
    assert samples == 100


def test_every_row_is_of_a_key():
    assert set(TABLES["rows"]) <= set(ENTRIES)
