"""Numbers of cheap runs against those that are kept in tests/golden: of one ply, of a pack, of coupons.

The rest: `python tools/golden.py --check`. A wanted change is written by `python tools/golden.py`.
"""

import json
from dataclasses import replace

import numpy as np
import pytest

# ten seconds of one core in all
CHEAP = (
    "impact-S-720-stops",
    "impact-own-fabric",
    "start-S-728-pack",
    "coupon-S-720-frame",
    "coupon-S-720-warp",
    "coupon-S-726-pull-out",
)


@pytest.mark.parametrize(
    "name", [*CHEAP, pytest.param("impact-S-728-pack", marks=pytest.mark.slow(8))]
)
def test_numbers_are_those_that_are_kept(name, tool):
    off, _, _ = tool("golden").find_changes(name)
    assert off == []


def with_modulus(setup, share):
    """The set-up with the modulus of its weft alone times a number."""
    weave = setup.fabric.weave
    weft = replace(weave.weft, E=share * weave.weft.E)
    return replace(setup, fabric=replace(setup.fabric, weave=replace(weave, weft=weft)))


def with_shear(setup, share):
    """The set-up with the shear modulus of its trellis times a number."""
    shear = replace(setup.fabric.shear, G1=share * setup.fabric.shear.G1)
    return replace(setup, fabric=replace(setup.fabric, shear=shear))


@pytest.mark.parametrize("change", [with_modulus, with_shear])
def test_a_coefficient_changed_by_a_millionth_is_found_on_another_processor(change, tool):
    """By the tolerance of another processor than the one that wrote the file, of one ply; with the unchanged one
    `test_numbers_are_those_that_are_kept` finds nothing by no wider a tolerance."""
    golden = tool("golden")
    name = "impact-S-720-stops"
    kept = json.loads((golden.FOLDER / f"{name}.json").read_text())
    elsewhere = golden.tolerance(name, kept | {"machine": {"processor": "another"}})
    setup = golden.setup(golden.EXAMPLES / "S-720-stops.toml")
    computed = golden.numbers(golden.run_shot(change(setup, 1 + 1e-6)))
    assert not all(
        golden.same(key, value, computed[key], elsewhere) for key, value in kept["numbers"].items()
    )


def test_a_difference_is_measured_by_its_field_and_never_below_the_floor_of_its_unit(tool):
    golden = tool("golden")
    force = [3e-12, 250.0, 100.0, -390.0]
    assert golden.same("plies.push", force, [-5e-12, 250.0, 100.0, -390.0], 1e-9)
    assert not golden.same("plies.push", force, [3e-12, 250.0, 100.0, -390.0 - 3e-7], 1e-9)
    assert golden.same("final_velocity.1", 2e-15, -9e-13, 1e-9)
    assert not golden.same("final_velocity.1", 2e-15, 2e-12, 1e-9)
    assert golden.same("peaks.1", [np.nan, np.nan], [np.nan, np.nan], 1e-9)
    assert not golden.same("peaks.1", [np.nan, np.nan], [3e-5, 3e-5], 1e-9)
    assert not golden.same("steps", 456.0, 457.0, 1e-9)


def test_every_number_needs_a_unit(tool):
    with pytest.raises(KeyError, match="unlisted: its unit is missing"):
        tool("golden").floor("plies.unlisted")


def test_files_kept_on_this_machine_are_held_to_the_last_digits(tool):
    golden = tool("golden")
    here = {"machine": golden.machine()}
    there = {"machine": golden.machine() | {"blas": "another"}}
    assert golden.tolerance("impact-S-720-stops", here) == 1e-11
    assert golden.tolerance("impact-S-720-stops", there) == 1e-9
    assert golden.tolerance("impact-S-728-pack", there) == 1e-4


def test_columns_of_unlike_units_are_compared_each_by_itself(tool):
    golden = tool("golden")
    record = np.outer(np.arange(1.0, 13.0), [1e-6, 4e3])
    kept = golden.numbers({"step_history": record})
    assert kept["step_history.0"][:2] == pytest.approx([6.5e-6, np.sqrt(650 / 12) * 1e-6])
    assert kept["step_history.1"][2:] == pytest.approx([4e3, 44e3])
