"""A run that has become unstable ends with an error: no kernel indexes an array by what is not a number."""

from tests.programs import printed

CODE = """
import numpy as np
from fabrics import catalogue
from shellfabric.impact.setup import ImpactSetup
from shellfabric.plies.frame_kernels import is_torn
from shellfabric.loop.pack_solver import PackSolver

pack = ImpactSetup(catalogue.load("S-728"), 91.0, opening=0.05, plies=2, ply_gap=1e-4)
solver = PackSolver(pack.target(), 91.0, 50e-6)
const = solver.pack.plies[1].constants()
for place in ((np.nan, np.nan), (np.nan, 3.0), (3.0, np.nan), (-0.5, -0.5), (float(const.ni), float(const.nj))):
    solver.contact.failures[:] = 1
    assert not is_torn(solver.contact, 1, *place)
"""


def test_no_kernel_leaves_its_arrays():
    """In a process of its own, which a wrong index would end. A foot on fabric that has flown off is not a number."""
    printed(CODE)
