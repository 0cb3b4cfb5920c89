"""What a notebook shows, run by a kernel of Jupyter as a user's is."""

import pytest

SHOT = 'shot = wc.impact("S-720", "150 m/s", opening="30 mm", end_time="15 us", elements_per_crossover=1)'
STUDY = 'wc.critical_velocity("S-720", tolerance="20 m/s", scan=False, residual_shots=0, opening="50 mm").plot()'
COUPON = 'wc.coupon("S-720", "picture_frame", shear_angle="5 deg", crossovers=2, steps=2).plot()'
OWN = "from matplotlib import pyplot; figure, axes = pyplot.subplots(); shot.plot()"


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """[the outputs of each cell]"""
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    first = "import weavecell as wc\nfrom weavecell.results import progress\nprogress.DELAY = 0.0"
    cells = (first, SHOT, "shot.plot()", "shot.plot_panel()", STUDY, COUPON, OWN)
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    folder = str(tmp_path_factory.mktemp("notebook"))
    nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": folder}}).execute()
    return [cell.outputs for cell in notebook.cells]


def data(outputs):
    """The last displayed data of a cell, {type: content}."""
    return [output["data"] for output in outputs if "data" in output][-1]


def test_plots_show_without_a_magic_command(outputs):
    for cell in outputs[2:6]:
        assert len(data(cell)["image/png"]) > 5000
    assert sum("image/png" in output.get("data", ()) for output in outputs[6]) == 2  # the user's own figure too


def test_a_long_call_has_a_bar(outputs):
    for cell in (outputs[1], outputs[4], outputs[5]):
        assert any("application/vnd.jupyter.widget-view+json" in output.get("data", ()) for output in cell)
