"""The forces that a panel has besides membrane, nose and other plies: those of every panel, those that
its numbers bring about, and those it is given.

Each is a `parts.Part`, with a unit `forces`:

    @unit("number", own=Springs)
    def springs(state, const, own, first, last, acting):

returns the energy [J] stored at the node rows first .. last, and adds its forces to state.f_int
where `acting`.
"""

from __future__ import annotations

from typing import Any

from shellfabric.membrane.bending_kernels import bending_forces
from shellfabric.membrane.packing_kernels import packing_forces
from shellfabric.panel_numbers import PanelNumbers
from shellfabric.parts import Part


class Bending(Part):
    """Yarns that resist bending.

    A yarn that turns to and fro at every node has the energy 1/2 n EI / L (4 w / L)^2 a node.
    """

    name = energy = "bending"

    def __init__(self, panel: Any) -> None:
        mass = panel.weave.areal_density
        spacing = panel.spacing
        lines = zip(panel.yarns_a_line, panel.bending, spacing, spacing[::-1])
        self.stiffness = sum(4 * n * EI / (mass * d**4 * across) for n, EI, d, across in lines)
        if any(panel.bending):
            self.forces = bending_forces


class Packing(Part):
    """Yarns that lie side by side: no stiffer than the membrane, whose bound holds for it."""

    name = energy = "packing"
    forces = packing_forces

    def __init__(self, panel: Any) -> None:
        pass


KNOWN: tuple[Any, ...] = (Bending, Packing)


def make_parts(panel: Any) -> tuple[Part, ...]:
    """Make the parts of a panel, each with a row of its own."""
    usual = PanelNumbers()
    known = [
        part
        for part in KNOWN
        if not part.numbers
        or any(getattr(panel, name) != getattr(usual, name) for name in part.numbers)
    ]
    return tuple(make(panel) for make in (*known, *panel.parts))
