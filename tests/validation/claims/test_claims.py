"""The ledger: no claim is dropped, comparisons hold at their edges, runs are shared, and work is taken up again."""

import csv
import inspect
import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from fabrics.errors import InputError, UnstableError
from validation.claims import claims as data
from validation.claims import judge, runner, summary
from validation.claims.checks import CHECKS, Check
from validation.claims.claims import Claim, Condition
from validation.claims.registry import Run

IDS = [entry.id for entry in data.load()]
RECORDED = Path(__file__).parents[3] / "docs" / "reports" / "data" / "claims.csv"
FAST = ("geom", "biaxial", "pencil")


def claim(*conditions, **changes):
    given = Claim("geom-x", "number", "nowhere", "analytic", "ledger", "a number", conditions, "test", "test.number")
    return replace(given, **changes)


# --- the data


def test_every_claim_has_a_check_or_a_reason_for_none():
    assert len(IDS) == len(set(IDS))
    for entry in data.load():
        reasons = [entry.check, entry.untestable, entry.unbuilt]
        assert sum(map(bool, reasons)) == 1, entry.id
        assert entry.quantity, entry.id
        assert entry.source, entry.id
        if entry.check:
            assert entry.conditions, entry.id
            assert entry.reason, entry.id


def test_checks_exist_and_their_runs_are_known():
    used = set()
    for entry in (entry for entry in data.load() if entry.check):
        used.add(entry.check)
        for run in CHECKS[entry.check].needs(**(entry.arguments or {})).values():
            assert run.name in runner._registry(), entry.id
            assert Run.of(run.name, **run.keywords) == run
    assert used == set(CHECKS)  # no check without a claim


def test_checks_take_the_runs_and_arguments_that_they_are_called_with():
    for entry in (entry for entry in data.load() if entry.check):
        check, arguments = CHECKS[entry.check], entry.arguments or {}
        inspect.signature(check.function).bind(**check.needs(**arguments), **arguments)


def test_units_are_known_and_converted():
    for entry in data.load():
        for condition in entry.conditions:
            assert condition.factor > 0, entry.id
    assert Condition("x", "value", 1, 0.1, unit="mm").factor == pytest.approx(1e-3)
    assert Condition("x", "value", 1, 0.1, unit="%").factor == 0.01
    assert Condition("x", "value", 1, 0.1, unit="mm uN^(1/3)").factor == pytest.approx(1e-5)
    assert Condition("x", "value", 1, 0.1, unit="g/m2").factor == pytest.approx(1e-3)
    assert Condition("x", "value", 1, 0.1, unit="Pa um3").factor == pytest.approx(1e-18)


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


def test_topics_select_and_slow_claims_are_distinguished():
    chosen, left = data.select(data.load(), ("gap", "bias"))
    assert {entry.topic for entry in chosen} == {"gap", "bias"}
    assert not left
    slow = (claim(id="geom-a"), claim(id="geom-b", slow=True))
    assert [[entry.id for entry in part] for part in data.select(slow)] == [["geom-a"], ["geom-b"]]
    assert [len(part) for part in data.select(slow, slow=True)] == [2, 0]
    with pytest.raises(InputError, match="--topic"):
        data.select(data.load(), ("nowhere",))


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
    ],
)
def test_conditions(condition, found, holds):
    record = judge.judge(claim(condition), {"h": found})
    assert (record.verdict == judge.REPRODUCED) == holds
    assert bool(record.miss) != holds


def test_a_miss_says_by_how_much():
    record = judge.judge(claim(Condition("V", "value", 100, within=5, unit="m/s")), {"V": 110.0})
    assert record.miss == "V off by +10 m/s (+10 %), 5 allowed"
    assert record.text == "V 110 m/s (100 ± 5 m/s)"
    record = judge.judge(claim(Condition("V", "below", 5, unit="%")), {"V": 0.2})
    assert record.miss == "V 20 %, target < 5 %"


