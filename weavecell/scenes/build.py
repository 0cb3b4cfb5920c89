"""From a checked scene to the objects of the solver: fabric, compression laws, set-up of the
impact."""

from __future__ import annotations

import logging
import os
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import assumed, catalogue, data_sheet, plausible, ply_laws
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.errors import AS_WRITTEN, InputError, placed
from fabrics.base.schema import Table, declared, entries, list_read, tables
from fabrics.compression import CompressionLaw, check_room
from fabrics.fabric import Fabric
from fabrics.materials import IsotropicKeys, load
from fabrics.surface import ResponseSurface
from fabrics.variants import data_digest, with_linear_density
from fabrics.yarn import WeavingDamage
from shellfabric.membrane.boundary import Grip, PullIn, SlipKeys
from shellfabric.projectile.shapes import SHAPES
from weavecell.scenes import stl_file
from weavecell.scenes.fabric_table import OF_ONE_FABRIC, FabricTable, InlineLaw
from weavecell.scenes.impact import ProjectileTable, Scene
from weavecell.scenes.words import shot_in_words

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup, Ply
    from shellfabric.projectile.projectile import Projectile

# the command line prints the lines of this log
LOG = logging.getLogger("weavecell")
# laws of warp and weft
Laws = tuple[CompressionLaw, CompressionLaw]
CHANGED = "was fitted to other data of {} than it has now"


@dataclass(frozen=True)
class Material:
    """What plies are made of.

    Parameters
    ----------
    fabric : Fabric, with the linear densities that the scene chose
    laws : (warp, weft) CompressionLaw
    law_name : where the laws come from, in words
    surface : ResponseSurface that the cell is made from in place of the laws, or None
    """

    fabric: Fabric
    laws: Laws
    law_name: str
    surface: ResponseSurface | None = None


@dataclass(frozen=True)
class Case(Material):
    """What a scene describes: its material (of a lay-up the first ply's), tables and plies.

    Parameters
    ----------
    scene : Scene or CouponScene
    name : short name of the run
    lay_up : every impact.setup.Ply of plies that are not all alike, from the front
    materials : of the lay-up, each once
    """

    scene: Any = None
    name: str = ""
    lay_up: tuple[Ply, ...] = ()
    materials: tuple[Material, ...] = ()


def build(scene: Any, file: FilePath | None, name: str, fabric: Fabric | None = None) -> Case:
    """Look up everything that a scene names.

    Parameters
    ----------
    scene : Scene or CouponScene
    file : of the scene, named in errors; None of what is given in Python
    name : of the run
    fabric : in place of that which [fabric] names

    Raises
    ------
    InputError : a fabric or law that cannot be found or does not fit, named with the scene's file
        and key
    """
    scene = _count_plies(scene, file, fabric)
    panel = getattr(scene, "panel", None)
    shot = getattr(scene, "projectile", None)
    if file is not None and shot is not None and (shot.name is not None or shot.stl is not None):
        LOG.info(f"projectile: {shot_in_words(shot)}")
    # a coupon has no panel; plies that are all alike are those of [fabric]
    if panel is None or not panel.ply:
        return Case(
            **vars(material(scene.fabric, "fabric", scene, file, fabric)), scene=scene, name=name
        )
    from shellfabric.impact.setup import Ply

    materials: dict[str, Material] = {}
    plies: list[Ply] = []
    for table in panel.ply:
        named = table.names_fabric
        own: dict[str, Any] = {}
        if named:
            # of [fabric] it takes how cells are computed, and nothing that is of another fabric
            own = {key: FabricTable.model_fields[key].default for key in OF_ONE_FABRIC}
        for key in OF_ONE_FABRIC:
            if getattr(table, key) is not None:
                own[key] = getattr(table, key)
        # plies of one fabric and law share one table of the cell, which takes a second to fill
        if (key := repr(own)) not in materials:
            of_ply = scene.fabric.model_copy(update=own)
            where = "fabric"
            if own:
                where = "panel.ply"
            materials[key] = material(of_ply, where, scene, file, None if named else fabric)
        # a ply without a gap of its own takes that of the pack
        if table.gap is None:
            gap = panel.ply_gap
        else:
            gap = table.gap
        plies += [Ply(materials[key].fabric, materials[key].laws, table.angle, gap)] * table.count
    each = tuple(materials.values())
    return Case(**vars(each[0]), scene=scene, name=name, lay_up=tuple(plies), materials=each)


