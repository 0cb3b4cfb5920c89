"""One small patch in three models: each is struck where it is aimed at, and what is said of them."""

from dataclasses import replace
from math import inf
from pathlib import Path
from types import SimpleNamespace as Given

import numpy as np
import pytest

pytest.importorskip("gmsh")

from fabrics import catalogue
from fabrics.base.errors import InputError
from meshing import patch
from shellfabric.impact.setup import ImpactSetup
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone
from validation import patch as program
from validation.cases import small_patch
from validation.cases.small_patch import SmallPatch, Struck

OWN = Path(__file__).parents[1] / "weavecell" / "own_fabrics"


def shot_of(radius):
    """A shot at S-720 by a steel sphere of a radius [m]."""
    sphere = Projectile(mass=0.11e-3 * (radius / 1.5e-3) ** 3, radius=radius, shape="sphere")
    return ImpactSetup(catalogue.load("S-720"), 60.0, projectile=sphere)


SHOT = shot_of(1.5e-3)


@pytest.fixture(scope="module")
def mesh():
    return patch.build(SHOT.fabric, (12, 12), size=small_patch.COARSE)


@pytest.mark.parametrize("model", small_patch.MODELS)
def test_every_model_is_struck_where_it_is_aimed_at(model, mesh):
    """Its nose is slowed by another amount in a gap than on a crossover; pinned crossovers are a continuum,
    in which only the edges tell the two apart."""
    duration = {"pinned": 12e-6, "yarns": 1.5e-6, "solids": 1.5e-6}[model]
    found = []
    for place in small_patch.PLACES:
        one = SmallPatch(SHOT, 12, place, duration=duration)
        if model == "solids":
            found.append(one.strike_solids(mesh))
        else:
            found.append(getattr(one, f"strike_{model}")())
    gap, crossover = found
    lost = [60.0 - one.velocity(duration) for one in found]
    assert min(lost) > 0.01
    assert abs(lost[0] - lost[1]) > 1e-4 * max(lost)
    for one in (gap, crossover):
        assert one.model == model
        assert one.z[-1] == pytest.approx(60.0 * duration, rel=0.1)
        assert 0.0 <= one.energy_error < 1e-3
        assert one.cpu > 0


def test_solid_yarns_say_what_they_take_for_granted():
    one = SmallPatch(SHOT, 12, "gap", size=(5, 3, 2))
    for words in (
        "5 along, 3 across and 2 through",
        f"friction {one.friction:g}",
        "fail at their strength",
    ):
        assert words in one.solids_in_words
    lasting = replace(one, shot=replace(SHOT, yarn_failure=False))
    assert "whose fibres do not fail" in lasting.solids_in_words


@pytest.mark.parametrize("place, off", [("gap", 0.5), ("crossover", 0.0)])
def test_a_place_is_the_same_one_in_every_model(place, off, mesh, monkeypatch):
    """The nose stands `off` spacings from the nearest warp and from the nearest weft."""
    struck = {}

    class Noted(Exception):
        pass

    def note(target, *_, **__):
        struck[type(target).__name__] = target
        raise Noted

    monkeypatch.setattr(small_patch, "run_impact", note)
    monkeypatch.setattr(small_patch, "SolidSolver", note)
    one = SmallPatch(SHOT, 12, place)
    for strike in (one.strike_yarns, lambda: one.strike_solids(mesh)):
        with pytest.raises(Noted):
            strike()
    spacing = 2 * np.array(SHOT.fabric.weave.w)
    solids = struck["SolidPatch"]
    families = np.array(solids.mesh.families)
    # axes of warps are places along the weft
    for family, aim in ((1, solids.aim[0]), (0, solids.aim[1])):
        axes = solids.mesh.axes[families == family]
        assert abs(axes - aim).min() == pytest.approx(off * spacing[1 - family], abs=1e-9)
    panel = struck["ImpactSetup"].panel(struck["ImpactSetup"].plain_table())
    for lines, side in zip(panel.lines(), spacing):
        assert abs(lines).min() == pytest.approx(off * side, abs=1e-9)


