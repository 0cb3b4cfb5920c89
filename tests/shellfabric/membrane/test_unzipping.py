"""The check of pinned yarns that unzip: what crossings carry, and shots that do and that do not."""

from dataclasses import replace
from types import SimpleNamespace as Given

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.compression import CompressionLaw
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop.checkpoint import Checkpoints
from shellfabric.membrane import quality
from shellfabric.membrane.indicator import OK
from shellfabric.membrane.slots import by_node
from shellfabric.membrane.unzipping import contact_force, slipping_crossings
from shellfabric.projectile.projectile import Projectile

TWARON = """
name = "ct716"
thickness = "0.40 mm"
areal_density = "280 g/m^2"
"""
YARN = """
[{}]
linear_density = "1100 dtex"
fibre_density = "1.44 g/cm^3"
modulus = "91 GPa"
tenacity = "235 cN/tex"
failure_strain = "3.5 %"
count = "12.2 / cm"
"""


def check(shot):
    return {one.name: one for one in shot.checks}.get("unzipping")


@pytest.fixture(scope="module")
def flat(tmp_path_factory):
    """One ply of Twaron CT 716 in 70 mm under a flat nose, which unzips: from its sheet and a calibrated law."""
    path = tmp_path_factory.mktemp("ct716") / "ct716.toml"
    path.write_text(TWARON + YARN.format("warp") + YARN.format("weft"))
    law = CompressionLaw(a=24.157e-6, b=24.845e-6, form="regularised")
    nose = Projectile(mass=15e-3, radius=6.3e-3, edge_radius=0.2e-3)
    return ImpactSetup(
        catalogue.load(path),
        64.0,
        laws=(law, law),
        projectile=nose,
        opening=0.07,
        end_time=400e-6,
    )


def test_a_ply_that_unzips_says_so(flat, tmp_path):
    shot = run_impact(flat, hooks=[Checkpoints(tmp_path / "run.h5", 80e-6)])
    assert shot.outcome == "perforated"
    found = check(shot)
    assert found.doubtful
    assert found.value == pytest.approx(float(shot.cut_yarns[-1]) / 30.7, rel=0.01)
    assert "cut over struck yarns 2." in found.text
    assert 'compare with crossovers = "yarns"' in str(found)
    again = run_impact(flat, resume=tmp_path / "run.h5")
    assert check(again) == found


def test_shots_that_cut_what_lies_under_the_nose_do_not_speak():
    """Just above the limit and twice as fast; no indicator where no yarn is cut."""
    base = ImpactSetup(catalogue.load("S-720"), 155.0, opening=0.1, end_time=300e-6)
    for velocity in (155.0, 300.0):
        shot = run_impact(replace(base, strike_velocity=velocity))
        assert shot.cut_yarns[-1] > 8
        assert check(shot).status == OK
    assert check(run_impact(replace(base, strike_velocity=60.0, end_time=40e-6))) is None


def test_a_node_hands_over_half_of_the_difference_of_the_pulls():
    """A flat patch at the stretches of the table; one warp edge with a tension of its own beside the cell's."""
    setup = ImpactSetup(
        catalogue.load("S-726"), 10.0, opening=0.02, symmetry="whole", elements_per_crossover=1
    )
    panel = setup.panel()
    const = panel.constants()
    state = panel.state(10.0)
    strain = 0.01
    X, Y = panel.coordinates()
    by_node(state.u[0], const)[:] = strain * X
    by_node(state.u[1], const)[:] = strain * Y
    tensions = [0.3 * yarn.strength for yarn in panel.weave.yarns]
    for T, tension in zip(state.T, tensions):
        by_node(T, const)[:] = tension
    slip, loaded = slipping_crossings(panel, const, state)
    assert (slip, loaded) == (0, (const.ni - 1) * (const.nj - 1))
    stretch = np.array([1.01])
    force = float(contact_force(panel.table, stretch, stretch)[0])
    assert force > 0
    middle = const.ni // 2, const.nj // 2
    for jump, slips in ((1.5, 0), (2.5, 1)):  # friction holds 0.2 F, half of the jump 2 x 0.2 F
        T = by_node(state.T[0], const)
        T[:] = tensions[0]
        T[: middle[0], middle[1]] += jump * 0.2 * force
        # the other end of this yarn is at the rim
        assert slipping_crossings(panel, const, state)[0] == slips, jump
    by_node(state.intact_fraction[0], const)[middle] = 0.0
    assert slipping_crossings(panel, const, state)[1] == loaded - 2


@pytest.mark.parametrize("speaks", [0, 1, 2])
def test_each_ply_of_a_pack_is_judged_by_what_lies_under_its_own_nose(monkeypatch, speaks):
    """Its cut yarns over those under the nose there, if it would slip."""
    under = {"a": 4.0, "b": 10.0, "c": 7.0}
    monkeypatch.setattr(quality.unzipping, "yarns_under_the_nose", under.__getitem__)
    slipping = np.zeros(3)
    slipping[speaks] = 0.9
    solver = Given(
        replaces_membrane=False,
        panel=Given(friction_between_yarns=0.2),
        pack=Given(plies=("a", "b", "c")),
        monitor=Given(slipping=slipping),
        ply_sample=lambda name: np.array([[0.0, 0.0, 0.0], [20.0, 22.0, 33.0]]),
    )
    energies = {
        "kinetic_projectile": np.array([9.0, 7.0, 1.0]),
        "viscous": np.array([0.0, 0.1, 5.0]),
    }
    (found,) = quality._unzipping(solver, np.array([0.0, 0.0, 75.0]), energies)
    assert found.value == pytest.approx([20 / 4, 22 / 10, 33 / 7][speaks])
    assert "cut over struck yarns 5.0" in found.meaning
