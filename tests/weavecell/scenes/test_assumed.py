"""A fabric file with what a data sheet gives: what is assumed is printed, recorded and shown; else one line."""

import json
import re
from dataclasses import replace
from functools import reduce
from math import acos
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import weavecell as wc
from fabrics import assumed, catalogue, data_sheet
from fabrics.base.errors import InputError
from fabrics.compression import CompressionLaw
from fabrics.families import list_families, trellis
from tests.scene_text import merged, toml
from tests.weavecell.session_runs import SCENES
from weavecell.api.target import resolve_fabric
from weavecell.scenes import build, impact
from weavecell.studies import unknown

EXAMPLES = Path(__file__).parents[3] / "examples"
MINE = EXAMPLES / "fabrics" / "mine.toml"
LAW = {"a": "0.04 mm", "b": "0.05 mm N^(1/3)"}
SHEAR = "assumed: [shear] of para-aramid yarns, its angles from width and spacing of the yarns, because mine gives none"
CRIMP = "assumed: crimp 1.57 / 0.55 % of warp / weft (1.00 / 0.16 .. 2.52 / 1.00 %), from the thickness 0.3 mm "
CRIMP += "(times 0.9 .. 1.1) and a warp share of the yarn heights of 0.63 (0.5 .. 0.8)"
LENGTH = "assumed: failure length 0.75 mm (0.375 mm .. 1.5 mm), because mine gives none"
WOVEN = "assumed: strength after weaving 0.94 (0.88 .. 1.0), because mine gives none"
YARNS = "assumed: friction between resolved yarns 0.2 (0.1 .. 0.3), which decides whether a nose passes between them"
NOSE = "assumed: friction of the projectile 0.1 (0.0 .. 0.2), because mine gives none"


@pytest.fixture
def own(succeed, drawn_once, tmp_path):
    """Run examples/own-fabric.toml on a small panel for a short time, with changes of its fabric file, (old, new)."""

    def run(*changes, options=()):
        (tmp_path / "fabrics").mkdir()
        data = reduce(lambda text, change: text.replace(*change), changes, MINE.read_text())
        (tmp_path / "fabrics" / "mine.toml").write_text(data)
        text = (
            (EXAMPLES / "own-fabric.toml")
            .read_text()
            .replace('"150 mm"', '"26 mm"')
            .replace('"600 us"', '"12 us"')
        )
        (tmp_path / "own.toml").write_text(
            text.replace("elements_per_crossover = 2", 'outputs = ["report"]')
        )
        out = succeed("impact", "own.toml", "--out", "r", "--verbose", *options)
        return out.splitlines(), json.loads((tmp_path / "r" / "summary.json").read_text())

    return run


@pytest.fixture(scope="module")
def kept():
    """Hold what the run of `assumed_of_mine` came to, which several tests look at."""
    return {}


@pytest.fixture
def assumed_of_mine(kept, request, tmp_path):
    """Run the fabric of a data sheet once: (lines printed, summary.json, report.html)."""
    if not kept:
        out, told = request.getfixturevalue("own")()
        kept["run"] = out, told, (tmp_path / "r" / "report.html").read_text()
    return kept["run"]


def test_what_is_assumed_is_printed_and_recorded(assumed_of_mine):
    out, told, _ = assumed_of_mine
    lines = [line for line in out if line.startswith("assumed: ")]
    # each line once
    assert lines == [CRIMP, LENGTH, SHEAR, WOVEN, NOSE, YARNS]
    assert told["provenance"]["assumed"] == "; ".join(lines[:5])


def test_an_assumed_trellis_law_is_in_force():
    """Of pinned yarns, which shear as a cell does."""
    shot = wc.impact(
        MINE, "80 m/s", crossovers="pinned", law=LAW, opening="26 mm", end_time="12 us"
    )
    assert shot.energies["shear"][-1] > 0


def test_the_report_shows_the_source_of_what_is_assumed(assumed_of_mine):
    *_, page = assumed_of_mine
    row = page[page.index("shear.G2") :].partition("</tr>")[0]
    assert all(word in row for word in ("9.74 GPa", "assumed", "thesis eq. 4-49"))


@pytest.fixture(scope="module")
def mine():
    """Return the fabric of a data sheet, which says nothing of weaving damage and friction."""
    return catalogue.load(MINE)


