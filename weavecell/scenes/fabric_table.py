"""The table [fabric] of input files, of impacts and of coupons."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, WithJsonSchema, model_validator

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.schema import (
    TEXT,
    FileOnly,
    Kind,
    MayBeObject,
    Table,
    Unread,
    described,
    in_python,
    number,
    one_of,
    quantity,
    refuse_passed_over,
    string,
    validated,
)
from fabrics.yarn import STATUSES
from shellfabric import shot_keys
from shellfabric.panel_numbers import UNSTRETCHED, CellNumbers
from weavecell.scenes import kept_files

# what a scene is read for, as the marks `Unread` of its keys name it
Reader = Literal[
    "shot",
    "setup",
    "limit",
    "v50",
    "sweep",
    "export",
    "coupon",
    "bias_extension",
    "picture_frame",
    "uniaxial",
    "biaxial",
    "pull_out",
]


class InlineLaw(Table):
    """Compression law given by its two coefficients, in place of `law = ...`, for both families.

    [fabric.law]
    a = "0.045 mm"
    b = "0.058 mm N^(1/3)"
    """

    a: quantity(
        "thickness reduction of a yarn at large contact force",
        "m",
        "0.045 mm",
        zero=True,
        ranged=True,
    )
    b: quantity(
        "coefficient of the cube root of the contact force",
        "m N^(1/3)",
        "0.058 mm N^(1/3)",
        zero=True,
        kind="a value {} in mm N^(1/3)",
        ranged=True,
    )
    form: one_of(
        "behaviour at zero contact force: `regularised` (finite stiffness) or as `printed` in the thesis",
        "regularised",
        "printed",
    ) = "regularised"


_NAMED_LAWS = "published", "solid", "pressure_law"
LAW = '"published", the path of a law written by `weavecell calibrate` (*.json), or a table { a = ..., b = ... }'


def _law_kind(value):
    if isinstance(value, (Mapping, InlineLaw)):
        return "inline"
    return "text"


def _law(value, info):
    if in_python(info) or (
        isinstance(value, str) and (value == "published" or value.endswith(".json"))
    ):
        return value
    raise ValueError("not a law")


def _object(value, info):
    if in_python(info) or isinstance(value, str):
        return value
    raise ValueError("not a path")


Law = Annotated[
    Annotated[Any, BeforeValidator(_law), Tag("text"), WithJsonSchema(TEXT)]
    | Annotated[InlineLaw, Tag("inline")],
    Discriminator(_law_kind),
]


class WeavingDamageTable(Table):
    """Modulus and strength of the woven yarn over those of the virgin yarn, if yarns drawn
    from the fabric were tested.

    [fabric.weaving_damage]
    modulus = 0.95
    strength = 0.9
    source = "yarns drawn from the fabric, 20 tests"
    status = "measured"
    """

    modulus: number(
        "modulus of the woven yarn over the modulus of the virgin yarn; if not given, 1",
        0.9,
        gt=0.0,
        le=1.0,
    ) = None
    strength: number(
        "strength of the woven yarn over the strength of the virgin yarn; if not given, it is assumed as without "
        "this table",
        0.8,
        ranged=True,
        gt=0.0,
        le=1.0,
    ) = None
    source: Annotated[
        str,
        described(
            "origin of the two ratios, kept in the results",
            "a text: where the shares come from",
            min_length=1,
        ),
    ]
    status: one_of("whether the ratios are measured or assumed, kept in the results", *STATUSES) = (
        "assumed"
    )

    @model_validator(mode="after")
    def _check_one_share(self):
        if self.modulus is None and self.strength is None:
            raise InputError("is missing", key="modulus", allowed="given, or strength")
        return self


LINEAR_DENSITY = one_of(
    "the linear density that is used where a fabric file has two: `effective`, from the areal density of the "
    "published runs, or `nominal`, of the data sheet",
    "effective",
    "nominal",
)


class FabricTable(Table, CellNumbers):  # type: ignore[misc] # frozen by its model_config
    """The fabric of all plies that name no other, its compression law and the model of its unit
    cell. The first two lines are all that most input files need.

    [fabric]
    name = "S-728"
    law = "published"
    """

    synonyms: ClassVar = {"material": "name", "path": "file", "compression": "law"}

    name: Annotated[
        string(
            "fabric of the catalogue (`weavecell fabrics list`); either this or `fabric.file`",
            "the name of a fabric of the catalogue",
        ),
        FileOnly(),
    ] = None
    file: Annotated[
        string(
            "fabric file of the user; either this or `fabric.name`",
            "the path of a fabric file (*.toml)",
        ),
        FileOnly(),
    ] = None
    linear_density: Annotated[LINEAR_DENSITY, FileOnly()] = "effective"
    weaving_damage: Annotated[
        WeavingDamageTable | None,
        Field(description='a table { modulus = 0.9, strength = 0.8, source = "..." }'),
        Unread("picture_frame", UNSTRETCHED),
    ] = None
    law: Annotated[
        Law,
        described(
            "compression law of warp and weft; needed for a fabric without a published one, such as your own",
            LAW,
        ),
        MayBeObject(),
    ] = "published"
    surface: Annotated[
        Any,
        Unread("export", "left out: a card is made from compression laws"),
        Unread("coupon", "left out: the cell of a coupon is made from laws"),
        BeforeValidator(_object),
        WithJsonSchema(TEXT),
        described(
            "response surface of the 3D crossover, which replaces the analytical cell and `fabric.law`",
            "the path of a surface written by `weavecell surface`",
        ),
        MayBeObject(),
    ] = None
    bending: Annotated[
        shot_keys.BENDING,
        Unread("export", "0: a membrane has no bending stiffness"),
        Unread(
            "bias_extension picture_frame uniaxial biaxial",
            "left out: only the yarns of a pull-out have bending stiffness",
        ),
    ] = 0.0

    @model_validator(mode="after")
    def _check_one_cell(self):
        if self.surface is not None:
            keys = "law cell_model crossover_gap weaving_damage"
            self.refuse(keys, "left out with fabric.surface")
        if self.cell_model != "compressible":
            models = '"incompressible" or "decoupled", whose yarns are not compressed'
            self.refuse("law", f"left out if fabric.cell_model is {models}")
        # yarns that never touch have no play to close
        if self.cell_model == "decoupled":
            words = 'left out if fabric.cell_model is "decoupled", whose yarns never touch'
            self.refuse("crossover_gap", words)
        # `direct` reads tensions off a surface, `equilibrium` solves the analytical cell
        if self.surface is None:
            other = "direct"
            words = "without"
        else:
            other = "equilibrium"
            words = "with"
        if self.cell_formulation == other:
            forms = "variational or direct"
            if self.surface is None:
                forms = "variational or equilibrium"
            raise InputError(key="cell_formulation", allowed=f"{forms} {words} fabric.surface")
        return self


# keys of [fabric] that a ply with a fabric of its own does not take, and has itself
OF_ONE_FABRIC = ("name", "file", "linear_density", "law", "weaving_damage")


def anchor_paths(scene: Any, file: FilePath) -> Any:
    """Return the scene with its relative paths taken from the folder of the scene file.

    Raises
    ------
    InputError : a path that is not that of a file
    """

    def of(name, table, keys):
        """The table [name] whose paths, all texts but the names of laws, are taken from that
        folder."""
        given = {key: getattr(table, key) for key in keys}
        texts = {}
        for key, text in given.items():
            if isinstance(text, str) and text not in _NAMED_LAWS:
                texts[key] = text
        paths = {key: os.path.normpath(Path(file).parent / text) for key, text in texts.items()}
        # a missing file is named by the key of the scene, before anything is built
        for key, path in paths.items():
            if not os.path.isfile(path):
                allowed = type(table).model_fields[key].description
                raise InputError(
                    f"there is no file {path}",
                    file=file,
                    key=f"{name}.{key}",
                    value=texts[key],
                    allowed=allowed,
                )
        return table.model_copy(update=paths)

    updates: dict[str, Any] = {"fabric": of("fabric", scene.fabric, ("file", "law", "surface"))}
    shot = getattr(scene, "projectile", None)
    panel = getattr(scene, "panel", None)
    if shot is not None:
        updates["projectile"] = of("projectile", shot, ("stl",))
    if panel is not None:
        plies = tuple(of("panel.ply", ply, ("file", "law")) for ply in panel.ply)
        updates["panel"] = of("panel", panel, ("ply_contact",)).model_copy(update={"ply": plies})
    return scene.model_copy(update=updates)


def check_scene(
    kind: type[Kind],
    table: dict[str, Any],
    file: FilePath | None,
    reader: Reader | None = None,
    context: Any = None,
) -> Kind:
    """Turn the table of a scene into a checked scene.

    Parameters
    ----------
    kind : class of the scene
    table : as it is written
    file : named in errors, its folder anchors relative paths; None of a scene without a file
    reader : what the scene is read for, which refuses keys that it does not read (`Unread`); None if
        any key may be set
    context : see `fabrics.base.schema.validated`

    Raises
    ------
    InputError : a line for each thing that is wrong with it
    """
    table = kept_files.use_copies_of_missing(table, file)
    scene = validated(kind, table, file, context)
    if reader is not None:
        # a coupon is read by its test too
        for name in dict.fromkeys((reader, getattr(scene, "test", reader))):
            refuse_passed_over(scene, table, file, name)
    if file is None:
        return scene
    return anchor_paths(scene, file)


def exactly_one(table: Table, keys: Sequence[str], name: str = "") -> None:
    """Raise an InputError unless exactly one of some keys of the table [name] is given."""
    if sum(getattr(table, key) is not None for key in keys) != 1:
        paths = [f"{name}.{key}".lstrip(".") for key in keys]
        raise InputError(
            f"give exactly one of {', '.join(paths[:-1])} and {paths[-1]}", key=name or None
        )
