"""Definitions mean what stands in their place when it is written out by hand."""

from dataclasses import dataclass, replace
from itertools import count

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.logic.formula import (
    Atom,
    Binary,
    Comparison,
    Constant,
    Count,
    QuantityTerm,
    Same,
    Unary,
    atoms_of,
)
from rulec.rulebook.loader import parse_rulebook

BOOK = """rulebook r
type car
signal near(c: car), far(c: car), wet default false
quantity gap(c: car) in m default 0
quantity way(c: car) in km default 0
option strict = on
param least = 1.5 m if wet else 2 m
"""
RELATIONS = ["near", "far"]


# Expressions as this test writes them out, with the objects and relations that they speak of.


@dataclass(frozen=True)
class Said:
    """`near(x)`"""

    relation: str
    thing: str


@dataclass(frozen=True)
class Less:
    """`gap(x) - 2 * way(y) < least`"""

    one: str
    other: str


@dataclass(frozen=True)
class Equal:
    """`x = y`"""

    one: str
    other: str


@dataclass(frozen=True)
class Joined:
    """`(p and q)`, `(not p)`"""

    words: tuple
    parts: tuple


@dataclass(frozen=True)
class Counted:
    """`some c: car (…)`"""

    kind: str
    name: str
    body: object


@dataclass(frozen=True)
class Use:
    """`close(near, x, y)`"""

    definition: int
    relation: str
    things: tuple


def text(node):
    match node:
        case Said(relation, thing):
            return f"{relation}({thing})"
        case Less(one, other):
            return f"gap({one}) - 2 * way({other}) < least"
        case Equal(one, other):
            return f"{one} = {other}"
        case Joined(words, parts):
            inner = " ".join(
                piece
                for word, part in zip(words, (*parts, None), strict=False)
                for piece in (word, "" if part is None else text(part))
            )
            return f"({inner})"
        case Counted("count", name, body):
            return f"count {name}: car ({text(body)}) >= 2"
        case Counted(kind, name, body):
            return f"{kind} {name}: car ({text(body)})"
        case Use(definition, relation, things):
            return f"d{definition}({', '.join((relation, *things))})"


def written_out(node, bodies, names, fresh):
    """Without definitions; counted variables get names that nothing else has."""

    def again(part):
        return written_out(part, bodies, names, fresh)

    match node:
        case Said(relation, thing):
            return Said(names.get(relation, relation), names[thing])
        case Less(one, other):
            return Less(names[one], names[other])
        case Equal(one, other):
            return Equal(names[one], names[other])
        case Joined(words, parts):
            return Joined(words, tuple(again(part) for part in parts))
        case Counted(kind, name, body):
            new = f"n{next(fresh)}"
            return Counted(kind, new, written_out(body, bodies, {**names, name: new}, fresh))
        case Use(definition, relation, things):
            inner = {
                "rel": names.get(relation, relation),
                "a": names[things[0]],
                "b": names[things[1]],
            }
            return written_out(bodies[definition], bodies, inner, fresh)


@st.composite
def expressions(draw, things, relations, definitions, deep=3, moment=False):
    """An expression about some things; ``definitions`` is the number of those it may use."""
    thing, relation = st.sampled_from(things), st.sampled_from(relations)

    def inner(more=(), moment=moment):
        return draw(expressions([*things, *more], relations, definitions, deep - 1, moment))

    kinds = ["said", "less", "equal"]
    if deep:
        kinds += ["not", "and", "or", "iff", "count"] + ["use"] * bool(definitions)
        kinds += [] if moment else ["then", "once", "until"]
    match draw(st.sampled_from(kinds)):
        case "said":
            return Said(draw(relation), draw(thing))
        case "less":
            return Less(draw(thing), draw(thing))
        case "equal":
            return Equal(draw(thing), draw(thing))
        case ("not" | "once") as word:
            return Joined((word,), (inner(),))
        case ("and" | "or" | "iff" | "then" | "until") as word:
            return Joined(("", word), (inner(), inner()))
        case "count":
            # The names of the rule's variables, too: inside of a definition they are free.
            free = [name for name in ("x", "y", "c", "c_2") if name not in things]
            name = draw(st.sampled_from(free)) if free else "e"
            assume(name not in things)
            kind = draw(st.sampled_from(["some", "every", "count"]))
            return Counted(kind, name, inner((name,), moment=True))
        case _:
            pair = (draw(thing), draw(thing))
            return Use(draw(st.integers(0, definitions - 1)), draw(relation), pair)


@st.composite
def books(draw):
    """Definitions, of which the later ones use the earlier ones, and a rule."""
    # What a count speaks of has no time, so a definition without time may be used there.
    bodies = [
        draw(expressions(["a", "b"], [*RELATIONS, "rel"], number, 2, moment=True))
        for number in range(draw(st.integers(1, 3)))
    ]
    rule = draw(expressions(["x", "y"], RELATIONS, len(bodies)))
    return bodies, rule


def formula_of(bodies, require):
    declared = "".join(
        f"define d{number}(rel, a: car, b) = {text(body)}\n" for number, body in enumerate(bodies)
    )
    return (
        parse_rulebook(f"{BOOK}{declared}hard rule r (x: car, y: car) {{ require {require} }}")
        .rules[0]
        .formula
    )


