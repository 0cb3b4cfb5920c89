"""What an impact leaves: scalars, histories, and the panel at the end, in one HDF5 file (histories.h5).

Layout: attributes of the root for scalars and texts; /histories, /energies, /reactions with one value an instant;
/panel with the shape and state at two instants; /measured, where a scene asks for it, with histories along yarns
(samples by elements or nodes), the forces on the edges (pull, lift) and the fronts; /bar, of an elastic projectile,
with the histories of tip, tail and centre of mass; /backing, of a block, with its quarter at the end. Every dataset has
the attribute "unit".
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields

import numpy as np

from fabrics.files import replace_whole
from weavecell.results import keys
from weavecell.results.hdf5_file import opened, plain, put
from weavecell.results.impact_groups import read_group, read_measured, write_group, write_measured

_FORMAT = 3
# attribute of the record: attribute of the file, and key of summary.json
SCALARS = {
    "title": "title",
    "fabric": "fabric",
    "law_name": "law_name",
    "strike_velocity": "strike_velocity_m_s",
    "outcome": "outcome",
    "residual_velocity": "residual_velocity_m_s",
    "mass": "projectile_mass_kg",
    "failure_message": "failure_message",
    "mirror_x": "mirror_x",
    "mirror_y": "mirror_y",
    "wall_time": "wall_time_s",
    "ns_per_element_step": "element_step_time_ns",
    "elements": "elements",
    "steps": "steps",
    "max_deflection": "max_deflection_m",
}
_SCALARS = SCALARS | {"rigid_check": "rigid_check"}
HISTORIES, _PANEL = keys.units(keys.HISTORIES), keys.units(keys.PANEL)
# datasets whose attribute in the object that holds them has another name
_SHAPE_FIELDS = {"time": "t"}


@dataclass(frozen=True)
class Shape:
    """The panel at one instant.

    Parameters
    ----------
    t, nose_position : [s, m] time, and the foremost point of the projectile
    projectile_position : (3,) [m] position of its nose
    nodes : (k, 3) [m]
    tension : (m, 2) [N] of warp and weft
    failed : (m, 3) bool: warp failed, weft failed, element eroded
    """

    t: float
    nose_position: float
    projectile_position: np.ndarray
    nodes: np.ndarray
    tension: np.ndarray
    failed: np.ndarray

    @classmethod
    def of(cls, shot):
        """The shape of a `shellfabric.output.snapshots.Snapshot`."""
        return cls(
            float(shot.t), float(shot.nose_position), shot.projectile_position, shot.nodes.reshape(-1, 3),
            shot.tension.reshape(-1, 2), shot.failed.reshape(-1, 3),
        )  # fmt: skip


class Audited:
    """What follows from the energy audit of an impact: of `mass`, `strike_velocity` and `energies`."""

    @property
    def strike_energy(self):
        """[J]"""
        return 0.5 * self.mass * self.strike_velocity**2

    @property
    def energy_error_max(self):
        """[-] largest error of the energy balance over the strike energy."""
        return float(np.max(np.abs(self.energies["error"]))) / self.strike_energy

    @property
    def absorbed_energy(self):
        """[J] energy that the projectile has lost."""
        return self.strike_energy - float(self.energies["kinetic_projectile"][-1])

    @property
    def viscous_energy_fraction(self):
        """[-] viscous energy at the end, over the energy absorbed."""
        return float(self.energies["viscous"][-1]) / self.absorbed_energy

    def audit(self):
        """The entries of the summary that follow from it."""
        return {
            "strike_energy_J": self.strike_energy,
            "absorbed_energy_J": self.absorbed_energy,
            "energy_error_max": self.energy_error_max,
            "viscous_energy_fraction": self.viscous_energy_fraction,
            "energies_at_end_J": {name: float(values[-1]) for name, values in self.energies.items()},
        }


@dataclass(frozen=True)
class ImpactRecord(Audited):
    """One impact, from strike to its end.

    Parameters
    ----------
    title, fabric, law_name : for the reader
    strike_velocity, residual_velocity : [m/s]; the residual velocity is that of the last instant, along the normal
    outcome : "stopped", "perforated", "in flight" or "unstable"
    mass : [kg] of the projectile
    failure_message : why an unstable run was ended; "" for others
    mirror_x, mirror_y : whether the panel below continues mirrored beyond x = 0, y = 0; energies and forces are those
        of the whole panel
    time, velocity, nose_position : (n,) [s, m/s, m] time, velocity of the projectile along the normal, foremost point
    failed_segments : (n,) number of failed yarn segments
    energies : {name: (n,)} [J], names of keys.ENERGIES
    reactions : {"warp", "weft": (n,)} [N] tension at the clamped end of the yarn nearest the impact point
    quads : (m, 4) node numbers
    strength : (2,) [N] of warp and weft
    projectile : (a, b, 3) [m] surface of the projectile about its nose, as it is drawn
    half_energy, final : Shape when the projectile had lost half of the energy that it lost (the snapshot nearest to
        it), and at the end
    wall_time, ns_per_element_step, elements, steps : cost of the run
    peak_tension : (2,) [N] of warp and weft over the run
    max_deflection : [m] of whole cloth over the run
    checks : tuple of shellfabric.panel.quality.Indicator
    rigid_check : whether a rigid projectile is justified, in words; "" where that is not known
    measured : shellfabric.output.histories.Histories, or None where nothing was to be recorded
    bar : shellfabric.projectile.dynamics.BarHistory of an elastic projectile, or None
    backing : shellfabric.backing.coupling.BackingResult, the block at the end, or None
    """

    title: str
    fabric: str
    law_name: str
    strike_velocity: float
    outcome: str
    residual_velocity: float
    mass: float
    failure_message: str
    mirror_x: bool
    mirror_y: bool
    wall_time: float
    ns_per_element_step: float
    elements: int
    steps: int
    time: np.ndarray
    velocity: np.ndarray
    nose_position: np.ndarray
    failed_segments: np.ndarray
    energies: dict
    reactions: dict
    quads: np.ndarray
    strength: np.ndarray
    projectile: np.ndarray
    half_energy: Shape
    final: Shape
    peak_tension: np.ndarray
    max_deflection: float
    checks: tuple = ()
    rigid_check: str = ""
    measured: object = None
    bar: object = None
    backing: object = None

    @classmethod
    def of(cls, result, title, law_name, message=""):
        """The record of a `shellfabric.impact.single_ply.ImpactResult`."""
        setup = result.setup
        mirror_x, mirror_y = result.mirrored
        last = Shape(
            float(result.t[-1]),
            float(result.nose_position[-1]),
            result.projectile_position,
            result.nodes,
            result.tension,
            result.failed,
        )
        return cls(
            title=title, fabric=setup.fabric.name, law_name=law_name, strike_velocity=setup.strike_velocity,
            outcome=result.outcome, residual_velocity=result.residual_velocity, mass=setup.projectile.mass,
            failure_message=message, mirror_x=mirror_x, mirror_y=mirror_y, projectile=drawn(setup.projectile),
            wall_time=result.wall_time, ns_per_element_step=result.ns_per_element_step,
            elements=result.panel.elements, steps=result.steps, time=result.t, velocity=result.v,
            nose_position=result.nose_position, failed_segments=result.failed_segments, energies=dict(result.energies),
            reactions=dict(result.reactions), quads=result.quads,
            strength=np.array([yarn.strength for yarn in setup.fabric.weave.yarns]),
            half_energy=_half_energy(result, last), final=last, measured=result.histories,
            peak_tension=np.array(result.peak_tension), max_deflection=result.max_deflection, checks=result.checks,
            rigid_check=str(result.rigidity or ""), bar=result.bar, backing=result.backing,
        )  # fmt: skip

    def summary(self):
        """The scalars of the record, and what follows from them, as a flat dict."""
        scalars = {key: getattr(self, name) for name, key in _SCALARS.items()}
        if self.bar is not None:
            scalars |= {"plastic_shortening_m": self.bar.shortening, "bar_period_s": self.bar.period}
        if self.backing is not None:
            scalars |= {"crater_depth_m": self.backing.depth, "crater_wall_angle_rad": self.backing.steepness}
        return scalars | {
            **stops(self),
            **tensions(self.peak_tension, self.strength),
            "failed_yarn_segments": int(self.failed_segments[-1]),
            **self.audit(),
        }

    def write(self, path):
        """Write the record, whole or not at all."""
        import h5py

        with replace_whole(path) as beside, h5py.File(beside, "w") as file:
            file.attrs["format"] = f"weavecell impact {_FORMAT}"
            for name, key in _SCALARS.items():
                file.attrs[key] = getattr(self, name)
            file.attrs["checks"] = store_checks(self.checks)
            for group, units in (("histories", HISTORIES), ("panel", _PANEL)):
                for name, unit in units.items():
                    put(file, f"{group}/{name}", getattr(self, name), unit)
            for shape in ("half_energy", "final"):
                write_shape(file, f"panel/{shape}", getattr(self, shape))
            for name, values in self.energies.items():
                put(file, f"energies/{name}", values, "J")
            for name, values in self.reactions.items():
                put(file, f"reactions/{name}", values, "N")
            if self.measured is not None:
                write_measured(file.create_group("measured"), self.measured)
            if self.bar is not None:
                write_group(file.create_group("bar"), self.bar, keys.BAR, ("period", "shortening"))
            if self.backing is not None:
                write_group(file.create_group("backing"), self.backing, keys.BACKING, ("face",))

    @classmethod
    def read(cls, path):
        """Read what `write` wrote; InputError if the file is not one of these."""
        with opened(path, "impact", _FORMAT) as file:
            values = {name: plain(file.attrs[key]) for name, key in _SCALARS.items()}
            values["checks"] = read_checks(file.attrs["checks"])
            values |= {name: file[f"histories/{name}"][()] for name in HISTORIES}
            values |= {name: file[f"panel/{name}"][()] for name in _PANEL}
            for shape in ("half_energy", "final"):
                values[shape] = read_shape(file[f"panel/{shape}"])
            for group in ("energies", "reactions"):
                values[group] = {name: data[()] for name, data in file[group].items()}
            values["measured"] = read_measured(file["measured"]) if "measured" in file else None
            values |= {name: read_group(file, name) for name in ("bar", "backing")}
        assert set(values) == {entry.name for entry in fields(cls)}
        return cls(**values)


def stops(record):
    """Entries of the summary: the time at the end, and that at which the projectile stopped, None if it did not."""
    end = float(record.time[-1])
    return {"end_time_s": end, "stop_time_s": end if record.outcome == "stopped" else None}


def tensions(peak, strength):
    """Entries of the summary: peak tensions (2,) [N] of warp and weft, and their shares of the strengths (2,) [N]."""
    found = {}
    for family, tension, limit in zip(("warp", "weft"), peak, strength):
        found[f"peak_tension_{family}_N"] = float(tension)
        found[f"peak_tension_{family}_over_strength"] = float(tension / limit)
    return found


def store_checks(checks):
    """Indicators as text, for an attribute of a file."""
    return json.dumps([asdict(one) for one in checks])


def read_checks(text):
    """The indicators that `store_checks` has written."""
    from shellfabric.panel.quality import Indicator

    return tuple(Indicator(**entry) for entry in json.loads(text))


def drawn(shot):
    """The projectile as it is drawn, set back by its edge radius.

    The flat elements of the cloth cut across the rounding that they lie on, and it would stick out between them.
    """
    return shot.surface(shot.edge_radius)


def _half_energy(result, last):
    """The shape nearest to the instant at which half of the energy lost had been lost."""
    kinetic = result.energies["kinetic_projectile"]
    lost = kinetic[0] - kinetic
    instant = result.t[int(np.argmax(lost >= 0.5 * lost[-1]))]
    shots = [shot for shot in result.snapshots if shot.t <= last.t]
    return Shape.of(min(shots, key=lambda shot: abs(shot.t - instant))) if shots else last


def write_shape(file, group, shape):
    """Write a Shape to a group of an open file."""
    for name, unit in keys.units(keys.SHAPE).items():
        put(file, f"{group}/{name}", getattr(shape, _SHAPE_FIELDS.get(name, name)), unit)


def read_shape(group):
    """The Shape that `write_shape` has written."""
    return Shape(**{_SHAPE_FIELDS.get(name, name): plain(group[name][()]) for name in keys.units(keys.SHAPE)})