ON_MINE = {"law": LAW, "opening": "40 mm"}


@pytest.fixture(scope="module")
def pack_of_mine(mine):
    """Set up two plies of it."""
    return wc.setup(mine, "90 m/s", plies=2, **ON_MINE)


def test_a_fabric_that_is_not_of_the_catalogue_is_shot_with_best_estimates(mine, pack_of_mine):
    """0.94 of the strength, friction of 0.1 on the projectile and 0.2 between plies."""
    warp = pack_of_mine.fabric.weave.warp
    assert warp.strength == pytest.approx(0.94 * mine.weave.warp.strength)
    assert (pack_of_mine.projectile.friction, pack_of_mine.ply_friction) == (0.1, 0.2)


def test_a_fabric_is_not_weakened_twice(pack_of_mine):
    again = wc.setup(pack_of_mine.fabric, "90 m/s", plies=2, **ON_MINE)
    assert again.fabric.weave.warp.strength == pack_of_mine.fabric.weave.warp.strength


def test_one_ply_assumes_no_friction_between_plies(mine):
    assert "friction between plies" not in wc.setup(mine, "90 m/s", **ON_MINE).fabric.assumed


def test_what_the_scene_gives_replaces_the_best_estimates(mine):
    damage = {"strength": 0.9, "source": "tests of drawn yarns"}
    shot = {"mass": "1 g", "diameter": "5 mm", "edge_radius": "0.3 mm", "friction": 0.0}
    given = {"ply_friction": 0.0, "weaving_damage": damage, "projectile": shot}
    setup = wc.setup(mine, "90 m/s", plies=2, **given, **ON_MINE)
    strength = setup.fabric.weave.warp.strength
    assert strength == pytest.approx(0.9 * mine.weave.warp.strength)
    assert (setup.projectile.friction, setup.ply_friction) == (0.0, 0.0)
    assert not set(setup.fabric.assumed) & set(data_sheet.OF_SHOTS)


def test_a_number_with_a_range_keeps_it_and_a_guess_has_that_of_its_family():
    """The modulus of the warp alone, its strength kept; E_c as stated, K_r without a source a quarter to 1.5 times."""
    fabric = assumed.with_shear(catalogue.load(Path(__file__).with_name("ranged.toml")))
    law = fabric.solid_laws[0]
    ends = {
        name: np.multiply(getattr(law, name), fabric.ranges[f"solid.{name}"])
        for name in ("E_c", "K_r")
    }
    assert ends["E_c"] == pytest.approx((0.5e9, 3e9))
    assert ends["K_r"] == pytest.approx((0.01, 0.06))
    assert law.V_c == 1.0
    assert "solid.V_c" not in fabric.ranges
    late = replace(
        fabric, shear=replace(fabric.shear, gamma2=1.5), ranges={"shear.gamma2": (0.1, 1.2)}
    )
    assert [
        end.shear.gamma2 for end in (assumed.shear_at(late, 0.0), assumed.shear_at(late, 1.0))
    ] == pytest.approx([trellis.LARGEST, 0.15])
    low = assumed.scale_ranged(fabric, "modulus", (0.9, 1.0)).weave
    assert (low.warp.E, low.weft.E) == pytest.approx((81e9, 90e9))
    assert low.warp.strength == pytest.approx(fabric.weave.warp.strength)
    own = "warp.modulus 90 GPa (times 0.9 .. 1.1), solid.E_c 1.5 GPa (times 0.333 .. 2), "
    own += "solid.K_r 0.04 (times 0.25 .. 1.5)"
    guess = "guessed, without a range: warp.tenacity; give low and high"
    assert assumed.lines(fabric)[-2:] == [f"assumed: {own}", guess]
    assert not assumed.has_range(assumed.given(fabric, "solid"), "solid")


@pytest.fixture(scope="module")
def clamped_pack():
    """Set up two plies of a fabric of the catalogue in friction clamps."""
    boundary = {"clamp_force": "20 N"}
    return wc.setup("S-720", "90 m/s", plies=2, opening="40 mm", boundary=boundary)


def test_a_fabric_of_the_catalogue_has_its_strength_and_the_frictions_of_its_family(clamped_pack):
    strength = resolve_fabric("S-720").weave.warp.strength
    assert clamped_pack.fabric.weave.warp.strength == pytest.approx(strength)
    assert (clamped_pack.projectile.friction, clamped_pack.ply_friction) == (0.1, 0.2)


