"""How the range of a number that is not known is found in a set-up, and a value of it put there: a `Way` for each row
of `unknown.ROWS`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from math import exp, gamma, inf, log, pi, remainder, sqrt
from typing import Any, NamedTuple

import numpy as np

from fabrics import assumed, data_sheet
from fabrics.base.assumed_number import Assumed, is_assumed
from fabrics.base.errors import InputError
from fabrics.base.range_texts import CUT_OFF
from fabrics.fabric import Fabric
from fabrics.fabric_tables import FAMILIES
from fabrics.families import Entry, entries
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.membrane.boundary import Grip
from shellfabric.plies.gap import gap_between
from shellfabric.plies.numerics import PlyContact
from weavecell.studies import inputs
from weavecell.studies.inputs import Scatter, scale_setup

# [spacings] along warp and weft from a crossover: every other place of a plain weave is the image of
# one in here, by the middle lines of the yarns and by a step along both families
PLACES = 0.5, 1.0
WOVEN = "weaving_damage.strength"  # key of what is left of the strength


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


class Way(NamedTuple):
    """How a number is found and put, of a set-up or of a ply.

    Parameters
    ----------
    find : returns its Range, by the scatter of panels; None of one that is given, or that is not there
    put : returns the set-up with the value at a share of this range; without a share with the value itself,
        which keeps its range
    """

    find: Find
    put: Put


def written(find: Find, write: Callable[[Any, float], Any]) -> Way:
    """Return the Way of what write(part, value) puts into a set-up or a ply."""

    def put(part: Any, share: float | None, scatter: Scatter) -> Any:
        found = find(part, scatter)
        if found is None:
            return part
        return write(part, found.number if share is None else found.at(share))

    return Way(find, put)


def in_each_ply(way: Way, when: Callable[[ImpactSetup], bool] = lambda setup: True) -> Way:
    """Return the Way of what each ply has by itself, all at the same share of their own ranges; the first that
    has one stands for all. when(setup) tells whether it counts at all."""

    def find(setup: ImpactSetup, scatter: Scatter) -> Range | None:
        found = (way.find(ply, scatter) for ply in (setup, *setup.lay_up) if when(setup))
        return next(filter(None, found), None)

    def put(setup: ImpactSetup, share: float | None, scatter: Scatter) -> ImpactSetup:
        plies = tuple(way.put(ply, share, scatter) for ply in setup.lay_up)
        return way.put(replace(setup, lay_up=plies), share, scatter)

    return Way(find, put)


def _range_of(number, source="the input"):
    """Return the Range of a number that says it itself."""
    return Range(float(number), *number.span, source, number.given, number.deviation)


def _of_entry(entry: Entry) -> Range:
    return Range(entry.value, entry.low, entry.high, entry.source)


def _of_ratios(fabric: Fabric, key: str) -> Range | None:
    """Return the range of a number of a fabric file over its value; None without one."""
    low, high = fabric.ranges.get(key, (1.0, 1.0))
    if not low < high:
        return None
    source = fabric.sources.get(key, {}).get("source", "")
    given = key not in fabric.guessed and key.partition(".")[0] not in fabric.assumed
    return Range(1.0, low, high, source, given, dict(fabric.deviations).get(key, 0.0))


def _of_number(entry, read, write):
    """Return the Way of a number that says itself whether it is known: read(setup), None where
    there is none; entry(*fabrics) is the Entry that stands in for it."""

    def find(setup, scatter):
        number = read(setup)
        if not is_assumed(number):
            return None
        if number.given:
            return _range_of(number)
        usual = entry(*setup.fabrics)
        if number.low < number.high:
            return _range_of(number, usual.source)
        # one that says nothing of its range
        return _of_entry(usual) if usual.low < usual.high else None

    return written(find, write)


def _of_shots(name):
    return lambda *fabrics: assumed.shot_entries(*fabrics)[name]


def _of_sheets(key):
    return lambda *fabrics: data_sheet.entries()[key]


def _of_zones(key):
    """Return the entry of a key of resolved yarns, as a function: their model takes a while to load."""

    def entry(*fabrics):
        from shellfabric.yarns.model import DATA

        return entries(DATA)[key]

    return entry


def _field_of_zone(field):
    """Return (read, write) of a number of resolved yarns."""

    def read(setup):
        return setup.crossovers and getattr(setup.crossovers, field)

    def write(setup, value):
        return replace(setup, crossovers=replace(setup.crossovers, **{field: value}))

    return read, write


def _field_of_pack(field):
    """Return (read, write) of a number of packs."""

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


def of_place(axis: int) -> Way:
    """Return the Way of the place that is struck, in spacings from the crossover that is nearest to
    the impact point. One ply of pinned yarns keeps its planes of symmetry."""

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

    return written(find, write)


def _find_roll(setup, scatter):
    """Return the range of a roll beyond the nose's own: a half turn, after which a chisel is the
    same; a full one for a body of an STL file."""
    nose = setup.projectile
    if nose.known.turned or of_place(0).find(setup, scatter) is None:
        return None
    turn = 2 * pi if nose.known.from_file else pi
    return Range(0.5 * turn, 0.0, turn, "any: nobody holds the roll of a fragment")


def _write_roll(setup, value):
    roll = remainder(setup.projectile.roll + value, 2 * pi)
    return replace(setup, projectile=replace(setup.projectile, roll=roll))


def _ranged_clamps(edge):
    """Return the friction clamps with a range of an edge in any of its forms."""
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
    """Return the Range, or None of what is given, of the gap behind each ply but the last."""
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
    """Return the range of the strength that weaving leaves: yarns are tested before it, so that it is
    assumed, unless it is given."""
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
    """Return the Way of numbers of [warp] and [weft] that a fabric file has with a range, as
    factors."""

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

    return Way(find, put)


def of_panels(factor: str, spread: str) -> Way:
    """Return the Way of a factor of `inputs.scale_fabric` that differs from panel to panel, where
    no fabric file has a range of it."""

    def find(setup, scatter):
        share = getattr(scatter, spread)
        stated = in_each_ply(_of_yarns(spread)).find(setup, scatter)
        if not share or stated is not None:
            return None
        source = inputs.table("spread")[spread].source
        return Range(1.0, 1 - CUT_OFF * share, 1 + CUT_OFF * share, source, scatter=share)

    return written(find, lambda setup, value: scale_setup(setup, **{factor: value}))


def _of_geometry(entry, field):
    """Return the Way of what crimp is computed from where the fabric file does not give it: a
    number of `data_sheet.toml` and keyword of `assumed.of_thickness`, which takes all of them at
    once."""

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

    # one alone; `put_geometry` puts several
    return written(find, lambda ply, value: _with_geometry(ply, {field: value}))


def _with_geometry(ply, numbers):
    """Return a ply whose crimp follows from {keyword of `assumed.of_thickness`: value}."""
    return replace(ply, fabric=assumed.of_thickness(ply.fabric, **numbers)) if numbers else ply


GEOMETRY = {  # {name: (its Way in a ply, keyword of `assumed.of_thickness`)}
    "thickness": (_of_geometry("thickness", "factor"), "factor"),
    "areal density": (_of_geometry("areal_density", "mass"), "mass"),
    "share of the warp in the thickness": (_of_geometry("warp_share", "share"), "share"),
    "length of changes of sides": (
        _of_geometry("straight_floats", "straight_floats"),
        "straight_floats",
    ),
}


def put_geometry(setup: ImpactSetup, shares: Mapping[str, float], scatter: Scatter) -> ImpactSetup:
    """Return the set-up whose crimp follows from all that is drawn of GEOMETRY at once: {name: share}."""

    def put(ply: Any, share: float | None, scatter: Scatter) -> Any:
        numbers = {}
        for name, share_of in shares.items():
            way, field = GEOMETRY[name]
            found = way.find(ply, scatter)
            if found is not None:
                numbers[field] = found.at(share_of)
        return _with_geometry(ply, numbers)

    return in_each_ply(Way(lambda ply, scatter: None, put)).put(setup, None, scatter)


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
    return _sample_laws(ply, value, 0.5)


def _find_law_shape(ply, scatter):
    """Return the range of a against b at one compression, of laws whose a and b are drawn together."""
    laws = [law for law in _laws_of(ply) if law.spread is not None]
    return Range(0.5, 0.0, 1.0, laws[0].provenance) if laws else None


def _write_law_shape(ply, value):
    return _sample_laws(ply, 0.5, value)


def _sample_laws(ply, share, shape):
    """Return a ply with its laws at shares of their range: a and b together where they have a joint one."""
    laws = tuple(
        law.at(share) if law.spread is None else law.sample((share, shape)) for law in _laws_of(ply)
    )
    return replace(ply, laws=laws)


def put_law(setup: ImpactSetup, share: float, shape: float, scatter: Scatter) -> ImpactSetup:
    """Put both shares of the range of the compression law: one after the other would begin with another law."""
    joint = written(_find_law, lambda ply, value: _sample_laws(ply, share, shape))
    return in_each_ply(joint, _has_laws).put(setup, share, scatter)


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
    """Return the range of the strengths of a panel's yarns over their mean (`strengths`)."""
    # that of the first ply stands for all
    shape = setup.fabrics[0].weibull_shape if scatter.shape is None else scatter.shape
    if not setup.yarn_failure or shape == inf:
        return None
    deviation = sqrt(gamma(1 + 2 / shape) / gamma(1 + 1 / shape) ** 2 - 1)
    return Range(1.0, 0.0, inf, data_sheet.entries()["weibull_shape"].source, scatter=deviation)


