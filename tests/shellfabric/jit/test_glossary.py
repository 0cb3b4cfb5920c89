"""The glossary of what kernels take holds every field of every named tuple, and no other; its page is up to date."""

import pytest

from tools import glossary


def test_every_field_has_an_entry():
    assert glossary.problems(glossary.table(), glossary.tuples()) == []


def test_all_named_tuples_are_found():
    found = glossary.tuples()
    assert len(found) == 12
    assert {"panel.arrays.State", "plies.arrays.Pair", "validation.models.cable.model.Constants"} <= set(found)
    assert found["panel.arrays.State"][:2] == ["u", "v"]


def test_the_page_is_up_to_date():
    """Else: python tools/glossary.py"""
    text = glossary.page(glossary.table(), glossary.tuples())
    assert (glossary.ROOT / glossary.PAGE).read_text("utf-8") == text


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("State = namedtuple('State', 'u v')", ["new.State.v has no entry"]),
        ("State = namedtuple('State', 'v')", ["new.State.u is in the table alone", "new.State.v has no entry"]),
        ("", ["new.State.u is in the table alone"]),
        ("State = namedtuple('State', 'u')\nPair = namedtuple('Pair', 'a')", ["new.Pair.a has no entry"]),
    ],
)
def test_planted_fields_are_found(tmp_path, text, told):
    (tmp_path / "shellfabric").mkdir()
    (tmp_path / "shellfabric" / "new.py").write_text(text)
    entries = {"terms": {}, "new.State": {"u": ["(n,)", "m", "displacement"]}}
    assert glossary.problems(entries, glossary.tuples(tmp_path)) == told


@pytest.mark.parametrize("row", [["(n,)", "m"], ["(n,)", "", "displacement"], "displacement"])
def test_incomplete_entries_are_found(row):
    [told] = glossary.problems({"terms": {}, "new.State": {"u": row}}, {"new.State": ["u"]})
    assert told == "new.State.u is to have shape, unit and meaning"
