"""The Python interface: lazy, in SI or with units, one result object a run, and none of the pitfalls of the solvers."""

import doctest
import inspect
import math
import re
import subprocess
import sys
from contextlib import suppress
from dataclasses import replace
from math import inf
from pathlib import Path

import h5py
import numpy as np
import pytest

import weavecell as wc
from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.base.schema import tables_in
from fabrics.compression import CompressionLaw
from shellfabric.panel.quality import Indicator
from tests.weavecell.session_runs import fired
from weavecell.api import keywords, quantities
from weavecell.scenes.impact import Scene
from weavecell.scenes.target import Target
from weavecell.studies import lambert_jonas, sweep
from weavecell.studies.ballistic_limit import Limit, Shot

MINE = Path(__file__).parents[3] / "examples" / "fabrics" / "mine.toml"
SMALL = {"opening": "30 mm", "end_time": "15 us", "elements_per_crossover": 1}
CUT = {"mass": 1e-3, "diameter": 5e-3}


@pytest.fixture(scope="module")
def shot():
    return fired("impact")


def test_the_import_loads_nothing():
    code = "import sys, weavecell; print({'numpy', 'numba', 'pint'} & {m.split('.')[0] for m in sys.modules})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def test_every_public_name_is_documented():
    assert wc.__all__ == sorted(wc.__all__)
    assert dir(wc) == wc.__all__
    assert all(getattr(wc, name).__doc__ for name in wc.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        wc.nothing  # noqa: B018


@pytest.mark.parametrize("name", [name for name in wc.__all__ if name != "__version__"])
def test_each_public_name_has_an_example_that_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (found,) = doctest.DocTestFinder(recurse=False).find(
        getattr(wc, name), name, module=False, globs={"wc": wc}
    )
    assert found.examples, f"{name} has no example"
    skipped = any(doctest.SKIP in example.options for example in found.examples)
    solved = (
        "calibrate",
        "crossover",
        "surface",
        "view",
    )  # which need dolfinx and minutes, or a display
    assert skipped == (
        name.removesuffix("Result").replace("Calibration", "calibrate").lower() in solved
    )
    assert doctest.DocTestRunner().run(found).failed == 0


def test_the_examples_of_quantities():
    assert doctest.testmod(quantities).failed == 0


def test_a_fabric_has_the_linear_density_of_scenes():
    """Without a word `catalogue.load` gives nominal yarns, and a run with them another mass (erratum E-07)."""
    effective, nominal = wc.fabric("S-720"), wc.fabric("S-720", linear_density="nominal")
    assert effective == catalogue.load("S-720").with_effective_density()
    assert effective.weave.areal_density > nominal.weave.areal_density


def test_numbers_are_in_si_units_and_a_projectile_may_be_its_name():
    cut = {"mass": "1.1 g", "diameter": 5.4e-3, "edge_radius": "0.3 mm"}
    given = wc.setup(
        "S-720", 92.5, projectile=cut, opening=("0.1 m", 0.2), history={"interval": 1e-6}
    )
    assert given == wc.setup(
        "S-720", "333 km/h", projectile=cut, opening=(0.1, "20 cm"), history={"interval": "1 us"}
    )
    name = "FSP 1.10 g"
    made = [wc.setup("S-720", 90.0, projectile=one).projectile for one in (name, {"name": name})]
    assert made[0] == made[1]
    turned = wc.setup(
        "S-720",
        90.0,
        projectile={"name": name, "mass": 1.13e-3, "roll": "45 deg"},
        symmetry="whole",
    )
    assert (turned.projectile.mass, turned.projectile.radius) == pytest.approx(
        (1.13e-3, made[0].radius)
    )


def test_a_lay_up_is_that_of_a_scene():
    """A ply that names nothing is of the set-up's fabric and law, another of its own published one."""
    law = CompressionLaw(4e-5, 5e-5)
    given = wc.setup(
        "S-728",
        100.0,
        law=law,
        ply=[{"count": 2, "gap": 1e-4}, {"name": "S-726", "angle": "90 deg"}],
    )
    assert given.title == "2 x S-728 + 1 x S-726 at 90 deg"
    assert [ply.laws[0] == law for ply in given.lay_up] == [True, True, False]
    assert [(ply.angle, ply.gap) for ply in given.lay_up] == [
        (0.0, 1e-4),
        (0.0, 1e-4),
        (math.pi / 2, None),
    ]
    assert given.symmetry == "quarter"
    assert given.fabric == given.lay_up[0].fabric
    angled = wc.setup(
        "S-728",
        100.0,
        ply=[{"angle": angle} for angle in ("30 deg", "-90 deg", "135 deg", "180 deg")],
    )
    assert [math.degrees(ply.angle) for ply in angled.lay_up] == pytest.approx(
        [30, 90, -45, 0], abs=1e-12
    )
    assert angled.symmetry == "whole"
    assert (
        angled.name
        == "1 x S-728 at 30 deg + 1 x S-728 at 90 deg + 1 x S-728 at -45 deg + 1 x S-728"
    )


def test_one_law_serves_both_families_of_its_own_fabric(tmp_path):
    """By its name: variants of the fabric take it, and a law without a name is of any fabric."""
    law, file = CompressionLaw(4e-5, 5e-5, fabric="S-720"), tmp_path / "law.json"
    law.to_json(file)
    for given in (law, (law, law), file, str(file), {"a": 4e-5, "b": "5e-5 m N^(1/3)"}):
        for fabric in ("S-720", wc.fabric("S-720").with_yarns(crimp=0.01)):
            assert [(one.a, one.b) for one in wc.setup(fabric, 100.0, law=given).laws] == [
                (4e-5, 5e-5)
            ] * 2
        if not isinstance(given, dict):
            with pytest.raises(
                InputError, match=r"law.*: is a law of fabric S-720; must be a law of S-728, or its"
            ):
                wc.setup("S-728", 100.0, law=given)
    with pytest.raises(InputError, match="is a law of fabric S-720; must be a law of S-726"):
        wc.setup("S-720", 100.0, ply=[{"count": 2}, {"name": "S-726", "law": str(file)}])
    assert wc.setup("S-728", 100.0, law=replace(law, fabric="")).laws[0].a == 4e-5


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: wc.setup("S-720", "3 kg"), "velocity = '3 kg'"),
        (
            lambda: wc.setup("S-720", 90.0, plie=3),
            "plie = 3: is not a keyword, did you mean plies?",
        ),
        (
            lambda: wc.setup("S-720", 90.0, edge="free"),
            "edge = 'free': is not a keyword; keywords: weaving_damage, law, ",
        ),
        (
            lambda: wc.setup("S-720", 90.0, edge_radius=1.0),
            "edge_radius = 1.0: is not a keyword, did you mean projectile=",
        ),
        (lambda: wc.setup("S-720", 90.0, projectile=CUT), "projectile.edge_radius: is missing"),
        (
            lambda: wc.setup("S-720", 90.0, ply_gap=1e-4),
            "ply_gap = 0.0001: must be left out for a single ply",
        ),
        (lambda: wc.setup("S-720", 90.0, law=(1,)), "law = (1,): must be a CompressionLaw"),
        (lambda: wc.setup(MINE, 90.0), "fabric mine has no compression law: give law=, or use"),
        (
            lambda: wc.fabric("S-720", linear_density="other"),
            "linear_density = 'other': must be effective or nominal",
        ),
        (lambda: wc.coupon("S-720", "shear"), "test = 'shear': must be one of bias_extension"),
        (lambda: wc.coupon("S-726", "pull_out", length=1), "length = 1: must be one of "),
        (
            lambda: wc.critical_velocity(wc.setup("S-720", 100.0), opening=0.1),
            "opening: must be left out beside a set",
        ),
    ],
)
def test_bad_arguments_are_one_line(call, told):
    with pytest.raises(InputError) as problem:
        call()
    assert str(problem.value).startswith(told)
    assert "\n" not in str(problem.value)


