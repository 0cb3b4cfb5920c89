"""Fidelity on demand: what is asked, which model is chosen for it, and what the check does."""

from dataclasses import replace
from math import inf, isnan
from types import SimpleNamespace

import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from shellfabric.edges import PullIn
from shellfabric.impact import ImpactSetup
from shellfabric.projectile import Projectile
from validation.fidelity import book, choose, models, page, quantities, scenes, survey

SETUP = ImpactSetup(catalogue.load("S-720").effective(), 60.0, opening=0.05, end_time=40e-6, symmetry="whole")


def result(outcome="stopped", speed=0.0, z=0.02, peak=(100.0, 120.0), strike=100.0):
    return SimpleNamespace(
        outcome=outcome, residual_velocity=speed, z=[0.0, z, 0.9 * z], peak_tension=peak,
        setup=SimpleNamespace(strike_velocity=strike),
    )  # fmt: skip


def entry(expected, typical=0.0, factor=1.0, cost=1.0):
    return {"cost": cost} | {
        name: {"expected": expected, "typical": typical, "factor": factor} for name in quantities.NAMES
    }


def table(**expected):
    """A Book in which meshes of 1, 2, 3 elements cost 1/27, 8/27, 1."""
    names = {"one": "1 element", "two": "2 elements", "three": "3 elements"}
    costs = {"one": 1 / 27, "two": 8 / 27, "three": 1.0}
    return book.Book({names[key]: entry(value, cost=costs[key]) for key, value in expected.items()}, {})


class TestQuantities:
    def test_a_stopped_projectile(self):
        found = quantities.of(result(speed=-0.3))
        assert found["residual_velocity"] == 0
        assert found["absorbed_energy"] == 1
        assert found["deflection"] == 0.02

    def test_a_perforated_panel_has_neither_deflection_nor_peak(self):
        found = quantities.of(result("perforated", speed=60.0))
        assert found["residual_velocity"] == 0.6
        assert found["absorbed_energy"] == pytest.approx(0.64)
        assert isnan(found["deflection"])
        assert all(map(isnan, found["peak_tension"]))

    def test_differences(self):
        one, other = quantities.of(result(z=0.0202, peak=(90.0, 121.0))), quantities.of(result())
        found = quantities.differences(one, other)
        assert found["deflection"] == pytest.approx(0.01)
        assert found["peak_tension"] == pytest.approx(0.1)
        assert found["residual_velocity"] == 0
        gone = quantities.differences(quantities.of(result("perforated", 10.0)), other)
        assert isnan(gone["deflection"])
        assert isnan(gone["peak_tension"])
        assert gone["residual_velocity"] == 0.1


class TestSymmetry:
    def test_a_straight_shot_needs_a_quarter(self):
        assert models.simplest(SETUP, models.Tables()).symmetry == "quarter"

    def test_an_oblique_one_what_its_plane_leaves(self):
        along_weft = replace(SETUP, projectile=Projectile(obliquity=0.3, azimuth=1.5707963267948966))
        across = replace(SETUP, projectile=Projectile(obliquity=0.3, azimuth=0.7))
        tables = models.Tables()
        assert [models.simplest(one, tables).symmetry for one in (along_weft, across)] == ["half", "whole"]

    def test_other_faults_are_told(self):
        with pytest.raises(InputError, match="opening"):
            models.simplest(replace(SETUP, opening=0.005), models.Tables())

    def test_sides_that_differ(self):
        pulled = PullIn(1e-3, 0.0, 1e-4)
        uneven = replace(SETUP, edge=((pulled, "clamped"), "clamped"))
        assert models.simplest(uneven, models.Tables()).symmetry != "quarter"


class TestChoice:
    def test_the_cheapest_that_is_enough(self):
        known = table(one=0.05, two=0.02, three=0.001)
        for share, name in ((0.1, "1 element"), (0.03, "2 elements"), (0.01, "3 elements"), (1e-5, "3 elements")):
            found = choose.options(SETUP, {"deflection": share}, book=known)
            assert choose.pick(found).model.name == name
        assert not choose.pick(found).enough

    def test_what_is_set_by_hand_stays(self):
        known = table(one=0.05, two=0.02, three=0.001)
        fixed = replace(SETUP, elements_per_crossover=2)
        found = choose.options(fixed, {"deflection": 0.2}, fixed={"elements_per_crossover", "symmetry"}, book=known)
        assert {option.model.name for option in found} == {"2 elements"}
        assert found[0].setup.symmetry == "whole"
        odd = replace(SETUP, elements_per_crossover=4)
        found = choose.options(odd, {"deflection": 0.2}, fixed={"elements_per_crossover"}, book=known)
        assert [option.model.name for option in found] == ["as set by hand"]
        assert found[0].setup.symmetry == "quarter"

    def test_bad_requests(self):
        for asked, text in (({"speed": 0.1}, "speed"), ({"deflection": 0.0}, "above 0")):
            with pytest.raises(InputError, match=text):
                choose.options(SETUP, asked, book=table(one=0.1))

    def test_elements_are_those_of_the_modelled_part(self):
        one, two = (
            next(
                o for o in choose.options(SETUP, {"deflection": 1.0}, book=table(one=1, two=1)) if o.model.name == name
            )
            for name in ("1 element", "2 elements")
        )
        assert two.elements == 4 * one.elements
        assert two.effort == pytest.approx(8 * one.effort)


