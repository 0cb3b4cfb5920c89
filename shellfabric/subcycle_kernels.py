"""Several steps of a part in one of the run."""

from shellfabric.jit.compile import kernel


def make_steps(step, body, count, dt):
    """Make `count` equal steps of a body in one of `dt` [s] of the run.

    step : called as step(body, own, left) with the length [s] of its own step, and the time [s] that
        is left of the run's after it
    """
    own = dt / count
    for number in range(count):
        step(body, own, (count - 1 - number) * own)


subcycle = kernel(_nrt=False, inline="always")(make_steps)
