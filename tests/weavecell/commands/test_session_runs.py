"""One run of each command: its folder, and its numbers against the Python interface, its files and its report."""

import html
import re
from dataclasses import asdict
from importlib.util import find_spec
from math import isclose, isnan

import numpy as np
import pytest
from PIL import Image

import weavecell as wc
from fabrics.compression import CompressionLaw
from fabrics.surface import ResponseSurface
from tests.scene_text import merged
from tests.weavecell.session_runs import RUNS, SCENES, fired, set_up, small_calibration
from tests.weavecell.written import names, rows_of, table_of
from weavecell.results.result_folder import read_record

IMPACTS = ("impact", "pack")
SOLID = pytest.mark.skipif(find_spec("dolfinx") is None, reason="without dolfinx")


def named(runs):
    """A case for each run."""
    cases = [pytest.param(name, marks=SOLID if RUNS[name].get("solid") else ()) for name in runs]
    return pytest.mark.parametrize("name", cases)


def summary_of(run, name):
    return table_of(run.folder, RUNS[name].get("summary", "summary.json"))


@named(RUNS)
def test_a_command_ends_well_and_leaves_its_folder(results, name):
    run = results(name)
    told = RUNS[name]
    assert run.code == 0, run.err
    assert "error" not in run.err
    assert re.search(r"^(files +r(/report\.html)?|written to r)$", run.out, re.MULTILINE)
    assert names(run.folder).split() == told["folder"].split()
    if "scene.toml" in told["folder"].split():
        assert (run.folder / "scene.toml").read_text() == (
            run.folder.parent / "scene.toml"
        ).read_text()
    if "pictures" in told:
        pictures = sorted(path.stem for path in (run.folder / "pictures").iterdir())
        assert pictures == told["pictures"].split()
    if "provenance.json" in told["folder"]:
        stamp = table_of(run.folder, "provenance.json")
    else:
        stamp = summary_of(run, name)["provenance"]
    assert {"commit", "packages", "processor"} <= set(stamp)


@named(RUNS)
def test_no_picture_is_empty(results, name):
    for path in results(name).folder.rglob("*.png"):
        with Image.open(path) as picture:
            assert np.ptp(np.asarray(picture.convert("L"))) > 100, path
    for path in results(name).folder.rglob("*.svg"):
        text = path.read_text("utf-8")
        assert text.count("<path") + text.count("<text") > 20, path


def numbers(value, at=""):
    """{path: number} of a summary, through its tables and lists, without times of the computer."""
    if isinstance(value, dict):
        parts = value.items()
    elif isinstance(value, (list, tuple, np.ndarray)):
        parts = enumerate(value)
    else:
        number = isinstance(value, (int, float, np.number)) and not isnan(value)
        timed = any(word in at for word in ("wall_time", "element_step_time", "seconds"))
        return {at: float(value)} if number and not timed else {}
    found = {}
    for key, part in parts:
        found |= numbers(part, f"{at}.{key}")
    return found


def limit(_):
    found = wc.critical_velocity(set_up(SCENES["limit"]), residual_shots=3)
    shots = sorted(found.limit.shots, key=lambda shot: shot.strike_velocity)
    entries = [
        {"strike_velocity_m_s": s.strike_velocity, "residual_velocity_m_s": s.residual_velocity}
        for s in shots
    ]
    return found.summary() | {
        "bracket_m_s": found.bracket,
        "lambert_jonas": asdict(found.lambert_jonas),
        "shots": entries,
    }


def swept(_):
    shots = [
        {"strike_velocity": v, "mass": mass}
        for v in ("90 m/s", "150 m/s")
        for mass in ("3 g", "2 g")
    ]
    found = wc.sweep([set_up(merged(SCENES["plies"], {"projectile": shot})) for shot in shots])
    return {"rows": [shot.facts() for shot in found]}


def frame(_):
    found = wc.coupon(
        "S-720", "picture_frame", shear_angle="24 deg", crossovers=4, steps=4
    ).summary()
    units = {
        "shear stress": "shear_stress_Pa",
        "trellis law": "trellis_law_Pa",
        "shear angle": "shear_angle_rad",
    }
    return found | {"at_end": {key: {"value": found[name]} for key, name in units.items()}}


def calibrated(folder):
    with small_calibration():
        found = wc.calibrate("S-720", mesh="coarse", out=folder).summary()
    ends = {
        f"{name}_interval_m{unit}": [found[f"{name}_interval_{end}"] for end in ("low", "high")]
        for name, unit in (("a", ""), ("b", "_N^(1/3)"))
    }
    return {"law": found | ends}


def pulled(_):
    found = wc.crossover.pull_out(
        "S-720", friction=0.15, end_displacement=["5 um", 9e-6], mesh=(3, 2, 2)
    )
    return {"found": found.summary()}


def stretched(folder):
    wc.biaxial("S-731", ratio=["1:1", "1:0"], out=folder)
    return table_of(folder, "biaxial.json")


IN_PYTHON = {
    **{name: lambda _, name=name: fired(name).summary() for name in IMPACTS},
    "critical-velocity": limit,
    "v50": lambda _: wc.v50(set_up(SCENES["small"]), shots=12, batch=4, seed=2).summary(),
    "sweep": swept,
    "coupon": frame,
    "pull-out": lambda _: wc.coupon("S-726", "pull_out", **SCENES["pull"]["pull_out"]).summary(),
    "export": lambda folder: {
        "error_over_strength": [wc.export(set_up(SCENES["plies"]), "lsdyna", folder).summary()]
    },
    "calibrate": calibrated,
    "crossover": pulled,
    "surface": lambda _: wc.surface(
        "S-720", mesh=(3, 2, 2), points=5, d1=(0, 1e-5), d2="0 um .. 8 um"
    ).summary(),
    "biaxial": stretched,
}


