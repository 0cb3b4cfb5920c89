"""Drawings of bodies of metal: meshes of layers, their masses, and what is refused."""

from math import pi
from types import SimpleNamespace as Given

import numpy as np
import pytest

from fabrics.base.errors import InputError
from fabrics.metals import Metal
from shellfabric.metal.body import HOURGLASS_STIFFNESS, MetalBody, make_row
from shellfabric.projectile.dynamics import BAR
from shellfabric.projectile.turned import Turned

HEAVY = Metal(11000.0, 16e9, 0.44)
LIGHT = Metal(8000.0, 115e9, 0.31)
R, L = 4.5e-3, 14e-3

DRAWINGS = {
    "flat": {},
    "flat in a jacket": {"jacket": LIGHT, "jacket_thickness": 0.5e-3},
    "hemisphere": {"nose_length": R},
    "sphere": {"nose_length": R, "round_base": True, "length": 2 * R},
    "sphere in a jacket": {
        "nose_length": R,
        "round_base": True,
        "length": 2 * R,
        "jacket": LIGHT,
        "jacket_thickness": 0.4e-3,
        "open_base": False,
    },
    "ogive": {"nose_length": 8e-3, "jacket": LIGHT, "jacket_thickness": 0.4e-3},
    "ogive with a flat": {"nose_length": 7e-3, "tip_radius": 1.5e-3},
    "closed base": {
        "nose_length": 7e-3,
        "jacket": LIGHT,
        "jacket_thickness": 0.6e-3,
        "open_base": False,
    },
    "hollow point": {
        "nose_length": 6e-3,
        "tip_radius": 2.2e-3,
        "cavity": (1.8e-3, 4e-3),
        "jacket": LIGHT,
        "jacket_thickness": 0.5e-3,
        "bare_tip": 1e-3,
    },
    "hollow flat": {"cavity": (2e-3, 3e-3)},
}


def draw(name, **changes):
    given = {"length": L, "element_size": 0.45e-3} | DRAWINGS[name] | changes
    return Turned(R, given.pop("length"), HEAVY, **given)


def volume(name):
    """Compute the volume [m3] of a drawing by its discs."""
    given = {"length": L, "nose_length": 0.0, "tip_radius": 0.0, "cavity": None} | DRAWINGS[name]
    nose, tip, length = given["nose_length"], given["tip_radius"], given["length"]
    z = np.linspace(0, length, 400001)
    r = np.full_like(z, R)
    if nose:
        ahead = z < nose
        r[ahead] = tip + (R - tip) * np.sqrt(1 - (1 - z[ahead] / nose) ** 2)
    if given.get("round_base"):
        r = np.minimum(r, r[::-1])
    found = pi * np.sum(0.5 * (r[1:] ** 2 + r[:-1] ** 2) * np.diff(z))
    if given["cavity"]:
        wide, deep = given["cavity"]
        found -= pi * wide**2 * deep / 3
    return found


@pytest.mark.parametrize("name", DRAWINGS)
def test_the_mesh_fills_the_drawing(name):
    made = draw(name)
    assert made.volumes.sum() == pytest.approx(volume(name), rel=0.01)
    finer = draw(name, element_size=0.35e-3)
    assert finer.volumes.sum() == pytest.approx(volume(name), rel=4e-3)
    assert made.areas.min() > 0.02 * np.median(made.areas)
    outline = made.places[made.outline]
    assert len(set(made.outline)) == len(made.outline)
    assert outline[0, 0] == outline[-1, 0] == 0.0
    assert outline[-1, 1] == pytest.approx(-DRAWINGS[name].get("length", L))
    # the outline goes round the body: it bounds as much as the elements fill
    r, z = outline.T
    rings = pi / 3 * (r[1:] ** 2 + r[1:] * r[:-1] + r[:-1] ** 2) * np.diff(z)
    exact = made.places[made.corners]
    cones = 0.0
    for a in range(4):
        (r0, z0), (r1, z1) = exact[:, a].T, exact[:, (a + 1) % 4].T
        cones += pi / 3 * (r0**2 + r0 * r1 + r1**2) * (z1 - z0)
    assert -rings.sum() == pytest.approx(cones.sum(), rel=1e-9)