def _count_plies(scene, file, given):
    """Return the scene with the plies of the areal density that its panel states."""
    panel = getattr(scene, "panel", None)
    if getattr(panel, "areal_density", None) is None:
        return scene
    fabric = _fabric(scene.fabric, "fabric", file) if given is None else given
    of_ply = fabric.weave.areal_density
    try:
        whole = panel.count_plies(of_ply)
    except InputError as problem:
        raise problem.changed(file=file, key=f"panel.{problem.key}") from None
    LOG.info(
        f"panel.areal_density: {counted(whole.plies, 'ply')} of {fabric.name}, {whole.plies * of_ply:.3g} kg/m²"
    )
    return scene.model_copy(update={"panel": whole})


def material(
    table: FabricTable, key: str, scene: Any, file: FilePath | None, given: Fabric | None = None
) -> Material:
    """Build the Material of a table [fabric].

    Parameters
    ----------
    key : of the scene under which the table stands
    scene, file : of it; see `build`, as the other parameters and exceptions
    given : Fabric in place of that which the table names
    """
    # a law is compared with the data before weaving damage, which it was fitted to
    if given is None:
        fabric = _fabric(table, key, file)
    else:
        # a fabric that Python has changed has not been compared with the plausible ranges; who takes
        # a quarter of its mass or all of its crimp to see what that does means it
        fabric = plausible.noted(given, plausible.of_fabric(given, taken=True))
    plain = fabric
    if table.weaving_damage is not None:
        fabric = _weaken(fabric, table.weaving_damage, f"{key}.weaving_damage", file)
    panel = getattr(scene, "panel", None)
    if panel is not None and panel.rate_dependence:
        try:
            fabric = assumed.with_strain_rate(fabric)
        except InputError as problem:
            raise InputError(
                f"needs more: {problem}", file=file, key="panel.rate_dependence"
            ) from None
    if panel is None:
        fails = getattr(getattr(scene, "test_table", None), "failure", False)
    else:
        fails = panel.yarn_failure
    gauge_length = panel and panel.strength and panel.strength.gauge_length
    if gauge_length is not None:
        number = plausible.Number("panel.strength.gauge_length", "gauge_length", gauge_length)
        fabric = plausible.noted(replace(fabric, gauge_length=gauge_length), [number], file=file)
    # of no use without failure
    if not fails:
        fabric = assumed.given(fabric, "failure_length", data_sheet.STRENGTH_AFTER_WEAVING)
    # the fabric of another set-up has been weakened already
    woven = "weaving_damage.strength" in fabric.sources
    if data_sheet.STRENGTH_AFTER_WEAVING in fabric.assumed and not woven:
        entry = assumed.shot_entries(fabric)[data_sheet.STRENGTH_AFTER_WEAVING]
        damage = WeavingDamage(strength=entry.value, source=entry.source, status=entry.status)
        fabric = fabric.with_weaving_damage(damage)
    fabric = _mark_frictions(fabric, getattr(scene, "projectile", None), panel)
    fabric = _add_trellis_law(fabric, getattr(scene, "trellis_law", "needed"), file)
    # a response surface stands in place of the compression law
    if table.surface is not None:
        return Material(fabric, fabric.laws, "3D response surface", _surface(table.surface, fabric))  # type: ignore[arg-type]
    if (
        plain.laws is None
        and table.law == "published"
        and not getattr(scene, "presses_yarns", True)
    ):
        laws, law_name = 2 * (CompressionLaw.incompressible(),), NOT_PRESSED
    else:
        laws, law_name = _laws(table, key, plain, file, given)
    if laws != plain.laws:
        fabric = plausible.noted(fabric, plausible.of_laws(laws, plain, f"{key}.law"), file=file)
    # a single ply touches no other, and a fabric without data for that is fine
    if panel is not None and panel.plies > 1:
        try:
            fabric = _with_ply_contact(fabric, panel.ply_contact, table.law)
        except InputError as problem:
            if problem.file is not None:
                raise
            name = problem.key or "ply_contact"
            if name == "ply_contact":
                name = "panel.ply_contact"
            raise problem.changed(file=file, key=name) from None
    return Material(fabric, laws, law_name)