# studies and 3D solutions of seconds, which are commands of the interface by the same code as the others
SLOW = ("v50", "critical-velocity", "calibrate", "crossover", "surface")


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.slow if name in SLOW else ()) for name in IN_PYTHON],
)
@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult", "ignore:unique with")
def test_the_python_interface_finds_the_same_numbers(results, name, tmp_path):
    """To 12 digits, of the same input."""
    told = numbers(summary_of(results(name), name))
    found = numbers(IN_PYTHON[name](tmp_path))
    both = set(told) & set(found)
    assert len(both) >= (4 if name == "export" else 7)
    # what the 3D solver leaves of large forces that cancel is not the same to the last bit in two processes
    off = 1e-11 * max(abs(told[key]) for key in both) if name == "crossover" else 1e-15
    assert [
        key
        for key in sorted(both)
        if not isclose(told[key], found[key], rel_tol=1e-12, abs_tol=off)
    ] == []


@named(IMPACTS)
def test_the_record_of_an_impact_has_the_numbers_of_its_summary(results, name):
    record = read_record(results(name).folder / "histories.h5")
    told = numbers(summary_of(results(name), name))
    found = numbers(record.facts())
    assert len(found) > 50
    assert {key: told[key] for key in found} == found
    assert record.energy_error_max < 5e-3


TABLES = {  # run: its table of shots, and what a column is in the list of shots of the summary
    "critical-velocity": (
        "shots.csv",
        "shots",
        {key: key for key in ("strike_velocity_m_s", "residual_velocity_m_s", "outcome")},
    ),
    "sweep": (
        "sweep.csv",
        "rows",
        {key: key for key in ("residual_velocity_m_s", "areal_density_kg_m2", "outcome")},
    ),
}


@named(TABLES)
def test_a_table_has_the_shots_of_the_summary(results, name):
    file, key, columns = TABLES[name]
    rows = rows_of(results(name).folder, file)
    shots = summary_of(results(name), name)[key]
    for column, entry in columns.items():
        values = [row[column] for row in rows]
        if entry != "outcome":
            values = [pytest.approx(float(value), abs=6e-5) for value in values]
        assert [shot[entry] for shot in shots] == values


def test_the_table_of_a_v50_has_the_perforations_of_its_summary(results):
    told = summary_of(results("v50"), "v50")
    rows = rows_of(results("v50").folder, "shots.csv")
    assert told["perforated"] == sum(row["outcome"] == "perforated" for row in rows)
    velocities = {
        row["quantity"]: float(row["value [m/s]"])
        for row in rows_of(results("v50").folder, "v50.csv")
    }
    for name in ("V10", "V50", "V90"):
        assert velocities[name] == pytest.approx(told[f"{name.lower()}_m_s"], rel=1e-5)
    assert 0 < told["v10_m_s"] < told["v50_m_s"] < told["v90_m_s"]


@SOLID
def test_files_of_the_3d_crossover_are_read_back(results):
    told = summary_of(results("calibrate"), "calibrate")
    folder = results("calibrate").folder
    law = CompressionLaw.from_json(folder / "law.json")
    assert (law.a, law.b) == pytest.approx(
        (told["law"]["a_m"], told["law"]["b_m_N^(1/3)"]), rel=1e-12
    )
    surface = ResponseSurface.read(results("surface").folder / "surface.h5")
    assert np.allclose([surface.d1, surface.d2], [np.linspace(0, 1e-5, 5), np.linspace(0, 8e-6, 5)])
    # the shell's cell is another model of the same crossover: near, and not the same
    assert 0 < summary_of(results("surface"), "surface")["rms_from_the_shells_cell_N"]["T1"] < 10


def of_shot(s):
    yield f"not decided: {s['residual_velocity_m_s']:.3g} m/s at the end, "
    yield f"energy that the projectile lost [J] {s['absorbed_energy_J']:.4g} "
    yield f"deflection of the back face [mm] {1e3 * s['max_deflection_m']:.4g} "
    yield f"peak tension of the warp, of its strength [%] {100 * s['peak_tension_warp_over_strength']:.4g} "


SAID = {
    **dict.fromkeys(IMPACTS, of_shot),
    "v50": lambda s: [
        f"V50 {s['v50_m_s']:.3g} m/s ({s['v50_low_m_s']:.3g} to {s['v50_high_m_s']:.3g})",
    ],
    "coupon": lambda s: [
        f"shear stress {1e-6 * s['at_end']['shear stress']['value']:.4g} MPa",
        "shear angle 24 °",
    ],
    "pull-out": lambda s: [
        f"peak load {s['peak_load_N']:.4g} N",
        f"plateau load {s['plateau_load_N']:.4g} N",
    ],
    "export": lambda s: [f"biaxial plane {100 * s['error_over_strength'][0]['rms']:.1f} %"],
    "calibrate": lambda s: [f"fitted {1e3 * s['law']['a_m']:.4f} "],
    "surface": lambda s: [
        f"{s['equilibria']} equilibria",
        f"{s['error_of_left_out_lines']['T1']['rms']:.4g} ",
    ],
}


@named(SAID)
def test_the_report_has_the_numbers_of_the_summary(results, name):
    (page,) = results(name).folder.glob("*.html")
    text = re.sub(r"<style.*?</style>|<[^>]+>", " ", page.read_text("utf-8"), flags=re.DOTALL)
    text = " ".join(html.unescape(text).split())
    for words in SAID[name](summary_of(results(name), name)):
        assert words in text
