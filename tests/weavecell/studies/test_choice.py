"""crossovers = "auto": pinned where friction is known to hold the yarns, else resolved, with the reason first."""

import json
import warnings
from dataclasses import replace
from html import unescape
from types import SimpleNamespace

import numpy as np
import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from shellfabric.block.block import Backing
from weavecell.api.limits import CriticalVelocityResult
from weavecell.api.scatter import V50Result
from weavecell.studies import choice, lambert_jonas, probit, v50
from weavecell.studies.ballistic_limit import Limit, Shot

# no test here looks at what a picture shows
pytestmark = pytest.mark.usefixtures("drawn_once")

SPHERE = {
    "projectile": {"shape": "sphere", "mass": "0.69 g", "diameter": "5.56 mm"},
    "opening": "40 mm",
    "crossovers": "auto",
    "zone": "8 mm",
}


def test_pinned_yarns_that_hold_are_enough():
    """At 60 m/s a friction of 0.12 holds the yarns of any fabric; nothing else is run."""
    shot = wc.impact("S-726", "60 m/s", end_time="30 us", **SPHERE)
    assert shot.chosen == (
        "yarns pinned: at 60 m/s a friction of 0.039 to 0.12, by the fabric, holds them, and theirs is "
        "0.2, assumed 0.1 to 0.3"
    )
    assert shot.target.setup.crossovers is shot.target.setup.instead is None
    assert shot.chosen in shot.headline()
    alone = wc.impact(
        "S-726", "60 m/s", end_time="30 us", **SPHERE | {"crossovers": "pinned", "zone": None}
    )
    assert shot.residual_velocity == alone.residual_velocity
    size = wc.impact("S-726", "60 m/s", end_time="30 us", check=True, **SPHERE)
    assert shot.chosen in size.assumed