def _weaken(fabric, table, key, file):
    """The fabric with the shares that [fabric.weaving_damage] gives; what it leaves out stays as it is."""
    damage = WeavingDamage(**table.model_dump())
    numbers = [
        plausible.Number(f"{key}.{name}", "weaving_damage", share)
        for name, share in damage.shares.items()
    ]
    try:
        weakened = fabric.with_weaving_damage(damage)
    except InputError as problem:
        name = next(iter(damage.shares))
        message = f"makes a yarn of which {problem}"
        raise InputError(message, file=file, key=f"{key}.{name}", value=AS_WRITTEN) from None
    fabric = plausible.noted(weakened, numbers, file=file)
    if damage.strength is not None:
        fabric = assumed.given(fabric, data_sheet.STRENGTH_AFTER_WEAVING)
    return fabric


def _fabric(table, key, file):
    """The fabric that a table names, with the linear density that it chooses."""
    if table.file is not None:
        fabric = catalogue.read(table.file)
    elif table.name in catalogue.list_names():
        fabric = catalogue.load(table.name)
    else:
        allowed = f"one of {', '.join(catalogue.list_names())}"
        name = f"{key}.name"
        if table.name.lower().endswith(".toml"):
            hint = f"a fabric file stands under {key}.file"
            raise InputError(hint, key=name, value=table.name, allowed=allowed, file=file)
        raise catalogue.unknown(table.name, allowed, key=name, file=file)
    return with_linear_density(fabric, table.linear_density)


def _mark_frictions(fabric, shot, panel):
    """The fabric with the frictions on the nose and between plies among what is assumed, but for one
    that the input file gives or a scene without shot, or of one ply, does not have."""
    given = {
        data_sheet.FRICTION_OF_PROJECTILE: shot is None or shot.friction is not None,
        data_sheet.FRICTION_BETWEEN_PLIES: (
            panel is None or panel.plies == 1 or panel.ply_friction is not None
        ),
    }
    for name, is_given in given.items():
        if is_given:
            fabric = assumed.given(fabric, name)
        elif name not in fabric.assumed:
            fabric = replace(fabric, assumed=(*fabric.assumed, name))
    return fabric


def _add_trellis_law(fabric, need, file):
    """The fabric with a trellis law, assumed if its file has none, if it is "needed", "optional" or
    "unused".

    Of a scene's file a line is logged for each law that is assumed, or left out.
    """
    try:
        if need != "unused":
            fabric = assumed.with_shear(fabric)
    except InputError as problem:
        if need == "needed":
            raise problem.changed(file=file) from None
        LOG.info(f"no [shear] of {fabric.name}: its fabric has no shear stiffness")
    # in Python the result carries these lines; a command prints them
    for line in assumed.lines(fabric) if file is not None else ():
        LOG.info(line)
    return fabric


def _with_ply_contact(fabric, choice, law):
    """The fabric with the contact law of plies of `choice` (`ply_laws.choose`), or that the file
    `law` holds."""
    if choice is not None:
        contact = ply_laws.choose(choice, fabric)
        # the same file has warned as the fabric's law already
        if choice != law:
            _warn_of_change(ply_laws.fitted_data(choice), fabric, str(choice))
        return replace(fabric, ply_contact=contact)
    if isinstance(law, (str, Path)) and law != "published" and ply_laws.stands_in(law):
        return replace(fabric, ply_contact=ply_laws.read(law, fabric))
    ply_laws.default(fabric)  # refuses a fabric without data
    return fabric


def _surface(surface, fabric):
    """The response surface of a path, of a result, or the surface itself, checked against the
    fabric."""
    from shellfabric.cell.surface_cell import SurfaceCell

    own = getattr(surface, "surface", surface)
    if isinstance(own, ResponseSurface):
        return SurfaceCell(fabric, own).surface
    if not isinstance(surface, (str, Path)):
        allowed = "a ResponseSurface, a SurfaceResult, or the path of a surface"
        raise InputError(key="surface", value=surface, allowed=allowed)
    if not os.path.exists(surface):
        raise InputError(
            "cannot be read; must be a surface written by `weavecell surface`", file=surface
        )
    with placed(surface):
        return SurfaceCell(fabric, ResponseSurface.read(surface)).surface