@pytest.mark.parametrize("function", [wc.calibrate, wc.surface, wc.sweep])
def test_a_wrong_keyword_is_refused_by_the_function_that_was_called(function):
    with pytest.raises(TypeError, match=rf"^{function.__name__}\(\) .* 'job'. Did you mean 'jobs'"):
        function("S-720", job=2)


@pytest.mark.parametrize("name", ["compare", "critical_velocity", "impact", "setup", "v50"])
def test_help_has_every_keyword_with_its_meaning_and_what_is_allowed(name):
    told = " ".join(inspect.getdoc(getattr(wc, name)).split())
    for key, table in keywords.tables().items():
        assert f" {key} : " in told
        if table:
            (kind,) = tables_in(Scene.model_fields[table].annotation)
            field = kind.model_fields[key]
            assert f"; {' '.join(field.description.split())}" in told or key == "ply"
            meaning = re.sub(r"\s*\(\[.*?\]\(.*?\)\)", "", field.title or "")
            assert meaning in told


def test_a_shot_as_text(shot):
    assert shot.outcome == "in flight"
    assert "in flight" in repr(shot)
    assert "<td>in flight</td>" in shot._repr_html_()


def test_a_shot_as_a_summary(shot):
    summary = shot.summary()
    areal_density = wc.fabric("S-720").weave.areal_density
    assert summary["areal_density_kg_m2"] == pytest.approx(areal_density)
    assert summary["max_deflection_m"] == shot.deflection.max() > 0


