"""The ledger: claims and their checks fit each other, comparisons hold at their edges, and outcomes are recorded."""

import csv
import inspect
import json
from dataclasses import replace
from pathlib import Path

import pytest

from fabrics.errors import InputError, UnstableError
from validation.claims import claims as data
from validation.claims import judge, runner, summary, variants
from validation.claims.checks import CHECKS, Check
from validation.claims.claims import Claim, Condition
from validation.claims.registry import Run
from validation.commands import claims as claims_command

RECORDED = Path(__file__).parents[3] / "docs" / "reports" / "data" / "claims.csv"


def claim(*conditions, **changes):
    base = Claim("geom-x", "number", "nowhere", "analytic", "ledger", "a number", conditions, "test", "test.number")
    return replace(base, **changes)


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
        {"id": "nowhere-x"},
        {"untestable": "too"},  # a check and a reason for none
        {"data": "a table", "against": "a misprint"},  # marked in two ways
        {"expect": [{"name": "h", "value": 1.0}]},  # a value without tolerance
        {"expect": [{"name": "h", "above": 1.0, "below": 2.0}]},
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


def of_topic(topic, cost):
    """Claims of a topic that are not slow and whose runs have the cost; what measures time has no fixed verdict."""
    chosen, _ = data.select(data.load(), [topic])
    return [
        entry for entry in chosen
        if entry.check and not entry.check.startswith(TIMED)
        and cost(max([0, *(runner.cost(run) for run in variants.runs(entry).values())]))
    ]  # fmt: skip


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("runs")


TIMED, CHEAP = ("cost.look_up", "cost.shell_over_cable"), 3
COSTS = {"cheap": lambda cost: cost <= CHEAP, "long": lambda cost: cost > CHEAP}


@pytest.mark.parametrize("cost", ["cheap", pytest.param("long", marks=pytest.mark.slow(60))])
@pytest.mark.parametrize("topic", data.TOPICS)
def test_claims_have_their_recorded_verdicts(folder, topic, cost):
    """A claim that turns from reproduced to missed, or the other way, is a change of the product."""
    claims = of_topic(topic, COSTS[cost])
    records = runner.validate(claims, folder, resume=True)
    found = {record.id: record.miss or record.note[-200:] for record in records}
    assert {name: f"{how}; {found[name]}" for name, how in summary.changed(claims, records).items()} == {}


def test_recorded_verdicts_are_those_of_the_page():
    with open(RECORDED, encoding="utf-8") as file:
        page = {row["id"]: row["verdict"] for row in csv.DictReader(file)}
    assert set(page) == {entry.id for entry in data.load()}
    assert [e.id for e in data.load() if e.check and page[e.id] not in (judge.LEFT_OUT, e.verdict)] == []


def test_a_verdict_that_turns_is_named():
    recorded = [
        claim(id="geom-a", verdict=judge.REPRODUCED),
        claim(id="geom-b", verdict=judge.MISSED, turned="data: x"),
    ]
    found = [judge.Record("geom-a", judge.MISSED), judge.Record("geom-b", judge.DATA)]
    assert summary.changed(recorded, found) == {"geom-a": "reproduced -> missed"}
    assert summary.changed(recorded, [judge.Record("geom-b", judge.MISSED)]) == {"geom-b": "data -> missed"}
    assert summary.changed(recorded, [judge.Record("geom-a", judge.LEFT_OUT)]) == {}


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


def test_variants_of_a_claim(computed, tmp_path):
    (record,) = runner.validate(squares(2), tmp_path, vary=True)
    assert (record.verdict, record.found) == (judge.REPRODUCED, {"number": 4.0})  # of the claim as it stands
    assert record.variants == {"two elements": judge.MISSED}
    assert variants.summary(record) == "holds in 1 of 2; missed with two elements"


def test_the_command_ends_well_and_a_turned_verdict_ends_with_1(tmp_path, monkeypatch, capsys):
    chosen = {"topics": ["geom"], "no_variants": True, "jobs": 1}
    assert claims_command.main(out=tmp_path / "ledger", **chosen) == 0
    topics = json.loads((tmp_path / "ledger" / "ledger.json").read_text("utf-8"))["topics"]
    assert topics["geom"]["share reproduced"] == 1.0
    with pytest.raises(InputError, match="--page"):
        claims_command.main(out=tmp_path / "out", **chosen, page=tmp_path / "claims.md")
    assert not (tmp_path / "out").exists()
    monkeypatch.setattr(judge, "_unmissed", lambda claim: judge.MISSED)
    assert claims_command.main(out=tmp_path / "turned", **chosen) == 1
    assert "geom-heights-s720: reproduced -> missed" in capsys.readouterr().out
