"""Patterns of weaves: names, interlacings, sides, kinds of crossings; one place that knows them; who takes which."""

import ast
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import weavecell as wc
from fabrics import assumed, catalogue, ply_laws, variants
from fabrics.base.errors import InputError
from fabrics.base.run_cache import ADDED_LATER, inputs_digest
from fabrics.compression import CompressionLaw
from fabrics.pattern import PLAIN, Pattern
from fabrics.variants import data_digest
from fabrics.weave import Weave, arc_length
from meshing.mesh_plan import Plan
from shellfabric.cell.model import CellModel
from shellfabric.impact import in_words
from shellfabric.impact.setup import ImpactSetup
from shellfabric.yarns.model import YarnZone
from weavecell.api.calibration import OWN_CROSSINGS, PLAIN_CROSSING
from weavecell.cli.app import program
from weavecell.report import chapters, derived
from weavecell.studies import choice

ROOT = Path(__file__).parents[2]
# (i + j) of numbers of elements, not of yarns
# of nodes, and of cells that repeat upside down
NO_PARITY_OF_YARNS = {"shellfabric/coupon/quasistatic.py", "unitcell3d/assembly/symmetries.py"}
# Kevlar 29 style 735
SHEET = """
thickness = "0.60 mm"
{weave}
[warp]
linear_density = "1500 denier"
fibre_density = "1.44 g/cm^3"
modulus = "70.5 GPa"
failure_strain = "3.6 %"
count = "35 / inch"
[weft]
linear_density = "1500 denier"
fibre_density = "1.44 g/cm^3"
modulus = "70.5 GPa"
failure_strain = "3.4 %"
count = "34 / inch"
[compression]
a = "0.08 mm"
b = "0.08 mm N^(1/3)"
"""


@pytest.fixture
def own(tmp_path):
    """Write the sheet with a weave."""

    def write(weave):
        path = tmp_path / "k735.toml"
        path.write_text(SHEET.format(weave=f'weave = "{weave}"' if weave else ""))
        return path

    return write


@pytest.mark.parametrize(
    "text, rows",
    [
        ("Plain 1/1", "+-/-+"),
        ("tabby", "+-/-+"),
        ("2x2 basket", "++--/++--/--++/--++"),
        ("matt 1/2", "++--/--++"),
        ("Twill 2x1", "++-/-++/+-+"),
        ("2/2 twill", "++--/-++-/--++/+--+"),
        ("4-harness 2/2 twill", "++--/-++-/--++/+--+"),
        ("4 H Twill 1x3", "+---/-+--/--+-/---+"),
        ("Basketweave (2 x 1)", "+-/+-/-+/-+"),
        ("5-HS Satin", "-++++/++-++/++++-/+-+++/+++-+"),
        ("4-harness satin", "-+++/++-+/+++-/+-++"),
        ("5HS", "-++++/++-++/++++-/+-+++/+++-+"),
        ("crow's foot", "-+++/++-+/+++-/+-++"),
    ],
)
def test_names_are_the_rows_that_are_drawn_for_them(text, rows):
    assert np.array_equal(Pattern.read(text).matrix, Pattern.read(rows).matrix)


@pytest.mark.parametrize(
    "text, shares",
    [
        ("plain", (1, 1)),
        ("basket 2x3", (1 / 3, 1 / 2)),
        ("twill 3/1", (1 / 2, 1 / 2)),
        ("satin 5", (2 / 5, 2 / 5)),
        ("satin 8", (1 / 4, 1 / 4)),
        ("++-/-+-/+-+", (2 / 3, 2 / 3)),
    ],
)
def test_interlacings_are_the_share_of_spacings_with_a_change(text, shares):
    assert Pattern.read(text).interlacings == pytest.approx(shares)


@pytest.mark.parametrize(
    "text",
    ["", "triaxial", "twill 4", "satin 6", "basket 9x2", "++/-+", "+-/+-+", "satin 8 step 4"],
)
def test_what_is_no_weave_is_refused(text):
    with pytest.raises(InputError) as refused:
        Pattern.read(text)
    assert refused.value.key == "weave"


@pytest.mark.parametrize(
    "text, words",
    [
        ("4-harness twill", "twill 3/1 or twill 2/2"),
        ("5 harness 2/2 twill", "must be twill 2/2 of 4 harnesses"),
        ("leno", "satin 5"),
    ],
)
def test_a_number_of_harnesses_alone_is_no_twill_and_one_beside_it_is_its_repeat(text, words):
    with pytest.raises(InputError, match=words):
        Pattern.read(text)


