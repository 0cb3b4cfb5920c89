"""A yarn as a chain: Smith's solution of transverse impact, and failure by mean and delay."""

import numpy as np
import pytest
from yarn_patches import march, only_first_warp, patch

from fabrics import assumed, catalogue
from fabrics.yarn import striking_velocity
from shellfabric.yarns import chain_kernels
from shellfabric.yarns.coupling_kernels import stored_and_lost

STRAIN = 0.01


def struck_chain(way):
    """(zone, nodes, struck node, wave speed, time) of a straight yarn whose middle node moves across it until the wave
    has come as far as `way` of the half length."""
    made = patch((300, 1), viscosity=0.05)
    zone = made.arrays(0.5 * made.critical_step)
    nodes = only_first_warp(zone)
    yarn = made.weave.warp
    middle = nodes[nodes.size // 2]
    zone.inverse_mass[middle] = 0.0
    zone.v[2, middle] = striking_velocity(yarn.wave_speed, STRAIN)
    half = zone.x[0, nodes[-1]] - zone.x[0, middle]
    steps = int(way * half / (yarn.wave_speed * zone.dt))
    march(zone, steps)
    return zone, nodes, middle, yarn.wave_speed, steps * zone.dt


def test_a_struck_yarn_has_the_strain_and_the_kink_of_smith():
    """Strain behind the front, and the kink at c (sqrt(e (1 + e)) - e) (Smith, McCrackin and Schiefer 1958)."""
    zone, nodes, middle, c, time = struck_chain(0.8)
    place = zone.x[:, nodes]
    along = place[0] - place[0, middle]
    kink = c * (np.sqrt(STRAIN * (1 + STRAIN)) - STRAIN) * time
    behind = (along[:-1] > 1.5 * kink) & (along[:-1] < 0.8 * c * time)
    strain = zone.tension[nodes[:-1]][behind] / zone.stiffness[0]
    assert behind.sum() > 30
    assert strain.mean() == pytest.approx(STRAIN, rel=2e-3)
    # the yarn is a straight line from the struck node to the kink, level beyond
    height = place[2]
    near = (along > 0) & (along < 0.7 * kink)
    slope = np.polyfit(along[near], height[near], 1)[0]
    assert along[middle] - height[middle] / slope == pytest.approx(kink, rel=5e-3)


def test_a_chain_keeps_energy_and_momentum():
    zone, nodes, *_ = struck_chain(0.3)
    zone.inverse_mass[:] = 1 / zone.mass
    before = zone.v[:, nodes] @ zone.mass[nodes]
    energies = []

    def watch(zone):
        after = zone.v + zone.dt * zone.inverse_mass * zone.f
        kinetic = 0.5 * (zone.mass * zone.v * after)[:, nodes].sum()
        energies.append(kinetic + stored_and_lost(zone))

    march(zone, 400, watch)
    after = zone.v[:, nodes] @ zone.mass[nodes]
    scale = (zone.mass * abs(zone.v))[:, nodes].sum()
    assert abs(after - before).max() < 1e-12 * scale
    assert np.ptp(energies) < 2e-3 * energies[0]


def test_a_segment_breaks_when_the_mean_of_its_neighbours_has_been_above_the_strength():
    """All yarns alike at 1.5 times the strength: F = 1.5 T_u - T_u e^(-t / t_f) reaches T_u at t_f ln 2."""
    made = patch((4, 9))
    zone = made.arrays(0.5 * made.critical_step)
    zone.touching[:] = False
    zone.foot[:] = -1.0
    load = 1.5
    strain = load * zone.strength[0] / zone.stiffness[0]
    zone.rest_length[zone.whole] = np.linalg.norm(np.diff(zone.x), axis=0)[zone.whole[:-1]] / (
        1 + strain
    )
    zone.inverse_mass[:] = 0.0
    steps = 0
    while zone.torn_segments == 0 and steps < 10_000:
        march(zone, 1)
        steps += 1
    delay = -1 / np.log1p(-zone.filter_factor[0])  # [steps] of t_f
    assert steps == pytest.approx(delay * np.log(2), abs=3)
    lost = zone.lost_with_yarns
    assert lost == pytest.approx(
        0.5 * load * zone.strength[0] * strain * zone.rest_length[~zone.whole & zone.breaking].sum()
    )


def test_a_neighbour_that_is_whole_shields_a_segment_that_alone_is_beyond_its_strength():
    """The mean over the fabric's failure length, as in the membrane: one loaded yarn among idle ones holds more."""
    made = patch((4, 9))
    zone = made.arrays(0.5 * made.critical_step)
    middle = zone.first[0] + 4 * zone.nodes[0]
    weight = zone.mean_weights[4].max()
    assert 0.2 < weight < 0.9
    for factor, breaks in ((0.98 / weight, False), (1.02 / weight, True)):
        zone.filtered[:] = zone.half_strength
        zone.tension[:] = 0.0
        zone.tension[middle + 3] = factor * zone.strength[middle]
        for _ in range(20_000):
            chain_kernels.follow_tensions(zone)
        assert bool(zone.breaking[middle + 3]) == breaks


def test_a_yarn_whose_strength_follows_the_strain_rate_holds_more_for_a_while():
    """Above its strength a segment of a rate-dependent yarn is damaged, and breaks later than one without."""
    fabric = assumed.with_strain_rate(catalogue.load("S-726"))
    yarns = fabric.weave.yarns
    law = np.array([fabric.strain_rate.table(yarn.failure_strain) for yarn in yarns])
    steps = {}
    for name, rate_law in (("steady", np.zeros((2, 3, 0))), ("by rate", law)):
        made = patch((4, 9), rate_law=rate_law)
        zone = made.arrays(0.5 * made.critical_step)
        zone.tension[zone.whole] = 1.02 * zone.strength[zone.whole]
        zone.filtered[:] = 1.02 * zone.strength
        steps[name] = 0
        while not zone.breaking.any() and steps[name] < 200_000:
            chain_kernels.follow_tensions(zone)
            steps[name] += 1
    assert steps["steady"] == 1
    assert 1000 < steps["by rate"]
