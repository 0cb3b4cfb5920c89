"""The failure criterion of a yarn segment, for the membrane's edges and for resolved yarns. The tension F
that is held against the strength follows the mean tension of the segments beside it with a low-pass
(`failure_kernels` says why). The load is x = F / (EA e_s), over the strength at rest; a constant
strength fails at x = 1. Where the strength is f(r) times as high at the strain rate r
(`families.strain_rate`), damage adds up (Coleman's linear accumulation; docs/reports/yarns.md):

    dD/dt = r'(x) / e_s,   failure at D = 1 or x = max f

with r(x) the inverse of f, in a table (`RateLaw.table`), without points where the option is off. At a
steady rate r that is failure at x = f(r), without a rate being formed from tensions that ring.
"""

import math

from shellfabric.jit.compile import kernel


@kernel(_nrt=False)
def follow_mean(filtered, mean, half, factor):
    """Return the low-passed tension F [N] after a step.

    filtered, mean : [N] F before it, and the present M
    half : [N] half of the strength, below which nothing is followed
    factor : [-] share of the way to M that F goes in a step
    """
    if max(mean, filtered) > half:
        return max(half, filtered + factor * (mean - filtered))
    return filtered


@kernel(_nrt=False)
def load_of(panel, tension, strength, stiffness):
    """Compute the load [-] of a segment, above 1 at failure: of its tension F by its strength, and by what
    else yarns fail. It is in proportion to the tension.

    panel : its numbers (`PanelNumbers`)
    tension, strength, stiffness : [N] F, strength and EA of the yarn
    """
    return tension / strength


@kernel(_nrt=False)
def breaks(rate_law, family, dt, rate_damage, k, load):
    """Decide whether the segment at slot k fails under a load [-]; keep its damage where there is a
    law of the strain rate."""
    after = damage(rate_law, family, dt, rate_damage, k, load)
    keep_damage(rate_law, rate_damage, k, after)
    return load > highest_load(rate_law) or after >= 1.0


@kernel(_nrt=False)
def highest_load(law):
    """Load beyond which a segment fails at any strain rate."""
    if law.load.size == 0:
        return 1.0
    return law.load[0, law.load.shape[1] - 1]


@kernel(_nrt=False)
def damage(law, family, dt, kept, k, load):
    """Compute the damage of the segment at slot k at the end of a step under a load; 0 if there is
    no law."""
    if law.load.size == 0:
        return 0.0
    for m in range(law.load.shape[1] - 1):
        low = law.load[family, m]
        if low < load <= law.load[family, m + 1]:
            growth = math.exp(law.growth[family, m] * (load - low))
            return kept[k] + dt * law.rate[family, m] * growth
    return kept[k]


@kernel(_nrt=False)
def keep_damage(law, kept, k, value):
    """Keep the damage of the segment at slot k, where there is a law."""
    if law.load.size > 0:
        kept[k] = value
