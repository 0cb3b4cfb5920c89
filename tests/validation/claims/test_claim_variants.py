"""Variants of the claims that rest on shots: which claims, which runs, and what a record says of them."""

from dataclasses import replace

import pytest

from validation.claims import claims as data
from validation.claims import judge, runner, runs, variants
from validation.claims.checks import CHECKS, Check
from validation.claims.claims import Claim, Condition
from validation.claims.registry import Run
from validation.claims.variants import VARIANTS

NAMES = list(VARIANTS)
FORM, DENIER, ELEMENTS, BODY = NAMES


@pytest.fixture
def claim(monkeypatch, tmp_path):
    """A claim on a made-up shot that is faster with two elements and breaks with an elastic projectile."""

    def shot(*, fabric, elements=1, body="rigid", form=None, denier="effective"):
        return {"velocity": 100.0 if elements == 1 else 120.0, "body": body}

    def fast(run, other, fabric):
        if run["body"] != "rigid":
            raise ZeroDivisionError
        return {"velocity": run["velocity"]}

    monkeypatch.setattr(runner, "_registry", lambda: {"shot": (shot, 1), "bias": (lambda *, fabric: {}, 1)})
    needs = {"run": "shot", "other": "bias"}
    entry = Check(fast, lambda fabric: {key: Run.of(name, fabric=fabric) for key, name in needs.items()})
    monkeypatch.setitem(CHECKS, "test.fast", entry)
    condition = Condition("velocity", "value", 100.0, within=5.0, unit="m/s")
    return Claim(
        "impact1-x", "number", "nowhere", "analytic", "ledger", "a velocity", (condition,), "test", "test.fast",
        {"fabric": "S-720"},
    )  # fmt: skip


def test_each_variant_changes_one_argument_of_the_shots(claim):
    base = variants.runs(claim)
    for name, (key, value) in VARIANTS.items():
        varied = variants.runs(claim, name)
        assert varied["run"].keywords == base["run"].keywords | {key: value}
        assert varied["other"] == base["other"]
    assert variants.varied(claim) == NAMES
    given = Run.of("shot", fabric="S-720", elements=3)
    assert variants.vary(given, ELEMENTS) == given, "a run keeps what it states itself"


def test_every_claim_on_shots_states_how_they_are_computed():
    on_shots = [entry for entry in data.load() if variants.applies(entry)]
    assert len(on_shots) >= 90
    for entry in on_shots:
        text = variants.setting(entry)
        for word in ("projectile", "cell formulation", "denier", "per crossover"):
            assert word in text, entry.id
        assert variants.varied(entry) == NAMES, entry.id
    for entry in data.load():
        if entry not in on_shots:
            assert (variants.setting(entry), variants.varied(entry)) == ("", []), entry.id


def test_runs_take_what_the_variants_change():
    """The set-up of a shot as computed and in each variant: one choice differs."""
    base = runs.setup("S-745", 100.0)
    changed = {name: runs.setup("S-745", 100.0, **dict([VARIANTS[name]])) for name in NAMES}
    assert (base.form, base.elements_per_crossover, base.projectile.bar) == ("variational", 1, None)
    assert replace(changed[FORM], form=base.form) == base
    assert changed[FORM].form == "equilibrium"
    assert replace(changed[ELEMENTS], elements_per_crossover=1) == base
    assert changed[ELEMENTS].elements_per_crossover == 2
    assert replace(changed[DENIER], fabric=base.fabric) == base
    ratio = base.fabric.weave.warp.linear_density / changed[DENIER].fabric.weave.warp.linear_density
    assert ratio == pytest.approx(3081 / 3000, rel=1e-3)  # erratum E-07
    bar = changed[BODY].projectile.bar
    assert bar.mass == pytest.approx(base.projectile.mass)
    assert replace(changed[BODY], projectile=base.projectile) == base


def test_verdicts_of_the_variants(claim, tmp_path):
    (record,) = runner.validate([claim], tmp_path, vary=True)
    assert record.verdict == judge.REPRODUCED
    assert record.found == {"velocity": 100.0}, "the claim as computed, not a variant"
    assert record.variants == {
        FORM: judge.REPRODUCED, DENIER: judge.REPRODUCED, ELEMENTS: judge.MISSED, BODY: judge.BROKEN,
    }  # fmt: skip
    text = variants.summary(record)
    assert text.startswith("holds in 3 of 5; ")
    assert f"missed with {ELEMENTS}" in text
    assert f"broken with {BODY}" in text
    assert list(variants.changes(record)) == [ELEMENTS, BODY]


def test_variants_are_kept_and_not_asked_for_twice(claim, tmp_path):
    (plain,) = runner.validate([claim], tmp_path)
    assert plain.variants == {}
    assert plain.setting
    assert variants.summary(plain) == ""
    (varied,) = runner.validate([claim], tmp_path, vary=True, resume=True)
    assert len(varied.variants) == len(VARIANTS)
    made = sorted(path.name for path in (tmp_path / runner.RUNS_FOLDER).iterdir())
    assert runner.validate([claim], tmp_path, vary=True, resume=True) == (varied,)
    assert sorted(path.name for path in (tmp_path / runner.RUNS_FOLDER).iterdir()) == made


def test_all_hold(claim):
    record = judge.Record(claim.id, judge.REPRODUCED, variants=dict.fromkeys(VARIANTS, judge.REPRODUCED))
    assert variants.summary(record) == "holds in 5 of 5"
    against = judge.Record(claim.id, judge.WRONG, variants=dict.fromkeys(VARIANTS, judge.WRONG))
    assert variants.summary(against) == "holds in 5 of 5"
    missed = judge.Record(claim.id, judge.MISSED, variants=dict.fromkeys(VARIANTS, judge.MISSED))
    assert variants.summary(missed) == "holds in 0 of 5"
    assert not variants.changes(missed)
