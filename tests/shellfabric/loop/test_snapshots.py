"""Histories along yarns and at edges, and the fronts read off them, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fabrics.base.errors import InputError
from shellfabric.impact import run
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop import snapshots
from shellfabric.loop.histories import EDGES, LIFT, PULL, Histories, HistoryRequest, YarnHistory
from shellfabric.membrane.numerics import Numerics
from shellfabric.projectile.projectile import Projectile
from validation.models.cable.smith import smith
from weavecell.results import wave_fronts
from weavecell.results.impact import ImpactRecord

HEAVY = Projectile(1.0, 4e-3, 0.3e-3)  # too heavy to be slowed
STRIP = {"projectile": HEAVY, "boundary": "free", "cell_model": "decoupled", "table_size": 61}


@pytest.mark.parametrize("symmetry", ["quarter", "half", "whole"])
def test_a_record_is_what_the_panel_was(shoot, symmetry):
    """At the instants of snapshots, tensions and deflections are those of the whole panel's snapshot."""
    measure = HistoryRequest(1e-6, (0.0, 6e-3), (0.0, 10e-3))
    result = shoot(symmetry=symmetry, history=measure, snapshot_interval=20e-6)
    panel = result.panel
    (recorded,) = result.measured
    c = panel.constants()
    assert 45 < len(recorded.t) <= 61  # whole steps nearest to the interval
    for (shot,) in result.snapshots:
        k = int(np.argmin(abs(recorded.t - shot.t)))
        assert recorded.t[k] == shot.t
        for yarn in recorded.yarns:
            warp = yarn.family == "warp"
            row = round((yarn.offset - (c.y0 if warp else c.x0)) / (c.dy if warp else c.dx) - 0.5)
            tension = shot.tension[:, row, 0] if warp else shot.tension[row, :, 1]
            assert_array_equal(yarn.tension[k], tension)
            assert_array_equal(yarn.strain[k], tension / yarn.EA)
        for family, (x, z) in zip(("warp", "weft"), snapshots.deflection_profile(panel, shot)):
            yarn = recorded.through(family)
            assert_array_equal(yarn.place[k], x)
            assert_array_equal(yarn.deflection[k], z)
    offsets = [yarn.offset for yarn in recorded.yarns]
    assert_allclose(offsets, [0, 6e-3, 0, 10e-3], atol=c.dx / 2 + 1e-12)
    assert recorded.yarns[0].X[recorded.yarns[0].element_at(10e-3)] == pytest.approx(
        10e-3, abs=c.dx / 2
    )


PARTS = {
    "quarter": {},
    "half": {"symmetry": "half"},
    "whole": {"symmetry": "whole"},
    # forces of the rows above a block of rows stand by themselves
    "small blocks": {"numerics": Numerics(threads=1, block=60)},
    "pack": {"plies": 2, "opening": 0.03, "end_time": 80.0e-6},
    "oblique": {"symmetry": "whole", "weave_angle": 0.4},
}


@pytest.mark.parametrize("part", PARTS)
def test_reactions_take_up_the_momentum(shoot, part, monkeypatch):
    """The lift of the edges, summed over the steps, is what projectile and plies have lost: to the last digits."""
    momentum = []
    start = 60.0 * Projectile().mass

    def weigh(solver):
        loose = [(state, state.inverse_mass > 0) for state in solver.states]
        fabric = sum(float(state.mass[free] @ state.v[2][free]) for state, free in loose)
        momentum.append(
            (solver.const.projectile_mass * solver.stack.projectile_velocity[2] + fabric)
            / solver.share
        )

    # each step is recorded, which no user may ask for
    monkeypatch.setattr(run, "_check_times", lambda setup, time_step: None)
    given = {"end_time": 119.9e-6, "history": HistoryRequest(1e-9)} | PARTS[part]
    result = shoot(60.0, hooks=[weigh], **given)
    t = result.measured[0].t
    edges = [ply.edges for ply in result.measured]
    lift = sum(ply[name][:, LIFT] for ply in edges for name in EDGES)
    # velocities stand half a step back: the forces of a step act on those of the next
    taken = t[0] * np.concatenate([[0.0], np.cumsum(lift[:-1])])
    lost = start - np.array(momentum)
    assert lost[-1] > 0.1 * start
    assert_allclose(taken, lost, atol=1e-9 * start)
    for high, low in (EDGES[:2], EDGES[2:]):
        assert edges[0][high][:, PULL].max() > 100
        assert_allclose(edges[0][low], edges[0][high], rtol=1e-6, atol=1e-5)


