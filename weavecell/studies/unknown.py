"""What nobody knows of a shot, and from what it is drawn: each unknown is one row of `ROWS`.

A row finds the range of its unknown in a set-up, and puts the value at a share of this range into it. What
the user gives without a range has none, and is not drawn; what is given with one is drawn from it; what
nobody gave from the range of its fibre family or of the data files, with their source. Half of the draws lie
below the value of the set-up, half above it: the one run at nominal values stands in their middle.

A share depends on seed, number and the name of the row alone, so that two set-ups share the draws of what
both leave open, and a row more moves no draw of the others. Of one row shares are spread evenly over
numbers from 0 on: points of van der Corput's sequence, scrambled as Owen did (1995, Lecture Notes in
Statistics 106, 299) by what seed and name say; place, roll and frictions are points of one Sobol sequence,
shifted by what the seed draws. Modulus and crimp differ from panel to panel, as random numbers do.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from hashlib import blake2b
from itertools import pairwise
from math import exp, gamma, inf, log, pi, remainder, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import assumed, data_sheet
from fabrics.base.assumed_number import Assumed, is_assumed
from fabrics.base.errors import InputError
from fabrics.base.range_texts import CUT_OFF
from fabrics.fabric import Fabric
from fabrics.fabric_tables import FAMILIES
from fabrics.families import Entry
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.membrane.boundary import Grip
from shellfabric.plies.gap import gap_between
from shellfabric.plies.numerics import PlyContact
from weavecell.studies import inputs
from weavecell.studies.inputs import Scatter, scale_setup
from weavecell.studies.places import ON_WARP, strike_at

if TYPE_CHECKING:
    from weavecell.api.target import Target

PLACE = "place"  # that is struck
STRENGTH_OF_YARNS = "strength of yarns"  # each of its own, see `strengths`
GIVEN, ASSUMED = "given", "assumed"
# [spacings] along warp and weft from a crossover: every other place of a plain weave is the image of
# one in here, by the middle lines of the yarns and by a step along both families
PLACES = 0.5, 1.0
SPREAD = 6  # rows whose shares are points of one Sobol sequence
LEVELS = 24  # binary digits of a share
ALIKE = Scatter()  # of panels that are all alike


@dataclass(frozen=True)
class Range:
    """From what a number is drawn.

    Parameters
    ----------
    value, low, high : [SI] half of the draws lie on either side of the value
    source : where the range comes from
    given : whether the user gave it
    deviation : one standard deviation, of a normal distribution that ends at low and high; 0 of one that
        is even on either side
    scatter : [-] standard deviation over mean of a log-normal distribution of mean `value`; 0 of the others
    """

    value: float
    low: float
    high: float
    source: str
    given: bool = False
    deviation: float = 0.0
    scatter: float = 0.0

    @property
    def number(self) -> Assumed:
        """The value, with its range."""
        return Assumed(self.value, self.low, self.high, self.deviation, self.given)

    def at(self, share: float) -> float:
        """Return the number that a share of the draws lies below."""
        from scipy.special import ndtr, ndtri

        if self.scatter:
            variance = log(1 + self.scatter**2)
            return self.value * exp(sqrt(variance) * ndtri(share) - 0.5 * variance)
        if self.deviation:
            ends = ndtr([-CUT_OFF, CUT_OFF])
            return self.value + self.deviation * float(ndtri(np.interp(share, (0.0, 1.0), ends)))
        if self.value == 0.5 * (self.low + self.high):
            return self.low + share * (self.high - self.low)
        return float(np.interp(share, (0.0, 0.5, 1.0), (self.low, self.value, self.high)))

    def beside(self, share: float) -> float:
        """Return how far a draw lies from the middle, over the width of the range."""
        if self.deviation or self.value != 0.5 * (self.low + self.high):
            return (self.at(share) - self.value) / (self.high - self.low)
        return share - 0.5

    def words(self, scale: float = 1.0, unit: str = "") -> str:
        """Write the range."""
        value, low, high = (scale * number for number in (self.value, self.low, self.high))
        said = f"{low:.4g} to {high:.4g}"
        if self.deviation or self.scatter:
            said = f"{value:.4g} ± {scale * (self.deviation or self.scatter * self.value):.2g}"
        return f"{said} {unit}".rstrip()


Find = Callable[[Any, Scatter], Range | None]
Put = Callable[[Any, float | None, Scatter], Any]


@dataclass(frozen=True)
class Unknown:
    """One row.

    Parameters
    ----------
    name : in words
    find : returns the Range in a set-up, by the scatter of panels; None of what is given, or of what the
        set-up does not have
    put : returns the set-up with the value at a share of this range; None of what `strengths` draws
    advice : what tells it
    keys : of input or fabric files that give it
    short : what it is called with others that belong to it; "" by its name
    unit, scale : of values in words, and over SI
    sobol : number of its share among those of the Sobol sequence; None of its own sequence
    panel : number of its share among those that are random from panel to panel; None of others
    of_cloth : whether it is one for all shots at one cloth, or new for each
    known : whether limits are estimated from it
    """

    name: str
    find: Find
    put: Put | None
    advice: str
    keys: tuple[str, ...] = ()
    short: str = ""
    unit: str = ""
    scale: float = 1.0
    sobol: int | None = None
    panel: int | None = None
    of_cloth: bool = True
    known: bool = False

    @property
    def words(self) -> str:
        """Its name, as the estimate of limits has it."""
        return self.name

    @property
    def column(self) -> str:
        """Its name as a column of a table."""
        return self.name.replace("the ", "").replace(" ", "_")

    def share(self, seed: int, number: int, panel: int) -> float:
        """Draw the share of a number; `panel` is the number of what differs from panel to panel."""
        if self.sobol is not None:
            return float(_spread(seed, number)[self.sobol])
        if self.panel is not None:
            from scipy.special import ndtr

            normal = np.random.default_rng([seed, panel]).standard_normal(3)
            return float(ndtr(normal[self.panel]))
        return _scrambled(self.name, seed, number)


def _spread(seed, number):
    """(SPREAD,) of the numbers from 0 on they are spread evenly, each by itself may be anywhere."""
    # the first draws of the shift are those of the place
    shift = np.random.default_rng(seed).uniform(size=SPREAD)
    return (_sobol_points(1 + number)[number] + shift) % 1.0


@cache
def _sobol_points(least):
    """At least so many points of the sequence."""
    if least & (least - 1):
        return _sobol_points(1 << least.bit_length())
    # takes a quarter of a second to load, which one run at nominal values does not need
    from scipy.stats import qmc

    return qmc.Sobol(SPREAD, scramble=False).random(least)


@cache
def _scrambled(name, seed, number):
    """Point of a number of van der Corput's sequence, each of its digits turned round or not by what the
    digits before it are."""
    share = 0.0
    before = ""
    for level in range(1, LEVELS + 1):
        digit = number & 1
        number >>= 1
        turned = blake2b(f"{name} {seed} {before}".encode(), digest_size=1).digest()[0] & 1
        share += (digit ^ turned) * 0.5**level
        before += str(digit)
    # in the middle of what this many digits leave open: 0 and 1 are no shares
    return share + 0.5 ** (LEVELS + 1)


# how a range is found and a value put


def _written(find, write):
    """(find, put) of what write(part, value) puts into a set-up or a ply; without a share the value with its
    range."""

    def put(part, share, scatter):
        found = find(part, scatter)
        if found is None:
            return part
        return write(part, found.number if share is None else found.at(share))

    return find, put


def _in_each_ply(find_in, put_in, when=None):
    """(find, put) of what each ply has by itself, all at the same share of their own ranges; the first that
    has one stands for all. when(setup) tells whether it counts at all."""

    def find(setup, scatter):
        if when is not None and not when(setup):
            return None
        found = (find_in(ply, scatter) for ply in (setup, *setup.lay_up))
        return next(filter(None, found), None)

    def put(setup, share, scatter):
        plies = tuple(put_in(ply, share, scatter) for ply in setup.lay_up)
        return put_in(replace(setup, lay_up=plies), share, scatter)

    return find, put


def _range_of(number, source="the input"):
    """The Range of a number that says it itself."""
    return Range(float(number), *number.span, source, number.given, number.deviation)


def _of_entry(entry: Entry) -> Range:
    return Range(entry.value, entry.low, entry.high, entry.source)


def _of_ratios(fabric: Fabric, key: str) -> Range | None:
    """The range of a number of a fabric file over its value; None without one."""
    low, high = fabric.ranges.get(key, (1.0, 1.0))
    if not low < high:
        return None
    source = fabric.sources.get(key, {}).get("source", "")
    given = key not in fabric.guessed and key.partition(".")[0] not in fabric.assumed
    return Range(1.0, low, high, source, given, dict(fabric.deviations).get(key, 0.0))


def _of_number(entry, read, write):
    """(find, put) of a number that says itself whether it is known: read(setup), None where there is none.

    entry : its name in `inputs.ranges`
    """

    def find(setup, scatter):
        number = read(setup)
        if not is_assumed(number):
            return None
        if number.given:
            return _range_of(number)
        usual = inputs.ranges(*setup.fabrics)[entry]
        if number.low < number.high:
            return _range_of(number, usual.source)
        # one that says nothing of its range
        return _of_entry(usual) if usual.low < usual.high else None

    return _written(find, write)


def _field_of_zone(field):
    """(read, write) of a number of resolved yarns."""

    def read(setup):
        return setup.crossovers and getattr(setup.crossovers, field)

    def write(setup, value):
        return replace(setup, crossovers=replace(setup.crossovers, **{field: value}))

    return read, write


def _field_of_pack(field):
    """(read, write) of a number of packs."""

    def read(setup):
        return getattr(setup, field) if setup.plies > 1 else None

    return read, lambda setup, value: replace(setup, **{field: value})


def _read_nose(setup):
    return setup.projectile.friction


def _write_nose(setup, value):
    return replace(setup, projectile=replace(setup.projectile, friction=value))


def _read_resilience(setup):
    return (setup.contact or PlyContact()).resilience if setup.plies > 1 else None


def _write_resilience(setup, value):
    return replace(setup, contact=replace(setup.contact or PlyContact(), resilience=value))


def _of_place(axis):
    """(find, put) of the place that is struck, in spacings from the crossover that is nearest to the impact
    point. One ply of pinned yarns keeps its planes of symmetry."""

    def find(setup, scatter):
        if setup.crossovers is None and (setup.plies == 1 or setup.backing is not None):
            return None
        reach = PLACES[axis]
        pattern = setup.fabric.weave.pattern
        if not pattern.is_plain:
            # along the warp the weft yarns follow each other
            reach = float(pattern.matrix.shape[1 - axis])
        return Range(0.5 * reach, 0.0, reach, "a repeat of the weave: nobody aims at a crossover")

    def write(setup, value):
        point = list(setup.impact_point)
        spacing = 2 * setup.fabric.weave.w[axis]
        point[axis] = float(spacing * (round(point[axis] / spacing) + value))
        return replace(setup, impact_point=tuple(point))

    return _written(find, write)


def _find_roll(setup, scatter):
    """Beyond the nose's own: any angle of a half turn, after which a chisel is the same; of a body of an STL
    file of a full one."""
    nose = setup.projectile
    if nose.known.turned or ROWS[0].find(setup, scatter) is None:
        return None
    turn = 2 * pi if nose.known.from_file else pi
    return Range(0.5 * turn, 0.0, turn, "any: nobody holds the roll of a fragment")


def _write_roll(setup, value):
    roll = remainder(setup.projectile.roll + value, 2 * pi)
    return replace(setup, projectile=replace(setup.projectile, roll=roll))


def _ranged_clamps(edge) -> Iterator[Grip]:
    """The friction clamps with a range of an edge in any of its forms."""
    if isinstance(edge, tuple):
        for part in edge:
            yield from _ranged_clamps(part)
    elif isinstance(edge, Grip) and is_assumed(edge.clamp_force):
        yield edge


def _find_clamp(setup, scatter):
    forces = (_range_of(grip.clamp_force) for grip in _ranged_clamps(setup.boundary))
    return next(forces, None)


def _put_clamp(setup, share, scatter):
    def change(edge):
        if isinstance(edge, tuple):
            return tuple(map(change, edge))
        if not any(_ranged_clamps(edge)):
            return edge
        return replace(edge, clamp_force=_range_of(edge.clamp_force).at(share))

    return replace(setup, boundary=change(setup.boundary))


def _gaps(setup):
    """The Range, or None of what is given, of the gap behind each ply but the last."""
    if setup.plies == 1:
        return []
    found = []
    for front, rear in pairwise(
        setup.lay_up or setup.plies * (Ply(setup.fabric, gap=setup.ply_gap),)
    ):
        between = gap_between(front.fabric, rear.fabric)
        gap = None
        if is_assumed(front.gap):
            gap = _range_of(front.gap)
        elif front.gap is None and between.low < between.high:
            gap = Range(between.value, between.low, between.high, between.source)
        found.append(gap)
    return found


def _find_gap(setup, scatter):
    return next(filter(None, _gaps(setup)), None)


def _put_gap(setup, share, scatter):
    gaps = [found and found.at(share) for found in _gaps(setup)]
    if not setup.lay_up:
        return (
            replace(setup, ply_gap=gaps[0]) if any(found is not None for found in gaps) else setup
        )
    plies = zip(setup.lay_up, [*gaps, None])
    return replace(
        setup, lay_up=tuple(ply if gap is None else replace(ply, gap=gap) for ply, gap in plies)
    )


def _fails_by_laws(setup):
    return setup.yarn_failure and setup.surface is None


def _has_laws(setup):
    return setup.surface is None


def _find_woven(ply, scatter):
    """Yarns are tested before weaving: what is left of their strength is assumed, unless it is given."""
    fabric = ply.fabric
    stated = fabric.sources.get(WOVEN, {}).get("value")
    if is_assumed(stated):
        return _range_of(stated)
    if stated is not None and data_sheet.STRENGTH_AFTER_WEAVING not in fabric.assumed:
        return None
    return _of_entry(assumed.shot_entries(fabric)[data_sheet.STRENGTH_AFTER_WEAVING])


def _write_woven(ply, value):
    # the catalogue has strengths before weaving, as the thesis
    ratio = value / ply.fabric.sources.get(WOVEN, {}).get("value", 1.0)
    strains = [ratio * yarn.failure_strain for yarn in ply.fabric.weave.yarns]
    return replace(ply, fabric=ply.fabric.with_yarns(failure_strain=strains))


def _of_yarns(*names):
    """(find, put) of numbers of [warp] and [weft] that a fabric file has with a range, as factors."""

    def find(ply, scatter):
        keys = [f"{family}.{name}" for name in names for family in FAMILIES]
        return next(filter(None, (_of_ratios(ply.fabric, key) for key in keys)), None)

    def put(ply, share, scatter):
        fabric = ply.fabric
        for name in names:
            found = [_of_ratios(fabric, f"{family}.{name}") for family in FAMILIES]
            ratios = [1.0 if one is None else one.at(share) for one in found]
            if any(found):
                fabric = assumed.scale_ranged(fabric, name, (ratios[0], ratios[1]))
        return replace(ply, fabric=fabric)

    return find, put


def _of_panels(factor, spread):
    """(find, put) of a factor of `inputs.scale_fabric` that differs from panel to panel, where no fabric
    file has a range of it."""

    def find(setup, scatter):
        share = getattr(scatter, spread)
        stated = _in_each_ply(*_of_yarns(spread))[0](setup, scatter)
        if not share or stated is not None:
            return None
        source = inputs.table("spread")[spread].source
        return Range(1.0, 1 - CUT_OFF * share, 1 + CUT_OFF * share, source, scatter=share)

    return _written(find, lambda setup, value: scale_setup(setup, **{factor: value}))


def _of_geometry(entry, field):
    """(find, put) of what crimp is computed from where the fabric file does not give it: a number of
    `data_sheet.toml` and keyword of `assumed.of_thickness`, which takes all of them at once (`put_all`)."""

    def find(ply, scatter):
        fabric = ply.fabric
        if "crimp" not in fabric.assumed or entry not in assumed.entries_of_crimp(fabric):
            return None
        if entry == "warp_share" and not all(assumed.is_crimp_computed(fabric)):
            return None
        found = _of_ratios(fabric, entry) or _of_entry(data_sheet.entries()[entry])
        try:
            assumed.of_thickness(fabric, **{field: found.low})
        except InputError:
            # thinner than the yarn whose crimp is given
            return replace(found, low=found.value, deviation=0.0)
        return found

    return find


GEOMETRY = {  # {name: find in a ply, keyword of `assumed.of_thickness`}
    "thickness": (_of_geometry("thickness", "factor"), "factor"),
    "areal density": (_of_geometry("areal_density", "mass"), "mass"),
    "share of the warp in the thickness": (_of_geometry("warp_share", "share"), "share"),
    "length of changes of sides": (
        _of_geometry("straight_floats", "straight_floats"),
        "straight_floats",
    ),
}


def _put_geometry(shares: Mapping[str, float], ply, share, scatter):
    """A ply whose crimp follows from all that is drawn of `GEOMETRY`: {name: share}."""
    found = {GEOMETRY[name][1]: GEOMETRY[name][0](ply, scatter) for name in shares}
    at = {GEOMETRY[name][1]: share for name, share in shares.items()}
    numbers = {field: one.at(at[field]) for field, one in found.items() if one is not None}
    return replace(ply, fabric=assumed.of_thickness(ply.fabric, **numbers)) if numbers else ply


def _find_trellis(ply, scatter):
    if ply.fabric.shear is None or not assumed.has_range(ply.fabric, "shear"):
        return None
    is_assumed_table = "shear" in ply.fabric.assumed
    source = ply.fabric.sources.get("shear.G2", {}).get("source", "")
    return Range(0.5, 0.0, 1.0, source, given=not is_assumed_table and not ply.fabric.guessed)


def _write_trellis(ply, value):
    return replace(ply, fabric=assumed.shear_at(ply.fabric, value))


def _laws_of(ply):
    return ply.laws or ply.fabric.laws or ()


def _find_law(ply, scatter):
    laws = _laws_of(ply)
    given = any(is_assumed(number) for law in laws for number in (law.a, law.b))
    if not given and not any(law.assumed_range for law in laws):
        return None
    return Range(0.5, 0.0, 1.0, laws[0].provenance, given)


def _write_law(ply, value):
    return replace(ply, laws=tuple(law.at(value) for law in _laws_of(ply)))


def _find_failure_length(ply, scatter):
    fabric = ply.fabric
    ratios = assumed.range_of_failure_length(fabric)
    if ratios is None:
        return None
    length = fabric.failure_length
    own = _of_ratios(fabric, "failure_length")
    if own is None:
        source = data_sheet.entries()["failure_length"].source
        return Range(length, ratios[0] * length, ratios[1] * length, source)
    low, high, deviation = (length * number for number in (own.low, own.high, own.deviation))
    return Range(length, low, high, own.source, own.given, deviation)


def _write_failure_length(ply, value):
    return replace(ply, fabric=replace(ply.fabric, failure_length=value))


def _find_strengths(setup, scatter):
    """Of the yarns of a panel about their mean (`strengths`)."""
    if not setup.yarn_failure or scatter.shape == inf:
        return None
    deviation = sqrt(gamma(1 + 2 / scatter.shape) / gamma(1 + 1 / scatter.shape) ** 2 - 1)
    return Range(1.0, 0.0, inf, inputs.table("weibull")["shape"].source, scatter=deviation)


WOVEN = "weaving_damage.strength"
MEASURE_STRENGTH = "test yarns taken from the fabric; give fabric.weaving_damage"

ROWS = (
    Unknown(
        "place along the warp", *_of_place(0), "", ("panel.impact_point",), PLACE,
        "spacings", sobol=0, of_cloth=False, known=True,
    ),
    Unknown(
        "place along the weft", *_of_place(1), "", ("panel.impact_point",), PLACE,
        "spacings", sobol=1, of_cloth=False, known=True,
    ),
    Unknown(
        "roll", *_written(_find_roll, _write_roll), "", ("projectile.roll",), "roll",
        "deg", 180 / pi, sobol=2, of_cloth=False,
    ),
    Unknown(
        "friction between yarns",
        *_of_number(inputs.FRICTION_OF_CROSSOVERS, *_field_of_zone("friction")),
        "measure friction between yarns by a pull-out",
        ("panel.crossover_friction",), sobol=3, known=True,
    ),
    Unknown(
        "friction on the nose",
        *_of_number(data_sheet.FRICTION_OF_PROJECTILE, _read_nose, _write_nose),
        "give projectile.friction", ("projectile.friction",), sobol=4, known=True,
    ),
    Unknown(
        "friction between plies",
        *_of_number(data_sheet.FRICTION_BETWEEN_PLIES, *_field_of_pack("ply_friction")),
        "give panel.ply_friction", ("panel.ply_friction",), sobol=5, known=True,
    ),
    Unknown(
        STRENGTH_OF_YARNS, _find_strengths, None, MEASURE_STRENGTH, (), "strength", of_cloth=False
    ),
    # what crimp follows from stands before crimp and trellis law
    *(
        Unknown(
            name, _in_each_ply(find, None, _has_laws)[0], None, "measure crimp by ISO 7211-3",
            ("warp.crimp", "weft.crimp"), "crimp",
        )
        for name, (find, _) in GEOMETRY.items()
    ),
    Unknown("modulus", *_of_panels("modulus", "modulus"), "", (), panel=0),
    Unknown("crimp of the warp", *_of_panels("crimp_warp", "crimp"), "", (), "crimp", panel=1),
    Unknown("crimp of the weft", *_of_panels("crimp_weft", "crimp"), "", (), "crimp", panel=2),
    Unknown(
        "strength", *_in_each_ply(*_of_yarns("strength", "tenacity", "failure_strain"), _fails_by_laws),
        MEASURE_STRENGTH, tuple(f"{family}.strength" for family in FAMILIES),
    ),
    Unknown(
        "modulus of the file", *_in_each_ply(*_of_yarns("modulus"), _has_laws),
        "test the modulus of yarns", tuple(f"{family}.modulus" for family in FAMILIES), "modulus",
    ),
    Unknown(
        "crimp of the file", *_in_each_ply(*_of_yarns("crimp"), _has_laws),
        "measure crimp by ISO 7211-3", tuple(f"{family}.crimp" for family in FAMILIES), "crimp",
    ),
    Unknown(
        data_sheet.STRENGTH_AFTER_WEAVING,
        *_in_each_ply(*_written(_find_woven, _write_woven), _fails_by_laws),
        MEASURE_STRENGTH, ("fabric.weaving_damage.strength",), "strength",
    ),
    Unknown(
        "failure length",
        *_in_each_ply(*_written(_find_failure_length, _write_failure_length), lambda s: s.yarn_failure),
        "", ("failure_length",), "", "mm", 1e3,
    ),
    Unknown(
        "compression law", *_in_each_ply(*_written(_find_law, _write_law), _has_laws),
        "weavecell calibrate from a measured curve", ("fabric.law.a", "fabric.law.b"),
    ),
    Unknown(
        "trellis law", *_in_each_ply(*_written(_find_trellis, _write_trellis)),
        "weavecell reduce picture-frame", tuple(f"shear.{name}" for name in ("G1", "G2")),
    ),
    Unknown("gap between plies", _find_gap, _put_gap, "give panel.ply_gap", ("panel.ply_gap",), "", "mm", 1e3),
    Unknown(
        "energy given back by plies",
        *_of_number("energy given back by plies", _read_resilience, _write_resilience), "", (),
    ),
    Unknown(
        "area of packed fabric",
        *_of_number("area of packed fabric", *_field_of_pack("packed_area")), "", (),
    ),
    Unknown(
        "lateral stiffness of yarns",
        *_of_number("lateral stiffness of yarns", *_field_of_zone("lateral")), "", (),
    ),
    Unknown(
        "edge of yarns under the nose",
        *_of_number("edge of yarns under the nose", *_field_of_zone("edge")), "", (),
    ),
    Unknown("clamp force", _find_clamp, _put_clamp, "", ("panel.boundary.clamp_force",), "", "N"),
)  # fmt: skip
FRICTIONS = {row.name: row for row in ROWS if row.known and row.of_cloth}
ADVICE = {row.name: row.advice for row in ROWS}  # {what moves an answer: what tells it}


def column_of(name: str) -> str:
    """Return the column of a row's values."""
    return next(row.column for row in ROWS if row.name == name)


