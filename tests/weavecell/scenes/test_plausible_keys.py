"""No number of an input file, of a backing, of a projectile by name or of a strain-rate law is wrong by a factor of a
hundred without a word."""

from contextlib import suppress
from dataclasses import replace

import pytest

import weavecell as wc
from fabrics import assumed, backings, catalogue, plausible, projectiles
from fabrics.base.errors import InputError
from fabrics.base.schema import unit_of
from tests.scene_text import merged, scale_quantity
from tests.weavecell.scenes.test_keys_reach import ENTRIES, LEAST, ROOT, SHOT, row, with_value
from weavecell.scenes import build, coupon
from weavecell.scenes.fabric_table import check_scene
from weavecell.scenes.impact import check

FACTORS = (100.0, 1000.0, 0.01, 0.001)
# keys whose number may be any: what is too coarse or too short shows itself in the run, which says so
FREE = {
    "run.snapshot_interval": "frequency of pictures",
    "run.checkpoint_interval": "frequency of checkpoints",
    "history.interval": "frequency of samples",
    "backing.after_stop": "time in which a block comes to rest, which is checked",
    "backing.reference_rate": "of clay from 1e-3 to 1e3 a second",
    "numerics.cfl": "a smaller step is a better one",
    "numerics.stretch_viscosity": "damping is booked, and checked",
    "numerics.threads": "chosen by the machine",
    "panel.aim_seed": "a seed",
    "panel.strength.seed": "a seed",
    "panel.boundary.start": "a time of a test",
    "panel.boundary.end": "a time of a test",
    "panel.boundary.warp.start": "a time of a test",
    "panel.boundary.warp.end": "a time of a test",
    "panel.boundary.weft.start": "a time of a test",
    "panel.boundary.weft.end": "a time of a test",
}
# smaller than any that is meant, and as good as 0, which means none
TO_NOTHING = {
    "projectile.friction",
    "projectile.obliquity",
    "projectile.azimuth",
    "projectile.yaw",
    "projectile.roll",
    "panel.weave_angle",
    "panel.ply.angle",
    "panel.impact_point",
    "panel.ply_gap",
    "panel.ply.gap",
    "panel.ply_friction",
    "panel.crossover_friction",
    "fabric.crossover_gap",
    "fabric.bending",
    "backing.standoff",
    "backing.hardening",
    "backing.rate_exponent",
    "numerics.contact_damping",
    "history.warp",
    "history.weft",
}


def numbers(value, factor):
    """A value with its numbers times a factor, whole ones rounded; None where it has none."""
    if isinstance(value, list):
        parts = [numbers(part, factor) for part in value]
        return None if None in parts else parts
    if isinstance(value, bool):
        return None
    if isinstance(value, int):
        return max(1, round(value * factor))
    if isinstance(value, float):
        return value * factor
    return scale_quantity(value, factor) if isinstance(value, str) else None


def is_numeric(key):
    _, value, *_ = row(key)
    of_numbers = unit_of(ENTRIES[key]) is not None or isinstance(value, (int, float))
    return of_numbers and numbers(value, 1.0) is not None


KEYS = [key for key in ENTRIES if key not in FREE and is_numeric(key)]


def said(scene):
    """The notes of a set-up; the refusal of one that is refused."""
    try:
        setup = build.setup(build.build(check(scene, None, "shot"), None, "s"), None)
        # what the run refuses before it begins
        size = wc.impact(setup, check=True)
        return setup.notes if size else ()
    except InputError as problem:
        return (str(problem),)


@pytest.mark.parametrize("key", KEYS)
def test_a_number_of_an_input_file_a_hundred_times_off_is_not_silent(key, monkeypatch):
    monkeypatch.chdir(ROOT)
    context, value, *_ = row(key)
    table = key.partition(".")[0]
    base = merged(merged(SHOT, {table: LEAST.get(table, {})}), context)
    right = said(with_value(base, key, value))
    silent = []
    for factor in FACTORS:
        wrong = numbers(value, factor)
        fewest = isinstance(value, int) and factor < 1
        if wrong == value or fewest or (factor < 1 and key in TO_NOTHING):
            continue
        if said(with_value(base, key, wrong)) == right:
            silent.append(wrong)
    assert silent == []


