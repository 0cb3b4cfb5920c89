"""A run that has become unstable ends with an error: no kernel indexes an array by what is not a number."""

import subprocess
import sys
import textwrap
from pathlib import Path

CODE = """
    import numpy as np
    from fabrics import catalogue
    from shellfabric.impact.simulation import ImpactSetup
    from shellfabric.solver.pack_solver import PackSolver
    from shellfabric.plies import surface_kernels as ply_surface_kernels

    pack = ImpactSetup(catalogue.load("S-728"), 91.0, opening=0.05, plies=2, ply_gap=1e-4)
    march = PackSolver(pack.target(), 91.0, 50e-6)
    state, const = march.states[1], march.pack.plies[1].constants()
    for place in ((np.nan, np.nan), (np.nan, 3.0), (3.0, np.nan), (-0.5, -0.5), (float(const.ni), float(const.nj))):
        assert ply_surface_kernels.intact_about(state, const, *place)
"""


def test_no_kernel_leaves_its_arrays():
    """In a process of its own, which a wrong index would end. A foot on cloth that has flown off is not a number."""
    command, root = [sys.executable, "-c", textwrap.dedent(CODE)], Path(__file__).parents[3]
    done = subprocess.run(command, capture_output=True, text=True, cwd=root, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
