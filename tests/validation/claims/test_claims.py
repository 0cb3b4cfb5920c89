"""The ledger: each claim ends with its recorded verdict, conditions hold at their edges, and outcomes are recorded."""

from pathlib import Path

import pytest

from fabrics.base.errors import InputError, UnstableError
from validation import csv_file
from validation.claims import (
    changed_fabrics,
    command,
    golden_rows,
    judge,
    readers,
    runner,
    runs,
    table,
    turns,
)
from validation.claims import claims as data

RECORDED = Path(__file__).parents[3] / "docs" / "reports" / "data" / "claims.csv"
TIMED = (
    "future-lut-equals-iteration",
    "cost-ratio-shell-cable-1",
    "cost-ratio-solid-shell",
    "cost-order",
)


# [CPU s] of claims of many shots, by which they are ordered. Of claims that share shots the first has them all, and the
# others nothing: they come last, when the shots are kept, and no two processes fire them beside each other.
# Not here are those whose shots others fire too that are not slow: to leave them out saves nothing.
SECONDS = {
    "cell-bounds-as-fallback": 28,
    "impact1-bounds-s731": 0,
    "impact1-bounds-s731-ke": 0,
    "impact1-bounds-s728": 0,
    "impact1-bounds-s728-ke": 0,
    "wave-crimp-slows-C": 20,
    "wave-crimp-slows-U": 0,
    "wave-crimp-steeper-cone": 0,
    "wave-sqrt2": 0,
    "impact1-failure-zone-by-speed": 17,
    "impact1-failure-sooner-when-faster": 3,
    "slip-width-length": 9,
    "slip-pressure": 6,
    "shear-max-below-lock": 19,
    "cost-iterations-edge": 18,
    "failmode-newton-contact-loss": 19,
    "impact1-quarter-symmetry": 5,
    "cell-bending-option": 7,
    # whose mechanism a cheaper claim or a golden number holds each day
    "yarn-failure-strain": 19,
    "impact1-unbalanced-profile": 4,
    "slip-zone-projectile-size": 3,
    "shear-high-stiffer": 3,
    "impact1-s726-test-110": 2,
    "wave-front-flattens": 2,
}


def marked(claim):
    """A claim as a case; a test of a long one is slow, or runs nightly."""
    marks = ()
    if claim.id in SECONDS:
        marks = pytest.mark.slow(SECONDS[claim.id])
    elif runner.is_long(claim):
        marks = pytest.mark.slow(60), pytest.mark.nightly
    return pytest.param(claim, id=claim.id, marks=marks)


@pytest.fixture(scope="session")
def folder(shared):
    """Of the runs that claims share, in all processes of a session."""
    return shared("runs-of-claims", lambda _: None)


@pytest.mark.parametrize(
    "claim", [marked(c) for c in data.load() if c.conditions and not c.slow and c.id not in TIMED]
)
def test_claim_has_its_recorded_verdict(folder, claim):
    """One that turns from reproduced to missed, or the other way, is a change of the product."""
    (record,) = runner.validate([claim], folder)
    assert not judge.changed(claim, record.verdict), record.miss or record.note


CHEAP = [claim for claim in turns.turned(data.load()) if not claim.run and claim.id not in SECONDS]


@pytest.mark.parametrize("claim", CHEAP, ids=lambda claim: claim.id)
def test_a_tenth_of_an_input_turns_the_verdict(folder, claim):
    """As claims-turns.csv says. A condition that no change turns says nothing of the fabric."""
    assert claim.verdict == judge.MISSED
    (record,) = runner.validate([claim], folder)
    assert record.verdict == judge.MISSED, turns.describe(claim.factors)


def test_turns_are_of_reproduced_claims():
    reproduced = {claim.id for claim in data.load() if claim.verdict == judge.REPRODUCED}
    looked = {row["id"] for row in csv_file.read(csv_file.DATA / turns.FILE)[1]}
    assert looked
    assert looked <= reproduced - set(turns.OF_CLOCKS)


