"""The command line that studies share: options are the parameters of a main function."""

import importlib
import re
import shlex
import sys
from collections.abc import Sequence
from inspect import signature
from pathlib import Path
from typing import Literal

import pytest

from fabrics.errors import InputError
from validation import program

ROOT = Path(__file__).parents[2]


def study(
    fabrics: Sequence[str] = ("S-720", "S-728"),
    *,
    out: Path = Path("results"),
    page: Path | None = None,
    edge: Literal["clamped", "free"] = "clamped",
    size: tuple[int, int, int] = (5, 5, 2),
    mu: Sequence[float] | None = None,
    end_time: float = 42.0,
    no_bare: bool = False,
) -> None:
    """A study that is not run."""


def one_file(chain: Path, fabric: str = "S-720") -> None:
    """One that needs a folder."""


def read(text, main=study):
    main.__globals__["__spec__"].name = "validation.made_up.__main__"
    return program.options(main, {"size": "100 % of it"}, text.split())


@pytest.fixture(autouse=True)
def named():
    before = __spec__.name
    yield
    __spec__.name = before


DEFAULTS = {
    "fabrics": ("S-720", "S-728"), "out": Path("results"), "page": None, "edge": "clamped", "size": (5, 5, 2),
    "mu": None, "end_time": 42.0, "no_bare": False,
}  # fmt: skip


@pytest.mark.parametrize(
    ("main", "text", "expected"),
    [
        (study, "", DEFAULTS),
        (study, "S-731 --page docs/a.md --edge free --out x", DEFAULTS | {
            "fabrics": ["S-731"], "page": Path("docs/a.md"), "edge": "free", "out": Path("x")}),
        (study, "--size 4 4 1 --mu 0.2 inf --end-time 6 --no-bare", DEFAULTS | {
            "size": [4, 4, 1], "mu": [0.2, float("inf")], "end_time": 6.0, "no_bare": True}),
        (one_file, "results/chain S-728", {"chain": Path("results/chain"), "fabric": "S-728"}),
    ],
)  # fmt: skip
def test_values_are_of_the_types_of_the_annotations(main, text, expected):
    assert read(text, main) == expected


@pytest.mark.parametrize(
    ("main", "wrong"),
    [(study, "--edge loose"), (study, "--size 4 4"), (study, "--end-time soon"), (study, "--seed 1"), (one_file, "")],
)
def test_wrong_or_missing_values_are_refused(main, wrong, capsys):
    with pytest.raises(SystemExit) as caught:
        read(wrong, main)
    assert caught.value.code == 2
    assert "error: " in capsys.readouterr().err


def test_bad_input_is_one_line(monkeypatch, capsys):
    def fails(*, out: Path = Path("results")) -> None:
        raise InputError("there is no such folder", file=out)

    monkeypatch.setattr(sys, "argv", ["study"])
    with pytest.raises(SystemExit) as caught:
        program.program(fails)
    assert caught.value.code == InputError("").exit_code == 2
    assert capsys.readouterr().err.count("\n") == 1


def documented():
    """[(module, options)] of the commands that the documentation prints with options."""
    texts = [path.read_text("utf-8") for path in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]]
    commands = {line for text in texts for line in re.findall(r"python -m (validation\.[^`#\n]*)", text)}
    split = [tuple(shlex.split(command)) for command in commands]
    return sorted((name, words) for name, *words in split if words)


@pytest.mark.parametrize(("name", "words"), documented())
def test_commands_of_the_documentation_are_understood(name, words):
    """Nothing is run."""
    folder = ROOT.joinpath(*name.split("."))
    try:
        module = importlib.import_module(f"{name}.__main__" if folder.is_dir() else name)
    except ModuleNotFoundError as problem:
        if problem.name not in ("dolfinx", "gmsh"):
            raise
        pytest.skip(f"needs {problem.name}")
    assert set(program.options(module.main, {}, words)) == set(signature(module.main).parameters)
