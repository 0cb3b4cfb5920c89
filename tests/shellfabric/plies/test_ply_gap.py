"""The gap between plies at rest that a pack has where none is given, with its range and source."""

from dataclasses import replace

import pytest

from fabrics import catalogue
from shellfabric.plies.gap import compression_gap, ply_gap

KEVLAR = [name for name in catalogue.list_names() if name.startswith("S-")]


@pytest.mark.parametrize(
    "name, printed", [("S-726", 0.10e-3), ("S-728", 0.12e-3), ("S-731", 0.14e-3)]
)
def test_a_gap_of_the_file(name, printed):
    """Table 5-2, which the reading of Table 2-2 by erratum E-02 gives within 7 %. It was fitted to what platens close,
    so plies may touch; a measured one has no range."""
    fabric = catalogue.load(name)
    gap = ply_gap(fabric)
    assert gap.low == 0.0
    assert gap.value == gap.high == pytest.approx(printed, rel=1e-12)
    entry = fabric.sources["interlayer_gap"] | {"status": "measured"}
    measured = ply_gap(replace(fabric, sources=fabric.sources | {"interlayer_gap": entry}))
    assert measured.low == measured.value == measured.high == gap.value
    assert "Table 5-2" in gap.source
    assert compression_gap(fabric.areal_density_measured) == pytest.approx(printed, rel=0.07)


def test_the_pressure_law_goes_before_the_thickness():
    fabric = catalogue.load("S-720")
    gap = ply_gap(fabric)
    assert (
        gap.value
        == compression_gap(fabric.areal_density_measured)
        == pytest.approx(0.134e-3, rel=0.01)
    )
    assert 0.0 == gap.low < gap.value < gap.high


@pytest.mark.parametrize("areal_density", [None, 0.148, 0.1])
def test_light_and_other_fabrics_have_a_share_of_their_thickness(areal_density):
    """K'' of eq. 2-6 vanishes at 148 g/m2: below, the pressure law has no gap."""
    fabric = replace(catalogue.load("S-720"), areal_density_measured=areal_density)
    gap = ply_gap(fabric)
    assert gap.value == pytest.approx(0.33 * fabric.weave.thickness)
    assert gap.low < gap.value < gap.high
    assert "of the thickness 0.432 mm" in gap.source
    own = ply_gap(replace(fabric, thickness=0.5e-3))
    assert own.value == pytest.approx(0.165e-3)


def test_the_share_is_that_of_the_pressure_law():
    """Mean share of six fabrics; low, plies touch; high, the law with a start load of 1 N in place of 10 N."""
    shares = []
    for fabric in map(catalogue.load, KEVLAR):
        shares.append(compression_gap(fabric.areal_density_measured) / fabric.weave.thickness)
    gap = ply_gap(replace(catalogue.load("S-720"), areal_density_measured=None))
    thickness = catalogue.load("S-720").weave.thickness
    assert gap.value / thickness == pytest.approx(sum(shares) / len(shares), abs=0.006)
    assert gap.low == 0.0
    assert (min(shares), max(shares)) == pytest.approx((0.26, 0.39), abs=0.006)
    pressures = [load / 0.019**2 for load in (1.0, 10.0, 7000.0)]
    one, ten, peak = (p ** (-1 / 3) for p in pressures)
    assert gap.high / gap.value == pytest.approx((one - peak) / (ten - peak), rel=0.01)
