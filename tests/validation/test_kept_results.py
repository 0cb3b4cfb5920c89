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
from validation.claims import runner
from validation.claims.checks import CHECKS, Check
from validation.claims.claims import Claim, Condition
from validation.claims.registry import Run

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


def the_ledger(folder, monkeypatch):
    monkeypatch.setattr(runner, "_registry", lambda: {"row": (row, 1)})
    check = Check(lambda one, of: {"number": one["number"]}, lambda of: {"one": Run.of("row", number=of)})
    monkeypatch.setitem(CHECKS, "test.number", check)
    claim = Claim(
        id="geom-1", kind="value", source="here", basis="analytic", origin="source", quantity="a number",
        conditions=(Condition("number", "value", 1, within=0),), check="test.number", arguments={"of": 1},
    )  # fmt: skip
    [record] = runner.validate([claim], folder, resume=True)
    assert record.verdict == "reproduced"


def a_history():
    from unitcell3d.solver.history import History

    return History({"F_plate": np.ones((2, 2))}, {}, np.zeros(1))


def the_calibration(folder, monkeypatch):
    from unitcell3d.identify import calibrate

    monkeypatch.setattr(calibrate, "run_job", lambda job: (row(job.name) and a_history(), 1.0))
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


REMADE = {function.__name__: function for function in (the_pool, the_ledger, the_calibration, the_fit_of_the_solid)}
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


def panel():
    from shellfabric.cell.model import CellModel
    from shellfabric.panel.model import Panel

    return Panel(CellModel(catalogue.load("S-720").with_effective_density()).table(61), (0.0306, 0.0306))


def an_impact(path):
    from shellfabric.output import checkpoint
    from shellfabric.solver.pack_solver import PackSolver

    this = panel()
    checkpoint.write(PackSolver(this, 50.0, 2e-6), path)
    return lambda: checkpoint.read(PackSolver(this, 50.0, 2e-6), path)


def a_pack(path):
    from shellfabric.output import checkpoint
    from shellfabric.plies.model import Pack
    from shellfabric.solver.pack_solver import PackSolver

    pack = Pack.stacked(panel(), 2)
    checkpoint.write(PackSolver(pack, 50.0, 2e-6), path)
    return lambda: checkpoint.read(PackSolver(pack, 50.0, 2e-6), path)


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
    assert coupon._stamp(table, replace_run(scene)) != coupon._stamp(table, scene)
    return lambda: results_coupon.read_states(path, coupon._stamp(table, scene))


def replace_run(scene):
    """The same scene with another tolerance."""
    return scene.model_copy(update={"run": scene.run.model_copy(update={"tolerance": 0.123})})


def the_surface(path):
    from unitcell3d.identify.surface_cache import Line, Partial

    def stamp():
        return run_cache.stamp((replace(catalogue.load("S-720")), 5), "unitcell3d.identify.response_surface")

    line = Line(0, 1e-6, np.arange(3.0), np.ones((3, 5)), np.empty((0, 0)), np.empty((0, 0)), 1.5, 7)
    Partial(path, stamp(), False).add("a line", line)
    return lambda: Partial(path, stamp(), True)


REFUSED = {function.__name__: function for function in (an_impact, a_pack, a_coupon, the_surface)}


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
HERE = "validation/verification/"
CODE = {  # the code of a result: files that are among it
    "shellfabric.impact.simulation": SHELL,
    "shellfabric.coupon.quasistatic": ("shellfabric/coupon/relaxation_kernels.py", "shellfabric/coupon/model.py"),
    "unitcell3d.identify.calibrate": SOLID,
    "unitcell3d.identify.response_surface": (*SOLID, "unitcell3d/identify/surface_line.py"),
    "validation.verification.crossover_convergence.cases": SOLID,
    "validation.verification.cost_accuracy.study": (*SHELL, *SOLID, f"{HERE}cost_accuracy/scenes.toml"),
    "validation.verification.stability.study": (*SHELL, *SOLID, f"{HERE}stability/maps.toml"),
    "weavecell.analysis.uncertainty.sobol": (*SHELL, "weavecell/analysis/uncertainty/inputs.toml"),
    "weavecell.analysis.uncertainty.v50": (*SHELL, "fabrics/catalogue/S-720.toml"),
    "validation.verification.fidelity.survey": (*SHELL, "weavecell/analysis/fidelity/ladder.py"),
    "validation.verification.fidelity.trial": (*SHELL, "weavecell/analysis/fidelity/errors.json"),
    "validation.published.packs.study": (*SHELL, "shellfabric/plies/torn_contact_kernels.py"),
    "validation.published.pencilling.study": (*SHELL, "shellfabric/backing/block.py"),
    "validation.verification.mesh_convergence.study": (*SHELL, "shellfabric/impact/ballistic_limit.py"),
    "validation.claims.runs": (*SHELL, "validation/published/bias_extension/cases.py"),
    "validation.claims.runs_studies": (*SHELL, "validation/published/pencilling/study.py"),
    "validation.claims.runs3d": SOLID,
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
