"""Quality indicators of the dent in a block behind a pack."""

from __future__ import annotations

from typing import Any

import numpy as np

from shellfabric.block import dent
from shellfabric.block.coupling import NAMES, result_of
from shellfabric.membrane.indicator import Indicator
from shellfabric.membrane.quality import indicator


def indicators(solver: Any) -> tuple[Indicator, ...]:
    """Return the quality indicators of the dent behind a pack of a `loop.pack_solver.PackSolver`;
    () without a block.

    What a dent comes to at rest is looked at where the run goes on after the stop; its shape where
    it is deeper than a tenth of a brick.
    """
    part = solver.part("block")
    if part is None:
        return ()
    block = part.block
    time, depth = solver.sample("t"), solver.sample("dent")
    found = result_of(block, time, depth, solver.alone_from, part.gauge_radius)
    brick = block.backing.min_size
    deepest = max(found.deepest_dent, 0.1 * brick)
    values = {
        "motion at held faces": solver.sample("held_motion").max() / deepest,
        "face under held fabric": dent.covered(solver.plies[-1][0]),
        "face across symmetry": solver.sample("crossing").max() / brick,
        "hourglass energy of the block": _hourglass_share(solver),
        "folded bricks": dent.folding(block),
    }
    if found.deepest_dent > 0.1 * brick:
        gauged = max(found.gauge_depth, 0.1 * brick)
        values["deepest node of the dent"] = found.deepest_point / gauged
        values["brick on the dent's floor"] = dent.floor_brick(found.depth_map, found.half_width)
    if solver.stack.after_stop > 0 and solver.stack.stop_step > 0:
        window = found.half_width / block.backing.material.shear_speed
        changed = dent.change(time, depth, window)
        values["change of the dent"] = changed if np.isfinite(changed) else 1.0
        values["springback of the dent"] = found.springback
    if solver.fabric_ended:
        least = depth[time >= solver.alone_from].min()
        values["dent back at the pack"] = part.hand_over.deepest_ply / max(least, 0.1 * brick)
    return tuple(indicator(name, value) for name, value in values.items())


def _hourglass_share(solver):
    """[-] the largest that springs of the hourglass control held, over what the block had taken up
    at the end: they have no limit of their own."""
    held = solver.sample("backing_hourglass").max()
    taken = sum(float(solver.sample(name)[-1]) for name in NAMES)
    return held / max(taken, 1e-3 * solver.strike_energy)
