"""A projectile of metal in a run: its row, and the part that moves it."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray
from fabrics.metals import Metal
from shellfabric.jit.table import Row
from shellfabric.law_rows import make_law
from shellfabric.membrane import quality
from shellfabric.membrane.indicator import Indicator
from shellfabric.metal import element_kernels, motion_kernels
from shellfabric.metal.state import BodyRow, MetalLaw
from shellfabric.parts import Part
from shellfabric.projectile.dynamics import BAR, ENERGIES, RIGID
from shellfabric.projectile.projectile import WIDEST, Projectile
from shellfabric.projectile.turned import Turned
from shellfabric.state import Constants, Profile, State

HOURGLASS_STIFFNESS = 0.02  # share of the elastic one
HOURGLASS_DAMPING = 0.05  # share of critical damping


def law_of(metal: Metal, density_factor: float = 1.0) -> MetalLaw:
    """Return the constants of a metal as kernels take them."""
    return make_law(
        MetalLaw,
        metal,
        density=density_factor * metal.density,
        wave_speed=metal.wave_speed / density_factor**0.5,
    )


def make_row(
    body: Turned,
    share: float = 1.0,
    velocity: float = 0.0,
    *,
    partners: int = 1,
    wall: float = inf,
    stiffness: float = HOURGLASS_STIFFNESS,
    damping: float = HOURGLASS_DAMPING,
) -> BodyRow:
    """Make the row that the kernels need of a body in flight, without strain.

    Parameters
    ----------
    share : of the body that is in the model
    velocity : [m/s] along its axis
    partners : number of plies and blocks that may touch it
    wall : [m] place of a rigid wall ahead, its tip being at 0
    stiffness, damping : of the hourglass control, as shares of the elastic stiffness and of
        critical damping
    """
    places = body.places
    corners = body.corners
    outline = body.outline
    at = places[corners]
    r, z = at[..., 0], at[..., 1]
    area = body.areas
    gradient = np.empty((len(corners), 4, 2))
    for a in range(4):
        after, before = (a + 1) % 4, (a + 3) % 4
        gradient[:, a, 0] = (z[:, after] - z[:, before]) / (2 * area)
        gradient[:, a, 1] = (r[:, before] - r[:, after]) / (2 * area)
    bent = np.array([1.0, -1.0, 1.0, -1.0])
    linear = np.einsum("a,mac->mc", bent, at)
    core = law_of(body.core, body.density_factor)
    jacket = law_of(body.jacket or body.core, body.density_factor)
    masses = share * body.density_factor * body.element_masses
    volume = share * body.volumes
    square = np.sum(gradient**2, axis=(1, 2))
    moduli, speeds = (
        np.where(body.jacketed, getattr(jacket, name), getattr(core, name))
        for name in ("shear_modulus", "wave_speed")
    )
    sizes = {"elements": len(corners), "nodes": len(places), "rings": len(outline)}
    found = BodyRow.zeros(**sizes, partners=partners)
    profile = Profile(**Profile.zeros(rings=len(outline)) | {"force": found["ring_force"][0]})
    # in equal parts, as forces: a body that is pushed evenly from behind moves evenly, on its axis too
    mass = np.bincount(corners.ravel(), np.repeat(0.25 * masses, 4), len(places))
    found |= {
        "corners": np.ascontiguousarray(corners),
        "jacketed": body.jacketed,
        "gradient": gradient,
        "pattern": bent - np.einsum("mac,mc->ma", gradient, linear),
        "radius": body.radii,
        "area": area,
        "volume": volume,
        "hourglass_stiffness": stiffness * moduli * volume * square / 12,
        "hourglass_damping": damping * 0.25 * masses * speeds * np.sqrt(square),
        "core": core,
        "jacket": jacket,
        "mass": mass,
        "outline": outline,
        "wall": wall,
        "x": places.copy(),
        "before": places[outline],
        "profile": profile,
    }
    found["v"][:, 1] = velocity
    found["metric"][:] = 1.0, 0.0, 1.0, 1.0
    ends = places[outline[0], 1], places[outline[-1], 1], sums.dot(mass, places[:, 1]) / mass.sum()
    found["start"][:] = ends
    row = BodyRow(**found)
    element_kernels.forces(row, 0.0)
    motion_kernels.note_motion(row)
    motion_kernels.show_outline(row, body.edge_radius, 1.0)
    return row


def width(row: BodyRow) -> float:
    """Compute the largest diameter [m] of a body as it is."""
    return 2 * float(row.x[row.outline, 0].max())


def length(row: BodyRow) -> float:
    """Compute the length [m] of a body as it is."""
    return float(np.ptp(row.x[row.outline, 1]))


@dataclass(frozen=True)
class MetalHistory:
    """A body of metal at the end of a run, and through time along its axis.

    Parameters
    ----------
    t : (n,) [s]
    tip, tail, centre : (n,) [m] how far tip, tail and centre of mass have come
    tip_velocity, tail_velocity, centre_velocity : (n,) [m/s]
    width, length : [m] at the end
    width_at_rest, length_at_rest : [m]
    plastic_energy : [J] of the whole body
    core_strain, jacket_strain : [-] largest effective plastic strain; 0 without a jacket
    hourglass_share : [-] largest energy of the hourglass control over the strike energy
    own_steps : most steps of its own in one of the run
    density_factor : [-] by which the densities were multiplied to give the mass
    rest, places : (nodes, 2) [m] r and z at rest and at the end
    corners : (elements, 4) nodes of the elements
    outline : (rings,) nodes of the surface, from the tip to the tail
    jacketed : (elements,) bool
    plastic : (elements,) effective plastic strain
    """

    t: np.ndarray
    tip: np.ndarray
    tail: np.ndarray
    centre: np.ndarray
    tip_velocity: np.ndarray
    tail_velocity: np.ndarray
    centre_velocity: np.ndarray
    width: float
    length: float
    width_at_rest: float
    length_at_rest: float
    plastic_energy: float
    core_strain: float
    jacket_strain: float
    hourglass_share: float
    own_steps: int
    density_factor: float
    rest: np.ndarray
    places: np.ndarray
    corners: np.ndarray
    outline: np.ndarray
    jacketed: np.ndarray
    plastic: np.ndarray


class MetalBody(Part):
    """A projectile of metal in a run.

    Parameters
    ----------
    shot : Projectile with the body metal
    share : of it that is in the model
    velocity : [m/s] along its axis
    plies : number of plies that it may touch; a block behind them besides
    """

    name = "metal"
    of_ply = False
    flight = motion_kernels.move_body

    def __init__(self, shot: Projectile, share: float, velocity: float, plies: int) -> None:
        drawing = shot.turned
        assert drawing is not None
        self.drawing = drawing
        self.shot = shot
        self.share = share
        self.velocity = velocity
        self.row = make_row(drawing, share, velocity, partners=plies + 1)
        self.motion = self.row.motion
        nose = shot.nose
        shared = self.row.profile
        self.noses = [
            nose._replace(profile=shared._replace(force=force)) for force in self.row.ring_force
        ]
        self.nose_of_block = self.noses[-1]

    def seen(self, const: Constants, ply: int) -> Constants:
        """Return the constants of a ply with the profile that it sees, see Part."""
        found: Constants = const._replace(nose=self.noses[ply])
        return found

    def as_it_is(self) -> tuple[FloatArray, FloatArray]:
        """Return its nodes (n, 2) [m], r and z with the foremost point at z = 0, and the effective
        plastic strain of its elements (m,)."""
        places = self.row.x.copy()
        places[:, 1] -= places[self.row.outline, 1].max()
        return places, self.row.alpha.copy()

    def rows(self) -> dict[str, Row]:
        """Return the rows of body and profile; the forces on the rings are in them, see Part."""
        return {"row": self.row, "profile": self.row.profile}

    def identity(self) -> tuple[Any, ...]:
        """Return what determines the body, see Part."""
        return self.name, self.drawing

    def energies(self) -> dict[str, float]:
        """Return the energies [J] of the body, see Part; viscosity counts as plastic."""
        row = self.row
        values = (
            float(row.kinetic_energy),
            float(row.elastic_energy + row.hourglass_energy),
            float(row.plastic_work + row.viscous_work),
        )
        return dict(zip(ENERGIES, values))

    def guard(self, state: State) -> tuple[str, str] | None:
        """Return what is wrong with the body, see Part."""
        row = self.row
        fault = int(row.fault)
        element = int(row.critical)
        if fault:
            where = self._where(element)
            if fault == motion_kernels.INSIDE_OUT:
                return "an element of the projectile is turned inside out", where
            steps = motion_kernels.MOST_OWN_STEPS
            return f"the projectile needs more than {steps} steps in one of the run", where
        if row.profile.widest > self.shot.reach_radius:
            return (
                f"the projectile is wider than {WIDEST:g} times its diameter at rest",
                "its widest ring",
            )
        return None

    def _where(self, element):
        r, z = 1e3 * self.drawing.places[self.drawing.corners[element]].mean(axis=0)
        strain = float(self.row.alpha[element])
        return f"the element at r = {r:.2f} mm, z = {z:.2f} mm at rest, plastic strain {strain:.2g}"

    def indicators(self) -> tuple[Indicator, ...]:
        """Return the strain of the jacket over that at which it would tear, and the share of the
        hourglass energy, see Part."""
        row = self.row
        strike = 0.5 * float(row.mass.sum()) * self.velocity**2
        found = [
            quality.indicator("projectile hourglass", float(row.most_hourglass_energy) / strike),
        ]
        jacket = self.drawing.jacket
        if jacket is not None:
            share = largest(row.alpha[row.jacketed]) / jacket.failure_strain
            found.append(quality.indicator("jacket strain", share))
        return tuple(found)

    def result(self, clock: FloatArray, steps: FloatArray) -> dict[str, Any]:
        """Return the body as it is and its history, see Part."""
        row = self.row
        strike = 0.5 * float(row.mass.sum()) * self.velocity**2
        named = {name: steps[:, BAR.index(name)] for name in BAR[len(RIGID) :]}
        rest = self.drawing.places[self.drawing.outline]
        found = MetalHistory(
            clock,
            **named,
            width=width(row),
            length=length(row),
            width_at_rest=2 * float(rest[:, 0].max()),
            length_at_rest=float(np.ptp(rest[:, 1])),
            plastic_energy=float(row.plastic_work) / self.share,
            core_strain=largest(row.alpha[~row.jacketed]),
            jacket_strain=largest(row.alpha[row.jacketed]),
            hourglass_share=float(row.most_hourglass_energy) / strike,
            own_steps=int(row.most_own_steps),
            density_factor=self.drawing.density_factor,
            rest=self.drawing.places,
            places=row.x.copy(),
            corners=self.drawing.corners,
            outline=self.drawing.outline,
            jacketed=row.jacketed.copy(),
            plastic=row.alpha.copy(),
        )
        return {"metal": found}


def largest(values: FloatArray) -> float:
    """Return the largest of some values, 0 of none."""
    return float(values.max(initial=0.0))


def make_bodies(pack: Any, consts: Any, velocity: float) -> tuple[Part, ...]:
    """Make the body of a projectile of metal that strikes a pack at a velocity [m/s]."""
    first = pack.plies[0]
    if first.shot.turned is None:
        return ()
    return (MetalBody(first.shot, first.share, velocity, len(pack.plies)),)