class TestCheck:
    """With answers that are made up."""

    @staticmethod
    def answers(monkeypatch, values, **asked):
        calls = []

        def run(setup, table=None):
            calls.append(setup.elements_per_crossover)
            return values[setup.elements_per_crossover]

        monkeypatch.setattr(choose.impact, "run", run)
        known = table_of_three()
        return choose.answer(SETUP, asked, book=known), calls

    def test_a_promise_that_holds(self, monkeypatch):
        found, calls = self.answers(monkeypatch, {1: result(), 2: result(z=0.0201), 3: result()}, deflection=0.02)
        assert found.confirmed
        assert found.final.option.model.name == "2 elements"
        assert sorted(calls) == [1, 2]
        assert found.final.errors["deflection"] == pytest.approx(0.005)

    def test_answers_too_far_apart_ask_for_the_next_mesh(self, monkeypatch):
        found, calls = self.answers(monkeypatch, {1: result(z=0.03), 2: result(), 3: result(z=0.0201)}, deflection=0.02)
        assert found.confirmed
        assert found.final.option.model.name == "3 elements"
        assert sorted(calls) == [1, 2, 3]
        assert [attempt.holds for attempt in found.attempts] == [False, True]

    def test_outcomes_that_differ_are_no_promise(self, monkeypatch):
        values = {1: result("perforated", 30.0), 2: result(), 3: result("perforated", 20.0)}
        found, _ = self.answers(monkeypatch, values, residual_velocity=0.03)
        assert not found.confirmed
        assert found.final.errors == {"residual_velocity": inf}

    def test_what_is_not_there_is_not_wrong(self, monkeypatch):
        values = {n: result("perforated", 30.0) for n in (1, 2, 3)}
        found, _ = self.answers(monkeypatch, values, deflection=0.02)
        assert found.confirmed
        assert found.final.errors == {"deflection": 0.0}


def table_of_three():
    return table(one=0.05, two=0.01, three=0.001)


class TestSurvey:
    def test_errors_from_rows(self):
        def row(speeds):
            values = {n: quantities.of(result("perforated", s)) for n, s in zip(names, speeds)}
            return {name: {"values": values[name], "seconds": cost} for name, cost in zip(names, (1.0, 8.0, 27.0))} | {
                "velocity": 100.0
            }

        names = ("1 element", "2 elements", "3 elements")
        others = [model.name for model in models.LADDER if model.name not in names]
        rows = [row((40.0, 42.0, 43.0)), row((50.0, 52.0, 53.0))]
        for one in rows:
            one.update(dict.fromkeys(others, one["1 element"]))
        found = survey.errors(rows)
        assert found["1 element"]["cost"] == pytest.approx(1 / 27)
        assert found["2 elements"]["residual_velocity"]["expected"] == pytest.approx(0.01)
        assert found["2 elements"]["residual_velocity"]["factor"] == pytest.approx(0.5)
        # twice the step from the mesh before is what is left where errors fall with the element's size
        assert found["3 elements"]["residual_velocity"]["expected"] == pytest.approx(0.02)

    def test_the_packages_own_book_knows_every_model(self):
        known = book.load()
        for model in models.LADDER:
            assert all(0 <= known.expected(model, name) < inf for name in quantities.NAMES)
        assert known.cost(models.BY_NAME[models.FULL]) == 1


class TestScenes:
    def test_a_number_is_a_scene(self):
        one, again, other = scenes.drawn(3), scenes.drawn(3), scenes.drawn(4)
        assert one.strike_velocity == again.strike_velocity != other.strike_velocity
        assert one.fabric.weave == again.fabric.weave != other.fabric.weave

    def test_scenes_can_be_run(self):
        for number in range(20):
            setup = scenes.drawn(number)
            assert scenes.VELOCITY[0] <= setup.strike_velocity <= scenes.VELOCITY[1]
            assert min(setup.opening) > 4 * setup.projectile.radius


def test_page(tmp_path):
    path = tmp_path / "page.md"
    path.write_text("a\n<!-- trial of validation.fidelity -->\nold\n<!-- end of the table -->\nz\n")
    page.put(path, "trial", ["| new |"])
    assert path.read_text() == "a\n<!-- trial of validation.fidelity -->\n| new |\n<!-- end of the table -->\nz\n"
    with pytest.raises(InputError, match="survey"):
        page.put(path, "survey", [])
    assert page.survey_table({"1 element": entry(0.01)})[2].startswith("| 1 element | 1.000 | 1 % |")
