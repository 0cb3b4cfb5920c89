"""Which share of its length a yarn of a plain weave touches the yarn that it crosses.

A cosine is the centreline of a yarn that is pressed all along its length (thesis section 5.3): the
crossing yarns then lie side by side. The share is their width over their spacing. A width that the
fabric does not state is that of an ellipse of the yarn's section, as thick as the mean yarn,
h01 + h02, with the fibre fraction of the solid law, or PACKED without one.
"""

from __future__ import annotations

from math import pi

from fabrics.fabric import Fabric
from shellfabric.membrane.indicator import Check, Indicator

# [-] fibre fraction of a yarn in a fabric; the thesis's are 0.62 and 0.70 (Table 3-2)
PACKED = 0.65
# [-] share below which the straight yarns of Kawabata are nearer than the cosine: where a yarn is
# free over half of its length
LEAST = 0.5
WITHOUT_CONTACT = Check(
    "length without contact",
    1.0,
    "share of the length of a yarn that touches no crossing yarn; the cosine is that of yarns in "
    "contact all along",
    "straight centrelines are nearer to such a weave",
    note=1 - LEAST,
)


def estimate_widths(fabric: Fabric) -> tuple[float, float]:
    """Return the widths [m] of a yarn of warp and weft, stated or estimated."""
    weave = fabric.weave
    widths = []
    for m, yarn in enumerate(weave.yarns):
        stated = fabric.yarn_width[m]
        if stated is not None:
            widths.append(stated)
            continue
        area = fabric.yarn_area[m]
        if area is None:
            fraction = PACKED
            if fabric.solid_laws is not None:
                fraction = fabric.solid_laws[m].Vf0
            area = yarn.A_s / fraction
        # straight yarns have no heights; a round section is the narrowest
        thickness = sum(weave.h0) or 2 * (area / pi) ** 0.5
        widths.append(4 * area / (pi * thickness))
    return widths[0], widths[1]


def find_contact_shares(fabric: Fabric) -> tuple[float, float]:
    """Compute the shares [-] of its length over which a warp and a weft yarn is in contact, at most
    1."""
    warp, weft = estimate_widths(fabric)
    weave = fabric.weave
    # the cell along the warp is the spacing of the weft
    return min(weft / (2 * weave.w1), 1.0), min(warp / (2 * weave.w2), 1.0)


def judge_centreline(fabric: Fabric) -> Indicator:
    """Return the indicator of the cosine: noted of a weave in which a yarn is free over more than
    half of its length."""
    shares = find_contact_shares(fabric)
    family = ("warp", "weft")[int(shares[1] < shares[0])]
    meaning = WITHOUT_CONTACT.meaning.replace("a yarn", f"a {family} yarn", 1)
    return WITHOUT_CONTACT.judge(1 - min(shares), meaning)
