"""What an impact leaves: scalars, histories, and the panel at the end, in one HDF5 file (histories.h5).

Layout: attributes of the root for scalars and texts; /histories, /energies, /reactions with one value an instant;
/panel with the last shape and state. Every dataset has the attribute "unit".
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from fabrics.errors import InputError
from fabrics.files import replace_whole

_FORMAT = "weavecell impact 1"
_SCALARS = (
    "title", "fabric", "law_name", "strike_velocity", "outcome", "residual_velocity", "mass", "message",
    "mirror_x", "mirror_y", "radius", "wall_time", "ns_per_element_step", "elements", "steps",
)  # fmt: skip
_HISTORIES = {"t": "s", "v": "m/s", "z": "m", "failed": "1"}
_PANEL = {"nodes": "m", "quads": "1", "tension": "N", "strength": "N", "broken": "1"}


@dataclass(frozen=True)
class ImpactRecord:
    """One impact, from strike to its end.

    Parameters
    ----------
    title, fabric, law_name : for the reader
    strike_velocity, residual_velocity : [m/s]; the residual velocity is that of the last instant
    outcome : "stopped", "perforated", "in flight" or "unstable"
    mass, radius : [kg, m] of the projectile
    message : what went wrong, where something did
    mirror_x, mirror_y : whether the panel below continues mirrored beyond x = 0, y = 0; energies and forces are those
        of the whole panel
    t, v, z : (n,) [s, m/s, m] time, velocity and position of the projectile
    failed : (n,) number of failed yarn segments
    energies : {name: (n,)} [J]
    reactions : {"warp", "weft": (n,)} [N] of the clamped ends
    nodes, quads : (k, 3) [m], (m, 4) the panel at the end
    tension : (m, 2) [N] of warp and weft
    strength : (2,) [N]
    broken : (m, 2) bool, whether the yarn has failed
    wall_time, ns_per_element_step, elements, steps : cost of the run
    """

    title: str
    fabric: str
    law_name: str
    strike_velocity: float
    outcome: str
    residual_velocity: float
    mass: float
    message: str
    mirror_x: bool
    mirror_y: bool
    radius: float
    wall_time: float
    ns_per_element_step: float
    elements: int
    steps: int
    t: np.ndarray
    v: np.ndarray
    z: np.ndarray
    failed: np.ndarray
    energies: dict
    reactions: dict
    nodes: np.ndarray
    quads: np.ndarray
    tension: np.ndarray
    strength: np.ndarray
    broken: np.ndarray

    @property
    def strike_energy(self):
        """[J]"""
        return 0.5 * self.mass * self.strike_velocity**2

    @property
    def worst_balance(self):
        """[-] largest energy that the audit cannot place, over the strike energy."""
        return float(np.max(np.abs(self.energies["balance"]))) / self.strike_energy

    @property
    def absorbed(self):
        """[J] energy that the projectile has lost."""
        return self.strike_energy - 0.5 * self.mass * float(self.v[-1]) ** 2

    @property
    def numerical_share(self):
        """[-] hourglass and viscous energy at the end, over the energy absorbed."""
        return float(self.energies["hourglass"][-1] + self.energies["viscous"][-1]) / self.absorbed

    def write(self, path):
        """Write the record, whole or not at all."""
        import h5py

        with replace_whole(path) as beside, h5py.File(beside, "w") as file:
            file.attrs["format"] = _FORMAT
            for name in _SCALARS:
                file.attrs[name] = getattr(self, name)
            for group, units in (("histories", _HISTORIES), ("panel", _PANEL)):
                for name, unit in units.items():
                    _put(file, f"{group}/{name}", getattr(self, name), unit)
            for name, values in self.energies.items():
                _put(file, f"energies/{name}", values, "J")
            for name, values in self.reactions.items():
                _put(file, f"reactions/{name}", values, "N")

    @classmethod
    def read(cls, path):
        """Read what `write` wrote; InputError if the file is not one of these."""
        import h5py

        try:
            with h5py.File(path, "r") as file:
                if file.attrs.get("format") != _FORMAT:
                    raise InputError(file=path, key="format", value=file.attrs.get("format"), allowed=repr(_FORMAT))
                values = {name: _plain(file.attrs[name]) for name in _SCALARS}
                values |= {name: file[f"histories/{name}"][()] for name in _HISTORIES}
                values |= {name: file[f"panel/{name}"][()] for name in _PANEL}
                for group in ("energies", "reactions"):
                    values[group] = {name: data[()] for name, data in file[group].items()}
        except OSError as problem:
            raise InputError(f"is not a readable HDF5 file ({problem})", file=path) from None
        assert set(values) == {entry.name for entry in fields(cls)}
        return cls(**values)


def _put(file, name, values, unit):
    file.create_dataset(name, data=np.asarray(values)).attrs["unit"] = unit


def _plain(value):
    return value.item() if isinstance(value, np.generic) else value
