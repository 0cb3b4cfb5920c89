"""What a notebook shows, run by a kernel of Jupyter as a user's is; the notebooks of docs/tutorials as they stand."""

import re
from pathlib import Path

import pytest

import weavecell as wc

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
CELLS = (
    "import weavecell as wc\nfrom weavecell.results import progress\nprogress.DELAY = 0.0",
    'shot = wc.impact("S-720", "150 m/s", opening="30 mm", end_time="15 us", elements_per_crossover=1); shot',
    "from matplotlib import pyplot; figure, axes = pyplot.subplots(); shot.plot_panel()",
    'wc.critical_velocity("S-720", tolerance="20 m/s", scan=False, residual_shots=0, opening="50 mm").plot()',
    'wc.coupon("S-720", "picture_frame", shear_angle="5 deg", crossovers=2, steps=2).plot()',
)
TUTORIALS = sorted(Path(__file__).parents[3].glob("docs/tutorials/*.ipynb"))


def outputs(notebook, folder):
    """The outputs of each cell."""
    nbclient.NotebookClient(
        notebook, timeout=3000, resources={"metadata": {"path": str(folder)}}
    ).execute()
    return [cell.get("outputs", ()) for cell in notebook.cells]


@pytest.fixture(scope="module")
def cells(tmp_path_factory):
    """[[{type: content} of each output] of each cell]"""
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in CELLS])
    return [
        [one["data"] for one in of if "data" in one]
        for of in outputs(notebook, tmp_path_factory.mktemp("n"))
    ]


@pytest.mark.slow(6)
def test_plots_show_without_a_magic_command_and_long_calls_have_a_bar(cells):
    for cell, pictures in zip(cells[2:], (2, 1, 1)):  # the figure of the user's pyplot too
        assert [len(data["image/png"]) > 5000 for data in cell if "image/png" in data] == [
            True
        ] * pictures
    for cell in (cells[1], *cells[3:]):
        assert cell[0]["text/plain"] == ""  # what is left of a bar in a saved notebook


@pytest.mark.slow(6)
def test_a_shot_shows_its_curve_and_labels_with_units(cells):
    deflection = r"largest deflection of the back face[^<]* \[mm\]</td>"
    parts = rf"<b>S-720, 150 m/s\nanswer +not decided: 148 m/s at the end.*data:image/png;base64,.*{deflection}"
    assert re.search(parts, cells[1][-1]["text/html"], re.DOTALL)


def test_a_picture_and_a_result_show_themselves():
    """What a notebook asks for, without a kernel."""
    found = wc.coupon("S-720", "picture_frame", shear_angle="5 deg", crossovers=2, steps=2)
    png = found.plot()._repr_png_()
    assert png.startswith(b"\x89PNG")
    assert len(png) > 5000
    assert "data:image/png;base64," in found._repr_html_()


def test_inputs_print_in_a_few_lines_and_lists_are_tables():
    setup = repr(wc.setup("S-728", "150 m/s", plies=4, projectile="FSP 1.10 g"))
    assert len(repr(wc.fabric("S-720"))) < 160
    assert "\n    strike_velocity=150," in setup
    assert "\n    plies=4," in setup
    assert "numerics" not in setup  # which have their defaults
    for table in (wc.fabrics(), wc.projectiles(), wc.metals(), wc.backings()):
        assert all(f"<th>{name}</th>" in table._repr_html_() for name in table.index)


def test_tables_have_marks_of_bold_in_a_terminal_only(monkeypatch):
    """A notebook asks for colours and keeps the text: 7 kB of marks in one tutorial."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "\x1b" not in repr(wc.show("S-720"))


@pytest.mark.parametrize("path", TUTORIALS)
def test_a_tutorial_keeps_small_outputs(path):
    assert path.stat().st_size < 100_000
    assert printed(nbformat.read(path, 4))


# [CPU s] of those of a minute and more, which run nightly
LONG = {"own-fabric-to-v50": 230}


def marked(path):
    """A tutorial as a case."""
    marks = [pytest.mark.slow(LONG.get(path.stem, 30))]
    if path.stem in LONG:
        marks.append(pytest.mark.nightly)
    return pytest.param(path, marks=marks, id=path.stem)


@pytest.mark.parametrize("path", [marked(path) for path in TUTORIALS])
def test_a_tutorial_prints_what_it_keeps(path, tmp_path):
    """Else: python tools/notebooks.py"""
    if path.stem not in ("first-shot", "nine-millimetre-bullet", "biaxial-tests"):
        pytest.importorskip("dolfinx")
    notebook = nbformat.read(path, 4)
    kept = printed(notebook)
    outputs(notebook, tmp_path)
    assert printed(notebook) == kept


def printed(notebook):
    """What its cells write to stdout."""
    found = [one for cell in notebook.cells for one in cell.get("outputs", ())]
    return [one.text for one in found if one.get("name") == "stdout"]
