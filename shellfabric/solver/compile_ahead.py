"""Kernels of a run, compiled by two processes beside each other where they are not in the cache yet.

The kernel that makes the steps takes half of the time, and what it calls falls into two groups that have little in
common: the forces of the elements with failure, and the contact with the projectile. Both are compiled first, then the
steps beside the energies and the quality indicators, which need the same.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics.base.kernel_cache import one_compiler_a_node
from shellfabric.cloth import boundary_kernels, failure_kernels
from shellfabric.jit import compile_in_child
from shellfabric.jit.compile_in_child import COUNTERS, HISTORY, INDEX, NUMBER, VECTOR, type_of
from shellfabric.panel import element_kernels, motion_kernels, quality_kernels
from shellfabric.plies import pack_guard_kernels, pressure_kernels
from shellfabric.projectile import bar_kernels, window_kernels
from shellfabric.projectile import contact_kernels as nose_kernels
from shellfabric.solver import ply_kernels, step_kernels

THREAD = (
    HISTORY,
    COUNTERS,
    INDEX,
    INDEX,
    NUMBER,
)  # history, shared, me, count, allowed of `run_thread`
_begun: set[Any] = set()  # kinds of the constants that this has been done for


def begin(states: Any, consts: Any, contact: Any, stack: Any, works: Any) -> None:
    """Begin to compile what a run with pinned crossovers needs; returns at once.

    Arguments as of `step_kernels.run_thread`.
    """
    if not is_new((consts.values[0], contact is None)):
        return
    state, const, work = (type_of(items.values[0]) for items in (states, consts, works))
    lists = type_of(states), type_of(consts), type_of(contact)
    forces, of_nose = parts(state, const, work, type_of(works.values[0].contact_scratch))
    if contact is None:
        first = [forces, of_nose]
    else:
        of_nose.append(
            (
                step_kernels.implicit_nose_contact,
                (*lists, type_of(stack), type_of(works), INDEX, INDEX),
            )
        )
        between = [
            (pressure_kernels.press, (lists[2], INDEX, INDEX)),
            (pressure_kernels.press_others, (lists[2],)),
            (pack_guard_kernels.hold_apart, lists),
        ]
        first = [forces + of_nose, between]
    steps = (step_kernels.run_thread, (*lists, *map(type_of, (None, stack, works)), *THREAD))
    compile_in_child.start(first, [[steps], audit(state, const)])


def is_new(const: Any) -> bool:
    """Whether this is the first run in this process with constants of these types, and it may compile what it likes."""
    kind = _kind(const)
    if (
        kind in _begun or one_compiler_a_node.cache_info().currsize
    ):  # which would have each kernel compiled once
        return False
    _begun.add(kind)
    return True


def _kind(value):
    """What the numba type of constants follows from, at a fraction of the time that numba takes to find it."""
    if isinstance(value, tuple):
        return type(value), *map(_kind, value)
    if isinstance(value, np.ndarray):
        return value.dtype, value.ndim, value.flags.c_contiguous, value.flags.writeable
    return type(value)


def parts(state: Any, const: Any, work: Any, scratch: Any) -> tuple[list, list]:
    """Kernels of a ply, [(kernel, numba types of its arguments), ...]: elements with failure, contact with projectile.

    Parameters
    ----------
    state, const, work, scratch : numba types of the tuples of a panel
    """
    rows, both = (const, state, INDEX, INDEX), (state, const)
    family = const, state, INDEX, INDEX, INDEX
    return [
        (motion_kernels.move_rows, (*both, INDEX, INDEX)),
        (element_kernels.element_forces, (*both, INDEX, INDEX, INDEX, work)),
        (element_kernels.refresh_tensions, (*both, INDEX, INDEX, work)),
        (failure_kernels.stored_energy, rows),
        (failure_kernels.half_step_work, rows),
        (failure_kernels.find_failures, family),
        (failure_kernels.break_edges, family),
    ], [
        (nose_kernels.contact_forces, (*both, scratch)),
        (nose_kernels.apply_contact_impulse, both),
        (window_kernels.cloth_ahead_of_nose, both),
        (motion_kernels.grow_active_rows, both),
        (bar_kernels.advance_bar, (*both, NUMBER)),
        (boundary_kernels.update_slip_nodes, (*both, NUMBER)),
    ]


def audit(state: Any, const: Any) -> list:
    """Kernels of the samples, as `parts`."""
    monitor = state, const, INDEX, INDEX, NUMBER, NUMBER, VECTOR
    return [
        (ply_kernels.energies, (state, const, type_of(None), VECTOR)),
        (quality_kernels.sample, monitor),
    ]