def test_free_keys_are_keys():
    assert set(FREE) | TO_NOTHING <= set(ENTRIES)


@pytest.mark.parametrize("name", projectiles.list_names())
def test_projectiles_as_they_are_are_plausible(name):
    notes = wc.setup("S-720", 100.0, projectile=name).notes
    assert not any("plausible" in note for note in notes)


@pytest.mark.parametrize("name", projectiles.list_names())
def test_a_number_of_a_projectile_ten_times_off_is_not_silent(name):
    _, data = projectiles.entry(name)
    silent = []
    for key in {"mass", "diameter", "length", "flat_width"} & data.keys():
        for factor in (10.0, 100.0, 0.1, 0.01):
            wrong = numbers(data[key]["value"], factor)
            try:
                setup = wc.setup("S-720", 100.0, projectile={"name": name, key: wrong})
            except InputError:
                continue
            if not any("projectile." in note for note in setup.notes):
                silent.append((key, factor))
    # a nearly pointed chisel
    assert set(silent) <= {("flat_width", 0.1), ("flat_width", 0.01)}


@pytest.mark.parametrize("name", backings.list_names())
def test_a_number_of_a_backing_a_hundred_times_off_is_not_silent(name):
    material = backings.load(name)
    silent = []
    for number in plausible.of_block(material):
        key = number.key.removeprefix("backing.")
        value = getattr(material, key)
        for factor in FACTORS:
            if not 0 < value < float("inf") or (
                factor < 1 and key in ("hardening", "rate_exponent")
            ):
                continue
            try:
                notes = plausible.judge(
                    plausible.of_block(replace(material, **{key: factor * value}))
                )
            except InputError:
                continue
            if not notes:
                silent.append((key, factor))
    assert silent == []


@pytest.mark.parametrize("key", ["strength", "modulus"])
@pytest.mark.parametrize("factor", [10.0, 100.0, 1000.0, 0.1, 0.01])
def test_a_ratio_of_a_strain_rate_law_ten_times_off_is_not_silent(key, factor):
    fabric = assumed.with_strain_rate(catalogue.load("S-720"))
    law = fabric.strain_rate
    wrong = tuple(factor * ratio for ratio in getattr(law, key))
    given = tuple(name for name in fabric.assumed if name != "strain_rate")
    with_law = replace(fabric, strain_rate=replace(law, **{key: wrong}), assumed=given)
    with suppress(InputError):
        assert plausible.judge(plausible.of_fabric(with_law))


COUPONS = {
    "bias_extension": {"length": "143.5 mm", "width": "74 mm", "elongation": "10 mm"},
    "uniaxial": {"direction": "warp", "length": "100 mm", "width": "30 mm", "strain": "5 %"},
    "biaxial": {"strain": ["2 %", "1 %"]},
    "picture_frame": {"shear_angle": "35 deg"},
    "pull_out": {
        "displacement": "5 mm",
        "pre_tension": "2 N",
        "crossover_friction": 0.2,
        "crossover_cohesion": "0.1 N",
    },
}


@pytest.mark.parametrize("test, key", [(test, key) for test in COUPONS for key in COUPONS[test]])
def test_a_number_of_a_coupon_a_hundred_times_off_is_not_silent(test, key):
    fabric = catalogue.load("S-726")

    def notes(table):
        scene = {"fabric": {"name": "S-726"}, test: table}
        try:
            made = check_scene(coupon.CouponScene, scene, None, "coupon")
            return plausible.judge(coupon.list_numbers(made, fabric))
        except InputError as problem:
            return str(problem)

    table = COUPONS[test]
    assert notes(table) == ()
    factors = (100.0, 1000.0)
    # a length smaller than meant is noted too; a load or angle may be as small as one likes
    if key in ("length", "width"):
        factors = FACTORS
    for factor in factors:
        wrong = numbers(table[key], factor)
        if wrong is not None:
            assert notes(table | {key: wrong})
