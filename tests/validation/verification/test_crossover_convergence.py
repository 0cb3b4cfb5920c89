"""The study of the 3D crossover: its judgement on values with a known limit, its files, and one real case."""

import csv
import itertools
import json
from concurrent.futures import Executor, Future
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dolfinx")

from fabrics.errors import InputError
from meshing import crossover as mesher
from unitcell3d.assembly.constraints import AXIAL, VERTICAL
from unitcell3d.cases import biaxial_and_platens as loads
from unitcell3d.model.crossover import Numerics
from validation.verification.cost_accuracy.core import non_dominated
from validation.verification.crossover_convergence import cases, page, pictures, study, tables
from validation.verification.crossover_convergence.axes import BASE, METHOD, axes
from validation.verification.crossover_convergence.cases import solve
from weavecell.cli import app

FABRIC, PATHS = study.scene()
TRUE = {"T1": 300.0, "T2": 80.0, "F_c": 50.0}


def made_up(fabric, paths, case):
    """Forces with errors of order two in the mesh, one in 1 / penalty; four times the time at half the size."""
    h, numerics = 8 / case.size[0], dict(case.numerics)
    error = 0.01 * h**2 + 0.004 * Numerics().penalty / numerics.get("penalty", Numerics().penalty)
    change = 0.05 if case.section == "ellipse" else 0.0
    values = {f"{q}, {name}": value * (1 + error + change) for name in paths for q, value in TRUE.items()}
    failed = {"weft only": "no equilibrium"} if case.one_point else {}
    values = {} if failed else values
    law = None if failed else {"a": 45e-6 * (1 + h**2 / 100), "b": 57e-6 * (1 - h**2 / 50), "rms": 1e-6}
    cost = np.prod(case.size) / 96
    return {
        "values": values, "law": law, "failed": failed, "cpu": cost, "wall": 2 * cost, "steps": 45, "tangents": 300,
        "unknowns": 1000,
    }  # fmt: skip


class MadeUp(Executor):
    """Hands out made-up results; interrupted after so many."""

    def __init__(self, jobs=99):
        self.left, self.done = jobs, 0

    def submit(self, function, *arguments):
        (run, [one]), future = arguments, Future()  # one case a task: they are long
        assert run is solve
        future.set_result(function(made_up, [one]))
        self.done += 1
        return future


@pytest.fixture
def found(tmp_path):
    return study.run(tmp_path, level="quick", executor=MadeUp())


def test_non_dominated_is_what_none_beats():
    random = np.random.default_rng(2)
    cost, error = random.integers(0, 12, (2, 60)).astype(float)
    error[7] = np.nan
    beaten = {
        i
        for i, j in itertools.product(range(60), repeat=2)
        if cost[j] <= cost[i] and error[j] <= error[i] and (cost[j] < cost[i] or error[j] < error[i])
    } | {7}
    best = non_dominated(cost, error)
    assert {(cost[i], error[i]) for i in best} == {(cost[i], error[i]) for i in range(60) if i not in beaten}
    assert list(cost[best]) == sorted(cost[best])
    assert non_dominated([1, 2, 3, 4], [1.0, 0.95, 0.8, 0.79], 0.1) == [0, 2]


def test_every_axis_holds_the_base_and_its_own_cases():
    everything = axes()
    for axis in everything:
        assert BASE in axis.cases.values(), axis.name
        assert len(set(axis.cases.values())) == len(axis.cases), axis.name
        assert axis.x is None or set(axis.x) == set(axis.cases)
    assert {"mesh", "penalty", "load step", "end condition", "section", "tip bluntness", "bars", "shear modulus G"} <= {
        axis.name for axis in everything
    }


def test_orders_limits_and_errors_of_known_values(found):
    for quantity, true in ((f"{q}, {path}", value) for q, value in TRUE.items() for path in study.MEASURED):
        mesh, penalty = found.limits["mesh"][quantity], found.limits["penalty"][quantity]
        assert mesh.order == pytest.approx(2, abs=1e-6)
        assert mesh.limit == pytest.approx(true * 1.004, rel=1e-9)
        assert penalty.order == pytest.approx(2, abs=1e-6)  # of the root of 1 / penalty
        value, half = found.reference[quantity]
        assert value == pytest.approx(true, rel=1e-6)
        assert half < 0.01 * true
    assert found.base.error == pytest.approx(0.014, rel=1e-3)
    assert found.of("penalty")[-1].error == pytest.approx(0.01 + 0.004 / 3, rel=1e-3)
    ellipse = next(entry for entry in found.of("section") if entry.label == "ellipse")
    assert ellipse.error is None
    assert ellipse.change["T1, warp only"] == pytest.approx(0.05 / 1.014, rel=1e-9)
    one_point = next(entry for entry in found.of("integration") if entry.label == "one point")
    assert one_point.error is None
    methods = [entry for entry in found.entries if entry.error is not None]
    for entry in found.best:
        for other in methods:
            if other.case != entry.case:
                assert other.result["cpu"] > entry.result["cpu"] - 1e-12 or other.error > entry.error - 1e-12