def test_a_rotation_is_undone_by_three_more_and_turns_the_line_of_a_twill():
    twill = Pattern.read("twill 3/1")
    four = twill.rotated().rotated().rotated().rotated()
    assert np.array_equal(four.matrix, twill.matrix)
    # the weft, on top a quarter of the way, is the warp of the rotated fabric
    assert twill.matrix.mean() == 0.75
    assert twill.rotated().matrix.mean() == 0.25


@pytest.mark.parametrize("name", ["plain", "basket 2x2", "twill 3/1", "satin 5", "crowfoot"])
def test_a_rotated_pattern_has_the_yarns_on_top_that_were(name):
    own = Pattern.read(name)
    warp, weft = np.ix_(np.arange(-4, 5), np.arange(-3, 6))
    # the weft yarns are the warp yarns from the other end
    assert np.array_equal(own.rotated().is_warp_up(-weft, warp), ~own.is_warp_up(warp, weft))
    assert own.rotated().rotated().rotated().rotated().rows == own.rows


def test_both_families_see_one_crossing_from_two_sides():
    satin = Pattern.read("satin 5")
    warp, weft = np.ix_(np.arange(-7, 6), np.arange(-3, 9))
    assert np.array_equal(satin.sides(0, warp, weft), -satin.sides(1, weft, warp))


def test_crimp_of_a_thickness_is_that_of_plain_weave_times_the_interlacings(own):
    plain = catalogue.load(own(None)).weave
    basket = catalogue.load(own("basket 2x2")).weave
    assert basket.warp.crimp == pytest.approx(plain.warp.crimp / 2)
    assert basket.weft.crimp == pytest.approx(plain.weft.crimp / 2)
    assert basket.h0 == pytest.approx(plain.h0)
    assert basket.thickness == pytest.approx(0.6e-3)


def mass_of_crimps(fabric):
    """[g/m2] of crimped yarns, by hand."""
    yarns, counts = (fabric.weave.warp, fabric.weave.weft), (35 / 0.0254, 34 / 0.0254)
    return 1e3 * sum(n * 1500 / 9e6 * (1 + yarn.crimp) for yarn, n in zip(yarns, counts))


@pytest.mark.parametrize("weave", ["basket 2x2", "twill 3/1", "satin 5"])
def test_the_areal_density_tells_the_crimp_of_a_weave_with_floats(weave, own):
    """491 g/m2 of style 735: the mean crimp is that of the mass, its parts have the share of the heights."""
    path = own(weave)
    text = path.read_text()
    path.write_text('areal_density = "484 g/m^2"\n' + text)
    fabric = catalogue.load(path)
    assert mass_of_crimps(fabric) == pytest.approx(484)
    assert fabric.weave.h01 / sum(fabric.weave.h0) == pytest.approx(0.63)
    assert fabric.weave.thickness > 0.62e-3
    assert any("the file states 0.6 mm; the crimps are used" in note for note in fabric.notes)
    told = next(line for line in assumed.lines(fabric) if "crimp" in line)
    assert "from the areal density 484 g/m^2 (times 0.98 .. 1.02)" in told
    ends = assumed.crimp_ends(fabric)
    light, heavy = (ends[f"areal density times {x}"] for x in ("0.98", "1.02"))
    assert mass_of_crimps(light) == pytest.approx(0.98 * 484)
    assert mass_of_crimps(heavy) == pytest.approx(1.02 * 484)
    # one crimp that is given leaves the rest of the mass to the other
    path.write_text(
        'areal_density = "484 g/m^2"\n' + text.replace("[weft]", '[weft]\ncrimp = "4 %"')
    )
    one = catalogue.load(path)
    assert one.weave.weft.crimp == 0.04
    assert mass_of_crimps(one) == pytest.approx(484)


def test_a_plain_sheet_with_a_thickness_keeps_the_crimp_of_it(own):
    """Without one the mass tells it; a mass of straight yarns or less tells none."""
    path = own("plain")
    text = path.read_text()
    crimp = catalogue.load(path).weave.warp.crimp
    path.write_text('areal_density = "484 g/m^2"\n' + text)
    assert catalogue.load(path).weave.warp.crimp == crimp
    light = text.replace('thickness = "0.60 mm"', 'areal_density = "484 g/m^2"')
    path.write_text(light)
    assert mass_of_crimps(catalogue.load(path)) == pytest.approx(484)
    path.write_text(light.replace("484", "450"))
    with pytest.raises(InputError) as refused_mass:
        catalogue.load(path)
    for word in ("areal_density = '450 g/m^2'", "452.8 to", "give crimp"):
        assert word in str(refused_mass.value)