@pytest.mark.parametrize("changes", [{}, {"elements_per_crossover": 2}, {"plies": 2}], ids=str)
def test_tensions_add_up_to_the_reaction_of_an_edge(shoot, changes):
    """Within 3 %: the history has trellis shear, viscosity and the forces of crossing yarns besides."""
    chosen = {
        "opening": 0.045,
        "end_time": 40e-6,
        "snapshot_interval": 8e-6,
        "history": HistoryRequest(1e-6),
    }
    result = shoot(**chosen | changes)
    for shots in (*result.snapshots[1:], result.last):  # waves have come to the edge
        for one, panel, known in zip(shots, result.panels, result.measured):
            (sample,) = np.flatnonzero(known.t == one.t)
            yarns = panel.weave.warp_count * np.diff(panel.lines()[1])  # of an element
            along = np.diff(one.nodes[-2:], axis=0)[0]
            cosine = along[:, 0] / np.linalg.norm(along, axis=1)
            pull = one.tension[-1, :, 0] * yarns @ (0.5 * (cosine[1:] + cosine[:-1]))
            # both halves
            assert 2 * pull == pytest.approx(known.edges["warp_high"][sample, PULL], rel=0.03)


def test_plies_are_followed_by_their_numbers(shoot):
    chosen = {"plies": 3, "opening": 0.04, "ply_gap": 50e-6, "end_time": 40e-6}
    every = shoot(120.0, history=HistoryRequest(2e-6), **chosen).measured
    named = shoot(120.0, history=HistoryRequest(2e-6, plies=(3, 1)), **chosen).measured
    assert len(every) == 3
    for one, other in zip(named, (every[2], every[0]), strict=True):
        assert_array_equal(
            [one.edges[name] for name in EDGES], [other.edges[name] for name in EDGES]
        )
        for yarn, same in zip(one.yarns, other.yarns, strict=True):
            assert_array_equal(yarn.tension, same.tension)
            assert_array_equal(yarn.deflection, same.deflection)
    assert every[0].yarns[0].deflection.max() > every[2].yarns[0].deflection.max() > 0


@pytest.mark.parametrize("plies", [(), (2,), (1.5,)])
def test_bad_measures(shoot, plies):
    with pytest.raises(InputError, match="plies"):
        shoot(history=HistoryRequest(plies=plies))


def test_the_cone_of_a_panel_is_that_of_its_recorded_yarn(shoot):
    """Read off the cuts of a record and off the yarn below the cut, at the same instants."""
    measure = HistoryRequest(1e-6, (0.0,), (0.0,))
    result = shoot(history=measure, snapshot_interval=10e-6)
    record = ImpactRecord.from_result(result, "a title", "a law")
    yarn = result.measured[0].through("warp")
    apart = np.abs(record.cut_times[:, None] - result.measured[0].t)
    known = [k for k, row in enumerate(apart) if row.min() < 1e-12]
    assert len(known) >= 4
    radius = record.cone_radius[known]
    assert np.isfinite(radius).sum() >= 3
    # the yarn is recorded on its row of nodes, as the cut is
    assert_array_equal(radius, yarn.cone_radius[apart[known].argmin(axis=1)])
    assert (np.diff(radius[np.isfinite(radius)]) > 0).all()


def made_up(tension, place, deflection):
    n = tension.shape[1]
    X = 1e-3 * (np.arange(n) + 0.5)
    return YarnHistory("warp", 0.0, 1e4, 300.0, 0.0, X, tension, place, deflection)


def test_fronts_of_made_up_waves():
    """A ramp that runs at 3000 m/s and a triangle that spreads at 250 m/s come back to the last digits."""
    t = 1e-6 * np.arange(1, 31)
    middles = 1e-3 * (np.arange(100) + 0.5)
    nodes = 1e-3 * np.arange(101)
    tension = 1e7 * np.maximum(t[:, None] - middles / 3000, 0)
    late = 10 * t
    deflection = np.maximum(0.1 * (250 * late[:, None] - nodes), 0)
    yarn = made_up(tension, np.broadcast_to(nodes, deflection.shape), deflection)
    # linear between records only where a record is not the first after the arrival
    front = wave_fronts.longitudinal(yarn, t, threshold=20.0)
    assert front.speed == pytest.approx(3000, rel=1e-3)
    assert front.start == pytest.approx(2e-6, rel=1e-3)
    assert front.interval[0] <= front.speed <= front.interval[1]
    assert front.r2 > 0.9999
    kink = wave_fronts.transverse(yarn, late)
    assert kink.speed == pytest.approx(250, rel=1e-3)
    assert_allclose(kink.place, 250 * kink.time, atol=1e-4)
    # early cones cover too few elements
    assert np.isnan(yarn.cone_radius[:2]).all()
    assert_allclose(yarn.cone_radius[3:], 250 * late[3:], atol=1e-4)
    found = wave_fronts.fronts(Histories(t, (yarn,), {}))
    assert [(front.kind, front.family) for front in found] == [
        ("longitudinal", "warp"),
        ("transverse", "warp"),
    ]


