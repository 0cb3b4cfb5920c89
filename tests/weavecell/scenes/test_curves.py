"""Readers of material tests: a coupon that the code computes with a known law gives that law back, within 2 %."""

from dataclasses import astuple, replace

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.trellis import TrellisShear
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from tests.shellfabric.coupon.test_quasistatic import load_of_zones
from unitcell3d.identify import shear_fit
from validation.models.variants import with_straight_yarns
from weavecell.scenes import curves


@pytest.fixture
def write(tmp_path):
    def make(heading, *columns):
        rows = [", ".join(f"{value:.10g}" for value in row) for row in zip(*columns)]
        path = tmp_path / "curve.csv"
        path.write_text("\n".join([heading, *rows]) + "\n")
        return path

    return make


def table(**law):
    """Straight yarns, thin: their shear stiffness is that of the fabric at its own thickness."""
    fabric = with_straight_yarns(catalogue.load("S-728").with_effective_density())
    fabric = replace(fabric, shear=TrellisShear(**law))
    return CellModel(fabric, cell_model="decoupled", cell_formulation="variational").table(61)


@pytest.fixture(scope="module")
def framed():
    known = {"G1": 2e7, "G2": 5e8, "gamma1": 0.4, "gamma2": 0.8}
    return quasistatic.picture_frame(table(**known), crossovers=2, shear_angle=1.1, steps=55)


def comes_back(found, fabric):
    return astuple(found.law) == pytest.approx(astuple(fabric.shear), rel=0.02)


def test_a_picture_frame_by_its_stress(framed, write):
    stress = quasistatic.frame_stress(framed)
    path = write("shear angle [rad], shear stress [Pa]", framed.prescribed, stress)
    fabric = framed.coupon.table.model.fabric
    assert comes_back(curves.picture_frame(path, fabric.weave.thickness), fabric)


def test_a_picture_frame_by_its_force(framed, write):
    """The force of the crosshead is the stored energy over the way of two opposite corners."""
    rest = framed.coupon.points
    fabric = framed.coupon.table.model.fabric
    corners = [int(np.argmin(rest.sum(axis=1))), int(np.argmax(rest.sum(axis=1)))]
    ends = np.array([rest[corners], *(state.x[corners] for state in framed.states)])
    opened = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    energy = np.array([0.0, *(sum(state.energies) for state in framed.states)])
    angles = np.concatenate([[0.0], framed.prescribed])
    middle = 0.5 * (angles[1:] + angles[:-1])
    path = write("shear angle [rad], force [N]", middle, np.diff(energy) / np.diff(opened))
    side = float(np.ptp(rest[:, 0]))
    assert comes_back(curves.picture_frame(path, fabric.weave.thickness, side), fabric)


def test_a_bias_strip_of_zones(write):
    """Yarns that do not stretch."""
    width = 0.10
    length = 0.25
    thickness = 0.7e-3
    law = TrellisShear(5e4, 5e5, 0.35, 0.80)
    moved = np.linspace(0.0, 0.05, 2001)
    force = load_of_zones(law, thickness, length, width, moved)
    path = write("displacement [m], force [N]", moved[50:-1:50], force[50:-1:50])
    found = curves.bias_extension(path, thickness, (width, length))
    assert astuple(found.law) == pytest.approx(astuple(law), rel=0.02)
    with pytest.raises(InputError, match="the length at least twice the width"):
        curves.bias_extension(path, thickness, (0.2, 0.25))


@pytest.mark.nightly
@pytest.mark.slow(90)
def test_a_bias_strip_of_the_coupon(write):
    """Two elements a crossover, 19 diagonals wide; its sides are staircases, and its width the mean between them.

    With one element a crossover zones are 9 diagonals wide, and G2 is 6 % off.
    """
    known = {"G1": 2e7, "G2": 6e7, "gamma1": 0.25, "gamma2": 0.5}
    run = quasistatic.bias_extension(
        table(**known),
        length=0.06,
        width=0.02,
        elongation=0.0105,
        steps=21,
        elements_per_crossover=2,
    )
    length, width = quasistatic.bias_size(run)
    width -= np.linalg.norm(run.coupon.spacing) / 2
    path = write("displacement [m], force [N]", run.prescribed, abs(run.force(1, 1)))
    fabric = run.coupon.table.model.fabric
    found = curves.bias_extension(path, fabric.weave.thickness, (width, length))
    assert comes_back(found, fabric)


def test_a_yarn(write):
    """A crimped yarn with a toe, alone: E A and the strain of its strength, which the crimp puts off."""
    fabric = catalogue.load("S-728")
    yarn = fabric.weave.warp
    stretch = np.linspace(1.0, (1 + yarn.crimp) * (1 + yarn.failure_strain), 80)
    taut = np.maximum(stretch / (1 + yarn.crimp) - 1, 0)
    force = yarn.EA * (taut + 5e-4 * np.expm1(-taut / 5e-4))
    found = curves.yarn_tension(write("strain [%], force [N]", 100 * (stretch - 1), force))
    assert found.EA == pytest.approx(yarn.EA, rel=0.02)
    assert found.failure_strain == pytest.approx(yarn.failure_strain, rel=0.02)
    assert found.slack == pytest.approx(yarn.crimp, abs=1e-3)


def test_a_curve_that_begins_with_friction_or_does_not_stiffen():
    gamma = np.linspace(0.006, 0.96, 30)
    stiffening = TrellisShear(2e4, 9e4, 0.5, 0.8)
    found = shear_fit.fit(gamma, 3e3 + stiffening.stress(gamma), any_curve=True)
    assert (found.offset, *astuple(found.law)) == pytest.approx((3e3, *astuple(stiffening)), 0.02)
    scattered = stiffening.stress(gamma) + 300 * np.cos(40 * gamma) + 60
    assert shear_fit.fit(gamma, scattered, any_curve=True).offset == 0
    straight = shear_fit.fit(gamma, 3e3 + 2e4 * gamma, any_curve=True)
    assert not straight.stiffens
    assert not straight.locked
    assert straight.law.stress(0.3) == pytest.approx(6e3, rel=1e-6)
    with pytest.raises(InputError, match="does not stiffen"):
        shear_fit.fit(gamma, 2e4 * gamma)
    with pytest.raises(InputError, match="does not rise"):
        shear_fit.fit(gamma, 0 * gamma + 1, any_curve=True)
