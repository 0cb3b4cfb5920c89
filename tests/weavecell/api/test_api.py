"""The Python interface: lazy, in SI or with units, one result object a run, and none of the pitfalls of the solvers."""

import doctest
import inspect
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

import h5py
import numpy as np
import pytest
from matplotlib import pyplot
from numpy.testing import assert_array_equal

import weavecell as wc
from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.base.schema import tables_in
from fabrics.compression import CompressionLaw
from shellfabric.membrane.indicator import Indicator
from tests.programs import printed
from tests.weavecell.session_runs import fired
from weavecell.answers.target import Target
from weavecell.api import keywords, quantities
from weavecell.api.target import resolve_target
from weavecell.scenes.impact import Scene
from weavecell.studies import lambert_jonas
from weavecell.studies.ballistic_limit import Limit, Shot

MINE = Path(__file__).parents[3] / "examples" / "fabrics" / "mine.toml"
SMALL = {"opening": "30 mm", "end_time": "15 us", "elements_per_crossover": 1}
CUT = {"mass": 1e-3, "diameter": 5e-3}
GIVEN = {"fabric": "S-720", "velocity": 90.0}


@pytest.fixture(scope="module")
def shot():
    return fired("impact")


def test_the_import_loads_nothing():
    code = "import sys, weavecell; print({'numpy', 'numba', 'pint'} & {m.split('.')[0] for m in sys.modules})"
    assert printed(code) == "set()"


def test_every_public_name_is_documented():
    assert wc.__all__ == sorted(wc.__all__)
    assert dir(wc) == wc.__all__
    assert all(getattr(wc, name).__doc__ for name in wc.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        wc.nothing  # noqa: B018


class Remembering:
    """weavecell, which computes what two examples have in common once: a function and its result show the same."""

    known: ClassVar[dict] = {}

    def __getattr__(self, name):
        value = getattr(wc, name)
        if name not in ("compare", "critical_velocity", "v50"):
            return value

        def call(*words, **options):
            if "out" in options:
                return value(*words, **options)
            files = sorted((path.name, path.read_bytes()) for path in Path().glob("*.*"))
            key = f"{name} {words} {options} {files}"
            if key not in self.known:
                self.known[key] = value(*words, **options)
            return self.known[key]

        return call


# studies of seconds, whose texts the golden texts hold
STUDIES = ("compare", "critical_velocity", "plies")
STUDIED = ("ComparisonResult", "CriticalVelocityResult", "PliesResult")


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.slow if name in STUDIES + STUDIED else ())
        for name in wc.__all__
        if name != "__version__"
    ],
)
def test_each_public_name_has_an_example_that_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (found,) = doctest.DocTestFinder(recurse=False).find(
        getattr(wc, name), name, module=False, globs={"wc": Remembering()}
    )
    assert found.examples, f"{name} has no example"
    skipped = any(doctest.SKIP in example.options for example in found.examples)
    # which need dolfinx and minutes, or a display
    solved = (
        "calibrate",
        "crossover",
        "surface",
        "view",
    )
    assert skipped == (
        name.removesuffix("Result").replace("Calibration", "calibrate").lower() in solved
    )
    assert doctest.DocTestRunner().run(found).failed == 0


def test_the_examples_of_quantities():
    assert doctest.testmod(quantities).failed == 0


def test_a_fabric_has_the_linear_density_of_scenes():
    """Without a word `catalogue.load` gives nominal yarns, and a run with them another mass (erratum E-07)."""
    effective = wc.fabric("S-720")
    nominal = wc.fabric("S-720", linear_density="nominal")
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
    law = CompressionLaw(4e-5, 5e-5, fabric="S-720")
    file = tmp_path / "law.json"
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


