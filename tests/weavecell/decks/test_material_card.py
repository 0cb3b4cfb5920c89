"""Laws of other codes against the cell: where they must agree with it, and that their fits are the best ones."""

import numpy as np
import pytest
from scipy.optimize import brentq

from fabrics import assumed, catalogue
from fabrics.base.errors import InputError
from shellfabric.cell.model import CellModel
from weavecell.decks.homogenised import HomogenisedFabric
from weavecell.decks.laws import FLEX, CrimpExchange, UncoupledCurves
from weavecell.decks.mismatch import Mismatch


def homogenised(name="S-720", **options):
    return HomogenisedFabric(CellModel(assumed.with_shear(catalogue.load(name)), **options))


def test_law58_is_in_equilibrium():
    """Against a root finder on the forces of two zigzags, written out once more, at single stretches."""
    law = CrimpExchange.fit(homogenised("S-728"), "uniaxial")
    rest = np.sqrt((1 + law.crimp) ** 2 - 1)
    bend = FLEX * law.E * rest / (1 + law.crimp)

    def pull(n, stretch, y):
        slant = np.hypot(stretch, rest[n] + y)
        return law.E[n] * (slant - 1 - law.crimp[n]) * np.array([stretch, rest[n] + y]) / slant

    for L1, L2 in ((1.01, 1.0), (1.02, 1.03), (1.0, 1.02)):

        def imbalance(y, L1=L1, L2=L2):
            return pull(0, L1, y)[1] - pull(1, L2, -y)[1] + bend.sum() * y

        y = brentq(imbalance, -rest[0], rest[1], xtol=1e-15)
        wanted = pull(0, L1, y)[0], pull(1, L2, -y)[0]
        assert law.stress(L1, L2) == pytest.approx(wanted, rel=1e-6)


def test_curves_of_uniaxial_tension_are_the_yarns_alone():
    fabric = homogenised("S-745")
    found = Mismatch.measure(fabric, UncoupledCurves.fit(fabric, "uniaxial"))
    assert found.uniaxial < 1e-12
    assert found.shear < 5e-3
    assert found.largest > 0.3  # crimp exchange, which they do not have


@pytest.mark.parametrize("name", catalogue.list_names())
def test_a_fit_over_the_plane_is_nearer_to_it(name):
    fabric = homogenised(name)
    for kind in (UncoupledCurves, CrimpExchange):
        plane, tension = (
            Mismatch.measure(fabric, kind.fit(fabric, match)) for match in ("plane", "uniaxial")
        )
        assert plane.rms < tension.rms


def test_curves_are_no_steeper_than_the_yarns():
    """A time step follows from the steepest slope."""
    fabric = homogenised("S-731")
    for match in ("plane", "uniaxial"):
        law = UncoupledCurves.fit(fabric, match)
        for curve, modulus in zip(law.curves, fabric.modulus):
            slope = np.diff(curve[:, 1]) / np.diff(curve[:, 0])
            assert np.all(slope >= 0)
            assert slope.max() < 1.05 * modulus
            assert slope[-1] == pytest.approx(modulus)
            assert curve[0] == pytest.approx([0, 0])


def test_what_has_no_card_is_refused():
    with pytest.raises(InputError, match="no \\[shear\\]"):
        HomogenisedFabric(CellModel(catalogue.load("glass-balanced")))


def test_stress_times_thickness_is_the_force_of_the_yarns_of_a_metre():
    """Warp and weft of S-726, whose counts are unlike: moduli, strengths and the stress of a stretched cell."""
    fabric = homogenised("S-726")
    weave = fabric.model.fabric.weave
    force = fabric.model.solve(1.01, 1.02)
    stress = fabric.stress(1.01, 1.02)
    for family, (yarn, across) in enumerate(zip(weave.yarns, weave.w[::-1])):
        yarns = 1 / (2 * across)  # a metre, of crossing cells two half spacings wide
        assert fabric.modulus[family] * fabric.thickness == pytest.approx(yarns * yarn.EA)
        assert fabric.strength[family] * fabric.thickness == pytest.approx(yarns * yarn.strength)
        wanted = yarns * force[f"N{family + 1}"]
        assert stress[family] * fabric.thickness == pytest.approx(wanted)
    assert weave.w[0] != pytest.approx(weave.w[1], rel=0.02)