def test_a_study_goes_on_from_its_cases(found, tmp_path):
    kept = sorted((tmp_path / "cases").iterdir())
    kept[0].unlink()
    rest = MadeUp()
    again = study.run(tmp_path, level="quick", resume=True, executor=rest)
    assert rest.done == 1
    assert again.reference == found.reference
    fresh = MadeUp()
    study.run(tmp_path, level="quick", executor=fresh)
    assert fresh.done == len(kept)
    with pytest.raises(InputError, match="axis = 'colour': must be one of mesh, "):
        study.run(tmp_path, only=["colour"], executor=MadeUp())


def test_tables_page_and_pictures_hold_it_all(found, tmp_path):
    tables.write(found, tmp_path / "a.csv")
    lines = list(csv.reader((tmp_path / "a.csv").open()))
    assert len(lines) == 1 + len(found.entries)
    assert len({len(line) for line in lines}) == 1
    tables.write_orders(found, tmp_path / "orders.csv")
    assert any(
        line[:2] == ["mesh", "T1, warp only [N]"] and line[3] == "2.00"
        for line in csv.reader((tmp_path / "orders.csv").open())
    )
    drawn = pictures.draw_all(found, tmp_path / "figures")
    assert set(drawn) == {"convergence", "effects", "pareto"}
    page.write(found, tmp_path / "page.md", "Then.", "this", drawn)
    text = (tmp_path / "page.md").read_text()
    for axis in found.axes:
        assert f"### {axis.name[0].upper()}{axis.name[1:]}\n" in text
    assert "**8 x 6 x 2**" in text
    assert "Failed: one point, weft only: no equilibrium." in text
    for name in drawn:
        assert f"(figures/crossover-{name}.png)" in text
        assert (tmp_path / "figures" / f"crossover-{name}.png").stat().st_size > 20_000


def test_the_folder_of_the_command(tmp_path, monkeypatch, capsys):
    run = study.run
    monkeypatch.setattr(study, "run", lambda out, **choices: run(out, **choices | {"executor": MadeUp()}))
    words = ["--scene", "crossover", "--level", "quick", "--only", "mesh,penalty", "--out", str(tmp_path / "c")]
    with pytest.raises(SystemExit) as leaving:
        app.main(["cost-accuracy", *words])
    assert leaving.value.code == 0
    assert sorted(path.name for path in (tmp_path / "c").iterdir()) == [
        "cases", "chart.json", "crossover.csv", "crossover.md", "figures", "orders.csv",
    ]  # fmt: skip
    best = json.loads((tmp_path / "c" / "chart.json").read_text())["best"]
    assert f"{best[0]['method']:<28}" in capsys.readouterr().out


def test_held_ends():
    """Which components of the end face move with the end alone: its middle row, the whole along the yarn, or both."""
    mesh = mesher.build(FABRIC, size=(3, 2, 2))
    n = len(mesh.points)
    for end in (cases.PIN, cases.UPRIGHT, cases.CLAMPED):
        held = cases.held(mesh.grids, n, end)
        unknown = held.unknown.reshape(-1, 3)
        for yarn, grid in enumerate(mesh.grids):
            face, row = grid[-1], grid[-1][:, 1]
            assert np.all(unknown[row][:, [AXIAL[yarn], VERTICAL]] == -1)
            others = np.setdiff1d(face, row)
            assert np.all((unknown[others, AXIAL[yarn]] == -1) == (end != cases.PIN))
            assert np.all((unknown[others, VERTICAL] == -1) == (end == cases.CLAMPED))
        d = np.array([2e-6, 3e-6])
        moved = held.displacement(np.zeros(held.size), d)
        for yarn, grid in enumerate(mesh.grids):
            assert np.allclose(moved[grid[-1], AXIAL[yarn]], d[yarn])
            assert np.allclose(moved[grid[0]], 0)
        free = np.flatnonzero(held.unknown >= 0)
        assert len(set(held.unknown[free])) == len(free) == held.size


def test_a_case_is_the_library_s_own_path():
    case = replace(BASE, size=(2, 2, 2), numerics=(("penalty", 0.5 * Numerics().penalty),))
    path = {"warp only": PATHS["warp only"]}
    result = solve(FABRIC, path, case)
    mesh = mesher.build(FABRIC, size=(2, 2, 2))
    history = loads.biaxial(mesh, FABRIC, (1, 0), max_displacement=path["warp only"][0], numerics=case.full_numerics)
    for quantity in TRUE:
        assert result["values"][f"{quantity}, warp only"] == pytest.approx(getattr(history, quantity)[-1], rel=1e-9)
    assert result["failed"] == {}
    assert result["tangents"] >= history.iterations.sum()
    assert json.loads(json.dumps(result)) == result
    stiff = solve(FABRIC, path, replace(case, end=cases.CLAMPED))
    assert stiff["values"]["T2, warp only"] > 1.02 * result["values"]["T2, warp only"]
    assert all(axis.kind == METHOD or axis.x is None for axis in axes())