def find_drawn(setup: ImpactSetup, scatter: Scatter) -> dict[str, tuple[Unknown, Range]]:
    """Find all that is drawn of a set-up: {name: (row, Range)}."""
    found = {row.name: (row, row.find(setup, scatter)) for row in ROWS}
    return {name: (row, one) for name, (row, one) in found.items() if one is not None}


def draw(
    setup: ImpactSetup, scatter: Scatter, seed: int, number: int, panel: int
) -> tuple[ImpactSetup, dict[str, float]]:
    """Draw all that is not known of a shot but the strengths of single yarns.

    Parameters
    ----------
    number : of the shot; with the seed it determines all that is drawn
    panel : number of what differs from panel to panel

    Returns
    -------
    setup, values : of the shot; {name: drawn [SI], of fabrics of the first ply}
    """
    drawn = find_drawn(setup, scatter)
    shares = {name: row.share(seed, number, panel) for name, (row, _) in drawn.items()}
    values = {name: drawn[name][1].at(share) for name, share in shares.items()}
    values.pop(STRENGTH_OF_YARNS, None)
    return put_all(setup, scatter, shares), values


def put_all(setup: ImpactSetup, scatter: Scatter, shares: Mapping[str, float]) -> ImpactSetup:
    """Return the set-up with the values at shares of their ranges, {name: share}."""
    geometry = {name: share for name, share in shares.items() if name in GEOMETRY}
    if geometry:
        put = _in_each_ply(None, partial(_put_geometry, geometry))[1]
        setup = put(setup, 0.0, scatter)
    for row in ROWS:
        if row.name in shares and row.put is not None:
            setup = row.put(setup, shares[row.name], scatter)
    return setup