def test_all_times_count_from_the_first_touch(monkeypatch):
    """Of a run whose nose touches after 3 us, and whose first yarn fails 6 us later."""
    t = np.linspace(0.0, 20e-6, 41)
    force = np.where(t > 3.1e-6, 5.0, 0.0)
    history = np.column_stack([t, 60.0 * t, np.full(t.size, 59.0), force])
    ran = Given(
        step_history=history,
        time=t[::2],
        cut_yarns=np.where(t[::2] > 8.9e-6, 2.0, 0.0),
        energy_error_max=1e-4,
    )
    monkeypatch.setattr(small_patch, "run_impact", lambda *_, **__: ran)
    found = SmallPatch(SHOT, 12, duration=10e-6).strike_yarns()
    assert found.t[[0, -1]] == pytest.approx([0.0, 10e-6], abs=0.6e-6)
    assert found.z[[0, -1]] == pytest.approx([0.0, 60.0 * 10e-6], abs=40e-6)
    assert found.first_failure == pytest.approx(6e-6)


@pytest.mark.parametrize("radius", [0.6e-3, 1.5e-3, 2.78e-3, 4.4e-3])
def test_the_fewest_crossings_are_what_resolved_yarns_take(radius):
    shot = shot_of(radius)
    least = small_patch.fewest_crossings(shot)
    spacing = 2 * shot.fabric.weave.w[0]

    def make(crossings):
        opening = crossings * spacing
        aim = (0.5 * spacing, 0.5 * spacing)
        zone = YarnZone(half_width=inf)
        whole = replace(shot, opening=opening, impact_point=aim, symmetry="whole", crossovers=zone)
        return whole.panel(whole.plain_table())

    assert make(least).patch.crossings == (least - 1, least - 1)
    with pytest.raises(InputError):
        make(least - 2)


def test_the_widest_nose_is_that_of_the_largest_patch():
    most = small_patch.max_radius(SHOT)
    widest = shot_of(0.999 * most)
    assert small_patch.fewest_crossings(widest) == small_patch.MOST
    with pytest.raises(InputError, match="diameter"):
        SmallPatch(shot_of(1.001 * most), small_patch.MOST)


@pytest.mark.parametrize(
    "of_shot, of_patch, line",
    [
        (
            {},
            {"crossings": 15},
            "crossings = 15: must be an even number from 12, for this nose, to 40",
        ),
        ({}, {"duration": 1e-3}, "duration = 0.001: must be from 1e-06 to 0.0001 s"),
        ({}, {"place": "yarn"}, "struck = 'yarn': must be gap or crossover"),
        ({}, {"size": (1, 2, 1)}, "at least 2 along, 2 across and 1 through"),
        ({"plies": 3}, {}, "plies = 3: must be 1 for a patch"),
        (
            {"rate_dependence": True},
            {},
            "rate_dependence = True: must be left out with solid yarns",
        ),
        (
            {"projectile": replace(SHOT.projectile, obliquity=0.3)},
            {},
            "must be 0 with solid yarns, which are struck straight on",
        ),
    ],
)
def test_what_no_patch_stands_for_is_refused(of_shot, of_patch, line):
    shot = replace(SHOT, **of_shot)
    with pytest.raises(InputError, match=line):
        SmallPatch(shot, **{"crossings": 12, "place": "gap", "size": (2, 2, 1)} | of_patch)


def slowed(model, by, end=50e-6, first_failure=inf):
    """A nose that is slowed evenly by so many m/s in 50 us."""
    t = np.linspace(0.0, end, 40)
    return Struck(model, t, 60.0 - by * t / 50e-6, 60.0 * t, first_failure, 1e-4, 100, 1.0)


