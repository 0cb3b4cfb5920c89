"""Biaxial tests that the solid of a 3D crossover is fitted to: which of them it takes, and how it meets them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fabrics.base.errors import InputError
from shellfabric.membrane.indicator import Indicator
from weavecell.studies.biaxial_fit import LIKENESS, PREDICTION, Comparison, find_likeness
from weavecell.studies.biaxial_tests import BiaxialTest

if TYPE_CHECKING:
    from unitcell3d.identify.biaxial_states import PulledTest
    from unitcell3d.identify.solid_record import SolidFit


def take_tests(tests: Sequence[BiaxialTest], fitted: Sequence[str]) -> tuple[PulledTest, ...]:
    """Return the tests that tell of the solid: all but those with a free direction, in which the yarns do
    not press each other.

    Parameters
    ----------
    fitted : names of those that are to be fitted

    Raises
    ------
    InputError : a test that is to be fitted has a free direction, or none is left
    """
    from unitcell3d.identify.biaxial_states import PulledTest

    found = []
    for test in tests:
        if not test.free:
            found.append(PulledTest(test.name, test.strain, test.load))
        elif test.name in fitted:
            allowed = "a test of both directions: in one with a free direction no yarn is pressed"
            raise InputError(key="fitted", value=test.name, allowed=allowed)
    if not found:
        raise InputError("has no test that strains both directions", key="biaxial")
    return tuple(found)


@dataclass(frozen=True)
class SolidTests:
    """Tests beside the crossover of a fitted solid.

    Parameters
    ----------
    comparisons : a Comparison of each
    before : rms (2,) [-] of each with the solid of the file, over the greatest load of warp and weft
    checked : the same with the fitted one on the finer mesh; nan without one
    """

    comparisons: tuple[Comparison, ...]
    before: tuple[tuple[float, float], ...]
    checked: tuple[tuple[float, float], ...]

    @classmethod
    def of(cls, solid: SolidFit) -> SolidTests:
        """Compare the tests of a fit."""
        comparisons = []
        before = []
        checked = []
        for one in solid.pulls:
            test = BiaxialTest(one.name, one.strain, one.load)
            comparisons.append(Comparison(test, one.computed, one.fitted, solid.greatest))
            before.append(_pair(solid.shares(one, one.before)))
            at = one.computed * np.nan if one.checked is None else one.checked
            checked.append(_pair(solid.shares(one, at)))
        return cls(tuple(comparisons), tuple(before), tuple(checked))

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Whether residuals are noise, and predictions agree."""
        fitted = [one for one in self.comparisons if one.fitted]
        predicted = [one for one in self.comparisons if not one.fitted]
        meaning = (
            "correlation of a residual of the fitted loads with the next; near 1 the crossover follows them but "
            "for what no constant of its solid can change, and the intervals are too narrow"
        )
        found = [LIKENESS.judge(max(find_likeness(one.residual) for one in fitted), meaning)]
        if predicted:
            worst = max(predicted, key=lambda one: _largest(one.missed))
            meaning = f"rms of the loads of test {worst.name}, without noise, over the greatest of all tests"
            found.append(PREDICTION.judge(_largest(worst.missed), meaning))
        return tuple(found)


def _pair(shares):
    warp, weft = shares
    return float(warp), float(weft)


def _largest(values):
    """Return the largest; infinite where none is known, as of a test that found no equilibrium."""
    known = [value for value in values if np.isfinite(value)]
    return max(known, default=np.inf)
