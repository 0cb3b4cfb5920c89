"""The ledger: claims and their checks fit each other, comparisons hold at their edges, and outcomes are recorded."""

import csv
import inspect
import json
from dataclasses import replace
from pathlib import Path

import pytest

from fabrics.errors import InputError, UnstableError
from validation.claims import claims as data
from validation.claims import judge, runner, runs, variants
from validation.claims.checks import CHECKS, Check
from validation.claims.claims import Claim, Condition
from validation.claims.registry import Run

RECORDED = Path(__file__).parents[3] / "docs" / "reports" / "data" / "claims.csv"


def claim(*conditions, **changes):
    base = Claim("geom-x", "number", "nowhere", "analytic", "ledger", "a number", conditions, "test", "test.number")
    return replace(base, **changes)


# --- the data


def test_every_claim_has_a_check_whose_runs_and_arguments_it_takes_or_a_reason_for_none():
    claims, used = data.load(), set()
    assert len({entry.id for entry in claims}) == len(claims)
    for entry in claims:
        assert sum(map(bool, [entry.check, entry.untestable, entry.unbuilt])) == 1, entry.id
        if entry.check:
            used.add(entry.check)
            check, arguments = CHECKS[entry.check], entry.arguments or {}
            needs = check.needs(**arguments)
            assert {run.name for run in needs.values()} <= set(runner._registry()), entry.id
            inspect.signature(check.function).bind(**needs, **arguments)
    assert used == set(CHECKS)  # no check without a claim


@pytest.mark.parametrize(
    "change",
    [
        {"kind": "rumour"},
        {"id": "nowhere-x"},
        {"untestable": "too"},  # a check and a reason for none
        {"check": ""},  # neither
        {"expect": []},
        {"reason": ""},
        {"data": "a table", "against": "a misprint"},  # marked in two ways
        {"check": "", "expect": [], "untestable": "lost", "data": "a table"},  # marked without a check
        {"expect": [{"name": "h", "value": 1.0}]},  # a value without tolerance
        {"expect": [{"name": "h", "value": 1.0, "within": 0.1, "relative": 0.1}]},
        {"expect": [{"name": "h", "above": 1.0, "below": 2.0}]},
        {"expect": [{"name": "h", "above": 1.0, "unit": "furlong"}]},
    ],
)
def test_a_bad_claim_is_refused(change):
    good = {
        "id": "geom-x", "kind": "number", "source": "eq. 1", "basis": "analytic", "origin": "ledger", "quantity": "h",
        "check": "geometry.heights", "arguments": {"fabric": "S-720"}, "reason": "r",
        "expect": [{"name": "h", "value": 1.0, "within": 0.1}],
    }  # fmt: skip
    data._claim(good)
    with pytest.raises(InputError):
        data._claim(good | change)


# --- the comparison


@pytest.mark.parametrize(
    ("condition", "found", "holds"),
    [
        (Condition("h", "value", 0.12, within=0.005, unit="mm"), 0.125e-3, True),  # the edge belongs to it
        (Condition("h", "value", 0.12, within=0.005, unit="mm"), 0.1251e-3, False),
        (Condition("h", "value", -2.0, relative=0.1), -2.2, True),
        (Condition("h", "value", -2.0, relative=0.1), -2.21, False),
        (Condition("h", "above", 0.0), 0.0, False),
        (Condition("h", "above", 0.0), 1e-12, True),
        (Condition("h", "below", 5, unit="%"), 0.049, True),
        (Condition("h", "below", 5, unit="%"), 0.05, False),
        (Condition("h", "is", ["weft", "warp"]), ("weft", "warp"), True),
        (Condition("h", "is", ["weft", "warp"]), ["warp", "weft"], False),
        (Condition("h", "is", True), True, True),
        (Condition("h", "value", 1, within=1), float("nan"), False),
        (Condition("h", "value", 1, within=1), None, False),
        (Condition("other", "value", 1, within=1), 1.0, False),
        (Condition("h", "value", 45, within=0.1, unit="mm uN^(1/3)"), 45e-5, True),
        (Condition("h", "value", 3, within=0.1, unit="Pa um3"), 3e-18, True),
    ],
)
def test_conditions(condition, found, holds):
    record = judge.judge(claim(condition), {"h": found})
    assert (record.verdict == judge.REPRODUCED) == holds
    assert bool(record.miss) != holds


@pytest.mark.parametrize(
    ("marked", "met", "missed"),
    [
        ({}, judge.REPRODUCED, judge.MISSED),
        ({"against": "a factor is missing"}, judge.WRONG, judge.MISSED),
        ({"data": "a table"}, judge.DATA, judge.MISSED),  # a slip in the data is one
        ({"incomparable": "E-21"}, judge.NOT_COMPARABLE, judge.NOT_COMPARABLE),
    ],
)
def test_all_conditions_have_to_hold_and_a_mark_makes_another_outcome(marked, met, missed):
    both = claim(Condition("a", "above", 0), Condition("b", "is", "stops"), **marked)
    assert judge.judge(both, {"a": 1.0, "b": "stops"}).verdict == met
    assert judge.judge(both, {"a": 1.0, "b": "perforates"}).verdict == missed


