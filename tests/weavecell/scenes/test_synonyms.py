"""A word that users have for a key is answered with the key of its own table, not with another table."""

import pytest

from fabrics.base import schema
from fabrics.base.errors import InputError
from fabrics.fabric_tables import YarnTable
from tests.scene_text import merged
from tests.weavecell.scenes.test_keys_reach import LEAST, SHOT
from weavecell.scenes.impact import Scene, check

TABLES = {name: table for name, table in schema.tables(Scene).items() if table.synonyms}
SLIPS = [(name, word) for name, table in TABLES.items() for word in table.synonyms]


@pytest.mark.parametrize("name, word", SLIPS)
def test_a_synonym_is_answered_with_its_key(name, word):
    table = TABLES[name]
    assert word not in table.model_fields
    assert table.synonyms[word] in table.model_fields
    scene = merged(SHOT, {name: LEAST.get(name, {}) | {word: "3 mm"}})
    with pytest.raises(InputError) as refused:
        check(scene, "scene.toml")
    (line,) = [part for part in str(refused.value).splitlines() if f"{name}.{word}" in part]
    assert f'did you mean "{table.synonyms[word]}"?' in line
    assert "it is a key of" not in line


def test_words_of_a_yarn_are_keys_of_a_yarn():
    assert set(YarnTable.synonyms.values()) <= set(YarnTable.model_fields)
    assert {"backing", "projectile", "panel", "fabric", "run"} <= set(TABLES)