@pytest.mark.parametrize(
    "modulus, density, family",
    [
        (90e9, 1440.0, "para-aramid"),
        (110e9, 970.0, "UHMWPE"),
        (72e9, 2560.0, "E-glass"),
        (5e9, 1140.0, "nylon"),
        (12e9, 1380.0, "polyester"),
        (180e9, 1560.0, "PBO"),
        (230e9, 1760.0, "carbon"),
        (30e9, 1900.0, None),
    ],
)
def test_the_family_follows_from_modulus_and_density(modulus, density, family):
    fabric = catalogue.load(MINE).with_yarns(E=modulus, fibre_density=density)
    found = assumed.family_of(fabric)
    assert (found and found.name) == family
    other = assumed.family_of(replace(fabric, family="para-aramid"))
    assert other.name == "para-aramid"
    assert other.of_others == (family != "para-aramid")


def test_a_family_that_the_file_names_has_wider_ranges_for_other_yarns():
    """PBO: the values of para-aramid, and ratios of the ends to them squared, of moduli at most that of the fibre."""
    fabric = replace(
        catalogue.load(MINE).with_yarns(E=180e9, fibre_density=1560.0), family="para-aramid"
    )
    found = assumed.with_solid_laws(assumed.with_shear(fabric))
    assert found.solid_laws[0] == replace(catalogue.load("S-720").solid_laws[0], Vf0=0.66)
    assert found.ranges["solid.E_c"] == pytest.approx((0.1**2, 1.25**2))
    assert found.solid_laws[0].V_c * found.ranges["solid.V_c"][1] == pytest.approx(1.4**2)
    ends = [assumed.shear_at(found, share).shear.G2 / found.shear.G2 for share in (0.0, 1.0)]
    assert ends == pytest.approx([0.5**2, 2.0])
    assert found.sources["solid.E_c"]["value"] == "2.0 GPa (0.02 GPa .. 3.12 GPa)"


def test_solid_values_are_those_of_the_catalogue():
    """Nominal values of para-aramid against the file that they are taken from, but for the fibre fraction, which yarns
    alike have alike; E-glass in the middle of the glass weaves, which its range holds."""
    bare = replace(catalogue.load("S-720"), shear=None, solid_laws=None, sources={})
    found = assumed.with_solid_laws(assumed.with_shear(bare))
    of_720 = catalogue.load("S-720").solid_laws
    assert found.solid_laws == tuple(replace(law, Vf0=0.66) for law in of_720)
    assert sum(law.Vf0 for law in of_720) / 2 == pytest.approx(0.66)
    assert found.assumed == ("failure_length", "shear", "solid")
    assert {entry["status"] for entry in found.sources.values()} == {"assumed"}
    for name in ("glass-balanced", "glass-unbalanced"):
        glass = catalogue.load(name)
        found = assumed.with_solid_laws(replace(glass, solid_laws=None, sources={}))
        for key in ("E_c", "K_r", "V_c"):
            low, high = found.ranges[f"solid.{key}"]
            own, of_family = (getattr(each.solid_laws[0], key) for each in (glass, found))
            assert low * of_family < own < high * of_family
    given = catalogue.load("S-720")
    assert assumed.with_shear(given) is given
    assert assumed.with_solid_laws(given) is given


def test_only_aramid_has_the_solid_of_aramid():
    """No glass, of the catalogue or assumed, and no carbon takes E_c, K_r or V_c as those of Kevlar or para-aramid."""
    tables = [catalogue.load(name).sources for name in catalogue.list_names() if "glass" in name]
    tables += [
        family.sources("solid")
        for family in list_families()
        if family.name in ("E-glass", "carbon")
    ]
    assert len(tables) == 4
    for sources in tables:
        for key, entry in sources.items():
            if key.startswith("solid.") and key.rpartition(".")[2] in ("E_c", "K_r", "V_c"):
                assert not re.match("as (Kevlar|S-720|para-aramid)", entry["source"]), key
    kevlar, glass = (
        next(family for family in list_families() if family.name == name).solid_laws("nominal")[0]
        for name in ("para-aramid", "E-glass")
    )
    assert glass.K_r * glass.E_c < 0.01 * kevlar.K_r * kevlar.E_c


