"""Cache-line-aligned arrays."""

import numpy as np


def aligned_zeros(count, slots, kind=float):
    """Allocate `count` flat arrays of `slots` zeros, each aligned to a cache line, in different
    cache sets."""
    width = (-(-slots // 16) | 1) * 16
    # of any kind, up to 63 bytes lie before a cache line
    whole = np.zeros(count * width + 64, kind)
    start = -whole.ctypes.data % 64 // whole.itemsize
    starts = [start + m * width for m in range(count)]
    return tuple([whole[first : first + slots] for first in starts])
