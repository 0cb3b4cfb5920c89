"""The command line: help with an example on every command, a fast start, version, exit codes, the catalogue."""

import csv
import inspect
import re
import subprocess
import sys
from operator import attrgetter

import pytest
import typer

import weavecell
from fabrics import backings, catalogue, metals, projectiles
from fabrics.base.errors import InputError
from tests.scene_text import merged, toml
from tests.weavecell.session_runs import SCENES
from weavecell.api import gone
from weavecell.cli import app, from_signature


def commands(group, words=()):
    """(words, click command) of a group and of all below it."""
    yield words, group
    for name, below in getattr(group, "commands", {}).items():
        yield from commands(below, (*words, name))


def in_a_program(code, *words):
    """What a fresh Python prints."""
    return subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True)


def test_help_has_an_example_and_keeps_its_brackets(command, monkeypatch):
    """Rich takes [word] for a style; each one of a help text must be one, or be escaped and so be shown."""
    monkeypatch.setenv("COLUMNS", "200")
    found = 0
    for words, one in commands(typer.main.get_command(app.program())):
        code, shown, _ = command(*words, "--help")
        shown = " ".join(shown.split())
        assert code == 0, words
        assert "Example: weavecell" in shown, words
        texts = [one.help, one.epilog, *(getattr(entry, "help", None) for entry in one.params)]
        for text in filter(None, texts):
            for escape, inside in re.findall(r"(\\?)\[([^\]]*)\]", text):
                assert escape or inside in ("bold", "/bold"), f"{' '.join(words)}: [{inside}]"
                if escape:
                    assert f"[{inside}]" in shown, f"{' '.join(words)}: [{inside}]"
                    found += 1
    assert found >= 6


@pytest.mark.parametrize("option, least", [("seed", 0), ("jobs", 1)])
def test_a_command_takes_the_numbers_that_its_function_takes(command, option, least):
    """The least one, and none below; nothing is run."""
    options = {"shots": 4, "check": True}
    weavecell.v50("S-720", **{option: least}, **options)
    assert command("v50", "S-720", "--check", "--shots", "4", f"--{option}", str(least))[0] == 0
    assert command("v50", "S-720", "--check", "--shots", "4", f"--{option}", str(least - 1))[0] == 2
    with pytest.raises(InputError, match=option):
        weavecell.v50("S-720", **{option: least - 1}, **options)


@pytest.mark.parametrize(
    "name, given, folder",
    [
        ("impact", {"target": "scenes/shot.toml"}, "shot"),
        ("coupon", {"target": "frame.toml"}, "frame"),
        ("v50", {"target": "scenes/shot.toml"}, "v50-shot"),
        ("critical-velocity", {"target": "S-720"}, "critical-velocity-S-720"),
        ("compare", {"target": "a.toml", "other": "old/b.toml"}, "compare-a-b"),
        ("sweep", {"target": "shot.toml"}, "sweep-shot"),
        ("calibrate", {"fabric": "mine.toml"}, "calibrate-mine"),
    ],
)
def test_the_folder_of_a_study_is_named_after_it_and_what_it_is_given(name, given, folder):
    """That of a single run after its input file alone."""
    function = getattr(weavecell, name.replace("-", "_"))
    parameters = inspect.signature(function).parameters.values()
    values = dict.fromkeys((parameter.name for parameter in parameters), None) | given
    found = from_signature._folder(name, parameters, values)
    assert found.parts == ("results", folder)


