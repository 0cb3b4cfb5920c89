"""The gradient of the ogive is that of its distance, and its shot lies between a flat nose and a cone."""

import numpy as np

from fabrics import catalogue
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.projectile.projectile import Projectile
from shellfabric.projectile.sdf_kernels import distance

shot = Projectile(shape="tangent_ogive")
random = np.random.default_rng(1)
for _ in range(200):
    point = random.uniform(-4e-3, 4e-3, 3) - (0.0, 0.0, 4e-3)
    depth, normal = distance(shot.nose, tuple(point))
    step = 1e-8
    ahead = [distance(shot.nose, tuple(point + step * axis))[0] for axis in np.eye(3)]
    behind = [distance(shot.nose, tuple(point - step * axis))[0] for axis in np.eye(3)]
    assert np.allclose((np.array(ahead) - behind) / (2 * step), normal, atol=1e-5), point
fabric = catalogue.load("S-720").with_effective_density()
setup = ImpactSetup(fabric, 150.0, projectile=shot, opening=0.06, end_time=30e-6)
result = run_impact(setup)
assert result.energy_error_max < 2e-3
