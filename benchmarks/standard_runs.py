"""Thirteen standard runs, to the last bit: what a change of the code's structure must leave as it is.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python benchmarks/standard_runs.py [--without-3d] [--only TEXT ...]
    ... --keep BEFORE.npz                      and keep all arrays of the runs
    ... --against BEFORE.npz                   and compare with arrays that another tree has kept

A digest covers the histories of time, velocity, nose position and every energy, the history of every step, the nodes of
the (foremost) ply at the end and the peak tensions. It depends on numpy, numba and the processor: compare two trees on
one machine. Where a change moves the last digits, `--against` tells the largest difference of any array, relative to
its largest value (of an energy: to that of the projectile), through failures as well; it exits with 1 above 1e-9.
"""

import argparse
import hashlib
import sys
from pathlib import Path

import numpy as np

from fabrics import catalogue
from shellfabric.block.block import Backing
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.projectile.projectile import Projectile
from validation.models.cable.net import CableNet

TOLERANCE = 1e-9  # of a change that only reorders sums
SMALL = {"opening": 0.06, "end_time": 100e-6}
BLOCK = Backing(size=(0.06, 0.06, 0.04))
BAR = Projectile(body="elastic_bar")


def arrays_of(result, nodes, peaks):
    """(text of the outcome and the last velocity [m/s], {name: array}) of a run."""
    found = {f"energy {name}": energy for name, energy in sorted(result.energies.items())}
    found["t"] = result.time
    found["v"] = result.velocity
    found["nose position"] = result.nose_position
    found["steps"] = result.step_history
    found["nodes"] = nodes
    found["peaks"] = peaks
    arrays = {name: np.ascontiguousarray(array, float) for name, array in found.items()}
    return f"{result.outcome} {result.velocity[-1]:.6f}", arrays


def shot(name, velocity, **changes):
    """One ply or several, 250 us at the longest."""
    options = {"end_time": 250e-6, **changes}
    result = run_impact(ImpactSetup(catalogue.load(name), velocity, **options))
    return arrays_of(result, result.last[0].nodes, result.peaks[..., 0])


def cable_net():
    """The cable net of S-720 at 100 m/s."""
    net = CableNet(ImpactSetup(catalogue.load("S-720"), 100.0, end_time=100e-6))
    result = net.run()
    found = {f"energy {name}": energy for name, energy in result.energies.items()}
    found |= {f"reaction {name}": force for name, force in result.reactions.items()}
    found["steps"] = result.step_history
    found["nodes"] = np.array(net.state.u)
    speed = result.step_history[-1, 2]
    return f"{speed:.6f}", {
        name: np.ascontiguousarray(array, float) for name, array in found.items()
    }


def calibration_path():
    """The balanced path of S-720 on the coarse mesh."""
    from meshing import crossover
    from unitcell3d.cases import biaxial_and_platens

    fabric = catalogue.load("S-720")
    found = biaxial_and_platens.biaxial(crossover.build(fabric, size="coarse"), fabric)
    names = ("path", "T1", "T2", "F_c", "d_c")
    arrays = {name: np.ascontiguousarray(getattr(found, name), float) for name in names}
    return f"{found.T1[-1]:.6f} {found.T2[-1]:.6f}", arrays


RUNS = {
    "S-720 at 92.5 m/s": lambda: shot("S-720", 92.5),
    "S-720 at 155 m/s": lambda: shot("S-720", 155.0),
    "S-745 at 215 m/s": lambda: shot("S-745", 215.0),
    "4 x S-728 at 91 m/s": lambda: shot("S-728", 91.0, plies=4),
    "4 x S-726 at 300 m/s, torn": lambda: shot("S-726", 300.0, plies=4, end_time=60e-6),
    "S-726 on a block": lambda: shot("S-726", 150.0, backing=BLOCK, **SMALL),
    "S-726, elastic bar": lambda: shot("S-726", 150.0, projectile=BAR, **SMALL),
    "S-726, oblique weave": lambda: shot(
        "S-726", 120.0, weave_angle=0.3, symmetry="whole", **SMALL
    ),
    "4 x S-728, alternating": lambda: shot(
        "S-728", 120.0, plies=4, stacking="alternating", ply_friction=0.2, **SMALL
    ),
    "cable net, S-720 at 100 m/s": cable_net,
    "3D path of S-720, coarse": calibration_path,
}


def digest(arrays):
    """First 16 digits of the SHA-256 of arrays, in the order of their names."""
    found = hashlib.sha256()
    for name in sorted(arrays):
        found.update(arrays[name].tobytes())
    return found.hexdigest()[:16]


def difference(name, array, before):
    """Largest difference of an array of a run from that of another tree, relative; inf of another shape."""
    other = before[name]
    if other.shape != array.shape:
        return np.inf
    if name.startswith("energy "):
        scale = np.abs(before["energy kinetic_projectile"]).max()
    else:
        scale = np.abs(other).max(initial=0.0)
    distance = np.abs(array - other).max(initial=0.0)
    return distance / scale if distance else 0.0


def compare(name, arrays, kept):
    """(line of the largest differences of a run, the largest of them)."""
    before = {key.removeprefix(f"{name}/"): kept[key] for key in kept if key.startswith(f"{name}/")}
    if before.keys() != arrays.keys():
        return f"has not the same arrays: {sorted(before.keys() ^ arrays.keys())}", np.inf
    found = sorted(((difference(key, arrays[key], before), key) for key in arrays), reverse=True)
    equal = sum(size == 0.0 for size, _ in found)
    worst = ", ".join(f"{key} {size:.1e}" for size, key in found[:3] if size)
    return f"{equal} of {len(found)} arrays equal to the bit  {worst}", found[0][0]


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--without-3d", action="store_true")
    arguments.add_argument("--only", nargs="+", help="parts of the names of runs")
    arguments.add_argument("--keep", type=Path)
    arguments.add_argument("--against", type=Path)
    chosen = arguments.parse_args()
    kept = dict(np.load(chosen.against)) if chosen.against else {}
    found, largest = {}, 0.0
    for name, fire in RUNS.items():
        if chosen.without_3d and fire is calibration_path:
            continue
        if chosen.only and not any(part in name for part in chosen.only):
            continue
        text, arrays = fire()
        found |= {f"{name}/{key}": array for key, array in arrays.items()}
        print(f"{name:30s} {text} {digest(arrays)}", flush=True)
        if kept:
            line, worst = compare(name, arrays, kept)
            largest = max(largest, worst)
            print(f"{'':30s} {line}", flush=True)
    if chosen.keep:
        np.savez(chosen.keep, **found)
    sys.exit(int(largest > TOLERANCE))


if __name__ == "__main__":
    main()