def draw_known(setup: ImpactSetup, seed: int, number: int) -> dict[str, float]:
    """Return what is known of a drawn shot, from which its limit is estimated: {word: [-] about 0}.

    The place counts where it goes from gap to crossover, on plain weaves under noses that are round about
    their axis; elsewhere what it does is part of the rest.
    """
    found = {}
    plain = all(fabric.weave.pattern.is_plain for fabric in setup.fabrics)
    if (
        setup.crossovers is not None
        and plain
        and setup.plies == 1
        and setup.projectile.known.turned
    ):
        along, across, *_ = _spread(seed, number)
        found[PLACE] = float(0.5 * (np.cos(pi * along) + np.cos(2 * pi * across)))
    for name, row in FRICTIONS.items():
        of_row = row.find(setup, ALIKE)
        if of_row is not None:
            found[name] = of_row.beside(row.share(seed, number, number))
    return found


def find_unknown(setup: ImpactSetup) -> dict[str, tuple[float, float]]:
    """Find the frictions that are drawn: {name: (low, high)}."""
    found = {name: row.find(setup, ALIKE) for name, row in FRICTIONS.items()}
    return {name: (one.low, one.high) for name, one in found.items() if one is not None}


def choose_nominal(setup: ImpactSetup, placed: bool) -> ImpactSetup:
    """Return the set-up of the one run that stands for all draws: what nobody gave has the value that half
    of the draws lie below, and resolved yarns are struck half-way between gap and crossover, on a yarn,
    where the panel mirrors itself.

    Parameters
    ----------
    placed : whether the input says where it strikes
    """
    for row in FRICTIONS.values():
        found = row.find(setup, ALIKE)
        if found is not None and row.put is not None:
            # it stays one that nobody gave, and is drawn beside this run
            setup = row.put(setup, None, ALIKE)
    if setup.crossovers is None or placed:
        return setup
    return strike_at(setup, ON_WARP)