def _laws(table, key, fabric, file, given):
    """((warp, weft) CompressionLaw, where they come from in words) of a table."""
    law = table.law
    # yarns that do not compress need no law
    if table.cell_model != "compressible":
        return 2 * (CompressionLaw.incompressible(),), f"none, {table.cell_model} yarns"
    if isinstance(law, InlineLaw):
        with placed(file, f"{key}.law."):
            own = CompressionLaw(law.a, law.b, law.form, provenance="given in the input file")
        check_room((own, own), fabric.weave, file=file, key=f"{key}.law.a")
        return (own, own), own.provenance
    # the same advice as in `laws_of`, in the words of an input file
    if law == "published" and fabric.laws is None and file is not None:
        raise InputError(
            f"fabric {fabric.name} has no compression law: run `weavecell calibrate {table.file or table.name}` and "
            'name its result, law = ".../law.json", or give law = { a = ..., b = ... }',
            file=file,
            key=f"{key}.law",
        )
    laws = laws_of(fabric, law, file, f"{key}.law")
    if law != "published":
        changed = {each.fitted_data for each in laws} - {"", data_digest(fabric)}
        if isinstance(law, (str, Path)):
            name = "fitted to the 3D crossover"
        else:
            name = laws[0].provenance
        if changed:
            name += f", {CHANGED.format(fabric.name)}"
        for doubts in {each.doubts for each in laws} - {""}:
            name += f", DOUBTFUL: {doubts}"
        return laws, name
    if given is not None:
        return laws, laws[0].provenance
    sources = " ".join(
        entry["source"] for name, entry in fabric.sources.items() if name.startswith("compression")
    )
    return laws, "published (Table 5-1)" if "Table 5-1" in sources else "published"


# in place of a law, of a test in which yarns are not pressed
NOT_PRESSED = "none, a picture frame shears the fabric and stretches no yarn"


def laws_of(
    fabric: Fabric, law: Any = None, file: FilePath | None = None, key: str = "law"
) -> Laws:
    """Choose the (warp, weft) compression laws.

    Parameters
    ----------
    fabric : Fabric, whose own laws are taken where `law` is None
    law : one CompressionLaw for both families, a pair (warp, weft), the path of a law.json, an
        object with the attribute `law` such as the result of `calibrate`; None or "published" for
        the fabric's own
    file, key : named in errors

    Raises
    ------
    InputError : none of these, a law of another fabric, or None for a fabric without laws
    """
    # messages show what the user gave, not what it was turned into
    written = law
    law = getattr(law, "law", law)
    if law is None or law == "published":
        if fabric.laws is None:
            raise InputError(
                f"fabric {fabric.name} has no compression law: give law=, or use weavecell.calibrate(fabric).fabric"
            )
        return fabric.laws
    if isinstance(law, (str, Path)):
        law = CompressionLaw.from_json(law)
    if isinstance(law, (tuple, list)) and len(law) == 2:
        warp, weft = law
    else:
        warp = law
        weft = law
    for law in (warp, weft):
        if not isinstance(law, CompressionLaw):
            allowed = "a CompressionLaw, a pair (warp, weft) of them, or a law.json"
            raise InputError(key="law", value=written, allowed=allowed)
        value = None
        if isinstance(written, (str, Path)):
            value = str(written)
        law.require_fabric(fabric.name, file=file, key=key, value=value)
        _warn_of_change(law.fitted_data, fabric, value or "law")
    for doubts in dict.fromkeys(law.doubts for law in (warp, weft) if law.doubts):
        LOG.warning(f"{value or 'law'} is doubtful: {doubts}")
    # a pair that closes more than both heights would let yarns pass through each other
    check_room((warp, weft), fabric.weave, file=file, key=f"{key}.a")
    return warp, weft


def _warn_of_change(fitted_data, fabric, name):
    """Warn if a law was fitted to other data of the fabric; `fitted_data` is their digest, empty if
    not known."""
    if fitted_data and fitted_data != data_digest(fabric):
        LOG.warning(f"{name} {CHANGED.format(fabric.name)}: `weavecell calibrate` again")


def cell_of(table: FabricTable) -> tuple[Any, ...]:
    """Return gap, model and form of the CellModel that a table [fabric] asks for."""
    return table.crossover_gap, table.cell_model, table.cell_formulation


