"""Numbers in formulas: what a comparison says, and that its text says the same.

Sizes of units are written out here, and the arithmetic is done here with fractions.
"""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Comparison,
    Constant,
    QuantityTerm,
    Unary,
    UnaryOperator,
    atoms_of,
)
from rulec.rulebook.loader import diagnose, parse_rulebook

UNITS = {
    "length": {"m": Fraction(1), "km": Fraction(1000), "cm": Fraction(1, 100)},
    "time": {"s": Fraction(1), "min": Fraction(60), "ms": Fraction(1, 1000)},
    "speed": {"m/s": Fraction(1), "km/h": Fraction(1000, 3600), "cm/min": Fraction(1, 6000)},
    "number": {"": Fraction(1)},
    "share": {"%": Fraction(1, 100), "permille": Fraction(1, 1000)},
}
QUANTITIES = {
    "gap": ("length", "m"),
    "way": ("length", "km"),
    "speed": ("speed", "km/h"),
    "wind": ("speed", "m/s"),
    "ratio": ("number", ""),
    "grade": ("share", "%"),
    "rest": ("time", "min"),
}
PARAMETERS = {
    "least": ("length", "1.5 m", lambda state: Fraction(3, 2)),
    "pace": (
        "speed",
        "2 * 7 km/h - speed",
        lambda state: Fraction(14000 - 1000 * state["speed"], 3600),
    ),
    "react": ("time", "1 s if wet else 0.5 s", lambda state: Fraction(1, 1 if state["wet"] else 2)),
    "double": ("number", "1 + 1", lambda state: Fraction(2)),
}
BOOK = (
    "rulebook r signal wet, dark default false\n"
    + "\n".join(
        f"quantity {name} in {unit or 'm/m'} default 0" for name, (_, unit) in QUANTITIES.items()
    )
    + "\n"
    + "\n".join(f"param {name} : {kind} = {said}" for name, (kind, said, _) in PARAMETERS.items())
)

literals = st.builds(Fraction, st.integers(0, 400), st.sampled_from([1, 2, 10, 100]))


