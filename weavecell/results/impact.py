"""What an impact leaves in one HDF5 file (histories.h5): scalars, histories, and every ply at two instants.

Layout: attributes of the root for scalars and texts; /histories and /energies with one value an instant;
/plies/histories with one column a ply; /plies with one row a ply; /half_energy/00, 01, ... and /final/00, 01, ... with
each ply's shape and state when the projectile had lost half of the energy that it lost (the snapshot nearest to it) and
at the end, /quads/00, ... with the node numbers of its elements; /cuts with the section through the impact point at the
instants of the snapshots. Where there are any: /measured/00, ... with histories along the yarns of a ply (samples by
elements or nodes), the forces on its edges (pull, lift) and the fronts; /bar with the histories of tip, tail and centre
of mass of an elastic projectile; /backing with the block at the end, as far as it is modelled; /slip/00, ... of
sliding crossovers. Nodes count from the middle surface of the first ply at rest. Every dataset has an attribute "unit".
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from math import degrees
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from fabrics.checks import FilePath, FloatArray
from fabrics.files import read_hdf5, write_hdf5
from fabrics.ply_law import SOLID_TRAVEL
from weavecell.results import keys
from weavecell.results.hdf5_file import plain, put
from weavecell.results.impact_groups import read_group, read_measured, write_group, write_measured
from weavecell.results.impact_shapes import Cut, Peak, Shape, read_cuts, read_shape, write_cuts, write_shape

if TYPE_CHECKING:
    from shellfabric.backing.coupling import BackingResult
    from shellfabric.impact.simulation import ImpactResult
    from shellfabric.output.histories import Histories
    from shellfabric.projectile.dynamics import BarHistory
    from shellfabric.sliding.model import SlipSummary

FORMAT = "weavecell impact 7"  # and version of the files
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
    "rigid_check": "rigid_check",
    "mirror_x": "mirror_x",
    "mirror_y": "mirror_y",
    "wall_time": "wall_time_s",
    "ns_per_element_step": "element_step_time_ns",
    "elements": "elements",
    "steps": "steps",
    "max_deflection": "max_deflection_m",
}
HISTORIES = keys.units(keys.HISTORIES)
_PLY_UNITS, _PLIES = keys.units(keys.PLY_HISTORIES), keys.units(keys.PLIES)


@dataclass(frozen=True, kw_only=True)
class ImpactRecord:
    """One impact on one ply or several, from strike to its end.

    Parameters
    ----------
    title, fabric, law_name : for the reader
    strike_velocity, residual_velocity : [m/s]; the residual velocity is that of the last instant, along the
        normal, and 0 of a projectile that has stopped
    outcome : "stopped", "perforated", "in flight" or "unstable"
    mass : [kg] of the projectile
    failure_message : why an unstable run was ended; "" for others
    rigid_check : whether a rigid projectile is justified, in words; "" where that is not known
    mirror_x, mirror_y : whether the panel continues mirrored beyond x = 0, y = 0; energies and forces are those of the
        whole panel
    wall_time, ns_per_element_step, elements, steps : cost of the run
    time, velocity, nose_position : (n,) [s, m/s, m] time, velocity of the projectile along the normal, foremost point
    contact_force : (n,) [N] on the projectile along the normal, against its flight; the mean since the time before
    deflection : (n,) [m] largest displacement of the last ply along the normal
    failed_segments : (n,) number of failed yarn segments of all plies
    energies : {name: (n,)} [J], names of keys.ENERGIES
    plies : {name: (n, plies)} with the names of shellfabric.solver.pack_solver.PLY_SAMPLES
    strength, peak_tension, peak_tension_time : (plies, 2) [N, N, s] of warp and weft, over the run, and when
    peak_tension_place : (plies, 2, 2) [m] where at rest, along warp and weft from the impact point
    z_rest, thickness : (plies,) [m] middle surfaces at rest
    gaps : (plies - 1,) [m]
    max_penetration_ratio : (plies - 1,) [-] deepest penetration of a ply into the next, over the thickness
    torn_contact : (2,) [-] impulses that kept torn fabric from passing through another ply, and how often it did
    half_energy, final : (plies,) Shape when the projectile had lost half of the energy that it lost, and at the end
    quads : (plies,) arrays (m, 4) of node numbers
    cuts : tuple of Cut
    projectile : (a, b, 3) [m] surface of the projectile about its nose, as it is drawn
    max_deflection : [m] largest entry of `deflection`
    pack : {key of keys.PACK: value} what is stacked, of several plies; empty of one
    failure : {key of keys.FAILURE: value} of strengths that follow strain rate or bending; empty of constant ones
    checks : tuple of shellfabric.panel.quality.Indicator
    measured : tuple of shellfabric.output.histories.Histories of each ply; empty where nothing was to be recorded
    bar : shellfabric.projectile.dynamics.BarHistory of an elastic projectile, or None
    backing : shellfabric.backing.coupling.BackingResult, the block at the end, or None
    slips : (plies,) shellfabric.sliding.model.SlipSummary of sliding crossovers; empty of pinned ones
    """

    title: str
    fabric: str
    law_name: str
    strike_velocity: float
    outcome: str
    residual_velocity: float
    mass: float
    failure_message: str
    rigid_check: str = ""
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
    plies: dict
    strength: np.ndarray
    peak_tension: np.ndarray
    peak_tension_time: np.ndarray
    peak_tension_place: np.ndarray
    z_rest: np.ndarray
    thickness: np.ndarray
    gaps: np.ndarray
    max_penetration_ratio: np.ndarray
    torn_contact: np.ndarray
    half_energy: tuple[Shape, ...]
    final: tuple[Shape, ...]
    quads: tuple[np.ndarray, ...]
    projectile: np.ndarray
    max_deflection: float
    cuts: tuple = ()
    pack: dict[str, Any] = field(default_factory=dict)
    failure: dict[str, float | None] = field(default_factory=dict)
    checks: tuple = ()
    measured: tuple[Histories, ...] = ()
    bar: BarHistory | None = None
    backing: BackingResult | None = None
    slips: tuple[SlipSummary, ...] = ()

    @classmethod
    def of(cls, result: ImpactResult, title: str, law_name: str, message: str = "") -> Self:
        """The record of a `shellfabric.impact.simulation.ImpactResult`."""
        from shellfabric.output.snapshots import quads

        setup, panels, (mirror_x, mirror_y) = result.setup, result.panels, result.mirrored
        target = result.target
        several = len(panels) > 1
        before = [shots for shots in result.snapshots if shots[0].t < result.last[0].t]
        final = tuple(map(Shape.of, result.last))
        return cls(
            title=title, fabric=setup.name, law_name=law_name,
            strike_velocity=setup.strike_velocity,
            outcome=result.outcome, residual_velocity=result.residual_velocity, mass=setup.projectile.mass,
            failure_message=message, rigid_check=str(result.rigidity or ""), mirror_x=mirror_x, mirror_y=mirror_y,
            wall_time=result.wall_time, ns_per_element_step=result.ns_per_element_step,
            elements=sum(panel.elements for panel in panels), steps=result.steps, time=result.t, velocity=result.v,
            nose_position=result.nose_position, contact_force=result.contact_force, deflection=result.deflection,
            failed_segments=result.failed_segments, energies=dict(result.energies), plies=dict(result.plies),
            strength=np.array([[yarn.strength for yarn in panel.weave.yarns] for panel in panels]),
            peak_tension=result.peaks[..., 0], peak_tension_time=result.peaks[..., 1],
            peak_tension_place=result.peaks[..., 2:], z_rest=target.places,
            thickness=np.array([panel.weave.thickness for panel in panels]),
            gaps=np.array(target.gaps), max_penetration_ratio=result.deepest,
            torn_contact=result.held_apart, half_energy=_half_energy(result, final), final=final,
            quads=tuple(map(quads, panels)),
            cuts=tuple(Cut.of(shots, result.panels) for shots in (*before, result.last)),
            projectile=_drawn(setup.projectile), max_deflection=result.max_deflection,
            pack=_stacked(setup, target) if several else {}, checks=result.checks, measured=result.histories,
            bar=result.bar, backing=result.backing, slips=result.slips, failure=_failure(result),
        )  # fmt: skip

    @property
    def count(self) -> int:
        """Number of plies."""
        return len(self.final)

    @property
    def contact_words(self) -> str:
        """The contact law of plies, for the reader."""
        law = {name: self.pack[f"ply_contact_{name}"] for name in ("source", "status", "travel_m")}
        words = f"contact of plies: {law['source']} ({law['status']})"
        if law["travel_m"] <= SOLID_TRAVEL:
            return words
        return f"{words}, travel {1e6 * law['travel_m']:.3g} um, then solid fibre"

    @property
    def gap_words(self) -> str:
        """The gap between plies at rest, its range and its source in one line."""
        low, high = (self.pack[f"ply_gap_{end}_m"] for end in ("low", "high"))
        span = f" ({1e3 * low:.3g} .. {1e3 * high:.3g} mm)" if high > low else ""
        return f"ply gap {1e3 * self.gaps[0]:.3g} mm{span}, {self.pack['ply_gap_source']}"

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
    def rear(self) -> tuple[Shape, Shape]:
        """Shapes of the last ply: when half of the energy was absorbed, and at the end."""
        return self.half_energy[-1], self.final[-1]

    def nose_place(self, t: float) -> FloatArray:
        """(2,) [m] place x and y of the nose at time t, linear between impact, half energy and end."""
        places = np.array([np.zeros(3), *(shape.projectile_position for shape in self.rear)])
        return np.array([np.interp(t, [0.0, *(shape.t for shape in self.rear)], places[:, axis]) for axis in (0, 1)])

    @property
    def peaks(self) -> dict[str, Peak]:
        """{"warp", "weft": Peak} the highest tension of each family over all plies."""
        found = {}
        for family, name in enumerate(("warp", "weft")):
            ply = int(np.argmax(self.peak_tension[:, family]))
            at = ply, family
            tension, share = float(self.peak_tension[at]), float(self.peak_tension[at] / self.strength[at])
            time, place = float(self.peak_tension_time[at]), self.peak_tension_place[at]
            found[name] = Peak(tension, share, time, place, ply + 1)
        return found

    def summary(self) -> dict[str, Any]:
        """The scalars of the record, and what follows from them, as a flat dict."""
        found: dict[str, Any] = {key: getattr(self, name) for name, key in SCALARS.items()}
        stop = float(self.time[np.argmax(self.velocity <= 0)]) if self.outcome == "stopped" else None
        found |= {"end_time_s": float(self.time[-1]), "stop_time_s": stop}
        found |= {
            "plies": self.count,
            "failed_yarn_segments": int(self.failed_segments[-1]),
            "ply_failed_yarn_segments": self.plies["failed_yarns"][-1].tolist(),
            "ply_peak_tension_over_strength": (self.peak_tension / self.strength).max(axis=1).tolist(),
            "ply_energies_J": self.plies["energy"][-1].tolist(),
        }
        if self.pack:
            found |= self.pack | {
                "ply_gap_m": float(self.gaps[0]),
                "max_penetration_ratio": float(self.max_penetration_ratio.max()),
                "torn_corrections": int(self.torn_contact[0]),
                "torn_unresolved": int(self.torn_contact[1]),
            }
        found |= self.failure
        if self.bar is not None:
            found |= {"plastic_shortening_m": self.bar.shortening, "bar_period_s": self.bar.period}
        if self.backing is not None:
            block = self.backing
            found |= {
                "crater_depth_m": block.depth,
                "back_face_signature_mm": 1e3 * block.back_face_signature,
                "dent_volume_m3": block.volume,
                "crater_wall_angle_rad": block.steepness,
            }
        if self.slips:
            found |= {
                "pulled_out_length_m": max(slip.pulled_out_length for slip in self.slips),
                "largest_window_m": max(slip.largest_window for slip in self.slips),
                "pulled_out_segments": sum(slip.pulled_out_segments for slip in self.slips),
                "crossover_friction_work_J": sum(slip.friction_work for slip in self.slips),
            }
        return (
            found
            | _peak_entries(self)
            | {
                "peak_contact_force_N": _known(self.contact_force.max()),
                "strike_energy_J": self.strike_energy,
                "absorbed_energy_J": self.absorbed_energy,
                "energy_error_max": self.energy_error_max,
                "viscous_energy_fraction": self.viscous_energy_fraction,
                "energies_at_end_J": {name: float(values[-1]) for name, values in self.energies.items()},
            }
        )

    def write(self, path: FilePath) -> None:
        """Write the record, whole or not at all."""
        with write_hdf5(path, FORMAT) as file:
            for name, key in SCALARS.items():
                file.attrs[key] = getattr(self, name)
            file.attrs["checks"] = json.dumps([asdict(one) for one in self.checks])
            file.attrs["pack"] = json.dumps(self.pack)
            file.attrs["failure"] = json.dumps(self.failure)
            for name, unit in HISTORIES.items():
                put(file, f"histories/{name}", getattr(self, name), unit)
            for name, values in self.energies.items():
                put(file, f"energies/{name}", values, "J")
            for name, values in self.plies.items():
                put(file, f"plies/histories/{name}", values, _PLY_UNITS[name])
            for name, unit in _PLIES.items():
                put(file, f"plies/{name}", getattr(self, name), unit)
            put(file, "projectile", self.projectile, "m")
            for ply, quads in enumerate(self.quads):
                put(file, f"quads/{ply:02d}", quads, "1")
                write_shape(file, f"half_energy/{ply:02d}", self.half_energy[ply])
                write_shape(file, f"final/{ply:02d}", self.final[ply])
            write_cuts(file, self.cuts)
            for ply, measured in enumerate(self.measured):
                write_measured(file.create_group(f"measured/{ply:02d}"), measured)
            if self.bar is not None:
                write_group(file.create_group("bar"), self.bar, keys.BAR, ("period", "shortening"))
            if self.backing is not None:
                write_group(file.create_group("backing"), self.backing, keys.BACKING, ("face", "share"))
            for ply, slip in enumerate(self.slips):
                write_group(file.create_group(f"slip/{ply:02d}"), slip, (), vars(slip))

    @classmethod
    def read(cls, path: FilePath) -> Self:
        """Read what `write` wrote; InputError if the file is not one of these."""
        with read_hdf5(path, FORMAT) as file:
            values = {name: plain(file.attrs[key]) for name, key in SCALARS.items()}
            values |= {name: file[f"histories/{name}"][()] for name in HISTORIES}
            values |= {name: file[f"plies/{name}"][()] for name in _PLIES}
            for name, group in (("energies", "energies"), ("plies", "plies/histories")):
                values[name] = {key: data[()] for key, data in file[group].items()}
            for name in ("half_energy", "final"):
                values[name] = tuple(read_shape(group) for _, group in sorted(file[name].items()))
            values["quads"] = tuple(data[()] for _, data in sorted(file["quads"].items()))
            values["measured"] = tuple(read_measured(group) for _, group in sorted(file.get("measured", {}).items()))
            values["slips"] = tuple(read_group(file, f"slip/{ply}") for ply in sorted(file.get("slip", ())))
            return cls(
                **values, projectile=file["projectile"][()], cuts=read_cuts(file), bar=read_group(file, "bar"),
                backing=read_group(file, "backing"), checks=_read_checks(file.attrs["checks"]),
                pack=json.loads(file.attrs["pack"]), failure=json.loads(file.attrs.get("failure", "{}")),
            )  # fmt: skip


def _stacked(setup, pack):
    """{key of keys.PACK: value} what is stacked."""
    from shellfabric.plies.gap import PlyGap, gap_between

    law, given = pack.laws[0], setup.lay_up[0].gap if setup.lay_up else setup.ply_gap
    gap = PlyGap(given, given, given, "given") if given is not None else gap_between(*map(setup.fabric_of, (0, 1)))
    plies = range(setup.plies)
    return {
        "stacking": "lay-up" if setup.lay_up else setup.stacking,
        "ply_fabrics": [setup.fabric_of(p).name for p in plies],
        "ply_angles_deg": [round(degrees(setup.angle_of(p)), 6) for p in plies],
        "ply_gap_low_m": gap.low, "ply_gap_high_m": gap.high, "ply_gap_source": gap.source,
        "ply_contact_source": law.source, "ply_contact_status": law.status, "ply_contact_travel_m": law.travel,
    }  # fmt: skip


def _failure(result):
    """{key of keys.FAILURE: value} where strengths follow the strain rate; None before a yarn has failed."""
    if not result.setup.rate_dependence:
        return {}
    count, *sums = result.failures.sum(axis=0)
    return {key.name: float(value / count) if count else None for key, value in zip(keys.FAILURE, sums)}


def _half_energy(result, final):
    """The shapes nearest to the instant at which half of the energy lost had been lost."""
    kinetic = result.energies["kinetic_projectile"]
    lost = kinetic[0] - kinetic
    instant = result.t[int(np.argmax(lost >= 0.5 * lost[-1]))]
    shots = [shots for shots in result.snapshots if shots[0].t <= final[0].t]
    nearest = min(shots, key=lambda shots: abs(shots[0].t - instant), default=None)
    return final if nearest is None else tuple(map(Shape.of, nearest))


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


def _read_checks(text):
    """The indicators of an attribute of a file."""
    from shellfabric.panel.quality import Indicator

    return tuple(Indicator(**entry) for entry in json.loads(text))


def _drawn(shot):
    """The projectile as it is drawn, set back by its edge radius.

    The flat elements of the fabric cut across the rounding that they lie on, and it would stick out between them.
    """
    return shot.surface(shot.edge_radius)
