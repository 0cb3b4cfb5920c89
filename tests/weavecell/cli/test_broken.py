"""Broken scene and fabric files: a line for each thing that is wrong, exit code 2, and not a file written."""

from os.path import normpath
from pathlib import Path

import pytest

from weavecell.cli import app

BROKEN = Path(__file__).parent / "broken"
FABRICS = "S-720, S-726, S-727, S-728, S-731, S-745, glass-balanced, glass-unbalanced"
FABRIC_KEYS = "name, section, interlayer_gap, areal_density, areal_density_measured, thickness, "
FABRIC_KEYS += "warp, weft, compression, shear, ply_contact, solid, micrograph, strain_rate"
LAW = '"published", the path of a law written by `weavecell calibrate` (*.json), or a table { a = ..., b = ... }'
OPENING = 'a length above 0 and at most 5 m, such as "203 mm", or a list of two, along warp and weft'
SIDE = (
    '"clamped", "free", { clamp_force = ... }, { pull_in = ..., start = ..., end = ... }, '
    "or a list of two such for its ends"
)

# scene -> what follows the name of the file
SCENES = {
    "accuracy-much": """accuracy.deflection = '60 %': must be a share above 0 and at most 50 %, such as "2 %\"""",
    "accuracy-nothing": "accuracy: has no target; must be at least one of "
    "residual_velocity, absorbed_energy, deflection, peak_tension",
    "accuracy-unknown": "accuracy.velocity: unknown key; allowed here: "
    "residual_velocity, absorbed_energy, deflection, peak_tension",
    "angle-without-unit": 'projectile.obliquity = 30: must be an angle from 0 to 75 deg, such as "30 deg"',
    "bar-too-light": "projectile.mass = 0.001: must be above 0.002613 and at most 0.007905 kg",
    "block-before-an-oblique-shot": "projectile.obliquity = 0.5235987755982988: must be 0, and no yaw or roll, "
    "before a backing",
    "boolean": """projectile.mass = True: must be a mass above 0, such as "3 g\"""",
    "bore-of-a-rigid-body": """projectile.bore_diameter = '4.5 mm': must be left out for a rigid projectile""",
    "boundary-both-slips": "panel.boundary.weft: give clamp_force alone, or pull_in with start and end (and zone)",
    "boundary-ends-early": "panel.boundary.weft: must end after its start",
    "boundary-glued": f"panel.boundary.weft = 'glued': must be {SIDE}",
    "boundary-half-glued": f"panel.boundary.warp = 'glued': must be {SIDE}",
    "boundary-slips-and-free": "panel.boundary: give clamp_force alone, or pull_in with start and end (and zone)",
    "boundary-unknown-key": 'panel.boundary.weft.clamp_forc: unknown key, did you mean "clamp_force"? '
    "allowed here: clamp_force, pull_in, start, end, zone",
    "boundary-wrong-unit": """panel.boundary.weft.clamp_force = '20 mm': must be a force above 0, such as "20 N\"""",
    "cone-without-angle": "projectile.half_angle: must be above 0 for a cone",
    "decimal-comma": "projectile.strike_velocity = '92,5 m/s': write a decimal point and no comma; must be a speed "
    'above 0 and at most 1000 m/s, such as "92.5 m/s"',
    "edge-too-round": "projectile.edge_radius = '3 mm': must be below half of projectile.diameter",
    "fabric-file-missing": f"fabric.file = 'fabric-nowhere.toml': there is no file {BROKEN}/fabric-nowhere.toml; "
    "must be the path of a fabric file (*.toml)",
    "form-of-a-law": "fabric.cell_formulation = 'direct': must be variational or equilibrium without fabric.surface",
    "form-of-a-surface": "fabric.cell_formulation = 'equilibrium': must be variational or direct with fabric.surface",
    "gap-too-wide": "fabric.crossover_gap = 0.001: must be at least 0 and at most h01 + h02",
    "grading-not-zones": "panel.grading = [10, 1]: must be zones [until, side] in crossovers, the last until inf, "
    'such as [[9, "1/2"], [20, 1], [inf, 2]]',
    "grading-shrinks": "panel.grading = ((10.0, 4.0), (inf, 2.0)): must be sides each a multiple of that before it",
    "grading-too-fine": "panel.grading = ((2.0, 1.0), (inf, 2.0)): must be a first zone of 8 crossovers or more, "
    "all that comes under the nose",
    "late-snapshots": "run.snapshot_interval = '1 ms': must be at most run.end_time",
    "law-and-surface": "fabric.cell_model = 'decoupled': must be left out with fabric.surface",
    "law-half-given": "fabric.law.b: is missing; must be a value of at least 0 in mm N^(1/3), "
    'such as "0.058 mm N^(1/3)"',
    "law-half-zero": "fabric.law.b = 0.0: must be zero exactly where a is zero (an incompressible yarn)",
    "law-not-a-law": f"fabric.law = 'printed': must be {LAW}",
    "law-of-another": f"fabric.law = '{BROKEN}/law-of-S-728.json': is a law of fabric S-728; must be a law of S-720, "
    "or its constants a and b to use them all the same",
    "mass-of-a-long-rod": "projectile.mass = '3 kg': must be from 0.00218 to 90.2 g, for a body of this diameter, at "
    "most 30 times as long, of 0.5 to 23 g/cm^3",
    "mass-of-a-sphere": "projectile.mass = '30 g': must be from 0.0436 to 2 g, for a body of this diameter, of 0.5 to "
    "23 g/cm^3",
    "measure-no-unit": "history.report_positions = ['5 mm', 20]: must be a list of positions along the yarns, such as "
    '["5 mm", "50 mm"]',
    "measure-not-a-list": "history.warp = '0 mm': must be a list of distances of warp yarns from the impact point, "
    'such as ["0 mm", "10 mm"]',
    "measure-off-the-panel": "history.weft = 0.25: must be at most 100.3 mm from the impact point",
    "measure-unknown-key": 'history.wrap: unknown key, did you mean "warp"? '
    "allowed here: interval, warp, weft, report_positions",
    "missing-fabric": "fabric: is missing; must be a table [fabric], which may be left out where every [[panel.ply]] "
    "has name or file",
    "missing-key": 'projectile.edge_radius: is missing; must be a length above 0, such as "0.3 mm"',
    "missing-table": "panel: is missing; must be a table [panel]",
    "negative-mass": """projectile.mass = '-3 g': must be a mass above 0, such as "3 g\"""",
    "no-elements": "run.elements_per_crossover = 0: must be a whole number from 1 to 8",
    "no-law-file": f"fabric.law = 'nowhere.json': there is no file {BROKEN}/nowhere.json; must be {LAW}",
    "no-surface-file": f"fabric.surface = 'nowhere.h5': there is no file {BROKEN}/nowhere.h5; "
    "must be the path of a surface written by `weavecell surface`",
    "no-unit": f"panel.opening = 203: must be {OPENING}",
    "not-a-table": "fabric = 'S-720': must be a table [fabric]",
    "not-toml": "not valid TOML (Expected newline or end of document after a statement (at line 5, column 10))",
    "oblique-quarter": "panel.symmetry = 'quarter': must be whole for this shot",
    "off-the-middle": "panel.impact_point = (0.02, 0.0): must be 0 across planes of symmetry, or symmetry = whole",
    "opening-in-m": f"panel.opening = '60 m': must be {OPENING}",
    "round-rectangle": "panel.opening = (0.203, 0.15): must be one diameter of a round opening",
    "oblique-weave-quarter": "panel.symmetry = 'quarter': must be whole where the weave is oblique",
    "panel-too-small": "panel.opening = 0.004: must be wider than two projectiles and four crossovers",
    "profile-of-a-surface": "fabric.cell_profile = 'straight': must be left out with fabric.surface",
    "profile-unknown": """fabric.cell_profile = 'sawtooth': must be one of "cosine", "straight\"""",
    "projectile-too-wide": "projectile.diameter = '120 mm': must be below half of panel.opening",
    "sphere-with-edge": "projectile.edge_radius = '0.3 mm': must be left out for a sphere",
    "toe-in-an-impact": "fabric.fibre_slack = '0.1 %': must be left out in an impact",
    "toe-too-long": "fabric.fibre_slack = ['0.1 %', '20 %']: must be a strain from 0 to 10 %, such as \"0.1 %\", "
    "or a list of two, of warp and weft",
    "three-sides": f"panel.opening = ['203 mm', '100 mm', '50 mm']: must be {OPENING}",
    "two-fabrics": "fabric: give exactly one of fabric.name and fabric.file",
    "two-numbers": f"panel.opening = '20 3 mm': must be {OPENING}",
    "unknown-fabric": f"fabric.name = 'S-702': must be one of {FABRICS}",
    "unknown-key": 'projectile.mas: unknown key, did you mean "mass"? '
    "allowed here: name, mass, diameter, edge_radius, strike_velocity, shape, length, half_angle, tip_radius, "
    "flat_width, flat_angle, stl, stl_unit, density, obliquity, azimuth, yaw, roll, friction, body, bore_diameter",
    "unknown-model": """fabric.cell_model = 'rigid': must be one of "compressible", "incompressible", "decoupled\"""",
    "unknown-output": """run.outputs = 'movie': must be a list of "paraview", "pictures", "report\"""",
    "wrong-dimension": "projectile.strike_velocity = '92.5 kg': must be a speed above 0 and at most 1000 m/s, "
    'such as "92.5 m/s"',
    "zero-time": """run.end_time = '0 us': must be a time above 0 and at most 10 ms, such as "250 us\"""",
}