def setup(case: Case, file: FilePath | None, **others: Any) -> ImpactSetup:
    """Build the impact's set-up for `shellfabric`. With a file, its notes are logged.

    Parameters
    ----------
    **others : fields of the set-up in place of what the scene says

    Raises
    ------
    InputError : values that fit each on its own but not together, named with the scene's file
    """
    from shellfabric.impact.strengths import YarnStrength
    from shellfabric.loop.histories import HistoryRequest
    from shellfabric.membrane.grid import SYMMETRIES
    from shellfabric.membrane.numerics import Numerics
    from shellfabric.yarns.model import aim
    from weavecell.scenes.short_setup import ShortSetup

    scene = case.scene
    panel = case.scene.panel
    # a key reaches the solver under its own name, unless it is an object of several keys
    of_setup = {field.name for field in fields(ShortSetup)}
    given: dict[str, Any] = {}
    fabrics = [case.fabric, *(ply.fabric for ply in case.lay_up or ())]
    for table in (scene.fabric, panel, scene.run):
        given |= {key: value for key, value in _collect_given(table).items() if key in of_setup}
    try:
        # in place of texts and tables the objects that they describe
        given |= {
            "fabric": case.fabric,
            "laws": case.laws,
            "surface": case.surface,
            "lay_up": case.lay_up,
            "strike_velocity": scene.projectile.strike_velocity,
            "projectile": make_projectile(scene.projectile, *fabrics),
            "boundary": _boundary(panel.boundary),
            "round": panel.opening_shape == "round",
            "backing": _backing(scene.backing),
            "strength": panel.strength
            and YarnStrength(panel.strength.weibull_shape, panel.strength.seed),
            "history": scene.history
            and HistoryRequest(**_collect_given(scene.history, "report_positions")),
            "numerics": Numerics(**_collect_given(scene.numerics)),
        }
        if data_sheet.FRICTION_BETWEEN_PLIES in case.fabric.assumed:
            entries = assumed.shot_entries(*fabrics)
            given["ply_friction"] = entries[data_sheet.FRICTION_BETWEEN_PLIES].number
        if "symmetry" not in panel.model_fields_set:
            given["symmetry"] = _modelled_part(panel, given, fabrics)
        zone = _build_yarn_zone(panel, fabrics)
        given["crossovers"] = given["instead"] = None
        given["crossovers" if panel.crossovers == "yarns" else "instead"] = zone
        given["pinned"] = panel.crossovers == "pinned" and "crossovers" in panel.model_fields_set
        # a nose may hit a crossover or the gap between yarns: the seed draws where
        if given["crossovers"] is not None and panel.impact_point is None:
            mirrors = SYMMETRIES[given["symmetry"]]
            given["impact_point"] = aim(case.fabric.weave, panel.aim_seed, mirrors)
        _check_positions(scene.history, panel.opening)
        made = ShortSetup(**given | others)
        made.check_contact_points()
    except InputError as problem:
        raise name_file(problem, file) from None
    for note in made.notes if file is not None else ():
        LOG.info(f"note: {note}")
    return made


def _modelled_part(panel, given, fabrics):
    """The smallest part of a panel that stands for the whole, where none is asked for: a plane of
    symmetry is one of the shot, of the place that it hits, of the edges, and of the weave; of resolved
    yarns also of the patterns of all fabrics. A block has both planes or none.

    given : keywords of the set-up, of which it reads projectile, boundary and backing
    """
    from shellfabric.membrane import boundary
    from shellfabric.membrane.grid import SYMMETRIES

    wanted = SYMMETRIES[panel.symmetry]
    mirrored = [True, True]
    if panel.crossovers == "yarns":
        # the plane across the warp is the middle line of a weft yarn
        for axis, family in ((0, 1), (1, 0)):
            lines = [fabric.weave.pattern.find_mirror(family) for fabric in fabrics]
            mirrored[axis] = None not in lines
    planes = tuple(
        plane
        and mirrored[axis]
        and given["projectile"].mirrored(axis)
        and offset == 0
        and low == high
        and panel.weave_angle == 0
        for axis, (plane, offset, (low, high)) in enumerate(
            zip(wanted, panel.impact_point or (0.0, 0.0), boundary.sides(given["boundary"]))
        )
    )
    if given["backing"] is not None:
        planes = (all(planes),) * 2
    return next(name for name, has in SYMMETRIES.items() if has == planes)


