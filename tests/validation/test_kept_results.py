"""What is kept for --resume, in every study and run: taken again by the same code, never by other code.

Results of runs that can be made again one by one are made again; the state of a single unfinished run is refused.
"""

from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from fabrics import catalogue, run_cache
from fabrics.errors import InputError

ROOT = Path(__file__).parents[2]
made = []


@pytest.fixture(autouse=True)
def _nothing_made():
    made.clear()


@pytest.fixture
def other_code(monkeypatch):
    """The code changes."""
    return lambda name="other": monkeypatch.setattr(run_cache, "code", lambda *modules: f"{name}{modules}" + 20 * "0")


class Here:
    """An executor that does it here and now."""

    def submit(self, function, *arguments):
        future = Future()
        future.set_result(function(*arguments))
        return future

    def map(self, function, *arguments):
        return list(map(function, *arguments))


def row(number):
    made.append(number)
    return {"number": number}


def the_pool(folder, monkeypatch):
    """Of all studies of `validation`, of sensitivity and v50."""
    assert run_cache.results(row, [(1,), (2,)], folder=folder) == [{"number": 1}, {"number": 2}]


def the_calibration(folder, monkeypatch):
    from unitcell3d.identify import calibrate
    from unitcell3d.solver.history import History

    history = History({"F_plate": np.ones((2, 2))}, {}, np.zeros(1))
    monkeypatch.setattr(calibrate, "run_job", lambda job: (row(job.name) and history, 1.0))
    found = SimpleNamespace(write=lambda folder: None)
    monkeypatch.setattr(calibrate, "evaluate", lambda *_: found)
    choices = {"size": (2, 2, 2), "plates_size": (2, 2, 2), "executor": Here(), "resume": True}
    calibrate.calibrate(catalogue.load("S-720"), out=folder, **choices)


def the_fit_of_the_solid(folder, monkeypatch):
    from fabrics.plate_curve import PlateCurve
    from unitcell3d.identify import chain

    monkeypatch.setattr(chain, "fit_solid", lambda fabric, *_: row(fabric.name))
    fabric = catalogue.load("S-720")
    curve = PlateCurve.pressure_law(fabric.areal_density_measured)
    assert chain.fit_solids([fabric], [curve], folder=folder, executor=Here()) == [{"number": "S-720"}]


REMADE = {function.__name__: function for function in (the_pool, the_calibration, the_fit_of_the_solid)}
THREE_D = ("the_calibration", "the_fit_of_the_solid", "the_surface")


@pytest.mark.parametrize("name", REMADE)
def test_results_of_other_code_are_computed_again(name, tmp_path, monkeypatch, other_code):
    if name in THREE_D:
        pytest.importorskip("dolfinx")
    REMADE[name](tmp_path, monkeypatch)
    first = list(made)
    assert first
    REMADE[name](tmp_path, monkeypatch)
    assert made == first  # nothing made again
    other_code()
    REMADE[name](tmp_path, monkeypatch)
    assert made == first + first
    REMADE[name](tmp_path, monkeypatch)
    assert made == first + first


def an_impact(path):
    from shellfabric.cell.model import CellModel
    from shellfabric.output import checkpoint
    from shellfabric.panel.model import Panel
    from shellfabric.solver.pack_solver import PackSolver

    panel = Panel(CellModel(catalogue.load("S-720").with_effective_density()).table(61), (0.0306, 0.0306))
    checkpoint.write(PackSolver(panel, 50.0, 2e-6), path)
    return lambda: checkpoint.read(PackSolver(panel, 50.0, 2e-6), path)


