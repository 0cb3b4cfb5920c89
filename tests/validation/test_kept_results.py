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
from validation.ledger import runner
from validation.ledger.cache import Run
from validation.ledger.checks import CHECKS, Check
from validation.ledger.claims import Claim, Condition
from validation.scatter import pool

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
    """Of sensitivity, v50, chart, stability and the survey and trials of fidelity."""
    assert pool.results(row, [(1,), (2,)], folder=folder) == [{"number": 1}, {"number": 2}]


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


def the_crossover_study(folder, monkeypatch):
    from validation.crossover_study import study

    monkeypatch.setattr(study, "solve", lambda fabric, paths, case: row(case.size[0]))
    monkeypatch.setattr(study, "judge", lambda name, paths, chosen, results: results)
    study.run(folder, level="quick", only=["mesh"], resume=True, executor=Here())


def the_packs(folder, monkeypatch):
    from validation.packs.study import Case, Results

    def fire(case):
        made.append(case)
        return {"outcome": "stopped", "time": 1.0, "failed": [0]}

    monkeypatch.setattr(fire, "__module__", "validation.packs.study", raising=False)
    Results(folder, report=lambda *_, **__: None)(Case("S-720", 2, 50.0), fire)


def the_pencilling_study(folder, monkeypatch):
    from validation.pencilling import __main__ as command

    shot = SimpleNamespace(outcome="stopped", depth=0.0, t=np.zeros(1), balance=0.0)
    monkeypatch.setattr(command, "shoot", lambda case, **_: row(case.plies) and shot)
    monkeypatch.setattr(command, "bare", lambda: row(0) and shot)
    monkeypatch.setattr(command, "table", lambda shots: [])
    for name in ("depths", "craters"):
        monkeypatch.setattr(command.pictures, name, lambda shots, path: None)
    monkeypatch.setattr("sys.argv", ["pencilling", "4", "5", "--resume", "--out", str(folder)])
    command.main()


def the_convergence_study(folder, monkeypatch):
    from validation.convergence import __main__ as command

    def study(fabric, velocity, *, elements, known, keep, **_):
        for n in sorted(set(elements) - {one.elements for one in known}):
            made.append(n)
            keep(command.Point(fabric.name, n, 90.0, 0.1, velocity, 1.0, 1.0, "variational", 0.0))
        return ()

    monkeypatch.setattr(command, "study", study)
    monkeypatch.setattr(command, "write_csv", lambda quantities, path: None)
    monkeypatch.setattr(command, "picture", lambda quantities, path: None)
    resume = ["--resume"] if (folder / "points.json").exists() else []
    monkeypatch.setattr("sys.argv", ["convergence", "S-720", "--out", str(folder), *resume])
    command.main()


def a_history():
    from unitcell3d.history import History

    return History({"F_plate": np.ones((2, 2))}, {}, np.zeros(1))


def the_calibration(folder, monkeypatch):
    from unitcell3d import calibrate

    monkeypatch.setattr(calibrate, "run_job", lambda job: (row(job.name) and a_history(), 1.0))
    found = SimpleNamespace(write=lambda folder: None)
    monkeypatch.setattr(calibrate, "evaluate", lambda *_: found)
    choices = {"size": (2, 2, 2), "plates_size": (2, 2, 2), "executor": Here(), "resume": True}
    calibrate.calibrate(catalogue.load("S-720"), out=folder, **choices)


def the_fit_of_the_solid(folder, monkeypatch):
    from unitcell3d import fit_solid

    monkeypatch.setattr(fit_solid, "press", lambda fabric, size, pressure: row(size) and a_history())
    monkeypatch.setattr(fit_solid, "closures", lambda *_: np.zeros(3))
    fabric, pressure = catalogue.load("S-720"), np.array([1e5, 2e5, 4e5])
    presses = fit_solid._Presses(Here(), fabric, (2, 2, 2), 0.7, pressure, np.zeros(3), None, folder, True)
    presses.many([np.log([1e9, 0.1, 0.01])])


REMADE = {
    function.__name__: function
    for function in (
        the_pool, the_ledger, the_crossover_study, the_packs, the_pencilling_study, the_convergence_study,
        the_calibration, the_fit_of_the_solid,
    )
}  # fmt: skip
THREE_D = ("the_calibration", "the_fit_of_the_solid", "the_surface", "the_crossover_study")


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
    from shellfabric.cell import CellModel
    from shellfabric.panel import Panel

    return Panel(CellModel(catalogue.load("S-720").effective()).table(61), (0.0306, 0.0306))


def an_impact(path):
    from shellfabric import checkpoint
    from shellfabric.march import March

    this = panel()
    checkpoint.write(March(this, 50.0, 2e-6), path)
    return lambda: checkpoint.read(March(this, 50.0, 2e-6), path)


def a_pack(path):
    from shellfabric import pack_checkpoint
    from shellfabric.pack import Pack
    from shellfabric.pack_march import PackMarch

    pack = Pack.stacked(panel(), 2)
    pack_checkpoint.write(PackMarch(pack, 50.0, 2e-6), path)
    return lambda: pack_checkpoint.read(PackMarch(pack, 50.0, 2e-6), path)


