"""Charts: the judge on made-up methods, coarse elements, what cannot change an answer, and a scene from end to end."""

import csv
from dataclasses import dataclass, replace

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError, UnstableError
from shellfabric.cell.model import CellModel
from validation.models.variants import homogenised
from validation.verification.cost_accuracy import core, page, pictures, shots, study, tables
from validation.verification.cost_accuracy.core import Method, Quantity, Sample, Scene


@dataclass(frozen=True)
class Made:
    """A made-up case."""

    value: float
    cost: float
    failed: str = ""


def sample(case):
    return Sample({} if case.failed else {"force": case.value}, case.cost, case.cost, {}, 1, case.failed)


def made_up():
    """Meshes of second order to 100, and five methods: cheap, dear, beaten, one that fails, one within the band."""
    meshes = tuple((h, Made(100 + 8 * h**2, 1 / h)) for h in (1.0, 0.5, 0.25))
    cases = {
        "cheap": Made(120, 0.1), "beaten": Made(121, 0.2), "dear": Made(102, 1), "failing": Made(0, 0.01, "it broke"),
        "good": Made(100.05, 5), "as good": Made(100.0, 9),
    }  # fmt: skip
    methods = tuple(Method("made", name, case) for name, case in cases.items())
    fine = ((meshes[0][1], Made(meshes[0][1].value + 0.02, 1)),)
    return Scene(
        "made", "Made up", "", (Quantity("force", "N", "force"),), methods, sample, lambda case: case, meshes, fine
    )


def test_reference_is_the_limit_with_its_error():
    scene = made_up()
    chart = core.judge(scene, {case: sample(case) for case in scene.cases})
    found = chart.references["force"]
    assert found.value == pytest.approx(100, abs=1e-9)
    # a quarter of the step beyond the finest mesh, 0.5, and what the finer choice moves
    assert found.half_width == pytest.approx(0.25 * 0.5 + 0.02, abs=1e-9)
    errors = {entry.method.name: entry.errors.get("force") for entry in chart.entries}
    assert errors["cheap"] == pytest.approx(0.2)
    assert errors["failing"] is None


def test_front_leaves_out_the_beaten_the_failed_and_what_no_reference_tells_apart():
    scene = made_up()
    chart = core.judge(scene, {case: sample(case) for case in scene.cases})
    assert [entry.method.name for entry in chart.fronts["force"]] == ["cheap", "dear", "good"]


def test_a_method_that_fails_is_kept_with_its_message():
    def run(case):
        raise UnstableError("a number is not finite")

    found = core.timed(lambda case: ({}, {}) if case == "short" else run(case), lambda case: "short", "long")
    assert found.values == {}
    assert found.failed == "a number is not finite"
    assert found.repeats == 1


@pytest.fixture
def clocks(monkeypatch):
    """Clocks that stand still but where a test moves them: {"cpu": [s], "wall": [s]}."""
    now = {"cpu": 7.0, "wall": 11.0}
    monkeypatch.setattr(core.time, "process_time", lambda: now["cpu"])
    monkeypatch.setattr(core.time, "perf_counter", lambda: now["wall"])
    monkeypatch.setattr(core, "_warm", set())
    return now


@pytest.mark.parametrize(
    ("costs", "repeats", "median"),
    [
        ((0.05, 0.2, 0.01, 0.02, 0.1), core.MOST, 0.05),  # never long enough
        ((0.3, 0.5, 9.0, 9.0, 9.0), 2, 0.4),  # as soon as it sums up to enough
        ((2.0, 9.0, 9.0, 9.0, 9.0), 1, 2.0),
    ],
)
def test_short_runs_are_repeated_and_the_warm_one_is_not_counted(clocks, costs, repeats, median):
    """What a case costs is the median of its repeats, in CPU time, which here is a third of the wall time."""
    calls, left = [], list(costs)

    def run(case):
        calls.append(case)
        cost = 100.0 if case == "warm it" else left.pop(0)
        clocks["cpu"] += cost
        clocks["wall"] += 3 * cost
        return {"force": 1.0}, {}

    found = core.timed(run, lambda case: "warm it", "case")
    assert calls == ["warm it"] + ["case"] * repeats
    assert found.repeats == repeats
    assert found.cpu == pytest.approx(median)
    assert found.wall == pytest.approx(3 * median)
    left[:] = costs
    core.timed(run, lambda case: "warm it", "case")
    assert calls.count("warm it") == 1  # compiled by then


