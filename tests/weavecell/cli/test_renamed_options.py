"""Old spellings on the command line are accepted with a warning; options without effect are refused."""

import pytest
import typer

from weavecell.cli import app, renamed_options
from weavecell.cli.crossover import _OF_ALL, _OF_CASE, Case, Part
from weavecell.cli.mesh_calibrate_surface import Domain

COMMANDS = typer.main.get_command(app.app).commands


def options(command):
    """{option: click parameter} of a command."""
    return {name: entry for entry in COMMANDS[command].params for name in entry.opts}


def test_the_tables_name_commands_and_options_of_today():
    assert set(renamed_options.COMMANDS.values()) <= set(COMMANDS)
    assert not set(renamed_options.COMMANDS) & set(COMMANDS)
    for command, names in renamed_options.OPTIONS.items():
        assert set(names.values()) <= set(options(command))
        assert not set(names) & set(options(command))
    choices = {("mesh", "--domain"): Domain, ("crossover", "--domain"): Part, ("crossover", "--case"): Case}
    for (command, option), names in renamed_options.VALUES.items():
        assert option in options(command)
        if option == "--executor":
            today = set(options(command)[option].metavar.split("|"))
        else:
            today = {choice.value for choice in choices[command, option]}
        assert set(names.values()) <= today
        assert not set(names) & today


@pytest.mark.parametrize(
    ("words", "new", "warnings"),
    [
        (["mesh", "S-720", "--size", "fine"], ["mesh", "S-720", "--mesh", "fine"], ["--size"]),
        (["mesh", "S-720", "--gap=1 um"], ["mesh", "S-720", "--yarn-gap=1 um"], ["--gap"]),
        (["mesh", "--domain", "four", "S"], ["mesh", "--domain", "periodic", "S"], ["--domain four"]),
        (["mesh", "--domain=four", "S"], ["mesh", "--domain=periodic", "S"], ["--domain four"]),
        (["chart", "--all"], ["cost-accuracy", "--all"], ["chart"]),
        (["crossover", "plates", "--case", "plates"], ["crossover", "plates", "--case", "platens"], ["--case plates"]),
        (["biaxial", "S", "--crossover", "fine"], ["biaxial", "S", "--compare-3d", "fine"], ["--crossover"]),
        (["v50", "S", "--shape", "9"], ["v50", "S", "--weibull-shape", "9"], ["--shape"]),
        (["critical-velocity", "S", "--workers=2"], ["critical-velocity", "S", "--jobs=2"], ["--workers"]),
        (["v50", "S", "--pool", "processes"], ["v50", "S", "--executor", "local"], ["--pool", "--executor processes"]),
        (["impact", "--gap"], ["impact", "--gap"], []),
        ([], [], []),
    ],
)
def test_old_spellings_become_those_of_today(words, new, warnings, capsys):
    assert renamed_options.upgraded(words) == new
    lines = capsys.readouterr().err.splitlines()
    assert [line.removeprefix("warning: ").split(" is now called ")[0] for line in lines] == warnings


def test_an_old_option_runs_and_warns(command):
    code, _, err = command("mesh", "S-720", "--size", "huge")
    assert code == 2
    warning, error = err.splitlines()
    assert warning == "warning: --size is now called --mesh; the old name is accepted until the next release"
    assert error.startswith("error: --mesh = 'huge'")


def test_old_options_are_in_no_help(command):
    for name, names in renamed_options.OPTIONS.items():
        shown = command(name, "--help")[1].replace("│", " ").split()
        assert not set(names) & set(shown), name


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("impact s.toml --explain --out r", "--out: must be left out with --explain, which runs and writes nothing"),
        (
            "impact s.toml --explain --strict",
            "--strict: must be left out with --explain, which runs and writes nothing",
        ),
        ("crossover S-720 --case platens --failure", "--failure: must be left out with --case platens"),
        ("crossover S-720 --case platens --plies 2", "--plies: must be left out with --case platens"),
        ("crossover S-720 --case yarn --friction 0.2", "--friction: must be left out with --case yarn"),
        ("crossover S-720 --case biaxial --shear-angle 1rad", "--shear-angle: must be left out with --case biaxial"),
        ("crossover S-720 --case shear --bars 0", "--bars: must be left out with --case shear"),
        ("cost-accuracy --scene struck-yarn --level fine", "--level: must be left out without --scene crossover"),
        ("cost-accuracy --all --jobs 1", "--jobs: must be left out without --scene crossover"),
        ("cost-accuracy --scene crossover --quick", "--quick: must be left out with --scene crossover"),
    ],
)
def test_an_option_without_effect_is_refused(command, tmp_path, words, line):
    assert command(*words.split()) == (2, "", f"error: {line}\n")
    assert list(tmp_path.iterdir()) == []


def test_every_option_of_crossover_belongs_to_a_case():
    every = {entry.name for entry in COMMANDS["crossover"].params} - {"help"}
    assert set(_OF_CASE) == set(Case)
    assert set(_OF_ALL) | {name for names in _OF_CASE.values() for name in names} == every
