"""The fields of the schema say how Python gives them; keywords, dicts and what a file can hold follow from that."""

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from fabrics.base.schema import AsDict, AsKeywords, FileOnly, MayBeObject, mark, marked, tables_in
from weavecell.api import keywords
from weavecell.scenes import impact, scene_text
from weavecell.scenes.fabric_table import FabricTable
from weavecell.scenes.impact import Scene
from weavecell.scenes.panel import PanelTable

TABLES = [name for name, entry in Scene.model_fields.items() if [*tables_in(entry.annotation)]]


@pytest.mark.parametrize("name", TABLES)
def test_a_table_is_keywords_or_a_dict(name):
    entry = Scene.model_fields[name]
    ways = [kind for kind in (AsKeywords, AsDict) if mark(entry, kind)]
    assert len(ways) == 1


@pytest.mark.parametrize("name", TABLES)
def test_every_key_of_a_table_reaches_the_scene_or_is_for_files_alone(name):
    for key, field in scene_text.fields_of(Scene, name).items():
        if mark(field, FileOnly):
            assert keywords.tables().get(key) != name
        elif mark(Scene.model_fields[name], AsKeywords):
            assert keywords.tables()[key] == name
        else:
            assert keywords.tables()[name] == ""


def test_the_standard_shot_is_a_whole_input_file_beside_a_fabric():
    scene = impact.check({"fabric": {"name": "S-720"}, **impact.standard_shot()}, None)
    assert scene.projectile.mass == 3e-3
    assert scene.projectile.strike_velocity == 92.5
    assert scene.panel.opening == 0.203


def test_a_fabric_alone_is_struck_by_the_projectile_of_the_standard_shot():
    scene, table = keywords.scene("S-720", "120 m/s", {}, "setup", "setup")
    standard = impact.standard_shot()
    assert table["panel"] == standard["panel"]
    assert table["projectile"] == standard["projectile"] | {"strike_velocity": "120 m/s"}
    assert scene.projectile.strike_velocity == 120.0


@pytest.mark.parametrize("name", marked(FabricTable, MayBeObject) | marked(PanelTable, MayBeObject))
def test_no_file_says_what_an_object_is(name):
    table = {"fabric": {}, "panel": {"opening": "40 mm"}, "run": {}, "projectile": {}}
    assert scene_text.text(table, "S-720")
    table[keywords.tables()[name]][name] = object()
    assert scene_text.text(table, "S-720") == ""


@pytest.mark.parametrize(
    "options, field",
    [({"projectile": "FSP 1.10 g"}, "projectile"), ({"backing": "gelatine 10 %"}, "backing")],
)
def test_a_name_in_place_of_a_dict_is_the_key_that_names_its_data(options, field):
    entry = Scene.model_fields[field]
    named = wc.setup("S-720", 100.0, **options)
    given = wc.setup("S-720", 100.0, **{field: {mark(entry, AsDict).named_by: options[field]}})
    assert getattr(named, field) == getattr(given, field)


@pytest.mark.parametrize(
    "key", ["strike_velocity", "checkpoint_interval", "outputs", "linear_density"]
)
def test_a_key_for_files_alone_is_no_keyword(key):
    with pytest.raises(InputError, match=f"^{key}"):
        wc.setup("S-720", 100.0, **{key: "1"})
