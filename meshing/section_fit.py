"""Sections for warp and weft that just touch: the overlap of the two yarns measured, removed, reported.

Warp lies over weft. With sections q_i and heights h_i of the centrelines the gap between the yarns,

    g(x, y) = [h_1 cos(pi x / 2 w_1) - q_2(x)] + [h_2 cos(pi y / 2 w_2) - q_1(y)],

is a function of x and one of y, so that its least value is the sum of two one-dimensional minima,
the *clearances*. The overlap is minus that sum. "conforming" sections (`meshing.conforming`) have
no gap and no overlap anywhere; their areas are what the crimp leaves room for.

These are the smooth surfaces: the facets of a mesh still overlap by their sag, of second order.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import ceil, pi

import numpy as np
from scipy.optimize import bisect, brentq, minimize_scalar

from fabrics.base.errors import InputError
from fabrics.data_sheet import crimps
from fabrics.fabric import SECTIONS
from fabrics.weave import Weave, arc_length
from fabrics.yarn import CLOSEST_PACKING
from meshing.conforming import KIND as CONFORMING
from meshing.conforming import YarnSection, conform
from meshing.section import Section

# of h_1 + h_2: keeps the end levels of the yarns, which symmetry wants equal, equal in all but name
SHIFT_LIMIT = 0.02
# of the width requested: the search for the best width ends here
NARROWEST = 0.4
# times the heights of the yarns: the search for the least crimp ends here
HIGHEST = 8.0
FACTOR = 1e-3  # to which a factor on crimp or thickness is found
SAMPLES = 4000
YARNS = ("warp", "weft")


def clearance(section: YarnSection, w: float, h: float) -> float:
    """Compute the least of h cos(pi s / 2 w) - q(s) over the section: its room [m] under the arch
    of the yarn that crosses it.

    Sampled at intervals of width / 8000: right to 1e-11 m in a yarn 1 mm wide.

    Parameters
    ----------
    section : Section of one yarn, at most 2 w wide
    w, h : [m] half cell length and height of the other yarn
    """
    s = section.stations(SAMPLES)
    return float(np.min(h * np.cos(pi * s / (2 * w)) - section.half_thickness(s)))


@dataclass(frozen=True)
class SectionFit:
    """The two sections, the shift that closes them, and what had to be changed.

    Parameters
    ----------
    sections : (Section, Section) of warp and weft
    overlap : [m] of the sections as requested; negative where they had a gap everywhere
    shift : [m] of warp against weft in z, positive apart; warp and weft move by half of it each; 0
        if not allowed
    Vf0 : (warp, weft) [-] fibre volume fractions of the mesh
    requested : (Section, Section) before anything was narrowed or densified
    """

    sections: tuple[YarnSection, YarnSection]
    overlap: float
    shift: float
    Vf0: tuple[float, float]
    requested: tuple[YarnSection, YarnSection]

    @property
    def changed(self) -> bool:
        """True if a section differs from the one requested."""
        return self.sections != self.requested

    @property
    def report(self) -> str:
        """One line for the user."""
        Vf0 = _listed(self.Vf0)
        if self.sections[0].kind == CONFORMING:
            return f"conforming sections that touch everywhere (Vf0 {Vf0})"
        what = "overlap"
        if self.overlap < 0:
            what = "gap"
        text = f"{what} of the sections {abs(self.overlap) * 1e6:.2f} um"
        if self.changed:
            pairs = list(zip(self.sections, self.requested))
            width = _listed(s.width / a.width for s, a in pairs)
            area = _listed(s.area / a.area for s, a in pairs)
            return f"{text}, solved: widths times {width}, areas times {area} (Vf0 {Vf0})"
        if self.shift:
            return f"{text}, closed by a shift of {self.shift * 1e6:+.2f} um"
        return f"{text}, left open"


def _listed(values):
    return " / ".join(map("{:.3f}".format, values))


class _TooDense(InputError):
    """Sections that do not fit even at the closest packing of the fibres."""


def fit_sections(
    kind: str | None,
    widths: Sequence[float],
    fractions: Sequence[float],
    weave: Weave,
    tip_thickness_ratio: float,
    *,
    prescribed: bool = False,
    overlap: str = "solve",
    shift: bool = True,
) -> SectionFit:
    """Find sections of the two yarns that touch without overlapping.

    The overlap is removed by the first of these that suffices:

    1. shift      the yarns are moved apart in z as rigid bodies, by at most 2 % of h_1 + h_2;
    2. narrow     sections of the same area are made narrower (not if the widths are prescribed);
    3. densify    the areas are reduced by one factor: the crossing yarn limits the yarn area, as in
                  thesis section A.2, and Vf0 = A_s / A_yarn rises, at most to the closest packing.

    After 2 or 3 no shift is left. A gap that is positive everywhere is closed by a shift, which is
    negative. Without `shift`, as in a woven patch, it stays open.

    Parameters
    ----------
    kind : "sine", "ellipse" or "conforming"; None for the first of these that fits
    widths : (warp, weft) [m] requested
    fractions : (warp, weft) [-] fibre volume fractions requested
    weave : Weave
    tip_thickness_ratio : [-] of both sections
    prescribed : the widths may not be narrowed
    overlap : "solve", or "refuse" to change any section (a shift within its limit is still made)
    shift : the yarns may be moved apart

    Raises
    ------
    InputError : the overlap is larger than a shift may remove and is refused, or cannot be removed
    """
    refused = overlap == "refuse"
    kinds: tuple[str, ...] = SECTIONS
    if kind:
        kinds = (kind,)
    elif refused:
        kinds = SECTIONS[:1]
    request = _Request(widths, fractions, tip_thickness_ratio, prescribed, refused, shift)
    try:
        return request.first_that_fits(kinds, weave)
    except _TooDense as problem:
        line = str(problem)
        if not prescribed:
            line = f"{problem}: {_advice(request, kinds, weave)}"
        raise InputError(line) from None


def leaves_room(
    kind: str | None,
    widths: Sequence[float],
    fractions: Sequence[float],
    weave: Weave,
    tip_thickness_ratio: float,
) -> bool:
    """Say whether `fit_sections` finds sections, without prescribed widths and with a shift.

    It takes a small part of the time: neither the least change nor advice is searched for.
    """
    kinds: tuple[str, ...] = SECTIONS
    if kind:
        kinds = (kind,)
    request = _Request(widths, fractions, tip_thickness_ratio, False, False, True)
    return request.has_room(kinds, weave)


@dataclass(frozen=True)
class _Request:
    """What is asked of the sections of any kind, as in `fit_sections`; refused: an overlap is."""

    widths: Sequence[float]
    fractions: Sequence[float]
    tip_thickness_ratio: float
    prescribed: bool
    refused: bool
    shift: bool

    def first_that_fits(self, kinds, weave):
        """The SectionFit of the first kind of section that fits."""
        if len(kinds) == 1:
            return self.fit(kinds[0], weave)
        for kind in kinds:
            try:
                return self.fit(kind, weave)
            except InputError as problem:
                if self.prescribed and kind == kinds[-1]:
                    raise _TooDense(f"{problem}: try other widths") from None
        raise _TooDense(
            f"neither {', '.join(kinds[:-1])} nor {kinds[-1]} sections of warp and weft fit, "
            f"even at the closest packing of the fibres (Vf0 = {CLOSEST_PACKING:.3f})"
        )

    def has_room(self, kinds, weave):
        """Whether one of the kinds of section fits."""
        for kind in kinds:
            with suppress(InputError):
                if self._has_room(kind, weave):
                    return True
        return False

    def _has_room(self, kind, weave):
        """Whether one kind of section fits as requested, or at the closest packing of the fibres."""
        if kind == CONFORMING:
            self._conforming(weave)
            return True
        requested, crossing = self._requested(kind, weave)
        if _overlap(requested, crossing) <= self._free(weave):
            return True
        if self.refused:
            return False
        densest = _densified(
            requested, crossing, self.fractions, self.prescribed, _highest(self.fractions)
        )
        return _overlap(densest, crossing) <= 0

    def _requested(self, kind, weave):
        """The sections as they are requested, and of each yarn the arch over it."""
        areas = _areas(weave, self.fractions)
        crossing = list(zip(weave.w, weave.h0))[::-1]
        return _sections(kind, self.widths, areas, self.tip_thickness_ratio), crossing

    def _free(self, weave):
        """The overlap [m] that a shift may remove."""
        if self.shift:
            return sum(weave.h0) * SHIFT_LIMIT
        return 0.0

    def fit(self, kind, weave):
        """The SectionFit of one kind of section."""
        if kind == CONFORMING:
            return self._conforming(weave)
        requested, crossing = self._requested(kind, weave)
        first = _overlap(requested, crossing)
        free = self._free(weave)
        sections = requested
        Vf0 = tuple(map(float, self.fractions))
        if first > free:
            if self.refused:
                raise InputError(self._too_much(kind, first, free))
            sections = None
            if not self.prescribed:
                sections = _narrow(requested, crossing)
            if sections is None:
                sections, factor = _densify(requested, crossing, self.fractions, self.prescribed)
                Vf0 = _denser(self.fractions, factor)
        shift = _overlap(sections, crossing) if self.shift else 0.0
        return SectionFit(sections, first, shift, Vf0, requested)

    def _too_much(self, kind, overlap, free):
        limit = ""
        if self.shift:
            limit = f", more than the {free * 1e6:.1f} um that a shift may remove"
        return (
            f"the {kind} sections of warp and weft overlap by {overlap * 1e6:.1f} um{limit}: "
            "narrow them, or let the overlap be solved"
        )

    def _conforming(self, weave):
        areas = _areas(weave, self.fractions)
        sections = conform(self.widths, areas, weave, self.tip_thickness_ratio)
        Vf0 = tuple(
            float(old * area / section.area)
            for old, area, section in zip(self.fractions, areas, sections)
        )
        if max(Vf0) > CLOSEST_PACKING:
            raise _TooDense(
                f"conforming sections leave room for fibre fractions of {Vf0[0]:.3f} and "
                f"{Vf0[1]:.3f}, denser than the closest packing ({CLOSEST_PACKING:.3f})"
            )
        return SectionFit(sections, 0.0, 0.0, Vf0, sections)


def _advice(request, kinds, weave):
    """What to change where no section fits: the least crimp of the same ratio of heights, and the
    least thickness."""

    def scaled(factor):
        return [float(arc_length(w, factor * h)) / (2 * w) - 1 for w, h in zip(weave.w, weave.h0)]

    def of_thickness(factor):
        return crimps(weave.w, factor * weave.thickness)

    same, computed = (
        _least(request, kinds, weave, crimp_at) for crimp_at in (scaled, of_thickness)
    )
    if same is None or computed is None:
        return "no crimp of this ratio leaves room: check linear density, fibre_density and counts"
    wanted = " and ".join(
        f'crimp = "{ceil(1e4 * yarn.crimp) / 100:.2f} %" under [{name}]'
        for name, yarn in zip(YARNS, same.yarns)
    )
    return (
        f"the crimp leaves a thickness of {1e3 * weave.thickness:.3f} mm, too little for these yarns; the least that "
        f'can be meshed is {wanted}, or thickness = "{ceil(1e6 * computed.thickness) / 1e3:.3f} mm" without crimp'
    )


def _least(request, kinds, weave, crimp_at):
    """The Weave of the least factor from which `crimp_at` makes crimps that fit; None where there
    is none."""

    def at(factor):
        warp, weft = (
            replace(yarn, crimp=crimp) for yarn, crimp in zip(weave.yarns, crimp_at(factor))
        )
        return replace(weave, warp=warp, weft=weft)

    def fits(factor):
        try:
            made = at(factor)
        except InputError:
            return False
        return request.has_room(kinds, made)

    low = 0.5
    high = 1.0
    while not fits(high):
        low = high
        high *= 1.25
        if high > HIGHEST:
            return None
    return at(least_that_fits(fits, low, high) + FACTOR)


def least_that_fits(fits: Callable[[float], bool], low: float, high: float) -> float:
    """Find the least factor between `low`, which does not fit, and `high`, which does, to within
    `FACTOR` above it."""
    found = bisect(lambda factor: fits(factor) - 0.5, low, high, xtol=0.5 * FACTOR)
    return float(found) + 0.5 * FACTOR


def _areas(weave, fractions):
    """Areas of the vertical sections, A_s (1 + crimp) / Vf0, with which the yarn volume is A_s S0 /
    Vf0."""
    return [yarn.A_s * (1 + yarn.crimp) / Vf0 for yarn, Vf0 in zip(weave.yarns, fractions)]


def _sections(kind, widths, areas, tip_thickness_ratio):
    return tuple(
        Section.of_area(kind, width, area, tip_thickness_ratio)
        for width, area in zip(widths, areas)
    )


def _overlap(sections, crossing):
    return -sum(clearance(section, *arch) for section, arch in zip(sections, crossing))


def _resized(section, width, area=None):
    return Section.of_area(
        section.kind, width, section.area if area is None else area, section.tip_thickness_ratio
    )


def _best(section, arch):
    """The section of the same area, not wider, whose clearance under the arch (w, h) is largest.

    The centre loses clearance as a section gets narrower and thicker, its shoulders gain it: one
    maximum.
    """
    found = minimize_scalar(
        lambda width: -clearance(_resized(section, width), *arch),
        bounds=(NARROWEST * section.width, section.width),
        method="bounded",
        options={"xatol": 1e-5 * section.width},
    )
    best = _resized(section, found.x)
    return best if clearance(best, *arch) > clearance(section, *arch) else section


def _narrow(requested, crossing):
    """The requested areas, narrowed towards the best widths until nothing overlaps; None if the
    best still overlap."""
    best = [_best(section, arch) for section, arch in zip(requested, crossing)]

    def at(part):
        return tuple(
            _resized(s, s.width + part * (b.width - s.width)) for s, b in zip(requested, best)
        )

    if _overlap(at(1.0), crossing) > 0:
        return None
    return at(brentq(lambda part: _overlap(at(part), crossing), 0.0, 1.0, xtol=1e-12))


def _denser(fractions, factor):
    return tuple(max(Vf0, min(Vf0 * factor, CLOSEST_PACKING)) for Vf0 in map(float, fractions))


def _highest(fractions):
    """The factor on the fibre fractions from which on both are at the closest packing."""
    return max(1.0, CLOSEST_PACKING / min(fractions))


def _densified(requested, crossing, fractions, prescribed, factor):
    """The sections of fibre fractions that are `factor` higher, with the best widths if none is prescribed."""
    sections = tuple(
        _resized(s, s.width, s.area * old / new)
        for s, old, new in zip(requested, fractions, _denser(fractions, factor))
    )
    if prescribed:
        return sections
    return tuple(map(_best, sections, crossing))


def _densify(requested, crossing, fractions, prescribed):
    """Sections, and the least common factor on the fibre fractions, that leave no overlap.

    Raises
    ------
    InputError : the sections overlap even at the closest packing
    """

    def at(factor):
        return _densified(requested, crossing, fractions, prescribed, factor)

    highest = _highest(fractions)
    left = _overlap(at(highest), crossing)
    if left > 0:
        raise _TooDense(
            f"the {requested[0].kind} sections of warp and weft overlap by {left * 1e6:.1f} um even at the closest "
            f"packing of the fibres (Vf0 = {CLOSEST_PACKING:.3f})"
            + (": try other widths or another section" if prescribed else "")
        )
    factor = brentq(lambda factor: _overlap(at(factor), crossing), 1.0, highest, xtol=1e-9)
    return at(factor), factor
