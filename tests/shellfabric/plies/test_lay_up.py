"""Lay-ups: what hybrid packs know of their plies, their gaps, their mesh."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric.cell import table_cache
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.gap import gap_between

SETUP = ImpactSetup(
    catalogue.load("S-728"),
    260.0,
    opening=0.04,
    end_time=20e-6,
    table_size=61,
    plies=3,
    numerics=Numerics(threads=1),
)


def laid(*plies, setup=SETUP):
    """The set-up with a lay-up."""
    return replace(
        setup, fabric=plies[0].fabric, laws=plies[0].laws, plies=len(plies), lay_up=plies
    )


def test_a_hybrid_pack_keeps_its_energy_and_knows_its_plies():
    """Plies of other crossovers and counts: the same energy balance, each with its own strength; the order matters."""
    one = Ply(SETUP.fabric)
    other = Ply(catalogue.load("S-726"), angle=pi / 2)
    results = [run_impact(laid(*plies)) for plies in ((one, one, other), (other, one, one))]
    for result in results:
        assert result.energy_error_max < 2e-3
        assert result.cut_yarns[-1] > 0
        assert result.plies["peak_warp"][-1].tolist() == result.peaks[:, 0, 0].tolist()
        assert np.all(np.diff(result.plies["peak_weft"], axis=0) >= 0)
    first, second = results
    assert first.setup.title == "2 x S-728 + 1 x S-726 at 90 deg"
    assert [panel.fabric.name.split(",")[0] for panel in first.panels] == [
        "S-728",
        "S-728",
        "S-726",
    ]
    weft, warp = (yarn.strength for yarn in first.panels[2].weave.yarns)
    assert (warp, weft) == tuple(yarn.strength for yarn in other.fabric.weave.yarns)
    assert abs(first.velocity - second.velocity).max() > 0.1
    law = first.target.laws
    assert law[0].stiffness != law[1].stiffness


def test_gaps_are_those_of_the_plies_or_the_mean():
    one = Ply(SETUP.fabric, gap=1e-4)
    other = Ply(catalogue.load("S-726"))
    both = [laid(each, each).target().gaps[0] for each in (replace(one, gap=None), other)]
    assert laid(one, other, other).target().gaps == (1e-4, both[1])
    assert laid(other, one).target().gaps[0] == pytest.approx(np.mean(both), rel=1e-12)


def test_the_mesh_is_fine_as_far_as_any_ply_needs():
    """One grading for all: as many crossovers as the fabric with the shortest ones needs."""
    setups = [
        laid(*[Ply(catalogue.load(name))] * 2, setup=replace(SETUP, opening=0.2))
        for name in ("S-745", "S-726")
    ]
    alone = [setup.meshed.grading[0] for setup in setups]
    mixed = laid(setups[0].lay_up[0], setups[1].lay_up[0], setup=setups[0])
    assert mixed.meshed.grading[0] == (max(far for far, _ in alone), min(side for _, side in alone))


def test_the_default_mesh_reaches_as_far_as_turned_plies_need():
    """In a long opening a turned ply of S-731 draws in more fabric along the long side than the first."""
    fabric = catalogue.load("S-731")
    setup = replace(SETUP, fabric=fabric, opening=(0.1, 0.2))
    straight = replace(setup, plies=2)
    turned = replace(setup, plies=2, stacking="alternating")
    assert turned.meshed.grading[0][0] > straight.meshed.grading[0][0]
    assert turned.target().plies[1].sides is not None
    assert (
        laid(Ply(fabric), Ply(fabric, angle=pi / 2), setup=setup).meshed.grading
        == turned.meshed.grading
    )


def test_a_pack_of_a_fabric_without_a_law_takes_the_law_of_the_shot():
    """The mesh is chosen without a law of the fabric's own, as an own fabric has none."""
    laws = SETUP.fabric.laws
    own = replace(SETUP, fabric=replace(SETUP.fabric, laws=None), laws=laws)
    assert replace(own, plies=3).meshed == replace(
        own, plies=3, grading=replace(SETUP, plies=3).meshed.grading
    )
    assert laid(Ply(own.fabric, laws=laws), Ply(SETUP.fabric), setup=own).meshed.grading is not None


def test_a_lay_up_is_reported_as_a_whole():
    """Name, areal density, fabrics and gap are those of all plies, not of the first."""
    one = Ply(SETUP.fabric)
    other = Ply(catalogue.load("S-726"))
    mixed = laid(one, other, other)
    densities = [ply.fabric.weave.areal_density for ply in mixed.lay_up]
    assert mixed.areal_density == pytest.approx(sum(densities), rel=1e-12)
    assert densities[0] != densities[1]
    assert mixed.fabrics == (one.fabric, other.fabric)
    assert mixed.name == mixed.title == "1 x S-728 + 2 x S-726"
    plain = replace(SETUP, plies=4)
    assert plain.name == "S-728"
    assert plain.title == "4 x S-728"
    assert plain.areal_density == pytest.approx(4 * densities[0], rel=1e-12)
    both = gap_between(one.fabric, other.fabric)
    assert both.low <= both.value == mixed.target().gaps[0] <= both.high


def test_tables_of_a_lay_up_are_not_put_into_the_cache_of_the_user(monkeypatch, tmp_path):
    """A draw changes modulus and crimp: its tables serve it alone."""
    monkeypatch.setenv("WEAVECELL_CACHE_DIR", str(tmp_path))
    laid(Ply(SETUP.fabric), Ply(catalogue.load("S-726"))).target()
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []
    monkeypatch.setattr(table_cache, "_IN_MEMORY", {})
    SETUP.table(kept=True)
    assert [path for path in tmp_path.rglob("*") if path.is_file()] != []
