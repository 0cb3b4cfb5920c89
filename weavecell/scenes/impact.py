"""Scene files: one impact, described in TOML with units as text, checked before anything is
computed or written."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import ConfigDict, Field, model_validator

from fabrics import backings, projectiles
from fabrics.base import written
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.schema import (
    AsDict,
    AsKeywords,
    FileOnly,
    NoPlace,
    StandardShot,
    Table,
    Unread,
    angle,
    list_unread,
    marked,
    number,
    one_of,
    quantities,
    quantity,
    some_of,
    string,
    tables_in,
    validated,
)
from fabrics.materials import IsotropicKeys
from shellfabric import shot_keys
from shellfabric.block.block_keys import BlockKeys
from shellfabric.loop.history_keys import HistoryKeys
from shellfabric.membrane.numerics import NumericsKeys
from shellfabric.projectile import shapes
from shellfabric.projectile.body_numbers import BodyNumbers
from shellfabric.projectile.shapes import SHAPES, NoseNumbers
from weavecell.scenes import kept_files, presets, stl_file
from weavecell.scenes.fabric_table import (
    OF_ONE_FABRIC,
    FabricTable,
    Reader,
    check_scene,
    exactly_one,
)
from weavecell.scenes.panel import PanelTable


def _name_or_size(schema):
    """The JSON Schema of [projectile] as files have it: what `projectiles` knows of a name is not
    required."""
    schema["required"] = ["strike_velocity"]
    schema["anyOf"] = [
        {"required": ["name"]},
        {"required": ["mass", "diameter"]},
        {"required": ["stl"]},
    ]


class ProjectileTable(Table, NoseNumbers, BodyNumbers):  # type: ignore[misc] # frozen by its model_config
    """A projectile by `name`, or by mass, diameter and edge radius. It strikes the middle of the
    panel. It is rigid unless `body` says otherwise.

    [projectile]
    name = "FSP 1.10 g"
    strike_velocity = "200 m/s"
    friction = 0.1
    """

    model_config = ConfigDict(json_schema_extra=_name_or_size)

    synonyms: ClassVar = {
        "velocity": "strike_velocity",
        "speed": "strike_velocity",
        "weight": "mass",
        "caliber": "diameter",
        "calibre": "diameter",
        "type": "shape",
        "material": "body",
    }

    name: string(
        "projectile of `weavecell projectiles list`, or the path of a file of these keys, from the folder of the input "
        "file; its values replace keys that are not given, also required ones",
        "the name of a projectile, or the path of a projectile file (*.toml)",
    ) = None
    mass: Annotated[
        quantity(
            "mass, with a mean density from 0.5 to 23 g/cm^3; a length that is not given may be 0.25 to 30 diameters",
            "kg",
            "3 g",
        ),
        StandardShot("3 g"),
    ]
    diameter: Annotated[quantity("diameter", "m", "5.5 mm"), StandardShot("5.5 mm")]
    edge_radius: Annotated[
        quantity(
            "rounding of the edges; required except for a sphere. Of an STL file the smallest radius of the nose's "
            "edges, to which sharp ones are rounded",
            "m",
            "0.3 mm",
        ),
        StandardShot("0.3 mm"),
    ] = None
    strike_velocity: Annotated[
        shot_keys.STRIKE_VELOCITY,
        FileOnly(),
        StandardShot("92.5 m/s"),
        Unread("limit v50"),
    ]
    shape: one_of("shape of the nose", *SHAPES) = "flat"
    length: quantity(
        "overall length; without it a cylinder has no rear end, and the elastic bar has the length given in the thesis",
        "m",
        "8 mm",
    ) = None
    stl: string(
        "STL file of the body, its z axis along the flight; required for the shape stl. Its path is relative to the "
        "input file",
        "the path of an STL file (*.stl)",
    ) = None
    stl_unit: one_of("unit of the lengths in the STL file; required with it", *stl_file.UNITS) = (
        None
    )
    density: quantity(
        "density of the body of an STL file, in place of its mass", "kg/m^3", "7.85 g/cm^3"
    ) = None
    obliquity: angle("angle between line of flight and normal of the panel", 0, 75, "30 deg") = 0.0
    azimuth: angle(
        "direction of the obliquity in the plane of the panel, from the warp", -360, 360, "90 deg"
    ) = 0.0
    yaw: angle("angle between axis and line of flight", -75, 75, "5 deg") = 0.0
    roll: angle(
        "rotation about the axis of a chisel or a body of an STL file", -360, 360, "45 deg"
    ) = 0.0
    friction: number(
        "Coulomb coefficient between projectile and fabric; assumed by fibre family if not given",
        0.2,
        ranged=True,
        ge=0.0,
        le=2.0,
    ) = None
    body: Annotated[
        one_of(
            "rigid body; elastic-plastic steel bar along the axis (one-dimensional waves); or body of revolution of "
            "metal, which mushrooms (flat, hemisphere, ogive or sphere)",
            "rigid",
            "elastic_bar",
            "metal",
        ),
        Unread("export", '"rigid"'),
    ] = "rigid"

    @classmethod
    def required_by(cls, given: Mapping[str, Any]) -> tuple[str, ...]:
        """Return what the shape needs, and the other one of two keys that are given together."""
        keys: tuple[str, ...] = ()
        shape = given.get("shape", "flat")
        if shape in list(SHAPES):
            # a body of an STL file is made from its file
            keys += ("stl", "stl_unit") if SHAPES[shape].from_file else shapes.needed(shape)
            if SHAPES[shape].edged:
                keys += ("edge_radius",)
        for pair in (("jacket", "jacket_thickness"), ("cavity_diameter", "cavity_depth")):
            if any(given.get(key) is not None for key in pair):
                keys += pair
        return keys

    @model_validator(mode="after")
    def _check_body(self):
        for name, bodies in list_unread(BodyNumbers, self, self.body):
            raise InputError(key=name, allowed=f'left out but for the body "{bodies}"')
        if not SHAPES[self.shape].from_file:
            self.refuse("stl stl_unit density", 'left out but for the shape "stl"')
        if self.obliquity == 0 and self.yaw == 0:
            self.refuse("azimuth", "left out without obliquity and yaw: it is their direction")
        if SHAPES[self.shape].turned:
            self.refuse("roll", f"left out for {SHAPES[self.shape].words}, alike from all sides")
        if not SHAPES[self.shape].edged:
            self.refuse("edge_radius", f"left out for {SHAPES[self.shape].words}")
        elif self.edge_radius >= self.diameter / 2:
            raise InputError(key="edge_radius", allowed="below half of projectile.diameter")
        return self


class BackingTable(Table, BlockKeys, IsotropicKeys):  # type: ignore[misc] # frozen by its model_config
    """A block behind the last ply: a material by name, or by its data.

    [backing]
    material = "Roma Plastilina No. 1"
    size = ["150 mm", "150 mm", "60 mm"]
    """

    synonyms: ClassVar = {
        "name": "material",
        "thickness": "size",
        "youngs_modulus": "modulus",
        "yield": "yield_stress",
        "gap": "standoff",
    }

    material: string(
        "backing of `weavecell backings list`; its values replace keys of the material that are not given",
        "the name of a backing",
    ) = None

    @model_validator(mode="after")
    def _check_material(self):
        data = (self.density, self.modulus, self.poisson, self.yield_stress, self.hardening)
        if self.material is None and not any(number is not None for number in data):
            raise InputError(
                "is missing",
                key="material",
                allowed="the name of a backing (`weavecell backings list`), or its data: density, modulus, "
                "poisson and yield_stress",
            )
        return self

    @model_validator(mode="after")
    def _check_three_lengths(self):
        if len(self.size) != 3:
            raise InputError(key="size", allowed="three lengths")
        return self


# functions that write no files of a shot
OF_MANY = "limit v50 sweep export"


class RunTable(Table):
    """End of the run, mesh, and the files that are written.

    [run]
    end_time = "400 us"
    elements_per_crossover = 1
    outputs = ["paraview", "report"]
    """

    synonyms: ClassVar = {
        "duration": "end_time",
        "time": "end_time",
        "elements": "elements_per_crossover",
    }

    end_time: Annotated[
        shot_keys.END_TIME,
        Unread("limit v50"),
    ] = 800e-6
    elements_per_crossover: shot_keys.ELEMENTS = None
    snapshot_interval: Annotated[
        shot_keys.SNAPSHOT_INTERVAL,
        Unread(OF_MANY),
        NoPlace("export"),
    ] = 1e-5
    checkpoint_interval: Annotated[
        quantity(
            "time between checkpoints for `--resume`; in the first 10 s of wall time, and within 10 s of the last, "
            "none is written",
            "s",
            "50 us",
        ),
        FileOnly(),
        Unread(OF_MANY),
        NoPlace("export"),
    ] = 5e-5
    outputs: Annotated[
        some_of(
            "which outputs are written beside `histories.h5` and `summary.json`",
            "paraview",
            "pictures",
            "report",
        ),
        FileOnly(),
        Unread(OF_MANY),
        NoPlace("export"),
    ] = ("paraview", "pictures", "report")

    @model_validator(mode="after")
    def _check_within_run(self):
        for key in ("snapshot_interval", "checkpoint_interval"):
            # the defaults may be longer than a short run; a value that is given may not
            if key in self.model_fields_set and getattr(self, key) > self.end_time:
                raise InputError(key=key, allowed="at most run.end_time")
        return self


NO_HISTORY = "left out: {} nothing along yarns; `weavecell impact` does"


class HistoryTable(Table, HistoryKeys):  # type: ignore[misc] # frozen by its model_config
    """Tension, strain and position along single yarns, and reactions at the edges, against time.

    [history]
    warp = ["0 mm", "10 mm"]
    report_positions = ["5 mm", "50 mm"]
    """

    report_positions: Annotated[
        quantities(
            "positions along the yarns at which the report plots tension and strain",
            "m",
            "a list of positions along the yarns",
            '["5 mm", "50 mm"]',
        ),
        Unread("setup", "left out: `weavecell.setup` does not support it"),
    ] = (5e-3, 20e-3, 50e-3, 80e-3)


class NumericsTable(Table, NumericsKeys):  # type: ignore[misc] # frozen by its model_config
    """Parameters of the time integration and of the contact with the projectile. The defaults fit
    all fabrics.

    [numerics]
    cfl = 0.8
    threads = 1
    """


class Scene(Table):
    """The title, a key before the first table:

    title = "S-728, 1.10 g FSP at 200 m/s"
    """

    title: Annotated[string("heading of the report", "a text"), Unread("limit v50 sweep")] = ""
    fabric: Annotated[FabricTable, Field(description="a table [fabric]"), AsKeywords()] = (
        FabricTable()
    )
    projectile: Annotated[
        ProjectileTable, Field(description="a table [projectile]"), AsDict("name")
    ]
    panel: Annotated[PanelTable, Field(description="a table [panel]"), AsKeywords()]
    run: Annotated[RunTable, Field(description="a table [run]"), AsKeywords()] = RunTable()
    history: Annotated[
        HistoryTable | None,
        Field(description="a table [history]"),
        AsDict(),
        Unread("limit v50", NO_HISTORY.format("the shots record")),
        Unread("sweep", NO_HISTORY.format("a sweep records")),
        NoPlace("export"),
    ] = None
    numerics: Annotated[
        NumericsTable,
        Field(description="a table [numerics]"),
        AsDict(),
        NoPlace("export"),
    ] = NumericsTable()
    backing: Annotated[
        BackingTable | None,
        Field(description="a table [backing]"),
        AsDict("material"),
        Unread("export", "left out: a block behind the fabric is not exported"),
    ] = None

    @model_validator(mode="after")
    def _check_tables_fit(self):
        fabric = self.fabric
        shot = self.projectile
        panel = self.panel
        # [fabric] may be missing only if every ply names its own fabric
        if not (
            panel.ply
            and all(ply.name or ply.file for ply in panel.ply)
            and fabric.name is fabric.file is None
        ):
            if "fabric" not in self.model_fields_set or not fabric.model_fields_set:
                allowed = "a table [fabric], which may be left out if every [[panel.ply]] has name or file"
                raise InputError("is missing", key="fabric", allowed=allowed)
            exactly_one(fabric, ("name", "file"), "fabric")
        named = [ply.names_fabric for ply in panel.ply]
        for key in OF_ONE_FABRIC if panel.ply else ():
            taken = any(not ply.names_fabric and getattr(ply, key) is None for ply in panel.ply)
            if not taken and getattr(fabric, key) is not None and key in fabric.model_fields_set:
                own = "" if key in ("name", "file") else f" or has {key}"
                words = f"left out where each [[panel.ply]] names its fabric{own}: no ply takes it"
                raise InputError(key=f"fabric.{key}", allowed=words)
        if any(named) and fabric.sets("bending"):
            words = "left out where a [[panel.ply]] names its fabric: it would be that of all yarns"
            raise InputError(key="fabric.bending", allowed=words)
        if panel.grading and self.run.sets("elements_per_crossover"):
            words = "left out with panel.grading, which says how large the elements are"
            raise InputError(key="run.elements_per_crossover", allowed=words)
        if not panel.yarn_failure and self.numerics.sets("erosion_gap"):
            words = "left out without panel.yarn_failure: no yarn is taken out"
            raise InputError(key="numerics.erosion_gap", allowed=words)
        if isinstance(panel.opening, tuple):
            smallest = min(panel.opening)
        else:
            smallest = panel.opening
        # a nose as wide as the opening would strike the clamp
        if shot.diameter >= smallest / 2:
            raise InputError(key="projectile.diameter", allowed="below half of panel.opening")
        # the mass of a body from a file is checked against its volume there
        if not SHAPES[shot.shape].from_file:
            stl_file.check_mass(shot)
        # a response surface belongs to one fabric with one modulus, all yarns alike
        if fabric.surface is None:
            return self
        if panel.ply:
            raise InputError(key="fabric.surface", allowed="left out with [[panel.ply]]")
        for key, words in (
            ("rate_dependence", "left out with fabric.surface, whose yarns have one modulus"),
            ("stacking", "aligned if the cell is a response surface"),
        ):
            if panel.sets(key):
                raise InputError(key=f"panel.{key}", allowed=words)
        return self


def standard_shot() -> dict[str, dict[str, str]]:
    """Return {table: {key: value as it stands in a file}} of the shot of the thesis' tests: one ply,
    203 mm square and clamped, struck by the flat cylinder of 3 g and 5.5 mm."""
    shot = {}
    for name, entry in Scene.model_fields.items():
        for table in tables_in(entry.annotation):
            values = {key: mark.value for key, mark in marked(table, StandardShot).items()}
            if values:
                shot[name] = values
    return shot


def check(
    table: dict[str, Any],
    file: FilePath | None,
    reader: Reader | None = None,
    context: Any = None,
) -> Scene:
    """Turn a scene's table into a checked Scene.

    Parameters
    ----------
    table : as it is written
    file : named in errors, its folder anchors relative paths; None of a scene without a file
    reader, context : see `check_scene`

    Returns
    -------
    Scene, in SI units, its paths taken from the folder of the file

    Raises
    ------
    InputError : one line naming the file, the key, its value and what is allowed
    """
    # what is named here is looked up before the scene is made
    if file is None:
        written.keep(None, "", table)
    table = kept_files.use_copies_of_missing(table, file)
    filled = presets.fill(table, file)
    written.note_fills(file, table, filled, "panel.preset")
    table = _with_named(filled, file, "projectile", "name", projectiles)
    filled = stl_file.describe_stl(table, ProjectileTable.model_fields, file)
    written.note_fills(file, table, filled, "projectile.stl")
    table = _with_named(filled, file, "backing", "material", backings)
    return check_scene(Scene, table, file, reader, context)


def _with_named(table, file, name, key, data):
    """The table with the data of what [name] names by its `key`, as if they were written there."""
    given = table.get(name)
    if not isinstance(given, dict) or not isinstance(given.get(key), str):
        return table
    named = data.table(given[key], given, file=file, key=f"{name}.{key}")
    # the fabric file has errors of its own, which name that file
    if given[key].endswith(".toml"):
        own = data.table(given[key], file=file) | {"strike_velocity": "1 m/s"}
        validated(ProjectileTable, own, Path(file or "").parent / given[key])
    filled = table | {name: named}
    written.note_fills(file, table, filled, f"{name}.{key}")
    return filled
