"""Sheets that print what pages on fabrics print: each becomes a fabric, or the stop says what to write."""

import itertools
import logging

import pytest

import weavecell as wc
from fabrics import assumed
from fabrics.base.errors import InputError
from fabrics.base.units import si
from fabrics.fabric_tables import FIBRES
from fabrics.families import list_families
from weavecell.scenes import fabric_file
from weavecell.studies import unknown

PAGE = {
    "linear_density": ("1000 denier", "1100 dtex"),
    "count": ("24 / inch", "9 / cm"),
    "thickness": ("0.4 mm", ""),
}
MORE = {
    "fibre_density": {
        family.name: family.typical["fibre_density"]["value"] for family in list_families()
    },
    "modulus": {family.name: family.typical["modulus"]["value"] for family in list_families()},
    "strength": {family.name: family.typical["strength"]["value"] for family in list_families()},
}


def sheet(tmp_path, values):
    rows = [
        "key,warp,weft,source",
        *(f"{key},{warp},{weft},a page" for key, (warp, weft) in values.items()),
    ]
    path = tmp_path / "sheet.csv"
    path.write_text("\n".join(rows))
    return path


@pytest.mark.parametrize("family", FIBRES)
@pytest.mark.parametrize("printed", list(itertools.product((False, True), repeat=3)))
def test_a_page_of_any_family_becomes_a_fabric(family, printed, tmp_path):
    """Whatever of modulus, density and strength it prints; what stands in has a range, within the family."""
    own = {key: (MORE[key][family],) * 2 for key, there in zip(MORE, printed) if there}
    path = sheet(tmp_path, PAGE | own)
    wc.new_fabric(tmp_path / "mine.toml", values=path, family=family)
    fabric = wc.fabric(tmp_path / "mine.toml")
    found = assumed.family_of(fabric)
    assert found.name == family
    assert not found.of_others
    varied = {key.partition(".")[2] for key in fabric.ranges if key.startswith(("warp.", "weft."))}
    assert varied == {key for key, there in zip(MORE, printed) if not there} - {"fibre_density"}
    for key in varied:
        pairs = zip(*(fabric.ranges[f"{family}.{key}"] for family in ("warp", "weft")))
        for ratios in pairs:
            for yarn in assumed.scale_ranged(fabric, key, ratios).weave.yarns:
                assert found.allows(
                    {
                        "strength": yarn.E * yarn.failure_strain,
                        "failure_strain": yarn.failure_strain,
                    }
                )


@pytest.mark.parametrize(
    "text, name",
    [
        ("kevlar 49", "para-aramid"),
        ("Aramid", "para-aramid"),
        ("uhmwpe", "UHMWPE"),
        ("Dyneema SK75", "UHMWPE"),
        ("e glass", "E-glass"),
        ("PA6.6", "nylon"),
        ("Polyethylene-terephthalate", "polyester"),
        ("zylon AS", "PBO"),
        ("VECTRAN", "LCP"),
    ],
)
def test_a_family_is_found_by_the_names_that_users_write(text, name, tmp_path):
    wc.new_fabric(tmp_path / "mine.toml", values=sheet(tmp_path, PAGE), family=text)
    assert wc.fabric(tmp_path / "mine.toml").family == name


@pytest.mark.parametrize("text", ["S-glass", "basalt", "", "E", "poly"])
def test_a_fibre_of_no_family_is_told_what_to_name(text, tmp_path):
    with pytest.raises(InputError) as refused:
        wc.new_fabric(tmp_path / "mine.toml", values=sheet(tmp_path, PAGE), family=text)
    assert "PBO (Zylon)" in str(refused.value)
    assert "most like it" in str(refused.value)


@pytest.mark.parametrize(
    "key, text, units_of",
    [
        ("tenacity", "3530 MPa", ["modulus", "strength"]),
        ("linear_density", "180 gsm", ["areal_density"]),
        ("thickness", "12 / cm", ["count"]),
        ("fibre_density", "12 m/s", []),
    ],
)
def test_a_value_under_the_wrong_key_names_the_keys_of_its_unit(key, text, units_of, tmp_path):
    path = sheet(tmp_path, PAGE | {key: (text, "")})
    with pytest.raises(InputError) as refused:
        fabric_file.read_values(path, "nylon")
    (line,) = [line for line in str(refused.value).splitlines() if key in line]
    if units_of:
        assert line.endswith(f"this is a unit of {' or '.join(units_of)}")
    else:
        assert "this is a unit" not in line


@pytest.mark.parametrize("text", ["5.9 osy", "5.9 opsy", "200 gsm", "200 g/sq m", "5.9 oz/sq. yd."])
def test_an_areal_density_is_in_the_units_of_the_trade(text):
    assert si(text, "kg/m^2") == pytest.approx(0.2, rel=2e-3)