# scene -> (the other file that is to blame, what follows its name)
OTHERS = {
    "fabric-file-broken": ("fabric-crimp-as-length.toml", "warp.crimp = '2 mm': must be a number"),
    "surface-of-another": (
        "../../../shellfabric/cell/data/S-720-coarse-9x9.h5",
        "surface = 'S-720': must be one of S-728",
    ),
}

# fabric -> what follows the name of the file
FABRIC_FILES = {
    "fabric-crimp-as-length": "warp.crimp = '2 mm': must be a number",
    "fabric-no-weft": "[weft]: is missing; must be a table with the yarn's data",
    "fabric-unknown-key": f"colour: is not a known key; must be one of {FABRIC_KEYS}",
    "fabric-negative-modulus": (
        "warp.modulus = '-96 GPa': must be from 1 to 1000 GPa",
        "weft.modulus = '-96 GPa': must be from 1 to 1000 GPa",
    ),
    "fabric-round-section": "section = 'round': must be sine, ellipse or conforming",
}


def check_refused(result, line, folder):
    code, out, err = result
    assert err == f"error: {line}\n"
    assert code == 2
    assert out == ""
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("name", SCENES)
def test_broken_scene(command, tmp_path, name):
    file = BROKEN / f"{name}.toml"
    check_refused(command("impact", file), f"{file}: {SCENES[name]}", tmp_path)


