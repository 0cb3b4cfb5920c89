"""The glossary of what kernels take holds every field of every named tuple; its page is up to date."""

from tools import glossary


def test_every_field_has_an_entry_and_is_on_the_page():
    """Else: python tools/glossary.py"""
    table, tuples = glossary.table(), glossary.tuples()
    assert glossary.problems(table, tuples) == []
    assert (glossary.ROOT / glossary.PAGE).read_text("utf-8") == glossary.page(table, tuples)