@pytest.mark.parametrize("n", [2, 4])
def test_coarse_cell_is_n_cells(n):
    """Same stretches: n-fold tensions, contact force and heights; n^2 cells' energy times n, the thickness."""
    fabric = catalogue.load("S-720").with_effective_density()
    thick = homogenised(fabric, n)
    x = np.linspace(0.97, 1.03, 7)
    s1, s2 = np.meshgrid(x, x)
    one, many = CellModel(fabric).solve(s1, s2), CellModel(thick).solve(s1, s2)
    for name in ("T1", "T2", "F", "N1", "N2"):
        assert many[name] == pytest.approx(n * one[name], rel=1e-9, abs=1e-6), name
    assert many["h1"] == pytest.approx(n * one["h1"], rel=1e-9)
    assert many["W"] == pytest.approx(n**2 * one["W"], rel=1e-9, abs=1e-12)
    assert thick.weave.areal_density == pytest.approx(fabric.weave.areal_density, rel=1e-12)
    stiff = [cloth.shear.stress(0.4) * cloth.weave.thickness for cloth in (fabric, thick)]
    assert stiff[1] == pytest.approx(stiff[0], rel=1e-12)


SHOT = shots.Shot("S-720", 0.0815, (92.5,), 40e-6, "in flight", 20e-6)
SMALL = shots.Shell(SHOT, table=21)


def test_what_cannot_change_an_answer():
    """Rows that no wave has reached, and the images of a symmetry, are no model: to the last bit, to rounding."""
    base = shots.run(SMALL)[0]
    assert shots.run(replace(SMALL, awake=True))[0] == base
    for symmetry in ("half", "whole"):
        assert shots.run(replace(SMALL, symmetry=symmetry))[0] == pytest.approx(base, rel=1e-6)


def test_what_changes_it():
    base = shots.run(SMALL)[0]
    for change in (
        {"model": "decoupled"},
        {"law": "printed"},
        {"form": "equilibrium"},
        {"elements": 2},
        {"elements": 0.5},
    ):
        found = shots.run(replace(SMALL, **change))[0]
        assert max(abs(found[name] / base[name] - 1) for name in base) > 1e-4, change
    cable = shots.run(shots.Cable(SHOT))[0]
    assert cable.keys() == base.keys()


def test_a_shot_with_another_outcome_fails():
    with pytest.raises(UnstableError, match=r"at 92\.5 m/s ends in flight, not stopped"):
        shots.run(replace(SMALL, shot=replace(SHOT, outcome="stopped")))


def test_scenes_are_all_there():
    for key in study.NAMES:
        if key == "crossover-path":
            pytest.importorskip("dolfinx")
        found = study.load(key, quick=True)
        assert found.key == key
        assert found.methods[0].choice == "default"
        assert len({method.name for method in found.methods}) == len(found.methods)
    with pytest.raises(InputError, match="must be one of struck-yarn, "):
        study.load("moon")