def _check_positions(history, opening):
    """Refuse positions of the report that are given and lie beyond the edge."""
    if history is None or not history.sets("report_positions"):
        return
    half = 0.5 * opening if isinstance(opening, float) else 0.5 * max(opening)
    for position in history.report_positions:
        if abs(position) > half:
            allowed = f"within panel.opening, at most {1e3 * half:g} mm from the impact point"
            raise InputError(key="history.report_positions", value=position, allowed=allowed)


def _collect_given(table, *but):
    """{key: value} of the keys that a table sets, without some."""
    return {key: value for key, value in table if value is not None and key not in but}


def _build_yarn_zone(table, fabrics):
    """The zone of resolved yarns, with the friction that is assumed of the fabrics; None of pinned
    crossovers."""
    if table.crossovers == "pinned":
        return None
    from shellfabric.yarns.model import YarnZone

    given = {
        "half_width": table.zone,
        "friction": table.crossover_friction,
        "seed": table.aim_seed,
    }
    if table.crossover_friction is None:
        given["friction"] = assumed.friction_between_yarns(*fabrics).number
    return YarnZone(**{field: value for field, value in given.items() if value is not None})


def make_projectile(table: ProjectileTable, *fabrics: Fabric) -> Projectile:
    """Make the projectile of a table [projectile]; a friction that it does not give is assumed.

    Parameters
    ----------
    fabrics : that it strikes, the first one first; none takes the friction of most fibres
    """
    from shellfabric.projectile.projectile import Projectile

    given = _collect_given(
        table, "name", "diameter", "strike_velocity", "stl", "stl_unit", "density"
    )
    if table.friction is None:
        given["friction"] = assumed.shot_entries(*fabrics)[data_sheet.FRICTION_OF_PROJECTILE].number
    # a body of any shape has its radius and length from its surface
    if not SHAPES[table.shape].from_file:
        return Projectile(radius=table.diameter / 2, **given)
    solid = stl_file.solid(table.stl, table.stl_unit, table.edge_radius)
    return Projectile(**given | {"solid": solid, "radius": solid.radius, "length": solid.length})


def _backing(table):
    """The block that a scene names; what it leaves out is the thesis's, or the mesh's default."""
    if table is None:
        return None
    from shellfabric.block.block import Backing

    given = _collect_given(table)
    given["name"] = given.pop("material", "")
    of_material = {key: given.pop(key) for key in declared(IsotropicKeys) if key in given}
    return Backing(material=replace(load("backing"), **of_material), **given)


def _boundary(boundary):
    """The panel's boundary as the solver has it, from a text or a table of sides."""
    if isinstance(boundary, str):
        return boundary
    sides: list[Any] = []
    for side in boundary.sides.values():
        if isinstance(side, tuple):
            sides.append(tuple(_side(end) for end in side))
        else:
            sides.append(_side(side))
    return tuple(sides)


def _side(side):
    if isinstance(side, str):
        return side
    if side.clamp_force is not None:
        return Grip(**_read_of(side, "grip"))
    return PullIn(**_read_of(side, "pull_in"))


def _read_of(side, model):
    """{key: value} of the keys of a side that slips that a model of it reads."""
    return {key: getattr(side, key) for key in list_read(SlipKeys, model)}


def may_be_of_file(problem: InputError) -> bool:
    """Tell whether an InputError may be of a key of an input file, and not of a parameter of a
    command."""
    known = {key.rpartition(".")[2] for key in entries(Scene)}
    return problem.key is None or "." in problem.key or problem.key in known


def name_file(
    problem: InputError, file: FilePath | None, of_scene: Mapping[str, type[Table]] | None = None
) -> InputError:
    """Return an InputError of an object that does not know its file, with the scene's file and key
    in it.

    Parameters
    ----------
    of_scene : {name: table} of the scene whose keys the object may name; None: those of an impact
    """
    if problem.file is not None:
        return problem
    if of_scene is None:
        of_scene = tables(Scene)
        of_scene = {name: table for name, table in of_scene.items() if name and "." not in name}
    key = problem.key
    for name, table in of_scene.items():
        if problem.key in table.model_fields:
            key = f"{name}.{problem.key}"
    return problem.changed(file=file, key=key)