@pytest.mark.parametrize(
    "pinned, yarns, words",
    [
        (22.9, 30.0, "crossovers may be pinned for this nose"),
        (30.0, 22.9, 'crossovers may not be pinned for this nose, take crossovers = "yarns"'),
        (30.0, 16.0, "neither pinned nor resolved yarns are as solid ones for this nose"),
    ],
)
def test_the_answer_is_by_solid_yarns(pinned, yarns, words):
    struck = [slowed("pinned", pinned), slowed("yarns", yarns), slowed("solids", 20.0)]
    assert small_patch.judge(struck, 60.0).startswith(words + ":")


def test_models_are_compared_until_the_first_failure_or_end():
    """30 and 20 m/s apart from 20: in 14 us they are 2.8 m/s or 4.7 % of the strike velocity apart."""
    struck = [slowed("pinned", 30.0, first_failure=14e-6), slowed("yarns", 21.0, end=20e-6)]
    struck.append(slowed("solids", 20.0, first_failure=30e-6))
    assert small_patch.compare_until(struck) == 14e-6
    assert small_patch.judge(struck, 60.0).startswith("crossovers may be pinned")
    assert "over 14 us" in small_patch.judge(struck, 60.0)
    assert small_patch.compare_until(struck[1:]) == 20e-6
    assert small_patch.largest_difference(struck[0], struck[2], 14e-6, 60.0) == pytest.approx(
        10.0 * 14 / 50 / 60
    )


def test_the_program_prints_each_model_and_the_answer():
    """One yarn fails after 20 us: from then on the noses say nothing."""
    struck = [slowed("pinned", 30.0), slowed("yarns", 21.0, first_failure=20e-6)]
    struck.append(slowed("solids", 14.0))
    head, pinned, yarns, solids, failed, _, answer = program.table(struck, 60.0)
    assert head.split()[3:] == ["10", "us", "20", "us", "CPU", "s"]
    assert pinned.split() == ["pinned", "crossovers", "54.0", "48.0", "1"]
    assert yarns.split() == ["resolved", "yarns", "55.8", "51.6", "1"]
    assert solids.split() == ["solid", "yarns", "57.2", "54.4", "1"]
    assert failed == "resolved yarns: the first fibre fails at 20 us"
    assert answer == small_patch.judge(struck, 60.0)


def test_the_program_strikes_the_patch_that_was_asked_for_and_refuses_a_mesh(capsys, monkeypatch):
    struck = [slowed("pinned", 30.0), slowed("yarns", 21.0), slowed("solids", 14.0)]
    asked = []

    def strike(patch):
        asked.append((patch.crossings, patch.place, patch.size, patch.duration))
        return [lambda one=one: one for one in struck]

    monkeypatch.setattr(SmallPatch, "strike", strike)
    program.main("S-720", velocity="60 m/s", struck="crossover", duration="7 us", mesh="3,2,1")
    assert asked == [(14, "crossover", (3, 2, 1), pytest.approx(7e-6))]
    out = capsys.readouterr().out.splitlines()
    assert out[0].endswith("14 x 14 crossovers of 9,408 hexahedra,")
    assert out[-1] == small_patch.judge(struck, 60.0)
    with pytest.raises(InputError, match="mesh = 'coarse': must be three whole numbers"):
        program.main("S-720", velocity="60 m/s", mesh="coarse")


def test_a_patch_of_pinned_yarns_has_the_friction_of_its_own_fibres():
    """0.12 of UHMWPE, where 0.2 is that of fibres without a number of their own; one that is given stays."""
    fabric = catalogue.load(OWN / "uhmwpe-1760.toml")
    pinned = replace(SHOT, fabric=fabric)
    patched = SmallPatch(pinned, 12, "gap")
    assert patched.friction == patched.yarns_setup().crossovers.friction == 0.12
    assert SmallPatch(SHOT, 12, "gap").friction == 0.2
    given = replace(pinned, instead=YarnZone(friction=0.17))
    assert SmallPatch(given, 12, "gap").friction == 0.17
