"""Units of measure: the table against Pint, composition, refusals and hostile texts."""

import subprocess
import sys
import time
from fractions import Fraction
from functools import cache

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.vocabulary.dimensions import (
    ANGLE,
    ANGLE_IN_RADIANS,
    DIMENSIONS,
    NUMBER,
    UNITS,
    Dimension,
)
from rulec.vocabulary.pint_units import _registry, pint_unit
from rulec.vocabulary.units import known_unit_names, parse_unit, unit_refusal


@cache
def of_pint():
    """Pint's own units, which take most of a second to define."""
    return pint.UnitRegistry(non_int_type=Fraction)


names = st.sampled_from(sorted(UNITS))
parts = st.builds(
    lambda name, power: f"{name}^{power}" if power else name,
    names.filter(lambda name: name not in "%°"),
    st.integers(-9, 9),
)
dimensions = st.builds(
    lambda powers: Dimension.of(**powers),
    st.dictionaries(st.sampled_from(["length", "time", "mass"]), st.integers(-3, 3)),
)


def unit(text):
    found = parse_unit(text)
    assert found is not None, text
    return found


@pytest.mark.parametrize("name", sorted(UNITS))
def test_the_table_says_what_pint_says(name):
    row = UNITS[name]
    if name != "°":  # Pint takes the sign as an operator's, not as a name
        assert pint_unit(name) == row
    # And Pint as it comes, without our registry: all its sizes but that of degrees are exact.
    said = of_pint().Quantity(Fraction(1), name)
    if row.dimension == ANGLE:
        assert said.to("degree").magnitude == row.factor
    else:
        base = {
            "length": "meter",
            "time": "second",
            "speed": "meter/second",
            "mass": "kilogram",
            "angle in radians": "radian",
            "number": "dimensionless",
            "frequency": "1/second",
        }[row.dimension.name]
        assert said.to(base).magnitude == row.factor


@pytest.mark.parametrize(
    ("text", "dimension", "factor"),
    [
        ("km/h", "speed", Fraction(5, 18)),
        ("m/s^2", "acceleration", Fraction(1)),
        ("m/s²", "acceleration", Fraction(1)),
        ("m/s/s", "acceleration", Fraction(1)),
        ("m/s^3", "jerk", Fraction(1)),
        ("km^2", "area", Fraction(10**6)),
        ("s^-1", "frequency", Fraction(1)),
        ("deg/s", "angular speed", Fraction(1)),
        ("m^0", "number", Fraction(1)),
        ("m/m", "number", Fraction(1)),
        # Through Pint:
        ("um", "length", Fraction(1, 10**6)),
        ("kN", "force", Fraction(1000)),
        ("kW", "power", Fraction(1000)),
        ("bar", "pressure", Fraction(10**5)),
        ("hectare", "area", Fraction(10**4)),
        ("short_ton", "mass", Fraction("907.18474")),
        ("long_ton", "mass", Fraction("1016.0469088")),
        ("turn", "angle", Fraction(360)),
        ("arcmin", "angle", Fraction(1, 60)),
        ("rpm", "angular speed", Fraction(6)),
        ("mrad", "angle in radians", Fraction(1, 1000)),
        ("K", "temperature", Fraction(1)),
        ("kbit/s", "information/time", Fraction(1000)),
    ],
)
def test_units(text, dimension, factor):
    found = unit(text)
    assert (found.text, found.dimension.name, found.factor) == (text, dimension, factor)


@pytest.mark.parametrize(
    "text",
    [
        *(
            "step",
            "steps",
            "vehicles",
            "persons",
            "kmh",
            "KM",
            "Km/h",
            "furlongsies",
            "nan",
            "None",
        ),
        *("", "/", "m/", "/s", "m//s", "m^", "^2", "m^2^2", "m^1.5", "m s", "m*s", " m", "m\n"),
        *("²", "m^²", "m²^2", "%/s", "°/s", "1", "m^٣", "\ud800", "__class__", "km/steps"),
    ],
)
def test_unknown(text):
    assert parse_unit(text) is None
    assert unit_refusal(text) is None


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("degC", "its own zero point"),
        ("degF/s", "its own zero point"),
        ("dB", "logarithmic"),
        ("pi", "cannot be exact"),
        ("parsec", "cannot be exact"),
        ("statC", "cannot be exact"),
        ("ton", "depending on the country"),
        ("tons/h", "depending on the country"),
        ("kiloton", "depending on the country"),
        ("m^10", "from -9 to 9"),
        ("m/s^-10", "from -9 to 9"),
        ("m^999999999", "from -9 to 9"),
    ],
)
def test_refused_with_a_reason(text, why):
    assert parse_unit(text) is None
    refusal = unit_refusal(text)
    assert refusal is not None
    assert why in refusal.why
    assert refusal.text in text
    assert refusal.instead


