"""What the quality monitor (`quality.Monitor`) looks at in a panel at an audit: tension
oscillation."""

from shellfabric.jit.compile import entry
from shellfabric.state import unit

ALTERNATION, SQUARES, DEPTH = range(3)  # columns of quality.Monitor.found
SAMPLED_YARNS = 4  # yarns of each family, from the impact point outwards, whose tension is sampled
# nodes of a wave front that are left out, and the least number of nodes behind it
FRONT_NODES = 6
MIN_NODES = 8
LOADED_FRACTION = 0.02  # of the largest tension of a yarn: what the wave has reached


@unit(T="n", light="number", found="3")
def alternation(T, start, step, count, across, light, found):
    """Add to found (2,) [N2] the squares of the alternation from node to node of tensions, and of
    the tensions.

    BAND yarns of `count` tensions each: those of yarn b are T[start + b across + n step]. Looked at
    is what is behind the wave front of the first, whose jump is none. Third differences over 8 are
    the amplitude of what alternates. Tensions count as `light` [N] at the least: what alternates
    far below the strength harms nothing.
    """
    top = 0.0
    last = -1
    for n in range(count):
        top = max(top, T[start + n * step])
    for n in range(count):
        if T[start + n * step] > LOADED_FRACTION * top:
            last = n
    end = last - FRONT_NODES
    if end < MIN_NODES:
        return
    alternating = 0.0
    squares = 0.0
    for b in range(SAMPLED_YARNS):
        k = start + b * across
        for n in range(end):
            squares += T[k + n * step] ** 2
            if n >= 3:
                a = k + (n - 3) * step
                c = k + n * step
                third = T[c] - T[a] + 3.0 * (T[a + step] - T[c - step])
                alternating += third * third
    found[ALTERNATION] += alternating / 64.0
    found[SQUARES] += max(squares, light * light * SAMPLED_YARNS * end)


@entry(_nrt=False)
def sample(state, const, i, j, light1, light2, found):
    """Sample a ply whose impact point is node (i, j) into found (3,)."""
    start = i * const.row_stride + j
    s = const.row_stride
    per = const.n_per_crossover
    alternation(state.T[0], start, s, const.ni - i, per, light1, found)
    alternation(state.T[1], start, 1, const.nj - j, per * s, light2, found)