def decimal(number):
    hundredths = number.numerator * (100 // number.denominator)
    return f"{hundredths // 100}.{hundredths % 100:02}"


def _literal(kind):
    units = st.sampled_from(sorted(UNITS[kind]))
    return st.builds(
        lambda number, unit: (
            f"{decimal(number)} {unit}".strip(),
            lambda state, value=number * UNITS[kind][unit]: value,
        ),
        literals,
        units,
    )


def _measured(name):
    kind, unit = QUANTITIES[name]
    return (name, lambda state: state[name] * UNITS[kind][unit])


def _leaves(kind):
    named = [_measured(name) for name, (one, _) in QUANTITIES.items() if one == kind]
    named += [(name, value) for name, (one, _, value) in PARAMETERS.items() if one == kind]
    return _literal(kind) | st.sampled_from(named)


def _sum(one, other, sign):
    (left, first), (right, second) = one, other
    return (
        f"({left} {sign} {right})",
        lambda state: first(state) + (1 if sign == "+" else -1) * second(state),
    )


def _bare_sum(one, other, sign):
    """Without parentheses: sums are read from the left."""
    (left, first), (right, second) = one, other
    return (
        f"{left} {sign} ({right})",
        lambda state: first(state) + (1 if sign == "+" else -1) * second(state),
    )


def _opposite(one):
    return f"-({one[0]})", lambda state: -one[1](state)


def _times(one, factor, first):
    text = f"{decimal(factor)} * ({one[0]})" if first else f"({one[0]}) * {decimal(factor)}"
    return f"({text})", lambda state: factor * one[1](state)


def _over(one, factor):
    return f"(({one[0]}) / {decimal(factor)})", lambda state: one[1](state) / factor


def _chosen(one, test, other):
    return (
        f"({one[0]} if {test} else {other[0]})",
        lambda state: one[1](state) if _is_so(test, state) else other[1](state),
    )


def _is_so(test, state):
    return not state[test[4:]] if test.startswith("not ") else state[test]


tests = st.sampled_from(["wet", "dark", "not wet"])


def sums(kind):
    return st.recursive(
        _leaves(kind),
        lambda inner: (
            st.builds(_sum, inner, inner, st.sampled_from("+-"))
            | st.builds(_bare_sum, inner, inner, st.sampled_from("+-")).map(
                lambda one: (f"({one[0]})", one[1])
            )
            | st.builds(_opposite, inner)
            | st.builds(_times, inner, literals, st.booleans())
            | st.builds(_over, inner, literals.filter(bool))
            | st.builds(_chosen, inner, tests, inner)
        ),
        max_leaves=5,
    )


lengths = st.one_of(
    sums("length"),
    st.builds(
        lambda time, speed: (
            f"({time[0]}) * ({speed[0]})",
            lambda state: time[1](state) * speed[1](state),
        ),
        _literal("time") | st.just(("react", PARAMETERS["react"][2])),
        sums("speed"),
    ),
)
pairs = st.one_of(
    st.tuples(lengths, lengths), *(st.tuples(sums(kind), sums(kind)) for kind in UNITS)
)
RELATIONS = {
    "<": lambda one, other: one < other,
    "<=": lambda one, other: one <= other,
    "=": lambda one, other: one == other,
    "!=": lambda one, other: one != other,
    ">=": lambda one, other: one >= other,
    ">": lambda one, other: one > other,
}
states = st.fixed_dictionaries(
    {name: st.integers(-300, 300).map(lambda value: Fraction(value, 4)) for name in QUANTITIES}
    | {"wet": st.booleans(), "dark": st.booleans()}
)


def formula_of(text, declared=BOOK):
    return parse_rulebook(f"{declared}\nhard rule r {{ require {text} }}").rules[0].formula


def is_true(formula, state):
    match formula:
        case Constant(value):
            return value
        case Atom(name):
            return state[name]
        case Comparison(terms, relation, limit):
            values = [factor * state[term.name] for factor, term in terms]
            return RELATIONS[relation](sum(values), limit)
        case Unary(UnaryOperator.NOT, operand):
            return not is_true(operand, state)
        case Binary(BinaryOperator.AND, left, right):
            return is_true(left, state) and is_true(right, state)
        case Binary(BinaryOperator.OR, left, right):
            return is_true(left, state) or is_true(right, state)
    raise AssertionError(formula)


@given(pairs, st.sampled_from(sorted(RELATIONS)), st.lists(states, min_size=1, max_size=4))
def test_a_comparison_says_what_is_written(pair, relation, some):
    (left, first), (right, second) = pair
    formula = formula_of(f"{left} {relation} {right}")
    for state in some:
        assert is_true(formula, state) == RELATIONS[relation](first(state), second(state))


@given(pairs, st.sampled_from(sorted(RELATIONS)))
def test_the_text_of_a_comparison_reads_as_the_comparison(pair, relation):
    formula = formula_of(f"{pair[0][0]} {relation} {pair[1][0]}")
    for one in atoms_of(formula):
        if isinstance(one, Comparison):
            assert formula_of(one.text) == one


@given(pairs, st.sampled_from(sorted(RELATIONS)))
def test_comparisons_are_in_one_form(pair, relation):
    formula = formula_of(f"{pair[0][0]} {relation} {pair[1][0]}")
    for one in atoms_of(formula):
        if isinstance(one, Comparison):
            texts = [term.name for _, term in one.terms if isinstance(term, QuantityTerm)]
            assert texts == sorted(set(texts))
            assert one.terms[0][0] == 1
            assert all(factor for factor, _ in one.terms)


@given(st.sampled_from([0, 1, 3, "3.5", "1e-3", "2e5"]), st.sampled_from(["m", "km"]))
def test_a_bare_zero_fits_every_kind_and_nothing_else_does(number, unit):
    assert formula_of("gap > 0") == formula_of("gap > 0 km") == formula_of("gap - 0 > 0 * speed")
    (comparison,) = atoms_of(formula_of(f"gap > {number} {unit}"))
    assert comparison.limit == Fraction(number) * UNITS["length"][unit]


def test_a_sum_with_a_bare_zero_is_of_the_other_kind():
    plain = formula_of("gap > 5 m")
    for number in ("0 + gap", "gap + 0", "0 + (0 + gap)", "gap - 0"):
        assert formula_of(f"{number} > 5 m") == plain
    assert formula_of("0 - gap < -5 m") == plain
    for wrong in ("0 + gap > 5 s", "gap + 0 > 5 s", "0 - gap < 5"):
        with pytest.raises(RulecError) as caught:
            formula_of(wrong)
        assert [one.code for one in caught.value.diagnostics] == ["R0312"]


def test_what_depends_on_the_same_condition_twice_has_no_impossible_cases():
    once = formula_of("react + react + react + react + react + react + react < 3 s")
    assert once == Constant(False)
    two = formula_of("gap < react * 2 m/s + react * 3 m/s - react * 1 m/s")
    wet, dry = ((Atom("wet"), 4), (Unary(UnaryOperator.NOT, Atom("wet")), 2))
    sides = [
        Binary(
            BinaryOperator.AND, test, Comparison(((Fraction(1), QuantityTerm("gap")),), "<", limit)
        )
        for test, limit in (wet, dry)
    ]
    assert two == Binary(BinaryOperator.OR, *sides)
    # The first condition decides; the second one cannot come true.
    assert formula_of(
        "gap < ((1 m if wet else 2 m) if wet else (1 m if wet else 2 m))"
    ) == formula_of("gap < (1 m if wet else 2 m)")


TRAFFIC = """rulebook r type car signal wet param headway = 2 s
quantity gap(c: car) in m
quantity speed_of(c: car) in km/h
quantity pace in km/h
hard rule h (c: car) { require always (%s) }"""


@pytest.mark.parametrize(
    ("formula", "mended"),
    [
        ("gap(c) >= headway", "`headway * pace`"),
        ("2 s < gap(c)", "`2 s * pace`"),
        ("pace <= 50 km/h if wet else 90 km/h", "`(50 km/h if wet else 90 km/h)`"),
    ],
)
def test_who_mixes_kinds_is_shown_how_it_is_written(formula, mended):
    with pytest.raises(RulecError) as problem:
        parse_rulebook(TRAFFIC % formula)
    assert mended in problem.value.diagnostics[0].help


@pytest.mark.parametrize("unit", ["km/t", "km/u", "km/std", "kmt", "Km/T"])
def test_an_hour_of_another_language_is_no_mass(unit):
    """`t` is a tonne and `u` the unit of atomic mass; `m/s` is not what `km/std` is a slip of."""
    param = f"param top : speed = 50 {unit}"
    for more, formula in [("", f"pace <= 50 {unit}"), (param, "pace > 0")]:
        with pytest.raises(RulecError) as problem:
            parse_rulebook(TRAFFIC % formula + more)
        helps = [one.help for one in problem.value.diagnostics]
        assert "an hour is `h`: did you mean `km/h`?" in helps


def test_without_a_word_for_a_speed_none_is_proposed():
    with pytest.raises(RulecError) as problem:
        parse_rulebook(TRAFFIC.replace("pace in km/h", "pace in m") % "gap(c) >= headway")
    way_out = "`gap(c)` is in m: check the unit of `headway` where it is declared"
    assert problem.value.diagnostics[0].help == way_out
    with pytest.raises(RulecError) as problem:
        # A time would make them alike, too, but who compares them so has slipped in the unit.
        parse_rulebook(TRAFFIC.replace("headway = 2 s", "headway = 50 km") % "headway >= pace")
    assert problem.value.diagnostics[0].help.startswith("`pace` is in km/h: check the unit of")
    with pytest.raises(RulecError) as problem:
        parse_rulebook(TRAFFIC.replace("pace in km/h", "pace in t") % "pace >= gap(c)")
    assert problem.value.diagnostics[0].help == "check the names and the units"


@pytest.mark.parametrize(
    ("number", "says"),
    [
        ("3.500", "is 3.5 kg, and may be meant for 3500 kg"),
        ("12.000", "is 12 kg, and may be meant for 12000 kg"),
        ("7.490", "is 7.49 kg, and may be meant for 7490 kg"),
        ("3.5", None),
        ("3.505", None),
        ("3.50", None),
        ("0.500", None),
        ("1234.500", None),
        ("3.5000", None),
    ],
)
def test_a_point_of_thousands_is_asked_about(number, says):
    text = (
        "rulebook a\nquantity mass in kg default 0\n"
        f"hard rule r {{ require always mass <= {number} kg }}\n"
    )
    found = [one for one in diagnose("a.rules", text.encode()).findings if one.code == "R0365"]
    said = [f"`{number} kg` {says}"] if says else []
    assert [one.message for one in found if one.severity == "warning"] == said


def test_a_value_beside_a_sign_stands_alone():
    with pytest.raises(RulecError) as problem:
        parse_rulebook("rulebook a\nsignal p, q\nhard rule r { require always (nothing = q) }\n")
    (found,) = [one for one in problem.value.diagnostics if one.code == "R0313"]
    assert found.help == "what is true or false is written alone, such as `q`"
    # What they quote is offered as an edit.
    assert "`=`" not in found.expected + found.help


def test_an_hour_of_another_language_in_an_example():
    text = (
        "rulebook a\nquantity pace in km/h default 0\n"
        "hard rule r { require always pace <= 50 km/h accept { pace = 50 km/t } }\n"
    )
    with pytest.raises(RulecError) as problem:
        parse_rulebook(text)
    assert problem.value.diagnostics[0].help == "an hour is `h`: did you mean `km/h`?"


SHARES = """rulebook a
quantity slope in %% default 0
quantity alcohol in permille default 0
quantity ratio in m/m default 0
signal wet default false
param steep = 8
param flat = 8 %%
type car
hard rule r { require always (%s) %s }
"""


@pytest.mark.parametrize(
    ("formula", "said"),
    [
        ("slope > 8", "`8` has no unit and `slope` is in %: they cannot be compared"),
        ("8 < slope", "write the unit, such as `8 %`"),
        ("slope > -8", "write the unit, such as `-8 %`"),
        ("alcohol <= 0.2", "write the unit, such as `0.2 permille`"),
        ("slope + 1 > 8 %", "`1` has no unit and `slope` is in %: they cannot be added"),
        ("slope - alcohol > 3 - 1", "write the unit, %"),
        ("2 * slope > 2 * 4", "write the unit, %"),
        ("slope / 2 > 4", "write the unit, %"),
        ("slope > (8 if wet else 6)", "write the unit, %"),
        ("(slope if wet else 8) > 3 %", "they cannot be one number"),
        ("slope > steep", "write its unit where it is declared, such as `param steep = 3 %`"),
    ],
)
def test_a_share_is_not_compared_with_a_bare_number(formula, said):
    """`slope > 8` would be 800 %, of a quantity whose numbers in traces are per cent."""
    with pytest.raises(RulecError) as problem:
        parse_rulebook(SHARES % (formula, ""))
    (found,) = problem.value.diagnostics
    assert found.code == "R0312"
    assert said in f"{found.message}. {found.help}"


@pytest.mark.parametrize(
    "formula",
    [
        *("slope > 8 %", "slope > 0", "slope > -0", "slope > flat", "slope > 8 permille"),
        *("slope > 2 * 4 %", "2 * slope > 8 %", "slope > (8 % if wet else 0)", "slope + 0 > 8 %"),
        *("slope / 1 % > 8", "slope / 2 % > flat / 1 %", "ratio > 8", "ratio + 1 > 800 %"),
        *("slope > alcohol", "count c: car (c = c) > 1", "flat < 0.5", "slope > ratio"),
    ],
)
def test_what_has_no_unit_or_needs_none(formula):
    parse_rulebook(SHARES % (formula, ""))


@pytest.mark.parametrize("unit", ["%", "permille"])
def test_a_share_in_an_example_has_its_unit(unit):
    name = {"%": "slope", "permille": "alcohol"}[unit]
    for number in ("9", "-9", "0.5"):
        with pytest.raises(RulecError) as problem:
            parse_rulebook(SHARES % (f"{name} <= 8 %", f"accept {{ {name} = {number} }}"))
        (found,) = problem.value.diagnostics
        assert (found.code, found.expected) == ("R0312", f"expected a number in {unit}")
        assert found.help == f"write the unit, such as `{number} {unit}`"
    good = f"accept {{ {name} = 0; {name} = 8 {unit} }} accept {{ ratio = 3 }}"
    parse_rulebook(SHARES % (f"{name} <= 8 %", good))
