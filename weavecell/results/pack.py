"""What an impact on a pack of plies leaves, in one HDF5 file (histories.h5): scalars, histories, every ply at the end.

Layout, besides the common part (`results.impact_base`): /plies with one row a ply, or one column a ply in its
histories; /shapes/00, 01, ... with a ply's shape and state at the end and the node numbers of its elements;
/measured/00, 01, ..., where a scene asks for it, with each ply's histories as in `results.impact`. Nodes count from the
middle surface of the first ply at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fabrics.ply_law import SOLID_TRAVEL
from weavecell.results import keys
from weavecell.results.hdf5_file import put
from weavecell.results.impact_base import BaseRecord
from weavecell.results.impact_groups import SLIP, read_group, read_measured, write_group, write_measured
from weavecell.results.impact_shapes import Cut, Shape, read_shape, write_shape

if TYPE_CHECKING:
    from shellfabric.impact.pack import PackResult

_PLY_UNITS, _PLIES = keys.units(keys.PLY_HISTORIES), keys.units(keys.PLIES)


@dataclass(frozen=True, kw_only=True)
class PackRecord(BaseRecord):
    """One impact on a pack; further fields as in `BaseRecord`.

    Parameters
    ----------
    stacking : "aligned" or "alternating"
    ply_contact_source, ply_contact_status : of the contact law of plies
    ply_contact_travel : [m] its closure before solid fibre is pressed
    plies : {name: (n, plies)} with the names of shellfabric.panel.solver.PLY_SAMPLES
    z_rest : (plies,) [m] middle surfaces at rest
    gaps : (plies - 1,) [m]
    gap_low, gap_high, gap_source : [m, m, -] range of the first of them, and where it comes from
    max_penetration_ratio : (plies - 1,) [-] deepest penetration of a ply into the next, over the thickness
    torn_contact : (2,) [-] impulses that kept torn cloth from passing through another ply, and passages despite them
    shapes, quads : of each ply at the end: Shape, and (m, 4) node numbers
    measured : tuple of shellfabric.output.histories.Histories of each ply; empty where nothing was to be recorded
    slips : (plies,) shellfabric.sliding.solver.SlipSummary of sliding crossovers; empty of pinned ones
    """

    KIND = "pack"
    OWN_SCALARS = {  # noqa: RUF012
        "stacking": "stacking",
        "gap_low": "ply_gap_low_m",
        "gap_high": "ply_gap_high_m",
        "gap_source": "ply_gap_source",
        "ply_contact_source": "ply_contact_source",
        "ply_contact_status": "ply_contact_status",
        "ply_contact_travel": "ply_contact_travel_m",
    }

    stacking: str
    gap_low: float
    gap_high: float
    gap_source: str
    ply_contact_source: str
    ply_contact_status: str
    ply_contact_travel: float
    plies: dict
    z_rest: np.ndarray
    gaps: np.ndarray
    max_penetration_ratio: np.ndarray
    torn_contact: np.ndarray
    shapes: tuple
    quads: tuple
    measured: tuple = ()
    slips: tuple = ()

    @property
    def contact_words(self) -> str:
        """The contact law of plies, for the reader."""
        words = f"contact of plies: {self.ply_contact_source} ({self.ply_contact_status})"
        if self.ply_contact_travel <= SOLID_TRAVEL:
            return words
        return f"{words}, travel {1e6 * self.ply_contact_travel:.3g} um, then solid fibre"

    @property
    def gap_words(self) -> str:
        """The gap between plies at rest, its range and its source in one line."""
        span = f" ({1e3 * self.gap_low:.3g} .. {1e3 * self.gap_high:.3g} mm)" if self.gap_high > self.gap_low else ""
        return f"ply gap {1e3 * self.gaps[0]:.3g} mm{span}, {self.gap_source}"

    @property
    def count(self) -> int:
        """Number of plies."""
        return len(self.z_rest)

    @property
    def drawn_shapes(self) -> tuple[Shape, Shape]:
        """See BaseRecord."""
        return self.shapes[-1], self.shapes[-1]

    @property
    def rear_quads(self) -> np.ndarray:
        """See BaseRecord."""
        return self.quads[-1]

    @classmethod
    def of(cls, result: PackResult, title: str, law_name: str, message: str = "") -> PackRecord:
        """The record of a `shellfabric.impact.pack.PackResult`."""
        from shellfabric.output.snapshots import quads
        from shellfabric.plies.gap import PlyGap, ply_gap

        given = result.setup.gap
        pack, (_, mirror_y) = result.pack, result.mirrored
        before = [shots for shots in result.snapshots if shots[0].t < result.last[0].t]
        law = pack.laws[0]
        gap = ply_gap(result.setup.ply.fabric, law) if given is None else PlyGap(given, given, given, "given")
        return cls._of(
            result, result.setup.ply, title, law_name, message, elements=pack.elements,
            strength=np.array([[yarn.strength for yarn in one.weave.yarns] for one in pack.plies]),
            stacking=result.setup.stacking, ply_contact_source=law.source, ply_contact_status=law.status,
            ply_contact_travel=law.travel, plies=dict(result.plies), z_rest=pack.places,
            thickness=np.array([one.weave.thickness for one in pack.plies]), gaps=np.array(pack.gaps),
            gap_low=gap.low, gap_high=gap.high, gap_source=gap.source,
            max_penetration_ratio=result.deepest, torn_contact=result.held_apart,
            shapes=tuple(Shape.of(shot) for shot in result.last), quads=tuple(quads(one) for one in pack.plies),
            cuts=tuple(Cut.of(shots, mirror_y) for shots in (*before, result.last)), measured=result.histories,
            slips=result.slips,
        )  # fmt: skip

    def _entries(self):
        slips = {key: [getattr(slip, name) for slip in self.slips] for name, key in SLIP.items()} if self.slips else {}
        return slips | {
            "plies": self.count,
            "ply_gap_m": float(self.gaps[0]),
            "failed_yarn_segments": self.plies["failed_yarns"][-1].tolist(),
            "peak_tension_over_strength": (self.peak_tension / self.strength).max(axis=1).tolist(),
            "ply_energies_J": self.plies["energy"][-1].tolist(),
            "max_penetration_ratio": float(self.max_penetration_ratio.max()),
            "torn_corrections": int(self.torn_contact[0]),
            "torn_unresolved": int(self.torn_contact[1]),
        }

    def _write(self, file):
        for name, values in self.plies.items():
            put(file, f"plies/histories/{name}", values, _PLY_UNITS[name])
        for name, unit in _PLIES.items():
            put(file, f"plies/{name}", getattr(self, name), unit)
        put(file, "projectile", self.projectile, "m")
        for number, (shape, quads) in enumerate(zip(self.shapes, self.quads)):
            put(file, f"shapes/{number:02d}/quads", quads, "1")
            write_shape(file, f"shapes/{number:02d}", shape)
        for ply, measured in enumerate(self.measured):
            write_measured(file.create_group(f"measured/{ply:02d}"), measured)
        for ply, slip in enumerate(self.slips):
            write_group(file.create_group(f"slip/{ply:02d}"), slip, (), SLIP)

    @staticmethod
    def _read(file):
        shapes = [group for _, group in sorted(file["shapes"].items())]
        values = {name: file[f"plies/{name}"][()] for name in _PLIES}
        return values | {
            "plies": {name: data[()] for name, data in file["plies/histories"].items()},
            "projectile": file["projectile"][()],
            "measured": tuple(read_measured(group) for _, group in sorted(file.get("measured", {}).items())),
            "slips": tuple(read_group(file, f"slip/{ply}") for ply in sorted(file.get("slip", ()))),
            "quads": tuple(group["quads"][()] for group in shapes),
            "shapes": tuple(map(read_shape, shapes)),
        }
