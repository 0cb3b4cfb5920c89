"""
Which inputs decide a residual velocity?
========================================

Sobol indices of one ply of S-720 at 170 m/s, by `SALib <https://salib.readthedocs.io>`_: the share of the variance that
an input explains alone (first order) and together with the others (total order). Modulus, failure strain and warp crimp
vary by 20 % either way, 16 (3 + 2) shots at a small, coarse panel. It prints and draws the indices with their 95 %
intervals, which are wide: take 128 samples and the default panel for numbers to rely on. About 30 s.
Run with ``python examples/sobol_indices.py``.
"""

import matplotlib.pyplot as plt
import numpy as np
from SALib.analyze import sobol as analysis
from SALib.sample import sobol as sampling

import weavecell as wc
from fabrics.variants import scale_yarns
from shellfabric.impact.setup import ImpactSetup

INPUTS = ["modulus", "failure strain", "warp crimp"]
PROBLEM = {"num_vars": len(INPUTS), "names": INPUTS, "bounds": [[0.8, 1.2]] * len(INPUTS)}


def setup(modulus: float, failure_strain: float, warp_crimp: float) -> ImpactSetup:
    """The shot at a fabric whose numbers are changed by these factors."""
    fabric = scale_yarns(
        wc.fabric("S-720"), E=modulus, failure_strain=failure_strain, crimp=(warp_crimp, 1.0)
    )
    return wc.setup(
        fabric, "170 m/s", opening="60 mm", projectile="FSP 1.10 g", elements_per_crossover=1
    )


factors = sampling.sample(PROBLEM, 16, calc_second_order=False, seed=1)
shots = wc.sweep(setup(*row) for row in factors)
residuals = np.array([shot.residual_velocity for shot in shots])
print(f"{len(residuals)} shots: mean {residuals.mean():.1f} m/s")

indices = analysis.analyze(PROBLEM, residuals, calc_second_order=False, seed=1)
for name, first, total in zip(INPUTS, indices["S1"], indices["ST"]):
    print(f"{name}: first order {first:.2f}, total order {total:.2f}")

figure, axes = plt.subplots(figsize=(7.2, 3.2), layout="constrained")
places = np.arange(len(INPUTS))
axes.barh(places - 0.2, indices["S1"], 0.4, xerr=indices["S1_conf"], label="first order")
axes.barh(places + 0.2, indices["ST"], 0.4, xerr=indices["ST_conf"], label="total order")
axes.set_yticks(places, INPUTS)
axes.invert_yaxis()
axes.set(xlabel="share of the variance of the residual velocity [-]")
axes.legend()
figure.savefig("sobol-indices.png", dpi=150)
