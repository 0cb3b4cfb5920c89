"""The gradient of the ogive is that of its distance; its number is a key of its own, which it needs and
which other shapes refuse."""

import numpy as np
import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from shellfabric.projectile.projectile import Projectile
from shellfabric.projectile.sdf_kernels import distance

shot = Projectile(shape="tangent_ogive", arc_radius=1.5)
random = np.random.default_rng(1)
for _ in range(200):
    point = random.uniform(-4e-3, 4e-3, 3) - (0.0, 0.0, 4e-3)
    depth, normal = distance(shot.nose, tuple(point))
    step = 1e-8
    ahead = [distance(shot.nose, tuple(point + step * axis))[0] for axis in np.eye(3)]
    behind = [distance(shot.nose, tuple(point - step * axis))[0] for axis in np.eye(3)]
    assert np.allclose((np.array(ahead) - behind) / (2 * step), normal, atol=1e-5), point

BODY = {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm"}
SCENE = {"opening": "60 mm", "end_time": "30 us"}
OGIVE = BODY | {"shape": "tangent_ogive"}
blunt, sharp = (
    wc.impact("S-720", "150 m/s", projectile=OGIVE | {"arc_radius": arc}, **SCENE)
    for arc in (0.8, 3.0)
)
assert sharp.residual_velocity > blunt.residual_velocity
assert sharp.energy_error_max < 2e-3
for wrong in (OGIVE, BODY | {"shape": "flat", "arc_radius": 2.0}):
    with pytest.raises(InputError, match="arc_radius"):
        wc.setup("S-720", "150 m/s", projectile=wrong, **SCENE)
