"""Kernels of a pack, compiled by two processes beside each other; see `panel.compile_ahead`."""

from __future__ import annotations

from typing import Any

from shellfabric.jit import compile_in_child
from shellfabric.jit.compile_in_child import INDEX, type_of
from shellfabric.panel.compile_ahead import THREAD, audit, is_new, parts
from shellfabric.plies import contact_kernels, step_kernels, torn_contact_kernels


def begin(lists: tuple[Any, ...], works: Any, stack: Any, stops: Any) -> None:
    """Begin to compile what the run of a pack needs; returns at once.

    Parameters
    ----------
    lists, works : Items of states, constants, pairs; of scratch
    stack, stops : Stack, TornContact
    """
    if not is_new((lists[1].values[0], "pack")):
        return
    work, all_of = works.values[0], (*map(type_of, lists), type_of(stack))
    state, const, pair = (type_of(items.values[0]) for items in lists)
    forces, contact = parts(state, const, type_of(work), type_of(work.contact_scratch))
    contact.append((step_kernels.implicit_nose_contact, (*all_of, type_of(works), INDEX, INDEX)))
    between = [
        (contact_kernels.contact_forces, (state, const, state, const, pair, INDEX)),
        (contact_kernels.contact_forces_back, (state, const, state, const, pair, INDEX)),
        (torn_contact_kernels.enforce_constraints, (*all_of, type_of(stops))),
    ]
    steps = [(step_kernels.run_thread, (*all_of, type_of(stops), type_of(works), INDEX, *THREAD))]
    compile_in_child.start([forces + contact, between], [steps, audit(state, const)])
