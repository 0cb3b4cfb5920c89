"""A body of metal in motion: waves, even pushes, momentum, and its shape on a rigid wall."""

from math import pi

import numpy as np
import pytest

from fabrics import metals
from fabrics.metals import Metal
from shellfabric.metal import body, motion_kernels
from shellfabric.projectile.turned import Turned
from validation.models.taylor_bar import strike_wall

ROD = Metal(8000.0, 200e9, 0.0)  # without Poisson's ratio waves along it are those of a bar


def pushed(row, force):
    """Share a force [N] out to the nodes of the front by their masses; return these and the shares."""
    front = np.flatnonzero(row.x[:, 1] > -1e-9)
    share = row.mass[front] / row.mass[front].sum()
    row.outer[front, 1] = force * share
    return front, share


def test_a_step_of_force_sends_a_wave():
    """Tip velocity F / rho c A until the wave is back at 2 L / c; the tail is still until L / c, then twice as fast."""
    length = 42e-3
    row = body.make_row(Turned(1e-3, length, ROD, element_size=0.5e-3))
    c = np.sqrt(200e9 / 8000)
    jump = 100.0 / (8000 * c * pi * 1e-6)
    front, share = pushed(row, 100.0)
    t = np.arange(1, int(1.8 * length / c / 5e-8)) * 5e-8
    tip = []
    tail = []
    for _ in t:
        motion_kernels.advance(row, 5e-8)
        tip.append(share @ row.v[front, 1])
        tail.append(row.v[row.outline[-1], 1])
    assert np.mean(np.array(tip)[t > 0.2 * length / c]) == pytest.approx(jump, rel=1e-3)
    assert max(np.abs(tail)[t < 0.9 * length / c]) < 0.01 * jump
    assert np.mean(np.array(tail)[t > 1.2 * length / c]) == pytest.approx(2 * jump, rel=2e-3)


def test_an_even_push_moves_all_nodes_alike():
    """A stress that falls off linearly from the front to the tail: no node lags, on the axis neither."""
    metal = Metal(8000.0, 200e9, 0.0)
    row = body.make_row(Turned(2e-3, 8e-3, metal, element_size=0.5e-3), damping=0.0)
    mass = row.mass.sum()
    force = 10.0
    stress = force / (pi * 4e-6)
    # strain -stress / E (1 + z / L): displaced from the tail
    z = row.x[:, 1]
    row.x[:, 1] += -stress / 200e9 * (z + z**2 / (2 * 8e-3))
    from shellfabric.metal import element_kernels

    element_kernels.forces(row, 0.0)
    row.outer[:] = 0.0
    pushed(row, -force)
    acceleration = (row.f[:, 1] + row.outer[:, 1]) / row.mass
    assert acceleration == pytest.approx(-force / mass, rel=2e-3)


def test_momentum_and_energy_are_those_of_the_push():
    lead = metals.load("lead")
    jacket = metals.load("gilding metal")
    made = Turned(
        4.5e-3,
        12e-3,
        lead,
        nose_length=6e-3,
        jacket=jacket,
        jacket_thickness=0.5e-3,
        element_size=0.9e-3,
    )
    row = body.make_row(made, velocity=100.0)
    front = row.outline[:5]
    row.outer[front, 1] = np.array([-1.0, -2.0, -3.0, -2.0, -1.0]) * 1e3
    row.outer[front, 0] = np.array([0.0, 0.1, 0.3, 0.5, 0.2]) * 1e3
    start = float(row.kinetic_energy)
    for _ in range(150):
        motion_kernels.advance(row, 1e-7)
    assert row.mass @ row.v[:, 1] == pytest.approx(row.mass.sum() * 100 - 9e3 * 150e-7, rel=1e-12)
    assert row.plastic_work > 0.05 * abs(row.outer_work)
    held = row.kinetic_energy + row.elastic_energy + row.hourglass_energy
    spent = row.plastic_work + row.viscous_work
    assert held + spent - row.outer_work == pytest.approx(start, rel=1e-4)


def test_taylor_bar_of_42crmo4():
    """32.4 x 6.4 mm at 287 m/s: 26.56 and 11.16 mm of Abaqus, 26.52 and 11.15 mm of DynELA, both with 250
    axisymmetric elements (documentation of DynELA 4.0, Samples-Impacts.tex)."""
    bar = Turned(3.2e-3, 32.4e-3, metals.load("42CrMo4"), element_size=0.64e-3)
    assert len(bar.corners) == 255
    found = strike_wall(bar, 287.0)
    for long, wide in ((26.56e-3, 11.16e-3), (26.52e-3, 11.15e-3)):
        assert found.length == pytest.approx(long, rel=0.01)
        assert found.width == pytest.approx(wide, rel=0.02)
    # the wall takes at once what its front row of nodes has, 1.1 %
    assert found.energy_error < 2e-3


def test_a_body_that_is_driven_too_far_stops_where_it_is():
    """Lead at 800 m/s on a wall: its front needs shorter and shorter steps, until the body says so."""
    made = Turned(4.5e-3, 12e-3, metals.load("lead"), nose_length=6e-3, element_size=1e-3)
    row = body.make_row(made, velocity=800.0, wall=0.0)
    for _ in range(400):
        motion_kernels.advance(row, 1e-7)
        if row.fault:
            break
    assert row.fault in (motion_kernels.INSIDE_OUT, motion_kernels.TOO_SHORT)
    before = row.x.copy()
    motion_kernels.advance(row, 1e-7)
    assert np.array_equal(row.x, before)