@pytest.mark.parametrize("name", [name for name in catalogue.list_names() if name.startswith("S-")])
def test_the_assumed_trellis_encloses_the_published_one(name):
    """Moduli of thesis Table 4-1 within 4 %, angles within the range of the assumed law."""
    fabric = catalogue.load(name)
    found = assumed.with_shear(replace(fabric, shear=None))
    assert found.shear.G1 == pytest.approx(fabric.shear.G1, rel=0.04)
    assert found.shear.G2 == pytest.approx(fabric.shear.G2, rel=0.04)
    soft, stiff = (assumed.shear_at(found, share).shear for share in (0.0, 1.0))
    assert stiff.gamma1 <= found.shear.gamma1 <= soft.gamma1
    assert stiff.gamma2 <= found.shear.gamma2 <= soft.gamma2
    assert soft.G1 < found.shear.G1 < stiff.G1
    assert stiff.gamma1 < fabric.shear.gamma1 < soft.gamma1 + 1e-3
    assert stiff.gamma2 < fabric.shear.gamma2 < soft.gamma2


def test_a_width_replaces_the_assumed_gap(tmp_path):
    """Eq. 4-32: gamma1 = acos(width / spacing) of the narrower yarn."""
    text = MINE.read_text().replace("[weft]\n", '[weft]\nwidth = "1.0 mm"\n')
    path = tmp_path / "wide.toml"
    path.write_text(text)
    fabric = assumed.with_shear(catalogue.load(path))
    assert fabric.yarn_width == (None, pytest.approx(1e-3))
    # the warp of unknown width touches first
    assert fabric.shear.gamma1 == pytest.approx(acos(1 - 0.026))
    path.write_text(text.replace("[warp]\n", '[warp]\nwidth = "1.1 mm"\n'))
    assert assumed.with_shear(catalogue.load(path)).shear.gamma1 == pytest.approx(
        acos(1.1 / (10 / 8.5))
    )
    path.write_text(text.replace('"1.0 mm"', '"-1 mm"'))
    with pytest.raises(InputError, match=r"weft\.width = '-1 mm': must be from 0.02 to 20 mm"):
        catalogue.load(path)


def test_a_tight_weave_locks_just_after_its_yarns_touch():
    weave = catalogue.load("S-727").weave
    law = trellis.from_weave(weave, locking_share=0.5, G1_over_G2=1e-3, gap=0.01, K_s=0.3)
    assert law.gamma2 == pytest.approx(law.gamma1 + trellis.LEAST_RISE)


def test_a_coupon_of_yarns_of_no_family_says_that_it_has_no_shear_stiffness(succeed, tmp_path):
    (tmp_path / "other.toml").write_text(MINE.read_text().replace("1.44 g/cm^3", "1.56 g/cm^3"))
    table = {
        "fabric": {"file": "other.toml", "law": LAW},
        "biaxial": {"strain": ["0.2 %", "0.2 %"], "centre": 2, "arm": 1},
        "run": {"steps": 1, "outputs": []},
    }
    (tmp_path / "scene.toml").write_text(toml(table))
    out = succeed("coupon", "scene.toml", "--out", "r", "--verbose")
    assert "no [shear] of mine: its fabric has no shear stiffness" in out.splitlines()


@pytest.mark.parametrize("model", ["incompressible", "decoupled"])
def test_yarns_that_are_not_compressed_need_no_law(model):
    scene = impact.check(
        merged(SCENES["small"], {"fabric": {"name": None, "file": str(MINE), "cell_model": model}}),
        None,
    )
    assert build.build(scene, None, "s").law_name == f"none, {model} yarns"


def test_a_law_outside_the_ends_of_its_range_says_at_which_forces():
    """The S706 of a new user: the stiff end, fitted up to 51 N, is softer above 50 N."""
    ends = (2.23e-5, 7.7e-6), (2.20e-5, 8.00e-5)
    law = CompressionLaw(5.8e-6, 4.0e-6, F_range=(0.4, 65.0), assumed_range=ends)
    stiff = CompressionLaw(*ends[1])
    assert brentq(lambda F: float(law.d(F) - stiff.d(F)), 10.0, 65.0) == pytest.approx(
        51.3, abs=0.1
    )
    assert law.outside_ends() == [
        "stiff end softer than the law from 51.3 to 65 N: the ends do not bracket it there"
    ]
    assert (
        replace(law, F_range=(0.4, 40.0)).outside_ends()
        == replace(law, F_range=None).outside_ends()
        == []
    )


