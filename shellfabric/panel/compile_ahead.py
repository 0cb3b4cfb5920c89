"""Kernels of a panel's run, compiled by two processes beside each other where they are not in the cache yet.

`run_steps_main` takes half of the time that all kernels of a run take, and needs those of the internal forces, which
the initial state needs as well, and those of contact, failure and energies. The two groups have little in common.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.kernel_cache import one_compiler_a_node
from shellfabric.cloth import failure_kernels
from shellfabric.jit import compile_in_child
from shellfabric.jit.compile_in_child import FLAG, INDEX, NUMBER, VECTOR, type_of
from shellfabric.panel import arrays, quality_kernels, step_kernels
from shellfabric.projectile import contact_kernels

if TYPE_CHECKING:
    from shellfabric.panel.model import Panel

_begun: set[Any] = set()  # kinds of the constants of panels that this has been done for


def begin(panel: Panel) -> None:
    """Begin to compile what a run of a panel needs; returns at once."""
    const = panel.constants()
    kind = _kind(const)
    if kind in _begun:
        return
    _begun.add(kind)
    known = type_of(const)
    if one_compiler_a_node.cache_info().currsize:  # which would have each kernel compiled once
        return
    state, work = type_of(arrays.undeformed(panel, const, 1.0)), panel.work()
    if not compile_in_child.kept(step_kernels.initial_forces, (state, known, type_of(work))):
        compile_in_child.start(*groups(state, known, type_of(work), type_of(work.contact_scratch)))


def _kind(value):
    """What the numba type of constants follows from, at a fraction of the time that numba takes to find it."""
    if isinstance(value, tuple):
        return type(value), *map(_kind, value)
    if isinstance(value, np.ndarray):
        return value.dtype, value.ndim, value.flags.c_contiguous, value.flags.writeable
    return type(value)


def groups(state: Any, const: Any, work: Any, scratch: Any) -> tuple[list, list]:
    """Two groups of (kernel, numba types of its arguments), from the types of the tuples of a panel."""
    rows = const, state, INDEX, INDEX
    family = const, state, INDEX, INDEX, INDEX
    monitor = state, const, INDEX, INDEX, FLAG, NUMBER, NUMBER, VECTOR
    return [(step_kernels.initial_forces, (state, const, work))], [
        (contact_kernels.contact_forces, (state, const, scratch)),
        (failure_kernels.stored_energy, rows),
        (failure_kernels.half_step_work, rows),
        (failure_kernels.any_past_strength, family),
        (failure_kernels.detect_failures, family),
        (step_kernels.energies, (state, const, VECTOR)),
        (quality_kernels.sample, monitor),
    ]