@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult")
def test_yarns_that_the_nose_parts_are_resolved_and_the_headline_says_why(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(
        """
[fabric]
name = "S-726"
[projectile]
shape = "sphere"
mass = "0.69 g"
diameter = "5.56 mm"
strike_velocity = "140 m/s"
[panel]
opening = "40 mm"
plies = 2
crossovers = "auto"
zone = "8 mm"
[run]
end_time = "16 us"
outputs = ["report"]
"""
    )
    shot = wc.impact(scene, out=tmp_path / "r")
    words = (
        "yarns resolved: at 140 m/s a friction of 0.068 to 0.21, by the fabric, holds them, and theirs is "
        "0.2, assumed 0.1 to 0.3"
    )
    assert f"; friction between yarns assumed, 0.1 to 0.3; {words}" in shot.headline()
    assert shot.target.setup.crossovers.half_width == 8e-3
    assert shot.energies["crossover_friction"][-1] > 0
    assert json.loads((tmp_path / "r/summary.json").read_text())["chosen"] == shot.chosen
    assert words in (tmp_path / "r/report.html").read_text("utf-8")
    size = wc.impact(scene, check=True)
    assert words in size.assumed


def test_yarns_are_resolved_where_no_friction_is_known_to_hold_them():
    """Of a nose wider than those of the bisections, and behind a block."""
    setup = wc.setup(
        "S-720",
        "100 m/s",
        opening="60 mm",
        projectile={"mass": "15 g", "diameter": "8 mm", "edge_radius": "1 mm"},
        crossovers="auto",
    )
    assert not choice.choose(setup, 100.0).resolved
    wide = replace(setup, projectile=replace(setup.projectile, radius=6.5e-3))
    clay = replace(setup, backing=Backing(size=(0.06, 0.06, 0.02)))
    for unknown in (wide, clay):
        assert str(choice.choose(unknown, 100.0)) == (
            "yarns resolved: with this nose and backing the friction that holds pinned ones is not known"
        )
    resolved = choice.with_resolved(setup)
    assert (resolved.symmetry, resolved.crossovers) == ("whole", setup.instead)
    assert resolved.impact_point != (0.0, 0.0)


def test_pinned_yarns_are_judged_by_the_friction_that_is_given():
    """0.11 does not hold the sphere at 60 m/s; 0.3 holds it, and the check of the pinned run says so."""
    setup = wc.setup("S-726", "60 m/s", **SPHERE)
    for friction, resolved in ((0.11, True), (0.3, False)):
        zone = replace(setup.instead, friction=friction)
        asked = replace(setup, instead=zone)
        assert choice.choose(asked, 60.0).resolved is resolved
        pinned = choice.with_pinned(asked)
        assert pinned.panel(pinned.plain_table()).yarn_friction == friction


@pytest.fixture(scope="module")
def parted(tmp_path_factory):
    """The limit of slippery yarns, which a sphere parts, and its folder."""
    out = tmp_path_factory.mktemp("limit") / "r"
    sphere = SPHERE["projectile"] | {"friction": 0}
    asked = {"crossover_friction": 0.05, "tolerance": "6 m/s", "residual_shots": 0}
    asked = SPHERE | asked | {"projectile": sphere}
    with warnings.catch_warnings(action="ignore", category=wc.DoubtfulResult):
        return wc.critical_velocity("S-726", scan=False, out=out, **asked), out


def test_a_limit_is_searched_again_where_yarns_part(parted):
    """Pinned yarns stop the sphere up to 46 m/s, and so do wide ones that slip with a friction of 0.05."""
    limit, _out = parted
    words = limit.chosen
    pinned = float(words.rpartition("limit of pinned yarns ")[2].removesuffix(" m/s)"))
    assert limit.critical_velocity == pytest.approx(pinned, rel=0.03)
    assert words.startswith(f"yarns resolved: at {pinned:.4g}")
    assert "of 0.071 to 0.13, by the fabric, holds them, and theirs is 0.05" in words
    assert limit.target.setup.crossovers.friction == 0.05
    assert words in limit.headline[1]
    assert words in str(limit)


def test_the_files_of_a_limit_say_which_yarns_it_has_and_why(parted):
    limit, out = parted
    kept = json.loads((out / "critical-velocity.json").read_text())
    assert kept["chosen"] == limit.chosen == limit.summary()["chosen"]
    assert list(limit.to_dataframe()["yarns"]) == ["resolved"] * len(limit.shots)
    assert limit.chosen in unescape((out / "report.html").read_text("utf-8"))


@pytest.mark.slow(18)
@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult")
def test_a_v50_is_of_resolved_yarns_where_they_part(tmp_path):
    given = SPHERE | {"crossover_friction": 0.05}
    found = wc.v50("S-726", shots=4, batch=4, modulus_cov=0, crimp_cov=0, out=tmp_path, **given)
    assert found.chosen.startswith("yarns resolved: at 58.15 m/s, the limit of pinned ones")
    assert found.chosen in found.headline[1]
    assert found.chosen in str(found)
    assert json.loads((tmp_path / "v50.json").read_text())["chosen"] == found.chosen
    points = found.to_dataframe()[["impact_point_x_m", "impact_point_y_m"]]
    assert len(points.drop_duplicates()) == 4


@pytest.mark.parametrize("limit, resolved", [(60.0, False), (140.0, True)])
def test_a_v50_is_of_the_yarns_that_its_limit_without_scatter_asks_for(
    monkeypatch, limit, resolved
):
    setup = wc.setup("S-726", "80 m/s", **SPHERE)
    found = SimpleNamespace(velocity=limit)
    monkeypatch.setattr(v50.run_cache, "results", lambda *_, **__: [found])
    assert v50.choose_yarns(setup).resolved is resolved


@pytest.mark.parametrize("study", [wc.critical_velocity, wc.v50])
def test_the_cost_of_both_runs_is_known_before(study):
    chosen = study("S-726", check=True, **SPHERE)
    pinned = study("S-726", check=True, **SPHERE | {"crossovers": "pinned", "zone": None})
    assert str(chosen).splitlines()[:2] == str(pinned).splitlines()[:2]
    assert f"if friction may not hold pinned yarns, another {chosen.resolved.cost}" in str(chosen)
    assert chosen.resolved.cpu_time[1] > 0


@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult")
@pytest.mark.filterwarnings("ignore:.*the edges follow yarns:UserWarning")
@pytest.mark.parametrize("friction, named", [(None, True), (0.2, False)])
def test_every_answer_of_resolved_yarns_names_the_friction_that_is_assumed_first(friction, named):
    """Of a shot, a limit and a V50: before all else that is said of its number."""
    words = "friction between yarns assumed, 0.1 to 0.3"
    given = SPHERE | {"crossovers": "yarns", "crossover_friction": friction}
    shot = wc.impact("S-726", "60 m/s", end_time="4 us", **given)
    target = shot.target
    row = Shot(60.0, 20.0, "perforated", 1e-4, 0.0, (1.0, 1.0), 0.0, 1.0)
    stop = replace(row, strike_velocity=50.0, outcome="stopped")
    limit = CriticalVelocityResult(
        target, Limit(50.0, 60.0, (row, stop)), lambert_jonas.fit([], [])
    )
    hit = [False, False, True, False, True, True]
    curve = probit.fit(np.linspace(40.0, 65.0, 6), hit)
    several = v50.Study((50.0, 60.0), (), {"probit": curve}, v50.Scatter())
    heads = [
        shot.headline().partition("; ")[2],
        limit.headline[1].partition("(")[2],
        V50Result(several, target, 1, 4, 0.0).headline[1].partition("(")[2],
    ]
    for head in heads:
        assert head.startswith(words) is named, head


def test_what_cannot_choose_refuses_it():
    with pytest.raises(InputError) as caught:
        wc.setup("S-720", "100 m/s", opening="60 mm", crossovers="auto").target()
    assert (caught.value.key, caught.value.value) == ("crossovers", "auto")
    with pytest.raises(InputError):
        wc.impact("S-726", "60 m/s", uncertainty=True, **SPHERE)
    with pytest.raises(InputError):
        wc.impact("S-726", "60 m/s", elements_per_crossover=2, **SPHERE)