@pytest.mark.parametrize("key", ["fibre_density", "modulus", "failure_strain"])
def test_a_stop_says_what_to_write(key, tmp_path):
    given = {"fibre_density": "1.38 g/cm^3", "modulus": "11 GPa", "tenacity": "8 g/den"}
    del given[{"failure_strain": "tenacity"}.get(key, key)]
    path = sheet(tmp_path, PAGE | {name: (text, "") for name, text in given.items()})
    with pytest.raises(InputError) as refused:
        fabric_file.read_values(path)
    assert f"{key}: is missing" in str(refused.value)
    assert "family" in str(refused.value)


@pytest.mark.parametrize(
    "text, force",
    [
        ("400 lbf/inch", 70050.7),
        ("400 lb/in", 70050.7),
        ("2500 N/5cm", 5e4),
        ("250 daN / 50 mm", 5e4),
        ("50 N/mm", 5e4),
    ],
)
def test_the_strength_of_a_strip_is_that_of_its_yarns(text, force, tmp_path):
    """Force over width and count, before weaving takes its share."""
    assert si(text, "N/m") == pytest.approx(force, rel=1e-5)
    path = sheet(tmp_path, PAGE | {"breaking_strength": (text, "300 lbf/inch")})
    values, _ = fabric_file.read_values(path, "nylon")
    share = (
        next(each for each in list_families() if each.name == "nylon")
        .shots["strength after weaving"]
        .value
    )
    warp, weft = (si(getattr(values["strength"], yarn), "N") for yarn in ("warp", "weft"))
    assert warp * share == pytest.approx(force * 0.0254 / 24, rel=1e-3)
    assert weft * share == pytest.approx(300 * 4.44822 / 0.0254 / 900, rel=1e-3)
    low, high = values["strength"].ranges["weft"]
    assert si(low, "N") == weft
    assert si(high, "N") == pytest.approx(1.25 * weft, rel=1e-3)


NOT_LINEAR = {
    "modulus": ("100 g/den", "11 GPa"),
    "fibre_density": ("1.38 g/cm^3", ""),
    "tenacity": ("8.5 g/den", ""),
}


def test_a_yarn_that_is_not_linear_takes_a_modulus_between_its_own(tmp_path, caplog):
    path = sheet(tmp_path, PAGE | NOT_LINEAR | {"failure_strain": ("14 %", "13 %")})
    with caplog.at_level(logging.INFO, "weavecell"):
        wc.new_fabric(tmp_path / "pet.toml", values=path)
    assert "polyester is not linear" in caplog.text
    fabric = wc.fabric(tmp_path / "pet.toml")
    strength = 8.5 * 9.80665e-3 * 9000 / 1e-3 * 1380  # [Pa]
    for yarn, at_first, strain, name in zip(
        fabric.weave.yarns, (100 / 8.5 * strength, 11e9), (0.14, 0.13), ("warp", "weft")
    ):
        secant = strength / strain
        assert yarn.E == pytest.approx((at_first * secant) ** 0.5, rel=1e-3)
        assert yarn.E * yarn.failure_strain == pytest.approx(strength, rel=1e-3)
        low, high = fabric.ranges[f"{name}.modulus"]
        assert (low * yarn.E, high * yarn.E) == pytest.approx((secant, at_first), rel=1e-3)


def test_three_numbers_of_a_linear_fibre_that_disagree_are_refused(tmp_path):
    numbers = {
        "modulus": ("85 GPa", ""),
        "fibre_density": ("1.44 g/cm^3", ""),
        "strength": ("3 GPa", ""),
    }
    path = sheet(tmp_path, PAGE | numbers | {"failure_strain": ("5 %", "")})
    with pytest.raises(InputError, match="check the three, or leave one out"):
        wc.new_fabric(tmp_path / "mine.toml", values=path)
    assert not (tmp_path / "mine.toml").exists()


@pytest.mark.parametrize(
    "family, friction, ends",
    [
        ("para-aramid", 0.2, (0.1, 0.3)),
        ("UHMWPE", 0.12, (0.05, 0.25)),
        ("polyester", 0.3, (0.15, 0.48)),
        ("carbon", 0.25, (0.1, 0.5)),
    ],
)
def test_friction_of_yarns_is_of_their_family(family, friction, ends, tmp_path):
    """In the set-up, in what is said of it, in its runs and in the checks of pinned yarns; a given one stays."""
    mine = tmp_path / "mine.toml"
    wc.new_fabric(mine, values=sheet(tmp_path, PAGE), family=family)
    given = {"opening": "60 mm", "law": {"a": 2e-5, "b": 2e-5}}
    setup = wc.setup(mine, "90 m/s", crossovers="yarns", **given)
    assert setup.crossovers.friction == friction
    assert setup.crossovers.friction_range == ends
    low, high = (f"{end:g}" for end in ends)
    assert f"{friction:g} ({low} .. {high})" in setup.crossovers.assumed_lines[0]
    name = "friction between yarns"
    drawn = [unknown.put_all(setup, unknown.ALIKE, {name: share}) for share in (0.0, 0.5, 1.0)]
    low_end, high_end = ends
    assert [one.crossovers.friction for one in drawn] == [low_end, friction, high_end]
    own = wc.setup(mine, "90 m/s", crossovers="yarns", crossover_friction=0.17, **given)
    assert (own.crossovers.friction, own.crossovers.friction_range) == (0.17, ())