def distance(place, a, b):
    """Compute the distance [m] of a place to a line from a to b."""
    share = np.clip((place - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return np.hypot(*(place - a - share * (b - a)))


@pytest.mark.parametrize("name", [name for name in DRAWINGS if "jacket" in DRAWINGS[name]])
def test_the_jacket_is_as_thick_as_drawn(name):
    made = draw(name)
    thick = DRAWINGS[name]["jacket_thickness"]
    inside = [made.places[made.corners[made.jacketed]][:, k] for k in (0, 3)]
    outline = made.places[made.outline]
    covered = outline[(outline[:, 1] < -7.5e-3) & (outline[:, 1] > -11e-3) & (outline[:, 0] > 0)]
    if "sphere" in name:
        covered = outline[outline[:, 0] > 0]
    for place in covered:
        nearest = min(distance(place, a, b) for a, b in zip(*inside))
        assert nearest == pytest.approx(thick, rel=0.02)
    if "hollow" in name:
        wall = made.places[made.corners[made.jacketed]].mean(axis=1)
        assert wall[:, 1].max() < -1e-3


def test_a_mass_is_held_against_the_drawing_and_never_scaled_in_silence():
    made = draw("ogive")
    near = draw("ogive", mass=1.03 * made.drawn_mass)
    assert near.density_factor == pytest.approx(1.03)
    assert made.density_factor == 1.0
    for factor in (0.94, 1.06):
        with pytest.raises(InputError, match=f"mass .* {made.drawn_mass:.4g} kg, within 5 %"):
            draw("ogive", mass=factor * made.drawn_mass)


REFUSED = {
    "edge_radius": {"edge_radius": 0.5e-3},
    "element_size": {"element_size": 3e-3},
    "nose_length": {"nose_length": 15e-3},
    "tip_diameter": {"tip_radius": 5e-3},
    "cavity_diameter": {"cavity": (3e-3, 2e-3)},
    "jacket_thickness": {"jacket_thickness": 0.0},
    "bare_tip": {"bare_tip": 20e-3},
    "length": {"length": 0.0},
}


@pytest.mark.parametrize("key", REFUSED)
def test_what_makes_no_body_is_refused(key):
    with pytest.raises(InputError, match=key):
        draw("ogive", **REFUSED[key])


def test_core_and_jacket_have_their_own_laws_and_the_factor_of_the_mass():
    """A body of 1.04 times the mass that is drawn: both metals are so much denser, and their waves slower."""
    drawn = draw("ogive").drawn_mass
    body = draw("ogive", mass=1.04 * drawn)
    row = make_row(body)
    assert row.mass.sum() == pytest.approx(1.04 * drawn, rel=1e-12)
    for law, metal in ((row.core, HEAVY), (row.jacket, LIGHT)):
        assert law.density == pytest.approx(1.04 * metal.density)
        assert law.wave_speed == pytest.approx(metal.wave_speed / 1.04**0.5)
    for law, own in ((row.core, ~body.jacketed), (row.jacket, body.jacketed)):
        square = (row.gradient[own] ** 2).sum(axis=(1, 2))
        stiffness = HOURGLASS_STIFFNESS * law.shear_modulus * row.volume[own] * square / 12
        assert row.hourglass_stiffness[own] == pytest.approx(stiffness)


@pytest.mark.parametrize("core, jacket", [(0.7, 0.2), (0.3, 0.9)])
def test_the_strains_of_core_and_jacket_are_those_of_their_own_elements(core, jacket):
    drawing = draw("ogive")
    shot = Given(turned=drawing, nose=Given(_replace=lambda **_: None))
    body = MetalBody(shot, 0.25, 100.0, 1)
    body.row.alpha[drawing.jacketed] = np.linspace(0, jacket, drawing.jacketed.sum())
    body.row.alpha[~drawing.jacketed] = np.linspace(0, core, (~drawing.jacketed).sum())
    found = body.result(np.zeros(1), np.zeros((1, len(BAR))))["metal"]
    assert (found.core_strain, found.jacket_strain) == pytest.approx((core, jacket))
    assert found.plastic[drawing.jacketed].max() == pytest.approx(jacket)
