"""What is compiled beside each other before a run is what the run calls."""

import numpy as np

from shellfabric.cell.model import CellModel, CellTable
from shellfabric.jit import compile_in_child
from shellfabric.panel import compile_ahead as of_panels
from shellfabric.panel.model import Panel
from shellfabric.panel.solver import PanelSolver
from shellfabric.plies import compile_ahead as of_packs
from shellfabric.plies.model import Pack
from shellfabric.plies.solver import PackSolver


def plan(monkeypatch, module, *arguments):
    """[(kernel, numba types)] that `begin` of a module would have compiled, were nothing in the cache."""
    found = []
    monkeypatch.setattr(compile_in_child, "start", lambda *stages: found.extend(stages))
    monkeypatch.setattr(of_panels, "_begun", set())
    module.begin(*arguments)
    assert len(found) == 2
    return [pair for stage in found for part in stage for pair in part]


def test_a_run_of_a_panel_has_compiled_the_plan(tables, monkeypatch):
    run = PanelSolver(Panel(tables["variational"], (0.06, 0.06)), 100.0, 4e-6).run()
    planned = plan(monkeypatch, of_panels, run.state, run.const, run._works[0])
    assert [kernel.__name__ for kernel, kinds in planned if not compile_in_child.kept(kernel, kinds)] == []


def test_a_run_of_a_pack_has_compiled_the_plan(tables, monkeypatch):
    run = PackSolver(Pack.stacked(Panel(tables["variational"], (0.06, 0.06)), 2, gap=1e-4), 100.0, 4e-6).run()
    planned = plan(monkeypatch, of_packs, run._lists, run._works[0], run.stack, run.stops)
    assert [kernel.__name__ for kernel, kinds in planned if not compile_in_child.kept(kernel, kinds)] == []


def test_types_do_not_depend_on_the_values_of_the_table(tables):
    """So that compiling can begin before the table is filled."""
    straight = CellTable.straight(tables["variational"].model)
    kinds = [
        [compile_in_child.type_of(part) for part in (panel.constants(), panel.state(1.0), panel.work())]
        for panel in (Panel(tables["variational"], (0.06, 0.06)), Panel(straight, (0.06, 0.06)))
    ]
    assert kinds[0] == kinds[1]


def test_straight_yarns_carry_their_strain(fabric):
    found = CellTable.straight(CellModel(fabric))
    warp, _ = fabric.weave.yarns
    np.testing.assert_allclose(found.values["T1"][:, 0], warp.EA * np.maximum(found.stretch1 - 1, 0))
