"""Names and types: what a rule means, and warnings."""

import pytest

from rulec.diagnostics import RulecError, Source
from rulec.logic.formula import Atom, Binary, BinaryOperator, Constant, Unary, UnaryOperator
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.reading.rulebook_reader import load_rulebook, read_rulebook
from rulec.rulebook.resolve import resolve
from rulec.rulebook.rulebook_model import Variable
from rulec.syntax import parse


def position(value, variable):
    return Atom("position", (variable,), value)


def no(operand):
    return Unary(UnaryOperator.NOT, operand)


def always(operand):
    return Unary(UnaryOperator.ALWAYS, operand)


def following(operand):
    return Unary(UnaryOperator.NEXT, operand)


def both(left, right):
    return Binary(BinaryOperator.AND, left, right)


def until(left, right):
    return Binary(BinaryOperator.UNTIL, left, right)


B, R, L, F = (position(value, "v") for value in "brlf")
CROSSING = Atom("surface", (), "R_pc")

PAPER = {
    # Esterle et al. 2019, Section VI.
    "R1": Binary(
        BinaryOperator.IMPLIES,
        no(Atom("CONGESTED")),
        always(no(both(B, following(until(B, until(R, F)))))),
    ),
    "R2": always(no(both(B, following(until(B, until(L, both(F, CROSSING))))))),
    "R3": always(no(both(CROSSING, position("f", "p")))),
}


@pytest.fixture(scope="module")
def paper():
    return load_rulebook("esterle2019")


@pytest.mark.parametrize("name", PAPER)
def test_the_paper_s_rules_mean_what_is_printed(paper, name):
    (rule,) = (rule for rule in paper.rules if rule.name == name)
    assert rule.formula == PAPER[name]
    assert rule.strength == "hard"
    kind = Variable("p", "pedestrian") if name == "R3" else Variable("v", "vehicle")
    assert rule.variables == (kind,)
    assert rule.cite.startswith("Article")
    labels = [example.label for example in rule.examples]
    assert labels == [f"tau {number}" for number in range(1, len(labels) + 1)]


def test_the_paper_s_rulebook_has_no_warnings_and_knows_its_law(paper):
    assert read_rulebook("esterle2019").warnings == ()
    assert [rule.name for rule in paper.rules] == ["R1", "R2", "R3"]
    assert paper.as_of == "1968-11-08"
    assert "Vienna" in paper.law


def formula(text, variables="(v: car, w: car, b_w: car)"):
    return (
        parse_rulebook(
            f"""rulebook test
        type car
        signal p, q
        signal b(c: car), two(c: car, d: car), c_v, long_name(c: car)
        hard rule r {variables} {{ require {text} }}"""
        )
        .rules[0]
        .formula
    )


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("b_v", Atom("b", ("v",))),
        ("b(v)", Atom("b", ("v",))),
        ("two(v, w)", Atom("two", ("v", "w"))),
        ("c_v", Atom("c_v")),
        ("long_name_v", Atom("long_name", ("v",))),
        ("b_b_w", Atom("b", ("b_w",))),
        ("true", Constant(True)),
        ("p xor false", Binary(BinaryOperator.XOR, Atom("p"), Constant(False))),
        ("weak next p", Unary(UnaryOperator.WEAK_NEXT, Atom("p"))),
        ("p M q", Binary(BinaryOperator.STRONG_RELEASE, Atom("p"), Atom("q"))),
    ],
)
def test_atoms(text, meaning):
    assert formula(text) == meaning


def test_every_operator_has_its_meaning():
    for operator in BinaryOperator:
        expected = Binary(operator, Atom("p"), Atom("q"))
        assert formula(f"p {operator.value} q") == expected
    for operator in UnaryOperator:
        assert formula(f"{operator.value} p") == Unary(operator, Atom("p"))


def test_subtypes_fit_where_their_supertypes_are_asked_for():
    text = """rulebook test
    type a
    type b is a
    type c is b
    signal near(x: a), far(x)
    hard rule r (x: c) { require near_x and far(x) }"""
    assert parse_rulebook(text).rules[0].variables == (Variable("x", "c"),)
    assert parse_rulebook(text).vocabulary.declarations["far"].parameters == ("a",)


def test_an_unused_variable_is_a_warning(tmp_path):
    path = tmp_path / "warned.rules"
    path.write_text(
        "rulebook warned\nuse paper\nhard rule r (v: vehicle) { require always CONGESTED }\n"
    )
    (warning,) = read_rulebook(path).warnings
    assert (warning.code, warning.severity) == ("R0207", "warning")
    assert "`v`" in warning.message


def test_what_is_unreadable_yields_no_rulebook_but_no_second_error():
    rules = "hard rule r { require always p }\nhard rule s { require q and x_1 }\n"
    text = f"rulebook a\nsignal p q\n{rules}"
    tree, (syntax,) = parse(Source("a", text))
    found = resolve([tree], at="2026-01-01")
    (meaning,) = found.mistakes
    assert found.rulebook is None
    assert syntax.place.line == 2
    assert "`x_1`" in meaning.message


@pytest.mark.parametrize(
    ("state", "missing"),
    [("{ b_v }", "`surface`"), ("{ road }", "`b(v)`"), ("{ b_v and not b_v and road }", "both")],
)
def test_a_state_says_what_has_no_default(state, missing):
    text = f"""rulebook test
    type car
    signal b(c: car)
    surface is one of road, path
    hard rule r (v: car) {{ require always (b_v and road) accept {state} }}"""
    with pytest.raises(RulecError) as caught:
        parse_rulebook(text)
    (one,) = caught.value.diagnostics
    assert missing in one.message


def test_a_rule_has_the_topics_that_it_names_else_those_that_name_it():
    rulebook = parse_rulebook(
        "rulebook a\nsignal p\n"
        'topics { first "One" of gap, gap_to_cyclists; second "Two" of gap; third "Three" }\n'
        + "".join(
            f"hard rule {name} {{ {said} require p }}\n"
            for name, said in {
                "gap": "",
                "gap_to_horses": "",
                # The longest name decides, and only whole words of a name count.
                "gap_to_cyclists_in_town": "",
                "gaps": "",
                "gap_to_trams": "topic third, first",
            }.items()
        )
    )
    assert {rule.name: rule.topics for rule in rulebook.rules} == {
        "gap": ("first", "second"),
        "gap_to_horses": ("first", "second"),
        "gap_to_cyclists_in_town": ("first",),
        "gaps": (),
        "gap_to_trams": ("third", "first"),
    }
    assert [topic.title for topic in rulebook.topics] == ["One", "Two", "Three"]