def test_a_unit_that_is_unknown_in_part_is_unknown_not_refused():
    assert unit_refusal("ton/steps") is None


def test_degrees_and_radians_are_of_different_dimensions():
    assert unit("rad").dimension == ANGLE_IN_RADIANS != unit("deg").dimension


def test_known_names_are_known():
    assert {"km/h", "m", "%"} <= set(known_unit_names())
    assert all(parse_unit(name) for name in known_unit_names())


def test_names_of_dimensions():
    assert DIMENSIONS["speed"] == unit("mph").dimension
    assert DIMENSIONS["distance"] == DIMENSIONS["length"] == unit("yd").dimension
    assert DIMENSIONS["duration"] == DIMENSIONS["time"] == unit("min").dimension
    assert {name for name, item in DIMENSIONS.items() if item.name != name} == {
        "distance",
        "duration",
    }
    assert unit("m^2/s").dimension.name == "length^2/time"
    assert unit("kg/m/s^3").dimension.name == "mass/length/time^3"
    assert unit("kg^-2").dimension.name == "1/mass^2"
    assert (DIMENSIONS["length"] * DIMENSIONS["time"]).name == "length*time"


@given(dimensions, dimensions, st.integers(-3, 3))
def test_dimensions_form_a_group(one, other, power):
    assert one * other == other * one
    assert hash(one * other) == hash(other * one)
    assert one * other / other == one
    assert one / one == NUMBER
    assert (one * other) ** power == one**power * other**power


@given(parts, parts)
def test_sizes_multiply(above, below):
    both = unit(f"{above}/{below}")
    assert both.factor == unit(above).factor / unit(below).factor
    assert both.dimension == unit(above).dimension / unit(below).dimension


@given(parts, parts, parts)
def test_all_that_follows_a_slash_divides(one, other, third):
    chain = unit(f"{one}/{other}/{third}")
    assert chain.factor == unit(one).factor / (unit(other).factor * unit(third).factor)


def test_every_unit_of_pint_is_read_or_refused_or_unknown():
    """None of them raises; all that is read is exact and as large as Pint says."""
    read = 0
    for name in of_pint():
        found = parse_unit(name)
        if found is None:
            continue
        read += 1
        assert type(found.factor) is Fraction
        said = float(of_pint().Quantity(Fraction(1), name).to_root_units().magnitude)
        powers = dict(found.dimension.exponents)
        ours = float(found.factor * Fraction(1000) ** powers.get("mass", 0))
        ours *= (3.141592653589793 / 180) ** powers.get("angle", 0)
        assert ours == pytest.approx(said, rel=1e-12), name
    assert read > 800


@given(st.text(max_size=80) | st.from_regex(r"[a-zµ°%/^0-9-]{0,70}", fullmatch=True))
def test_any_text_is_answered(text):
    found = parse_unit(text)
    assert found is None or found.text == text
    assert found is None or unit_refusal(text) is None


@pytest.mark.parametrize(
    "text",
    ["m" * 10**6, "m/" * 10**6, "m^" + "9" * 10**6, "m^-" + "9" * 50, "k" * 64, "_" * 64, "²" * 64],
)
def test_hostile_texts_are_answered_at_once(text):
    begun = time.process_time()
    assert parse_unit(text) is None
    assert time.process_time() - begun < 10  # Pint by itself would take an hour over the first


def test_common_units_do_without_pint():
    program = """
import sys
from rulec.vocabulary.units import known_unit_names, parse_unit
assert all(parse_unit(name) for name in known_unit_names())
assert parse_unit("km/h") and parse_unit("m/s^2")
assert "pint" not in sys.modules, "early"
assert parse_unit("furlong")
assert "pint" in sys.modules, "never"
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)


def test_without_pint_the_others_are_unknown(monkeypatch):
    _registry.cache_clear()
    pint_unit.cache_clear()
    try:
        monkeypatch.setitem(sys.modules, "pint", None)  # makes `import pint` fail
        assert parse_unit("furlong") is None
        assert unit_refusal("degC") is None
        assert unit("km/h").factor == Fraction(5, 18)
    finally:
        _registry.cache_clear()
        pint_unit.cache_clear()
