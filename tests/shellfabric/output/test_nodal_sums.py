"""Fields of snapshots add up to what the histories have at the same time; see also test_runs.py."""

import numpy as np
import pytest

from shellfabric.backing.block import Backing
from shellfabric.output.histories import PULL, HistoryRequest


@pytest.mark.parametrize("changes", [{}, {"elements_per_crossover": 2}, {"plies": 2}], ids=str)
def test_tensions_add_up_to_the_reaction_of_an_edge(shoot, changes):
    """Within 3 %: the history has trellis shear, viscosity and the forces of crossing yarns besides."""
    chosen = {"opening": 0.045, "end_time": 40e-6, "snapshot_interval": 8e-6, "history": HistoryRequest(1e-6)}
    result = shoot(**chosen | changes)
    for shots in (*result.snapshots[1:], result.last):  # waves have come to the edge
        for one, panel, known in zip(shots, result.panels, result.histories):
            (sample,) = np.flatnonzero(known.t == one.t)
            yarns = panel.weave.warp_count * np.diff(panel.lines()[1])  # of an element
            along = np.diff(one.nodes[-2:], axis=0)[0]
            cosine = along[:, 0] / np.linalg.norm(along, axis=1)
            pull = one.tension[-1, :, 0] * yarns @ (0.5 * (cosine[1:] + cosine[:-1]))
            assert 2 * pull == pytest.approx(known.edges["warp_high"][sample, PULL], rel=0.03)  # both halves


@pytest.mark.parametrize("plies", [1, 2])
def test_a_block_presses_on_the_last_ply(shoot, plies):
    block = Backing(size=(0.04, 0.04, 0.03), min_size=1.5e-3, refined_depth=6e-3, growth=1.4)
    result, pressed = shoot(100.0, opening=0.04, plies=plies, backing=block, end_time=24e-6, snapshot_interval=8e-6), []
    for shots in result.snapshots:
        total = np.array([np.tensordot(one.area, one.pressure.astype(float), 2) for one in shots]) / result.panel.share
        push = result.plies["push"][result.t == shots[0].t][0]
        assert total[:, 0] == pytest.approx(push, rel=1e-6, abs=1e-3)  # in single precision
        assert total[0, 1] == 0.0
        pressed.append(total[-1, 2])
    assert max(pressed) > 100.0