def test_a_shot_as_a_table(shot):
    table = shot.to_dataframe()
    assert list(table.columns[:3]) == ["time_s", "velocity_m_s", "nose_position_m"]
    assert np.array_equal(table["energy_kinetic_projectile_J"], shot.energies["kinetic_projectile"])
    for name in ("time_s", "deflection_m", "contact_force_N"):
        assert np.array_equal(table[name], getattr(shot, name.rpartition("_")[0]))


def test_the_impulse_is_what_the_projectile_has_lost(shot):
    impulse = (shot.contact_force[1:] * np.diff(shot.time)).sum()
    assert 100 < shot.residual_velocity < shot.strike_velocity == 155
    assert impulse == pytest.approx(shot.mass * (155 - shot.residual_velocity), rel=1e-9)


def test_a_shot_as_figures(shot):
    assert shot.plot().axes[0].get_ylabel() == "velocity of the projectile [m/s]"
    picture = shot.plot_panel()
    assert shot.outcome in " ".join(text.get_text() for text in picture.texts)
    assert picture.axes[0].images[0].get_array().std() > 5  # not an empty picture


def test_a_shot_is_an_xarray_over_time_and_ply(shot):
    pytest.importorskip("xarray")
    table = shot.to_xarray()
    assert (table.deflection.dims, table.ply_energy.dims) == (("time",), ("time", "ply"))
    assert np.array_equal(table.ply_energy, shot.plies["energy"])
    assert (table.contact_force.units, table.energy_friction.units) == ("N", "J")


def test_a_shot_writes_the_files_of_the_command(shot, results, tmp_path):
    folder = results("impact").folder
    assert shot.to_vtk(tmp_path / "vtk") == tmp_path / "vtk" / "panel.pvd"
    for path in (folder / "panel").iterdir():
        assert (tmp_path / "vtk" / "panel" / path.name).read_bytes() == path.read_bytes()
    shot.write(tmp_path / "histories.h5")
    with h5py.File(
        tmp_path / "histories.h5"
    ) as file:  # the axis has a name and values, as netCDF and xarray take it
        assert file["histories/velocity"].dims[0][0] == file["histories/time"]


def test_a_sweep_of_one_job_starts_no_process(monkeypatch):
    monkeypatch.setattr("fabrics.base.executors.ProcessPoolExecutor", None)
    found = wc.sweep([wc.setup("S-720", v, **SMALL) for v in (100.0, 150.0)])
    assert [one.strike_velocity for one in found] == [100.0, 150.0]
    assert found.summary() == {"shots": 2, "in flight": 2, "doubtful": 0, "checks": "ok"}
    assert found[1].residual_velocity > found[0].residual_velocity
    assert found.plot().axes[0].get_xlabel() == "strike velocity [m/s]"
    assert len(found.to_dataframe()) == len(found) == 2


def test_assumed_laws_are_named_and_ranged():
    law = CompressionLaw(4e-5, 5e-5, assumed_range=((5e-5, 4e-5), (3e-5, 5e-5)))
    found = wc.impact(MINE, 90.0, law=law, assumed_range=True, **SMALL)
    assert found.assumed[0].startswith("assumed: crimp 1.57 / 0.55 % of warp / weft")
    assert found.assumed[2].startswith("assumed: [shear] of para-aramid yarns")
    alone = [row for row in found.assumed_range.rows if row.varied]
    assert (
        len(alone) == 12
    )  # two ends each of trellis, solid law, thickness, warp share, length; of the set-up two
    assert {"crimp", "trellis law", "solid law", "failure length"} < set(found.assumed_range.shares)
    assert found.assumed_range.low <= found.residual_velocity <= found.assumed_range.high
    assert found.assumed_range.low < found.assumed_range.high
    assert "assumed_range" in found.summary()


def test_a_stopped_projectile_has_no_residual_velocity():
    """The run ends in the step in which the projectile turns back; its velocity there is none of rebound."""
    found = wc.impact("S-720", 10.0, opening="30 mm")
    assert found.outcome == "stopped"
    assert (
        found.velocity[-1]
        < 0.0
        == found.residual_velocity
        == found.summary()["residual_velocity_m_s"]
    )
    assert "residual velocity 0 m/s" in repr(found)


