"""Every command on every kind of scene: the key changes what it should, or is rejected in one line with code 2."""

import copy
import json
import tomllib
from dataclasses import dataclass, field
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from test_supported import CHISEL, LAW, NAMED, SURFACE, merged

from shellfabric.impact.ballistic_limit import Shot
from shellfabric.solver.pack_solver import PackSolver
from weavecell.cli import app
from weavecell.results.paraview import read_series

SHOT = {
    "fabric": {"name": "S-720"},
    "projectile": {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm", "strike_velocity": "400 m/s"},
    "panel": {"opening": "26 mm"},
    "run": {"end_time": "12 us", "snapshot_interval": "4 us", "checkpoint_interval": "6 us", "outputs": []},
}
PACK = {"panel": {"plies": 2, "ply_gap": "0.05 mm"}}
ACCURACY = {"accuracy": {"residual_velocity": "50 %"}}
BLOCK = {"size": ["60 mm", "60 mm", "30 mm"], "min_size": "2 mm", "growth": 1.5}


def energy(name):
    return lambda got: sum(value for key, value in got.energies.items() if key.startswith(name))


def rises(measure, least=0.0):
    """Whether the kind of scene has more of something than the plain one, by more than `least`."""
    return lambda got, plain: measure(got) > measure(plain) + least


def ratio(measure, value, within):
    return lambda got, plain: abs(measure(got) / measure(plain) - value) < within


def a_ninth_of_the_step(got, plain):
    """Nine times as many steps in a time; 3.35 times of a pack, whose contact bounds the plain step."""
    rate = got.steps / got.end_time_s * plain.end_time_s / plain.steps
    return abs(rate / (9 if getattr(got, "plies", 1) == 1 else 3.35) - 1) < 0.025


def moved(got, plain):
    """The projectile ends with another velocity, by more than rounding."""
    return abs(got.residual_velocity_m_s / plain.residual_velocity_m_s - 1) > 1e-6


def every_four_microseconds(got, plain):
    """The ParaView series is written, at the snapshot interval; the plain scene has none."""
    return [round(2.5e5 * time) for _, time in got.series] == [1, 2, 3] and not plain.series


@dataclass(frozen=True)
class Kind:
    """A kind of scene: what it changes, how a shot shows it, and {command that rejects it: what it says}."""

    changes: dict
    shows: object = moved
    rejected: dict = field(default_factory=dict)


ALL = ("impact", "pack", "accuracy", "explain", "critical-velocity")


def all_say(told):
    return dict.fromkeys(ALL, told)


NO_SLACK = all_say("fabric.fibre_slack = '0.1 %': must be left out in an impact")
MESH = "must be left out in a scene with [accuracy], whose mesh is chosen"
KINDS = {
    "pack": Kind(
        PACK, lambda got, plain: got.plies == 2 and got.gap == pytest.approx(5e-5)
        and got.absorbed_energy_J > plain.absorbed_energy_J,
    ),
    "alternating": Kind(
        merged(PACK, {"panel": {"stacking": "alternating"}}), lambda got, plain: got.stacking == "alternating",
    ),
    "ply friction": Kind(
        merged(PACK, {"panel": {"ply_friction": 0.3}}), rises(energy("ply_friction"), 1e-9),
    ),
    "backing": Kind({"backing": BLOCK}, rises(energy("backing"), 1e-6)),
    "oblique": Kind(
        {"projectile": {"obliquity": "30 deg"}, "panel": {"symmetry": "whole"}},
        lambda got, plain: got.v[0] == pytest.approx(plain.v[0] * np.cos(np.radians(30))),
    ),
    "chisel": Kind({"projectile": CHISEL}),
    "named projectile": Kind(
        {"projectile": NAMED},
        lambda got, plain: moved(got, plain) and getattr(got, "projectile", "FSP 1.10 g, ").startswith("FSP 1.10 g, "),
    ),
    "unknown projectile": Kind(
        {"projectile": {"name": "FSP 1 g"}},
        rejected=all_say("projectile.name = 'FSP 1 g': unknown projectile, did you mean \"FSP 1"),
    ),
    "elastic bar": Kind({"projectile": {"body": "elastic_bar"}}, rises(energy("elastic_projectile"), 1e-6)),
    "bored bar": Kind(
        {"projectile": {"bore_diameter": "4.5 mm"}},
        rejected=all_say("projectile.bore_diameter = '4.5 mm': must be left out for"),
    ),
    "nose friction": Kind(
        {"projectile": {"friction": 0.3, "shape": "hemisphere"}}, rises(energy("friction"), 1e-9)
    ),
    "grip": Kind({"panel": {"boundary": {"weft": {"clamp_force": "2 N"}}}}, rises(energy("clamp_friction"), 1e-9)),
    "pull_in": Kind(
        {"panel": {"boundary": {"weft": {"pull_in": "0.2 mm", "start": "0 us", "end": "10 us"}}}},
        lambda got, plain: abs(energy("boundary_work")(got)) > 1e-9,
    ),
    "free": Kind({"panel": {"boundary": "free"}}, lambda got, plain: got.reactions.max() < plain.reactions.max()),
    "weave angle": Kind(
        {"panel": {"weave_angle": "30 deg", "symmetry": "whole"}}, lambda got, plain: got.elements > 4 * plain.elements
    ),
    "round": Kind(
        {"panel": {"opening_shape": "round"}}, lambda got, plain: moved(got, plain) and got.elements == plain.elements
    ),
    "off the middle": Kind(
        {"panel": {"impact_point": ["4 mm", "0 mm"], "symmetry": "whole"}},
        lambda got, plain: moved(got, plain) and got.elements > 4 * plain.elements,
    ),
    "whole": Kind({"panel": {"symmetry": "whole"}}, ratio(lambda got: got.elements, 4, 1e-9)),
    "yarns hold": Kind({"panel": {"yarn_failure": False}}, lambda got, plain: got.failed == 0 < plain.failed),
    "strength by rate": Kind({"panel": {"rate_dependence": True}}),
    "rates of yarns that hold": Kind(
        {"panel": {"yarn_failure": False, "rate_dependence": True}},
        rejected=all_say("panel.rate_dependence = True: must be left out where yarns do not fail"),
    ),
    "rates of a surface": Kind(
        {"fabric": {"surface": SURFACE}, "panel": {"rate_dependence": True}},
        rejected=all_say("panel.rate_dependence = True: must be left out with fabric.surface"),
    ),
    "grading": Kind(
        {"panel": {"grading": [[8, 1], [float("inf"), 2]], "opening": "60 mm"}},
        lambda got, plain: got.elements < 23**2 * getattr(got, "plies", 1),
        {"accuracy": "panel.grading = [[8, 1], [inf, 2]]: " + MESH,
         "explain": "panel.grading = [[8, 1], [inf, 2]]: " + MESH},
    ),
    "sliding": Kind(
        {"panel": {"crossovers": "sliding", "crossover_friction": 0.1, "crossover_cohesion": "0.01 N"}},
        rises(energy("crossover_friction"), 1e-9),
        dict.fromkeys(("accuracy", "explain"), "panel.crossovers = 'sliding': must be \"pinned\" where the mesh is"),
    ),
    "pinned with friction": Kind(
        {"panel": {"crossover_friction": 0.1}},
        rejected=all_say("panel.crossover_friction = 0.1: must be left out where crossovers are"),
    ),
    "elements": Kind({"run": {"elements_per_crossover": 2}}, ratio(lambda got: got.elements, 4, 1e-9)),
    "accuracy": Kind(
        ACCURACY, lambda got, plain: got.accuracy["targets"] == {"residual_velocity": 0.5},
        {"critical-velocity": "accuracy: must be left out: the shots are computed"},
    ),
    "measure": Kind(
        {"history": {"warp": ["0 mm", "2.6 mm"]}}, lambda got, plain: got.followed == 3,
        {"critical-velocity": "history: must be left out: the shots record nothing"},
    ),
    "cfl": Kind({"numerics": {"cfl": 0.1}}, a_ninth_of_the_step),
    "viscosity": Kind({"numerics": {"stretch_viscosity": 0.2}}, rises(energy("viscous"))),
    "penalty": Kind({"numerics": {"penalty": 0.3, "contact_damping": 0.4}}),
    "contact points": Kind({"numerics": {"contact_points": 4}}),
    "surface": Kind({"fabric": {"surface": SURFACE}}),
    "surface and law": Kind(
        {"fabric": {"surface": SURFACE, "law": LAW}},
        rejected=all_say("fabric.law: must be left out with fabric.surface"),
    ),
    "law": Kind({"fabric": {"law": LAW}}, lambda got, plain: moved(got, plain) and "scene" in got.law_name),
    "incompressible": Kind({"fabric": {"cell_model": "incompressible"}}),
    "decoupled": Kind({"fabric": {"cell_model": "decoupled"}}),
    "incompressible with a law": Kind(
        {"fabric": {"cell_model": "incompressible", "law": LAW}},
        rejected=all_say("fabric.law: must be left out where fabric.cell_model is"),
    ),
    "decoupled with a gap": Kind(
        {"fabric": {"cell_model": "decoupled", "crossover_gap": "0.01 mm"}},
        rejected=all_say("fabric.crossover_gap = '0.01 mm': must be left out where fabric.cell_model is"),
    ),
    "equilibrium form": Kind({"fabric": {"cell_formulation": "equilibrium"}}),
    "straight yarns": Kind({"fabric": {"cell_profile": "straight"}}),
    "play": Kind({"fabric": {"crossover_gap": "0.02 mm"}}),
    "bending": Kind({"fabric": {"bending": "1e-6 N m^2"}}, rises(energy("bending"), 1e-9)),
    "yarn toe": Kind({"fabric": {"fibre_slack": "0.1 %"}}, rejected=NO_SLACK),
    "nominal": Kind({"fabric": {"linear_density": "nominal"}}),
    "stacked alone": Kind(
        {"panel": {"stacking": "alternating"}},
        rejected=dict.fromkeys(
            (name for name in ALL if name != "pack"),
            "panel.stacking = 'alternating': must be left out for a single ply",
        ),
        shows=lambda got, plain: got.stacking == "alternating",
    ),
    "friction between plies alone": Kind(
        {"panel": {"ply_friction": 0.2}},
        rejected=dict.fromkeys(
            (name for name in ALL if name != "pack"), "panel.ply_friction = 0.2: must be left out for a single ply"
        ),
        shows=lambda got, plain: "ply_friction" in got.energies,
    ),
    "title": Kind({"title": "mine"}, lambda got, plain: got.title == "mine" != plain.title),
    "outputs": Kind({"run": {"outputs": ["paraview"]}}, every_four_microseconds),
}  # fmt: skip
OF_ITSELF = {
    "pack": ("pack", "alternating", "ply friction"),
    "accuracy": ("accuracy",),
}  # kinds that are the command's own
# of the others [accuracy] leaves the mesh, the table of the cell and the part of the panel open; these it cannot
OF_ACCURACY = {
    "pack": lambda got: getattr(got, "plies", 1), "alternating": lambda got: got.stacking == "alternating",
    "ply friction": energy("ply_friction"), "grip": energy("clamp_friction"), "bending": energy("bending"),
    "measure": lambda got: got.followed,
    "elastic bar": lambda got: "as set" in got.accuracy["projectile"], "cfl": lambda got: got.steps / got.elements,
}  # fmt: skip


def call(capsys, *words):
    with pytest.raises(SystemExit) as leaving:
        app.main([str(word) for word in words])
    return (leaving.value.code, *capsys.readouterr())


def inline(value):
    """TOML of a value, tables in one line."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {inline(part)}" for key, part in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(inline(part) for part in value) + "]"
    return "inf" if value == float("inf") else json.dumps(value)


def written(folder, table):
    path = folder / "scene.toml"
    path.write_text("".join(f"{key} = {inline(value)}\n" for key, value in table.items()))
    assert tomllib.loads(path.read_text()) == table
    return path


@pytest.fixture(scope="module")
def known():
    """Results of the scenes that others are compared with."""
    return {}


def shot(capsys, folder, table):
    """The results of `weavecell impact`, by name."""
    code, _, err = call(capsys, "impact", written(folder, table), "--out", folder / "r")
    assert code == 0, err
    told = json.loads((folder / "r/summary.json").read_text())
    with h5py.File(folder / "r/histories.h5") as file:
        v = file["histories/velocity"][()]
        reactions = np.array([file[f"plies/histories/reaction_{side}"][()].max() for side in ("warp", "weft")])
        followed = len(file["measured/00/yarns"]) if "measured" in file else 0
    name = folder / "r" / "panel.pvd"
    series = read_series(name) if name.exists() else []
    return SimpleNamespace(
        **{"stacking": "", "gap": told.get("ply_gap_m"), **told}, v=v, reactions=reactions, followed=followed,
        series=series, energies=told["energies_at_end_J"], failed=told["failed_yarn_segments"],
    )  # fmt: skip


def scene_of(command, changes):
    one = {"run": {"elements_per_crossover": 1}}  # as of one ply, by default
    added = {"pack": merged(PACK, one), "accuracy": ACCURACY, "explain": ACCURACY}.get(command, {})
    return merged(merged(copy.deepcopy(SHOT), added), changes)


def rejected(capsys, folder, words, told, *, lines=1):
    """One line, or a number of `lines` of which `told` is the first, exit code 2, and nothing written."""
    before = sorted(folder.rglob("*"))
    code, out, err = call(capsys, *words)
    assert code == 2
    assert out == ""
    assert len(err.splitlines()) == lines
    assert all(line.startswith(f"error: {folder / 'scene.toml'}: ") for line in err.splitlines())
    assert err.startswith(f"error: {folder / 'scene.toml'}: {told}")
    assert sorted(folder.rglob("*")) == before


REJECTED = [(name, command) for name, kind in KINDS.items() for command in kind.rejected]
SHOWN = [
    (name, command)
    for command in ("impact", "pack")
    for name, kind in KINDS.items()
    if command not in kind.rejected and name not in OF_ITSELF.get(command, ())
]


@pytest.mark.parametrize(("name", "command"), REJECTED)
def test_rejected(capsys, tmp_path, name, command):
    path = written(tmp_path, scene_of(command, KINDS[name].changes))
    words = {"explain": ("impact", path, "--explain"), "critical-velocity": ("critical-velocity", path)}
    rejected(
        capsys, tmp_path, words.get(command, ("impact", path, "--out", tmp_path / "r")), KINDS[name].rejected[command]
    )


@pytest.mark.parametrize(("name", "command"), SHOWN)
def test_honoured_by_impacts(capsys, tmp_path, known, name, command):
    if command not in known:
        (tmp_path / "plain").mkdir()
        known[command] = shot(capsys, tmp_path / "plain", scene_of(command, {}))
    got = shot(capsys, tmp_path, scene_of(command, KINDS[name].changes))
    assert KINDS[name].shows(got, known[command])


ACCURATE = [name for name in OF_ACCURACY if "accuracy" not in KINDS[name].rejected]


@pytest.mark.parametrize("name", ACCURATE)
def test_honoured_with_accuracy(capsys, tmp_path, known, name):
    if "accuracy" not in known:
        (tmp_path / "plain").mkdir()
        known["accuracy"] = shot(capsys, tmp_path / "plain", scene_of("accuracy", {}))
    got = shot(capsys, tmp_path, scene_of("accuracy", KINDS[name].changes))
    assert got.accuracy["targets"] == {"residual_velocity": 0.5}
    assert OF_ACCURACY[name](got) > OF_ACCURACY[name](known["accuracy"])


def options(capsys, folder, changes):
    """What `weavecell impact --explain` prints of the models, as (name, part, elements)."""
    code, out, err = call(capsys, "impact", written(folder, scene_of("explain", changes)), "--explain")
    assert code == 0, err
    assert [path.name for path in folder.iterdir()] == ["scene.toml"]
    return [line.split() for line in out.splitlines() if "element" in line or "by hand" in line], out


@pytest.mark.parametrize("name", [name for name, kind in KINDS.items() if "explain" not in kind.rejected])
def test_honoured_by_explain(capsys, tmp_path, monkeypatch, name):
    """It runs nothing; what it prints follows from the set-up, which is that of the scene."""
    monkeypatch.setenv("COLUMNS", "200")
    _, out = options(capsys, tmp_path, KINDS[name].changes)
    assert "->" in out
    if name == "elements":
        assert "2 elements" in out
        assert "3 elements" not in out
    if name in ("oblique", "weave angle", "whole"):
        assert " whole " in out
    if name == "elastic bar":
        assert "projectile: elastic_bar, as the scene says" in out
    if name in ("incompressible", "decoupled"):
        assert ("1 element, decoupled" in out) == (name == "decoupled")


def limit(capsys, folder, monkeypatch, changes):
    """The panel that `weavecell critical-velocity` shoots at, struck as in SHOT; its outcomes are made up."""
    marches = []

    def fire(panel, velocity, _):
        if not marches:
            marches.append(PackSolver(panel, 400.0, 12e-6).run(()))
        through = velocity > 130.0
        return Shot(velocity, 50.0 * through, "perforated" if through else "stopped", 1e-4, 0, (1.0, 1.0), 0.0, 0.0)

    monkeypatch.setattr("shellfabric.impact.ballistic_limit._fire", fire)
    path = written(folder, merged(SHOT, changes))
    words = ("--tolerance", "100 m/s", "--residual-shots", 0, "--jobs", 1, "--out", folder / "r")
    code, _, err = call(capsys, "critical-velocity", path, *words)
    assert code == 0, err
    march, found = marches[0], json.loads((folder / "r/critical-velocity.json").read_text())
    pack, v = march.pack, march.sample("v")
    turned = pack.plies[0] is not pack.plies[-1]
    return SimpleNamespace(
        plies=found["plies"], gap=pack.gaps[0] if pack.gaps else None, stacking="alternating" if turned else "aligned",
        absorbed_energy_J=march.sample("kinetic_projectile")[0] - march.sample("kinetic_projectile")[-1],
        energies={name: march.sample(name)[-1] for name in march.energy_names}, v=v,
        residual_velocity_m_s=v[-1], failed=march.sample("failed_yarns")[-1],
        law_name=found["law_name"],
        reactions=np.array([march.sample(f"reaction_{side}").max() for side in ("warp", "weft")]),
        elements=march.parts[0][0].elements * found["plies"], steps=march.steps, end_time_s=march.sample("t")[-1],
        numbers=found | {"wall_time_s": 0, "provenance": ""},
    )  # fmt: skip


IGNORED = ("title", "outputs")


@pytest.mark.parametrize("name", [name for name, kind in KINDS.items() if "critical-velocity" not in kind.rejected])
def test_honoured_by_the_ballistic_limit(capsys, tmp_path, known, monkeypatch, name):
    if "limit" not in known:
        (tmp_path / "plain").mkdir()
        known["limit"] = limit(capsys, tmp_path / "plain", monkeypatch, {})
    got = limit(capsys, tmp_path, monkeypatch, KINDS[name].changes)
    if name in IGNORED:
        assert got.numbers == known["limit"].numbers
    else:
        assert KINDS[name].shows(got, known["limit"])