REFUSED = [  # keywords of a set-up
    ({"velocity": "3 kg"}, "velocity = '3 kg'"),
    ({"plie": 3}, "plie = 3: is not a keyword of setup, did you mean plies?"),
    (
        {"edge": "free"},
        "edge = 'free': is not a keyword of setup, did you mean boundary? keywords: weaving_damage, law, ",
    ),
    (
        {"edge_radius": 1.0},
        "edge_radius = 1.0: is not a keyword of setup, did you mean projectile=",
    ),
    ({"projectile": CUT}, "projectile.edge_radius: is missing"),
    ({"ply_gap": 1e-4}, "ply_gap = 0.0001: must be left out for a single ply"),
    ({"law": (1,)}, "law = (1,): must be a CompressionLaw"),
    ({"fabric": MINE}, "fabric mine has no compression law: give law=, or use"),
    ({"crossovers": "sliding"}, 'crossovers = \'sliding\': must be one of "pinned", "yarns"'),
]
REFUSED = [(lambda given=given: wc.setup(**GIVEN | given), told) for given, told in REFUSED]
REFUSED += [
    (lambda: wc.impact("S-720", 100.0, plie=3), "plie = 3: is not a keyword of impact, did you"),
    (lambda: wc.critical_velocity("S-720", plie=3), "plie = 3: is not a keyword of critical_veloc"),
    (lambda: wc.v50("S-720", plie=3), "plie = 3: is not a keyword of v50, did you mean plies?"),
]
REFUSED += [
    (lambda: wc.fabric("S-720", linear_density="o"), "linear_density = 'o': must be effective or"),
    (lambda: wc.coupon("S-720", "shear"), "test = 'shear': unknown test; allowed: bias_extension"),
    (
        lambda: wc.coupon("S-726", "pull_out", length=1),
        "length = 1: is not a keyword of a coupon's pull_out; ",
    ),
    (
        lambda: wc.critical_velocity(wc.setup("S-720", 100.0), opening=0.1),
        "opening: must be left out beside a set",
    ),
]
REFUSED += [  # keys that a function does not read, as in an input file
    (
        lambda: wc.v50("S-720", strength={"weibull_shape": 12.0}, check=True),
        "strength: must be left out: a V50 draws the strengths itself",
    ),
    (
        lambda: wc.v50("S-720", history={"warp": [0.001]}, check=True),
        "history: must be left out: the shots record nothing along yarns; `weavecell impact` does",
    ),
    (
        lambda: wc.setup("S-720", 60.0, history={"report_positions": [0.002]}),
        "history.report_positions = [0.002]: must be left out: `weavecell.setup` does not",
    ),
]


@pytest.mark.parametrize("call, told", REFUSED)
def test_bad_arguments_are_one_line(call, told):
    with pytest.raises(InputError) as problem:
        call()
    assert str(problem.value).startswith(told)
    assert "\n" not in str(problem.value)


@pytest.mark.parametrize("function", [wc.calibrate, wc.surface, wc.sweep])
def test_a_wrong_keyword_is_refused_by_the_function_that_was_called(function):
    with pytest.raises(InputError, match=f"^job = 2: .* {function.__name__}, did you mean jobs?"):
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


def test_a_shot_as_a_table(shot):
    table = shot.to_dataframe()
    assert list(table.columns[:3]) == ["time_s", "velocity_m_s", "nose_position_m"]
    assert_array_equal(table["energy_kinetic_projectile_J"], shot.energies["kinetic_projectile"])
    for name in ("time_s", "deflection_m", "contact_force_N"):
        assert_array_equal(table[name], getattr(shot, name.rpartition("_")[0]))


def test_a_shot_as_figures(shot):
    assert shot.plot().axes[0].get_ylabel() == "velocity of the projectile [m/s]"
    picture = shot.plot_panel()
    words = (
        f"{1e6 * shot.time[-1]:.0f} µs after the strike, projectile at {shot.velocity[-1]:.0f} m/s"
    )
    assert words in " ".join(text.get_text() for text in picture.texts)
    assert picture.axes[0].images[0].get_array().std() > 5  # not an empty picture


def test_a_shot_is_an_xarray_over_time_and_ply(shot):
    pytest.importorskip("xarray")
    table = shot.to_xarray()
    assert table.deflection.dims == ("time",)
    assert table.ply_energy.dims == ("time", "ply")
    assert_array_equal(table.ply_energy, shot.plies["energy"])
    assert table.contact_force.units == "N"
    assert table.energy_friction.units == "J"


