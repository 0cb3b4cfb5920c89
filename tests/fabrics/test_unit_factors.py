"""Quantities are one number and one unit: converted as pint does, to the last bit, or refused."""

import re
import tomllib
from fractions import Fraction
from typing import Annotated

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from fabrics.base import schema, units
from fabrics.base.errors import InputError
from fabrics.fabric_tables import FabricFile, Quantity
from tests.programs import printed
from weavecell.scenes.coupon import CouponScene
from weavecell.scenes.impact import Scene

# the same examples in every run
SAME = settings(
    deadline=None,
    derandomize=True,
    database=None,
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow],
)
PAIRS = [(unit, to) for to, table in units.FACTORS.items() for unit in table]
# unit = its SI unit and exact value
EXACT = tomllib.loads("""
m = ["m", "1"]
mm = ["m", "1e-3"]
in = ["m", "0.0254"]
"µm" = ["m", "1e-6"]
g = ["kg", "1e-3"]
"m/s" = ["m/s", "1"]
"ft/s" = ["m/s", "0.3048"]
N = ["N", "1"]
lbf = ["N", "4.4482216152605"]
GPa = ["Pa", "1e9"]
"%" = ["", "1e-2"]
"" = ["", "1"]
dtex = ["kg/m", "1e-7"]
den = ["kg/m", "1/9000000"]
denier = ["kg/m", "1/9000000"]
"g/cm3" = ["kg/m^3", "1000"]
"g/cm^3" = ["kg/m^3", "1000"]
"g cm-3" = ["kg/m^3", "1000"]
"kg/m3" = ["kg/m^3", "1"]
"g/m2" = ["kg/m^2", "1e-3"]
gsm = ["kg/m^2", "1e-3"]
"/ cm" = ["1/m", "100"]
"1/cm" = ["1/m", "100"]
"per inch" = ["1/m", "10000/254"]
epi = ["1/m", "10000/254"]
PPI = ["1/m", "10000/254"]
tpi = ["1/m", "10000/254"]
"yarns/cm" = ["1/m", "100"]
"ends / inch" = ["1/m", "10000/254"]
"picks per cm" = ["1/m", "100"]
"threads/in" = ["1/m", "10000/254"]
mil = ["m", "2.54e-5"]
mils = ["m", "2.54e-5"]
mm2 = ["m^2", "1e-6"]
"gf/den" = ["N/(kg/m)", "88259.85"]
"cN/dtex" = ["N/(kg/m)", "1e5"]
us = ["s", "1e-6"]
"mm * N^(1/3)" = ["m * N**(1/3)", "1e-3"]
""")
DIMENSIONS = sorted({to for to, _ in EXACT.values()})
NUMBER = st.from_regex(
    r"[-+]?([0-9]{1,17}(\.[0-9]{0,9})?|\.[0-9]{1,9})([eE][-+]?[0-9]{1,2})?", fullmatch=True
)
PIECE = st.one_of(
    NUMBER,
    st.sampled_from([*EXACT, *"  ,.;/*^+-()_'%", "**", "1/", "e3", "^2", "\u00a0", "٣", "nan"]),
)
TEXT = st.one_of(st.text(max_size=12), st.lists(PIECE, max_size=6).map("".join))


@pytest.mark.parametrize("unit, to", PAIRS)
def test_the_factors_are_those_of_pint(unit, to):
    assert units._factor_by_pint(unit, to) == units.FACTORS[to][unit]


@settings(SAME, max_examples=300)
@given(number=NUMBER, unit=st.sampled_from([*EXACT]), space=st.sampled_from(["", " ", "\u00a0"]))
def test_one_number_and_one_unit_are_converted_exactly(number, unit, space):
    to, value = EXACT[unit]
    text = f" {number}{space or ' ' * (unit[:1] == '1')}{unit} "
    exact = float(Fraction(number) * Fraction(value))
    assert units.si(text, to) == pytest.approx(exact, rel=1e-15, abs=0)