FRICTION_OF_YARNS = _of_number(assumed.friction_between_yarns, *_field_of_zone("friction"))
FRICTION_ON_NOSE = _of_number(_of_shots(data_sheet.FRICTION_OF_PROJECTILE), _read_nose, _write_nose)
FRICTION_OF_PLIES = _of_number(
    _of_shots(data_sheet.FRICTION_BETWEEN_PLIES), *_field_of_pack("ply_friction")
)
LATERAL = _of_number(_of_zones("lateral_stiffness"), *_field_of_zone("lateral"))
EDGE = _of_number(_of_zones("edge"), *_field_of_zone("edge"))
PACKED_AREA = _of_number(_of_sheets("packed_area"), *_field_of_pack("packed_area"))
RESILIENCE = _of_number(_of_sheets("ply_resilience"), _read_resilience, _write_resilience)
ROLL = written(_find_roll, _write_roll)
CLAMPS = Way(_find_clamp, _put_clamp)
GAP = Way(_find_gap, _put_gap)
STRENGTHS = Way(_find_strengths, lambda setup, share, scatter: setup)  # `strengths` draws them
STRENGTH = in_each_ply(_of_yarns("strength", "tenacity", "failure_strain"), _fails_by_laws)
MODULUS = in_each_ply(_of_yarns("modulus"), _has_laws)
CRIMP = in_each_ply(_of_yarns("crimp"), _has_laws)
AFTER_WEAVING = in_each_ply(written(_find_woven, _write_woven), _fails_by_laws)
FAILURE_LENGTH = in_each_ply(
    written(_find_failure_length, _write_failure_length), lambda setup: setup.yarn_failure
)
LAW = in_each_ply(written(_find_law, _write_law), _has_laws)
LAW_SHAPE = in_each_ply(written(_find_law_shape, _write_law_shape), _has_laws)
TRELLIS = in_each_ply(written(_find_trellis, _write_trellis))
GEOMETRIES = {name: in_each_ply(way, _has_laws) for name, (way, _) in GEOMETRY.items()}
