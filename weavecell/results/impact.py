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

from fabrics.errors import InputError
from fabrics.files import replace_whole

_FORMAT = "weavecell impact 2"
_SCALARS = (
    "title", "fabric", "law_name", "strike_velocity", "outcome", "residual_velocity", "mass", "message",
    "mirror_x", "mirror_y", "wall_time", "ns_per_element_step", "elements", "steps", "rigidity", "max_deflection",
)  # fmt: skip
_HISTORIES = {"t": "s", "v": "m/s", "z": "m", "failed": "1"}
_PANEL = {"quads": "1", "strength": "N", "projectile": "m", "peak_tension": "N"}
_YARN = ("family", "offset", "EA", "strength", "crimp")
_YARN_HISTORIES = {"X": "m", "tension": "N", "place": "m", "deflection": "m"}
_BAR = {
    "t": "s", "tip": "m", "tail": "m", "centre": "m", "tip_velocity": "m/s", "tail_velocity": "m/s",
    "centre_velocity": "m/s",
}  # fmt: skip
_BACKING = {"crater": "m", "crater_weft": "m", "nodes": "m", "bricks": "1", "plastic": "1", "gone": "1"}
_PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
SHAPE = {"t": "s", "z": "m", "nose": "m", "nodes": "m", "tension": "N", "broken": "1"}


@dataclass(frozen=True)
class Shape:
    """The panel at one instant.

    Parameters
    ----------
    t, z : [s, m] time, and the foremost point of the projectile
    nose : (3,) [m] place of its nose
    nodes : (k, 3) [m]
    tension : (m, 2) [N] of warp and weft
    broken : (m, 3) bool: warp failed, weft failed, element eroded
    """

    t: float
    z: float
    nose: np.ndarray
    nodes: np.ndarray
    tension: np.ndarray
    broken: np.ndarray

    @classmethod
    def of(cls, shot):
        """The shape of a `shellfabric.output.snapshots.Snapshot`."""
        return cls(
            float(shot.t), float(shot.z), shot.nose, shot.nodes.reshape(-1, 3), shot.tension.reshape(-1, 2),
            shot.broken.reshape(-1, 3),
        )  # fmt: skip


class Audited:
    """What follows from the energy audit of an impact: of `mass`, `strike_velocity` and `energies`."""

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
        return self.strike_energy - float(self.energies["kinetic_projectile"][-1])

    @property
    def numerical_share(self):
        """[-] viscous energy at the end, over the energy absorbed."""
        return float(self.energies["viscous"][-1]) / self.absorbed


