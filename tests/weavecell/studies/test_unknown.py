"""What is not known of a shot, row by row: given it is fixed, given with a range it is drawn from that, else from the
range of its family or of the data files."""

import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import weavecell as wc
from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.base.run_cache import inputs_digest
from fabrics.families import entries
from shellfabric.yarns.model import DATA
from weavecell.report.shot import chapters_shot
from weavecell.studies import inputs, strengths, unknown
from weavecell.studies.inputs import Scatter

MINE = Path(__file__).parents[3] / "examples" / "fabrics" / "mine.toml"
SCATTER = inputs.read_scatter()
LAW = {"a": "0.04 mm", "b": "0.05 mm N^(1/3)"}
NOSE = {"mass": "1.1 g", "diameter": "5.4 mm"}
PACK = {"law": LAW, "opening": "40 mm", "plies": 3, "crossovers": "yarns"}
CHISEL = {"projectile": "FSP 1.10 g"}


def load(tmp_path, *changes):
    """Load the fabric of the data sheet with changes of its file, (old, new)."""
    text = MINE.read_text("utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "mine.toml"
    path.write_text(text, "utf-8")
    return catalogue.load(path)


def setup(fabric=None, **more):
    return wc.setup(fabric or catalogue.load(MINE), "120 m/s", **PACK | more)


def with_nose(friction):
    return {"projectile": {**NOSE, "edge_radius": "0.3 mm", "friction": friction}}


def woven(strength):
    return {"weaving_damage": {"strength": strength, "source": "yarns taken from the cloth"}}


def clamps(force):
    return {"crossovers": "pinned", "boundary": {"warp": {"clamp_force": force}, "weft": "clamped"}}


def crimp(made):
    return made.fabric.weave.warp.crimp


HEAD = "\n[warp]\n"
# {row: (keywords or changes of the fabric file that give it, that give it with a range, value, low and high of that
# range, what reads it of a set-up)}; a dict is keywords, a tuple is changes of the file
ROWS = {
    "friction between yarns": (
        {"crossover_friction": 0.23}, {"crossover_friction": "0.2 ± 0.02"},
        (0.2, 0.16, 0.24), lambda made: made.crossovers.friction,
    ),
    "friction on the nose": (
        with_nose(0.17), with_nose("0.05 to 0.15"), (0.1, 0.05, 0.15), lambda made: made.projectile.friction,
    ),
    "friction between plies": (
        {"ply_friction": 0.23}, {"ply_friction": "0.1 to 0.2"}, (0.15, 0.1, 0.2), lambda made: made.ply_friction,
    ),
    "gap between plies": (
        {"ply_gap": "0.06 mm"}, {"ply_gap": "0.05 to 0.09 mm"}, (7e-5, 5e-5, 9e-5), lambda made: made.ply_gap,
    ),
    "strength after weaving": (
        woven(0.9), woven("0.8 to 0.9"), (0.85, 0.8, 0.9),
        lambda made: made.fabric.weave.warp.strength / catalogue.load(MINE).weave.warp.strength,
    ),
    "compression law": (
        {}, {"law": LAW | {"a": "0.04 mm ± 5 %", "b": "0.04 to 0.06 mm N^(1/3)"}},
        (0.04e-3, 0.044e-3, 0.036e-3), lambda made: made.laws[1].a,
    ),
    "clamp force": (clamps("5 N"), clamps("2 to 6 N"), (4.0, 2.0, 6.0), lambda made: made.boundary[0].clamp_force),
    "failure length": (
        ((HEAD, f'\nfailure_length = "1 mm"{HEAD}'),), ((HEAD, f'\nfailure_length = "0.8 to 1.2 mm"{HEAD}'),),
        (1e-3, 0.8e-3, 1.2e-3), lambda made: made.fabric.failure_length,
    ),
    "thickness": (
        (("count =", 'crimp = "1 %"\ncount ='),), (('"0.30 mm"', '"0.27 to 0.33 mm"'),), None, crimp,
    ),
    "crimp of the file": (
        (("count =", 'crimp = "1 %"\ncount ='),), (("count =", 'crimp = "0.8 to 1.2 %"\ncount ='),),
        (0.01, 0.008, 0.012), crimp,
    ),
    "modulus of the file": (
        (), (('modulus = "90 GPa"', 'modulus = "80 to 100 GPa"'),), (90e9, 80e9, 100e9),
        lambda made: made.fabric.weave.weft.E,
    ),
}  # fmt: skip
# what no key of an input or fabric file gives by itself, or what is drawn whatever is given
OTHERS = {
    "roll", "strength of yarns", "modulus", "crimp of the warp", "crimp of the weft", "strength of the file",
    "place along the warp", "place along the weft", "areal density", "share of the warp in the thickness",
    "length of changes of sides", "trellis law", "energy given back by plies", "area of packed fabric",
    "lateral stiffness of yarns", "edge of yarns under the nose", unknown.LAW_SHAPE,
}  # fmt: skip
NEVER_ASSUMED = {"clamp force", "crimp of the file", "modulus of the file", "compression law"}


def made_of(given, tmp_path):
    if isinstance(given, dict):
        return setup(**given)
    return setup(load(tmp_path, *given))


def test_every_row_is_tried_here():
    assert {row.name for row in unknown.ROWS} == set(ROWS) | OTHERS


@pytest.mark.parametrize("name", ROWS)
def test_given_it_is_fixed_with_a_range_drawn_from_it_else_from_that_of_its_family(name, tmp_path):
    given, ranged, wanted, read = ROWS[name]
    fixed, in_range = made_of(given, tmp_path), made_of(ranged, tmp_path)
    assert name not in unknown.find_drawn(fixed, SCATTER)
    _, found = unknown.find_drawn(in_range, SCATTER)[name]
    assert found.given
    ends = [read(unknown.put_all(in_range, SCATTER, {name: share})) for share in (0.5, 0.0, 1.0)]
    # the one run stands in the middle of the draws
    assert ends[0] == pytest.approx(float(read(in_range)))
    if wanted is not None:
        assert ends == pytest.approx(wanted, rel=1e-9)
    assert ends[1] != ends[0] != ends[2]
    usual = unknown.find_drawn(setup(), SCATTER)
    assert (name in usual) == (name not in NEVER_ASSUMED)
    if name in usual:
        assert not usual[name][1].given
        assert usual[name][1].source
    # a study that is continued finds no shot of another range
    assert inputs_digest(fixed) != inputs_digest(in_range)
    again = pickle.loads(pickle.dumps(in_range))
    assert unknown.find_drawn(again, SCATTER)[name][1] == found


def test_a_range_takes_the_place_of_another_in_what_is_kept():
    narrow, wide = (setup(**with_nose(words)) for words in ("0.1 to 0.2", "0.05 to 0.25"))
    assert narrow == wide
    assert inputs_digest(narrow) != inputs_digest(wide)


def test_a_value_changes_its_own_number_and_no_other(tmp_path):
    """At the lower end of each row of a pack, what all others read stays."""
    made = setup(load(tmp_path, ("count =", 'crimp = "0.8 to 1.2 %"\ncount =')), **with_nose(None))
    reads = {name: row[3] for name, row in ROWS.items() if name not in ("thickness", "clamp force")}
    before = {name: read(made) for name, read in reads.items()}
    for name in unknown.find_drawn(made, SCATTER):
        low = unknown.put_all(made, SCATTER, {name: 0.1})
        for other in reads.keys() - {name}:
            shared = other == "crimp of the file" and name in (
                "crimp of the warp",
                "crimp of the weft",
            )
            shared = shared or (other, name) == ("modulus of the file", "modulus")
            shared = shared or (other, name) == ("strength after weaving", "modulus")
            if not shared:
                assert reads[other](low) == before[other], f"{name} changes {other}"


def test_a_row_more_moves_no_other_draw(monkeypatch):
    """And the order of the rows neither: a draw follows from seed, number and name."""
    made = setup(**CHISEL)
    plain = [unknown.draw(made, SCATTER, 7, number, 3 * number)[1] for number in (0, 5)]
    more = replace(unknown.ROWS[-3], name="one more")
    monkeypatch.setattr(unknown, "ROWS", (more, *reversed(unknown.ROWS)))
    for number, values in zip((0, 5), plain):
        again = unknown.draw(made, SCATTER, 7, number, 3 * number)[1]
        assert again.pop("one more") > 0
        assert again == values
        assert len(set(values.values())) > 12


def test_set_ups_share_the_draws_of_what_both_leave_open():
    """One ply of pinned yarns, a pack whose friction is given: what both draw is the same."""
    one = wc.setup("S-728", "90 m/s", opening="40 mm", **CHISEL)
    pack = wc.setup("S-728", "90 m/s", opening="60 mm", plies=3, ply_friction=0.2, **CHISEL)
    a, b = (unknown.draw(made, SCATTER, 5, 11, 11)[1] for made in (one, pack))
    assert set(a) < set(b)
    assert {name: b[name] for name in a} == a


@pytest.mark.parametrize("name", ["failure length", "lateral stiffness of yarns"])
def test_draws_of_a_row_are_even_over_their_range(name):
    """Of 2^k in a row one lies in each 2^k-th of the range; of rows that differ they do not go together."""
    row = next(row for row in unknown.ROWS if row.name == name)
    for first, count in ((0, 16), (32, 32)):
        shares = np.array([row.share(3, number, 0) for number in range(first, first + count)])
        assert sorted((shares * count).astype(int)) == list(range(count))
    own = [other for other in unknown.ROWS if other.panel is None]
    table = [[other.share(3, number, 0) for number in range(64)] for other in own]
    together = np.corrcoef(table) - np.eye(len(own))
    # of random numbers 0.126; scrambled alone, all rows have one order, and 0.75
    assert np.sqrt((together**2).mean()) < 0.16


def test_half_of_the_draws_lie_below_the_value():
    entry = entries(DATA)["lateral_stiffness"]
    made = wc.setup("S-728", "90 m/s", opening="40 mm", crossovers="yarns")
    _, found = unknown.find_drawn(made, SCATTER)["lateral stiffness of yarns"]
    ends = [found.at(share) for share in (0.0, 0.25, 0.5, 1.0)]
    assert ends == pytest.approx(
        [entry.low, (entry.low + entry.value) / 2, entry.value, entry.high]
    )


def test_a_deviation_is_a_normal_distribution_that_ends_at_two():
    _, found = unknown.find_drawn(setup(crossover_friction="0.2 ± 0.05"), SCATTER)[
        "friction between yarns"
    ]
    values = np.array([found.at((k + 0.5) / 4000) for k in range(4000)])
    assert (values.mean(), values.min(), values.max()) == pytest.approx((0.2, 0.1, 0.3), abs=2e-3)
    # of the whole of it the deviation would be 0.05
    assert values.std() == pytest.approx(0.88 * 0.05, rel=0.01)


def test_draws_are_those_that_the_truths_were_made_with():
    """Seed 1, draws 0 and 1 of a known table of limits: shares of frictions and factors of the panel."""
    made = wc.setup("S-726", "90 m/s", opening="60 mm", crossovers="yarns", **CHISEL)
    known = ((0.94865, 0.31183, 1.0161489925320106, 1.080023013345474),
             (0.44865, 0.81183, 1.0257280047744424, 1.1263029146970474))  # fmt: skip
    for number, (yarns, nose, modulus, crimp_warp) in enumerate(known):
        values = unknown.draw(made, SCATTER, 1, number, number)[1]
        assert values["friction between yarns"] == pytest.approx(0.1 + 0.2 * yarns, abs=2e-6)
        assert values["friction on the nose"] == pytest.approx(0.2 * nose, abs=2e-6)
        assert values["modulus"] == pytest.approx(modulus)
        assert values["crimp of the warp"] == pytest.approx(crimp_warp)


def test_pinned_packs_draw_place_roll_and_frictions_one_pinned_ply_no_place():
    pack = wc.setup("S-728", "90 m/s", opening="40 mm", plies=3, **CHISEL)
    one = wc.setup("S-728", "90 m/s", opening="40 mm", **CHISEL)
    drawn = strengths.draw_panel(pack, SCATTER, 5, 3)
    assert {"place_along_warp", "roll", "friction_on_nose", "friction_between_plies"} <= set(
        drawn.values
    )
    ply = drawn.pack.plies[0]
    assert ply.impact_point[0] == pytest.approx(
        2 * pack.fabric.weave.w[0] * drawn.values["place_along_warp"]
    )
    assert ply.projectile.friction == drawn.values["friction_on_nose"]
    assert not {"place_along_warp", "roll"} & set(strengths.draw_panel(one, SCATTER, 5, 3).values)


def test_all_that_crimp_follows_from_is_drawn_at_once():
    """Thickness and share of the warp together: both count."""
    made = setup()
    alone = [crimp(unknown.put_all(made, SCATTER, {name: 0.9})) for name in ("thickness",)]
    share = {"share of the warp in the thickness": 0.1}
    both = crimp(unknown.put_all(made, SCATTER, {"thickness": 0.9, **share}))
    assert crimp(made) < alone[0]
    assert both < alone[0]
    assert both > crimp(unknown.put_all(made, SCATTER, share))


def test_the_law_goes_from_its_soft_to_its_stiff_end():
    law = replace(catalogue.load("S-720").laws[0], assumed_range=((5e-5, 4e-5), (3e-5, 5e-5)))
    made = replace(setup(), laws=(law, replace(law, assumed_range=((6e-5, 4e-5), (2e-5, 6e-5)))))
    low, middle, high = (
        unknown.put_all(made, SCATTER, {"compression law": share}).laws
        for share in (0.0, 0.5, 0.75)
    )
    assert [(one.a, one.b) for one in low] == [(5e-5, 4e-5), (6e-5, 4e-5)]
    assert [(one.a, one.b) for one in middle] == [(law.a, law.b)] * 2
    assert high[1].a == pytest.approx((law.a + 2e-5) / 2)


def test_a_law_with_a_joint_range_is_drawn_from_it_a_and_b_together():
    """A law of a calibration: each ply has the laws that both shares give; of one whose ends alone are known, none."""
    law = replace(catalogue.load("S-720").laws[0], F_range=(0.5, 90.0))
    wide = law.with_spread([[0.04, 0.03], [0.03, 0.09]])
    made = replace(setup(), laws=(wide, replace(wide, a=0.8 * wide.a)))
    assert {unknown.LAW, unknown.LAW_SHAPE} <= set(unknown.find_drawn(made, SCATTER))
    shares = {unknown.LAW: 0.2, unknown.LAW_SHAPE: 0.9}
    assert unknown.put_all(made, SCATTER, shares).laws == tuple(
        one.sample((0.2, 0.9)) for one in made.laws
    )
    for name, u in ((unknown.LAW, (0.2, 0.5)), (unknown.LAW_SHAPE, (0.5, 0.9))):
        (moved, _) = unknown.put_all(made, SCATTER, {name: shares[name]}).laws
        assert moved == wide.sample(u)
    ends = replace(made, laws=(replace(wide, spread=None),) * 2)
    assert unknown.LAW_SHAPE not in unknown.find_drawn(ends, SCATTER)


def test_the_page_lists_what_is_drawn_and_from_where():
    rows = chapters_shot.describe_unknown(setup(crossover_friction="0.2 ± 0.02")).tables[0].rows
    of = {row[0]: row[1:] for row in rows}
    assert of["friction between yarns"][:2] == ("0.2 ± 0.02", "given, one for a cloth")
    assert of["friction between plies"][:2] == ("0.15 to 0.25", "assumed, one for a cloth")
    assert of["place along the warp"][:2] == ("0 to 0.5 spacings", "assumed, new for each shot")
    assert of["failure length"][0] == "0.375 to 1.5 mm"
    assert all(row[3] for row in rows)


def test_what_is_drawn_is_said_shortly():
    said = unknown.say_drawn(setup(crossover_friction="0.2 ± 0.02"))
    assert said == (
        "place, friction between yarns 0.2 ± 0.02, friction on the nose 0 to 0.2, friction between plies 0.15 to 0.25, "
        "strength, crimp and 8 more drawn"
    )


@pytest.mark.parametrize(
    "options, message",
    [
        ({"opening": "40 mm ± 1 mm"}, r"opening = '40 mm ± 1 mm': must be a length above 0.*without a range: shots "),
        ({"crossover_friction": "0.3 to 0.1"}, "crossover_friction = '0.3 to 0.1': must be a range whose ends rise"),
        ({"crossover_friction": "0.1 ± 0.1"}, "must be a value ± a standard deviation, of which twice stays within"),
        ({"ply_gap": "0.1 ± 10 %"}, "ply_gap = '0.1 ± 10 %': must be said of which"),
        ({"ply_gap": "0.1 mm to 0.2 cm"}, "must be a range in one unit"),
        ({"crossover_friction": "0.1 to 3"}, "must be a range that stays within what is allowed"),
    ],
)  # fmt: skip
def test_a_range_that_is_none_is_refused(options, message):
    with pytest.raises(InputError, match=message):
        setup(**options)


def test_a_range_of_a_number_that_is_not_drawn_is_refused_in_a_fabric_file(tmp_path):
    with pytest.raises(
        InputError, match=r"warp\.count = '8 to 9 / cm': must be one value: only modulus, "
    ):
        load(tmp_path, ('count = "8.5 / cm"', 'count = "8 to 9 / cm"'))


@pytest.mark.parametrize("name", ["assumed_range", "interval"])
def test_options_of_earlier_versions_say_what_took_their_place(name):
    with pytest.raises(
        InputError, match=f"{name}: was removed: one run is made, and draws=16 fires 16 drawn"
    ):
        wc.impact("S-728", "90 m/s", **{name: True})


def test_no_scatter_of_panels_draws_neither_modulus_nor_crimp():
    made = wc.setup("S-728", "90 m/s", opening="40 mm")
    assert not {"modulus", "crimp of the warp"} & set(unknown.find_drawn(made, Scatter()))