def say_run(target: Target) -> str:
    """Write what the one run takes of all that nobody gave."""
    parts = []
    if target.setup.crossovers is not None and not target.is_placed:
        parts.append("on a yarn, half-way from gap to crossover")
    for name, row in FRICTIONS.items():
        found = row.find(target.setup, ALIKE)
        if found is not None:
            parts.append(f"{name} {found.value:g}")
    return ", ".join(parts) or "all that matters is given"


def say_drawn(setup: ImpactSetup) -> str:
    """Write what drawn shots draw: place, frictions with their ranges, strength and modulus, and how many
    others."""
    drawn = find_drawn(setup, inputs.read_scatter())
    frictions = {name: one.words() for name, (row, one) in drawn.items() if name in FRICTIONS}
    named = [f"{name} {words}" for name, words in frictions.items()]
    shorts = dict.fromkeys(row.short or name for name, (row, _) in drawn.items())
    others = [one for one in shorts if one not in frictions]
    first = [one for one in others if one in (PLACE, "roll")]
    rest = [one for one in others if one not in first]
    said = [*first, *named, *rest[:2]]
    if len(rest) > 2:
        return f"{', '.join(said)} and {len(rest) - 2} more drawn"
    return f"{', '.join(said)} drawn"


def say(unknown: Mapping[str, tuple[float, float]]) -> str:
    """Write frictions with their ranges; "" of none."""
    return ", ".join(f"{name} {low:g} to {high:g}" for name, (low, high) in unknown.items())


def list_drawn(setup: ImpactSetup, scatter: Scatter) -> list[tuple[str, str, str, str]]:
    """List all that is drawn, for a table: (name, range, "given" or "assumed" and for what, source)."""
    lines = []
    for name, (row, found) in find_drawn(setup, scatter).items():
        by = GIVEN if found.given else ASSUMED
        each = "one for a cloth" if row.of_cloth else "new for each shot"
        lines.append((name, found.words(row.scale, row.unit), f"{by}, {each}", found.source))
    return lines
