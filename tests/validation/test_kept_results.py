"""What is kept for --resume, in every study and run: taken again by the same code, never by other code.

Results of runs that can be made again one by one are made again; the state of a single unfinished run is refused.
"""

from pathlib import Path

import pytest

from fabrics import catalogue
from fabrics.base import run_cache
from fabrics.base.errors import InputError
from shellfabric.cell.model import CellModel
from shellfabric.output import checkpoint
from shellfabric.panel.model import Panel
from shellfabric.solver.pack_solver import PackSolver

ROOT = Path(__file__).parents[2]


def change_code(monkeypatch, name):
    monkeypatch.setattr(run_cache, "code", lambda *modules: f"{name}{modules}" + 20 * "0")


def test_results_of_other_code_are_computed_again(tmp_path, monkeypatch):
    computed = []

    def square(number):
        computed.append(number)
        return {"number": number * number}

    def results():
        assert run_cache.results(square, [(1,), (2,)], folder=tmp_path) == [
            {"number": 1},
            {"number": 4},
        ]
        return computed

    assert results() == [1, 2]
    assert results() == [1, 2]  # nothing again
    change_code(monkeypatch, "other")
    assert results() == [1, 2, 1, 2]
    assert results() == [1, 2, 1, 2]


def test_the_state_of_a_run_of_other_code_is_refused(tmp_path, monkeypatch):
    panel = Panel(
        CellModel(catalogue.load("S-720").with_effective_density()).table(61), (0.03048, 0.03048)
    )
    solver = PackSolver(panel, 50.0, 2e-6)
    path = tmp_path / "checkpoint.h5"
    checkpoint.write(solver, path)
    checkpoint.read(solver, path)
    before = run_cache.version("fabrics.yarn").split()[0]
    change_code(monkeypatch, "fedcba")
    with pytest.raises(InputError, match=r"checkpoint\.h5") as caught:
        checkpoint.read(solver, path)
    message = str(caught.value)
    assert "\n" not in message
    assert "(code fedcba" in message  # this version
    assert message.count(f"{before} (code ") == 2  # and that of the file


@pytest.mark.parametrize("name, again", [("loop.py", True), ("pictures.py", False)])
def test_a_study_is_run_again_after_a_change_of_a_kernel_and_not_of_a_picture(
    monkeypatch, name, again
):
    def key():
        return run_cache.code.__wrapped__("validation.runner")

    before = key()
    read = Path.read_bytes
    monkeypatch.setattr(
        Path, "read_bytes", lambda self: read(self) + b"# changed\n" * (self.name == name)
    )
    assert (key() != before) == again