@pytest.mark.parametrize(
    "crossing, end_time, length",
    [
        pytest.param(0.3, 60e-6, 0.92, marks=pytest.mark.slow(4), id="light weft"),
        pytest.param(1.0, 70e-6, 0.84, id="woven"),
    ],
)
def test_straight_yarn_is_smiths(straight, crossing, end_time, length):
    """c / sqrt(1 + mass of the crossing yarn over its own), and Smith's U and tension for a yarn of that mass.

    Measured at 200 m/s: c within 0.1 %, U -1.5 and -0.9 %, tension -0.2 %; U comes nearer with time. A weft of less
    than a quarter of the mass follows the warp in waves of its own, and is no part of Smith's theory.
    """
    fabric = straight(crossing)
    # soft contact: the yarn of Smith's theory is led by the nose and does not bounce off it
    setup = ImpactSetup(
        fabric,
        200.0,
        opening=(length, 0.0165),
        end_time=end_time,
        history=HistoryRequest(weft=()),
        numerics=Numerics(nose_stiffness=0.3),
        **STRIP,
    )
    (recorded,) = run_impact(setup).measured
    yarn = recorded.through("warp")
    warp = fabric.weave.warp
    heavy = replace(
        warp,
        linear_density=warp.linear_density * (1 + crossing),
        fibre_density=warp.fibre_density * (1 + crossing),
    )
    theory = smith(heavy, 200.0)
    assert theory.c == pytest.approx(warp.wave_speed / np.sqrt(1 + crossing), rel=1e-12)
    front = wave_fronts.longitudinal(yarn, recorded.t, threshold=0.5 * theory.tension)
    assert front.speed == pytest.approx(theory.c, rel=0.02)
    kink = wave_fronts.transverse(yarn, recorded.t, window=(0.008, 0.9))
    assert kink.time.size > 30
    assert kink.speed == pytest.approx(theory.U, rel=0.02)
    plateau = yarn.tension[-1][(yarn.X > 1.5 * kink.place[-1]) & (yarn.X < 0.6 * front.place[-1])]
    assert np.median(plateau) == pytest.approx(theory.tension, rel=0.02)


def test_front_of_a_crimped_yarn_is_a_shock(fabric):
    """It runs at sqrt(T / (m eps)) of the state behind it, a fifth of c / sqrt 2, and the cone at Smith's U of that
    state, sqrt(T / m) (sqrt(1 + eps) - sqrt(eps)). Measured: 0.15 and 0.17 % off."""
    setup = ImpactSetup(
        replace(fabric, shear=None),
        150.0,
        opening=(0.5, 0.0165),
        end_time=140e-6,
        elements_per_crossover=2,
        history=HistoryRequest(weft=()),
        **STRIP | {"table_size": 201},
    )
    (recorded,) = run_impact(setup).measured
    yarn = recorded.through("warp")
    weave = fabric.weave
    front = wave_fronts.longitudinal(yarn, recorded.t)
    kink = wave_fronts.transverse(yarn, recorded.t)
    T = np.median(
        yarn.tension[-1][(yarn.X > 1.3 * kink.place[-1]) & (yarn.X < 0.9 * front.place[-1])]
    )
    mass = weave.areal_density * 2 * weave.w2
    stretch = (1 + yarn.crimp) * (1 + T / yarn.EA) - 1
    assert front.speed == pytest.approx(np.sqrt(T / (mass * stretch)), rel=0.02)
    assert front.speed < 0.35 * weave.warp.wave_speed / np.sqrt(2)
    U = np.sqrt(T / mass) * (np.sqrt(1 + stretch) - np.sqrt(stretch))
    cone = wave_fronts.transverse(yarn, recorded.t, window=(0.03, 0.9))
    assert cone.speed == pytest.approx(U, rel=0.02)
    assert cone.time.size > 100
    assert yarn.cone_radius[-1] == pytest.approx(U * recorded.t[-1], rel=0.15)
