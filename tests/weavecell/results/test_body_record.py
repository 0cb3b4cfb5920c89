"""What a run with an elastic projectile and a block leaves: HDF5, pictures, and whether rigid would be enough."""

from dataclasses import fields

import numpy as np
import pytest

from shellfabric.backing.coupling import result_of
from shellfabric.projectile.dynamics import BarHistory
from weavecell.report import pictures, pictures_body
from weavecell.results import impact_groups, keys


@pytest.fixture
def bar():
    t = np.linspace(0, 100e-6, 201)
    tip, tail = 100 + np.sin(2 * np.pi * t / 17e-6), 100 - np.sin(2 * np.pi * t / 17e-6)
    return BarHistory(t, 100 * t, 100 * t, 100 * t, tip, tail, 0 * t + 100, 17e-6, 1e-6)


@pytest.fixture
def block():
    from shellfabric.backing.block import Backing

    made = Backing(size=(0.02, 0.02, 0.02), min_size=2e-3, refined_depth=4e-3, growth=1.5).block(1e-8)
    made.x[made.nodes[:2, :2, 0], 2] += 1e-3
    return result_of(made)


def test_both_survive_the_file(bar, block, tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        impact_groups.write_group(file.create_group("bar"), bar, keys.BAR, ("period", "shortening"))
        impact_groups.write_group(file.create_group("backing"), block, keys.BACKING, ("face",))
        assert file["bar/tip_velocity"].attrs["unit"] == "m/s"
        for kept, given in (
            (impact_groups.read_group(file, "bar"), bar),
            (impact_groups.read_group(file, "backing"), block),
        ):
            for entry in fields(given):
                np.testing.assert_array_equal(getattr(kept, entry.name), getattr(given, entry.name))
        del file["bar"]
        assert impact_groups.read_group(file, "bar") is None


def test_the_period_of_a_swing_is_found(bar):
    assert bar.swing == pytest.approx(17e-6, rel=0.01)
    assert np.isnan(BarHistory(*(v[:50] for v in list(vars(bar).values())[:7]), 17e-6, 0.0).swing)


def test_pictures_are_drawn(bar, block):
    assert block.depth == pytest.approx(1e-3)
    assert pictures.render(pictures_body.bar, bar, kind="png").startswith(b"\x89PNG")
    assert pictures.render(pictures_body.depth_map, block, kind="png").startswith(b"\x89PNG")
    assert pictures.render(pictures_body.crater, {"a": block, "b": block}, kind="png").startswith(b"\x89PNG")


def test_every_energy_of_a_march_has_a_place_in_the_picture():
    from shellfabric.solver.pack_solver import ENERGIES

    assert set(ENERGIES) - {"formulation_residual"} == {name for name, _, _ in pictures.ENERGIES}
