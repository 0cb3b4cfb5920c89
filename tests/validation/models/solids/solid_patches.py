"""Patches of solid yarns that several tests use."""

from functools import cache

import numpy as np

from fabrics import catalogue
from meshing import patch
from shellfabric.projectile.projectile import Projectile
from validation.models.solids import facet_kernels, tip_kernels
from validation.models.solids.mesh import SolidMesh
from validation.models.solids.model import SolidPatch
from validation.models.solids.solver import SolidSolver

FABRIC = catalogue.load("S-720")
SHOT = Projectile(mass=0.11e-3, radius=1.5e-3, shape="sphere", friction=0.1)


@cache
def woven(count=(3, 3), size=(2, 2, 1)):
    """A mesh of S-720, made once a process: nobody writes to it."""
    return patch.build(FABRIC, count, size=size)


def struck(mesh, *, quarter=False, velocity=60.0, end_time=2e-6, interval=0.25e-6, **choices):
    """A solver of a patch under a sphere that rubs."""
    own = {"friction": 0.2, "failure": False, "fibre_fractions": tuple(mesh.Vf0)} | choices
    patched = SolidPatch(SolidMesh.of(mesh, quarter=quarter), FABRIC, SHOT, **own)
    return SolidSolver(patched, velocity, end_time, interval=interval)


def settled(model, x):
    """The row of a patch at places x, all feet found."""
    row = model.row()
    row.x[:] = x
    gaps = np.empty(row.area.size)
    shares = np.empty(row.area.size)
    distances = np.empty(row.tip_area.size)
    for _ in range(3):
        facet_kernels.find_feet(row, gaps, shares)
        tip_kernels.find_tips(row, distances)
    return row


def pressed(model):
    """Places (n, 3) at which crossing yarns press on each other and on their neighbours, all bent,
    rolled and moved aside by unlike amounts."""
    random = np.random.default_rng(3)
    mesh = model.mesh
    x = mesh.points.copy()
    for yarn, grid in enumerate(mesh.grids):
        family = mesh.families[yarn]
        sign = (-1) ** mesh.numbers[yarn]
        x[grid, 1 - family] -= 36e-6 * sign * (mesh.axes[yarn] != 0)
        x[grid, 2] += 6e-6 * sign * (2 * family - 1)
        roll = 5e-6 * random.normal() * np.linspace(-1, 1, grid.shape[1])
        x[grid, 2] += roll[None, :, None]
    x += 0.5e-6 * random.normal(size=x.shape)
    return mesh.points + (x - mesh.points) * model._free()
