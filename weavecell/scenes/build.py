"""From a checked scene to the objects of the solver: fabric, compression laws, set-up of the impact."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import assumed, catalogue
from fabrics.checks import FilePath
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.materials import Isotropic, load
from fabrics.ply_law import PlyLaw
from fabrics.surface import ResponseSurface
from fabrics.variants import with_linear_density
from fabrics.yarn import WeavingDamage
from weavecell.scenes import stl_file, supported
from weavecell.scenes.impact import BESIDE_ANGLES, Scene, is_angled
from weavecell.scenes.schema import FabricTable, InlineLaw, Table
from weavecell.scenes.supported import Rule, of
from weavecell.scenes.words import shot_in_words

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup, Ply

LOG = logging.getLogger("weavecell")  # the command line prints its lines
_OF_A_PACK = of("panel", "stacking ply_gap ply_contact ply_friction")
# keys whose field in the objects of shellfabric has another name
FIELDS = {
    "fabric.cell_formulation": "form",
    "fabric.crossover_gap": "gap",
    "fabric.cell_profile": "profile",
    "panel.boundary": "edge",
    "panel.yarn_failure": "failure",
    "picture_frame.crossovers": "cells",
}
NO_SLACK = {"fabric.fibre_slack": "left out in an impact"}  # a yarn whose crossings have failed is linear in the march
# of sliding crossovers, which need a mesh of one element a crossover
PINNED = {"panel.crossovers": '"pinned" where the mesh is chosen by [accuracy]'} | dict.fromkeys(
    ("panel.crossover_friction", "panel.crossover_cohesion"), "left out where crossovers are pinned"
)
CELL_RULES = (
    *(
        Rule(f"fabric.{key}", lambda scene: scene.fabric.surface is not None, "left out with fabric.surface")
        for key in ("law", "cell_model", "crossover_gap", "cell_profile", "fibre_slack", "weaving_damage")
    ),
    Rule(
        "fabric.law",
        lambda scene: scene.fabric.cell_model != "compressible",
        'left out where fabric.cell_model is "incompressible" or "decoupled", whose yarns are not compressed',
    ),
    Rule(
        "fabric.crossover_gap",
        lambda scene: scene.fabric.cell_model == "decoupled",
        'left out where fabric.cell_model is "decoupled", whose yarns never touch',
    ),
)
SHOT_RULES = (
    *CELL_RULES,
    *(
        Rule(f"projectile.{key}", lambda scene: scene.projectile.shape != "stl", 'left out but for the shape "stl"')
        for key in ("stl", "stl_unit", "density")
    ),
    Rule("panel.rate_dependence", lambda scene: not scene.panel.yarn_failure, "left out where yarns do not fail"),
    Rule(
        "panel.rate_dependence",
        lambda scene: scene.fabric.surface is not None,
        "left out with fabric.surface, whose yarns have one modulus",
    ),
    Rule("projectile.bore_diameter", lambda scene: scene.projectile.body == "rigid", "left out for a rigid projectile"),
    *(
        Rule(f"panel.{key}", lambda scene: scene.panel.crossovers == "pinned", "left out where crossovers are pinned")
        for key in ("crossover_friction", "crossover_cohesion")
    ),
    *(
        Rule(key, lambda scene: bool(scene.panel.ply), "left out with [[panel.ply]]")
        for key in ("fabric.surface", "panel.weave_angle")
    ),
    *(
        Rule(key, lambda scene: is_angled(scene.panel), f"{allowed} {BESIDE_ANGLES}")
        for key, allowed in (
            ("panel.boundary", "clamped"),
            ("panel.crossovers", "pinned"),
        )
    ),
    *(Rule(key, lambda scene: scene.panel.plies == 1, "left out for a single ply") for key in _OF_A_PACK),
    Rule("panel.stacking", lambda scene: scene.panel.weave_angle != 0, "aligned where the weave is oblique"),
    Rule(
        "panel.stacking", lambda scene: scene.fabric.surface is not None, "aligned where the cell is a response surface"
    ),
)


@dataclass(frozen=True)
class Case:
    """What a scene describes.

    Parameters
    ----------
    name : short name of the run
    fabric : Fabric, with the linear densities that the scene chose
    laws : (warp, weft) CompressionLaw
    law_name : where the laws come from, in words
    scene : Scene
    surface : ResponseSurface that the cell is made from in place of the laws, or None
    lay_up : every simulation.Ply of plies that are not all alike, from the front; the first has fabric and laws
    """

    name: str
    fabric: Fabric
    laws: tuple[CompressionLaw, CompressionLaw]
    law_name: str
    scene: Any
    surface: ResponseSurface | None = None
    lay_up: tuple[Ply, ...] = ()


def build(scene: Any, file: Path, name: str) -> Case:
    """Look up everything that a scene names.

    Raises
    ------
    InputError : a fabric or law that cannot be found or does not fit, named with the scene's file and key
    """
    cloths, plies = lay_up(scene, lambda table, key: _cloth(table, key, scene, file))
    fabric, surface, laws, law_name = cloths[0]
    shot = getattr(scene, "projectile", None)
    if shot is not None and (shot.name is not None or shot.stl is not None):
        LOG.info(f"projectile: {shot_in_words(shot)}")
    return Case(name, fabric, laws, law_name, scene, surface, plies)


def _cloth(table, key, scene, file):
    """(fabric, surface, laws, where they come from) of a table [fabric] that stands under a key of the scene."""
    fabric = _sheared(_with_strength(_fabric(table, key, file), scene, file), scene, file)
    surface = surface_of(table, fabric, file)
    laws, words = (fabric.laws, "3D response surface") if surface is not None else _laws(table, key, fabric, file)
    return _with_ply_contact(fabric, table.law, scene, file), surface, laws, words


def lay_up(scene: Any, make: Callable[[FabricTable, str], Any]) -> tuple[list[Any], tuple[Ply, ...]]:
    """What the plies of a scene are made of, that of the first ply first, and every ply of its tables [[panel.ply]].

    Parameters
    ----------
    scene : whose [fabric] is that of plies that name none
    make : called once for each table [fabric] that differs, with the key that it stands under; gives (fabric, surface,
        laws, where they come from)
    """
    tables = getattr(getattr(scene, "panel", None), "ply", ())
    if not tables:
        return [make(scene.fabric, "fabric")], ()
    from shellfabric.impact.simulation import Ply

    known: dict[str, Any] = {}
    plies: list[Ply] = []
    for table in tables:
        named = {key: getattr(table, key) for key in ("name", "file") if getattr(table, key) is not None}
        own = {"name": None, "file": None, "law": "published", **named} if named else {}
        own |= {} if table.law is None else {"law": table.law}
        if (key := repr(own)) not in known:
            known[key] = make(scene.fabric.model_copy(update=own), "panel.ply" if own else "fabric")
        fabric, _, laws, _ = known[key]
        gap = scene.panel.ply_gap if table.gap is None else table.gap
        plies += [Ply(fabric, laws, table.angle, gap)] * table.count
    return list(known.values()), tuple(plies)


def setup(case: Case, file: FilePath | None) -> ImpactSetup:
    """The impact's set-up for `shellfabric`. With a file, its notes are logged.

    Raises
    ------
    InputError : values that fit each on its own but not together, named with the scene's file
    """
    from shellfabric.impact.simulation import ImpactSetup
    from shellfabric.output.histories import HistoryRequest
    from shellfabric.panel.model import Numerics

    scene, panel = case.scene, case.scene.panel
    of_setup = {field.name for field in fields(ImpactSetup)}
    given: dict[str, Any] = {}
    for name in ("fabric", "panel", "run"):
        given |= {key: value for key, value in _given(getattr(scene, name), name).items() if key in of_setup}
    try:
        made = ImpactSetup(**given | {  # in place of texts and tables the objects that they describe
            "fabric": case.fabric,
            "laws": case.laws,
            "surface": case.surface,
            "lay_up": case.lay_up,
            "strike_velocity": scene.projectile.strike_velocity,
            "projectile": _projectile(scene.projectile),
            "edge": _edge(panel.boundary),
            "round": panel.opening_shape == "round",
            "crossovers": _crossovers(panel),
            "backing": _backing(scene.backing),
            "history": scene.history and HistoryRequest(**_given(scene.history, "history", but=("report_positions",))),
            "numerics": Numerics(**_given(scene.numerics, "numerics")),
        })  # fmt: skip
    except InputError as problem:
        raise in_file(problem, file) from None
    for note in made.notes if file is not None else ():
        LOG.info(f"note: {note}")
    return made


def _crossovers(table):
    """The friction of sliding crossovers; None of pinned ones."""
    if table.crossovers == "pinned":
        return None
    from shellfabric.sliding.model import CrossoverFriction

    given = {"mu": table.crossover_friction, "cohesion": table.crossover_cohesion}
    return CrossoverFriction(**{key: value for key, value in given.items() if value is not None})


def _projectile(table):
    from shellfabric.projectile.projectile import Projectile

    of_stl = ("stl", "stl_unit", "density")
    given = _given(table, "projectile", but=("name", "diameter", "strike_velocity", *of_stl))
    if table.shape != "stl":
        return Projectile(radius=table.diameter / 2, **given)
    solid = stl_file.solid(table.stl, table.stl_unit, table.edge_radius)
    return Projectile(**given | {"solid": solid, "radius": solid.radius, "length": solid.length})


def _given(table, name, but=()):
    """{field: value} of the keys that a table sets."""
    return {FIELDS.get(f"{name}.{key}", key): value for key, value in table if value is not None and key not in but}


def _backing(table):
    """The block that a scene names; what it leaves out is the thesis's, or the mesh's default."""
    if table is None:
        return None
    from shellfabric.backing.block import Backing

    given = _given(table, "backing", but=("material",))
    of_material = {field.name for field in fields(Isotropic)}
    material = replace(load("backing"), **{key: given.pop(key) for key in tuple(given) if key in of_material})
    return Backing(material=material, **given)


def _edge(boundary):
    """The panel's edge as the solver has it, from a text or a table of sides."""
    if isinstance(boundary, str):
        return boundary
    return tuple(
        tuple(_side(end) for end in side) if isinstance(side, tuple) else _side(side)
        for side in boundary.sides.values()
    )


