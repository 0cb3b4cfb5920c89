"""What an impact on a pack of plies leaves: scalars, histories, every ply at the end, in one HDF5 file (histories.h5).

Layout: attributes of the root for scalars and texts; /histories and /energies with one value an instant; /plies with
one row a ply, or one column a ply in its histories; /shapes/00, 01, ... with a ply's shape and state at the end and the
node numbers of its elements; /cuts with the section of the pack through the impact point at the instants of the
snapshots; /measured/00, 01, ..., where a scene asks for it, with each ply's histories as in
`results.impact`. Every dataset has the attribute "unit". Nodes count from the middle surface of the first ply at rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fabrics.files import replace_whole
from weavecell.results import keys
from weavecell.results.hdf5_file import opened, plain, put
from weavecell.results.impact import (
    HISTORIES,
    SCALARS,
    Audited,
    Shape,
    drawn,
    read_checks,
    read_shape,
    stops,
    store_checks,
    tensions,
    write_shape,
)
from weavecell.results.impact_groups import read_measured, write_measured

_FORMAT = 3
_SCALARS = SCALARS | {"stacking": "stacking"}
_PLY_UNITS, _PLIES = keys.units(keys.PLY_HISTORIES), keys.units(keys.PLIES)


@dataclass(frozen=True)
class Cut:
    """The pack cut open along x through the impact point, at one instant.

    Parameters
    ----------
    t, nose : [s, m] time, and the foremost point of the projectile
    lines : tuple of (n, 2) [m] places x and z of each ply's middle surface; not a number where its yarn has failed
    """

    t: float
    nose: float
    lines: tuple


@dataclass(frozen=True)
class PackRecord(Audited):
    """One impact on a pack, from strike to its end.

    Parameters
    ----------
    title .. steps : as results.impact.ImpactRecord; energies and forces are those of the whole pack
    stacking : "aligned" or "alternating"
    time, velocity, nose_position, failed_segments : (n,) of the projectile; number of failed yarn segments
    energies : {name: (n,)} [J], names of keys.ENERGIES
    plies : {name: (n, plies)} with the names of shellfabric.panel.solver.PLY_SAMPLES
    z_rest, thickness : (plies,) [m] middle surfaces at rest, and thickness
    gaps : (plies - 1,) [m]
    strength, peak_tension : (plies, 2) [N] of each ply's warp and weft
    max_penetration_ratio : (plies - 1,) [-] deepest penetration of a ply into the next, over the thickness
    torn_contact : (2,) [-] impulses that kept torn cloth from passing through another ply, and passages despite them
    projectile : (a, b, 3) [m] its surface about the nose
    shapes, quads : of each ply at the end: Shape, and (m, 4) node numbers
    cuts : tuple of Cut
    max_deflection : [m] of the whole cloth of any ply, from its own plane, over the run
    checks : tuple of shellfabric.panel.quality.Indicator
    measured : tuple of shellfabric.output.histories.Histories of each ply; empty where nothing was to be recorded
    """

    title: str
    fabric: str
    law_name: str
    strike_velocity: float
    outcome: str
    residual_velocity: float
    mass: float
    failure_message: str
    stacking: str
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
    plies: dict
    z_rest: np.ndarray
    thickness: np.ndarray
    gaps: np.ndarray
    strength: np.ndarray
    peak_tension: np.ndarray
    max_penetration_ratio: np.ndarray
    torn_contact: np.ndarray
    projectile: np.ndarray
    shapes: tuple
    quads: tuple
    cuts: tuple
    max_deflection: float
    checks: tuple = ()
    measured: tuple = ()

    @property
    def count(self):
        """Number of plies."""
        return len(self.z_rest)

    @classmethod
    def of(cls, result, title, law_name, message=""):
        """The record of a `shellfabric.impact.pack.PackResult`."""
        from shellfabric.output.snapshots import quads

        ply, pack = result.setup.ply, result.pack
        mirror_x, mirror_y = result.mirrored
        before = [shots for shots in result.snapshots if shots[0].t < result.last[0].t]
        return cls(
            title=title, fabric=ply.fabric.name, law_name=law_name, strike_velocity=ply.strike_velocity,
            outcome=result.outcome, residual_velocity=result.residual_velocity, mass=ply.projectile.mass,
            failure_message=message, stacking=result.setup.stacking, mirror_x=mirror_x, mirror_y=mirror_y,
            wall_time=result.wall_time, ns_per_element_step=result.ns_per_element_step, elements=pack.elements,
            steps=result.steps, time=result.t, velocity=result.v, nose_position=result.nose_position,
            failed_segments=result.failed_segments, energies=dict(result.energies), plies=dict(result.plies),
            z_rest=pack.places,
            thickness=np.array([one.weave.thickness for one in pack.plies]), gaps=np.array(pack.gaps),
            strength=np.array([[yarn.strength for yarn in one.weave.yarns] for one in pack.plies]),
            peak_tension=result.peak_tension, max_penetration_ratio=result.deepest,
            torn_contact=result.held_apart, projectile=drawn(ply.projectile),
            shapes=tuple(Shape.of(shot) for shot in result.last), quads=tuple(quads(one) for one in pack.plies),
            cuts=tuple(_cut(shots, mirror_y) for shots in (*before, result.last)),
            max_deflection=result.max_deflection, checks=result.checks, measured=result.histories,
        )  # fmt: skip

    def summary(self):
        """The scalars of the record, and what follows from them, as a flat dict."""
        scalars = {key: getattr(self, name) for name, key in _SCALARS.items()}
        return scalars | {
            "plies": self.count,
            "ply_gap_m": float(self.gaps[0]),
            **stops(self),
            **tensions(self.peak_tension.max(axis=0), self.strength.max(axis=0)),
            "failed_yarn_segments": self.plies["failed_yarns"][-1].tolist(),
            "peak_tension_over_strength": (self.peak_tension / self.strength).max(axis=1).tolist(),
            "ply_energies_J": self.plies["energy"][-1].tolist(),
            "max_penetration_ratio": float(self.max_penetration_ratio.max()),
            "torn_corrections": int(self.torn_contact[0]),
            "torn_unresolved": int(self.torn_contact[1]),
            **self.audit(),
        }

    def write(self, path):
        """Write the record, whole or not at all."""
        import h5py

        with replace_whole(path) as beside, h5py.File(beside, "w") as file:
            file.attrs["format"] = f"weavecell pack {_FORMAT}"
            for name, key in _SCALARS.items():
                file.attrs[key] = getattr(self, name)
            file.attrs["checks"] = store_checks(self.checks)
            for name, unit in HISTORIES.items():
                put(file, f"histories/{name}", getattr(self, name), unit)
            for name, values in self.energies.items():
                put(file, f"energies/{name}", values, "J")
            for name, values in self.plies.items():
                put(file, f"plies/histories/{name}", values, _PLY_UNITS[name])
            for name, unit in _PLIES.items():
                put(file, f"plies/{name}", getattr(self, name), unit)
            put(file, "projectile", self.projectile, "m")
            for number, (shape, quads) in enumerate(zip(self.shapes, self.quads)):
                put(file, f"shapes/{number:02d}/quads", quads, "1")
                write_shape(file, f"shapes/{number:02d}", shape)
            for number, cut in enumerate(self.cuts):
                put(file, f"cuts/{number:04d}/time", cut.t, "s")
                put(file, f"cuts/{number:04d}/nose_position", cut.nose, "m")
                for ply, line in enumerate(cut.lines):
                    put(file, f"cuts/{number:04d}/lines/{ply:02d}", line, "m")
            for ply, measured in enumerate(self.measured):
                write_measured(file.create_group(f"measured/{ply:02d}"), measured)

    @classmethod
    def read(cls, path):
        """Read what `write` wrote; InputError if the file is not one of these."""
        with opened(path, "pack", _FORMAT) as file:
            values = {name: plain(file.attrs[key]) for name, key in _SCALARS.items()}
            values["checks"] = read_checks(file.attrs["checks"])
            values |= {name: file[f"histories/{name}"][()] for name in HISTORIES}
            values["energies"] = {name: data[()] for name, data in file["energies"].items()}
            values["plies"] = {name: data[()] for name, data in file["plies/histories"].items()}
            values |= {name: file[f"plies/{name}"][()] for name in _PLIES}
            values["projectile"] = file["projectile"][()]
            values["measured"] = tuple(read_measured(group) for _, group in sorted(file.get("measured", {}).items()))
            shapes = [group for _, group in sorted(file["shapes"].items())]
            values["quads"] = tuple(group["quads"][()] for group in shapes)
            values["shapes"] = tuple(map(read_shape, shapes))
            values["cuts"] = tuple(_read_cut(group) for _, group in sorted(file["cuts"].items()))
        return cls(**values)


def _read_cut(group):
    lines = tuple(line[()] for _, line in sorted(group["lines"].items()))
    return Cut(float(group["time"][()]), float(group["nose_position"][()]), lines)


def _cut(shots, mirror_y):
    lines = []
    for shot in shots:
        j = 0 if mirror_y else shot.nodes.shape[1] // 2
        line, gone = shot.nodes[:, j, [0, 2]], np.flatnonzero(shot.failed[:, j, 0])
        lines.append(np.insert(line, gone + 1, np.nan, axis=0))
    return Cut(float(shots[0].t), float(shots[0].nose_position), tuple(lines))
