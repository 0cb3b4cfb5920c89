"""The trellis law of a weave from its geometry: moduli by eq. 4-49, angles from width and spacing
(erratum E-08)."""

from __future__ import annotations

from math import acos, inf, pi
from typing import TypeAlias

from fabrics.base.errors import InputError
from fabrics.trellis import TrellisShear, locking_angle, locking_modulus, touching_angle
from fabrics.weave import Weave

Widths: TypeAlias = tuple[float | None, float | None]
# [rad] between the two angles the packed yarn is as wide as its spacing, or nearly so
LEAST_RISE = 0.05
LARGEST = 0.49 * pi  # [rad]


def from_weave(
    weave: Weave,
    widths: Widths = (None, None),
    *,
    locking_share: float,
    G1_over_G2: float,
    gap: float,
    K_s: float,
) -> TrellisShear:
    """Compute the trellis law that follows from a weave.

    G2 is eq. 4-49 with `locking_share` in place of one half; G1 = G1_over_G2 G2. gamma1 is the
    smaller one of both families' touching angles (eq. 4-32), gamma2 that of their locking angles
    (eqs. 4-33, 4-34, erratum E-08) and at least LEAST_RISE above gamma1.

    Yarns of a group, over which others float, may lie closer to each other and farther from the next
    group: n of them have n spacings, so that the angles are those of a plain weave of the same yarns.
    Its moduli are taken over.

    Parameters
    ----------
    weave : Weave
    widths : (warp, weft) [m] yarn widths; where None, or not below the spacing, it is (1 - gap)
        times the spacing
    locking_share : [-] of the fibre's modulus
    G1_over_G2 : [-]
    gap : [-] between parallel yarns, over the spacing
    K_s : [-] fibre volume fraction of a packed yarn

    Raises
    ------
    InputError : the fabric has no thickness, since neither of its yarns is crimped
    """
    if not weave.thickness > 0:
        raise InputError(
            "the trellis law cannot be derived: neither yarn is crimped, so that the fabric is flat"
        )
    # spacing of parallel warp yarns, of parallel weft yarns
    spacings = 2 * weave.w2, 2 * weave.w1
    G2 = (
        2
        * locking_share
        * locking_modulus(weave.warp.E, weave.warp.A_s, weave.thickness, 2 * weave.w1)
    )
    gamma1 = min(
        touching_angle(width, spacing) if width is not None and width < spacing else acos(1 - gap)
        for width, spacing in zip(widths, spacings)
    )
    gamma1 = min(gamma1, LARGEST - LEAST_RISE)
    gamma2 = inf
    for yarn, spacing in zip(weave.yarns, spacings):
        gamma2 = min(gamma2, _locking(yarn.A_s, K_s, weave.thickness, spacing))
    return TrellisShear(G1_over_G2 * G2, G2, gamma1, min(max(gamma2, gamma1 + LEAST_RISE), LARGEST))


def _locking(A_s, K_s, thickness, spacing):
    try:
        return locking_angle(A_s, K_s, thickness, spacing)
    except InputError:
        # the packed yarn is wider than its spacing: it locks at once
        return 0.0
