"""Yarn pull-out coupon: one yarn drawn out of crossovers that are held, while the yarns that it
crosses are in tension; quasi-static (docs/theory-panel.md, "Yarn pull-out"). From the stretch behind
a crossover follows the stretch ahead of it, and so on up to the crosshead. What that has drawn out is
what the pieces hold less than at first, and what has come from the tail.

1. The front of slip runs from the crosshead to the tail. Behind it the yarn is slack and lies still.
2. All crossovers slide, and the tail moves on.
3. The tail leaves one crossover after the other.

The contact force of the cell is that of flexible yarns: one without tension does not press back. With
mu alone there is then no load; the cohesion is what it begins with. Yarns that resist bending press
back (`contact_force`).
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any

import numpy as np

from fabrics.assumed import friction_between_yarns
from fabrics.base.assumed_number import Assumed
from fabrics.base.checks import FloatArray, IntArray, refuse
from fabrics.base.errors import InputError
from shellfabric.cell.model import CellTable
from shellfabric.coupon import contact_force

TAIL = 0.5  # of a spacing: yarn beyond the last crossover
BISECTIONS = 50  # 1e-15 of the table's range
# [-] of the strength: a lower tension is rounding of the stretch at which the yarns come apart
ROUNDING = 1e-9
# tensions at the front of slip between two crossovers, of which samples are interpolated
FRONTS = 17


@dataclass(frozen=True)
class PullOut:
    """A yarn of the warp drawn out of held crossovers.

    Parameters
    ----------
    table : CellTable of the fabric, variational
    crossings : crossovers that the yarn is drawn through
    pre_tension : [N] of each crossing yarn, before the yarn is drawn
    mu : [-] coefficient of friction of yarn on yarn; None takes that which is assumed of the fabric
    cohesion : [N] c0, friction of a crossover without contact force
    bending : (warp, weft) [N m2] bending stiffness of the yarns, for the contact force; 0 of
        flexible yarns

    Raises
    ------
    InputError : a value out of its range, another form of the cell, a pre-tension beyond the
        strength of the crossing yarns, or a law or crimp with which the yarn is nowhere slack
    """

    table: CellTable
    crossings: int = 20
    pre_tension: float = 0.0
    mu: float | None = None
    cohesion: float = 0.0
    bending: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self):
        if self.table.model.cell_formulation != "variational":
            allowed = "variational in a pull-out"
            raise InputError(
                key="cell_formulation", value=self.table.model.cell_formulation, allowed=allowed
            )
        self._check_friction()
        if not min(self.bending) >= 0:
            refuse(self, "bending", "at least 0")
        if not 0 <= self.pre_tension < self.table.model.fabric.weave.weft.strength:
            allowed = "at least 0 and below the strength of the crossing yarns"
            refuse(self, "pre_tension", allowed)
        if self.tensions.min() > 0:
            self._refuse_tension()

    def _check_friction(self):
        """Refuse friction, cohesion or crossings out of their range."""
        numbers = {"crossover_friction": self.friction, "crossover_cohesion": self.cohesion}
        for key, value in numbers.items():
            if not 0 <= value < inf:
                raise InputError(key=key, value=value, allowed="at least 0")
        if self.crossings < 1:
            refuse(self, "crossings", "at least 1")

    def _refuse_tension(self):
        """Refuse a yarn that is nowhere slack, by what keeps it in tension."""
        model = self.table.model
        if any(law.form == "printed" for law in model.used_laws):
            allowed = "regularised in a pull-out: by the printed form its yarn is nowhere slack"
            raise InputError(key="law", allowed=allowed)
        allowed = "lower in a pull-out: the yarn is in tension even where the yarns that it crosses lie side by side"
        raise InputError(key="warp.crimp", value=model.fabric.weave.warp.crimp, allowed=allowed)

    @cached_property
    def friction(self) -> float:
        """[-] of yarn on yarn: the given one, or that which is assumed of the fabric."""
        if self.mu is not None:
            return self.mu
        return self.assumed_friction

    @property
    def assumed_friction(self) -> Assumed:
        """[-] of yarn on yarn, with its range, of the fibre family of the fabric."""
        return friction_between_yarns(self.table.model.fabric).number

    @property
    def spacing(self) -> float:
        """[m] of the crossovers."""
        return 2 * self.table.model.fabric.weave.w1

    @cached_property
    def crossing_stretch(self) -> float:
        """[-] stretch at which the crossing yarns have the pre-tension, while the drawn yarn has
        none."""
        if self.pre_tension == 0:
            return 1.0
        stretch = self.table.stretch2
        tension = contact_force.crossing_tension(self.table, self.bending)
        loaded = (stretch >= 1) & (np.gradient(tension) > 0)
        return float(np.interp(self.pre_tension, tension[loaded], stretch[loaded]))

    def _along_yarn(self, values):
        """(n1,) values of the table at the stretch of the crossing yarns."""
        return np.array([np.interp(self.crossing_stretch, self.table.stretch2, v) for v in values])

    @cached_property
    def tensions(self) -> FloatArray:
        """(n1,) [N] axial force of the yarn at the stretches of the table."""
        found = self._along_yarn(self.table.values["T1"])
        least = ROUNDING * self.table.model.fabric.weave.warp.strength
        return np.where(found < least, 0.0, found)

    @cached_property
    def contact_forces(self) -> FloatArray:
        """(n1,) [N] contact force of a crossover at the stretches of the table."""
        return self._along_yarn(contact_force.stiff_table(self.table, self.bending))

    @cached_property
    def thresholds(self) -> FloatArray:
        """(n1,) [N] friction of a crossover at the stretches of the table."""
        return self.cohesion + self.friction * self.contact_forces

    def changed(self, **fields: Any) -> PullOut:
        """Return the pull-out with other crossings, mu or cohesion; what does not depend on these is
        not computed again."""
        other = copy(self)
        for name in ("friction", "thresholds", "peak"):
            vars(other).pop(name, None)
        vars(other).update(fields)
        other._check_friction()
        return other

    @cached_property
    def peak(self) -> float:
        """[N] highest load: all crossovers slide, and the tail begins to move.

        Raises
        ------
        InputError : more crossovers than the yarn can be drawn through
        """
        at_tail = self.stretch_ahead(np.full(1, self.slack), at_tail=True)
        return float(self.tension(self.stretches(at_tail)[0, -1]))

    @property
    def slack(self) -> float:
        """[-] largest stretch of the table at which the yarn has no tension."""
        return float(self.table.stretch1[np.flatnonzero(self.tensions <= 0)[-1]])

    def tension(self, stretch: FloatArray) -> FloatArray:
        """Interpolate the axial force [N] of the yarn."""
        return np.interp(stretch, self.table.stretch1, self.tensions)

    def stretch_ahead(self, behind: FloatArray, *, at_tail: bool = False) -> FloatArray:
        """Stretch ahead of a crossover that the yarn slides through.

        Parameters
        ----------
        behind : (k,) [-] stretch behind it
        at_tail : whether the tail is behind it, which presses on nothing: the contact force is then
            of the stretch ahead alone

        Returns
        -------
        (k,) [-]; the end of the table if the yarn cannot bear the friction
        """
        low = behind
        high = np.full_like(behind, self.table.stretch1[-1])
        for _ in range(BISECTIONS):
            ahead = 0.5 * (low + high)
            if at_tail:
                pressed = ahead
            else:
                pressed = 0.5 * (behind + ahead)
            friction = np.interp(pressed, self.table.stretch1, self.thresholds)
            slides = self.tension(ahead) > self.tension(behind) + friction
            low = np.where(slides, low, ahead)
            high = np.where(slides, ahead, high)
        return low

    def stretches(self, first: FloatArray) -> FloatArray:
        """Compute the stretches (k, crossings) [-] towards the crosshead if all crossovers slide,
        the first ones `first` (k,)."""
        found = [first]
        while len(found) < self.crossings:
            found.append(self.stretch_ahead(found[-1]))
        self._check(found)
        return np.transpose(found)

    def _check(self, stretches):
        """Refuse more crossovers than the yarn can be drawn through."""
        strength = self.table.model.fabric.weave.warp.strength
        for number, stretch in enumerate(stretches):
            broken = self.tension(stretch) > strength
            if np.any(broken | np.isclose(stretch, self.table.stretch1[-1], rtol=1e-9)):
                allowed = f"at most {number} with this friction: the yarn breaks in more"
                refuse(self, "crossings", allowed)


@dataclass(frozen=True)
class PullOutCurve:
    """Samples of a pull-out.

    Parameters
    ----------
    coupon : PullOut
    displacement : (n,) [m] of the crosshead
    load : (n,) [N] on the yarn
    sliding : (n,) [-] crossovers that the yarn slides through
    left : (n,) [-] crossovers that the yarn's end has left
    friction_work : (n,) [J]
    """

    coupon: PullOut
    displacement: FloatArray
    load: FloatArray
    sliding: IntArray
    left: IntArray
    friction_work: FloatArray

    @property
    def peak(self) -> float:
        """[N] highest load."""
        return float(self.load.max())

    @property
    def plateau(self) -> float | None:
        """[N] load while all crossovers slide; None where there is no such sample."""
        whole = np.flatnonzero(self.sliding == self.coupon.crossings)
        if not whole.size:
            return None
        return float(self.load[whole[-1]])

    @property
    def slip_length(self) -> float:
        """[m] length of yarn, at rest, that slides at the peak."""
        return float(self.coupon.spacing * self.sliding[np.argmax(self.load)])


def follow(coupon: PullOut, displacement: float, *, samples: int = 500) -> PullOutCurve:
    """Draw the yarn until the crosshead has moved by `displacement` [m], in equal samples.

    Raises
    ------
    InputError : a displacement that is not positive, no sample, or more crossovers than the yarn
        can be drawn through
    """
    if not 0 < displacement < inf:
        raise InputError(key="displacement", value=displacement, allowed="above 0")
    if samples < 1:
        raise InputError(key="samples", value=samples, allowed="at least 1")
    stretches, (sliding, left, from_tail) = _path(coupon)
    given = coupon.spacing * (1 / coupon.slack - 1 / stretches)  # by the pieces between crossovers
    moved = given.sum(axis=1) + from_tail
    tension = coupon.tension(stretches)
    friction = np.diff(tension, axis=1, prepend=0.0)
    # through a crossover has passed what the pieces ahead of it have not given
    passed = moved[:, None] - np.cumsum(given[:, ::-1], axis=1)[:, ::-1]
    works = 0.5 * (friction[1:] + friction[:-1]) * np.diff(passed, axis=0)
    work = np.concatenate([[0.0], np.cumsum(works.sum(axis=1))])
    at = np.linspace(0.0, displacement, samples + 1)
    state = np.searchsorted(moved, at, side="right") - 1
    return PullOutCurve(
        coupon=coupon,
        displacement=at,
        load=np.interp(at, moved, tension[:, -1]),
        sliding=sliding[state].astype(int),
        left=left[state].astype(int),
        friction_work=np.interp(at, moved, work),
    )


def _path(coupon):
    """States of the yarn in their order.

    Returns
    -------
    (states, crossings) [-] stretches of the pieces towards the crosshead; and of each state the
    crossovers that the yarn slides through, those that its end has left, and the yarn [m] that its
    tail has given
    """
    n = coupon.crossings
    slack = coupon.slack
    rows = []
    counts = []
    at_rest = np.full(1, slack)
    at_front = np.linspace(slack, coupon.stretch_ahead(at_rest)[0], FRONTS)
    at_tail = coupon.stretch_ahead(at_rest, at_tail=True)
    ahead = coupon.stretches(at_front)
    for pieces in range(1, n + 1):
        if pieces == n:
            ahead = coupon.stretches(np.linspace(slack, at_tail[0], FRONTS))
        rows.append(_with_slack(slack, n, ahead[:, :pieces]))
        counts += [(pieces - 1, 0, 0.0)] * FRONTS
    ahead = coupon.stretches(at_tail)
    start = 0.0
    for left in range(n + 1):
        row = _with_slack(slack, n, ahead[:, : n - left])
        end = coupon.spacing * (TAIL + left) / slack
        rows.append(np.repeat(row, 2, axis=0))
        counts += [(n - left, left, start), (n - left, left, end)]
        # when the end leaves the next crossover the pieces shorten, and its tail moves on by as
        # much
        if left < n:
            next_row = _with_slack(slack, n, ahead[:, : n - left - 1])
            start = end + coupon.spacing * np.sum(1 / next_row - 1 / row)
    return np.concatenate(rows), np.transpose(counts)


def _with_slack(slack, n, ahead):
    """(k, n) stretches: `ahead` (k, pieces) of the pieces at the crosshead, slack of those
    behind."""
    found = np.full((len(ahead), n), slack)
    found[:, n - ahead.shape[1] :] = ahead
    return found