def _side(side):
    from shellfabric.panel.boundary import Grip, PullIn

    if isinstance(side, str):
        return side
    if side.clamp_force is not None:
        return Grip(side.clamp_force)
    return PullIn(side.pull_in, side.start, side.end, **({} if side.zone is None else {"zone": side.zone}))


def of_file(problem: InputError) -> bool:
    """Whether an InputError may be of a key of an input file, and not of a parameter of a command."""
    known = {key.rpartition(".")[2] for key in supported.entries(Scene)} | {"model", *FIELDS.values()}
    return problem.key is None or "." in problem.key or problem.key in known


def in_file(problem: InputError, file: FilePath | None, tables: Mapping[str, type[Table]] | None = None) -> InputError:
    """An InputError of an object that does not know its file, with the scene's file and key in it.

    Parameters
    ----------
    tables : {name: table} of the scene whose keys the object may name; None: those of an impact
    """
    if problem.file is not None:
        return problem
    if tables is None:
        tables = {name: table for name, table in supported.tables(Scene).items() if name and "." not in name}
    keys = {key: f"{name}.{key}" for name, table in tables.items() for key in table.model_fields}
    keys |= {"model": "fabric.cell_model"} | {field: key for key, field in FIELDS.items()}
    key = keys.get(problem.key or "", problem.key)
    if key is None:
        return InputError(str(problem), file=file)
    return InputError(file=file, key=key, value=problem.value, allowed=problem.allowed)