COARSE = {
    "projectile": CUT | {"mass": "3 g", "edge_radius": "0.05 mm"},
    "numerics": {"contact_points": 8},
}


COARSE_SPACING = "doubtful: contact point spacing"


@pytest.fixture(scope="module")
def doubtful():
    """(the warnings of a shot whose contact points are too far apart, the shot)"""
    with pytest.warns(wc.DoubtfulResult) as told:
        return told, wc.impact("S-720", 92.5, **SMALL, **COARSE)


def test_a_sound_shot_is_not_doubtful(shot):
    assert not shot.doubtful
    assert {one.name for one in shot.checks} >= {"energy error", "viscous energy"}


def test_a_check_says_its_name_and_what_it_means(shot):
    for one in shot.checks:
        assert one.text.startswith(one.name)
        assert one.meaning in one.text


def test_a_doubtful_shot_warns_at_the_line_of_the_user(doubtful):
    (told, *_), _ = doubtful
    assert told.filename == __file__
    assert str(told.message).startswith(f"S-720, 92.5 m/s: in flight: {COARSE_SPACING}")


def test_the_check_that_fails_is_doubtful_alone(doubtful):
    _, found = doubtful
    assert found.doubtful
    assert [one.name for one in found.checks if one.doubtful] == ["contact point spacing"]


@pytest.mark.parametrize(
    "text_of",
    [
        repr,
        lambda found: found._repr_html_(),
        lambda found: found.summary()["checks"],
        lambda found: found.to_dataframe()["checks"].iloc[-1],
    ],
    ids=["text", "notebook", "summary", "table"],
)
def test_a_doubtful_shot_says_so(doubtful, text_of):
    assert COARSE_SPACING in text_of(doubtful[1])


def test_a_row_of_a_sweep_says_that_its_shot_is_doubtful():
    row = sweep.shot(wc.setup("S-720", 92.5, **SMALL, **COARSE))
    assert row["checks"].startswith(f"{COARSE_SPACING} ")


def test_a_sweep_counts_its_doubtful_shots():
    said = "sweep of 2 shots, doubtful at 92.5 m/s; worst: doubtful: contact"
    setups = [wc.setup("S-720", 92.5, **SMALL, **options) for options in (COARSE, {})]
    with pytest.warns(wc.DoubtfulResult, match=said):
        shots = wc.sweep(setups)
    assert shots.doubtful
    assert shots.summary()["doubtful"] == 1
    assert [text.split(":")[0] for text in shots.to_dataframe()["checks"]] == ["doubtful", "ok"]


@pytest.mark.parametrize("call", [wc.impact, wc.setup, wc.v50])
def test_notes_of_a_set_up_warn_at_the_line_of_the_user(call):
    target, more = ("S-726", 96.0), {"end_time": "5 us"}
    if call is wc.v50:
        target, more = ("S-726",), {"shots": 0}  # refused, after the set-up is made
    with (
        pytest.warns(UserWarning, match="energy up to 15 % too high") as told,
        suppress(InputError),
    ):
        call(*target, opening="28 mm", boundary="free", **more)
    assert [one.filename for one in told] == [__file__]


def test_yarns_that_slip_at_crossovers_are_refused():
    said = """crossovers = 'sliding': must be one of "pinned", "yarns\""""
    with pytest.raises(InputError, match=said):
        wc.setup("S-726", 96.0, crossovers="sliding")


