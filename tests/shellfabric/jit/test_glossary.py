"""The glossary of what kernels take holds every field of every named tuple."""

from tools import glossary


def test_every_field_has_an_entry_and_is_on_the_page():
    table, tuples = glossary.table(), glossary.tuples()
    assert glossary.problems(table, tuples) == []
    assert all(
        f"| `{field}` |" in glossary.page(table, tuples)
        for fields in tuples.values()
        for field in fields
    )