def test_closed_forms_have_their_recorded_verdict(tmp_path):
    """A claim without a run that turns from reproduced to missed, or the other way, is a change of the product."""
    with open(RECORDED, encoding="utf-8") as file:
        recorded = {row["id"]: row["verdict"] for row in csv.DictReader(file)}
    assert set(recorded) == {entry.id for entry in data.load()}
    changed = {}
    for entry in data.load():
        if entry.check and not CHECKS[entry.check].needs(**(entry.arguments or {})):
            if entry.check.startswith(("newton.iterations_at", "cost.")):
                continue  # seconds
            record = runner.check(entry, tmp_path)
            assert set(record.found) >= {condition.name for condition in entry.conditions}, entry.id
            if record.verdict != recorded[entry.id]:
                changed[entry.id] = f"{recorded[entry.id]} -> {record.verdict}"
    assert not changed


# --- the runner


@pytest.fixture
def computed(monkeypatch):
    """Runs and checks that square a number; the list has the runs that were computed."""
    numbers = []

    def square(*, of, elements=1):
        numbers.append(of)
        if of < 0:
            raise UnstableError("below zero")
        if of == 13:
            raise ModuleNotFoundError(name="dolfinx")
        return {"value": of * of * elements}

    def number(square, of):
        return {"number": square["value"] / (of - 1)}

    monkeypatch.setattr(runner, "_registry", lambda: {"shot": (square, 1)})
    monkeypatch.setitem(CHECKS, "test.number", Check(number, lambda of: {"square": Run.of("shot", of=of)}))
    monkeypatch.setattr(variants, "VARIANTS", {"two elements": ("elements", 2)})
    return numbers


def squares(*numbers):
    """Claims that a number squared, over the number less one, is 4."""
    expected = Condition("number", "value", 4, within=0)
    return [claim(expected, id=f"geom-{k}", arguments={"of": n}) for k, n in enumerate(numbers)]


def test_a_shared_run_is_computed_once_and_failures_are_outcomes(computed, tmp_path):
    records = runner.validate(squares(2, 2, 3, -1, 13, 1), tmp_path)
    assert [record.verdict for record in records] == [
        judge.REPRODUCED, judge.REPRODUCED, judge.MISSED, judge.MISSED, judge.NOT_TESTABLE, judge.BROKEN,
    ]  # fmt: skip
    assert sorted(computed) == [-1, 1, 2, 3, 13]
    assert "below zero" in records[3].miss
    assert "dolfinx" in records[4].note
    assert "ZeroDivisionError" in records[5].note


def test_an_interrupted_ledger_goes_on(computed, tmp_path):
    def interrupt(share, text):
        if text.startswith("shot") and share > 0.3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        runner.validate(squares(2, 3, 5), tmp_path, report=interrupt)
    assert 0 < len(computed) < 3
    records = runner.validate(squares(2, 3, 5), tmp_path, resume=True)
    assert sorted(computed) == [2, 3, 5]  # none twice
    assert runner.validate(squares(2, 3, 5), tmp_path, resume=True) == records
    changed = [replace(entry, conditions=(Condition("number", "value", 5, within=0),)) for entry in squares(2)]
    assert runner.validate(changed, tmp_path, resume=True)[0].verdict == judge.MISSED
    assert len(computed) == 3
    runner.validate(squares(2), tmp_path)  # without resuming it is done again
    assert len(computed) == 4


def test_variants_of_a_claim(computed, tmp_path):
    (record,) = runner.validate(squares(2), tmp_path, vary=True)
    assert (record.verdict, record.found) == (judge.REPRODUCED, {"number": 4.0})  # of the claim as it stands
    assert record.variants == {"two elements": judge.MISSED}
    assert variants.summary(record) == "holds in 1 of 2; missed with two elements"


def test_variants_and_sliding_crossovers_change_one_choice_of_a_shot():
    base = runs.setup("S-745", 100.0)
    form, denier, elements, body = (runs.setup("S-745", 100.0, **{k: v}) for k, v in variants.VARIANTS.values())
    assert (base.form, base.elements_per_crossover, base.projectile.bar) == ("variational", 1, None)
    assert (form.form, elements.elements_per_crossover) == ("equilibrium", 2)
    ratio = base.fabric.weave.warp.linear_density / denier.fabric.weave.warp.linear_density
    assert ratio == pytest.approx(3081 / 3000, rel=1e-3)  # erratum E-07
    assert body.projectile.bar.mass == pytest.approx(base.projectile.mass)
    names = "form", "fabric", "elements_per_crossover", "projectile"
    for name, varied in zip(names, (form, denier, elements, body)):
        assert replace(varied, **{name: getattr(base, name)}) == base
    (key, mu), *_ = variants.OPTIONS.values()
    assert runs.setup("S-720", 100.0, **{key: mu}).crossovers.mu == 0.2
    assert runs.setup("S-720", 100.0).crossovers is None


# --- the command


def test_the_command_ends_well_and_refuses_a_page_of_some_topics(tmp_path, monkeypatch):
    from validation.commands import claims

    chosen = {"topics": ["geom"], "no_variants": True, "jobs": 1}
    assert claims.main(out=tmp_path / "ledger", **chosen) == 0
    topics = json.loads((tmp_path / "ledger" / "ledger.json").read_text("utf-8"))["topics"]
    assert topics["geom"]["share reproduced"] == 1.0
    with pytest.raises(InputError, match="--page"):
        claims.main(out=tmp_path / "out", **chosen, page=tmp_path / "claims.md")
    assert not (tmp_path / "out").exists()
    broken = judge.Record("geom-x", judge.BROKEN)
    monkeypatch.setattr(runner, "validate", lambda chosen, *_, **__: [replace(broken, id=c.id) for c in chosen])
    assert claims.main(out=tmp_path / "broken", **chosen) == 1
