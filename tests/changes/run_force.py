"""The foundation stores energy, and the energy of the run is conserved."""

# the patch adds the last of these modules
# isort: off
from dataclasses import replace
from functools import partial

from fabrics import catalogue
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.foundation import Foundation

fabric = catalogue.load("S-726").with_effective_density()
setup = ImpactSetup(fabric, 100.0, opening=0.04, end_time=30e-6)
panel = replace(setup.panel(), parts=(partial(Foundation, stiffness=2e10),))
run = PackSolver(panel, 100.0, 30e-6).run()
assert run.sample("foundation")[-1] > 0.01 * run.strike_energy
assert abs(run.sample("error")).max() < 1e-3 * run.strike_energy
