"""What report, forecast and summary say of a shot follows each key of its input: headline, settings or assumptions
change."""

import pytest

import weavecell as wc
from shellfabric.impact import in_words
from tests.scene_text import merged, toml
from tests.weavecell.scenes.test_keys_reach import ENTRIES, LEAST, ROOT, SHOT, row, with_value
from weavecell.answers.wording import Wording
from weavecell.report import chapters
from weavecell.report.shot import chapters_shot
from weavecell.runs import table
from weavecell.scenes import build
from weavecell.scenes.impact import check

# what is written and when, and what is said of data in chapters of their own
ELSEWHERE = {
    "title",
    "run.checkpoint_interval",
    "run.outputs",
    "history.report_positions",
    "fabric.weaving_damage.source",
    "panel.ply.weaving_damage.source",
    "fabric.weaving_damage.status",
    "panel.ply.weaving_damage.status",
}


def said(table):
    """Headline, settings and assumptions of a scene."""
    scene = check(table, None, "shot")
    case = build.build(scene, None, "s")
    setup = build.setup(case, None)
    report = (
        chapters.describe_shot(setup, scene, velocity=True),
        chapters_shot.settings(setup).rows,
        chapters_shot.assumptions(setup, ()).tables[0].rows,
        # the chapter of the cell writes both
        (case.law_name, str(case.laws)),
    )
    forecast = (report[0], in_words.list_assumptions(setup), in_words.list_choices(setup))
    return report, forecast


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("key", [key for key in ENTRIES if key not in ELSEWHERE])
def test_a_key_is_told(key, monkeypatch):
    monkeypatch.chdir(ROOT)
    context, value, *_ = row(key)
    table = key.partition(".")[0]
    base = merged(merged(SHOT, {table: LEAST.get(table, {})}), context)
    report, forecast = said(with_value(base, key, value))
    plain, plain_forecast = said(base)
    assert report != plain
    assert forecast != plain_forecast


