"""What is compiled beside each other before a run is what the run calls."""

import numpy as np
import pytest

from shellfabric.cell.model import CellModel, CellTable
from shellfabric.jit import compile_in_child
from shellfabric.panel.model import Panel
from shellfabric.plies.model import Pack
from shellfabric.solver import compile_ahead
from shellfabric.solver.pack_solver import PackSolver


def plan(monkeypatch, run):
    """[(kernel, numba types)] that `begin` would have compiled for a run, were nothing in the cache."""
    found = []
    monkeypatch.setattr(compile_in_child, "start", lambda *stages: found.extend(stages))
    monkeypatch.setattr(compile_ahead, "_begun", set())
    compile_ahead.begin(*run._plies, run.contact, run.stack, run._works[0])
    assert len(found) == 2
    return [pair for stage in found for part in stage for pair in part]


@pytest.mark.parametrize("plies", [1, 2])
def test_a_run_has_compiled_the_plan(tables, monkeypatch, plies):
    panel = Panel(tables["variational"], (0.06, 0.06))
    run = PackSolver(Pack.stacked(panel, plies, gap=1e-4), 100.0, 4e-6).run()
    planned = plan(monkeypatch, run)
    assert [
        kernel.__name__ for kernel, kinds in planned if not compile_in_child.kept(kernel, kinds)
    ] == []


def test_types_do_not_depend_on_the_values_of_the_table(tables):
    """So that compiling can begin before the table is filled."""
    straight = CellTable.straight(tables["variational"].model)
    kinds = [
        [
            compile_in_child.type_of(part)
            for part in (panel.constants(), panel.state(1.0), panel.work())
        ]
        for panel in (Panel(tables["variational"], (0.06, 0.06)), Panel(straight, (0.06, 0.06)))
    ]
    assert kinds[0] == kinds[1]


def test_straight_yarns_carry_their_strain(fabric):
    found = CellTable.straight(CellModel(fabric))
    warp, _ = fabric.weave.yarns
    np.testing.assert_allclose(
        found.values["T1"][:, 0], warp.EA * np.maximum(found.stretch1 - 1, 0)
    )