def _fabric(table, key, file):
    if table.file is not None:
        fabric = catalogue.read(table.file)
    elif table.name in catalogue.list_names():
        fabric = catalogue.load(table.name)
    else:
        raise InputError(
            file=file, key=f"{key}.name", value=table.name, allowed=f"one of {', '.join(catalogue.list_names())}"
        )
    return damaged(with_linear_density(fabric, table.linear_density), table)


def damaged(fabric: Fabric, table: FabricTable) -> Fabric:
    """The fabric with the weaving damage that a table [fabric] states."""
    if table.weaving_damage is None:
        return fabric
    return fabric.with_weaving_damage(WeavingDamage(**table.weaving_damage.model_dump()))


def _with_strength(fabric, scene, file):
    """The fabric with what its strength depends on besides the tension, where the scene asks for it."""
    if not getattr(getattr(scene, "panel", None), "rate_dependence", False):
        return fabric
    try:
        return assumed.with_strain_rate(fabric)
    except InputError as problem:
        raise InputError(f"needs more: {problem}", file=file, key="panel.rate_dependence") from None


def _sheared(fabric, scene, file):
    """The fabric with the trellis law that its fabric needs; logs one line where that is assumed or left out."""
    need = getattr(scene, "trellis_law", "needed")
    try:
        fabric = fabric if need == "unused" else assumed.with_shear(fabric)
    except InputError as problem:
        if need == "needed":
            raise InputError(str(problem), file=file) from None
        LOG.info(f"no [shear] of {fabric.name}: its fabric has no shear stiffness")
    for line in assumed.lines(fabric):
        LOG.info(line)
    return fabric