def test_a_sheet_with_floats_and_a_mass_of_straight_yarns_keeps_the_thickness(own):
    path = own("twill 2/2")
    of_thickness = catalogue.load(path)
    path.write_text('areal_density = "450 g/m^2"\n' + path.read_text())
    assert catalogue.load(path).weave.warp.crimp == of_thickness.weave.warp.crimp


def test_masses_of_three_weaves_of_a_thickness_are_within_2_percent(own):
    """Style 735 of 35 by 35 per inch has 491 g/m2 and 0.60 mm."""
    masses = []
    for weave in ("basket 2x2", "twill 2/2", "crowfoot"):
        path = own(weave)
        path.write_text(path.read_text().replace("34 / inch", "35 / inch"))
        masses.append(1e3 * catalogue.load(path).weave.areal_density)
    assert masses == pytest.approx([491] * 3, rel=0.02)


def test_a_long_change_of_sides_is_an_end_of_the_crimp_of_a_thickness(own):
    """As long as a float: a plain weave of groups, twice as long and as high, of the same slope."""
    fabric = catalogue.load(own("basket 2x2"))
    end = assumed.crimp_ends(fabric)["changes of sides as long as floats"]
    weave = fabric.weave
    groups = arc_length(2 * weave.w1, weave.h01) / (4 * weave.w1) - 1
    assert end.weave.warp.crimp == pytest.approx(groups)
    assert end.weave.warp.crimp < 0.6 * weave.warp.crimp
    plain = assumed.crimp_ends(catalogue.load(own("plain")))
    assert not any("changes" in words for words in plain)


def test_a_weave_that_is_not_stated_is_assumed_and_told(own):
    told = assumed.lines(catalogue.load(own(None)))
    assert "assumed: plain weave, because k735 states none" in told
    for weave in ("plain", "twill 2/2"):
        assert not any("weave," in line for line in assumed.lines(catalogue.load(own(weave))))
    # all fabrics of the catalogue are plain weaves
    assert "weave" not in catalogue.load("S-720").assumed


def test_a_rotated_fabric_has_its_weft_on_top_where_the_warp_was(own):
    fabric = catalogue.load(own("twill 3/1"))
    assert variants.rotated_90(fabric).weave.pattern.matrix.mean() == 0.25


def test_a_plain_weave_keeps_its_digest_and_another_has_its_own(own):
    assert Weave.__dataclass_fields__["pattern"].metadata == ADDED_LATER
    plain, stated, twill = (
        inputs_digest(catalogue.load(own(weave)).weave) for weave in (None, "plain", "twill 2/2")
    )
    assert plain == stated != twill
    # of commit 944fc391, before a weave had a pattern
    assert (
        inputs_digest(catalogue.load("S-720").weave)
        == "8a6dc72fd7fa5113a84fb44d186114356c6d208b25bc9026de6bb05b6ce1e388"
    )


@pytest.mark.parametrize(
    "text, alike, mirrors",
    [
        ("plain", True, (0, 0)),
        ("basket 2x2", True, (None, None)),
        ("twill 2/2", True, (None, None)),
        ("++--/+--+/--++/-++-", True, (None, None)),
        ("basket 1x2", False, (0, None)),
        ("basket 3x3", False, (1, 1)),
        ("twill 3/1", False, (None, None)),
        ("crowfoot", False, (None, None)),
        ("satin 5", False, (None, None)),
    ],
)
def test_kinds_of_crossings_and_middle_lines_that_mirror_a_pattern(text, alike, mirrors):
    pattern = Pattern.read(text)
    assert pattern.has_like_crossings == alike
    assert tuple(map(pattern.find_mirror, (0, 1))) == mirrors
    assert pattern.centre == tuple(mirror or 0 for mirror in mirrors)


def test_changes_beside_a_crossing_are_counted_for_both_families():
    """A group of one warp yarn and two weft yarns: the warp floats over two, each weft over one."""
    warp, weft = Pattern.read("basket 1x2").turns
    assert (warp == 1).all()
    assert (weft == 2).all()
    assert sorted(Pattern.read("twill 3/1").turns[0][0]) == [0, 1, 1, 2]


def refused(run):
    with pytest.raises(InputError) as found:
        run()
    assert found.value.key == "weave"
    return str(found.value)


def test_models_of_plain_weave_refuse_another(own):
    fabric = catalogue.load(own("twill 2/2"))
    models = {
        "solid yarns": lambda: Plan.of(fabric, size="coarse", shift=True),
        "pressure law of packs": lambda: ply_laws.of_packs(fabric),
    }
    for model, run in models.items():
        text = refused(run)
        assert "must be plain for" in text
        assert model in text


