"""Failure of a yarn segment by its strain rate, and where it is bent over the nose.

The load is the strain of the outer side of the fibres over the failure strain of the yarn,

    x = (T / EA + e_b) / e_s,   e_b = d / (2 R + d)

with e_b the strain of bending of a fibre of diameter d whose axis lies on the radius R + d/2. A constant strength fails
at x = 1. Where the strength is f(r) times as high at the strain rate r (`families.strain_rate`), damage adds up:

    dD/dt = r'(x) / e_s,   failure at D = 1 or x = max f

with r(x) the inverse of f, in a table (`RateLaw.table`). At a steady rate r that is D = r(x) / r and failure at
x = f(r), without a rate being formed from tensions that ring. Under a load that is held damage goes on (Coleman's
linear accumulation). Sources and limits: docs/reports/strength.md. Where an option is off its table or diameter is
None, and the kernel that is handed it is compiled without the rest.
"""

import math

import numpy as np

from shellfabric.jit.compile import kernel

HALF = 0.5 - 1e-9  # share of a line that makes it a yarn's own


@kernel(_nrt=False)
def highest_load(law):
    """Load beyond which a segment fails at any strain rate."""
    if law is None:
        return 1.0
    return law[0, 0, law.shape[2] - 1]


@kernel(_nrt=False)
def damage(law, family, dt, kept, k, load):
    """Damage of the segment at slot k at the end of a step under a load; 0 where there is no law."""
    if law is None:
        return 0.0
    for m in range(law.shape[2] - 1):
        if law[family, 0, m] < load <= law[family, 0, m + 1]:
            return kept[k] + dt * law[family, 1, m] * math.exp(law[family, 2, m] * (load - law[family, 0, m]))
    return kept[k]


@kernel(_nrt=False)
def keep_damage(law, kept, k, value):
    """Keep the damage of the segment at slot k, where there is a law."""
    if law is None:
        return
    kept[k] = value


@kernel(_nrt=False)
def segment_bending(diameter, state, along, across, family, axis, start, lines, stride):
    """Largest strain of bending of the fibres of the segment of the yarn on line `axis` from place `start` on: of the
    lines of which at least half is its own."""
    if diameter is None:
        return 0.0
    found, (first, last) = 0.0, lines
    for line in range(first, last + 1):
        share = 1.0 - along.share[line] if line < axis else along.share[line]
        if share < HALF:
            continue
        for place in range(start, start + across.elements[start]):
            i, j = (place, line) if family == 0 else (line, place)
            found = max(found, state.bending_strain[family][np.uint64(i * stride + j)])
    return found
