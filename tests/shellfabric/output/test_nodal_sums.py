"""Fields of snapshots add up to what the histories have of each ply at the same time."""

import numpy as np
import pytest

from shellfabric.backing.block import Backing
from shellfabric.impact.simulation import ImpactSetup, run
from shellfabric.output.histories import PULL, HistoryRequest
from shellfabric.projectile.projectile import Projectile
from shellfabric.sliding.model import CrossoverFriction

QUICK = {"opening": 0.045, "table_size": 101, "end_time": 40e-6, "snapshot_interval": 8e-6}
RUBBING = {"projectile": Projectile(3e-3, 2.75e-3, 0.3e-3, friction=0.3), "ply_friction": 0.2}
ROUNDING = 1e-6  # of numbers in single precision, which snapshots keep


def shot(fabric, velocity=200.0, **changes):
    return run(ImpactSetup(fabric, velocity, **QUICK | changes))


def instants(result):
    """(sample, plies' snapshots) of each."""
    for shots in (*result.snapshots, result.last):
        (sample,) = np.flatnonzero(result.t == shots[0].t)
        yield sample, shots


def forces(shots):
    """(plies, k) [N] of the modelled part: pressures times areas, over all nodes."""
    return np.array([np.tensordot(one.area, one.pressure.astype(float), 2) for one in shots])


CASES = {
    "one ply": {},
    "one ply, half of it": {"symmetry": "half"},
    "one ply that rubs": RUBBING | {"ply_friction": 0.0},
    "one graded ply": {"grading": ((10, 0.5), (np.inf, 1))},
    "one sliding ply": {"crossovers": CrossoverFriction(0.2), "velocity": 150.0},
    "pack": {"plies": 3, "stacking": "alternating"},
    "whole pack": {"plies": 2, "symmetry": "whole", "elements_per_crossover": 1},
    "pack that rubs": RUBBING | {"plies": 3},
    "torn pack": {"plies": 2, "velocity": 400.0},
    "sliding pack": {"plies": 2, "crossovers": CrossoverFriction(0.2)},
}


@pytest.mark.parametrize("case", CASES)
def test_pressures_and_failed_segments_add_up_to_the_histories(fabric, case):
    result, pressed = shot(fabric, **CASES[case]), []
    share, peak = result.panel.share, result.plies["push"].max()
    for sample, shots in instants(result):
        total = forces(shots) / share
        pressed.append(total.max(axis=0))
        assert total[:, 0] == pytest.approx(result.plies["push"][sample], rel=ROUNDING, abs=ROUNDING * peak)
        failed = [one.failed_segments.sum() / share for one in shots]
        assert failed == pytest.approx(result.plies["failed_yarns"][sample], rel=ROUNDING)
        if len(shots) > 1:
            front, rear, torn = total[:, 1:].T
            assert front[0] == rear[-1] == 0.0
            assert rear[:-1] == pytest.approx(front[1:], rel=ROUNDING, abs=ROUNDING * peak)
            assert torn.sum() == pytest.approx(0.0, abs=ROUNDING * peak)
    assert np.all(np.max(pressed, axis=0)[:3] > 100.0)  # [N] the projectile and, in a pack, both neighbours
    assert result.plies["failed_yarns"][-1].sum() > 0


@pytest.mark.parametrize("changes", [{}, {"elements_per_crossover": 2}, {"plies": 2}], ids=str)
def test_tensions_add_up_to_the_reaction_of_an_edge(fabric, changes):
    """Within 3 %: the history has trellis shear, viscosity and the forces of crossing yarns besides."""
    result = shot(fabric, 150.0, history=HistoryRequest(1e-6), **changes)
    for shots in (*result.snapshots[1:], result.last):  # waves have come to the edge
        for one, panel, known in zip(shots, result.panels, result.histories):
            (sample,) = np.flatnonzero(known.t == one.t)
            yarns = panel.weave.warp_count * np.diff(panel.lines()[1])  # of an element
            along = np.diff(one.nodes[-2:], axis=0)[0]
            cosine = along[:, 0] / np.linalg.norm(along, axis=1)
            pull = one.tension[-1, :, 0] * yarns @ (0.5 * (cosine[1:] + cosine[:-1]))
            assert 2 * pull == pytest.approx(known.edges["warp_high"][sample, PULL], rel=0.03)  # both halves


@pytest.mark.parametrize("plies", [1, 2])
def test_a_block_presses_on_the_last_ply(fabric, plies):
    block = Backing(size=(0.04, 0.04, 0.03), min_size=1.5e-3, refined_depth=6e-3, growth=1.4)
    result, pressed = shot(fabric, 100.0, plies=plies, backing=block, end_time=24e-6, opening=0.04), []
    for sample, shots in instants(result):
        total = forces(shots) / result.panel.share
        assert total[:, 0] == pytest.approx(result.plies["push"][sample], rel=ROUNDING, abs=1e-3)
        assert total[0, 1] == 0.0
        pressed.append(total[-1, 2])
    assert max(pressed) > 100.0
