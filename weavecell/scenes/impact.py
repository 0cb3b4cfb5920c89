"""Scene files: one impact, described in TOML with units as text, checked before anything is computed or written."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Discriminator, Field, Tag, WithJsonSchema, model_validator

from fabrics import backings, projectiles
from fabrics.checks import FilePath
from fabrics.errors import InputError
from fabrics.schema import (
    TEXT,
    TEXT_OR_TWO,
    Table,
    angle,
    as_tuple,
    described,
    flag,
    from_text,
    in_python,
    number,
    one_of,
    quantities,
    quantity,
    read_toml,
    some_of,
    string,
    validated,
    whole,
)
from weavecell.scenes import honoured, stl_file
from weavecell.scenes.fabric_table import LAW, FabricTable, Law, anchored, exactly_one

SHAPES = {  # of `shellfabric.projectile.projectile`, in words
    "flat": "a cylinder", "hemisphere": "a round-nosed cylinder", "cone": "a conical projectile", "sphere": "a sphere",
    "chisel": "a chisel-nosed fragment simulator", "stl": "a body from an STL file",
}  # fmt: skip


def _name_or_size(schema):
    """The JSON Schema of [projectile] as files have it: what `projectiles` knows of a name is not required."""
    schema["required"] = ["strike_velocity"]
    schema["anyOf"] = [{"required": ["name"]}, {"required": ["mass", "diameter"]}, {"required": ["stl"]}]


class ProjectileTable(Table):
    """A projectile by `name`, or by mass, diameter and edge radius. It strikes the middle of the panel. It is rigid
    unless `body` says otherwise.

    [projectile]
    name = "FSP 1.10 g"
    strike_velocity = "200 m/s"
    friction = 0.1
    """

    model_config = ConfigDict(json_schema_extra=_name_or_size)

    name: string(
        "projectile of `weavecell projectiles list`; its data stand for keys that are not given, required ones too",
        "the name of a projectile",
    ) = None  # fmt: skip
    mass: quantity(
        "mass, with a mean density from 0.5 to 23 g/cm^3; a length that is not given may be 0.1 to 30 diameters",
        "kg", "3 g",
    )  # fmt: skip
    diameter: quantity("diameter", "m", "5.5 mm")
    edge_radius: quantity(
        "rounding of the edges; required except for a sphere. Of an STL file the smallest radius of the nose's edges, "
        "to which sharp ones are rounded", "m", "0.3 mm",
    ) = None  # fmt: skip
    strike_velocity: quantity("speed along the line of flight", "m/s", "92.5 m/s", most="1000 m/s")
    shape: one_of("shape of the nose", *SHAPES) = "flat"
    length: quantity(
        "overall length; without it a cylinder has no rear end, and the elastic bar has the length given in the "
        "thesis", "m", "8 mm",
    ) = None  # fmt: skip
    half_angle: angle("angle between axis and flank of a cone; required for a cone", 5, 85, "45 deg") = None
    tip_radius: quantity("rounding of the tip of a cone; required for a cone", "m", "0.5 mm") = None
    flat_width: quantity("width of the flat strip across a chisel nose; required for a chisel", "m", "2.5 mm") = None
    flat_angle: angle(
        "angle of a chisel's two flats against the plane of the nose; required for a chisel", 5, 85, "35 deg"
    ) = None
    stl: string(
        "STL file of the body, its z axis along the flight; required for the shape stl. Its path is relative to the "
        "input file", "the path of an STL file (*.stl)",
    ) = None  # fmt: skip
    stl_unit: one_of("unit of the lengths in the STL file; required with it", *stl_file.UNITS) = None
    density: quantity("density of the body of an STL file, in place of its mass", "kg/m^3", "7.85 g/cm^3") = None
    obliquity: angle("angle between line of flight and normal of the panel", 0, 75, "30 deg") = 0.0
    azimuth: angle("direction of the obliquity in the plane of the panel, from the warp", -360, 360, "90 deg") = 0.0
    yaw: angle("angle between axis and line of flight", -75, 75, "5 deg") = 0.0
    roll: angle("rotation about the axis", -360, 360, "45 deg") = 0.0
    friction: number("Coulomb coefficient between projectile and fabric", 0.2, ge=0.0, le=2.0) = 0.0
    body: one_of(
        "rigid body, or elastic-plastic steel bar along the axis (one-dimensional waves)", "rigid", "elastic_bar"
    ) = "rigid"
    bore_diameter: quantity(
        "diameter of a bore into the rear of the elastic bar; its depth follows from the mass", "m", "4.5 mm"
    ) = None

    @model_validator(mode="after")
    def _of_one_body(self):
        if self.shape != "stl":
            self.refuse("stl stl_unit density", 'left out but for the shape "stl"')
        if self.body == "rigid":
            self.refuse("bore_diameter", "left out for a rigid projectile")
        if self.shape == "sphere":
            self.refuse("edge_radius", "left out for a sphere")
        elif self.edge_radius is None:
            allowed = type(self).model_fields["edge_radius"].description
            raise InputError("is missing", key="edge_radius", allowed=allowed)
        elif self.edge_radius >= self.diameter / 2:
            raise InputError(key="edge_radius", allowed="below half of projectile.diameter")
        return self


class SlipTable(Table):
    """Yarns that slip in their clamps (thesis section 6.4.3): either `clamp_force`, a friction clamp, or `pull_in` with
    `start` and `end`, a prescribed slip. A list of two tables holds for their two ends.

    [panel.boundary]
    warp = [{ clamp_force = "20 N" }, { clamp_force = "40 N" }]
    weft = { pull_in = "5 mm", start = "200 us", end = "650 us" }
    """

    clamp_force: quantity("friction-limited clamp: tension of a yarn at which it slips", "N", "20 N") = None
    pull_in: quantity("prescribed slip of the yarn in the middle of the zone, into the panel", "m", "5 mm") = None
    start: quantity("time at which the prescribed slip begins", "s", "200 us", zero=True) = None
    end: quantity("time at which the prescribed slip ends", "s", "650 us") = None
    zone: quantity(
        "width of the triangular zone of the side that slips, about its middle; 60 mm where not given", "m", "60 mm"
    ) = None

    @model_validator(mode="after")
    def _clamped_or_pulled(self):
        given = {name for name in self.model_fields_set if getattr(self, name) is not None}
        if given == {"clamp_force"} or (type(self) is not SlipTable and not given & set(SlipTable.model_fields)):
            return self
        if given - {"zone"} != {"pull_in", "start", "end"}:
            raise InputError("give clamp_force alone, or pull_in with start and end (and zone)")
        if self.end <= self.start:
            raise InputError("must end after its start")
        return self


_SIDE = (
    '"clamped", "free", { clamp_force = ... }, { pull_in = ..., start = ..., end = ... }, '
    "or a list of two such for its ends"
)
WIDEST = 5.0  # [m] of an opening: a larger number has another unit
_BOUNDARY = '"clamped", "free", a table of a slipping side for all four, or a table { warp = ..., weft = ... } of sides'


def _kind(value):
    return "inline" if isinstance(value, (Mapping, Table)) else "pair" if isinstance(value, (list, tuple)) else "text"


_Text = Annotated[Literal["clamped", "free"], Tag("text")]
_One = Annotated[_Text | Annotated[SlipTable, Tag("inline")], Discriminator(_kind)]
_Pair = Annotated[tuple[_One, _One], BeforeValidator(tuple), Tag("pair")]
Side = Annotated[_Text | Annotated[SlipTable, Tag("inline")] | _Pair, Discriminator(_kind)]


class BoundaryTable(SlipTable):
    """Different conditions for the ends of warp and weft, in place of `boundary = ...`; or the keys of a slipping side,
    which then holds for all four: `boundary = { clamp_force = "5 N" }`.

    [panel.boundary]
    warp = "clamped"
    weft = "free"
    """

    warp: Annotated[Side, described("how the warp yarns end at the frame", _SIDE)] = "clamped"
    weft: Annotated[Side, described("how the weft yarns end at the frame", _SIDE)] = "clamped"

    @property
    def sides(self) -> dict[str, Any]:
        """{"warp": side, "weft": side} in the forms of these keys; where all four slip alike, this table itself."""
        alike = bool(self.model_fields_set & set(SlipTable.model_fields))
        return {name: self if alike else getattr(self, name) for name in ("warp", "weft")}


Boundary = Annotated[_Text | Annotated[BoundaryTable, Tag("inline")], Discriminator(_kind)]


def _opening(value, read):
    sides = [read(text, "m") for text in (value if isinstance(value, list) and len(value) == 2 else [value])]
    if not 0 < min(sides) <= max(sides) <= WIDEST:
        raise ValueError("out of range")
    return sides[0] if len(sides) == 1 else tuple(sides)


_ZONE = {"type": "array", "prefixItems": [{"type": ["number", "string"]}] * 2, "minItems": 2, "maxItems": 2}
_PLY_CONTACT = '"solid", "pressure_law", or the path of a law.json of `weavecell calibrate` or of a *.csv'


def _ply_contact(value, info):
    if in_python(info) or value in (None, "solid", "pressure_law") or str(value).endswith((".json", ".csv")):
        return value
    raise ValueError("no law")


def _ply_angle(text, read):
    """[rad] above -pi/2 and at most pi/2: half a turn leaves a weave as it is."""
    degrees = round(math.degrees(read(text, "rad")), 6)
    if not -180 <= degrees <= 180:
        raise ValueError("out of range")
    least = math.remainder(degrees, 180)
    return math.radians(90 if least == -90 else least)


def _zones(value):
    """Zones (until, side) [crossovers] of a grading, as numbers."""
    if value is None:
        return None
    numbers = [part for zone in value for part in zone] if all(isinstance(zone, list) for zone in value) else [None]
    if any(isinstance(part, bool) or not isinstance(part, (int, float, str)) for part in numbers):
        raise ValueError("no zones")
    return tuple((_crossovers(until), _crossovers(side)) for until, side in value)


def _crossovers(value):
    """A number of crossovers, or a fraction of one such as "1/3"."""
    if not isinstance(value, str):
        return float(value)
    over, _, under = value.partition("/")
    if int(under) == 0:
        raise ValueError("divided by 0")
    return int(over) / int(under)


MOST_PLIES = 100
BESIDE_ANGLES = "where a ply is at another angle than 0 and 90 deg"


class PlyTable(Table):
    """One table for each group of plies that are alike, from the struck side to the back. `panel.plies` and
    `panel.stacking` are then left out.

    [[panel.ply]]
    count = 2

    [[panel.ply]]
    name = "S-726"
    angle = "45 deg"
    gap = "0.1 mm"
    """

    name: string(
        "fabric of the catalogue; without name and file the fabric of the table [fabric]",
        "the name of a fabric of the catalogue",
    ) = None  # fmt: skip
    file: string("fabric file; its path is relative to the input file", "the path of a fabric file (*.toml)") = None
    law: Annotated[Law | None, described(
        "compression law of the ply; where not given `published`, for plies of [fabric] the law of `fabric.law`", LAW,
    )] = None  # fmt: skip
    angle: from_text(
        float, _ply_angle,
        "angle of the warp of the ply to that of a ply at 0, towards its weft; another one than 0 and 90 deg needs "
        "clamped edges and pinned crossovers, and has the whole panel modelled",
        'an angle from -180 to 180 deg, such as "45 deg"', "rad", "45 deg",
    ) = 0.0  # fmt: skip
    gap: quantity(
        "clearance to the next ply at rest; where not given `panel.ply_gap`, else the mean of the gaps of both "
        "fabrics", "m", "0.12 mm", zero=True,
    ) = None  # fmt: skip
    count: whole("number of plies that are alike", 1, MOST_PLIES) = 1

    @model_validator(mode="after")
    def _of_one_fabric(self):
        if self.name is not None and self.file is not None:
            raise InputError("give one of panel.ply.name and panel.ply.file")
        return self


class PanelTable(Table):
    """The opening, how the yarns are held, and the plies: one, several alike, or a lay-up of tables `[[panel.ply]]`.

    [panel]
    opening = "150 mm"
    boundary = "clamped"
    plies = 4
    """

    opening: from_text(
        float | tuple[float, float], _opening,
        "side of the square opening of the frame, or both sides; diameter of a round one",
        f'a length above 0 and at most {WIDEST:g} m, such as "203 mm", or a list of two, along warp and weft',
        "m", "203 mm", TEXT_OR_TWO,
    )  # fmt: skip
    opening_shape: one_of("shape of the opening; a round one needs clamped edges", "rectangular", "round") = (
        "rectangular"
    )
    impact_point: Annotated[
        quantities(
            "where the projectile hits, from the middle of the opening along its two sides. Where not given the "
            "middle; of one ply with sliding crossovers, computed whole, a quarter of the spacing off a crossover in "
            "both directions. Off the middle it needs a symmetry across which it is 0, `half` for a point on the "
            "second axis, else `whole`; with pinned crossovers also clamped edges",
            "m", "a list of two lengths", '["20 mm", "0 mm"]',
        ),
        Field(min_length=2, max_length=2),
    ] = None  # fmt: skip
    boundary: Annotated[Boundary, described("how the yarns end at the frame", _BOUNDARY)] = "clamped"
    symmetry: one_of(
        "modelled part of the panel; half: x >= 0, for a shot that flies in the plane x = 0 (azimuth 90 deg). Where "
        "not given, one ply with sliding crossovers is whole: symmetry can decide its outcome",
        "quarter", "half", "whole",
    ) = "quarter"  # fmt: skip
    weave_angle: angle("angle of the warp to the sides of the opening", -89, 89, "45 deg") = 0.0
    plies: whole("number of plies; above 1 a pack with contact between plies", 1, MOST_PLIES) = 1
    ply: Annotated[tuple[PlyTable, ...], BeforeValidator(as_tuple), Field(description="tables [[panel.ply]]")] = ()
    stacking: one_of("pack: all plies alike, or every second one turned by 90 degrees", "aligned", "alternating") = (
        "aligned"
    )
    ply_gap: quantity(
        "pack: clearance between plies at rest; where not given the gap of the fabric file, else an assumed gap with "
        "a range ([Packs](../pack.md))", "m", "0.12 mm", zero=True,
    ) = None  # fmt: skip
    ply_contact: Annotated[Any, BeforeValidator(_ply_contact), WithJsonSchema(TEXT), described(
        "pack: law of pressure against closure between two plies; where not given the law in the file of "
        "`fabric.law`, in the fabric file, or of solid fibre, in this order ([theory](../theory-panel.md))",
        _PLY_CONTACT,
    )] = None  # fmt: skip
    ply_friction: number("pack: Coulomb coefficient between plies", 0.2, ge=0.0, le=2.0) = 0.0
    yarn_failure: flag("whether a yarn fails at its strength") = True
    rate_dependence: flag(
        "strength of the yarns as a function of their strain rate, and their modulus at high rates, from the table "
        "`[strain_rate]` of the fabric file, else assumed by fibre family ([strength](../reports/strength.md))"
    ) = False  # fmt: skip
    grading: Annotated[
        tuple[tuple[float, float], ...] | None,
        BeforeValidator(_zones),
        WithJsonSchema({"type": "array", "items": _ZONE}),
        described(
            "coarser mesh with the distance from the impact point: zones of distance and element side, in crossovers",
            'zones [until, side] in crossovers, the last until inf, such as [[9, "1/2"], [20, 1], [inf, 2]]',
        ),
    ] = None
    crossovers: one_of(
        "whether warp and weft are pinned to each other where they cross, or slide against friction "
        "([sliding](../reports/sliding.md))", "pinned", "sliding",
    ) = "pinned"  # fmt: skip
    crossover_friction: number(
        "sliding crossovers: Coulomb coefficient of yarn on yarn; 0.2 (assumed) where not given", 0.3, ge=0.0, le=2.0
    ) = None
    crossover_cohesion: quantity(
        "sliding crossovers: friction of a crossover without contact force; 0 where not given", "N", "0.1 N", zero=True
    ) = None

    @property
    def angled(self) -> bool:
        """Whether a ply of a lay-up is at another angle than 0 and 90 deg."""
        return any(ply.angle not in (0.0, math.pi / 2) for ply in self.ply)

    @model_validator(mode="after")
    def _of_a_lay_up(self):
        """The panel with the number of the plies of its tables [[panel.ply]]."""
        if not self.ply:
            return self
        for key in {"plies", "stacking"} & self.model_fields_set:
            raise InputError(key=key, allowed="left out beside [[panel.ply]]")
        self.refuse("weave_angle", "left out with [[panel.ply]]")
        plies = sum(ply.count for ply in self.ply)
        if not 2 <= plies <= MOST_PLIES:
            allowed = f"2 to {MOST_PLIES} plies in all; [fabric] alone is one ply"
            raise InputError(key="ply", value=f"{plies} plies", allowed=allowed)
        return self.model_copy(update={"plies": plies})

    @model_validator(mode="after")
    def _of_one_or_more_plies(self):
        if not self.yarn_failure:
            self.refuse("rate_dependence", "left out where yarns do not fail")
        if self.crossovers == "pinned":
            self.refuse("crossover_friction crossover_cohesion", "left out where crossovers are pinned")
        if self.angled:
            self.refuse("boundary", f"clamped {BESIDE_ANGLES}")
            self.refuse("crossovers", f"pinned {BESIDE_ANGLES}")
        if self.plies == 1:
            self.refuse("stacking ply_gap ply_contact ply_friction", "left out for a single ply")
        if self.weave_angle != 0:
            self.refuse("stacking", "aligned where the weave is oblique")
        return self

    @model_validator(mode="after")
    def _of_the_modelled_part(self):
        """The whole panel where a ply is at an angle, and of one ply of sliding yarns unless its symmetry is given."""
        given = "symmetry" in self.model_fields_set
        if self.angled and given and self.symmetry != "whole":
            raise InputError(key="symmetry", allowed=f"whole, or left out, {BESIDE_ANGLES}")
        slides = self.crossovers == "sliding" and self.plies == 1 and not given
        return self.model_copy(update={"symmetry": "whole"}) if self.angled or slides else self


class BackingTable(Table):
    """A block behind the last ply: a material by name, or by its data.

    [backing]
    material = "Roma Plastilina No. 1"
    size = ["150 mm", "150 mm", "60 mm"]
    """

    material: string(
        "backing of `weavecell backings list`; its data stand for keys of the material that are not given",
        "the name of a backing",
    ) = None  # fmt: skip
    size: quantities(
        "length, width and thickness of the block", "m", "a list of three lengths", '["300 mm", "300 mm", "180 mm"]'
    ) = None
    standoff: quantity("clearance between last ply and face of the block", "m", "0.5 mm", zero=True) = 0.0
    modulus: quantity("Young's modulus of the block", "Pa", "100 MPa") = None
    density: quantity("density of the block", "kg/m^3", "3 g/cm^3") = None
    poisson: number("Poisson's ratio of the block", 0.4, ge=0.0, lt=0.5) = None
    yield_stress: quantity("initial yield stress of the block at slow rates (J2 plasticity)", "Pa", "20 MPa") = None
    hardening: quantity("isotropic hardening modulus of the block", "Pa", "0 Pa", zero=True) = None
    erosion_strain: number("effective plastic strain at which an element is eroded", 0.9, gt=0.0) = None
    rate_exponent: number(
        "exponent m of the rate: the yield stress is multiplied by (1 + rate / reference_rate)^m", 0.1, ge=0.0, le=1.0
    ) = None
    reference_rate: quantity("reference_rate in that formula, a rate of effective plastic strain", "1/s", "1 / s") = (
        None
    )
    outer_boundary: one_of(
        "condition on the faces other than the struck one: fixed, absorbing (dashpots) or free",
        "fixed", "absorbing", "free",
    ) = None  # fmt: skip
    min_size: quantity("edge length of the smallest elements, under the impact point", "m", "1 mm") = None
    refined_depth: quantity("extent of the smallest elements from the axis and from the face", "m", "8 mm") = None
    growth: number("ratio of the edge lengths of neighbouring elements outside the refined region", 1.3, ge=1.0) = None
    after_stop: quantity(
        "time for which the run goes on after the projectile has stopped, so that the block comes to rest; where not "
        "given, the run ends with the dent as it is then", "s", "1 ms", zero=True, most="10 ms",
    ) = None  # fmt: skip

    @model_validator(mode="after")
    def _of_three_lengths(self):
        if self.size is not None and len(self.size) != 3:
            raise InputError(key="size", allowed="three lengths")
        return self


class RunTable(Table):
    """End of the run, mesh, and the files that are written.

    [run]
    end_time = "400 us"
    elements_per_crossover = 1
    outputs = ["paraview", "report"]
    """

    end_time: quantity(
        "latest end of the run; it ends earlier when the projectile stops (see backing.after_stop) or has perforated",
        "s", "250 us", most="10 ms",
    ) = 800e-6  # fmt: skip
    elements_per_crossover: whole(
        "elements along each side of a crossover; where not given, 1 for one ply, and for a pack 2 about the impact "
        "point and longer ones outside", 1, 8,
    ) = None  # fmt: skip
    snapshot_interval: quantity("time between the shapes kept for ParaView and the pictures", "s", "10 us") = 1e-5
    checkpoint_interval: quantity(
        "time between checkpoints for `--resume`; in the first 10 s of wall time, and within 10 s of the last, none "
        "is written", "s", "50 us",
    ) = 5e-5  # fmt: skip
    outputs: some_of(
        "which outputs are written beside `histories.h5` and `summary.json`", "paraview", "pictures", "report"
    ) = ("paraview", "pictures", "report")

    @model_validator(mode="after")
    def _within_the_run(self):
        for key in ("snapshot_interval", "checkpoint_interval"):
            if key in self.model_fields_set and getattr(self, key) > self.end_time:
                raise InputError(key=key, allowed="at most run.end_time")
        return self


_YARNS = "a list of distances of {} yarns from the impact point"


class HistoryTable(Table):
    """Tension, strain and position along single yarns, and reactions at the edges, against time.

    [history]
    warp = ["0 mm", "10 mm"]
    report_positions = ["5 mm", "50 mm"]
    """

    interval: quantity("time between samples along yarns and at the edges", "s", "1 us") = 1e-6
    warp: quantities("warp yarns that are recorded", "m", _YARNS.format("warp"), '["0 mm", "10 mm"]') = (0.0,)
    weft: quantities("weft yarns that are recorded", "m", _YARNS.format("weft"), '["0 mm", "10 mm"]') = (0.0,)
    report_positions: quantities(
        "positions along the yarns at which the report plots tension and strain",
        "m", "a list of positions along the yarns", '["5 mm", "50 mm"]',
    ) = (5e-3, 20e-3, 50e-3, 80e-3)  # fmt: skip


def _share(meaning):
    return quantity(meaning, "", "2 %", most="50 %", kind="a share {}")


class AccuracyTable(Table):
    """Largest errors that the results may have; the command refines the mesh until they are met.

    [accuracy]
    residual_velocity = "2 %"
    deflection = "5 %"
    """

    residual_velocity: _share("target: error at most, over the strike velocity") = None
    absorbed_energy: _share("target: error at most, over the strike energy") = None
    deflection: _share("target: relative error of the maximum deflection at most") = None
    peak_tension: _share("target: relative error of the peak tension at most") = None

    @property
    def targets(self) -> dict[str, float]:
        """{quantity: [-] error at most} of those that are given."""
        return {name: share for name, share in self if share is not None}

    @model_validator(mode="after")
    def _of_one_target(self):
        if not self.targets:
            raise InputError("has no target", allowed=f"at least one of {', '.join(type(self).model_fields)}")
        return self


class NumericsTable(Table):
    """Parameters of the time integration and of the contact with the projectile. The defaults fit all fabrics.

    [numerics]
    cfl = 0.8
    threads = 1
    """

    cfl: number("time step over its stability bound (Courant factor)", 0.5, gt=0.0, le=1.0) = None
    stretch_viscosity: number("damping ratio of the highest mode along a yarn", 0.2, ge=0.0, le=1.0) = None
    penalty: number(
        "stiffness of the contact between projectile and fabric, in units of nodal mass over the square of the time "
        "step", 0.3, gt=0.0,
    ) = None  # fmt: skip
    contact_damping: number("damping ratio of the contact between projectile and fabric", 0.6, ge=0.0) = None
    contact_points: whole(
        "contact points along each side of a crossover; where not given 8, and more under a sharp nose", 1, 64
    ) = None
    threads: Annotated[int | None, described(
        "threads of the time integration; where not given, chosen by the size of the model. Results do not depend on "
        "it", "a number of threads", example=1, ge=1,
    )] = None  # fmt: skip


class Scene(Table):
    """The title, a key before the first table:

    title = "S-728, 1.10 g FSP at 200 m/s"
    """

    title: string("heading of the report", "a text") = ""
    fabric: Annotated[FabricTable, Field(description="a table [fabric]")] = FabricTable()
    projectile: Annotated[ProjectileTable, Field(description="a table [projectile]")]
    panel: Annotated[PanelTable, Field(description="a table [panel]")]
    run: Annotated[RunTable, Field(description="a table [run]")] = RunTable()
    history: Annotated[HistoryTable | None, Field(description="a table [history]")] = None
    accuracy: Annotated[AccuracyTable | None, Field(description="a table [accuracy]")] = None
    numerics: Annotated[NumericsTable, Field(description="a table [numerics]")] = NumericsTable()
    backing: Annotated[BackingTable | None, Field(description="a table [backing]")] = None

    @model_validator(mode="after")
    def _of_tables_that_fit(self):
        fabric, shot, panel = self.fabric, self.projectile, self.panel
        if not (panel.ply and all(ply.name or ply.file for ply in panel.ply) and fabric.name is fabric.file is None):
            if "fabric" not in self.model_fields_set or not fabric.model_fields_set:
                allowed = "a table [fabric], which may be left out where every [[panel.ply]] has name or file"
                raise InputError("is missing", key="fabric", allowed=allowed)
            exactly_one(fabric, ("name", "file"), "fabric")
        smallest = min(panel.opening) if isinstance(panel.opening, tuple) else panel.opening
        if shot.diameter >= smallest / 2:
            raise InputError(key="projectile.diameter", allowed="below half of panel.opening")
        if shot.shape != "stl":
            stl_file.check_mass(shot)
        if self.accuracy is not None and panel.crossovers != "pinned":
            words = '"pinned" where the mesh is chosen by [accuracy]'
            raise InputError(key="panel.crossovers", allowed=words)
        if fabric.surface is None:
            return self
        if panel.ply:
            raise InputError(key="fabric.surface", allowed="left out with [[panel.ply]]")
        for key, words in (
            ("rate_dependence", "left out with fabric.surface, whose yarns have one modulus"),
            ("stacking", "aligned where the cell is a response surface"),
        ):
            if panel.sets(key):
                raise InputError(key=f"panel.{key}", allowed=words)
        return self


def load(path: FilePath, refused: honoured.Keys | None = None) -> tuple[Scene, str]:
    """Read and check a scene file.

    Parameters
    ----------
    path : of the file
    refused : keys that what reads it does not honour (`honoured`); None where any key may be set

    Returns
    -------
    scene : Scene, in SI units, its paths taken from the folder of the file
    text : the file as written, for the record

    Raises
    ------
    InputError : one line naming the file, the key, its value and what is allowed
    """
    path = Path(path)
    text, table = read_toml(path, what="scene")
    return check(table, path, refused), text


def check(
    table: dict[str, Any], file: FilePath | None, refused: honoured.Keys | None = None, context: Any = None
) -> Scene:
    """Turn a scene's table into a checked Scene.

    Parameters
    ----------
    table : as it is written
    file : named in errors, its folder anchors relative paths; None of a scene without a file
    refused : as of `load`
    context : as of `fabrics.schema.validated`
    """
    table = _with_named(table, file, "projectile", "name", projectiles)
    table = stl_file.described(table, ProjectileTable.model_fields, file)
    table = _with_named(table, file, "backing", "material", backings)
    scene = validated(Scene, table, file, context)
    if refused is not None:
        honoured.check(scene, table, file, refused)
        if "panel.symmetry" in refused and scene.panel.crossovers == "sliding" and scene.panel.plies == 1:
            panel = scene.panel.model_copy(update={"symmetry": "whole"})
            scene = scene.model_copy(update={"panel": panel})
    return scene if file is None else anchored(scene, file)


def _with_named(table, file, name, key, data):
    """The table with the data of what [name] names by its `key`, as if they were written there."""
    given = table.get(name)
    if not isinstance(given, dict) or not isinstance(given.get(key), str):
        return table
    return table | {name: data.table(given[key], given, file=file, key=f"{name}.{key}")}