# a shot of each model, and what its report alone says
BODY = {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm"}
ONE_OF = {
    "projectile": {
        "Rigid.": {},
        "Elastic-plastic along its axis, and rigid across it.": {"body": "elastic_bar"},
        "Of metal, of lead-antimony in a jacket of gilding metal: a body of revolution": "9 mm FMJ 8.0 g",
    },
    "crossovers": {
        "Warp and weft are pinned to each other at every crossover": {},
        "Yarns are resolved within 9 mm of the impact point": {
            "crossovers": "yarns",
            "zone": "9 mm",
        },
    },
    "failure of yarns": {
        ", at any strain rate; it is the same for all yarns.": {},
        ", multiplied by what its strain rate makes of it; it is the same": {
            "rate_dependence": True
        },
        ", at any strain rate; each yarn has a drawn strength": {
            "strength": {"weibull_shape": 14.0}
        },
        "Yarns do not fail.": {"yarn_failure": False},
    },
    "strain rate": {
        "Stiffness and strength of the yarns do not depend on it.": {},
        "S-720: strength 1 to 1.57 times that of slow tests, modulus 1.23 times": {
            "rate_dependence": True
        },
    },
    "edges": {
        "All yarn ends are clamped. A quarter of the panel": {},
        "All yarn ends are free. A quarter of the panel": {"boundary": "free"},
        "Warp ends are clamped; Weft ends are held by friction up to 20 N a yarn.": {
            "boundary": {"weft": {"clamp_force": "20 N"}}
        },
    },
    "between plies": {
        "Friction 0.2, assumed 0.15 to 0.25.": {"plies": 2},
        "No friction.": {"plies": 2, "ply_friction": 0.0},
        "Friction 0.25. Plies at rest are 0.1 mm apart.": {
            "plies": 2,
            "ply_friction": 0.25,
            "ply_gap": "0.1 mm",
        },
    },
    "block behind": {
        ", of the block of gelatine 20 %. Its outer faces are fixed. The run ends": {
            "backing": "gelatine 20 %"
        },
        "Its outer faces are absorbing. It is followed for 2 ms after": {
            "backing": {"modulus": "100 MPa", "outer_boundary": "absorbing", "after_stop": "2 ms"}
        },
    },
}


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(
    "of, sentence", [(of, sentence) for of, shots in ONE_OF.items() for sentence in shots]
)
def test_a_report_says_what_its_run_assumes_and_nothing_of_another_model(of, sentence):
    options = ONE_OF[of][sentence]
    if of == "projectile":
        shot = options if isinstance(options, str) else BODY | options
        options = {"projectile": shot}
    setup = wc.setup("S-720", "155 m/s", opening="60 mm", **options)
    told = dict(chapters_shot.assumptions(setup, ()).tables[0].rows)[of]
    assert [known for known in ONE_OF[of] if known in told] == [sentence], told


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_shot_that_leans_says_how_it_flies():
    chisel = {"shape": "chisel", "flat_width": "2.5 mm", "flat_angle": "35 deg"}
    shot = (
        BODY
        | chisel
        | {"obliquity": "20 deg", "azimuth": "30 deg", "yaw": "5 deg", "roll": "10 deg"}
    )
    setup = wc.setup("S-720", "155 m/s", opening="60 mm", symmetry="whole", projectile=shot)
    told = dict(chapters_shot.assumptions(setup, ()).tables[0].rows)["projectile"]
    assert told == (
        "Rigid. It flies at 20° to the normal, towards 30° from the warp. Its axis leans 5° from its flight. It is "
        "turned by 10° about its axis. It keeps this attitude: nothing turns it. Friction on the fabric 0.1, assumed "
        "0 to 0.2."
    )


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_forecast_says_what_the_report_says():
    options = {
        "opening": "20 mm",
        "end_time": "10 us",
        "yarn_failure": False,
        "numerics": {"cfl": 0.7},
    }
    size = wc.impact("S-720", "155 m/s", check=True, **options)
    setup = wc.impact.plan("S-720", "155 m/s", **options).target.setup
    rows = chapters_shot.assumptions(setup, ()).tables[0].rows
    assert list(size.assumptions) == [": ".join(one) for one in rows]
    assert "Yarns do not fail." in str(size)
    assert "cfl 0.7" in str(size)
    assert "20 mm square and clamped, struck at 155 m/s by a cylinder of 3 g" in str(size)
    told = size.summary()
    assert told["shot"] in str(size)
    assert told["settings"] in str(size)


SMALL = {"opening": "20 mm", "end_time": "10 us", "yarn_failure": True, "numerics": {"cfl": 0.7}}


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("study", ["critical_velocity", "v50"])
def test_the_check_of_a_study_says_what_its_report_says(study):
    size = getattr(wc, study)("S-720", check=True, **SMALL)
    setup = getattr(wc, study).plan("S-720", **SMALL).target.setup
    drawn = study == "v50"
    if drawn:
        setup = table.as_fired(setup)
    rows = chapters_shot.assumptions(setup, (), drawn=drawn).tables[0].rows
    assert list(size.assumptions) == [": ".join(one) for one in rows]
    for words in (*size.assumptions, "cfl 0.7", "20 mm square and clamped, struck by a cylinder"):
        assert words in str(size)
    # a shot of a study ends with its outcome
    assert "latest end" not in size.settings
    assert size.summary()["settings"] == size.settings


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_study_says_nothing_of_what_it_passes_over():
    block = {"modulus": "100 MPa", "after_stop": "2 ms"}
    kept = {"end_time": "500 us", "snapshot_interval": "20 us"}
    shot = wc.setup("S-720", "155 m/s", opening="60 mm", backing=block, **kept)
    one = Wording.of_setup(shot, None, velocity=True)
    many = Wording.of_setup(shot, None)
    passed_over = {"latest end", "time between snapshots", "block after stop"}
    assert passed_over == {*dict(one.choices)} - {*dict(many.choices)}
    assert "It is followed for 2 ms" in dict(one.assumptions)["block behind"]
    assert "The run ends when" in dict(many.assumptions)["block behind"]


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_the_check_of_several_set_ups_says_whose_a_choice_is():
    """What all have is said once; twice and thrice the same plies are named, the third row is not like them."""
    over = {"panel.plies": [2, 3, 1], "panel.opening": ["20 mm"], "panel.crossovers": ["pinned"]}
    size = wc.sweep("S-720", over=over, quantity="critical-velocity", check=True)
    said = dict(size.said.assumptions)
    two, three, one = (
        f"panel plies {n}, panel opening 20 mm, panel crossovers pinned" for n in (2, 3, 1)
    )
    assert said[f"between plies ({two}; {three})"] == "Friction 0.2, assumed 0.15 to 0.25."
    assert "pass far below" in said[f"crossovers ({one})"]
    assert "pass far below" not in said[f"crossovers ({two}; {three})"]
    assert said["strain rate"].endswith("do not depend on it.")
    assert f"\n{three}: 3 plies of S-720, aligned, 20 mm square" in str(size)
    assert "chosen, in SI units: opening 0.02;" in str(size)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_the_check_of_a_comparison_names_a_and_b():
    size = wc.compare("S-720", "S-728", opening="20 mm", check=True)
    strengths = [words for of, words in size.said.assumptions if of.startswith("failure of yarns")]
    assert ["374 / 374 N" in strengths[0], "400 / 400 N" in strengths[1]] == [True, True]
    assert "failure of yarns (B): A yarn fails at its strength, 400" in str(size)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_the_check_of_a_coupon_says_test_law_and_choices():
    of_frame = {"shear_angle": "5 deg", "crossovers": 2, "steps": 3, "tolerance": 0.02}
    size = wc.coupon("S-720", "picture_frame", check=True, **of_frame)
    words = "A coupon of S-720, in 3 load steps, each relaxed to 0.02 of the reaction."
    assert size.said.shots == (("", words),)
    assert "picture frame shear angle 0.0872665; picture frame crossovers 2; run steps 3" in str(
        size
    )
    of_pull = {"crossings": 10, "displacement": "1.2 mm", "crossover_cohesion": "0.5 N"}
    pulled = wc.coupon("S-726", "pull_out", check=True, **of_pull)
    assert dict(pulled.said.assumptions)["friction between yarns"] == "0.2, assumed (0.1 .. 0.3)"
    given = wc.coupon("S-726", "pull_out", check=True, crossover_friction=0.3, **of_pull)
    assert "friction between yarns" not in dict(given.said.assumptions)
    assert "pull out crossover friction 0.3" in given.said.settings


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_the_check_of_a_shot_on_two_meshes_says_so(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(toml(SHOT))
    settings = wc.impact(scene, uncertainty=True, check=True).settings
    assert "meshes two, for the error of the first" in settings