def test_the_published_shear_of_a_glass_weave_lies_in_the_assumed_range():
    """36.8 kPa: the bias test of a glass plain weave."""
    fabric = catalogue.load("glass-balanced")
    soft, stiff = (
        assumed.family_of(fabric).shear(fabric.weave, fabric.yarn_width, end).G1
        for end in ("soft", "stiff")
    )
    assert soft < 36.8e3 < stiff


@pytest.mark.parametrize("family", list_families(), ids=lambda family: family.name)
def test_every_family_has_laws_whose_ends_enclose_them(family):
    """Of a weave of its own yarns: soft below nominal below stiff, a yarn not packed at rest, and each end a law."""
    (low, high), (light, heavy) = family.limits["modulus"], family.limits["fibre_density"]
    plain = catalogue.load(MINE).with_yarns(
        E=(low * high) ** 0.5, fibre_density=(light * heavy) ** 0.5
    )
    fabric = replace(plain, family=family.name, shear=None, solid_laws=None)
    assert not assumed.family_of(fabric).of_others
    found = assumed.with_solid_laws(assumed.with_shear(fabric))
    soft, stiff = (assumed.shear_at(found, share) for share in (0.0, 1.0))
    assert soft.shear.G2 < found.shear.G2 <= stiff.shear.G2
    assert all(law.Vf0 < law.V_c for law in found.solid_laws)
    low, high = found.ranges["solid.E_c"]
    assert low < 1 <= high
    for entry in assumed.shot_entries(found).values():
        assert 0 <= entry.low < entry.value <= entry.high <= 1


def test_a_family_stands_in_for_the_numbers_of_shots():
    """What a data sheet does not give: of carbon its own, of aramid the usual, of both the widest range."""
    aramid = catalogue.load(MINE)
    carbon = aramid.with_yarns(E=230e9, fibre_density=1760.0)
    name = data_sheet.STRENGTH_AFTER_WEAVING
    of_carbon = assumed.shot_entries(carbon)[name]
    assert (of_carbon.value, of_carbon.low, of_carbon.high) == (0.8, 0.5, 1.0)
    assert assumed.shot_entries(aramid)[name] == data_sheet.entries()[name]
    both = assumed.shot_entries(aramid, carbon)[name]
    assert (both.value, both.low, both.high) == (0.94, 0.5, 1.0)
    assert both.written == "0.94 (0.5 .. 1)"
    assert f"assumed: strength after weaving {of_carbon.written}, because" in "\n".join(
        assumed.lines(carbon)
    )
    shot = wc.setup(carbon, "90 m/s", opening="40 mm", law=catalogue.load("S-720").laws[0])
    assert shot.fabric.sources["weaving_damage.strength"]["value"] == 0.8
    assert shot.projectile.friction == 0.2
    weaker = unknown.put_all(shot, unknown.ALIKE, {name: 0.0}).fabric.weave.warp.failure_strain
    assert weaker / shot.fabric.weave.warp.failure_strain == pytest.approx(0.5 / 0.8)


def test_the_friction_of_a_hybrid_pack_is_of_its_first_fabric_in_the_range_of_all():
    aramid = catalogue.load("S-720")
    polyester = replace(aramid, family="polyester")
    for fabrics, value in (((aramid, polyester), 0.2), ((polyester, aramid), 0.3)):
        found = assumed.friction_between_yarns(*fabrics)
        assert (found.value, found.low, found.high) == (value, 0.1, 0.48)


def test_the_failure_length_is_at_most_one_spacing():
    """A fine weave of 35 yarns an inch: 0.726 mm and its half and double; others have 0.75 mm."""
    plain = catalogue.load(MINE)
    spacing = 0.0254 / 35
    fine = replace(plain.weave, weft_count=1 / spacing)
    entry = data_sheet.failure_length(fine)
    assert (entry.value, entry.low, entry.high) == pytest.approx(
        (spacing, spacing / 2, 2 * spacing)
    )
    assert entry.written == "0.726 mm (0.363 mm .. 1.45 mm)"
    assert data_sheet.failure_length(plain.weave) == data_sheet.entries()["failure_length"]
