"""Digests of standard runs, to the last bit: what a change of the code's structure must leave as it is.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python benchmarks/standard_runs.py [--without-3d]

A digest covers the histories of time, velocity, nose position and every energy, the history of every step, the nodes of
the (foremost) ply at the end and the peak tensions. It depends on numpy, numba and the processor: compare two trees on
one machine.
"""

import hashlib
import sys

import numpy as np

from fabrics import catalogue
from shellfabric.backing.block import Backing
from shellfabric.impact.simulation import ImpactSetup, run
from shellfabric.projectile.projectile import Projectile
from shellfabric.sliding.model import CrossoverFriction
from validation.models.cable import solver as cable_solver
from validation.models.cable.model import CableNet

# energies in the order of the names that they had when digests were first kept
FIRST_NAMES = {
    "yarn_strain": "stored", "formulation_residual": "cell", "failure_dissipation": "failed", "clamp_friction": "grip",
    "boundary_work": "external", "jamming": "jam", "ply_contact": "plies", "error": "balance",
}  # fmt: skip
LATER = {"ply_friction", "ply_guard"}  # energies of models that came later, 0 in all runs here


def digest(*arrays):
    """First 16 digits of the SHA-256 of arrays as doubles."""
    found = hashlib.sha256()
    for array in arrays:
        found.update(np.ascontiguousarray(array, float).tobytes())
    return found.hexdigest()[:16]


def of_result(result, nodes, peaks):
    """(text of the outcome and the last velocity [m/s], digest) of a run."""
    energies = [
        result.energies[name]
        for name in sorted({*result.energies} - LATER, key=lambda name: FIRST_NAMES.get(name, name))
    ]
    found = digest(result.t, result.v, result.nose_position, *energies, result.step_history, nodes, peaks)
    return f"{result.outcome} {result.v[-1]:.6f}", found


def shot(name, velocity, **changes):
    """One ply or several, 250 us at the longest: (text of the outcome, digest)."""
    result = run(ImpactSetup(catalogue.load(name), velocity, **{"end_time": 250e-6, **changes}))
    return of_result(result, result.last[0].nodes, result.peaks[..., 0])


def cable_net():
    """The cable net of S-720 at 100 m/s: (text of the outcome, digest)."""
    setup = ImpactSetup(catalogue.load("S-720"), 100.0, end_time=100e-6)
    result = cable_solver.run(CableNet.of(setup), 100.0, 100e-6)
    return of_result(result, result.nodes, result.peak_tension)


def calibration_path():
    """The balanced path of S-720 on the coarse mesh: (text of the last tensions, digest)."""
    from meshing import crossover
    from unitcell3d.cases import biaxial_and_platens

    fabric = catalogue.load("S-720")
    found = biaxial_and_platens.biaxial(crossover.build(fabric, size="coarse"), fabric)
    return f"{found.T1[-1]:.6f} {found.T2[-1]:.6f}", digest(found.path, found.T1, found.T2, found.F_c, found.d_c)


SMALL = {"opening": 0.06, "end_time": 100e-6}
RUNS = {
    "S-720 at 92.5 m/s": lambda: shot("S-720", 92.5),
    "S-720 at 155 m/s": lambda: shot("S-720", 155.0),
    "S-745 at 215 m/s": lambda: shot("S-745", 215.0),
    "4 x S-728 at 91 m/s": lambda: shot("S-728", 91.0, plies=4),
    "4 x S-726 at 300 m/s, torn": lambda: shot("S-726", 300.0, plies=4, end_time=60e-6),
    "S-726, sliding crossovers": lambda: shot("S-726", 96.0, **SMALL, crossovers=CrossoverFriction(0.2)),
    "2 x S-726, sliding crossovers": lambda: shot("S-726", 130.0, **SMALL, plies=2, crossovers=CrossoverFriction(0.2)),
    "S-726 on a block": lambda: shot("S-726", 150.0, **SMALL, backing=Backing(size=(0.06, 0.06, 0.04))),
    "S-726, elastic bar": lambda: shot("S-726", 150.0, **SMALL, projectile=Projectile(body="elastic_bar")),
    "S-726, oblique weave": lambda: shot("S-726", 120.0, **SMALL, weave_angle=0.3, symmetry="whole"),
    "4 x S-728, alternating": lambda: shot("S-728", 120.0, **SMALL, plies=4, stacking="alternating", ply_friction=0.2),
    "cable net, S-720 at 100 m/s": cable_net,
    "3D path of S-720, coarse": calibration_path,
}


def main():
    for name, fire in RUNS.items():
        if not (fire is calibration_path and "--without-3d" in sys.argv):
            print(f"{name:30s}", *fire(), flush=True)


if __name__ == "__main__":
    main()
