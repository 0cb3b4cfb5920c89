"""Elements of a body of metal: exact gradients, flow in one element, an elastic-plastic sphere under pressure."""

import itertools
from math import exp, log, pi
from types import SimpleNamespace

import numpy as np
import pytest

from fabrics import metals
from fabrics.metals import Metal
from shellfabric import flow_kernels
from shellfabric.metal import element_kernels, motion_kernels
from shellfabric.metal.body import law_of, make_row
from shellfabric.projectile.turned import Turned

STEEL = Metal(8000.0, 200e9, 0.3)
SOFT = Metal(11000.0, 20e9, 0.42)


def bullet(**changes):
    """A small bullet with a jacket of another metal, round nosed and with a flat tip."""
    given = {
        "nose_length": 6e-3,
        "tip_radius": 0.8e-3,
        "jacket": STEEL,
        "jacket_thickness": 0.5e-3,
        "element_size": 1.2e-3,
    }
    return Turned(4.5e-3, 14e-3, SOFT, **given | changes)


def stored(row):
    """Find the stored energy [J] at the present places; nothing flows in no time."""
    element_kernels.forces(row, 0.0)
    return row.elastic_energy + row.hourglass_energy


@pytest.mark.parametrize("jacket", [True, False])
def test_forces_are_the_slopes_of_the_energy(jacket):
    body = bullet() if jacket else bullet(jacket=None, jacket_thickness=0.0)
    row = make_row(body, damping=0.0, stiffness=0.3)
    rng = np.random.default_rng(3)
    row.x[:] += rng.normal(0, 6e-5, row.x.shape) * (row.x[:, :1] > 0)
    row.x[:, 1] += rng.normal(0, 6e-5, len(row.x))
    # plastic strain of before, which is not alike in all directions
    row.metric[:] = [1.1, 0.07, 0.93, 0.95] * rng.uniform(0.97, 1.03, row.metric.shape)
    stored(row)
    force = row.f.copy()
    largest = abs(force).max()
    assert row.elastic_energy > 0
    assert row.hourglass_energy > 0
    assert abs(force[:, 1].sum()) < 1e-13 * abs(force[:, 1]).sum()
    for n in range(0, len(row.x), 5):
        for c in range(int(row.x[n, 0] == 0), 2):
            slopes = []
            for step in (4e-7, 2e-7):  # differences, and Richardson's extrapolation
                around = []
                for way in (step, -2 * step):
                    row.x[n, c] += way
                    around.append(stored(row))
                row.x[n, c] += step
                slopes.append((around[1] - around[0]) / (2 * step))
            slope = (4 * slopes[1] - slopes[0]) / 3
            assert slope == pytest.approx(force[n, c], abs=1e-9 * largest)


def squeezed(row, strain):
    """Squeeze a body evenly along its axis at constant volume; an axial force [N] holds each section."""
    row.x[:, 0] *= exp(0.5 * strain)
    row.x[:, 1] *= exp(-strain)


@pytest.mark.parametrize("name, rate", [("OFHC copper", 3e3), ("42CrMo4", 1e4), ("lead", 1e4)])
def test_the_flow_curve_of_one_element(name, rate):
    """All elements are alike: the force on a section is that of Johnson and Cook's curve, at the heat that the
    plastic work has left."""
    metal = metals.load(name)
    body = Turned(1e-3, 3e-3, metal, element_size=0.5e-3, edge_radius=0.1e-3)
    row = make_row(body, damping=0.0)
    law = law_of(metal)
    step = 2e-4
    rest = row.x.copy()
    heat = 0.0
    flowing = []
    for n in range(1, 2501):
        row.x[:] = rest
        squeezed(row, n * step)
        element_kernels.forces(row, step / rate)
        alpha = row.alpha.max()
        rate_of_flow = (alpha - (flowing[-1][0] if flowing else 0.0)) * rate / step
        stress = flow_kernels.metal_flow_stress(law, alpha, max(rate_of_flow, 0.0), heat)
        heat += stress * (alpha - (flowing[-1][0] if flowing else 0.0))
        flowing.append((alpha, stress))
    assert row.alpha.min() == pytest.approx(row.alpha.max(), rel=1e-9)
    alpha, stress = flowing[-1]
    assert alpha == pytest.approx(0.5 - stress / (3 * metal.shear), rel=1e-5)
    # sigma_zz = -2/3 q without pressure; a tip's nodes bear it but for the viscosity, which is 0 at constant volume
    tip = np.isclose(row.x[:, 1], row.x[:, 1].max())
    area = pi * row.x[:, 0].max() ** 2
    assert row.f[tip, 1].sum() / area == pytest.approx(2 / 3 * stress, rel=1e-3)
    # w / w_m by hand
    hard = metal.yield_stress + metal.hardening * alpha**metal.hardening_exponent
    fast = 1 + metal.rate_coefficient * log(1 + rate / metal.reference_rate)
    soft = 1 - (heat / metal.melting_work) ** metal.softening_exponent
    assert stress == pytest.approx(hard * fast * soft, rel=2e-3)
    assert row.heat.max() == pytest.approx(heat, rel=3e-3)