def test_a_bracket_on_a_doubtful_shot_says_so():
    good, bad = (
        Indicator("viscous energy", value, 0.15, "", "share", 0.1) for value in (0.05, 0.31)
    )
    shots = [
        Shot(v, 0.0, outcome, 1e-4, 0, (1.0, 1.0), 0.0, 0.0, (one,))
        for v, outcome, one in (
            (90.0, "stopped", bad),
            (110.0, "perforated", good),
            (100.0, "stopped", bad),
        )
    ]
    target = Target(None, wc.setup("S-720", 100.0), "", "S-720", from_file=False)
    too_few = lambert_jonas.fit(np.array([]), np.array([]))
    found = wc.CriticalVelocityResult(target, Limit(100.0, 110.0, tuple(shots)), too_few)
    assert found.doubtful
    assert (
        found.bracket_checks
        == "doubtful stopped shot at 100 m/s (viscous energy 0.310 (limit 0.15))"
    )
    assert found.bracket_checks in repr(found)
    with pytest.warns(
        wc.DoubtfulResult, match="the limit rests on a doubtful stopped shot at 100 m/s"
    ):
        found.warn()
    assert list(found.to_dataframe()["checks"]) == ["doubtful", "doubtful", "ok"]
    sound = replace(
        found, limit=Limit(100.0, 110.0, tuple(replace(shot, checks=(good,)) for shot in shots))
    )
    assert (sound.bracket_checks, sound.doubtful) == ("ok", False)
    faster = Shot(
        120.0, 0.0, "stopped", 1e-4, 0, (1.0, 1.0), 0.0, 0.0, (bad,)
    )  # makes the outcomes mixed
    mixed = replace(sound, limit=Limit(100.0, 110.0, (*sound.limit.shots, faster)))
    assert (
        mixed.bracket_checks
        == "doubtful stopped shot at 120 m/s (viscous energy 0.310 (limit 0.15))"
    )


def test_coupons_as_tables_and_figures(tmp_path):
    strip = wc.coupon(
        "S-720", "uniaxial", direction="warp", length="20 mm", width="10 mm", strain="1 %", steps=2
    )
    assert strip.outcome == "complete"
    assert strip.to_dataframe()["load_of_a_yarn_N"].iloc[-1] > 0
    assert strip.to_vtk(tmp_path) == tmp_path / "coupon.pvd"
    pulled = wc.coupon(
        "S-726",
        "pull_out",
        displacement="0.3 mm",
        crossings=10,
        crossover_friction=0.0,
        crossover_cohesion="0.5 N",
    )
    assert pulled.plateau == pytest.approx(5.0, rel=0.03)
    assert pulled.summary()["peak_load_N"] == pulled.peak == pulled.to_dataframe()["load_N"].max()
    assert all("load" in found.plot().axes[0].get_ylabel() for found in (strip, pulled))


@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult")
def test_a_pack_has_a_critical_velocity_and_a_v50(tmp_path):
    """Of a set-up and of keywords the same; without scatter V50 is the limit; shots are kept and taken again."""
    panel = {"plies": 2, "ply_gap": "0.1 mm", "opening": "40 mm", "elements_per_crossover": 1}
    search = {"tolerance": "10 m/s", "residual_shots": 3, "scan": False}
    found = wc.critical_velocity(
        "S-720", **search, **panel, end_time="1 us", snapshot_interval="1 us"
    )  # not used
    assert (
        found.bracket == wc.critical_velocity(wc.setup("S-720", 300.0, **panel), **search).bracket
    )
    low, high = found.bracket
    assert low < found.critical_velocity < high <= low + 10
    assert found.lambert_jonas is not None
    assert found.summary()["plies"] == 2
    assert list(found.to_dataframe()["strike_velocity_m_s"]) == sorted(
        s.strike_velocity for s in found.limit.shots
    )
    assert found.plot().axes[0].get_title(loc="left") == "2 x S-720"
    alike = {
        "shots": 8,
        "batch": 4,
        "weibull_shape": inf,
        "modulus_cov": 0.0,
        "crimp_cov": 0.0,
        "out": tmp_path,
    }
    curve = wc.v50("S-720", **alike, **panel)
    assert curve.v50 == pytest.approx(found.critical_velocity, abs=10.0)
    assert curve.summary()["shots"] == 8 == len(curve.to_dataframe())
    assert curve.plot().axes[1].get_ylabel() == "residual velocity [m/s]"
    before = {file: file.stat().st_mtime_ns for file in (tmp_path / "runs").iterdir()}
    assert wc.v50("S-720", **alike, **panel, resume=True).study == curve.study
    assert {file: file.stat().st_mtime_ns for file in (tmp_path / "runs").iterdir()} == before


def test_a_shot_without_velocity_and_the_folder_of_a_set_up_are_refused_before_a_run(tmp_path):
    with pytest.raises(InputError, match="velocity: is missing"):
        wc.impact("S-720", **SMALL)
    with pytest.raises(InputError, match="out: must be left out beside a set-up"):
        wc.impact(wc.setup("S-720", 100.0, **SMALL), out=tmp_path / "r")
    assert not (tmp_path / "r").exists()


@pytest.mark.parametrize("name", ["draws", "fit", "projectile", "sensitivity"])
def test_what_was_removed_says_what_to_use(name):
    with pytest.raises(AttributeError, match=f"weavecell.{name} was removed: (use|give) "):
        getattr(wc, name)
