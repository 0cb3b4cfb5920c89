"""Yarns that differ in strength: each has one all along, of a Weibull distribution of shape m and mean T,

    F(T_u) = 1 - exp(-(Gamma(1 + 1/m) T_u / T)^m)

T is the strength of all yarns of its family where none is drawn, at their length in the panel
(`shellfabric.membrane.grid.PanelGrid.strengths`). The drawn value is that of the weakest place, and is
held against the tension everywhere: the limit is on the safe side. Every yarn of every ply is drawn, so
that panels are whole. On a graded panel they are drawn as on the uniform one; a line that stands for
several yarns has the strength of the weakest of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import gamma, inf

import numpy as np

from fabrics.base.fields import check_fields
from fabrics.base.frozen import explain_frozen
from shellfabric.impact.strength_keys import StrengthKeys
from shellfabric.membrane import grading
from shellfabric.membrane.model import Panel
from shellfabric.plies.model import Pack

SCATTERED_BEFORE = (
    3  # numbers of a stream that belong to modulus and crimps (`weavecell.studies.strengths`)
)


@explain_frozen
@dataclass(frozen=True)
class YarnStrength(StrengthKeys):
    """The distribution of the strength of yarns.

    Parameters
    ----------
    weibull_shape : [-] m; infinite for yarns that are all alike, None for that of each ply's fabric
    seed : of what is drawn, a whole number of at least 0
    """

    @property
    def words(self) -> str:
        """The distribution, a sentence."""
        shape = "the fabric's shape"
        if self.weibull_shape is not None:
            shape = f"shape {self.weibull_shape:g}"
        return (
            f"Drawn for each yarn by the seed {self.seed}, of a Weibull distribution of {shape} about the strength of "
            "yarns of its length."
        )

    def __post_init__(self):
        check_fields(self)


def draw_strengths(
    shape: float, seed: int, number: int, counts: Sequence[int]
) -> tuple[np.ndarray, ...]:
    """Draw the strength of each yarn of a ply, from the seed and the number of the ply alone.

    Parameters
    ----------
    shape : [-] m; infinite for yarns that are all alike
    counts : (warp, weft) yarns

    Returns
    -------
    (warp, weft) (n,) factors on the strength of each yarn, of mean 1
    """
    random = np.random.default_rng([seed, number])
    random.standard_normal(SCATTERED_BEFORE)
    factors = []
    for count in counts:
        uniform = random.uniform(size=count)
        if shape == inf:
            factors.append(np.ones(count))
            continue
        factors.append((-np.log1p(-uniform)) ** (1 / shape) / gamma(1 + 1 / shape))
    return tuple(factors)


def with_strengths(
    pack: Pack, strength: YarnStrength, number: int = 0, stride: int | None = None
) -> Pack:
    """Return the pack with yarns that differ in strength; its plies are whole.

    Parameters
    ----------
    number : of the pack, if many are drawn from one seed
    stride : numbers of plies from one pack to the next; None takes the plies of this one. Packs of
        different numbers of plies whose stride is the same share the draws of their first plies
    """
    plies = []
    stride = stride or len(pack.plies)
    for place, ply in enumerate(pack.plies):
        uniform = replace(ply, grading=None)
        of_ply = number * stride + place
        shape = strength.weibull_shape
        if shape is None:
            shape = ply.fabric.weibull_shape
        factors = draw_strengths(shape, strength.seed, of_ply, uniform.yarn_counts)
        if ply.sides is not None:
            factors = of_lines(factors, ply, uniform)
        plies.append(replace(ply, strength_factors=factors))
    return replace(pack, plies=tuple(plies))


def of_lines(
    strengths: Sequence[np.ndarray], panel: Panel, uniform: Panel
) -> tuple[np.ndarray, ...]:
    """Compute the (warp, weft) strength factors of the lines of a graded panel, from those of all
    yarns, which are those of the uniform panel."""
    found = []
    for axis, factors in ((1, strengths[0]), (0, strengths[1])):
        yarns = uniform.lines()[axis][uniform.yarn_axes[axis]]
        # off the middle of the opening there are more yarns on one side of the impact point
        middle = int(np.argmin(np.abs(yarns)))
        crossover = 2 * panel.weave.w[axis]
        lines = panel.lines()[axis][panel.yarn_axes[axis]]
        places = np.fix((1 + 1e-9) * lines / crossover)
        found.append(grading.weakest(factors, places, middle))
    return tuple(found)