@dataclass(frozen=True)
class ImpactRecord(Audited):
    """One impact, from strike to its end.

    Parameters
    ----------
    title, fabric, law_name : for the reader
    strike_velocity, residual_velocity : [m/s]; the residual velocity is that of the last instant, along the normal
    outcome : "stopped", "perforated", "in flight" or "unstable"
    mass : [kg] of the projectile
    message : what went wrong, where something did
    mirror_x, mirror_y : whether the panel below continues mirrored beyond x = 0, y = 0; energies and forces are those
        of the whole panel
    t, v, z : (n,) [s, m/s, m] time, velocity of the projectile along the normal, and its foremost point
    failed : (n,) number of failed yarn segments
    energies : {name: (n,)} [J]
    reactions : {"warp", "weft": (n,)} [N] tension at the clamped end of the yarn nearest the impact point
    quads : (m, 4) node numbers
    strength : (2,) [N] of warp and weft
    projectile : (a, b, 3) [m] surface of the projectile about its nose, as it is drawn
    middle, last : Shape when the projectile had lost half of the energy that it lost (the snapshot nearest to it), and
        at the end
    wall_time, ns_per_element_step, elements, steps : cost of the run
    peak_tension : (2,) [N] of warp and weft over the run
    max_deflection : [m] of whole cloth over the run
    checks : tuple of shellfabric.panel.quality.Indicator
    rigidity : whether a rigid projectile was enough, in words; "" where that is not known
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
    message: str
    mirror_x: bool
    mirror_y: bool
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
    quads: np.ndarray
    strength: np.ndarray
    projectile: np.ndarray
    middle: Shape
    last: Shape
    peak_tension: np.ndarray
    max_deflection: float
    checks: tuple = ()
    rigidity: str = ""
    measured: object = None
    bar: object = None
    backing: object = None

    @classmethod
    def of(cls, result, title, law_name, message=""):
        """The record of a `shellfabric.impact.single_ply.ImpactResult`."""
        setup = result.setup
        mirror_x, mirror_y = result.mirrored
        last = Shape(float(result.t[-1]), float(result.z[-1]), result.nose, result.nodes, result.tension, result.broken)
        return cls(
            title=title, fabric=setup.fabric.name, law_name=law_name, strike_velocity=setup.strike_velocity,
            outcome=result.outcome, residual_velocity=result.residual_velocity, mass=setup.projectile.mass,
            message=message, mirror_x=mirror_x, mirror_y=mirror_y,
            projectile=drawn(setup.projectile),
            wall_time=result.wall_time, ns_per_element_step=result.ns_per_element_step,
            elements=result.panel.elements, steps=result.steps, t=result.t, v=result.v, z=result.z,
            failed=result.failed, energies=dict(result.energies), reactions=dict(result.reactions),
            quads=result.quads, strength=np.array([yarn.strength for yarn in setup.fabric.weave.yarns]),
            middle=_middle(result, last), last=last, measured=result.histories,
            peak_tension=np.array(result.peak_tension), max_deflection=result.max_deflection, checks=result.checks,
            rigidity=str(result.rigidity or ""), bar=result.bar, backing=result.backing,
        )  # fmt: skip

    def summary(self):
        """The scalars of the record, and what follows from them, as a flat dict."""
        scalars = {name: getattr(self, name) for name in _SCALARS}
        if self.bar is not None:
            scalars |= {"plastic_shortening": self.bar.shortening, "bar_period": self.bar.period}
        if self.backing is not None:
            scalars |= {"crater_depth": self.backing.depth, "crater_wall_angle": self.backing.steepness}
        return scalars | {
            "end_time": float(self.t[-1]),
            **stops(self),
            **tensions(self.peak_tension, self.strength),
            "failed_yarn_segments": int(self.failed[-1]),
            "strike_energy": self.strike_energy,
            "absorbed": self.absorbed,
            "worst_balance": self.worst_balance,
            "numerical_share": self.numerical_share,
            "energies_at_end": {name: float(values[-1]) for name, values in self.energies.items()},
        }

    def write(self, path):
        """Write the record, whole or not at all."""
        import h5py

        with replace_whole(path) as beside, h5py.File(beside, "w") as file:
            file.attrs["format"] = _FORMAT
            for name in _SCALARS:
                file.attrs[name] = getattr(self, name)
            file.attrs["checks"] = store_checks(self.checks)
            for group, units in (("histories", _HISTORIES), ("panel", _PANEL)):
                for name, unit in units.items():
                    put(file, f"{group}/{name}", getattr(self, name), unit)
            for shape in ("middle", "last"):
                for name, unit in SHAPE.items():
                    put(file, f"panel/{shape}/{name}", getattr(getattr(self, shape), name), unit)
            for name, values in self.energies.items():
                put(file, f"energies/{name}", values, "J")
            for name, values in self.reactions.items():
                put(file, f"reactions/{name}", values, "N")
            if self.measured is not None:
                write_measured(file.create_group("measured"), self.measured)
            if self.bar is not None:
                _write_group(file.create_group("bar"), self.bar, _BAR, ("period", "shortening"))
            if self.backing is not None:
                _write_group(file.create_group("backing"), self.backing, _BACKING, ("face",))

    @classmethod
    def read(cls, path):
        """Read what `write` wrote; InputError if the file is not one of these."""
        import h5py

        try:
            with h5py.File(path, "r") as file:
                if file.attrs.get("format") != _FORMAT:
                    raise InputError(file=path, key="format", value=file.attrs.get("format"), allowed=repr(_FORMAT))
                values = {name: plain(file.attrs[name]) for name in _SCALARS}
                values["checks"] = read_checks(file.attrs["checks"])
                values |= {name: file[f"histories/{name}"][()] for name in _HISTORIES}
                values |= {name: file[f"panel/{name}"][()] for name in _PANEL}
                for shape in ("middle", "last"):
                    values[shape] = Shape(**{name: plain(file[f"panel/{shape}/{name}"][()]) for name in SHAPE})
                for group in ("energies", "reactions"):
                    values[group] = {name: data[()] for name, data in file[group].items()}
                values["measured"] = read_measured(file["measured"]) if "measured" in file else None
                values |= {name: _read_group(file, name) for name in ("bar", "backing")}
        except OSError as problem:
            raise InputError(f"is not a readable HDF5 file ({problem})", file=path) from None
        assert set(values) == {entry.name for entry in fields(cls)}
        return cls(**values)


def stops(record):
    """Entries of the summary: the time at which the projectile stopped, None if it did not, and the deflection."""
    stop = float(record.t[-1]) if record.outcome == "stopped" else None
    return {"stop_time_s": stop, "max_deflection_m": float(record.max_deflection)}


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


def _middle(result, last):
    """The shape nearest to the instant at which half of the energy lost had been lost."""
    kinetic = result.energies["kinetic_projectile"]
    lost = kinetic[0] - kinetic
    instant = result.t[int(np.argmax(lost >= 0.5 * lost[-1]))]
    shots = [shot for shot in result.snapshots if shot.t <= last.t]
    return Shape.of(min(shots, key=lambda shot: abs(shot.t - instant))) if shots else last


def _write_group(group, source, units, scalars):
    """Arrays and scalars of an object, by name."""
    for name in scalars:
        group.attrs[name] = getattr(source, name)
    for name, unit in units.items():
        put(group, name, getattr(source, name), unit, **_PACKED)


def _read_group(file, name):
    """What `_write_group` wrote of a bar or a backing; None where the file has none."""
    from shellfabric.backing.coupling import BackingResult
    from shellfabric.projectile.dynamics import BarHistory

    if name not in file:
        return None
    kind, units = {"bar": (BarHistory, _BAR), "backing": (BackingResult, _BACKING)}[name]
    group = file[name]
    return kind(**{key: group[key][()] for key in units}, **{key: plain(value) for key, value in group.attrs.items()})


def write_measured(group, measured):
    """Histories of one ply, and the fronts read off them, which are for the reader alone."""
    from shellfabric.output.wave_fronts import fronts

    put(group, "t", measured.t, "s")
    for number, yarn in enumerate(measured.yarns):
        inner = group.create_group(f"yarns/{number:03d}-{yarn.family}")
        for name in _YARN:
            inner.attrs[name] = getattr(yarn, name)
        for name, unit in _YARN_HISTORIES.items():
            put(inner, name, getattr(yarn, name), unit, **_PACKED)
        put(inner, "strain", yarn.strain, "1", **_PACKED)
    for name, forces in measured.edges.items():
        put(group, f"edges/{name}", forces, "N")
    for front in fronts(measured):
        inner = group.create_group(f"fronts/{front.family}-{front.kind}")
        inner.attrs["speed"], inner.attrs["interval"], inner.attrs["start"] = front.speed, front.interval, front.start
        put(inner, "time", front.time, "s")
        put(inner, "place", front.place, "m")


def read_measured(group):
    """What `write_measured` wrote."""
    from shellfabric.output.histories import EDGES, Histories, YarnHistory

    yarns = tuple(
        YarnHistory(
            **{name: plain(inner.attrs[name]) for name in _YARN}, **{name: inner[name][()] for name in _YARN_HISTORIES}
        )
        for _, inner in sorted(group.get("yarns", {}).items())
    )
    return Histories(group["t"][()], yarns, {name: group[f"edges/{name}"][()] for name in EDGES})


def put(file, name, values, unit, **packing):
    """Write an array to an open HDF5 file, with its unit."""
    file.create_dataset(name, data=np.asarray(values), **packing).attrs["unit"] = unit


def plain(value):
    return value.item() if isinstance(value, np.generic) else value
