"""Biaxial curves of the two glass weaves: symmetry, order of the ratios, free edge, and the command."""

import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from shellfabric.cell.model import CellModel
from weavecell.analysis.biaxial_test.curves import at_ratio, curves, free_edge

BALANCED = CellModel(catalogue.load("glass-balanced"), form="equilibrium")
UNBALANCED = CellModel(catalogue.load("glass-unbalanced"), form="equilibrium")


def load_at(curve, strain, index=0):
    return np.interp(strain, curve.strain[:, index], curve.tension[:, index])


def test_balanced_weave_is_symmetric():
    slow, fast = at_ratio(BALANCED, 0.5), at_ratio(BALANCED, 2.0)
    assert np.allclose(slow.tension[:, 0], fast.tension[:, 1], rtol=1e-10, atol=1e-9)
    equal = at_ratio(BALANCED, 1.0)
    assert np.allclose(equal.tension[:, 0], equal.tension[:, 1], rtol=1e-10)


@pytest.mark.parametrize("model", [BALANCED, UNBALANCED], ids=["balanced", "unbalanced"])
def test_more_cross_stretch_means_more_load(model):
    """Claim biaxial-order-k, at every strain that all curves reach under load."""
    tests = [at_ratio(model, k) for k in (0.5, 1.0, 2.0)] + [free_edge(model, "warp")]
    reach = min(curve.strain[-1, 0] for curve in tests)
    for strain in np.linspace(0.1, 1, 10) * reach:
        loads = [load_at(curve, strain) for curve in tests]
        assert all(more > less for more, less in pairwise(loads) if more > 0), (strain, loads)


def test_free_edge_is_shifted_by_the_crimp():
    """Claim biaxial-balanced-free: 0.40 % beyond the single yarn, at every load."""
    curve, yarn = free_edge(BALANCED, "warp"), BALANCED.fabric.weave.warp
    loaded = curve.tension[:, 0] > 1
    shift = curve.strain[loaded, 0] - curve.tension[loaded, 0] / yarn.EA
    assert shift == pytest.approx(0.0040, abs=0.0005)


def test_every_curve_ends_at_a_strength():
    for model in (BALANCED, UNBALANCED):
        strengths = {name: yarn.strength for name, yarn in zip(("warp", "weft"), model.fabric.weave.yarns)}
        for curve in curves(model.fabric):
            end = curve.tension[-1][("warp", "weft").index(curve.failed)]
            assert end == pytest.approx(strengths[curve.failed], rel=1e-5)


def test_unbalanced_constants_are_extreme():
    """Claim biaxial-unbalanced-large-a: 2 a is 0.86 of the sum of the heights."""
    assert 2 * UNBALANCED.fabric.laws[0].a / sum(UNBALANCED.fabric.weave.h0) == pytest.approx(0.86, abs=0.02)


def test_a_ratio_is_positive():
    with pytest.raises(InputError, match="a positive ratio"):
        at_ratio(BALANCED, 0.0)


def test_the_command_writes_table_and_picture(tmp_path):
    command = [sys.executable, "-m", "validation.published.biaxial_glass", "--out", str(tmp_path), "glass-balanced"]
    subprocess.run(command, check=True, capture_output=True)
    lines = (tmp_path / "glass-balanced.csv").read_text().splitlines()
    assert lines[0].startswith("test,warp strain")
    assert len(lines) == 1 + 5 * 241
    assert (tmp_path / "glass-balanced.png").stat().st_size > 20_000
