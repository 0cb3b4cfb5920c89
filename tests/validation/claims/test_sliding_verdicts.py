"""Claims checked with sliding crossovers: which are chosen, what the option changes, and the table of verdicts."""

from types import SimpleNamespace

import pytest

from fabrics.errors import InputError
from validation.claims import claims as data
from validation.claims import runs, sliding, variants
from validation.claims.judge import MISSED, REPRODUCED, Record
from validation.claims.registry import Run


def test_the_rule_chooses_shots_that_sliding_crossovers_allow():
    of = sliding.chosen(data.load())
    names = {claim.id for claim in of}
    assert len(of) > 70
    assert {"impact1-s726-test-96", "impact1-s726-test-110"} <= names
    assert not {"slip-36", "cell-bending-option"} & names  # slipping sides, bending of yarns
    for claim in of:
        base, slid = variants.runs(claim), variants.runs(claim, sliding.OPTION)
        assert base != slid
        for name, run in slid.items():
            added = set(run.keywords) - set(base[name].keywords)
            assert added == ({"crossovers"} if run.name in variants.SHOTS else set())
    fewer = sliding.chosen(data.load(), 0)
    assert all(run.name != "limit" for claim in fewer for run in variants.runs(claim).values())


def test_the_option_reaches_the_set_up():
    run = variants.vary(Run.of("shot", fabric="S-726", velocity=100.0), sliding.OPTION)
    assert runs.setup(**run.keywords).crossovers.mu == 0.2
    assert runs.setup("S-726", 100.0).crossovers is None
    with pytest.raises(InputError, match="with sliding crossovers"):
        runs.setup("S-726", 100.0, crossovers=0.2, elements=2).panel()


def test_it_is_no_variant_of_the_ledger():
    assert sliding.OPTION not in variants.VARIANTS
    assert not {key for key, _ in variants.OPTIONS.values()} & {key for key, _ in variants.VARIANTS.values()}


def test_the_table_has_the_verdicts_that_change():
    claim, other = SimpleNamespace(id="one"), SimpleNamespace(id="two")
    rows = [
        (claim, Record("one", MISSED, text="120 m/s"), Record("one", REPRODUCED, text="110 | m/s")),
        (other, Record("two", REPRODUCED), Record("two", REPRODUCED)),
    ]
    text = sliding.table(rows, 5, "python -m x")
    assert "2 claims of shots at one ply were checked with mu = 0.2; 5 others" in text
    assert "1 verdicts change, 1 of them to one that holds." in text
    assert "| `one` | missed | reproduced | 120 m/s | 110 / m/s |" in text
    assert "`two`" not in text