def test_an_input_is_changed_in_all_fabrics():
    plain = changed_fabrics.load("S-726")
    given = {"crimp": [1.1, 0.9], "count": 1.2, "a": 1.3, "linear_density": 0.8, "E": 1.4}
    with changed_fabrics.change_inputs(given | {"shear moduli": 2.0}):
        fabric = changed_fabrics.load("S-726")
        assert readers.weave("S-726") == fabric.weave
    for yarn, before, factor in zip(fabric.weave.yarns, plain.weave.yarns, (1.1, 0.9)):
        assert yarn.crimp == pytest.approx(factor * before.crimp)
        assert yarn.EA == pytest.approx(0.8 * 1.4 * before.EA)
    assert fabric.weave.weft_count == pytest.approx(1.2 * plain.weave.weft_count)
    assert (fabric.laws[1].a, fabric.laws[1].b) == (1.3 * plain.laws[1].a, plain.laws[1].b)
    assert fabric.shear.G1 == 2 * plain.shear.G1
    again = fabric.with_effective_density().weave.warp.linear_density
    assert again == pytest.approx(0.8 * plain.with_effective_density().weave.warp.linear_density)
    assert changed_fabrics.load("S-726") == plain


def test_a_change_reaches_runs_and_is_found(tmp_path, monkeypatch):
    fired = []

    def shot(of, velocity, cell_formulation):
        fired.append((velocity, changed_fabrics.load(of).weave.warp.crimp))
        return velocity

    monkeypatch.setattr(runs, "shot", shot)
    claim = claim_of(
        "v: fired = 100 m/s +- 8 m/s",
        run={"fired": {"shot": "S-720", "velocity": "100 m/s"}},
        verdict=judge.REPRODUCED,
    )
    (row,) = turns.search([claim], tmp_path, lambda done, total: None)
    assert (row["change"], row["tried"]) == ("velocity -10 %", 1)
    assert row["computed"] == "v 90 m/s, expected 100 ± 8 m/s"
    loose = claim_of("v: fired > 1 m/s", run=claim.run, verdict=judge.REPRODUCED, id="geom-loose")
    (row,) = turns.search([loose], tmp_path, lambda done, total: None)
    assert (row["change"], row["tried"]) == ("none", len(turns.OF_RUNS))
    crimps = {velocity: crimp for velocity, crimp in fired if velocity == 100.0}
    assert len(fired) == len(turns.OF_RUNS)
    assert crimps
    crimp = changed_fabrics.load("S-720").weave.warp.crimp
    assert sorted(round(one / crimp, 9) for v, one in fired if v == 100.0) == [0.9, 1.0, 1.1]