def test_a_scene_from_end_to_end_and_resumed(tmp_path, monkeypatch):
    chart = study.run("struck-yarn", tmp_path / "cases", quick=True)
    assert chart.unsure("wave speeds") == 0.0  # a closed form
    assert all(entry.worst(chart.scene.quantities) < 0.1 for entry in chart.entries)
    pictures.draw(chart, tmp_path / "chart.png")
    assert (tmp_path / "chart.png").read_bytes()[:4] == b"\x89PNG"
    tables.write_methods(chart, tmp_path / "methods.csv")
    rows = list(csv.DictReader((tmp_path / "methods.csv").open()))
    assert len(rows) == len(chart.scene.methods)
    assert [float(row["cpu [s]"]) for row in rows] == pytest.approx([e.sample.cpu for e in chart.entries], rel=1e-3)
    yarn, velocity = catalogue.load("S-720").weave.warp, chart.scene.methods[0].case.velocity
    c = (yarn.EA / yarn.linear_density) ** 0.5
    e, U = float(rows[0]["tension [N]"]) / yarn.EA, float(rows[0]["kink speed [m/s]"])
    assert (c**2 * e * (1 + e) - U**2) ** 0.5 == pytest.approx(velocity, rel=0.02)  # Smith, of the default mesh
    for row in rows:
        off = abs(float(row["front speed [m/s]"]) / c - 1)
        assert float(row["error of front speed [-]"]) == pytest.approx(off, rel=0.01, abs=1e-6)
    assert {row["Pareto-optimal in"] for row in rows} > {"", "wave speeds"}
    tables.write_methods(chart, tmp_path / "struck-yarn.csv")
    tables.write_references(chart, tmp_path / "struck-yarn-references.csv", "here and now")
    read, made = tables.read(chart.scene, tmp_path)
    assert made == "here and now"
    assert [[e.method.name for e in front] for front in read.fronts.values()] == [
        [e.method.name for e in front] for front in chart.fronts.values()
    ]
    page.write([(read, made)], tmp_path / "charts.md", "weavecell cost-accuracy")
    text = (tmp_path / "charts.md").read_text()
    assert "| Struck yarn" in text
    (row,) = (line for line in page.costs([read]).splitlines() if "| wave speeds |" in line)
    by_cost = sorted(read.entries, key=lambda entry: entry.sample.cpu)
    quantities = read.scene.groups["wave speeds"]
    for error, cell in zip(page.WITHIN, row.split(" | ")[2:6]):
        assert cell.startswith(next(e.method.name for e in by_cost if e.worst(quantities) <= error))
    dominating = row.strip(" |").split(" | ")[-1]
    default = read.entries[0]
    assert (dominating == "none") == all(
        entry.sample.cpu >= default.sample.cpu or entry.worst(quantities) > default.worst(quantities)
        for entry in read.fronts["wave speeds"]
    )
    assert row in text
    monkeypatch.setattr(study, "timed", None)  # nothing is run again
    again = study.run("struck-yarn", tmp_path / "cases", quick=True, resume=True)
    assert again.references == chart.references


def test_the_defaults_of_the_charts_are_those_of_the_code():
    from shellfabric.impact.simulation import ImpactSetup
    from validation.verification.cost_accuracy import coupons
    from weavecell.commands.coupon import TABLE_SIZE
    from weavecell.scenes.coupon import TOLERANCE

    table_size = ImpactSetup.__dataclass_fields__["table_size"].default
    for shell in (shots.Shell(SHOT), study.load("four-ply-pack").methods[0].case.shell):
        assert shell.table == table_size
        assert shell.grading is None
    for test in (coupons.Bias(), coupons.Cross()):
        assert (test.table, test.tolerance) == (TABLE_SIZE, TOLERANCE)


@pytest.mark.parametrize("key", ["bias-extension", "biaxial-coupon"])
def test_coupons_converge(key):
    """One element a crossover and two agree within 2 %; a finer table and smaller load steps move nothing."""
    from validation.verification.cost_accuracy import coupons

    base = replace(coupons.read(study.case_of(key)), table=51, steps=1)
    one, two = (coupons.run(replace(base, elements=n))[0] for n in (1, 2))
    assert two == pytest.approx(one, rel=0.02)
    assert coupons.run(replace(base, table=101))[0] == pytest.approx(one, rel=1e-3)
    assert coupons.run(replace(base, steps=2))[0] == pytest.approx(one, rel=1e-3)