@pytest.mark.parametrize(
    ("marked", "met", "missed"),
    [
        ({}, judge.REPRODUCED, judge.MISSED),
        ({"against": "a factor is missing"}, judge.WRONG, judge.MISSED),
        ({"data": "a table"}, judge.DATA, judge.MISSED),  # a slip in the data is one
        ({"incomparable": "E-21"}, judge.NOT_COMPARABLE, judge.NOT_COMPARABLE),
    ],
)
def test_all_conditions_have_to_hold_and_a_mark_makes_another_verdict(marked, met, missed):
    both = claim(Condition("a", "above", 0), Condition("b", "is", "stops"), **marked)
    assert judge.judge(both, {"a": 1.0, "b": "stops"}).verdict == met
    record = judge.judge(both, {"a": 1.0, "b": "perforates"})
    assert record.verdict == missed
    assert record.text == "a 1 (> 0); b perforates (stops)"


@pytest.mark.parametrize(("mark", "verdict"), [("untestable", judge.NOT_TESTABLE), ("unbuilt", judge.NOT_BUILT)])
def test_claims_without_a_check_keep_their_reason(mark, verdict):
    record = judge.unchecked(claim(check="", **{mark: "a lost figure"}))
    assert (record.verdict, record.note) == (verdict, "a lost figure")


# --- the runner


@pytest.fixture
def bench(monkeypatch):
    """Checks and runs of the test's own; the list tells what has been run."""
    made = []

    def square(*, of):
        made.append(of)
        if of < 0:
            raise UnstableError("below zero")
        if of == 13:
            raise ModuleNotFoundError(name="dolfinx")
        return {"value": of * of}

    def one(square, of):
        made.append("check")
        return {"number": square["value"], "note": "noted"}

    def fails():
        raise ZeroDivisionError

    monkeypatch.setattr(runner, "_registry", lambda: {"square": (square, 1)})
    monkeypatch.setitem(CHECKS, "test.number", Check(one, lambda of: {"square": Run.of("square", of=of)}))
    monkeypatch.setitem(CHECKS, "test.fails", Check(fails, lambda: {}))
    return made


def squares(*numbers):
    return [
        claim(Condition("number", "value", 4, within=0), id=f"geom-{k}", arguments={"of": n})
        for k, n in enumerate(numbers)
    ]


def test_a_shared_run_is_made_once(bench, tmp_path):
    records = runner.validate(squares(2, 2, 3), tmp_path)
    assert [record.verdict for record in records] == ["reproduced", "reproduced", "missed"]
    assert sorted(entry for entry in bench if entry != "check") == [2, 3]
    assert records[0].note == "noted"


def test_any_executor_gives_the_same(bench, tmp_path):
    with ThreadPoolExecutor(2) as pool:
        records = runner.validate(squares(2, 3, 2, 5), tmp_path, executor=pool)
    assert [record.found for record in records] == [{"number": n} for n in (4.0, 9.0, 4.0, 25.0)]


def test_resume_does_nothing_twice(bench, tmp_path):
    first = runner.validate(squares(2, 3), tmp_path)
    bench.clear()
    assert runner.validate(squares(2, 3), tmp_path, resume=True) == first
    assert bench == []
    runner.validate(squares(2, 3), tmp_path)  # without it all is done again
    assert sorted(map(str, bench)) == ["2", "3", "check", "check"]


def test_an_interrupted_run_goes_on(bench, tmp_path):
    def interrupt(share, text):
        if text.startswith("square") and share > 0.3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        runner.validate(squares(2, 3, 5), tmp_path, report=interrupt)
    before = list(bench)
    assert 0 < len(before) < 6
    records = runner.validate(squares(2, 3, 5), tmp_path, resume=True)
    assert sorted(entry for entry in bench if entry != "check") == [2, 3, 5]  # none twice
    assert [record.found["number"] for record in records] == [4.0, 9.0, 25.0]