@pytest.mark.parametrize("name", OTHERS)
def test_scene_that_names_a_broken_file(command, tmp_path, name):
    blamed, line = OTHERS[name]
    check_refused(command("impact", BROKEN / f"{name}.toml"), f"{normpath(BROKEN / blamed)}: {line}", tmp_path)


@pytest.mark.parametrize("name", FABRIC_FILES)
@pytest.mark.parametrize("verb", ["mesh", "calibrate"])
def test_broken_fabric(command, tmp_path, verb, name):
    file = BROKEN / f"{name}.toml"
    told = FABRIC_FILES[name] if isinstance(FABRIC_FILES[name], tuple) else (FABRIC_FILES[name],)
    check_refused(command(verb, file), "\nerror: ".join(f"{file}: {line}" for line in told), tmp_path)


@pytest.mark.parametrize("verb", ["mesh", "calibrate"])
def test_fabric_without_3d_data(command, tmp_path, verb):
    code, _out, err = command(verb, BROKEN / "fabric-no-3d-data.toml")
    assert code == 2
    told = "fabric mine has no [solid] table; must be given, with E_a, E_c, K_r, K_G, V_c and Vf0 of warp and weft: "
    told += "it is assumed only where modulus and fibre_density of both yarns are in the range of para-aramid"
    assert err.startswith(f"error: FABRIC = '{BROKEN}/fabric-no-3d-data.toml': {told}")
    assert list(tmp_path.iterdir()) == []


def test_every_broken_file_is_tested():
    names = {path.stem for path in BROKEN.glob("*.toml")}
    assert names == set(SCENES) | set(OTHERS) | set(FABRIC_FILES) | {"fabric-no-3d-data", "three-errors"}


def test_all_errors_of_a_scene_are_reported_at_once(command, tmp_path):
    """The mistyped key leaves the right one missing, which is not told again."""
    file = BROKEN / "three-errors.toml"
    code, out, err = command("impact", file)
    assert (code, out, list(tmp_path.iterdir())) == (2, "", [])
    unknown, *wrong = err.splitlines()
    assert unknown.startswith(
        f'error: {file}: panel.oppening: unknown key, did you mean "opening"? allowed here: opening'
    )
    assert wrong == [
        f"error: {file}: projectile.mass = '3 m': must be a mass above 0, such as \"3 g\"",
        f"error: {file}: projectile.diameter = 'wide': must be a length above 0, such as \"5.5 mm\"",
    ]


def test_missing_scene(command, tmp_path):
    check_refused(
        command("impact", "nowhere.toml"),
        "nowhere.toml: the scene file cannot be read (No such file or directory)",
        tmp_path,
    )


def test_scene_that_is_not_text(command, tmp_path):
    (tmp_path / "scene.toml").write_bytes(b"\xff\xfe\x00")
    code, _, err = command("impact", "scene.toml")
    assert (code, err) == (2, "error: scene.toml: the scene file is not UTF-8 text\n")


def test_wrong_option_is_one_line(command, tmp_path):
    code, _, err = command("mesh", "S-720", "--mesh", "huge")
    assert code == 2
    assert len(err.splitlines()) == 1
    assert "--mesh" in err
    assert "coarse" in err


def test_gap_without_unit(command, tmp_path):
    code, _, err = command("mesh", "S-720", "--yarn-gap", "3 parsec/s")
    assert code == 2
    assert err.startswith("error: --yarn-gap = '3 parsec/s': must be")
    assert list(tmp_path.iterdir()) == []


def test_interrupt_is_not_a_traceback(monkeypatch, capsys):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("weavecell.commands.fabrics.print_table", interrupted)
    with pytest.raises(SystemExit) as leaving:
        app.main(["fabrics", "list"])
    assert leaving.value.code == 130
    assert capsys.readouterr().err == "error: interrupted\n"


def test_plate_curves_that_cannot_be_fitted_to(command, tmp_path):
    check_refused(
        command("calibrate", "S-720", "--platen-curve", "nowhere.csv"),
        "nowhere.csv: cannot be read; must be a plate curve (No such file or directory)",
        tmp_path,
    )
    check_refused(
        command("calibrate", "glass-balanced", "--fit-solid"),
        "fabric glass-balanced has no areal_density_measured, which the pressure law needs: give --platen-curve",
        tmp_path,
    )