def _with_ply_contact(fabric, law, scene, file):
    """The fabric with the contact law of plies that the scene of a pack names, or that the file of its law holds."""
    panel = getattr(scene, "panel", None)
    if getattr(panel, "plies", 1) == 1:
        return fabric
    try:
        return with_ply_contact(fabric, panel.ply_contact, law)
    except InputError as problem:
        if problem.file is not None:
            raise
        key = "panel.ply_contact" if problem.key in (None, "ply_contact") else problem.key
        message = None if problem.key is not None else str(problem)
        raise InputError(message, file=file, key=key, value=problem.value, allowed=problem.allowed) from None


def with_ply_contact(fabric: Fabric, choice: PlyLaw | FilePath | None, law: object = None) -> Fabric:
    """The fabric with the contact law of plies of `choice` (`PlyLaw.chosen`), or that the file `law` holds.

    Raises
    ------
    InputError : as `PlyLaw.chosen` and `PlyLaw.of`
    """
    if choice is not None:
        return replace(fabric, ply_contact=PlyLaw.chosen(choice, fabric))
    if isinstance(law, (str, Path)) and law != "published" and PlyLaw.held_by(law):
        return replace(fabric, ply_contact=PlyLaw.read(law, fabric))
    PlyLaw.of(fabric)  # refuses a fabric without data
    return fabric


def surface_of(
    table: FabricTable, fabric: Fabric, file: FilePath | None, given: ResponseSurface | None = None
) -> ResponseSurface | None:
    """The response surface that a scene names, or the one `given` in its place, checked against what else the scene
    says of the cell."""
    forms = ("variational", "equilibrium") if table.surface is None else ("variational", "direct")
    if table.cell_formulation not in forms:
        words = "without" if table.surface is None else "with"
        raise InputError(
            file=file, key="fabric.cell_formulation", value=table.cell_formulation,
            allowed=f"{' or '.join(forms)} {words} fabric.surface",
        )  # fmt: skip
    if table.surface is None:
        return None
    if given is None and not os.path.exists(table.surface):
        raise InputError("cannot be read; must be a surface written by `weavecell surface`", file=table.surface)
    surface = given or ResponseSurface.read(table.surface)
    try:
        from shellfabric.cell.surface_cell import SurfaceCell

        return SurfaceCell(fabric, surface).surface
    except InputError as problem:
        raise InputError(file=table.surface, key=problem.key, value=problem.value, allowed=problem.allowed) from None


def _laws(table, key, fabric, file):
    if table.cell_model != "compressible":
        law = CompressionLaw.incompressible()
        return (law, law), f"none, {table.cell_model} yarns"
    if isinstance(table.law, InlineLaw):
        try:
            law = CompressionLaw(table.law.a, table.law.b, table.law.form, provenance=f"scene {file}")
        except InputError as problem:
            raise InputError(
                file=file, key=f"{key}.law.{problem.key}", value=problem.value, allowed=problem.allowed
            ) from None
        return (law, law), "given in the scene"
    if table.law != "published":
        law = CompressionLaw.from_json(table.law)
        law.require_fabric(fabric.name, file=file, key=f"{key}.law", value=table.law)
        return (law, law), "fitted to the 3D crossover"
    if fabric.laws is None:
        raise InputError(
            f"fabric {fabric.name} has no compression law: run `weavecell calibrate {table.file or table.name}` and "
            'name its result, law = ".../law.json", or give law = { a = ..., b = ... }',
            file=file, key=f"{key}.law",
        )  # fmt: skip
    return fabric.laws, "published (Table 5-1)" if "Table 5-1" in _source(fabric) else "published"


def _source(fabric):
    return " ".join(entry["source"] for key, entry in fabric.sources.items() if key.startswith("compression"))


def cell_of(table: FabricTable) -> tuple[Any, ...]:
    """Gap, model, form, profile and slack of the CellModel that a table [fabric] asks for."""
    return table.crossover_gap, table.cell_model, table.cell_formulation, table.cell_profile, table.fibre_slack