@pytest.mark.parametrize("weave", ["twill 3/1", "crowfoot", "satin 5", "basket 1x2", "basket 3x3"])
def test_pinned_yarns_refuse_crossings_of_several_kinds(weave, own):
    path = own(weave)
    for run in (
        lambda: wc.biaxial(path),
        lambda: wc.setup(path, "90 m/s").panel(),
        lambda: CellModel(catalogue.load(path)),
    ):
        assert "all alike (plain, basket 2x2, twill 2/2) for pinned yarns" in refused(run)
    assert CellModel(catalogue.load(path), mean_crossing=True).fabric.weave.pattern.name == weave


def test_yarns_of_a_family_that_are_not_alike_are_refused(own):
    fabric = catalogue.load(own("+-+-/-+-+/++--/--++"))
    assert "equally often" in refused(lambda: CellModel(fabric, mean_crossing=True))


def test_the_order_of_two_weaves_is_doubtful_with_pinned_yarns(own):
    """Of one fabric before and after a change it is not."""
    basket = catalogue.load(own("basket 2x2"))
    plain = replace(basket, weave=replace(basket.weave, pattern=PLAIN))
    line = "which weave stops more is not decided by pinned yarns: crossovers = yarns"
    for other, zones, doubtful in (
        (plain, (None, None), True),
        (plain, (YarnZone(), None), True),
        (plain, (YarnZone(), YarnZone()), False),
        (basket, (None, None), False),
    ):
        setups = [ImpactSetup(f, 90.0, crossovers=z) for f, z in zip((basket, other), zones)]
        assert (line in choice.doubt_order(setups)) == doubtful


def test_a_run_says_what_its_model_does_not_decide_of_a_weave(own):
    """Pinned yarns of a weave with floats; resolved ones in a zone, beyond which a satin has a mean crossing."""
    floats, mean = (
        "which cannot slip under their floats",
        "of several kinds, are taken by their mean",
    )
    for weave, zone, said in (
        ("plain", None, ()),
        ("basket 2x2", None, (floats,)),
        ("basket 2x2", YarnZone(), ()),
        ("satin 5", YarnZone(), (mean,)),
        ("satin 5", YarnZone().whole, ()),
    ):
        whole = ImpactSetup(catalogue.load(own(weave)), 90.0, symmetry="whole")
        setup = replace(whole, crossovers=zone)
        text = str(in_words.list_assumptions(setup))
        assert tuple(words for words in (floats, mean) if words in text) == said


def test_no_other_place_writes_the_parity_of_crossings():
    found = set()
    for package in ("fabrics", "meshing", "shellfabric", "unitcell3d", "weavecell", "tools"):
        for path in (ROOT / package).rglob("*.py"):
            name = str(path.relative_to(ROOT))
            text = path.read_text(encoding="utf-8")
            if name in NO_PARITY_OF_YARNS or not re.search(r"% 2|-1(\.0)?\) \*\*", text):
                continue
            if any(map(_is_parity, ast.walk(ast.parse(text)))):
                found.add(name)
    assert not found


def _is_parity(node):
    """Whether a node is (i + j) % 2 or (-1) ** (i + j)."""
    if not isinstance(node, ast.BinOp):
        return False
    sides = ast.unparse(node.left), ast.unparse(node.right)
    if isinstance(node.op, ast.Pow):
        return sides[0] in ("-1", "-1.0") and "+" in sides[1]
    if not isinstance(node.op, ast.Mod) or sides[1] != "2":
        return False
    return "add.outer" in sides[0] or isinstance(getattr(node.left, "op", None), ast.Add)


def test_a_fabric_says_its_weave(own):
    plain = wc.fabric(own(""))
    basket = wc.fabric(own("basket 2x2"))
    assert ("weave", "basket 2x2") in derived.derive_rows(basket)
    assert "weave" not in dict(derived.derive_rows(plain))


