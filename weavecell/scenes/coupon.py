"""Scene files of coupons: one test on a piece of cloth, described in TOML as impacts are (`tables`)."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from fabrics.checks import FilePath
from fabrics.errors import InputError
from weavecell.scenes import supported
from weavecell.scenes.schema import (
    FabricTable,
    Table,
    anchored,
    angle,
    exactly_one,
    one_of,
    quantities,
    quantity,
    read_toml,
    validated,
    whole,
)

YES = Annotated[bool, Field(description="true or false")]
TESTS = ("bias_extension", "picture_frame", "uniaxial", "biaxial", "pull_out")
TOLERANCE = 1e-3  # [-] of the out-of-balance force over the reaction, by default (docs/coupons.md)


class BiasTable(Table):
    """A coupon cut at 45 degrees to its yarns, pulled by two clamps (thesis section 4.4.3)."""

    length: quantity("m", "a length above 0", "143.5 mm", above=0.0)
    width: quantity("m", "a length above 0", "74 mm", above=0.0)
    elongation: quantity("m", "a length above 0", "10 mm", above=0.0)
    trellis: YES = True


class FrameTable(Table):
    """A square of cloth in a hinged frame (thesis Figure 4-24)."""

    shear_angle: angle(0.1, 89, "35 deg")
    crossovers: whole(2, 400) = 8


class UniaxialTable(Table):
    """A strip pulled along its warp or its weft, its sides free."""

    direction: one_of("warp", "weft")
    length: quantity("m", "a length above 0", "100 mm", above=0.0)
    width: quantity("m", "a length above 0", "30 mm", above=0.0)
    strain: quantity("", "a strain above 0", "5 %", above=0.0)
    failure: YES = True


class BiaxialTable(Table):
    """A cross pulled by its four arms (thesis section 5.3)."""

    strain: quantities("", "a list of two strains of at least 0, one of them above, of warp and weft", '["2 %", "1 %"]')
    centre: whole(2, 400) = 12
    arm: whole(1, 400) = 8
    cross_yarns_removed: YES = True
    failure: YES = True


class PullOutTable(Table):
    """A yarn of the warp drawn out of held crossovers by a crosshead, the yarns that it crosses in tension."""

    crossings: whole(8, 400) = 20
    displacement: quantity("m", "a length above 0", "5 mm", above=0.0)
    velocity: quantity("m/s", "a velocity above 0", "2 m/s", above=0.0) = 2.0
    pre_tension: quantity("N", "a force of at least 0", "10 N", at_least=0.0) = 0.0
    crossover_friction: Annotated[float, Field(ge=0.0, le=2.0, description="a number from 0 to 2")] = 0.2
    crossover_cohesion: quantity("N", "a force of at least 0", "0.1 N", at_least=0.0) = 0.0
    all_yarns: YES = False
    samples: whole(10, 100_000) = 500


class CouponRunTable(Table):
    """In how many steps, how fine, how close to equilibrium, and what is written."""

    steps: whole(1, 1000) = 20
    elements_per_crossover: whole(1, 8) = 1
    tolerance: Annotated[float, Field(gt=0.0, le=0.1, description="a number above 0 and at most 0.1")] = TOLERANCE
    max_iterations: whole(10, 10_000_000) = 50_000
    outputs: Annotated[
        tuple[Literal["pictures", "report"], ...],
        BeforeValidator(lambda value: tuple(value) if isinstance(value, list) else value),
        Field(description='a list of "pictures", "report"'),
    ] = ("pictures", "report")


class CouponScene(Table):
    """One test on one coupon."""

    title: Annotated[str, Field(description="a text")] = ""
    fabric: Annotated[FabricTable, Field(description="a table [fabric]")]
    bias_extension: Annotated[BiasTable | None, Field(description="a table [bias_extension]")] = None
    picture_frame: Annotated[FrameTable | None, Field(description="a table [picture_frame]")] = None
    uniaxial: Annotated[UniaxialTable | None, Field(description="a table [uniaxial]")] = None
    biaxial: Annotated[BiaxialTable | None, Field(description="a table [biaxial]")] = None
    pull_out: Annotated[PullOutTable | None, Field(description="a table [pull_out]")] = None
    run: Annotated[CouponRunTable, Field(description="a table [run]")] = CouponRunTable()

    @property
    def test(self) -> str:
        """Name of the test, of TESTS."""
        return next(name for name in TESTS if getattr(self, name) is not None)

    @property
    def trellis_law(self) -> str:
        """Whether the test needs the fabric's trellis law: "needed", "optional" or "unused"."""
        if self.test == "bias_extension":
            return "needed" if self.test_table.trellis else "unused"
        return "needed" if self.test == "picture_frame" else "optional"

    @property
    def test_table(self) -> Any:
        """The table of the test."""
        return getattr(self, self.test)


def load(path: FilePath, support: Any = None) -> tuple[CouponScene, str]:
    """Read and check the scene file of a coupon; `support` as in `scenes.impact.load`.

    Returns
    -------
    scene : CouponScene, in SI units, its paths taken from the folder of the file
    text : the file as written, for the record

    Raises
    ------
    InputError : one line naming the file, the key, its value and what is allowed
    """
    text, table = read_toml(path, what="scene")
    return check(table, path, support), text


def check(table: dict[str, Any], file: FilePath, support: Any = None) -> CouponScene:
    """Turn a scene's table into a checked CouponScene; `file` is named in errors and anchors relative paths."""
    scene = validated(CouponScene, table, file)
    exactly_one(scene.fabric, ("name", "file"), "fabric", file)
    exactly_one(scene, TESTS, "", file)
    if support is not None:
        supported.check(scene, table, file, support)
    written, test = table[scene.test], scene.test_table
    if scene.test == "bias_extension" and test.length <= test.width:
        key, allowed = "bias_extension.length", f"above the width, {written['width']}"
        raise InputError(file=file, key=key, value=written["length"], allowed=allowed)
    if scene.test == "biaxial" and not (len(test.strain) == 2 and min(test.strain) >= 0 < max(test.strain)):
        words = BiaxialTable.model_fields["strain"].description
        raise InputError(file=file, key="biaxial.strain", value=written["strain"], allowed=words)
    if scene.test == "pull_out" and test.crossings % 2:
        allowed = "an even number from 8 to 400"
        raise InputError(file=file, key="pull_out.crossings", value=written["crossings"], allowed=allowed)
    return anchored(scene, Path(file).parent)