def a_coupon(path):
    from shellfabric.cell.model import CellModel
    from shellfabric.coupon.dynamic_relaxation import State
    from weavecell.commands import coupon
    from weavecell.results import coupon as results_coupon
    from weavecell.scenes import coupon as scenes_coupon

    scene, _ = scenes_coupon.load(ROOT / "examples" / "coupons" / "S-728-bias.toml")
    table = CellModel(catalogue.load("S-728").with_effective_density()).table(21)
    state = State(0.5, np.zeros((3, 2)), np.zeros((3, 2)), (0.0, 0.0), np.zeros((1, 2)), 1e-6, True)
    results_coupon.write_states(path, coupon._stamp(table, scene), [state])
    other = scene.model_copy(update={"run": scene.run.model_copy(update={"tolerance": 0.123})})
    assert coupon._stamp(table, other) != coupon._stamp(table, scene)
    return lambda: results_coupon.read_states(path, coupon._stamp(table, scene))


def the_surface(path):
    from unitcell3d.identify.surface_cache import Line, Partial

    def stamp():
        return run_cache.stamp((replace(catalogue.load("S-720")), 5), "unitcell3d.identify.response_surface")

    line = Line(0, 1e-6, np.arange(3.0), np.ones((3, 5)), np.empty((0, 0)), np.empty((0, 0)), 1.5, 7)
    Partial(path, stamp(), False).add("a line", line)
    return lambda: Partial(path, stamp(), True)


REFUSED = {function.__name__: function for function in (an_impact, a_coupon, the_surface)}


@pytest.mark.parametrize("name", REFUSED)
def test_the_state_of_a_run_of_other_code_is_refused(name, tmp_path, other_code):
    if name in THREE_D:
        pytest.importorskip("dolfinx")
    path = tmp_path / "checkpoint.h5"
    read = REFUSED[name](path)
    read()
    before = run_cache.version("fabrics.yarn").split()[0]
    other_code("fedcba")
    with pytest.raises(InputError, match=r"checkpoint\.h5") as caught:
        read()
    message = str(caught.value)
    assert "\n" not in message
    assert "(code fedcba" in message  # this version
    assert message.count(f"{before} (code ") == 2  # and that of the file


ANALYSES = ("weavecell/__init__.py", "weavecell/analysis/")
SHELL = ("shellfabric/solver/step_kernels.py", "shellfabric/cell/model.py", "shellfabric/plies/contact_kernels.py")
SOLID = ("unitcell3d/solver/newton.py", "unitcell3d/contact/surface_contact_kernels.py", "meshing/crossover.py")
CODE = {  # the code of a result: files that are among it
    "shellfabric.impact.simulation": SHELL,
    "unitcell3d.identify.response_surface": (*SOLID, "unitcell3d/identify/surface_line.py"),
    "weavecell.analysis.uncertainty.v50": (*SHELL, "fabrics/catalogue/S-720.toml"),
    "validation.verification.fidelity.trial": (*SHELL, "weavecell/analysis/fidelity/errors.json"),
    "validation.claims.runner": (*SHELL, *SOLID, "validation/claims/checks/impact.py"),
}


@pytest.mark.parametrize("module", CODE)
def test_the_code_of_a_result_is_what_computes_it(module):
    found = {str(file.relative_to(ROOT)) for file in run_cache.files_of(module)}
    assert set(CODE[module]) <= found
    assert "fabrics/solid.py" in found  # whose methods are used without an import
    packages = {name.split("/")[0] for name in found}
    # a report or a picture more, and nothing is computed again
    assert not any(name.startswith("weavecell/") and not name.startswith(ANALYSES) for name in found)
    if module.startswith(("shellfabric", "weavecell.analysis.uncertainty", "weavecell.analysis.fidelity")):
        assert "unitcell3d" not in packages


@pytest.mark.parametrize(("name", "again"), [("step_kernels.py", True), ("pictures.py", False)])
def test_a_study_is_run_again_after_a_change_of_a_kernel_and_not_of_a_picture(monkeypatch, name, again):
    def key():
        return run_cache.code.__wrapped__("validation.verification.mesh_convergence.study")

    before, read = key(), Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda self: read(self) + b"# changed\n" * (self.name == name))
    assert (key() != before) == again
