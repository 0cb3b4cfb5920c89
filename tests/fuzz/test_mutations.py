"""Some of the mutated inputs of `mutations`, and the parts of `kills`."""

import pytest

from tests.fuzz import kills, mutations


def test_mutated_inputs_have_no_defect():
    found = [
        (mutant.base, mutant.what, fault) for mutant, fault, _ in mutations.run(60, 7) if fault
    ]
    assert found == []


@pytest.mark.parametrize("name", mutations.BASES)
def test_inputs_as_they_are_are_accepted_without_a_note(name, tmp_path, monkeypatch):
    """So that a note about a mutant is about its mutation."""
    monkeypatch.chdir(tmp_path)
    mutant = mutations.Mutant(name, "none", mutations.BASES[name][1], "")
    fault, code = mutations.judge(mutant, tmp_path)
    assert (fault, code) == ("", 0)


def test_what_is_accepted_without_a_word_is_found(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mutant = mutations.Mutant("shot", "none", mutations.SHOT, "word")
    assert mutations.judge(mutant, tmp_path) == ("accepted without a word", 0)


@pytest.mark.nightly
@pytest.mark.slow(90)
def test_commands_that_end_at_random_are_made_whole():
    assert kills.main(["--seed", "5", "--count", "20"]) == 0
