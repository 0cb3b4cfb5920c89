"""What an impact leaves in one HDF5 file (histories.h5); every dataset has an attribute "unit", nodes
count from the middle surface of the first ply at rest. Attributes of the root are scalars and texts.

    /histories, /energies      a value an instant;  /plies/histories: a column a ply
    /plies                     a row a ply;  /quads/00, ...: node numbers of its elements
    /half_energy/00, /final/00 shape and state of a ply at the snapshot nearest to half of the energy
                               that the projectile lost, and at the end
    /cuts                      section through the impact point at the snapshots: plies, nodes of a
                               metal projectile with plastic strain, face of a block
    /measured/00, ...          along the yarns of a ply, forces on its edges (pull, lift), fronts
    /bar, /backing             tip, tail, centre of mass of an elastic projectile; block at the end
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, fields
from fnmatch import fnmatchcase
from functools import partial
from itertools import groupby
from math import degrees
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.files import write_hdf5
from fabrics.base.record import Record
from fabrics.ply_law import SOLID_TRAVEL
from shellfabric.impact.data import ImpactData
from shellfabric.loop.cone import find_foot
from shellfabric.membrane.indicator import status
from weavecell.results import display, json_file, keys
from weavecell.results.hdf5_file import plain, put, read_group, write_group
from weavecell.results.impact_shapes import OF_YARNS, Cut, Peak, Shape, TurnedBody
from weavecell.results.keys import TABLES

if TYPE_CHECKING:
    from xarray import Dataset

    from shellfabric.impact.result import ImpactResult


# name and version of the files
FORMAT = "weavecell impact 12"


@dataclass(frozen=True, kw_only=True)
class ImpactRecord(ImpactData):
    """One impact on one ply or several, as its file has it, from strike to its end.

    Scalars, histories (n,) and data of the plies (plies, ...) are in SI units and as
    results/keys.toml has them, in the tables run, impact, histories and plies.

    Parameters
    ----------
    title, fabric_name, law_name : of the shot, its fabric and its compression law
    strike_velocity, mass : [m/s, kg] of the projectile
    failure_message : why an unstable run was stopped, else ""
    rigid_check : whether a rigid projectile is justified, in words
    mirror_x, mirror_y : whether the panel continues mirrored at x = 0, y = 0
    elements : number of elements
    strength, peak_tension, peak_tension_time : (plies, 2) [N, N, s] of warp and weft, over the run,
        and when
    peak_tension_place : (plies, 2, 2) [m] where at rest, along warp and weft from the impact point
    z_rest, thickness : (plies,) [m] middle surface at rest, thickness
    gaps : (plies - 1,) [m]
    half_energy, final : (plies,) Shape when the projectile had lost half of the energy that it
        lost, and at the end
    quads : (plies,) arrays (m, 4) of node numbers
    cuts : tuple of Cut
    projectile : (a, b, 3) [m] surface of the projectile about its nose, as it is drawn
    pack : {key: value} of the table stacking, of several plies; empty of one
    failure : {key: value} of the table failure, of strengths that follow strain rate; empty of
        constant ones
    """

    title: str
    fabric_name: str
    law_name: str
    strike_velocity: float
    mass: float
    failure_message: str
    rigid_check: str = ""
    mirror_x: bool
    mirror_y: bool
    elements: int
    strength: np.ndarray
    peak_tension: np.ndarray
    peak_tension_time: np.ndarray
    peak_tension_place: np.ndarray
    z_rest: np.ndarray
    thickness: np.ndarray
    gaps: np.ndarray
    half_energy: tuple[Shape, ...]
    final: tuple[Shape, ...]
    quads: tuple[np.ndarray, ...]
    projectile: np.ndarray
    cuts: tuple = ()
    pack: dict[str, Any] = field(default_factory=dict)
    failure: dict[str, float | None] = field(default_factory=dict)

    @classmethod
    def from_result(
        cls, result: ImpactResult, title: str, law_name: str, message: str = "", **more: Any
    ) -> Self:
        """Make the record of a `shellfabric.impact.result.ImpactResult`; `more` fields of a derived
        class."""
        from shellfabric.loop.snapshots import quads
        from weavecell.studies import rigidity

        setup = result.setup
        panels = result.panels
        target = result.target
        # the last snapshot may be the end of the run, which is cut on its own
        before = [shots for shots in result.snapshots if shots[0].t < result.last[0].t]
        final = tuple(map(Shape.from_snapshot, result.last))
        return cls(
            **{entry.name: getattr(result, entry.name) for entry in fields(ImpactData)},
            **more,
            title=title,
            fabric_name=setup.name,
            law_name=law_name,
            strike_velocity=setup.strike_velocity,
            mass=setup.projectile.mass,
            failure_message=message,
            rigid_check=str(rigidity.check_shot(result) or ""),
            mirror_x=result.mirrored[0],
            mirror_y=result.mirrored[1],
            elements=sum(panel.elements for panel in panels),
            strength=np.array([panel.strengths for panel in panels]),
            peak_tension=result.peaks[..., 0],
            peak_tension_time=result.peaks[..., 1],
            peak_tension_place=result.peaks[..., 2:],
            z_rest=target.places,
            thickness=np.array([panel.weave.thickness for panel in panels]),
            gaps=np.array(target.gaps),
            half_energy=_half_energy(result, final),
            final=final,
            quads=tuple(map(quads, panels)),
            cuts=tuple(Cut.from_snapshots(shots, panels) for shots in (*before, result.last)),
            # set back by its edge radius: the flat elements of the fabric cut across the rounding
            # that they lie on
            projectile=setup.projectile.surface(setup.projectile.edge_radius),
            pack=_describe_stacking(setup, target) if len(panels) > 1 else {},
            failure=_failure(result),
        )

    @property
    def count(self) -> int:
        """Number of plies."""
        return len(self.final)

    @property
    def ply_fabrics(self) -> tuple[str, ...]:
        """Names of the fabric of each ply from the front; empty if all plies are of one fabric."""
        names = tuple(self.pack.get("ply_fabrics", ()))
        if len(set(names)) < 2:
            return ()
        return names

    def ply_name(self, ply: int) -> str:
        """Name a ply, the first is 0, with its fabric in a pack of several."""
        if self.ply_fabrics:
            return f"ply {ply + 1}, {self.ply_fabrics[ply]}"
        return f"ply {ply + 1}"

    @property
    def which_fabric(self) -> str:
        """Say which plies are of which fabric; "" if all are of one."""
        parts = []
        first = 1
        for name, plies in groupby(self.ply_fabrics):
            last = first + len(list(plies)) - 1
            where = f"ply {first}" if first == last else f"plies {first} to {last}"
            parts.append(f"{where} {name}")
            first = last + 1
        return ", ".join(parts)

    @property
    def contact_words(self) -> str:
        """The contact law of plies, for the reader."""
        law = {name: self.pack[f"ply_contact_{name}"] for name in ("source", "status", "travel_m")}
        words = f"contact of plies: {law['source']} ({law['status']})"
        # a law of solid fibre has no travel worth a word
        if law["travel_m"] <= SOLID_TRAVEL:
            return words
        return f"{words}, travel {law['travel_m'] * 1e6:.3g} um, then solid fibre"

    @property
    def gap_words(self) -> str:
        """The gap between plies at rest, its range and its source in one line."""
        low, high = (self.pack[f"ply_gap_{end}_m"] for end in ("low", "high"))
        span = ""
        if high > low:
            span = f" ({display.number(low, 'm', form='.3g')} .. {display.text(high, 'm', form='.3g')})"
        return f"ply gap {display.text(self.gaps[0], 'm', form='.3g')}{span}, {self.pack['ply_gap_source']}"

    @property
    def stop_time(self) -> float | None:
        """[s] at which the projectile stopped, or None."""
        if self.outcome == "stopped":
            return float(self.time[np.argmax(self.velocity <= 0)])
        return None

    @property
    def strike_energy(self) -> float:
        """[J]"""
        return 0.5 * self.mass * self.strike_velocity**2

    @property
    def viscous_energy_fraction(self) -> float:
        """[-] energy that viscosity has dissipated over the energy absorbed, until the first
        failure of a yarn."""
        return self._viscous_split[0]

    @property
    def recoil_of_cut_yarns(self) -> float:
        """[J] energy that viscosity has dissipated after the first failure of a yarn."""
        return self._viscous_split[1]

    @property
    def viscous_note(self) -> str:
        """That viscosity dissipated more in the whole run than the check allows until the first
        failure, or ""."""
        from shellfabric.membrane.quality import CHECKS

        # a nose that hardly loses energy would make any share large
        share = float(self.energies["viscous"][-1]) / max(
            self.absorbed_energy, 1e-3 * self.strike_energy
        )
        if not self.cut_yarns[-1] or share <= CHECKS["viscous energy"].limit:
            return ""
        return f"viscosity took {100 * share:.0f} % of what the whole run absorbed; its check ends at the first failure"

    @property
    def _viscous_split(self):
        from shellfabric.membrane.quality import split_viscous

        return split_viscous(self.cut_yarns, self.energies)

    @property
    def block_motion(self) -> float:
        """[-] energy that the block moves with at the end, over the strike energy."""
        return float(self.energies["backing_kinetic"][-1]) / self.strike_energy

    @property
    def block_moves(self) -> bool:
        """Whether a block has no dent yet at the end: it moves, or its dent still changes
        (`shellfabric.block.dent.at_rest`)."""
        return self.backing is not None and not self.backing.at_rest

    @property
    def dent(self) -> dict[str, float | None]:
        """{name: value} of the dent in the block: depth [m], volume [m3], radius at half of its depth
        [m], steepness [rad]; None while it moves."""
        names = ("depth", "volume", "half_width", "steepness")
        if self.block_moves:
            return dict.fromkeys(names)
        return {name: getattr(self.backing, name) for name in names}

    @property
    def back_face_signature_mm(self) -> float | None:
        """[mm] depth of the dent that a gauge finds at rest; None while it moves."""
        assert self.backing is not None
        if self.backing.back_face_signature is None:
            return None
        return 1e3 * self.backing.back_face_signature

    @property
    def deepest_dent_mm(self) -> float:
        """[mm] deepest that the dent has been, which is no signature."""
        assert self.backing is not None
        return 1e3 * self.backing.deepest_dent

    @property
    def springback(self) -> float | None:
        """[-] share of its greatest depth by which the dent has fallen at rest; None while it
        moves."""
        assert self.backing is not None
        return None if self.block_moves else self.backing.springback

    @property
    def rear(self) -> tuple[Shape, Shape]:
        """Shapes of the last ply: when half of the energy was absorbed, and at the end."""
        return self.half_energy[-1], self.final[-1]

    @property
    def cut_times(self) -> FloatArray:
        """(cuts,) [s] of the cuts."""
        return np.array([cut.time for cut in self.cuts])

    @property
    def cone_radius(self) -> FloatArray:
        """(cuts,) [m] how far the transverse wave has come in the last ply at `cut_times`: from the
        impact point along x to the foot of the cone; not a number before there is one
        (`shellfabric.loop.cone`). Finer in time along recorded yarns, `measured`."""
        found = []
        for cut in self.cuts:
            line = cut.lines[-1]
            x, z = line[np.isfinite(line).all(axis=1)].T
            found.append(find_foot(x, z - self.z_rest[-1], float(np.median(np.diff(x)))))
        return np.array(found)

    def nose_place(self, t: float) -> FloatArray:
        """Interpolate the place x and y (2,) [m] of the nose at time t, linear between impact, half
        energy and end."""
        places = np.array([np.zeros(3), *(shape.projectile_position for shape in self.rear)])
        times = [0.0, *(shape.time for shape in self.rear)]
        return np.array([np.interp(t, times, place) for place in places[:, :2].T])

    def surface(self, t: float) -> FloatArray:
        """Return the surface (a, b, 3) [m] of the projectile, its foremost point at z = 0 or at rest; of
        one of metal in the shape of the cut nearest to the time t [s]."""
        nearest = min(self.cuts, key=lambda cut: abs(cut.time - t), default=None)
        if nearest is None or self.metal is None:
            return self.projectile
        from shellfabric.projectile.projectile import turn_about

        return turn_about(nearest.body[self.metal.outline], self.projectile.shape[1])

    def bodies(self) -> list[tuple[TurnedBody, float]]:
        """Return a projectile of metal at each cut, where it is then, and the time [s]; none of another
        projectile."""
        found = []
        for cut in self.cuts:
            if self.metal is not None:
                place = np.append(self.nose_place(cut.time), cut.nose_position)
                found.append((TurnedBody(self.metal, cut.body, cut.plastic, place), cut.time))
        return found

    @property
    def seen_from_front(self) -> bool:
        """Whether pictures show the side that is struck, where the projectile is; a panel that it
        has left, or before a block, is seen from behind."""
        return self.outcome != "perforated" and self.backing is None

    def time_of_pack(self, t: float) -> float:
        """Return the time [s] of which pack and projectile are shown at time t [s]: they stay as
        they were when the block began to go on alone."""
        if self.backing is None:
            return t
        return float(np.fmin(t, self.backing.alone_from))

    def face_at(self, t: float) -> FloatArray:
        """Return the face (nx, ny, 3) [m] of the block beside the pack that is shown at time t [s],
        from the nearest cut, as far as it is modelled; empty without a block."""
        if not self.cuts:
            return np.empty((0, 0, 3))
        shown = self.time_of_pack(t)
        return min(self.cuts, key=lambda cut: abs(cut.time - shown)).face

    def faces(self) -> list[tuple[FloatArray, float]]:
        """Return the face (nx, ny, 3) [m] of the block behind the last ply at each cut, as far as it
        is modelled, and the time [s]; none without a block."""
        return [(cut.face, cut.time) for cut in self.cuts if cut.face.size]

    @property
    def ply_shares(self) -> FloatArray:
        """(plies,) [-] highest tension over strength in each ply."""
        return (self.peak_tension / self.strength).max(axis=1)

    @property
    def peaks(self) -> dict[str, Peak]:
        """{"warp", "weft": Peak} the highest tension of each family over all plies."""
        peaks = {}
        for family, name in enumerate(("warp", "weft")):
            at = int(np.argmax(self.peak_tension[:, family])), family
            tension = float(self.peak_tension[at])
            time = float(self.peak_tension_time[at])
            peaks[name] = Peak(
                tension, tension / self.strength[at], time, self.peak_tension_place[at], at[0] + 1
            )
        return peaks

    def facts(self) -> dict[str, Any]:
        """Return {key: value} of all quantities of results/keys.toml, as summary.json has them."""
        tables = ["run", "impact"]
        tables += [table for part, table in keys.OF_SOME.items() if getattr(self, part)]
        known = {key.name: key.value(self) for key in keys.table(*tables)}
        known |= self.pack | self.failure
        known["checks"] = status(self.checks)
        at_end = {name: values[-1] for name, values in self.energies.items()}
        return json_file.finite(known | {"energies_at_end_J": at_end})

    @property
    def histories(self) -> Record:
        """All that has a value an instant: of the shot, (n,) energy_NAME [J] of `energies`, (n,
        plies) ply_NAME."""
        columns = {}
        meanings = {}

        def add(prefix, key, history):
            columns[f"{prefix}{key.name}"] = history
            meanings[f"{prefix}{key.name}"] = f"[{key.si_unit}] {key.meaning}"

        # the tables in keys.toml give the order, the unit and the meaning of each column
        for key in TABLES["histories"]:
            add("", key, key.value(self))
        for prefix, table, held in (
            ("energy_", "energies", self.energies),
            ("ply_", "ply_histories", self.plies),
        ):
            known = {key.name: key for key in TABLES[table]}
            # a file has its names in another order than a run
            for name in sorted(held, key=partial(_place_in, tuple(known))):
                # a force on a ply of one's own has an energy that no table names
                key = known.get(name, keys.Key(name, "J", name.replace("_", " ")))
                add(prefix, key, held[name])
        return Record(columns, meanings, self.facts())

    def to_xarray(self) -> Dataset:
        """Return the histories as an xarray.Dataset over time, those of plies over time and ply,
        with units and meanings."""
        return self.histories.to_xarray("time", "ply")

    def write(self, path: FilePath) -> None:
        """Write the record, whole or not at all."""
        units = {key.name: key.si_unit for key in TABLES["ply_histories"]}
        with write_hdf5(path, FORMAT) as file:

            def write_table(name, source, table):
                write_group(file.create_group(name), source, TABLES[table])

            # numbers stand in attributes, arrays in datasets with a unit each
            for name, key in SCALARS.items():
                file.attrs[key] = getattr(self, name)
            for name in _TEXTS:
                file.attrs[name] = json.dumps(getattr(self, name))
            file.attrs["checks"] = json.dumps(list(map(asdict, self.checks)))
            write_table("histories", self, "histories")
            time, *others = (file["histories"][key.name] for key in TABLES["histories"])
            # xarray and netCDF name the axis by it
            time.make_scale("time")
            for history in others:
                history.dims[0].attach_scale(time)
            for name, values in self.energies.items():
                put(file, f"energies/{name}", values, "J")
            write_table("plies", self, "plies")
            for name, values in self.plies.items():
                put(file, f"plies/histories/{name}", values, units[name])
            for ply, quads in enumerate(self.quads):
                put(file, f"quads/{ply:02d}", quads, "1")
                for name in ("half_energy", "final"):
                    shape = getattr(self, name)[ply]
                    write_table(f"{name}/{ply:02d}", shape, "shape")
                    if shape.resolved.size:
                        write_group(file[f"{name}/{ply:02d}"], shape, TABLES["shape_of_yarns"])
            # four digits keep the order of cuts when a reader sorts by name
            for number, cut in enumerate(self.cuts):
                write_table(f"cuts/{number:04d}", cut, "cut")
                for ply, line in enumerate(cut.lines):
                    put(file, f"cuts/{number:04d}/lines/{ply:02d}", line, "m")
                if cut.body.size:
                    put(file, f"cuts/{number:04d}/body", cut.body, "m")
                    put(file, f"cuts/{number:04d}/plastic", cut.plastic, "1")
                if cut.face.size:
                    put(file, f"cuts/{number:04d}/face", cut.face, "m")
            for ply, measured in enumerate(self.measured):
                _write_measured(file.create_group(f"measured/{ply:02d}"), measured)
            for name in _PARTS:
                if getattr(self, name) is not None:
                    write_table(name, getattr(self, name), name)
            put(file, "projectile", self.projectile, "m")

    @classmethod
    def from_hdf5(cls, file: Any) -> Self:
        """Make the record of an open file that `write` wrote (`result_folder.read_record`)."""
        from shellfabric.block.coupling import BackingResult
        from shellfabric.membrane.indicator import Indicator
        from shellfabric.metal.body import MetalHistory
        from shellfabric.projectile.dynamics import BarHistory

        values = {name: plain(file.attrs[key]) for name, key in SCALARS.items()}
        for name in _TEXTS:
            values[name] = json.loads(file.attrs[name])
        known = {entry.name for entry in fields(cls)}
        for group in ("histories", "plies"):
            for key in TABLES[group]:
                if key.name in known:
                    values[key.name] = file[group][key.name][()]
        for name, group in (("energies", "energies"), ("plies", "plies/histories")):
            values[name] = {key: data[()] for key, data in file[group].items()}
        for name in ("half_energy", "final"):
            values[name] = tuple(map(_read_shape, _members(file, name)))
        cuts = []
        for group in _members(file, "cuts"):
            lines = tuple(line[()] for line in _members(group, "lines"))
            names = ("body", "plastic", "face")
            more = {name: group[name][()] for name in names if name in group}
            cuts.append(read_group(group, Cut, "cut", lines=lines, **more))
        for name, kind in zip(_PARTS, (BarHistory, MetalHistory, BackingResult)):
            if name in file:
                values[name] = read_group(file[name], kind, name)
        return cls(
            **values,
            checks=tuple(Indicator(**entry) for entry in json.loads(file.attrs["checks"])),
            quads=tuple(quads[()] for quads in _members(file, "quads")),
            projectile=file["projectile"][()],
            cuts=tuple(cuts),
            measured=tuple(map(_read_measured, _members(file, "measured"))),
        )


_TEXTS = ("pack", "failure")
# a record may lack these
_PARTS = ("bar", "metal", "backing")
# attribute of the record: attribute of the file, and key of summary.json
SCALARS = {
    key.field: key.name
    for key in keys.table("run", "impact")
    if key.field in {entry.name for entry in fields(ImpactRecord)}
}


def _members(group, name):
    """What a group holds under a name, in the order of its numbers; [] if it holds none."""
    return [member for _, member in sorted(group.get(name, {}).items())]


def _read_shape(group):
    """The shape of a ply, with resolved yarns if it has any."""
    of_yarns = {name: group[name][()] for name in OF_YARNS if name in group}
    return read_group(group, Shape, "shape", **of_yarns)


def _write_measured(group, measured):
    """Histories, and the fronts read off them, which are for the reader alone."""
    from weavecell.results.wave_fronts import fronts

    put(group, "time", measured.t, "s")
    for number, yarn in enumerate(measured.yarns):
        write_group(group.create_group(f"yarns/{number:03d}-{yarn.family}"), yarn, TABLES["yarn"])
    for name, forces in measured.edges.items():
        put(group, f"edges/{name}", forces, "N")
    # fronts follow from the histories: reading a file leaves them out
    for front in fronts(measured):
        write_group(
            group.create_group(f"fronts/{front.family}-{front.kind}"), front, TABLES["front"]
        )


def _read_measured(group):
    from shellfabric.loop.histories import EDGES, Histories, YarnHistory

    yarns = [read_group(yarn, YarnHistory, "yarn") for yarn in _members(group, "yarns")]
    edges = {name: group[f"edges/{name}"][()] for name in EDGES}
    return Histories(group["time"][()], tuple(yarns), edges)


def _describe_stacking(setup, pack):
    """{key: value} of the table stacking."""
    from shellfabric.plies.gap import PlyGap, gap_between

    law = pack.laws[0]
    if setup.lay_up:
        given = setup.lay_up[0].gap
    else:
        given = setup.ply_gap
    # a gap that the user gives has no range
    if given is not None:
        gap = PlyGap(given, given, given, "given")
    else:
        gap = gap_between(*map(setup.fabric_of, (0, 1)))
    plies = range(setup.plies)
    return {
        "stacking": "lay-up" if setup.lay_up else setup.stacking,
        "ply_fabrics": [setup.fabric_of(p).name for p in plies],
        "ply_angles_deg": [round(degrees(setup.angle_of(p)), 6) for p in plies],
        "ply_gap_low_m": gap.low,
        "ply_gap_high_m": gap.high,
        "ply_gap_source": gap.source,
        "ply_contact_source": law.source,
        "ply_contact_status": law.status,
        "ply_contact_travel_m": law.travel,
    }


def _failure(result):
    """{key: value} of the table failure, where strengths follow the strain rate; None before a yarn
    has failed."""
    if not result.setup.rate_dependence:
        return {}
    # the solver counts failures and sums what each had: the mean is asked for
    count, *sums = result.failures.sum(axis=0)
    shares = {}
    for key, value in zip(TABLES["failure"], sums):
        shares[key.name] = None
        if count:
            shares[key.name] = float(value / count)
    return shares


def _half_energy(result, final):
    """The shapes nearest to the instant at which half of the energy lost had been lost."""
    kinetic = result.energies["kinetic_projectile"]
    lost = kinetic[0] - kinetic
    instant = result.time[int(np.argmax(lost >= 0.5 * lost[-1]))]
    shots = [shots for shots in result.snapshots if shots[0].t <= final[0].time]
    # a short run has no snapshot before its end
    nearest = min(shots, key=lambda shots: abs(shots[0].t - instant), default=None)
    if nearest is None:
        return final
    return tuple(map(Shape.from_snapshot, nearest))


def _place_in(known, name):
    """Where a name stands among those of a table, which may have a *: its number, and itself."""
    places = (number for number, one in enumerate(known) if fnmatchcase(name, one))
    return next(places, len(known)), name