def test_a_shot_writes_the_files_of_the_command(shot, results, tmp_path):
    folder = results("impact").folder
    assert shot.to_vtk(tmp_path / "vtk") == tmp_path / "vtk" / "panel.pvd"
    for path in (folder / "panel").iterdir():
        assert (tmp_path / "vtk" / "panel" / path.name).read_bytes() == path.read_bytes()
    shot.write(tmp_path / "histories.h5")
    # the axis has a name and values, as netCDF and xarray take it
    with h5py.File(tmp_path / "histories.h5") as file:
        assert file["histories/velocity"].dims[0][0] == file["histories/time"]


def test_a_sweep_of_one_job_starts_no_process(monkeypatch):
    monkeypatch.setattr("fabrics.base.executors.ProcessPoolExecutor", None)
    pinned = SMALL | {"crossovers": "pinned"}
    found = wc.sweep([wc.setup("S-720", v, **pinned) for v in (100.0, 150.0)])
    assert [one.strike_velocity for one in found] == [100.0, 150.0]
    assert found.summary() == {"shots": 2, "in flight": 2, "doubtful": 0, "checks": "ok"}
    assert found[1].residual_velocity > found[0].residual_velocity
    assert found.plot().axes[0].get_xlabel() == "strike velocity [m/s]"
    assert len(found.to_dataframe()) == len(found) == 2


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


def test_a_doubtful_shot_warns_at_the_line_of_the_user_of_the_check_that_fails(doubtful):
    (told, *_), found = doubtful
    assert told.filename == __file__
    assert str(told.message).startswith(f"S-720, 92.5 m/s: in flight: {COARSE_SPACING}")
    assert [one.name for one in found.checks if one.doubtful] == ["contact point spacing"]


def test_a_doubtful_shot_says_so_as_text_in_a_notebook_and_in_tables(doubtful):
    _, found = doubtful
    table = found.to_dataframe()["checks"].iloc[-1]
    for text in (repr(found), found._repr_html_(), found.summary()["checks"], table):
        assert COARSE_SPACING in text


def test_a_sweep_counts_its_doubtful_shots():
    said = "sweep of 2 shots, doubtful at 92.5 m/s; worst: doubtful: contact"
    pinned = SMALL | {"crossovers": "pinned"}
    setups = [wc.setup("S-720", 92.5, **pinned, **options) for options in (COARSE, {})]
    with pytest.warns(wc.DoubtfulResult, match=said):
        shots = wc.sweep(setups)
    assert shots.doubtful
    assert shots.summary()["doubtful"] == 1
    assert [text.split(":")[0] for text in shots.to_dataframe()["checks"]] == ["doubtful", "ok"]


@pytest.mark.parametrize("call", [wc.impact, wc.setup, wc.v50])
def test_notes_of_a_set_up_warn_at_the_line_of_the_user(call):
    target = ("S-726", 96.0)
    more = {"end_time": "5 us"}
    if call is wc.v50:
        target = ("S-726",)
        more = {"shots": 8, "check": True}
    with pytest.warns(UserWarning, match="the edges follow yarns") as told:
        call(*target, opening="28 mm", weave_angle="30 deg", symmetry="whole", **more)
    edges = [one.filename for one in told if "edges" in str(one.message)]
    assert edges == [__file__]


GOOD, BAD = (Indicator("viscous energy", value, 0.15) for value in (0.05, 0.31))


