"""Entry points of installed packages: what they add, and one line about each that cannot be used."""

import pytest

from fabrics.base import plugs
from fabrics.base.errors import InputError

GROUP = "weavecell.fabrics"


@pytest.fixture
def install(tmp_path, monkeypatch):
    """install(entry point, files): a package "acme" as pip leaves it."""

    def put(entry, files, group=GROUP):
        for name, text in files.items():
            (tmp_path / name).parent.mkdir(exist_ok=True)
            (tmp_path / name).write_text(text)
        info = tmp_path / "acme-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: acme\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[{group}]\n{entry}\n")
        monkeypatch.syspath_prepend(tmp_path)

    return put


def test_nothing_is_added_where_nothing_is_installed():
    assert plugs.data_files(GROUP, ()) == {}
    assert plugs.objects("weavecell.decks", (), ()) == {}


def test_each_data_file_of_a_package_is_a_name(install, tmp_path):
    weaves = {f"acme_weaves/{name}": "" for name in ("A 1.toml", "B.toml", "notes.txt")}
    install("acme = acme_weaves", weaves)
    folder = tmp_path / "acme_weaves"
    assert plugs.data_files(GROUP, {"S-720"}) == {
        "A 1": folder / "A 1.toml",
        "B": folder / "B.toml",
    }


@pytest.mark.parametrize(
    "entry, files, words",
    [
        ("acme = acme_gone", {}, "importable, which raises ModuleNotFoundError"),
        ("acme = acme_bad", {"acme_bad.py": "1 / 0"}, "importable, which raises ZeroDivisionError"),
        ("acme = acme_flat", {"acme_flat.py": ""}, r"a package whose folder holds \*.toml files"),
        ("acme = acme_empty", {"acme_empty/__init__.py": ""}, "a package whose folder holds"),
        ("acme = acme_taken", {"acme_taken/S-720.toml": ""}, '"S-720" is taken'),
    ],
)
def test_a_package_that_cannot_be_used_is_named(install, entry, files, words):
    install(entry, files)
    with pytest.raises(InputError, match=words) as caught:
        plugs.data_files(GROUP, {"S-720"})
    assert "of the installed package acme" in str(caught.value)
    assert "weavecell.fabrics.acme" in str(caught.value)


@pytest.mark.parametrize(
    "entry, words",
    [
        ("other = acme_code", "what has NAME, write"),
        ("radioss = acme_code", '"radioss" is taken'),
    ],
)
def test_a_module_that_lacks_something_or_has_a_name_of_ours_is_named(install, entry, words):
    install(entry, {"acme_code.py": "NAME = 'Other'"}, "weavecell.decks")
    with pytest.raises(InputError, match=words):
        plugs.objects("weavecell.decks", {"radioss"}, ("NAME", "write"))


def test_a_module_is_found_by_the_name_of_its_entry_point(install):
    install("other = acme_whole", {"acme_whole.py": "NAME = 'Other'"}, "weavecell.decks")
    found = plugs.objects("weavecell.decks", {"radioss"}, ("NAME",))
    assert {name: module.NAME for name, module in found.items()} == {"other": "Other"}
