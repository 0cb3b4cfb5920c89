"""What a notebook shows, run by a kernel of Jupyter as a user's is."""

import re

import pytest

import weavecell as wc

CELLS = (
    "import weavecell as wc\nfrom weavecell.results import progress\nprogress.DELAY = 0.0",
    'shot = wc.impact("S-720", "150 m/s", opening="30 mm", end_time="15 us", elements_per_crossover=1); shot',
    "from matplotlib import pyplot; figure, axes = pyplot.subplots(); shot.plot_panel()",
    'wc.critical_velocity("S-720", tolerance="20 m/s", scan=False, residual_shots=0, opening="50 mm").plot()',
    'wc.coupon("S-720", "picture_frame", shear_angle="5 deg", crossovers=2, steps=2).plot()',
)


@pytest.fixture(scope="module")
def cells(tmp_path_factory):
    """[{type: contents} of the outputs of each cell]"""
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in CELLS])
    folder = str(tmp_path_factory.mktemp("notebook"))
    nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": folder}}).execute()
    shown = [[output["data"] for output in cell.outputs if "data" in output] for cell in notebook.cells]
    return [{kind: [one[kind] for one in of if kind in one] for data in of for kind in data} for of in shown]


def test_plots_show_without_a_magic_command_and_long_calls_have_a_bar(cells):
    for cell, pictures in zip(cells[2:], (2, 1, 1)):  # the figure of the user's pyplot too
        assert [len(picture) > 5000 for picture in cell["image/png"]] == [True] * pictures
    for cell in (cells[1], *cells[3:]):
        assert "application/vnd.jupyter.widget-view+json" in cell


def test_a_shot_shows_its_curve_and_labels_with_units(cells):
    (page,) = cells[1]["text/html"]
    assert "<b>S-720, 150 m/s: in flight, velocity at the end" in page
    assert "data:image/png;base64," in page
    assert re.search(r"largest deflection of the back face[^<]* \[mm\]</td>\s*<td>[\d.]+</td>", page)
    assert "max_deflection_m" not in page


def test_inputs_print_in_a_few_lines_and_lists_are_tables():
    setup = wc.setup("S-728", "150 m/s", plies=4, projectile="FSP 1.10 g", backing="gelatine 10 %")
    assert len(repr(wc.fabric("S-720"))) < 160
    assert len(repr(setup)) < 900
    assert re.search(r"strike_velocity=150,\n.*\bplies=4\)", repr(setup), re.DOTALL)
    assert "numerics" not in repr(setup)  # which have their defaults
    for names in (wc.fabrics(), wc.projectiles(), wc.backings()):
        assert all(f"<td>{name}</td>" in names._repr_html_() for name in names)
