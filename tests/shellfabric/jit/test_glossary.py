"""The glossary of what kernels take holds every field of every named tuple, and no other; its page is up to date."""

from tools import glossary


def test_every_field_has_an_entry():
    assert glossary.problems(glossary.table(), glossary.tuples()) == []


def test_the_page_is_up_to_date():
    """Else: python tools/glossary.py"""
    text = glossary.page(glossary.table(), glossary.tuples())
    assert (glossary.ROOT / glossary.PAGE).read_text("utf-8") == text