def hollow_sphere(inner, outer, metal, across, around):
    """What `make_row` needs of a mesh between two half circles about the origin."""
    radius = np.linspace(inner, outer, across + 1)
    turn = np.linspace(0, pi, around + 1)
    r = radius[:, None] * np.sin(turn)
    z = radius[:, None] * np.cos(turn)
    r[:, [0, -1]] = 0.0
    places = np.stack([r, z], axis=-1)
    number = np.arange(places.shape[0] * places.shape[1]).reshape(places.shape[:2])
    cells = number[1:, 1:], number[1:, :-1], number[:-1, :-1], number[:-1, 1:]
    corners = np.stack(cells, axis=-1).reshape(-1, 4)
    flat = places.reshape(-1, 2)
    r, z = np.moveaxis(flat[corners], -1, 0)
    areas = 0.5 * (
        (r[:, 2] - r[:, 0]) * (z[:, 3] - z[:, 1]) + (r[:, 1] - r[:, 3]) * (z[:, 2] - z[:, 0])
    )
    assert areas.min() > 0
    volumes = 2 * pi * r.mean(axis=1) * areas
    return SimpleNamespace(
        places=flat,
        corners=corners,
        outline=number[-1],
        inside=number[0],
        areas=areas,
        radii=r.mean(axis=1),
        volumes=volumes,
        core=metal,
        jacket=None,
        jacketed=np.zeros(len(corners), bool),
        density_factor=1.0,
        element_masses=metal.density * volumes,
        edge_radius=1e-4,
    )


def pressed(row, nodes, pressure):
    """Put a pressure [Pa] on the facets between nodes, half of each facet's force on either end."""
    row.outer[:] = 0.0
    for a, b in itertools.pairwise(nodes):
        along = row.x[b] - row.x[a]
        middle = 0.5 * (row.x[a, 0] + row.x[b, 0])
        force = pressure * 2 * pi * middle * np.array([-along[1], along[0]])
        row.outer[a] += 0.5 * force
        row.outer[b] += 0.5 * force


def test_hills_hollow_sphere():
    """Pressure within an elastic-plastic shell (Hill 1950, chapter 5): with the plastic front at c,

    p = 2 Y ln(c / a) + 2 Y / 3 (1 - c^3 / b^3),    u(b) = Y c^3 (1 - nu) / E b^2.
    """
    inner, outer = 10e-3, 20e-3
    metal = Metal(8000.0, 200e9, 0.3, yield_stress=10e6)  # of small strains
    body = hollow_sphere(inner, outer, metal, 20, 36)
    row = make_row(body, damping=0.2)
    front = 14e-3
    pressure = 2e7 * log(front / inner) + 2e7 / 3 * (1 - (front / outer) ** 3)
    steps = 2000
    for n in range(steps):
        pressed(row, body.inside, pressure * np.sin(0.5 * pi * min(1.0, n / (0.8 * steps))) ** 2)
        motion_kernels.advance(row, 8e-8)
        row.v[:] *= 0.97
    assert row.kinetic_energy < 1e-6 * row.elastic_energy
    grown = np.hypot(*row.x[body.outline].T) - outer
    expected = 1e7 * front**3 * 0.7 / (200e9 * outer**2)
    area = row.x[body.outline, 0]
    assert area @ grown / area.sum() == pytest.approx(expected, rel=0.01)
    assert np.ptp(grown) < 0.04 * expected
    # the front: half of the elements at this radius have flowed
    at = np.hypot(*body.places[body.corners].mean(axis=1).T)
    assert at[row.alpha > 0].max() == pytest.approx(front, abs=0.6e-3)