def in_one_form(formula, names=()):
    """With counted variables named by how deep they are."""
    known = dict(names)
    match formula:
        case Atom(_, arguments):
            return replace(formula, arguments=tuple(known.get(one, one) for one in arguments))
        case Same(left, right):
            return Same(*sorted((known.get(left, left), known.get(right, right))))
        case Comparison(terms):
            said = [(factor, _term(term, known)) for factor, term in terms]
            return replace(formula, terms=tuple(sorted(said, key=repr)), text="")
        case Unary(_, operand):
            return replace(formula, operand=in_one_form(operand, names))
        case Binary(_, left, right):
            sides = in_one_form(left, names), in_one_form(right, names)
            return replace(formula, left=sides[0], right=sides[1])
        case Constant():
            return formula


def _term(term, known):
    if isinstance(term, QuantityTerm):
        return replace(term, arguments=tuple(known.get(one, one) for one in term.arguments))
    own = f"depth {len(known)}"
    body = in_one_form(term.body, {**known, term.variable: own}.items())
    return Count(own, term.type, body)


@given(books())
def test_a_definition_is_what_stands_in_its_place(book):
    bodies, rule = book
    plain = written_out(rule, bodies, {"x": "x", "y": "y"}, count())
    expected = in_one_form(formula_of([], text(plain)))
    assert in_one_form(formula_of(bodies, text(rule))) == expected


@given(books())
def test_the_text_of_every_comparison_reads_as_the_comparison(book):
    bodies, rule = book
    for one in atoms_of(formula_of(bodies, text(rule))):
        if isinstance(one, Comparison):
            again = formula_of([], one.text)
            assert in_one_form(again) == in_one_form(one)


def test_a_relation_is_looked_up_where_the_definition_is_used():
    """The name of a definition's parameter does not hide what is given for another one."""
    text = """rulebook r
    type car
    signal a default false
    define both(a: car, b) = near(a) and b
    signal near(c: car) default false
    hard rule r (v: car) { require always both(v, a) }"""
    both = parse_rulebook(text).rules[0].formula.operand
    assert (both.left, both.right) == (Atom("near", ("v",)), Atom("a"))


@pytest.mark.parametrize(
    ("definitions", "use", "code", "said", "number"),
    [
        ("define d = e\ndefine e = d", "d", "R0316", "`e` uses `d` uses `e`", 1),
        ("define d = d or wet", "wet", "R0316", "`d` uses `d`", 1),
        ("define d(r, v: car) = r(r, v)", "d(d, x)", "R0316", "`d` uses `d`", 1),
        ("param d = e\nparam e = 1 m + d", "gap(x) < d", "R0316", "`e` uses `d` uses `e`", 1),
        ("define d = nope\ndefine e = d", "d and e and d", "R0202", "`nope`", 1),
        ("define d(v: car) = gap(v) < 3 s", "d(x) and d(y)", "R0312", "a length", 1),
        ("define d(r) = r(r)", "d(near)", "R0203", "`r`", 1),
        ("define d(r, v) = r(v)", "d(x, y)", "R0303", "`r`", 1),
        ("define d(r, v) = r(v)", "d(gap, y) > 3 s", "R0312", "`d(gap, y)`", 2),
        ("define d(r, v) = r(v)", "d(naer, y)", "R0203", "`naer`", 2),
    ],
)
def test_a_mistake_is_said_once_where_it_was_made(definitions, use, code, said, number):
    """In the definition, however often that is used; or at each use, if that is what is wrong."""
    with pytest.raises(RulecError) as caught:
        parse_rulebook(
            f"{BOOK}{definitions}\nhard rule r (x: car, y: car) {{ require {use} }}"
            f"\nhard rule s (x: car, y: car) {{ require not ({use}) }}"
        )
    mistakes = [one for one in caught.value.diagnostics if one.severity == "error"]
    assert [one.code for one in mistakes] == [code] * number
    assert all(said in one.message for one in mistakes)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("wet", "`wet` is about no object, and one is given"),
        ("strict", "`strict` is an option and about no object"),
        ("two", "`two` takes 2 things, and one is given"),
    ],
)
def test_what_does_not_fit_a_definition_is_said_where_it_was_given(given, said):
    """To mend the definition would change it for others: there is no edit of it."""
    text = (
        f"{BOOK}define two(a: car, b: car) = near(a) and near(b)\n"
        "define inner(r, v: car) = r(v)\ndefine outer(q, v: car) = inner(q, v)\n"
        f"hard rule r (x: car) {{ require outer({given}, x) }}\n"
    )
    with pytest.raises(RulecError) as caught:
        parse_rulebook(text)
    (mistake,) = (one for one in caught.value.diagnostics if one.severity == "error")
    assert (mistake.code, mistake.message) == ("R0301", said)
    line = text.splitlines()[mistake.place.line - 1]
    assert line[mistake.place.column - 1 :].startswith(f"{given}, x)")
    assert mistake.expected == "expected something about one object"
    assert "it is used here as `r(v)`" in [label.message for label in mistake.labels]
    assert mistake.fix is None
    assert mistake.offers == ()


def test_too_few_arguments_are_completed_as_the_user_wrote_them():
    book = f"{BOOK}define two(a: car, b: car) = near(a) and near(b)\n"
    with pytest.raises(RulecError) as caught:
        parse_rulebook(f"{book}hard rule r (x: car) {{ require two(x) }}\n")
    (mistake,) = caught.value.diagnostics
    assert mistake.expected == "expected `two(x, …)`"
    assert mistake.labels[0].message == "defined here as `two(a: car, b: car)`"
