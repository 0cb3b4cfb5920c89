"""Scene files of coupons: one test on a piece of fabric, described in TOML as impacts are
(`tables`)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, model_validator

from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.base.schema import (
    Table,
    Unread,
    angle,
    changed,
    flag,
    number,
    one_of,
    quantities,
    quantity,
    some_of,
    string,
    whole,
)
from fabrics.plausible import Number
from weavecell.scenes.fabric_table import FabricTable, exactly_one

if TYPE_CHECKING:
    from fabrics.fabric import Fabric

TESTS = ("bias_extension", "picture_frame", "uniaxial", "biaxial", "pull_out")
# [-] default limit of the out-of-balance force over the reaction (docs/coupons.md)
TOLERANCE = 1e-3
# keys of what is tested and written; the law is named by its source
NO_CHOICES = {"title", "fabric.name", "fabric.file", "fabric.law", "run.outputs"}


class BiasTable(Table):
    """A strip cut at 45 degrees to its yarns, pulled by two clamps.

    [bias_extension]
    length = "143.5 mm"
    width = "74 mm"
    elongation = "10 mm"
    """

    length: quantity("length of the coupon between the clamps", "m", "143.5 mm", most="5 m")
    width: quantity("width of the coupon", "m", "74 mm", most="5 m")
    elongation: quantity("displacement of the moving clamp at the end", "m", "10 mm")
    trellis: flag("whether the trellis shear law acts") = True

    @model_validator(mode="after")
    def _longer_than_wide(self):
        if self.length <= self.width:
            raise InputError(key="length", allowed=f"above the width, {1e3 * self.width:g} mm")
        return self


class FrameTable(Table):
    """A square of fabric sheared in a hinged frame.

    [picture_frame]
    shear_angle = "35 deg"
    """

    shear_angle: angle("shear angle at the end", 0.1, 89, "35 deg")
    crossovers: whole("crossovers along each side of the frame", 2, 400) = 8


class UniaxialTable(Table):
    """A strip pulled along its warp or its weft, its long sides free.

    [uniaxial]
    direction = "warp"
    length = "100 mm"
    width = "30 mm"
    strain = "5 %"
    """

    direction: one_of("yarns along which the strip is pulled", "warp", "weft")
    length: quantity("length of the strip between the clamps", "m", "100 mm", most="5 m")
    width: quantity("width of the strip", "m", "30 mm", most="5 m")
    strain: quantity("nominal strain at the end", "", "5 %")
    failure: flag("whether the run ends when a yarn reaches its strength") = True


class BiaxialTable(Table):
    """A cross pulled by its four arms.

    [biaxial]
    strain = ["2 %", "1 %"]
    """

    strain: quantities(
        "nominal strains of the arms at the end",
        "",
        "a list of two strains of at least 0, one of them above, of warp and weft",
        '["2 %", "1 %"]',
    )
    centre: whole("crossovers along each side of the central square", 2, 400) = 12
    arm: whole("crossovers along each arm", 1, 400) = 8
    cross_yarns_removed: flag(
        "whether the transverse yarns of the arms are removed, so that the arms carry no transverse load"
    ) = True
    failure: flag("whether the run ends when a yarn reaches its strength") = True

    @model_validator(mode="after")
    def _check_two_strains(self):
        if len(self.strain) != 2 or not min(self.strain) >= 0 < max(self.strain):
            raise InputError(key="strain", allowed=type(self).model_fields["strain"].description)
        return self


class PullOutTable(Table):
    """One warp yarn drawn out of crossovers that are held; the yarns that it crosses are in
    tension.

    [pull_out]
    displacement = "5 mm"
    crossover_cohesion = "0.1 N"
    """

    crossings: whole("crossovers that the yarn is pulled through", 1, 400, 10) = 20
    displacement: quantity("displacement of the crosshead at the end", "m", "5 mm")
    pre_tension: quantity(
        "tension of each crossing yarn before the pull", "N", "10 N", zero=True
    ) = 0.0
    crossover_friction: number(
        "Coulomb coefficient of yarn on yarn; assumed by fibre family if not given, 0.2 of para-aramid",
        0.3,
        ge=0.0,
        le=2.0,
    ) = None
    crossover_cohesion: quantity(
        "friction of a crossover without contact force", "N", "0.1 N", zero=True
    ) = 0.0
    samples: whole("samples of the load that are kept", 10, 100_000, 100) = 500


NO_STEPS = "left out in a pull-out"


class CouponRunTable(Table):
    """Load steps, mesh, tolerance, and the files that are written.

    [run]
    steps = 20
    tolerance = 1e-3
    """

    steps: Annotated[
        whole("load steps; not used in a pull-out", 1, 1000), Unread("pull_out", NO_STEPS)
    ] = 20
    elements_per_crossover: Annotated[
        whole("elements along each side of a crossover", 1, 8), Unread("pull_out", NO_STEPS)
    ] = 1
    tolerance: Annotated[
        number("convergence: out-of-balance force over the reaction", 1e-2, gt=0.0, le=0.1),
        Unread("pull_out", NO_STEPS),
    ] = TOLERANCE
    max_iterations: Annotated[
        whole("iterations of dynamic relaxation in a load step at most", 10, 10_000_000, 100),
        Unread("pull_out", NO_STEPS),
    ] = 50_000
    outputs: some_of(
        "which outputs are written beside `histories.h5` and `summary.json`", "pictures", "report"
    ) = (
        "pictures",
        "report",
    )


class CouponScene(Table):
    """One test on one coupon."""

    title: string("heading of the report", "a text") = ""
    fabric: Annotated[FabricTable, Field(description="a table [fabric]")]
    bias_extension: Annotated[BiasTable | None, Field(description="a table [bias_extension]")] = (
        None
    )
    picture_frame: Annotated[FrameTable | None, Field(description="a table [picture_frame]")] = None
    uniaxial: Annotated[UniaxialTable | None, Field(description="a table [uniaxial]")] = None
    biaxial: Annotated[BiaxialTable | None, Field(description="a table [biaxial]")] = None
    pull_out: Annotated[PullOutTable | None, Field(description="a table [pull_out]")] = None
    run: Annotated[CouponRunTable, Field(description="a table [run]")] = CouponRunTable()

    @model_validator(mode="after")
    def _check_one_test(self):
        exactly_one(self.fabric, ("name", "file"), "fabric")
        exactly_one(self, TESTS)
        if self.test != "pull_out":
            return self
        # flexible yarns press on each other with no force: whatever the friction, the load is 0
        if self.pull_out.crossover_cohesion == 0 and self.fabric.bending == 0:
            allowed = (
                "above 0 with flexible yarns, which press on each other with no force that friction could "
                "act on: the load would be 0 N; or give fabric.bending"
            )
            raise InputError(key="pull_out.crossover_cohesion", value="0 N", allowed=allowed)
        return self

    @property
    def test(self) -> str:
        """Name of the test, of TESTS."""
        return next(name for name in TESTS if getattr(self, name) is not None)

    @property
    def trellis_law(self) -> str:
        """Whether the test needs the fabric's trellis law: "needed", "optional" or "unused"."""
        if self.test == "bias_extension":
            if self.test_table.trellis:
                return "needed"
            return "unused"
        if self.test == "picture_frame":
            return "needed"
        return "optional"

    @property
    def presses_yarns(self) -> bool:
        """Whether the test needs the compression law of the yarns: a picture frame stretches none."""
        return self.test != "picture_frame"

    @property
    def test_table(self) -> Any:
        """The table of the test."""
        return getattr(self, self.test)

    def say_test(self, fabric: str, steps: int, elements: str = "") -> str:
        """Say in a sentence what is tested, and how.

        Parameters
        ----------
        steps : of the load
        elements : how many there are, with a comma behind; "" where that is not known
        """
        if self.test == "pull_out":
            return (
                f"One yarn of {fabric} drawn through {self.test_table.crossings} held crossovers."
            )
        return (
            f"A coupon of {fabric}, {elements}in {counted(steps, 'load step')}, each relaxed to "
            f"{self.run.tolerance:g} of the reaction."
        )

    def list_choices(self) -> dict[str, Any]:
        """List {key in words: value in SI units} of test, cell and load steps that is no default."""
        chosen = {}
        for key in changed(self):
            if key in NO_CHOICES:
                continue
            value: Any = self
            for part in key.split("."):
                value = getattr(value, part)
            chosen[key.replace(".", " ").replace("_", " ")] = value
        return chosen


def list_numbers(scene: CouponScene, fabric: Fabric) -> Iterator[Number]:
    """List the numbers of a test that are compared with `fabrics.plausible`."""
    table = scene.test_table
    for name in ("length", "width"):
        if hasattr(table, name):
            yield Number(f"{scene.test}.{name}", "coupon_length", getattr(table, name))
    match scene.test:
        case "bias_extension":
            ratio = table.elongation / table.length
            yield Number("bias_extension.elongation", "elongation", ratio)
        case "uniaxial":
            yield Number("uniaxial.strain", "coupon_strain", table.strain)
        case "biaxial":
            yield Number("biaxial.strain", "coupon_strain", max(table.strain))
        case "pull_out":
            drawn = table.crossings / fabric.weave.weft_count
            ratio = table.displacement / drawn
            yield Number("pull_out.displacement", "pull_out_displacement", ratio)
            if table.crossover_friction is not None:
                yield Number("pull_out.crossover_friction", "friction", table.crossover_friction)
            strength = fabric.weave.weft.strength
            yield Number("pull_out.pre_tension", "yarn_force", table.pre_tension / strength)
            ratio = table.crossover_cohesion / strength
            yield Number("pull_out.crossover_cohesion", "cohesion", ratio)
