"""What a result is in one line, what it prints, and what a wrong object in its place is told."""

import html

import pytest

import weavecell as wc
from fabrics.base.door import open_terminal
from fabrics.base.errors import InputError
from weavecell.results import display, keys

QUICK = {"opening": "20 mm", "end_time": "6 us"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("results") / "shot"


@pytest.fixture(scope="module")
def shot(folder):
    return wc.impact("S-720", "150 m/s", out=folder, **QUICK)


@pytest.mark.parametrize(
    "compute",
    [
        lambda: wc.impact("S-720", "150 m/s", check=True, **QUICK),
        lambda: wc.biaxial("S-720"),
        lambda: wc.cite("S-720"),
        lambda: wc.coupon(
            "S-720", "pull_out", displacement="1 mm", crossings=4, crossover_cohesion="0.1 N"
        ),
    ],
    ids=["size", "biaxial", "citations", "pull-out"],
)
def test_a_result_is_one_short_line(compute):
    result = compute()
    assert len(repr(result)) < 250
    assert "\n" not in repr(result)
    assert repr(result).startswith(f"{type(result).__name__}(")


def test_a_loaded_shot_prints_what_it_printed_when_it_was_fired(shot, folder):
    again = wc.load(folder)
    assert str(again).splitlines()[:-1] == str(shot).splitlines()[:-1]
    assert str(again).splitlines()[-1].split() == ["files", str(folder / "report.html")]
    fired, loaded = shot.details().splitlines(), again.details().splitlines()
    assert loaded[:2] == [fired[0], f"read from {folder}"]
    assert loaded[2:] == fired[1:]


def test_doubts_are_printed_and_shown(shot):
    """Among the lines of the answer; of all that is known in Python alone, as the command line prints them last."""
    from dataclasses import replace

    from shellfabric.membrane.quality import indicator

    words = "yarn snap 0.42"
    doubted = replace(shot, checks=(*shot.checks, indicator("yarn snap", 0.42)))
    (line,) = [line for line in str(doubted).splitlines() if line.startswith("doubts")]
    assert words in line
    assert words in doubted._repr_html_().replace("</abbr>", "")
    assert words not in str(shot)
    checks = f"checks: doubtful: {words}"
    assert checks in doubted.details()
    with open_terminal():
        assert words in str(doubted)
        assert checks not in doubted.details()


def test_a_result_in_place_of_a_fabric_is_named(shot):
    for call in (
        lambda: wc.impact(shot, "100 m/s"),
        lambda: wc.biaxial(shot),
        lambda: wc.v50(shot),
    ):
        with pytest.raises(InputError, match=r"^ShotResult: is a result; .*overlay"):
            call()
    with pytest.raises(InputError, match=r"ShotResult and ShotResult.*overlay draws others"):
        wc.compare(shot, shot)
    with pytest.raises(InputError, match=r"^results\[1\] = 'yesterday': must be a result"):
        wc.overlay(shot, "yesterday")


@pytest.mark.parametrize(
    "over, options, hint",
    [
        ({"velosity": [80, 100]}, {}, 'over={"projectile.strike_velocity": [80, 100]}'),
        ({"opening": ["4 cm"]}, {}, 'over={"panel.opening": ["4 cm"]}'),
        ({"panel.plies": [1, 2]}, {"opening": "40 mm"}, 'over={"panel.opening": ["40 mm"]}'),
        ({"panel.plies": [1, 2]}, {}, 'over={"projectile.strike_velocity": ["90 m/s", "150 m/s"]}'),
        ({"colour": ["red"]}, {}, 'over={"panel.opening": ["150 mm", "200 mm"]}'),
    ],
)
def test_a_sweep_says_how_a_key_is_varied(over, options, hint):
    """In Python as Python writes it, in the terminal as the command line does."""
    with pytest.raises(InputError) as refused:
        wc.sweep("S-720", over=over, **options)
    assert hint in str(refused.value)
    with open_terminal(), pytest.raises(InputError) as refused:
        wc.sweep("S-720", over=over, **options)
    assert '--over "' in str(refused.value)


def test_a_number_in_an_error_has_no_noise_of_its_unit():
    error = InputError(key="mass", value=2.6 * 1e-3, allowed="more")
    assert str(error) == "mass = 0.0026: must be more"
    assert error.value == 2.6 * 1e-3


@pytest.mark.parametrize(
    "value, form, text",
    [
        (1778.4, ".3g", "1780"),
        (1222.6, "+.3g", "+1220"),
        (-45678.9, ".4g", "-45680"),
        (6.02e23, ".3g", "6.02e+23"),
        (0.00012, ".3g", "0.00012"),
    ],
)
def test_numbers_below_a_million_have_no_exponent(value, form, text):
    assert display.number(value, "N", form) == text


def test_an_energy_over_an_areal_density_has_its_unit():
    assert keys.infer_key("a_specific_energy_J_m2_kg").label == "a specific energy [J m2/kg]"


def test_tables_show_whole_texts_and_four_digits(shot):
    checks = shot.checks_table()
    assert "..." not in checks._repr_html_()
    assert max(checks["meaning"], key=len) in html.unescape(checks._repr_html_())
    fabrics = wc.fabrics().head(2)
    assert fabrics["warp count [1/cm]"]["S-726"] == pytest.approx(10.2362204, abs=1e-7)
    for shown in (fabrics._repr_html_(), repr(fabrics)):
        assert "10.24" in shown
        assert "10.236" not in shown
