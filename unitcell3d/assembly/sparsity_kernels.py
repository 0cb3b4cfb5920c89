"""Summation of the 3 x 3 blocks of the tangent into the matrix of the unknowns."""

from __future__ import annotations

from fabrics.kernel_cache import kernel


@kernel()
def gather(values, source, sign, target, entries):
    """Fill `entries` with the sums of sign * values[source] at each target.

    Parameters
    ----------
    values : (9 k,) [N/m] blocks, flat
    source, sign, target : (m,) which value goes where, with which sign
    entries : (nnz,) [N/m] filled
    """
    entries[:] = 0.0
    for m in range(source.size):
        entries[target[m]] += sign[m] * values[source[m]]