@pytest.mark.parametrize("unit", EXACT)
def test_a_unit_of_another_dimension_is_refused(unit):
    for other in set(DIMENSIONS) - {EXACT[unit][0]}:
        with pytest.raises(InputError):
            units.si(f"2.5 {unit}", other)


@settings(SAME, max_examples=600)
@given(text=TEXT, to=st.sampled_from(DIMENSIONS))
def test_any_text_is_converted_exactly_or_refused(text, to):
    """What is converted is the longest number that it begins with, times the value of the one unit that follows."""
    try:
        found = units.si(text, to)
    except InputError:
        return
    plain = text.strip()
    number = re.match(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", plain, re.ASCII)[0]
    unit = plain[len(number) :].strip()
    value = Fraction(EXACT[unit][1]) if unit in EXACT else Fraction(units.si(f"1 {unit}", to))
    assert found == pytest.approx(float(Fraction(number) * value), rel=1e-15, abs=0)
    without_exponents = re.sub(
        r"(\^|\*\*) ?\(?[-+]?\d\)?|(?<=[a-zµ])-?\d", "", re.sub(r"^1/", "/", unit)
    )
    assert not re.search(r"[\d,.]", without_exponents)


# SI unit = texts that are no quantity in it
REFUSED = tomllib.loads("""
m = [
    "0,23 mm", "1,000 mm", ",5 mm", "2 3 mm", "2 1 mm", "1 000 mm", "1_000 mm", "2 mm 3",
    "2 x 3 mm", "3 mm + 2 mm", "mm", "", "nan mm", "1e999 mm", "3 furlong mm", 3.0, ["3 mm"],
]
"m/s" = ["92,5 m/s"]
kg = [
    "3,5 g", "3 kg^99999999", "3 kg^9^9^9", "3 (kg^9)^9", "3 kg^(9)^(9)^(9)",
    "3 (((((kg^9)^9)^9)^9)^9)^9",
]
"" = ["3,45 %", "5 1", true]
"1/m" = ["8 1 / cm"]
s = ["3 mm"]
""")


@pytest.mark.parametrize(
    "to, text", [(to, text) for to, texts in REFUSED.items() for text in [*texts, None]]
)
def test_everything_else_is_refused(text, to):
    with pytest.raises(InputError) as caught:
        units.si(text, to, key="length")
    assert str(caught.value).startswith(f"length = {text!r}: " if text is not None else "length: ")
    assert ("write a decimal point" in str(caught.value)) == ("," in str(text))


def test_the_usual_units_need_no_pint():
    code = (
        "import sys; from fabrics.base.units import si; si('3 g', 'kg'); si('9 / cm', '1/m'); "
        "print('pint' in sys.modules)"
    )
    assert printed(code) == "False"
    code = (
        "import sys; from fabrics import catalogue, plausible; plausible.rows(); "
        "[catalogue.load(name) for name in catalogue.list_names()]; print('pint' in sys.modules)"
    )
    assert printed(code) == "False"


# dimensions as pint does not tell them apart: an angle, a share, a count of bits, what is no factor
SAME_TO_PINT = {
    "rad": ("%", "ppm", "mm/mm", "dimensionless", "bit", "counts", "AU", "sr", "mm/m", "rad^2"),
    "": ("rad", "deg", "gon", "turn", "mrad", "sr", "bit", "counts", "dB", "Np"),
    "1": ("%", "ppm", "rad", "deg", "mm/mm", "sr", "bit", "counts", "dB", "Np"),
    "1/s": (
        "rad/s",
        "rpm",
        "deg/s",
        "Bq",
        "turn/s",
        "bit/s",
        "counts/s",
        "cycles/s",
        "1/m",
        "sr Hz",
    ),
    "1/m": ("rad/cm", "deg/m", "turn/m", "bit/mm", "sr/m", "gon/mm", "AU/cm", "RIU/m", "Hz", "m"),
    "m": ("rad m", "m/rad", "deg mm", "mm bit", "mm sr", "m^2", "dB", "counts mm", "turn m", "s"),
    "K": ("degC", "degF", "celsius", "degRe", "degC/2", "K rad", "dBm", "fahrenheit", "J", "1"),
    "Pa": ("Pa rad", "Pa/deg", "N/rad", "J/turn", "MPa sr", "N bit/m^2", "N", "J", "dBm", "kg"),
}


@pytest.mark.parametrize("to", SAME_TO_PINT)
def test_what_pint_takes_for_the_same_dimension_is_refused(to):
    for unit in SAME_TO_PINT[to]:
        with pytest.raises(InputError):
            units.si(f"1 {unit}", to)


# a unit for each dimension that a key may have, and none of them twice
OF_EACH = {
    "m": "7 mm",
    "s": "7 us",
    "kg": "7 g",
    "N": "7 N",
    "J": "7 J",
    "K": "7 K",
    "Pa": "7 GPa",
    "m/s": "7 m/s",
    "rad": "7 deg",
    "rad/s": "7 rad/s",
    "": "7 %",
    "1/s": "7 / s",
    "1/m": "7 / cm",
    "kg/m": "700 dtex",
    "kg/m^3": "1.4 g/cm^3",
    "N m^2": "1e-6 N m^2",
}
KEYS = [
    (key, field)
    for model in (Scene, CouponScene, FabricFile)
    for key, field in schema.entries(model).items()
    if schema.unit_of(field) or any(isinstance(part, Quantity) for part in field.metadata)
]


@pytest.mark.parametrize("key, field", KEYS, ids=[key for key, _ in KEYS])
def test_no_key_takes_another_dimension(key, field):
    """At least ten wrong ones, in a text, and in lists as far as the key takes one."""
    own = {schema.unit_of(field) or ""}
    own |= {unit for part in field.metadata if isinstance(part, Quantity) for unit in part.bounds}
    own |= {""} if "1" in own and schema.unit_of(field) else set()
    wrong = [text for unit, text in OF_EACH.items() if unit not in own]
    assert len(wrong) >= 10
    reader = TypeAdapter(Annotated[field.annotation, *field.metadata])
    context = {"source": "file", "idealised": True}
    for text in wrong:
        for value in (text, [text], [text] * 2, [text] * 3):
            with pytest.raises((ValidationError, InputError)):
                reader.validate_python(value, context=context)


# what is written = the unit that is meant; "" where no hint is better than one
SLIPS = {
    ("m", "MM"): "mm",
    ("m", "UM"): "um",
    ("m", "millimtr"): "",
    ("Pa", "Mpa"): "MPa",
    ("Pa", "gpa"): "GPa",
    ("Pa", "parsnip"): "",
    ("rad", "Grad"): "deg",
    ("rad", "grad"): "deg",
    ("m/s", "mps"): "m/s",
    ("m/s", "M/S"): "m/s",
    ("kg", "KG"): "kg",
    ("kg/m", "DTEX"): "dtex",
    ("kg/m", "dnier"): "denier",
    ("s", "mics"): "",
}


@pytest.mark.parametrize("to, unit", SLIPS)
def test_an_unknown_unit_is_named_with_the_one_that_is_meant(to, unit):
    meant = SLIPS[to, unit]
    hint = f', did you mean "{meant}"?' if meant else ""
    with pytest.raises(InputError) as caught:
        units.si(f"3 {unit}", to)
    assert f'has an unknown unit, "{unit}"{hint};' in str(caught.value)


def test_an_angle_has_a_unit():
    """A number alone would be radians, whatever was meant."""
    for text in ("1", "0.5", " 30 "):
        with pytest.raises(InputError, match='such as "45 deg"'):
            units.si(text, "rad")
    assert units.si("0.5 rad", "rad") == 0.5
    assert units.si("180 deg", "rad") == pytest.approx(3.141592653589793, rel=1e-15)
