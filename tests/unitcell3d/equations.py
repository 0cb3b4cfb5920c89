"""What tests of several equations share: differences beside a tangent, a tangent as a matrix, states under load."""

import numpy as np
from scipy import sparse

from unitcell3d.model.crossover import CrossoverModel, Load, Numerics
from unitcell3d.solver.load_stepping import continue_to, rest_state
from unitcell3d.solver.newton import Newton


def slope(function, x, direction, step):
    """(n,) derivative of a function of an array along `direction`, by differences of fourth order."""
    at = {s: np.ravel(function(x + s * step * direction)) for s in (-2, -1, 1, 2)}
    return (8 * (at[1] - at[-1]) - (at[2] - at[-2])) / (12 * step)


def assert_tangent(K, function, x, direction, step, tolerance=1e-7):
    """K times `direction` is the derivative of the function, within `tolerance` of its largest component."""
    difference = slope(function, x, direction, step)
    assert abs(K @ np.ravel(direction) - difference).max() < tolerance * abs(difference).max()


def assert_model_tangent(model, q, load, direction):
    """The tangent that a model has made at q is the derivative of its reduced forces along `direction`."""

    def residual(q):
        return model.constraints.reduce(model.forces(q, load)[0])

    # 3e-12 m: between rounding and the kinks of the contact's toe
    assert_tangent(matrix(model.pattern), residual, q, direction, 3e-12)


def shares(steps):
    """The ends of equal steps from 0 to 1."""
    return np.linspace(0, 1, steps + 1)[1:]


def matrix(pattern):
    """The tangent of a model that has filled its pattern."""
    size = len(pattern.starts) - 1
    content = (pattern.entries.copy(), pattern.columns, pattern.starts)
    return sparse.csr_matrix(content, shape=(size, size))


def dense(values, n):
    """(3 n, 3 n) of blocks (n n, 3, 3) in the order of pairs of nodes."""
    return values.reshape(n, n, 3, 3).transpose(0, 2, 1, 3).reshape(3 * n, 3 * n)


def loaded(model, load, steps=10):
    """(solver, state) in equilibrium at a load, which is reached from none in equal steps."""
    solver = Newton(model)
    q = np.zeros(model.size)
    for share in shares(steps):
        state = solver.solve(q, Load().towards(load, share))
        q = state.q
    return solver, state


def end_forces(mesh, fabric, route, friction=0.0, step=2e-6):
    """T1, T2, F_c [N] after the corners `route` : (c, 2) [m], in steps [m] after each of which friction sticks anew."""
    model = CrossoverModel(mesh, fabric, Numerics(friction=friction))
    solver = Newton(model)
    q = rest_state(model, solver, Load()).q
    at = Load()
    model.commit(q, at)
    for corner in route:
        goal = Load(tuple(corner))
        steps = round(abs(np.subtract(goal.d, at.d)).max() / step)
        for share, state in continue_to(model, solver, q, at, goal, shares(steps)):
            q = state.q
            model.commit(q, at.towards(goal, share))
        at = goal
    solver.close()
    return np.array([*model.tensions(state.forces), model.copies[1] * state.contact])