def test_one_claim_by_its_name(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(command, "KEPT", tmp_path / "kept")
    assert command.main(["geom-glass-shell-dims"], jobs=1) == 0
    told = capsys.readouterr().out
    assert "geom-glass-shell-dims: " in told
    assert "along warp 6.25 mm" in told
    assert not (tmp_path / "kept" / "claims.csv").exists()
    with pytest.raises(InputError, match="geom-glass-shell-dims"):
        command.main(["geom-glass-shell-dim"], jobs=1)


def test_claims_that_are_judged_again_leave_the_rows_of_others(tmp_path, monkeypatch):
    """A row has the commit of the code that computed it, and nothing else takes that away."""
    monkeypatch.chdir(tmp_path)
    made, rows = csv_file.read(RECORDED)
    csv_file.write(tmp_path / table.FILE, rows, made)
    monkeypatch.setattr(command.origin, "commit", lambda: "0123456789ab")
    name = "geom-glass-shell-dims"
    assert command.main([name], jobs=1, out=tmp_path) == 0
    renewed, again = csv_file.read(tmp_path / table.FILE)
    changed = [(old, new) for old, new in zip(rows, again, strict=True) if old != new]
    assert [(old["id"], new["commit"]) for old, new in changed] == [(name, "0123456789ab")]
    assert ", commit 0123456789ab" in renewed
    assert "golden rows none" not in renewed


def test_a_cause_that_is_written_anew_reaches_a_row_that_is_not_judged_again():
    """It is a sentence of the ledger, and no number."""
    claim = claim_of("h: 1.0 > 2", cause="of two\n lines", because="reading", verdict=judge.MISSED)
    row = {"id": claim.id, "verdict": judge.MISSED, "cause": "earlier", "computed": "h 1"}
    assert table.explained(claim, row) == row | {"cause": "of two lines", "because": "reading"}
    held = row | {"verdict": judge.REPRODUCED, "cause": ""}
    assert table.explained(claim, held) == held | {"because": ""}


def test_a_golden_claim_that_has_moved_is_named():
    """Verdict and numbers are compared, of each that is golden and of no other."""
    rows = [
        {
            "id": "geom-heights-s720",
            "verdict": "reproduced",
            "computed": "h01 0.1203 mm; h02 0.09582 mm",
        },
        {
            "id": "geom-heights-s726",
            "verdict": "missed",
            "computed": "h01 0.1125 mm; h02 0.04401 mm",
        },
        {"id": "impact1-s745-215", "verdict": "missed", "computed": "outcome stops"},
        {"id": "geom-crimp-scatter", "verdict": "not testable", "computed": ""},
    ]
    found = golden_rows.compare(rows)
    assert {cell.row for cell in found.cells} == {"geom-heights-s720", "geom-heights-s726"}
    assert [(cell.row, cell.column) for cell in found.moves] == [
        ("geom-heights-s726", "verdict"),
        ("geom-heights-s726", "computed"),
    ]


def test_golden_claims_are_of_every_kind_of_model():
    rows = csv_file.read(RECORDED)[1]
    chosen = [golden_rows.by_id()[row["id"]] for row in rows if golden_rows.is_golden(row)]
    assert len(chosen) > 100
    assert {claim.id for claim in chosen} >= {*golden_rows.OF_RUNS}


def test_recorded_verdicts_are_those_of_the_page():
    page = {row["id"]: row["verdict"] for row in csv_file.read(RECORDED)[1]}
    assert set(page) == {claim.id for claim in data.load()}
    judged = [claim for claim in data.load() if claim.conditions]
    assert [claim.id for claim in judged if page[claim.id] != claim.verdict] == []


GOOD = {
    "id": "geom-x",
    "kind": "number",
    "source": "eq. 1",
    "basis": "analytic",
    "origin": "ledger",
    "quantity": "h",
    "expect": ["h: weave('S-720').h0[0] = 0.12 mm +- 0.1 mm"],
    "reason": "r",
}


def claim_of(*expect, **changes):
    return data.Claim(**GOOD | changes | ({"expect": list(expect)} if expect else {}))


def test_every_claim_has_a_topic_a_reason_and_one_state():
    claims = data.load()
    assert len({claim.id for claim in claims}) == len(claims)
    for claim in claims:
        assert claim.topic in data.topics()
        assert [bool(claim.conditions), bool(claim.untestable), bool(claim.unbuilt)].count(
            True
        ) == 1, claim.id
        assert claim.reason or not claim.conditions, claim.id
        missed = claim.verdict == judge.MISSED
        assert bool(claim.cause) == missed, claim.id
        assert (claim.because in judge.CAUSES) == missed, claim.id
        marks = [claim.against, claim.data, claim.incomparable]
        assert sum(map(bool, marks)) <= bool(claim.conditions), claim.id


@pytest.mark.parametrize(
    "text", ["h = 1", "h > 1 furlong", "h = 1 mm +- 1 um", "h < 1 mm +- 3 %", "h"]
)
def test_a_bad_condition_is_refused(text):
    with pytest.raises(InputError):
        data.condition_of(text)


# condition: what is found and holds, what is found and does not; an edge belongs to a tolerance, and to nothing else
EDGES = {
    "h = 0.12 mm +- 0.005 mm": (0.125e-3, 0.1251e-3),
    "h = -2.0 +- 10 %": (-2.2, -2.21),
    "h = 50 % +- 1 %": (0.51, 0.511),
    "h > 0": (1e-12, 0.0),
    "h < 5 %": (0.049, 0.05),
    "h is ['weft', 'warp']": (("weft", "warp"), ["warp", "weft"]),
    "h is True": (True, None),
    "h is stops": ("stops", "perforates"),
    "h = 1 +- 1": (2.0, float("nan")),
    "h = 45 mm uN^(1/3) +- 0.1 mm uN^(1/3)": (45e-5, 45.0),
    "h = 3 Pa um3 +- 0.1 Pa um3": (3e-18, None),
}


@pytest.mark.parametrize("condition", EDGES)
def test_conditions(condition):
    for found, verdict in zip(EDGES[condition], (judge.REPRODUCED, judge.MISSED)):
        record = judge.judge(claim_of(condition), {"h": found})
        assert record.verdict == verdict
        assert bool(record.miss) == (verdict == judge.MISSED)


@pytest.mark.parametrize(
    "marks, met, missed",
    [
        ({}, judge.REPRODUCED, judge.MISSED),
        ({"against": "a factor is missing"}, judge.WRONG, judge.MISSED),
        ({"data": "a table"}, judge.DATA, judge.MISSED),  # a slip in the data is one
        ({"incomparable": "E-21"}, judge.NOT_COMPARABLE, judge.NOT_COMPARABLE),
    ],
)
def test_all_conditions_have_to_hold_and_a_mark_makes_another_outcome(marks, met, missed):
    both = claim_of("a > 0", "b is stops", **marks)
    assert judge.judge(both, {"a": 1.0, "b": "stops"}).verdict == met
    assert judge.judge(both, {"a": 1.0, "b": "perforates"}).verdict == missed


READINGS = {"wide": ["a > 0"], "narrow": ["b > 0"], "middle": ["c > 0"]}


@pytest.mark.parametrize(
    "values, verdict",
    [
        ((1.0, 2.0, 3.0), judge.REPRODUCED),
        ((1.0, -2.0, 3.0), judge.OPEN),
        ((-1.0, -2.0, 3.0), judge.OPEN),
        ((-1.0, -2.0, -3.0), judge.MISSED),
    ],
)
def test_readings_that_differ_leave_a_claim_open(values, verdict):
    """Nobody chooses the one that holds; a condition of all readings that fails is a miss whatever they say."""
    found = dict(zip("abc", values)) | {"h": 0.12e-3}
    claim = claim_of(reading=READINGS, undecided="the window")
    record = judge.judge(claim, found)
    assert record.verdict == verdict
    assert bool(record.miss) == (verdict != judge.REPRODUCED)
    assert judge.judge(claim, found | {"h": 1.0}).verdict == judge.MISSED


def test_a_double_is_not_counted_again():
    claim = claim_of(double="geom-y")
    assert judge.judge(claim, {"h": 0.12e-3}).verdict == judge.DOUBLE
    assert judge.judge(claim, {"h": 1.0}).verdict == judge.DOUBLE


def test_readings_say_what_is_open_and_doubles_name_a_claim_that_is_counted():
    by_id = {claim.id: claim for claim in data.load()}
    for claim in by_id.values():
        assert bool(claim.reading) == bool(claim.undecided), claim.id
        assert len(claim.reading) != 1, claim.id
        if claim.double:
            counted = by_id[claim.double]
            assert counted.verdict in (judge.REPRODUCED, judge.MISSED), claim.id
            assert not counted.double, claim.id


def test_the_page_has_one_count(tool):
    """The three counts are those of the tables: missed claims are as many as the page lists."""
    claims_page = tool("claims_page")
    _, rows = csv_file.read(RECORDED)
    thesis = claims_page.of_thesis(rows)
    missed = [row for row in thesis if row["verdict"] == judge.MISSED]
    found = claims_page.shares()
    assert sum(share.missed for share in found.values()) == len(missed)
    assert claims_page.missed().count("\n| `") == len(missed)
    decided = sum(share.decided for share in found.values())
    assert decided == sum(row["verdict"] in (judge.REPRODUCED, judge.MISSED) for row in thesis)


def test_expressions_have_units_readers_and_values_of_their_own():
    text = "2 * 60 us + a[1] * 0.5 mm - T1 / 45 deg"
    assert data.in_si(text) == "2 * 6e-05 + a[1] * 0.0005 - T1 / 0.7853981633974483"
    claim = claim_of("twice: 2 * h > 0.2 mm", "once: h < 1 mm", let={"h": "weave('S-720').h0[0]"})
    assert runner.values(claim, {})["twice"] == 2 * readers.weave("S-720").h0[0]


def test_a_group_makes_a_claim_of_each_row():
    group = {
        "id": "geom-{tag}",
        "each": {"fabric": ["S-720", "S-726"], "n": [1, 2]},
        "run": {"a": {"net": "{n}"}},
    }
    assert data.members(group) == [
        {"id": "geom-s720", "run": {"a": {"net": 1}}},
        {"id": "geom-s726", "run": {"a": {"net": 2}}},
    ]


def test_a_verdict_that_turns_is_named():
    missed = claim_of(verdict=judge.MISSED)
    assert not judge.changed(missed, judge.MISSED)
    assert judge.changed(missed, judge.DATA)
    assert not judge.changed(missed, judge.LEFT_OUT)
    assert judge.changed(missed, judge.BROKEN)


@pytest.fixture
def computed(monkeypatch):
    """Shots that square a number; the list has those that were computed."""
    numbers = []

    def square(of, elements_per_crossover=1, cell_formulation="variational"):
        numbers.append(of)
        if of < 0:
            raise UnstableError("below zero")
        return of * of * elements_per_crossover

    monkeypatch.setattr(runs, "shot", square)
    return numbers


def squares(*numbers):
    """Claims that a number squared, over the number less one, is 4."""
    expect = ["number: square / ({} - 1) = 4 +- 0"]
    return [
        claim_of(expect[0].format(n), id=f"geom-{k}", run={"square": {"shot": n}})
        for k, n in enumerate(numbers)
    ]


def test_a_shared_run_is_computed_once_and_failures_are_outcomes(computed, tmp_path):
    records = runner.validate(squares(2, 2, 3, -1, 1), tmp_path)
    verdicts = [judge.REPRODUCED, judge.REPRODUCED, judge.MISSED, judge.MISSED, judge.BROKEN]
    assert [record.verdict for record in records] == verdicts
    assert sorted(computed) == [-1, 1, 2, 3]
    assert "below zero" in records[3].miss
    assert "ZeroDivisionError" in records[4].note


def test_runs_of_a_list_and_in_a_variant(computed, tmp_path, monkeypatch):
    many = claim_of(
        "sum: sum(square.values()) = 5 +- 0", run={"square": {"shot": "{}", "for": [1, 2]}}
    )
    of_thesis = '{"cell_formulation": "equilibrium"}'
    runs_of = {n: data.Run("shot", str(n), of_thesis) for n in (1, 2)}
    assert runner.runs_of(many)["square"] == runs_of
    monkeypatch.setattr(runner, "VARIANTS", {"two elements": {"elements_per_crossover": 2}})
    monkeypatch.setattr(table, "VARIANTS", runner.VARIANTS)
    (record,) = runner.validate([many], tmp_path, vary=True)
    assert record.verdict == judge.REPRODUCED
    assert record.variants == {"two elements": judge.MISSED}
    assert (
        table.rows([many], [record])[0]["variants"] == "holds in 1 of 2; missed with two elements"
    )


def test_the_command_ends_well_and_a_turned_verdict_ends_with_1(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    chosen = {"topics": ["geom"], "no_variants": True, "jobs": 1}  # which fire no shots
    assert command.main(out=tmp_path, **chosen) == 0
    made, rows = csv_file.read(tmp_path / "claims.csv")
    assert made.startswith("python -m validation claims --no-variants, commit ")
    assert {row["verdict"] for row in rows} >= {judge.REPRODUCED, judge.DATA}
    monkeypatch.setattr(judge, "REPRODUCED", judge.MISSED)
    assert command.main(out=tmp_path, **chosen) == 1
    assert "geom-heights-s720: missed, where reproduced is recorded" in capsys.readouterr().out
