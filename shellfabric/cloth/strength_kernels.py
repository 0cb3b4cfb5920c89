"""Failure of a yarn segment by its strain rate.

The load is x = T / (EA e_s), the tension over the strength at rest. A constant strength fails at x
= 1. Where the strength is f(r) times as high at the strain rate r (`families.strain_rate`), damage
adds up:

    dD/dt = r'(x) / e_s,   failure at D = 1 or x = max f

with r(x) the inverse of f, in a table (`RateLaw.table`). At a steady rate r that is D = r(x) / r
and failure at x = f(r), without a rate being formed from tensions that ring. Under a load that is
held damage goes on (Coleman's linear accumulation). Sources and limits: docs/reports/yarns.md.
Where the option is off its table has no points.
"""

import math

from shellfabric.jit.compile import kernel


@kernel(_nrt=False)
def highest_load(law):
    """Load beyond which a segment fails at any strain rate."""
    if law.size == 0:
        return 1.0
    return law[0, 0, law.shape[2] - 1]


@kernel(_nrt=False)
def damage(law, family, dt, kept, k, load):
    """Damage of the segment at slot k at the end of a step under a load; 0 where there is no
    law."""
    if law.size == 0:
        return 0.0
    for m in range(law.shape[2] - 1):
        if law[family, 0, m] < load <= law[family, 0, m + 1]:
            return kept[k] + dt * law[family, 1, m] * math.exp(
                law[family, 2, m] * (load - law[family, 0, m])
            )
    return kept[k]


@kernel(_nrt=False)
def keep_damage(law, kept, k, value):
    """Keep the damage of the segment at slot k, where there is a law."""
    if law.size > 0:
        kept[k] = value