def test_all_commands_are_listed_with_what_they_do(command, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    lines = [line.strip(" │") for line in command("--help")[1].splitlines()]
    for name, one in typer.main.get_command(app.program()).commands.items():
        assert any(
            line.split(None, 1) == [name, " ".join(one.help.split("\n\n")[0].split())]
            for line in lines
        ), name


def test_the_options_of_a_command_are_the_parameters_of_its_function():
    root = typer.main.get_command(app.program())
    for words, (public_name, _, *keywords) in app.COMMANDS.items():
        function = app.find_function(public_name)
        command = root
        for word in words.split():
            command = command.commands[word]
        parameters = inspect.signature(function).parameters.values()
        own = {p.name for p in parameters if p.kind is not p.VAR_KEYWORD}
        own |= {p.name for p in from_signature.unpack_keywords(function, {})} | set(keywords)
        options = {entry.name for entry in command.params} - {"strict", "verbose"}
        assert own >= options >= own - {"test", "velocity"}, words
        assert all(entry.help for entry in command.params), words
        assert attrgetter(public_name)(weavecell) is function


def test_version(command):
    assert command("--version")[:2] == (0, f"weavecell {weavecell.__version__}\n")


BRIEF = {
    "panel": {"opening": "20 mm"},
    "run": {"end_time": "10 us", "outputs": []},
    "projectile": {"strike_velocity": "150 m/s"},
}
HEAVY = {"dolfinx", "pyvista", "vtkmodules", "matplotlib", "pandas", "scipy.stats", "h5py", "pint"}


def test_the_package_is_loaded_without_what_it_may_not_need():
    done = in_a_program(
        f"import sys, weavecell\nprint(sorted({HEAVY | {'numba'}} & set(sys.modules)))"
    )
    assert done.stdout.strip() == "[]"


def test_a_shot_without_pictures_loads_no_plotter_and_no_statistics(tmp_path):
    """Units of the catalogue and of ranges need no pint."""
    (tmp_path / "scene.toml").write_text(toml(merged(SCENES["limit"], BRIEF)))
    done = in_a_program(
        "import sys\nfrom weavecell.cli import app\n"
        f"try: app.main(['impact', '{tmp_path}/scene.toml', '--out', '{tmp_path}/r'])\n"
        "except SystemExit: pass\n"
        f"print(sorted(({HEAVY} - {{'h5py'}}) & set(sys.modules)))"
    )
    assert (tmp_path / "r" / "summary.json").exists()
    assert done.stdout.strip().endswith("[]")


def test_as_module_and_without_heavy_imports():
    """`python -m weavecell --help` works, and help must not wait for a solver or a plotter to load."""
    done = subprocess.run(
        [sys.executable, "-m", "weavecell", "--help"], capture_output=True, text=True, check=True
    )
    assert "unit cell, calibration, impact" in done.stdout
    done = in_a_program(
        "import sys\nfrom weavecell.cli import app\n"
        "for words in (['--help'], *([*name.split(), '--help'] for name in app.COMMANDS)):\n"
        "    try: app.main(words)\n"
        "    except SystemExit: pass\n"
        f"print(sorted({HEAVY | {'numba'}} & set(sys.modules)))"
    )
    assert done.stdout.strip().endswith("[]")


@pytest.mark.parametrize("words", ["--help", "--version", "impcat"])
def test_words_that_call_no_command_load_none(words):
    """Neither its function nor what all of them share, such as numbers of fabrics."""
    done = in_a_program(
        "import sys\nfrom weavecell.cli import app\n"
        f"try: app.main(['{words}'])\n"
        "except SystemExit: pass\n"
        "late = ('scipy', 'weavecell.api.', 'shellfabric', 'fabrics.families')\n"
        "print(sorted(name for name in sys.modules if name.startswith(late)))"
    )
    assert done.stdout.strip().endswith("[]")


def test_the_log_is_plain_whatever_a_library_sets_up():
    code = "import logging\nlogging.basicConfig()\nfrom weavecell.cli import app\n"
    code += "app.program = lambda _: lambda **_: logging.getLogger('weavecell').warning('compiling')\napp.main([])"
    assert in_a_program(code).stderr == "compiling\n"


@pytest.mark.parametrize(
    "kind, module, some",
    [
        ("fabrics", catalogue, ["S-720", "252.904"]),
        (
            "projectiles",
            projectiles,
            ["FSP 1.10 g", "chisel", "1.1", "5.46", "6.16"],
        ),
        ("projectiles", projectiles, ["9 mm FMJ 8.0 g", "lead-antimony in gilding metal"]),
        ("metals", metals, ["OFHC copper", "8960", "124", "90", "second-hand"]),
        ("backings", backings, ["Roma Plastilina No. 1"]),
    ],
)
def test_a_catalogue_is_listed(succeed, tmp_path, monkeypatch, kind, module, some):
    monkeypatch.setenv("COLUMNS", "200")
    out = succeed(f"{kind} list --out list.csv")
    _, *rows = csv.reader((tmp_path / "list.csv").open(encoding="utf-8", newline=""))
    assert [row[0] for row in rows] == list(module.list_names())
    assert all(row[0] in out for row in rows)
    assert any(set(some) <= set(row) for row in rows)


def test_show_gives_every_number_its_source(command, succeed, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    out = succeed("show S-720")
    lines = out[out.index("where each number comes from") :].splitlines()
    for key, entry in catalogue.load("S-720").sources.items():
        line = next(line for line in lines if line.split()[:1] == [key])
        assert all(
            word in line
            for word in (entry["value"], entry["status"], entry["source"].split(",")[0][:30])
        )
    assert "as long as wide" in command("show 'RCC 16 grain'")[1]
    assert "assumed" in command("show 'Roma Plastilina No. 1'")[1]


def test_show_copies_the_data_file_and_never_over_another(command, succeed, tmp_path):
    succeed("show S-728 --out .")
    assert catalogue.read(tmp_path / "S-728.toml").weave == catalogue.load("S-728").weave
    code, _, err = command("show S-728 --out .")
    assert code == 2
    assert err == "error: S-728.toml: exists already\n"
    assert "0.4391 mm" in command("show S-728.toml")[1]


def test_without_the_3d_part_one_line_says_what_to_install(tmp_path):
    code = """
import sys
for name in ("dolfinx", "petsc4py", "gmsh"):
    sys.modules[name] = None
from weavecell.cli import app, from_signature
app.main(["calibrate", "S-720", "--mesh", "coarse", "--jobs", "1", "--out", sys.argv[1]])
"""
    done = in_a_program(code, str(tmp_path / "out"))
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert last.startswith("error: this needs the Python package ")
    assert "apt install python3-dolfinx" in last
    assert "Traceback" not in done.stderr


def test_an_interrupt_is_no_traceback(command, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("fabrics.catalogue.list_names", interrupted)
    assert command("fabrics list")[::2] == (130, "error: interrupted\n")


def test_a_scene_that_is_not_text(command, tmp_path):
    (tmp_path / "scene.toml").write_bytes(b"\xff\xfe\x00")
    assert command("impact scene.toml") == (
        2,
        "",
        "error: scene.toml: line 1 is not UTF-8 text; save it with the encoding UTF-8 (Notepad and other editors)\n",
    )


def test_show_of_a_bullet_has_its_metals_and_draws_it(command, succeed, tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    out = succeed("show '.44 Magnum SJHP 15.6 g' --out .")
    # the drawing has no name of a hidden file
    assert (tmp_path / "44 Magnum SJHP 15.6 g.png").stat().st_size > 10_000
    words = (
        "mass of the drawing",
        "mass of the jacket",
        "core, lead-antimony",
        "jacket, gilding metal",
    )
    assert all(word in out for word in words)
    for name in ("lead-antimony", "gilding metal"):
        for key, row in metals.entry(name).items():
            span = f"{row['value']} ({row['range'][0]} .. {row['range'][1]})"
            assert any(line.startswith(key) and span in line for line in out.splitlines())
    code, _, err = command("show '.44 Magnum SJHP 15.6 g' --out .")
    assert (code, err) == (2, "error: 44 Magnum SJHP 15.6 g.png: exists already\n")


OWN_BULLET = """body = "metal"
shape = "flat"
mass = "{}"
diameter = "8 mm"
length = "10 mm"
edge_radius = "0.2 mm"
core = "OFHC copper"
"""


def test_show_of_a_bullet_in_a_file_says_how_its_mass_differs(command, succeed, tmp_path):
    (tmp_path / "mine.toml").write_text(OWN_BULLET.format("4.6 g"))
    out = succeed("show mine.toml")
    # 8960 kg/m3 x pi/4 x (8 mm)^2 x 10 mm = 4.504 g; the mesh leaves the rounded edge
    assert "4.504 g, given +2.1 %" in out
    assert "core, OFHC copper" in out
    (tmp_path / "mine.toml").write_text(OWN_BULLET.format("5 g"))
    code, _, err = command("show mine.toml")
    assert code == 2
    assert err.startswith("error: mine.toml:3: mass = '5 g': must be that of the drawing")


GONE = [(name, option) for name, options in gone.GONE.items() for option in options]


@pytest.mark.parametrize("function, option", GONE)
def test_an_option_of_an_earlier_version_says_what_took_its_place(function, option, command):
    """At both doors, switched on or off; the function has it no more."""
    words = gone.GONE[function][option]
    assert option not in inspect.signature(getattr(weavecell, function)).parameters
    named = option.replace("_", "-")
    others = ["S-728"] if function == "compare" else []
    for given in (f"--{named}", f"--no-{named}"):
        said = command(function.replace("_", "-"), "S-720", *others, given)
        assert said == (2, "", f"error: --{named}: was removed: {words}\n")
    with pytest.raises(InputError, match=f"{option}: was removed: "):
        getattr(weavecell, function)("S-720", *others, **{option: True})
