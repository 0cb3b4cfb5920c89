"""What nobody knows of a shot, and from what it is drawn: each unknown is one row of `ROWS`.

A row finds the range of its unknown in a set-up, and puts the value at a share of this range into it. What
the user gives without a range has none, and is not drawn; what is given with one is drawn from it; what
nobody gave from the range of its fibre family or of the data files, with their source. Half of the draws lie
below the value of the set-up, half above it: the one run at nominal values stands in their middle.

A share depends on seed, number and the name of the row alone, so that two set-ups share the draws of what
both leave open, and a row more moves no draw of the others. Of one row shares are spread evenly over
numbers from 0 on: points of van der Corput's sequence, shuffled and scrambled as Owen did (1995, Lecture Notes
in Statistics 106, 299) by what seed and name say; place, roll and frictions are points of one Sobol sequence,
shifted by what the seed draws. Modulus and crimp differ from panel to panel, as random numbers do.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from hashlib import blake2b
from math import pi

import numpy as np

from fabrics import data_sheet
from shellfabric.impact.setup import ImpactSetup
from weavecell.studies import inputs
from weavecell.studies import unknown_numbers as ways
from weavecell.studies.inputs import Scatter
from weavecell.studies.places import ON_WARP, strike_at
from weavecell.studies.unknown_numbers import Range, Way

PLACE = "place"  # that is struck
STRENGTH_OF_YARNS = "strength of yarns"  # each of its own, see `strengths`
LAW, LAW_SHAPE = "compression law", "shape of the compression law"
GIVEN, ASSUMED = "given", "assumed"
SPREAD = 6  # rows whose shares are points of one Sobol sequence
LEVELS = 24  # binary digits of a share
ALIKE = Scatter()  # of panels that are all alike


@dataclass(frozen=True)
class Unknown:
    """One row.

    Parameters
    ----------
    name : in words
    way : Way, how it is found in a set-up, and put there
    advice : what tells it
    test, command : that measures it, and what of the command line reduces that; "" of what is only given
    keys : of input or fabric files that give it
    short : what it is called with others that belong to it; "" by its name
    unit, scale : of values in words, and over SI
    sobol : number of its share among those of the Sobol sequence; None of its own sequence
    panel : number of its share among those that are random from panel to panel; None of others
    of_cloth : whether it is one for all shots at one cloth, or new for each
    known : whether limits are estimated from it
    """

    name: str
    way: Way
    advice: str = ""
    keys: tuple[str, ...] = ()
    short: str = ""
    unit: str = ""
    scale: float = 1.0
    sobol: int | None = None
    panel: int | None = None
    of_cloth: bool = True
    known: bool = False
    test: str = ""
    command: str = ""

    @property
    def words(self) -> str:
        """Its name, as the estimate of limits has it."""
        return self.name

    def find(self, setup: ImpactSetup, scatter: Scatter) -> Range | None:
        """Find from what it is drawn; None if it is not."""
        return self.way.find(setup, scatter)

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
    """Return (SPREAD,) of the numbers from 0 on they are spread evenly, each by itself may be
    anywhere."""
    # the first draws of the shift are those of the place
    shift = np.random.default_rng(seed).uniform(size=SPREAD)
    return (_sobol_points(1 + number)[number] + shift) % 1.0


@cache
def _sobol_points(least):
    """Return at least so many points of the sequence."""
    if least & (least - 1):
        return _sobol_points(1 << least.bit_length())
    # takes a quarter of a second to load, which one run at nominal values does not need
    from scipy.stats import qmc

    return qmc.Sobol(SPREAD, scramble=False).random(least)


@cache
def _scrambled(name, seed, number):
    """Return the point of a number of van der Corput's sequence, shuffled and scrambled: each binary
    digit of the number, then of the point, is turned round or not by what the digits above it are.
    Numbers of a block of 2^k are spread evenly, in an order that is another for each name."""

    def turn(digits, what):
        found = ""
        for level, digit in enumerate(digits):
            key = f"{what} {name} {seed} {digits[:level]}"
            turned = blake2b(key.encode(), digest_size=1).digest()[0] & 1
            found += str(int(digit) ^ turned)
        return found

    shuffled = turn(f"{number:0{LEVELS}b}", "order")
    point = turn(shuffled[::-1], "place")
    # in the middle of what this many digits leave open: 0 and 1 are no shares
    return (int(point, 2) + 0.5) / 2**LEVELS


TEST_YARNS = "test yarns taken from the fabric; give fabric.weaving_damage"
MEASURE_CRIMP = "measure crimp by ISO 7211-3; give warp.crimp and weft.crimp"
FIT_LAW = "press plies between platens (`weavecell reduce compression --cell-of FABRIC`)"
FIT_TRELLIS = "test a picture frame (`weavecell fabrics new --picture-frame CURVE`)"
PULL_OUT = "reduce pull-out"
MEASURE_FRICTION = f"measure friction between yarns (`weavecell {PULL_OUT}`)"

ROWS = (
    Unknown("place along the warp", ways.of_place(0), short=PLACE, unit="spacings", sobol=0, of_cloth=False),
    Unknown("place along the weft", ways.of_place(1), short=PLACE, unit="spacings", sobol=1, of_cloth=False),
    Unknown("roll", ways.ROLL, unit="deg", scale=180 / pi, sobol=2, of_cloth=False),
    Unknown(
        "friction between yarns", ways.FRICTION_OF_YARNS, MEASURE_FRICTION,
        ("panel.crossover_friction",), sobol=3, known=True, test="yarn pull-out", command=PULL_OUT,
    ),
    Unknown(
        "friction on the nose", ways.FRICTION_ON_NOSE, "give projectile.friction",
        ("projectile.friction",), sobol=4, known=True, test="sled of the nose's metal",
    ),
    Unknown(
        "friction between plies", ways.FRICTION_OF_PLIES, "give panel.ply_friction",
        ("panel.ply_friction",), sobol=5, known=True, test="sled of fabric on fabric",
    ),
    Unknown(STRENGTH_OF_YARNS, ways.STRENGTHS, TEST_YARNS, short="strength", of_cloth=False),
    # what crimp follows from, before crimp and the trellis law
    *(
        Unknown(name, way, MEASURE_CRIMP, ("thickness", "areal_density"), "crimp")
        for name, way in ways.GEOMETRIES.items()
    ),
    Unknown("modulus", ways.of_panels("modulus", "modulus"), panel=0),
    Unknown("crimp of the warp", ways.of_panels("crimp_warp", "crimp"), short="crimp", panel=1),
    Unknown("crimp of the weft", ways.of_panels("crimp_weft", "crimp"), short="crimp", panel=2),
    Unknown("modulus of the file", ways.MODULUS, keys=("warp.modulus", "weft.modulus"), short="modulus"),
    Unknown("crimp of the file", ways.CRIMP, MEASURE_CRIMP, ("warp.crimp", "weft.crimp"), "crimp"),
    Unknown("strength of the file", ways.STRENGTH, TEST_YARNS, ("warp.strength", "weft.strength"), "strength"),
    Unknown(
        data_sheet.STRENGTH_AFTER_WEAVING, ways.AFTER_WEAVING, TEST_YARNS,
        ("fabric.weaving_damage.strength",), "strength",
    ),
    Unknown("failure length", ways.FAILURE_LENGTH, keys=("failure_length",), unit="mm", scale=1e3),
    Unknown(LAW, ways.LAW, FIT_LAW, ("fabric.law.a", "fabric.law.b")),
    Unknown(LAW_SHAPE, ways.LAW_SHAPE, FIT_LAW, short=LAW),
    Unknown("trellis law", ways.TRELLIS, FIT_TRELLIS, ("shear.G1", "shear.G2")),
    Unknown("gap between plies", ways.GAP, "give panel.ply_gap", ("panel.ply_gap",), unit="mm", scale=1e3),
    Unknown("energy given back by plies", ways.RESILIENCE),
    Unknown("area of packed fabric", ways.PACKED_AREA),
    Unknown("lateral stiffness of yarns", ways.LATERAL),
    Unknown("edge of yarns under the nose", ways.EDGE),
    Unknown("clamp force", ways.CLAMPS, keys=("panel.boundary.clamp_force",), unit="N"),
)  # fmt: skip
FRICTIONS = {row.name: row for row in ROWS if row.known}
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
    geometry = {name: share for name, share in shares.items() if name in ways.GEOMETRY}
    if len(geometry) > 1:
        # each by itself would begin with the thickness of the file again
        setup = ways.put_geometry(setup, geometry, scatter)
    together = set(geometry) if len(geometry) > 1 else set()
    if LAW_SHAPE in shares:
        setup = ways.put_law(setup, shares.get(LAW, 0.5), shares[LAW_SHAPE], scatter)
        together |= {LAW, LAW_SHAPE}
    for row in ROWS:
        if row.name in shares and row.name not in together:
            setup = row.way.put(setup, shares[row.name], scatter)
    return setup


def put_place(setup: ImpactSetup, seed: int, number: int) -> ImpactSetup:
    """Return the set-up with the place, the roll and the lie of the plies of a shot."""
    rows = [row for row in ROWS if not row.of_cloth and row.sobol is not None]
    drawn = [row for row in rows if row.find(setup, ALIKE) is not None]
    placed = put_all(setup, ALIKE, {row.name: row.share(seed, number, number) for row in drawn})
    if placed.crossovers is None:
        return placed
    return replace(placed, crossovers=replace(placed.crossovers, seed=(seed, number)))


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
        if row.find(setup, ALIKE) is not None:
            # it stays one that nobody gave, and is drawn beside this run
            setup = row.way.put(setup, None, ALIKE)
    if setup.crossovers is None or placed:
        return setup
    return strike_at(setup, ON_WARP)


def say_run(setup: ImpactSetup, placed: bool) -> str:
    """Write what the one run takes of all that nobody gave; `placed` as of `choose_nominal`."""
    parts = []
    if setup.crossovers is not None and not placed:
        parts.append("on a yarn, half-way from gap to crossover")
    for name, row in FRICTIONS.items():
        found = row.find(setup, ALIKE)
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