@pytest.mark.parametrize("command", ["biaxial", "mesh", "surface"])
def test_a_command_refuses_it_in_one_line_and_writes_nothing(command, own, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    target = str(own("satin 5"))
    done = CliRunner().invoke(program(), [command, target, "--out", "made"])
    assert isinstance(done.exception, InputError)
    assert done.exception.exit_code == 2
    assert "weave = 'satin 5': must be" in str(done.exception)
    assert not (tmp_path / "made").exists()


@pytest.mark.parametrize("weave, shares", [("basket 2x2", (0.5, 0.5)), ("crowfoot", (0.5, 0.5))])
def test_the_plain_crossing_of_a_weave_has_its_heights(weave, shares, own):
    woven = wc.fabric(own(weave)).weave
    crossing = woven.of_plain_crossing()
    assert crossing.pattern.is_plain
    assert crossing.h0 == pytest.approx(woven.h0)
    assert crossing.w == woven.w
    for yarn, there, share in zip(woven.yarns, crossing.yarns, shares):
        assert there.crimp == pytest.approx(yarn.crimp / share)
    assert PLAIN == wc.fabric("S-720").weave.of_plain_crossing().pattern


@pytest.mark.slow(20)
def test_a_law_of_a_weave_with_crossings_of_several_kinds_is_that_of_its_plain_crossing(own):
    with pytest.raises(InputError, match="of a weave with floats, whose plain crossing is solved"):
        wc.calibrate(own("satin 5"), fit_solid=True)
    solved = wc.calibrate(own("satin 5"), mesh=(2, 2, 2), assumed_range=False)
    assert solved.fabric.weave.pattern.name == "satin 5"
    assert solved.law.provenance.endswith(f", {PLAIN_CROSSING}")
    assert any(f"of a satin 5 is {PLAIN_CROSSING}" in line for line in solved.assumed)
    assert solved.fabric.laws[0].fitted_data == data_digest(wc.fabric(own("satin 5")))


@pytest.mark.parametrize(
    ("weave", "solved"),
    [("plain", False), ("twill 2/2", True), ("basket 2x2", True), ("satin 5", False)],
)
def test_a_calibration_counts_the_paths_of_the_crossings_of_a_weave(weave, solved, own):
    """Of weaves whose crossings are all alike; the plain crossing is solved of all."""
    plan = wc.calibrate.plan(own(weave), mesh=(2, 2, 2), assumed_range=False)
    assert plan.has_own_crossings == solved
    assert ("cell path" in str(plan.forecast())) == solved


@pytest.mark.slow(60)
def test_a_law_of_a_twill_is_that_of_its_own_crossings(own, monkeypatch):
    from unitcell3d.identify import own_crossings

    monkeypatch.setattr(own_crossings, "SIZE", (2, 2, 1))
    solved = wc.calibrate(own("twill 2/2"), mesh=(2, 2, 2), assumed_range=False)
    crossing = solved.mesh.fabric
    samples = own_crossings.solve_samples(crossing, (2, 2, 2), 0.0, "mesh")[:2]
    plain = CompressionLaw.fit(*samples)
    found = re.search(r"a times ([\d.]+) and b times ([\d.]+) in the cell", solved.law.provenance)
    factors = [float(text) for text in found.groups()]
    assert (solved.law.a, solved.law.b) == pytest.approx(
        (plain.a * factors[0], plain.b * factors[1]), rel=5e-3
    )
    assert max(abs(np.log(factors))) > 0.02
    assert solved.fabric.weave.pattern.name == "twill 2/2"
    assert any(f"of a twill 2/2 is {OWN_CROSSINGS}" in line for line in solved.assumed)


@pytest.mark.parametrize("point", [{}, {"impact_point": ("0 mm", "0 mm")}])
def test_one_run_takes_a_pattern_that_no_plane_mirrors(point, own):
    """Pinned yarns of the same shot would be computed as a quarter."""
    setup = {"opening": "30 mm", "end_time": "8 us", **point}
    made = wc.impact.plan(own("basket 2x2"), "90 m/s", **setup).target.setup
    assert made.crossovers is not None
    assert made.symmetry == "whole"


def test_a_page_shows_the_cell_of_crossings_of_several_kinds_by_their_mean(own, monkeypatch):
    """A shot of resolved yarns and a pull-out take such a weave, and their pages have the cell."""
    drawn = []
    monkeypatch.setattr(chapters.pictures, "draw_figure", lambda *given: drawn.append(given[-1]))
    for weave, said in (("crowfoot", True), ("basket 2x2", False)):
        fabric = catalogue.load(own(weave))
        text = chapters.cell(fabric, {"own": fabric.laws}).lead
        assert ("mean of its crossings" in text) == said
    warp, weft = drawn[0]["both yarns stretched alike"]["curves"]["own"]
    assert 0 < warp[-1] != weft[-1] > 0


@pytest.mark.parametrize(
    ("name", "symmetries", "held"),
    [("plain", 16, True), ("basket 2x2", 16, True), ("satin 5", 10, True), ("crowfoot", 4, False)],
)
def test_symmetries_hold_the_yarns_along(name, symmetries, held):
    pattern = Pattern.read(name)
    assert len(pattern.symmetries) == symmetries
    assert pattern.holds_yarns == held
