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
from shellfabric.cable import solver as cable_solver
from shellfabric.cable.model import CableNet
from shellfabric.impact import pack, single_ply

# energies in the order of the names that they had when digests were first kept
FIRST_NAMES = {
    "yarn_strain": "stored", "formulation_residual": "cell", "failure_dissipation": "failed", "clamp_friction": "grip",
    "boundary_work": "external", "jamming": "jam", "ply_contact": "plies", "error": "balance",
}  # fmt: skip
LATER = {"ply_friction"}  # energies of models that came later, 0 in all runs here


def digest(*arrays):
    """First 16 digits of the SHA-256 of arrays as doubles."""
    found = hashlib.sha256()
    for array in arrays:
        found.update(np.ascontiguousarray(array, float).tobytes())
    return found.hexdigest()[:16]


def of_result(result, nodes):
    """(text of the outcome and the last velocity [m/s], digest) of a run."""
    energies = [
        result.energies[name]
        for name in sorted({*result.energies} - LATER, key=lambda name: FIRST_NAMES.get(name, name))
    ]
    found = digest(result.t, result.v, result.nose_position, *energies, result.step_history, nodes, result.peak_tension)
    return f"{result.outcome} {result.v[-1]:.6f}", found


def shot(name, velocity, end_time=250e-6):
    """One ply at the default settings: (text of the outcome, digest)."""
    result = single_ply.run(single_ply.ImpactSetup(catalogue.load(name), velocity, end_time=end_time))
    return of_result(result, result.nodes)


def shot_at_pack(name, plies, velocity, end_time=250e-6):
    """A pack of equal plies: (text of the outcome, digest)."""
    ply = single_ply.ImpactSetup(catalogue.load(name), velocity, end_time=end_time)
    result = pack.run(pack.PackSetup(ply, plies))
    return of_result(result, result.last[0].nodes)


def cable_net():
    """The cable net of S-720 at 100 m/s: (text of the outcome, digest)."""
    setup = single_ply.ImpactSetup(catalogue.load("S-720"), 100.0, end_time=100e-6)
    result = cable_solver.run(CableNet.of(setup), 100.0, 100e-6)
    return of_result(result, result.nodes)


def calibration_path():
    """The balanced path of S-720 on the coarse mesh: (text of the last tensions, digest)."""
    from meshing import crossover
    from unitcell3d.cases import biaxial_and_platens

    fabric = catalogue.load("S-720")
    found = biaxial_and_platens.biaxial(crossover.build(fabric, size="coarse"), fabric)
    return f"{found.T1[-1]:.6f} {found.T2[-1]:.6f}", digest(found.path, found.T1, found.T2, found.F_c, found.d_c)


RUNS = {
    "S-720 at 92.5 m/s": lambda: shot("S-720", 92.5),
    "S-720 at 155 m/s": lambda: shot("S-720", 155.0),
    "S-745 at 215 m/s": lambda: shot("S-745", 215.0),
    "4 x S-728 at 91 m/s": lambda: shot_at_pack("S-728", 4, 91.0),
    "4 x S-726 at 300 m/s, torn": lambda: shot_at_pack("S-726", 4, 300.0, 60e-6),
    "cable net, S-720 at 100 m/s": cable_net,
    "3D path of S-720, coarse": calibration_path,
}


def main():
    for name, run in RUNS.items():
        if not (run is calibration_path and "--without-3d" in sys.argv):
            print(f"{name:30s}", *run(), flush=True)


if __name__ == "__main__":
    main()
