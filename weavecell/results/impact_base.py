"""What the records of an impact on one ply and on a pack share: their fields, their summary, and their HDF5 file.

Layout of the common part of the file: attributes of the root for scalars and texts; /histories and /energies with one
value an instant; /cuts with the section through the impact point at the instants of the snapshots. Every dataset has
the attribute "unit". What files of an earlier version lack is read as NaN, or as no cuts.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from fabrics.checks import FilePath
from fabrics.files import read_hdf5, write_hdf5
from weavecell.results import keys
from weavecell.results.hdf5_file import plain, put
from weavecell.results.impact_shapes import Peak, Shape, read_cuts, write_cuts

if TYPE_CHECKING:
    from shellfabric.impact.single_ply import ImpactSetup

FORMAT = 4  # version of the files
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
HISTORIES = keys.units(keys.HISTORIES)


@dataclass(frozen=True, kw_only=True)
class BaseRecord:
    """One impact, from strike to its end.

    A derived class gives `KIND`, the word in the format of its file, `OWN_SCALARS`, `_entries`, `_write` and `_read`.

    Parameters
    ----------
    title, fabric, law_name : for the reader
    strike_velocity, residual_velocity : [m/s]; the residual velocity is that of the last instant, along the
        normal, and 0 of a projectile that has stopped
    outcome : "stopped", "perforated", "in flight" or "unstable"
    mass : [kg] of the projectile
    failure_message : why an unstable run was ended; "" for others
    mirror_x, mirror_y : whether the panel continues mirrored beyond x = 0, y = 0; energies and forces are those of the
        whole panel, or of the whole pack
    wall_time, ns_per_element_step, elements, steps : cost of the run
    time, velocity, nose_position : (n,) [s, m/s, m] time, velocity of the projectile along the normal, foremost point
    contact_force : (n,) [N] on the projectile along the normal, against its flight; the mean since the time before
    deflection : (n,) [m] largest displacement of the cloth along the normal; of a pack, of its last ply
    failed_segments : (n,) number of failed yarn segments
    energies : {name: (n,)} [J], names of keys.ENERGIES
    strength, peak_tension : (2,) or (plies, 2) [N] of warp and weft, and over the run
    peak_tension_time, peak_tension_place : (2,) or (plies, 2) [s], and (2, 2) or (plies, 2, 2) [m] when, and where at
        rest along warp and weft from the impact point
    thickness : (plies,) [m]
    cuts : tuple of Cut
    projectile : (a, b, 3) [m] surface of the projectile about its nose, as it is drawn
    max_deflection : [m] largest entry of `deflection`
    checks : tuple of shellfabric.panel.quality.Indicator
    """

    KIND: ClassVar[str]
    OWN_SCALARS: ClassVar[dict] = {}

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
    contact_force: np.ndarray
    deflection: np.ndarray
    failed_segments: np.ndarray
    energies: dict
    strength: np.ndarray
    peak_tension: np.ndarray
    peak_tension_time: np.ndarray
    peak_tension_place: np.ndarray
    projectile: np.ndarray
    max_deflection: float
    thickness: np.ndarray
    cuts: tuple = ()
    checks: tuple = ()

    @classmethod
    def _of(cls, result: Any, setup: ImpactSetup, title: str, law_name: str, message: str, **own: Any) -> Self:
        """A record of an impact; `setup` is the `shellfabric.impact.single_ply.ImpactSetup`, `own` the other fields."""
        mirror_x, mirror_y = result.mirrored
        return cls(
            title=title, fabric=setup.fabric.name, law_name=law_name, strike_velocity=setup.strike_velocity,
            outcome=result.outcome, residual_velocity=result.residual_velocity, mass=setup.projectile.mass,
            failure_message=message, mirror_x=mirror_x, mirror_y=mirror_y, wall_time=result.wall_time,
            ns_per_element_step=result.ns_per_element_step, steps=result.steps, time=result.t, velocity=result.v,
            nose_position=result.nose_position, contact_force=result.contact_force, deflection=result.deflection,
            failed_segments=result.failed_segments, energies=dict(result.energies),
            peak_tension=np.array(result.peak_tension), peak_tension_time=result.peak_tension_time,
            peak_tension_place=result.peak_tension_place, projectile=_drawn(setup.projectile),
            max_deflection=result.max_deflection, checks=result.checks, **own,
        )  # fmt: skip

    @property
    def strike_energy(self) -> float:
        """[J]"""
        return 0.5 * self.mass * self.strike_velocity**2

    @property
    def energy_error_max(self) -> float:
        """[-] largest error of the energy balance over the strike energy."""
        return float(np.max(np.abs(self.energies["error"]))) / self.strike_energy

    @property
    def absorbed_energy(self) -> float:
        """[J] energy that the projectile has lost."""
        return self.strike_energy - float(self.energies["kinetic_projectile"][-1])

    @property
    def viscous_energy_fraction(self) -> float:
        """[-] viscous energy at the end, over the energy absorbed."""
        return float(self.energies["viscous"][-1]) / self.absorbed_energy

    @property
    def drawn_shapes(self) -> tuple[Shape, Shape]:
        """Shapes of the last ply: one for the whole panel, and that at the end."""
        raise NotImplementedError

    @property
    def rear_quads(self) -> np.ndarray:
        """(m, 4) node numbers of the elements of the last ply."""
        raise NotImplementedError

    @property
    def rear_strength(self) -> np.ndarray:
        """(2,) [N] strength of warp and weft of the last ply."""
        return np.atleast_2d(self.strength)[-1]

    @property
    def peaks(self) -> dict[str, Peak]:
        """{"warp", "weft": Peak} the highest tension of each family over all plies."""
        tension, strength, time = (
            np.atleast_2d(getattr(self, name)) for name in ("peak_tension", "strength", "peak_tension_time")
        )
        place = self.peak_tension_place.reshape(len(time), 2, 2)
        found = {}
        for family, name in enumerate(("warp", "weft")):
            ply = int(np.argmax(tension[:, family]))
            at = ply, family
            found[name] = Peak(
                float(tension[at]), float(tension[at] / strength[at]), float(time[at]), place[at], ply + 1
            )
        return found

    def audit(self) -> dict[str, Any]:
        """The entries of the summary that follow from it."""
        return _peak_entries(self) | {
            "peak_contact_force_N": _known(self.contact_force.max()),
            "strike_energy_J": self.strike_energy,
            "absorbed_energy_J": self.absorbed_energy,
            "energy_error_max": self.energy_error_max,
            "viscous_energy_fraction": self.viscous_energy_fraction,
            "energies_at_end_J": {name: float(values[-1]) for name, values in self.energies.items()},
        }

    def summary(self) -> dict[str, Any]:
        """The scalars of the record, and what follows from them, as a flat dict."""
        scalars = {key: getattr(self, name) for name, key in self._scalars().items()}
        return scalars | _stops(self) | self._entries() | self.audit()

    def write(self, path: FilePath) -> None:
        """Write the record, whole or not at all."""
        with write_hdf5(path, f"weavecell {self.KIND} {FORMAT}") as file:
            for name, key in self._scalars().items():
                file.attrs[key] = getattr(self, name)
            file.attrs["checks"] = _store_checks(self.checks)
            for name, unit in HISTORIES.items():
                put(file, f"histories/{name}", getattr(self, name), unit)
            write_cuts(file, self.cuts)
            for name, values in self.energies.items():
                put(file, f"energies/{name}", values, "J")
            self._write(file)

    @classmethod
    def read(cls, path: FilePath) -> Self:
        """Read what `write` wrote; InputError if the file is not one of these."""
        with read_hdf5(path, f"weavecell {cls.KIND} {FORMAT}") as file:
            values = {name: plain(file.attrs[key]) for name, key in cls._scalars().items()}
            values["checks"] = _read_checks(file.attrs["checks"])
            values |= {name: file[f"histories/{name}"][()] for name in HISTORIES}
            values["cuts"] = read_cuts(file)
            values["energies"] = {name: data[()] for name, data in file["energies"].items()}
            return cls(**values, **cls._read(file))

    def _entries(self) -> dict[str, Any]:
        """Further entries of the summary."""
        raise NotImplementedError

    def _write(self, file: Any) -> None:
        """Write what the common part does not hold to the open file."""
        raise NotImplementedError

    @staticmethod
    def _read(file: Any) -> dict[str, Any]:
        """{field: value} of what `_write` wrote."""
        raise NotImplementedError

    @classmethod
    def _scalars(cls) -> dict[str, str]:
        """{field: attribute of the file and key of summary.json}."""
        return SCALARS | cls.OWN_SCALARS


def _stops(record):
    """Entries of the summary: the time at the end, and that at which the projectile stopped, None if it did not."""
    end = float(record.time[-1])
    return {"end_time_s": end, "stop_time_s": end if record.outcome == "stopped" else None}


def _peak_entries(record):
    """Entries of the summary on the peak tensions."""
    found = {}
    for family, peak in record.peaks.items():
        name = f"peak_tension_{family}"
        found |= {f"{name}_N": peak.tension, f"{name}_over_strength": peak.share, f"{name}_time_s": _known(peak.time)}
        found |= {f"{name}_place_m": [_known(x) for x in peak.place], f"{name}_ply": peak.ply}
    return found


def _known(value):
    """A number, or None for JSON where it is NaN."""
    return float(value) if np.isfinite(value) else None


def _store_checks(checks):
    """Indicators as text, for an attribute of a file."""
    return json.dumps([asdict(one) for one in checks])


def _read_checks(text):
    """The indicators that `_store_checks` has written."""
    from shellfabric.panel.quality import Indicator

    return tuple(Indicator(**entry) for entry in json.loads(text))


def _drawn(shot):
    """The projectile as it is drawn, set back by its edge radius.

    The flat elements of the cloth cut across the rounding that they lie on, and it would stick out between them.
    """
    return shot.surface(shot.edge_radius)