@pytest.mark.parametrize(
    "slow, fast, said", [(BAD, GOOD, "100"), (GOOD, BAD, "120"), (GOOD, GOOD, "")]
)
def test_a_bracket_on_a_doubtful_shot_says_so(slow, fast, said):
    """Of stops at 100 and 120 m/s and a perforation between them, which make the outcomes mixed."""
    fired = ((100.0, "stopped", slow), (110.0, "perforated", GOOD), (120.0, "stopped", fast))
    shots = [
        Shot(v, 0.0, outcome, 1e-4, 0, (1.0, 1.0), 0.0, 0.0, (check,))
        for v, outcome, check in fired
    ]
    target = Target(None, wc.setup("S-720", 100.0), "", "S-720", from_file=False)
    too_few = lambert_jonas.fit(np.array([]), np.array([]))
    found = wc.CriticalVelocityResult(target, Limit(100.0, 110.0, tuple(shots)), too_few)
    told = "ok"
    if said:
        told = f"doubtful stopped shot at {said} m/s (viscous energy 0.310 (limit 0.15))"
        with pytest.warns(wc.DoubtfulResult, match=f"stopped shot at {said} m/s"):
            found.warn()
    assert found.bracket_checks == told
    assert told in found.summary()["bracket_checks"]


def test_coupons_as_tables_and_figures(tmp_path):
    size = {"length": "20 mm", "width": "10 mm", "strain": "1 %"}
    strip = wc.coupon("S-720", "uniaxial", direction="warp", steps=2, **size)
    assert strip.to_dataframe()["load_of_a_yarn_N"].iloc[-1] > 0
    assert strip.to_vtk(tmp_path) == tmp_path / "coupon.pvd"
    assert "load" in strip.plot().axes[0].get_ylabel()


def test_steps_of_slack_yarns_are_marked_wherever_a_coupon_is_shown():
    size = {"length": "16 mm", "width": "7 mm", "strain": "3.3 %"}
    strip = wc.coupon("S-720", "uniaxial", direction="warp", steps=3, **size)
    reactions = [state.history[-1, 1] for state in strip.solved.states]
    floor = strip.solved.force_floor
    assert reactions[0] < 3 * floor < 30 * floor < reactions[1]
    assert list(strip.to_dataframe()["unloaded"]) == [1, 0, 0]
    assert list(strip.table()["state"]) == ["unloaded", "", ""]
    assert "unloaded in 1 of 3 load steps (1): the yarns are slack" in strip.details()
    assert "unloaded" not in strip.table()
    for name in ("load", "strains"):
        caption, draw, arguments = strip.figures()[name]
        assert "Hollow points: unloaded" in caption
        (axes,) = draw(pyplot, *arguments).axes
        hollow = [line for line in axes.lines if line.get_label().endswith(", unloaded")]
        assert len(hollow) == len(arguments[1])
        for line in hollow:
            assert line.get_xdata() == pytest.approx([1.1])
            assert line.get_markerfacecolor() == "white"


@pytest.mark.slow(25)
@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult")
def test_a_pack_has_a_critical_velocity_and_a_v50(tmp_path):
    """Of a set-up and of keywords the same; without scatter of the yarns V50 is near the limit."""
    panel = {"plies": 2, "ply_gap": "0.1 mm", "opening": "24 mm", "elements_per_crossover": 1}
    nose = {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm", "friction": 0}
    panel |= {"projectile": nose, "crossovers": "pinned"}
    search = {"tolerance": "20 m/s", "residual_shots": 1, "scan": False}
    found = wc.critical_velocity("S-720", **search, **panel, end_time="1 us")  # not used
    low, high = found.bracket
    setup = wc.setup("S-720", 300.0, **panel)
    again = resolve_target(setup, {}, "limit").setup
    same = {"strike_velocity": 300.0, "end_time": 1e-6}
    assert replace(again, **same) == replace(found.target.setup, **same)
    assert low < high <= low + 20
    assert found.v50.low < found.critical_velocity < found.v50.high
    assert found.summary()["plies"] == 2
    assert list(found.to_dataframe()["strike_velocity_m_s"]) == sorted(
        s.strike_velocity for s in found.limit.shots
    )
    (above,) = found.plot().texts
    assert above.get_text().startswith("DOUBTFUL: ")
    curve = wc.v50("S-720", shots=12, batch=4, out=tmp_path, **panel)
    assert curve.v50 == pytest.approx(found.critical_velocity, abs=20.0)
    assert curve.plot().axes[0].get_ylabel() == "share that passes [-]"


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