def a_solid_patch(path):
    pytest.importorskip("gmsh")
    from shellfabric import solid_checkpoint
    from validation.solid_patch.study import march

    begun = march(count=4, size=(2, 2, 2), threads=1)
    solid_checkpoint.write(begun, path)
    return lambda: solid_checkpoint.read(begun, path)


def a_coupon(path):
    from shellfabric.cell import CellModel
    from shellfabric.relax import State
    from weavecell import coupon, coupon_record, coupon_scene

    scene, _ = coupon_scene.load(ROOT / "examples" / "coupons" / "S-728-bias.toml")
    table = CellModel(catalogue.load("S-728").effective()).table(21)
    state = State(0.5, np.zeros((3, 2)), np.zeros((3, 2)), (0.0, 0.0), np.zeros((1, 2)), 1e-6, True)
    coupon_record.write_states(path, coupon._stamp(table, scene), [state])
    assert coupon._stamp(table, replace_run(scene)) != coupon._stamp(table, scene)
    return lambda: coupon_record.read_states(path, coupon._stamp(table, scene))


def replace_run(scene):
    """The same scene with another tolerance."""
    return scene.model_copy(update={"run": scene.run.model_copy(update={"tolerance": 0.123})})


def the_surface(path):
    from unitcell3d.partial import Line, Partial

    def stamp():
        return run_cache.stamp((replace(catalogue.load("S-720")), 5), "unitcell3d.surface")

    line = Line(0, 1e-6, np.arange(3.0), np.ones((3, 5)), np.empty((0, 0)), np.empty((0, 0)), 1.5, 7)
    Partial(path, stamp(), False).add("a line", line)
    return lambda: Partial(path, stamp(), True)


REFUSED = {function.__name__: function for function in (an_impact, a_pack, a_solid_patch, a_coupon, the_surface)}


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


SHELL = ("shellfabric/march.py", "shellfabric/march_kernels.py", "shellfabric/cell.py", "fabrics/compression.py")
SOLID = ("unitcell3d/newton.py", "unitcell3d/contact_kernels.py", "meshing/crossover.py", "fabrics/solid.py")
CODE = {
    "shellfabric.impact": SHELL,
    "shellfabric.pack_impact": (*SHELL, "shellfabric/ply_contact_kernels.py", "shellfabric/pack.py"),
    "shellfabric.quasistatic": ("shellfabric/relax_kernels.py", "shellfabric/cell.py", "shellfabric/coupon.py"),
    "shellfabric.solid_march": ("shellfabric/solid_kernels.py", "shellfabric/solid_patch.py"),
    "unitcell3d.calibrate": SOLID,
    "unitcell3d.fit_solid": SOLID,
    "unitcell3d.surface": (*SOLID, "unitcell3d/surface_line.py"),
    "validation.crossover_study.cases": (*SOLID, "validation/crossover_study/ends.py"),
    "validation.charts.study": (*SHELL, *SOLID, "validation/charts/shots.py", "validation/charts/scenes.toml"),
    "validation.stability.study": (*SHELL, *SOLID, "validation/stability/bars.py"),
    "validation.scatter.sobol": (*SHELL, "validation/scatter/inputs.toml", "fabrics/catalogue/S-720.toml"),
    "validation.scatter.v50": (*SHELL, "validation/scatter/inputs.py"),
    "validation.fidelity.survey": (*SHELL, "validation/fidelity/models.py"),
    "validation.fidelity.trial": (*SHELL, "validation/fidelity/errors.json", "validation/fidelity/choose.py"),
    "validation.packs.study": (*SHELL, "shellfabric/ply_stop_kernels.py"),
    "validation.pencilling.study": (*SHELL, "shellfabric/backing.py"),
    "validation.convergence.study": (*SHELL, "shellfabric/limit.py"),
    "validation.ledger.runs": (*SHELL, "validation/bias_extension/cases.py"),
    "validation.ledger.runs_studies": (*SHELL, "validation/pencilling/study.py", "validation/solid_patch/study.py"),
    "validation.ledger.runs3d": SOLID,
    "validation.ledger.runner": (*SHELL, *SOLID, "validation/ledger/checks/impact.py"),
}


@pytest.mark.parametrize("module", CODE)
def test_the_code_of_a_result_is_what_computes_it(module):
    found = {str(file.relative_to(ROOT)) for file in run_cache.files_of(module)}
    assert set(CODE[module]) <= found
    assert "fabrics/solid.py" in found  # whose methods are used without an import
    packages = {name.split("/")[0] for name in found}
    assert "weavecell" not in packages  # a report or a picture more, and nothing is computed again
    if module.startswith(("shellfabric", "validation.scatter", "validation.fidelity")):
        assert "unitcell3d" not in packages


def test_all_that_resumes_is_here():
    """Whatever names its results by a digest of its own would go by another rule."""
    own = [
        str(path.relative_to(ROOT))
        for package in ("meshing", "unitcell3d", "shellfabric", "validation", "weavecell")
        for path in (ROOT / package).rglob("*.py")
        if any(word in path.read_text("utf-8") for word in ("hashlib", "pickle", "joblib", "diskcache"))
    ]
    assert own == ["shellfabric/compile_apart.py"]  # it keeps nothing: pickle takes a request to a child process
