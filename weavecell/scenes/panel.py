"""The table [panel] of an impact: opening, edges, plies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    WithJsonSchema,
    model_validator,
)

from fabrics.base.counted import counted
from fabrics.base.errors import InputError, placed
from fabrics.base.schema import (
    NoPlace,
    StandardShot,
    Table,
    Unread,
    as_tuple,
    declared,
    described,
    flag,
    from_text,
    list_read,
    list_unread,
    one_of,
    quantity,
    string,
    whole,
)
from shellfabric import part_of_others, shot_keys
from shellfabric.impact.strength_keys import StrengthKeys
from shellfabric.membrane.boundary import SlipKeys
from shellfabric.panel_numbers import PanelNumbers, ZoneKeys
from shellfabric.plies.pack_keys import MOST_PLIES, PackKeys
from weavecell.scenes import presets
from weavecell.scenes.fabric_table import LAW, LINEAR_DENSITY, Law, WeavingDamageTable


class SlipTable(Table, SlipKeys):  # type: ignore[misc] # frozen by its model_config
    """Yarns that slip in their clamps: either `clamp_force`, a friction clamp, or `pull_in` with
    `start` and `end`, a prescribed slip. A list of two tables holds for their two ends.

    [panel.boundary]
    warp = [{ clamp_force = "20 N" }, { clamp_force = "40 N" }]
    weft = { pull_in = "5 mm", start = "200 us", end = "650 us" }
    """

    @model_validator(mode="after")
    def _check_clamped_or_pulled(self):
        given = {name for name in self.model_fields_set if getattr(self, name) is not None}
        # [panel.boundary] has these keys too, and may have none of them
        if given == {*list_read(SlipKeys, "grip")} or (
            type(self) is not SlipTable and not given & set(SlipTable.model_fields)
        ):
            return self
        if given | {"zone"} != {*list_read(SlipKeys, "pull_in")}:
            raise InputError("give clamp_force alone, or pull_in with start and end (and zone)")
        if self.end <= self.start:
            raise InputError("must end after its start")
        return self


_SIDE = (
    '"clamped", "free", { clamp_force = ... }, { pull_in = ..., start = ..., end = ... }, '
    "or a list of two such for its ends"
)
_BOUNDARY = '"clamped", "free", a table of a slipping side for all four, or a table { warp = ..., weft = ... } of sides'


def _kind(value):
    if isinstance(value, (Mapping, Table)):
        return "inline"
    if isinstance(value, (list, tuple)):
        return "pair"
    return "text"


_Text = Annotated[Literal["clamped", "free"], Tag("text")]
_One = Annotated[_Text | Annotated[SlipTable, Tag("inline")], Discriminator(_kind)]
_Pair = Annotated[tuple[_One, _One], BeforeValidator(tuple), Tag("pair")]
Side = Annotated[_Text | Annotated[SlipTable, Tag("inline")] | _Pair, Discriminator(_kind)]


class BoundaryTable(SlipTable):  # type: ignore[misc] # frozen by its model_config
    """Different conditions for the ends of warp and weft, in place of `boundary = ...`; or the keys
    of a slipping side, which then holds for all four: `boundary = { clamp_force = "5 N" }`.

    [panel.boundary]
    warp = "clamped"
    weft = "free"
    """

    warp: Annotated[Side, described("how the warp yarns end at the frame", _SIDE)] = "clamped"
    weft: Annotated[Side, described("how the weft yarns end at the frame", _SIDE)] = "clamped"

    @property
    def sides(self) -> dict[str, Any]:
        """{"warp": side, "weft": side} in the forms of these keys; if all four slip alike, this
        table itself."""
        alike = bool(self.model_fields_set & set(SlipTable.model_fields))
        return {name: self if alike else getattr(self, name) for name in ("warp", "weft")}


Boundary = Annotated[_Text | Annotated[BoundaryTable, Tag("inline")], Discriminator(_kind)]


_ZONE = {
    "type": "array",
    "prefixItems": [{"type": ["number", "string"]}] * 2,
    "minItems": 2,
    "maxItems": 2,
}


def _ply_angle(text, read):
    """[rad] above -pi/2 and at most pi/2: half a turn leaves a weave as it is."""
    degrees = round(math.degrees(read(text, "rad")), 6)
    if not -180 <= degrees <= 180:
        raise ValueError("out of range")
    # half a turn leaves a weave as it is
    least = math.remainder(degrees, 180)
    return math.radians(90 if least == -90 else least)


def _zones(value):
    """Zones (until, side) [crossovers] of a grading, as numbers."""
    if value is None:
        return None
    if isinstance(value, list) and all(isinstance(zone, list) for zone in value):
        numbers = [part for zone in value for part in zone]
    else:
        numbers = [None]
    if any(isinstance(part, bool) or not isinstance(part, (int, float, str)) for part in numbers):
        raise ValueError("no zones")
    return tuple((_crossovers(until), _crossovers(side)) for until, side in value)


def _crossovers(value):
    """A number of crossovers, or a fraction of one such as "1/3"."""
    if not isinstance(value, str):
        return float(value)
    # a third has no finite decimal, so fractions are read as such
    over, _, under = value.partition("/")
    if int(under) == 0:
        raise ValueError("divided by 0")
    return int(over) / int(under)


class StrengthTable(Table, StrengthKeys):  # type: ignore[misc] # frozen by its model_config
    """Yarns that differ in strength: each yarn of each ply has one of its own, of a Weibull
    distribution. The whole panel is modelled. `weavecell sweep` over seeds gives the scatter of a
    result ([studies](../studies.md)).

    [panel.strength]
    weibull_shape = 14.3
    seed = 1
    """

    gauge_length: quantity(
        "length of the yarns that have the stated strength on average, in place of that of the fabrics: longer "
        "yarns are weaker",
        "m",
        "200 mm",
    ) = None


BESIDE_ANGLES = "if a ply is at another angle than 0 and 90 deg"


class PlyTable(Table):
    """One table for each group of plies that are alike, from the struck side to the back.
    `panel.plies` and `panel.stacking` are then left out.

    [[panel.ply]]
    count = 2
    gap = "0.1 mm"

    [[panel.ply]]
    name = "S-726"
    angle = "45 deg"
    """

    name: string(
        "fabric of the catalogue; without name and file the fabric of the table [fabric]",
        "the name of a fabric of the catalogue",
    ) = None
    file: string(
        "fabric file; its path is relative to the input file", "the path of a fabric file (*.toml)"
    ) = None
    law: Annotated[
        Law | None,
        described(
            "compression law of the ply; if not given `published`, for plies of [fabric] the law of `fabric.law`",
            LAW,
        ),
    ] = None
    angle: from_text(
        float,
        _ply_angle,
        "angle from the warp of a ply at 0 to the warp of this ply, towards its weft. Any other than 0 and 90 deg "
        "needs clamped edges and pinned crossovers, and the whole panel is modelled",
        'an angle from -180 to 180 deg, such as "45 deg"',
        "rad",
        "45 deg",
    ) = 0.0
    gap: shot_keys.PLY_GAP = None
    count: whole("number of plies that are alike", 1, MOST_PLIES) = 1
    linear_density: LINEAR_DENSITY = None
    weaving_damage: Annotated[
        WeavingDamageTable | None,
        Field(description='a table { modulus = 0.9, strength = 0.8, source = "..." }'),
    ] = None

    @property
    def names_fabric(self) -> bool:
        """Whether it has a fabric of its own, and takes nothing from that of [fabric]."""
        return self.name is not None or self.file is not None

    @model_validator(mode="after")
    def _check_one_fabric(self):
        if self.name is not None and self.file is not None:
            raise InputError("give one of panel.ply.name and panel.ply.file")
        if not self.names_fabric:
            self.refuse("linear_density", "left out without name and file: [fabric] has it")
        return self


def _opening_or_preset(schema):
    """The JSON Schema of [panel] as files have it: a preset has an opening."""
    schema["required"].remove("opening")
    schema["anyOf"] = [{"required": ["opening"]}, {"required": ["preset"]}]


class PanelTable(Table, PanelNumbers, ZoneKeys, PackKeys):  # type: ignore[misc] # frozen by its model_config
    """The opening, how the yarns are held, and the plies: one, several alike, or a lay-up of tables
    `[[panel.ply]]`.

    [panel]
    opening = "150 mm"
    boundary = "clamped"
    plies = 4
    """

    model_config = ConfigDict(json_schema_extra=_opening_or_preset)

    synonyms: ClassVar = {
        "size": "opening",
        "layers": "plies",
        "plys": "plies",
        "clamping": "boundary",
        "edges": "boundary",
        "gap": "ply_gap",
    }

    preset: one_of(
        "set-up of a test, whose values stand in place of keys of [panel], [backing] and [run] that are not given: "
        "body armour is a pack with free edges of 200 mm before a block of clay, followed until the dent rests",
        *presets.list_names(),
    ) = None
    opening: Annotated[
        shot_keys.OPENING,
        StandardShot("203 mm"),
    ]
    opening_shape: Annotated[
        one_of("shape of the opening; round needs clamped edges", "rectangular", "round"),
        Unread("export", '"rectangular"'),
    ] = "rectangular"
    impact_point: Annotated[
        shot_keys.IMPACT_POINT,
        Field(min_length=2, max_length=2),
        Unread("export", "0"),
    ] = None
    boundary: Annotated[Boundary, described("how the yarns end at the frame", _BOUNDARY)] = (
        "clamped"
    )
    symmetry: shot_keys.SYMMETRY = "quarter"
    weave_angle: Annotated[
        shot_keys.WEAVE_ANGLE,
        Unread("export", "0: an oblique weave is not exported"),
    ] = 0.0
    areal_density: Annotated[
        quantity(
            "areal density of a pack, from which the number of its plies follows: of whole plies that which is nearest",
            "kg/m^2",
            "5 kg/m^2",
            kind="an areal density {}",
        ),
        Unread("export"),
    ] = None
    ply: Annotated[
        tuple[PlyTable, ...], BeforeValidator(as_tuple), Field(description="tables [[panel.ply]]")
    ] = ()
    strength: Annotated[
        StrengthTable | None,
        Field(description="a table { weibull_shape = 14.3, seed = 1 }"),
        Unread("export", "left out: cards have one strength"),
        Unread("v50", "left out: a V50 draws the strengths itself"),
    ] = None
    length_effect: Annotated[
        flag(
            "whether the strength of a yarn follows its length from edge to edge: the stated strength is that of yarns "
            "of the gauge length of the fabric, 200 mm if its file gives none, and longer ones are weaker "
            "([strength](../reports/yarns.md)); false: it is that of the yarns in the panel, as in the thesis"
        ),
        NoPlace("export", "nothing breaks"),
    ] = True
    grading: Annotated[
        tuple[tuple[float, float], ...] | None,
        BeforeValidator(_zones),
        WithJsonSchema({"type": "array", "items": _ZONE}),
        described(
            "coarser mesh with the distance from the impact point: zones of distance and element side, in crossovers",
            'zones [until, side] in crossovers, the last until inf, such as [[9, "1/2"], [20, 1], [inf, 2]]',
        ),
    ] = None
    crossovers: Annotated[
        one_of(
            "whether warp and weft are pinned to each other where they cross, or are resolved yarns in a zone about "
            "the nose, which may slip and be pushed aside, and pinned beyond it ([theory](../theory-panel.md)); auto, "
            "as a command does where nothing is said, resolves them if a zone of them fits (a shot, a limit, a V50)",
            "pinned",
            "yarns",
            "auto",
        ),
        Unread("export", '"pinned": no law here lets yarns slip'),
    ] = "pinned"

    parts: Annotated[
        dict[str, Any] | None,
        Field(description='a table { foundation = { stiffness = "2e10 N/m^3" } }'),
        Unread("export", "left out: no deck has it"),
    ] = None

    @property
    def angled(self) -> bool:
        """Whether a ply of a lay-up is at another angle than 0 and 90 deg."""
        return any(ply.angle not in (0.0, math.pi / 2) for ply in self.ply)

    @classmethod
    def unknown(cls, key: str, near: str | None) -> tuple[str | None, str | None]:
        """Return the message of `Table.unknown`, and what is allowed of a key of yarns that slide,
        which the panel had."""
        # earlier versions had sliding crossovers with a cohesion
        if key == "crossover_cohesion":
            return (
                None,
                'left out: resolved yarns (crossovers = "yarns") have friction without cohesion',
            )
        return super().unknown(key, near)

    @model_validator(mode="after")
    def _read_parts(self):
        """The panel with its parts in place of their tables."""
        if not self.parts:
            return self
        with placed(None, "parts."):
            made = tuple(part_of_others.read(name, table) for name, table in self.parts.items())
        if self.crossovers == "yarns":
            raise InputError(key="parts", allowed="left out with resolved yarns")
        return self.model_copy(update={"parts": made})

    @model_validator(mode="after")
    def _check_lay_up(self):
        """The panel with the number of the plies of its tables [[panel.ply]]."""
        if self.areal_density is not None:
            self.refuse("plies ply", "left out beside areal_density, from which it follows")
        if not self.ply:
            return self
        # a number that contradicts the tables would be wrong in silence
        for key in declared(PackKeys):
            if key in self.model_fields_set and key not in list_read(PackKeys, "lay_up"):
                raise InputError(key=key, allowed="left out beside [[panel.ply]]")
        self.refuse("weave_angle", "left out with [[panel.ply]]")
        plies = sum(ply.count for ply in self.ply)
        if not 2 <= plies <= MOST_PLIES:
            allowed = f"2 to {MOST_PLIES} plies in all; [fabric] alone is one ply"
            raise InputError(key="ply", value=counted(plies, "ply"), allowed=allowed)
        return self.model_copy(update={"plies": plies})

    @model_validator(mode="after")
    def _resolve_yarns_of_a_zone(self):
        """The panel with resolved yarns where it tells of their zone and not of the crossovers."""
        if "crossovers" not in self.model_fields_set:
            for name, _ in list_unread(ZoneKeys, self, "pinned"):
                # a seed alone may stand beside a projectile or a block that resolved yarns do not take
                if name != "aim_seed":
                    return self.model_copy(update={"crossovers": "yarns"})
        return self

    @model_validator(mode="after")
    def _check_ply_count(self):
        if not self.yarn_failure:
            self.refuse("rate_dependence strength", "left out if yarns do not fail")
        if self.angled:
            self.refuse("boundary", f"clamped {BESIDE_ANGLES}")
        if self.crossovers == "pinned":
            for name, _ in list_unread(ZoneKeys, self, "pinned"):
                raise InputError(key=name, allowed="left out where crossovers are pinned")
        elif self.impact_point is not None:
            self.refuse("aim_seed", "left out beside impact_point")
        if self.areal_density is None:
            self._refuse_keys_of_packs()
        if self.weave_angle != 0:
            self.refuse("stacking", "aligned if the weave is oblique")
        if not self.length_effect and self.strength is not None:
            with placed(None, "strength."):
                self.strength.refuse("gauge_length", "left out with length_effect = false")
        return self

    def _refuse_keys_of_packs(self):
        # one that changes nothing is a misunderstanding
        if self.plies == 1:
            for name, _ in list_unread(PackKeys, self, "ply"):
                raise InputError(key=name, allowed="left out for a single ply")

    def count_plies(self, of_ply: float) -> PanelTable:
        """Return the table with the number of plies of its areal density.

        Parameters
        ----------
        of_ply : [kg/m2] areal density of one ply

        Raises
        ------
        InputError : fewer than one or more than `MOST_PLIES`, or a key of packs beside one ply
        """
        if self.areal_density is None:
            return self
        plies = round(self.areal_density / of_ply)
        if not 1 <= plies <= MOST_PLIES:
            allowed = f"that of 1 to {MOST_PLIES} plies of {of_ply:.3g} kg/m^2 each"
            value = f"{self.areal_density:g} kg/m^2"
            raise InputError(key="areal_density", value=value, allowed=allowed)
        made = self.model_copy(update={"plies": plies})
        made._refuse_keys_of_packs()
        return made

    @model_validator(mode="after")
    def _check_gaps_are_between_plies(self):
        if not self.ply:
            return self
        *front, last = self.ply
        if last.gap is not None and last.count == 1:
            raise InputError(
                key="ply.gap", allowed="left out of the last ply, which has none behind it"
            )
        if last.count > 1:
            front.append(last)
        if self.ply_gap is not None and front and all(ply.gap is not None for ply in front):
            raise InputError(key="ply_gap", allowed="left out where each [[panel.ply]] has its gap")
        return self

    @model_validator(mode="after")
    def _check_modelled_part(self):
        """The whole panel if a ply is at an angle, yarns differ in strength, or are resolved and no
        part is asked for."""
        # these panels have no plane of symmetry; a symmetry that is given is not overruled in
        # silence
        given = "symmetry" in self.model_fields_set
        if self.angled and given and self.symmetry != "whole":
            raise InputError(key="symmetry", allowed=f"whole, or left out, {BESIDE_ANGLES}")
        drawn = self.strength is not None
        if drawn and given and self.symmetry != "whole":
            allowed = "whole, or left out, if yarns differ in strength"
            raise InputError(key="symmetry", allowed=allowed)
        resolved = self.crossovers == "yarns"
        if self.angled or drawn or (resolved and not given):
            return self.model_copy(update={"symmetry": "whole"})
        return self