def test_a_changed_claim_is_checked_again(bench, tmp_path):
    runner.validate(squares(2), tmp_path)
    bench.clear()
    (changed,) = squares(2)
    changed = replace(changed, conditions=(Condition("number", "value", 5, within=0),))
    (record,) = runner.validate([changed], tmp_path, resume=True)
    assert record.verdict == judge.MISSED
    assert bench == ["check"]  # the run still holds


def test_runs_that_fail_are_verdicts(bench, tmp_path):
    unstable, missing, broken = (
        *squares(-1, 13),
        claim(Condition("number", "above", 0), id="geom-z", check="test.fails", arguments={}),
    )
    records = runner.validate([unstable, replace(missing, id="geom-y"), broken], tmp_path)
    assert [record.verdict for record in records] == [judge.MISSED, judge.NOT_TESTABLE, judge.BROKEN]
    assert "below zero" in records[0].miss
    assert "dolfinx" in records[1].note
    assert "ZeroDivisionError" in records[2].note


def test_a_broken_check_is_tried_again(bench, tmp_path, monkeypatch):
    given = claim(Condition("number", "above", 0), check="test.fails", arguments={})
    runner.validate([given], tmp_path)
    monkeypatch.setitem(CHECKS, "test.fails", Check(lambda: {"number": 1.0}, lambda: {}))
    (record,) = runner.validate([given], tmp_path, resume=True)
    assert record.verdict == judge.REPRODUCED


def test_slow_claims_left_out_are_reported(bench, tmp_path):
    (slow,) = squares(2)
    (record,) = runner.validate([], tmp_path, left_out=[slow])
    assert record.verdict == judge.LEFT_OUT


# --- what is written

_WITH_A_REASON = (judge.NOT_TESTABLE, judge.NOT_BUILT, judge.WRONG, judge.DATA, judge.NOT_COMPARABLE)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    from validation.commands.claims import validate

    out = tmp_path_factory.mktemp("ledger")
    assert validate(out, topics=FAST, slow=False, jobs=1, resume=False) == 0
    return out


def test_the_table_has_every_claim(folder):
    with open(folder / "ledger.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["id"] for row in rows] == [name for name in IDS if name.split("-")[0] in FAST]
    assert all(row["why"] for row in rows if row["verdict"] in _WITH_A_REASON)
    assert not [row["id"] for row in rows if row["verdict"] == judge.BROKEN]


def test_the_page_is_whole_and_fetches_nothing(folder):
    page = (folder / "ledger.html").read_text("utf-8")
    for name in (name for name in IDS if name.split("-")[0] in FAST):
        assert f'id="{name}"' in page
    assert "http" not in page.replace("http://www.w3.org", "")


def test_the_summary_adds_up(folder):
    topics = json.loads((folder / "ledger.json").read_text("utf-8"))["topics"]
    for verdict in judge.VERDICTS:
        assert topics["all"][verdict] == sum(topics[topic][verdict] for topic in FAST)
    assert topics["geom"]["share reproduced"] == 1.0
    assert topics["pencil"]["share reproduced"] is None  # all of them left out: their runs are long


def test_shares_count_only_what_our_number_decides():
    verdicts = [judge.REPRODUCED, judge.REPRODUCED, judge.MISSED, judge.WRONG, judge.NOT_BUILT, judge.DATA,
                judge.NOT_COMPARABLE]  # fmt: skip
    claims = [claim(id=f"geom-{k}") for k in range(7)]
    records = [judge.Record(f"geom-{k}", verdict) for k, verdict in enumerate(verdicts)]
    share = summary.shares(claims, records)[0]
    assert share.compared == 3
    assert share.reproduced == pytest.approx(2 / 3)


def test_closed_forms_have_their_recorded_verdict(tmp_path):
    """A claim without a run that turns from reproduced to missed, or the other way, is a change of the product."""
    with open(RECORDED, encoding="utf-8") as file:
        recorded = {row["id"]: row["verdict"] for row in csv.DictReader(file)}
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
