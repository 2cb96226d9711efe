"""Recordings are cut out of something longer: what was before, and comes after, is not seen."""

from dataclasses import replace
from fractions import Fraction
from itertools import product

import pytest
from hypothesis import Phase, given, settings

from rulec.automata.bundle.cut_machines import stored
from rulec.logic.bounds import PAST, operations_of, range_of
from rulec.logic.formula import Atom, Binary, BinaryOperator, Bound, Unary, UnaryOperator
from rulec.monitoring.batch.verify import verify
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.rulebook_model import Rule, Rulebook
from rulec.trace import Trace
from rulec.vocabulary import Signal, Vocabulary
from support.builders.rulebooks import compile_here
from support.generators.random_rulebooks import formula
from support.generators.seeds import seeds
from support.oracles.continuation_oracle import Hope
from support.oracles.formula_oracle import is_kept
from support.oracles.past_in_spot import is_easy

P, Q = Atom("p"), Atom("q")
VOCABULARY = Vocabulary("two", {}, {"p": Signal("p", (), False), "q": Signal("q", (), False)})
LETTERS = [frozenset(chosen) for chosen in ((), (P,), (Q,), (P, Q))]
LONGEST = 4
STEPS = {"next", "weak next", "previously", "weak previously"}
"""These look at one state, whose distance is both ends of their bound."""


def narrowed(found):
    """Bounds so small that four letters before the word tell all that may have been."""
    match found:
        case Unary(operator, operand, bound):
            return Unary(operator, narrowed(operand), small(bound, is_one=operator.value in STEPS))
        case Atom():
            return found
    if hasattr(found, "left"):
        left, right = narrowed(found.left), narrowed(found.right)
        return type(found)(found.operator, left, right, small(found.bound))
    return found


def small(bound, is_one=False):
    if bound is None:
        return None
    low = min(bound.low, Fraction(1))
    if is_one:
        return Bound(low, low, "steps")
    return Bound(low, None if bound.high is None else min(bound.high, low + 1), "steps")


def reach(found):
    """How many letters before the word may have a say, if nothing unbounded is within."""
    past = [op for op in operations_of(found) if op.operator in PAST]
    return sum(1 if range_of(op).high is None else range_of(op).high for op in past)


def reading(meant, semantics, word):
    """The outcome over all histories: violated, kept or open; with the reasons.

    A sequence that never happens did not before, either: the formula begins anywhere in the
    history, which keeps it.
    """
    found = set()
    operations = list(operations_of(meant))
    goes_on = meant in operations[:1] and meant.operator.value in ("always", "never")
    goes_on = goes_on and meant.bound is None and "then" in [x.operator.value for x in operations]
    for length in range(LONGEST + 1):
        for begin in range(length + 1) if goes_on else [length]:
            steps = Bound(Fraction(begin), Fraction(begin), "steps")
            there = Unary(UnaryOperator.NEXT, meant, steps)
            hope = Hope(there, semantics, LETTERS)
            for before in product(LETTERS, repeat=length):
                whole = [*before, *word]
                lost = hope.first_lost(whole)
                if lost is None:
                    found.add("kept" if is_kept(there, whole, "finite") else "pending")
                elif lost >= length or begin == length:
                    found.add("violated")
        looks_back = any(op.operator in PAST for op in operations)
        if len(found) == 3 or not (looks_back or goes_on):
            break
    return found


@given(seeds)
@settings(phases=[Phase.generate])
def test_outcomes_are_those_of_all_that_may_have_been(chance):
    meant = None
    while meant is None or not is_easy(meant) or reach(meant) > LONGEST - 1:
        leaves = chance.randint(1, 3)
        meant = narrowed(formula(chance, lambda chance: chance.choice([P, Q]), leaves))
        if chance.random() < 0.3:
            meant = Unary(UnaryOperator.NEVER, Binary(BinaryOperator.THEN, P, meant))
    semantics = chance.choice(["stutter", "finite"])
    book = Rulebook("r", VOCABULARY, (Rule("r", "hard", (), meant),), semantics=semantics)
    compiled = compile_here(book, Fraction(1))
    word = chance.choices(LETTERS, k=chance.randint(1, 3))
    states = tuple({"p": P in letter, "q": Q in letter} for letter in word)
    verdict = verify(Trace("t", 1.0, {}, states, ends="cut"), compiled)
    as_stored = replace(compiled, prefixes=stored(compiled))
    assert verify(Trace("t", 1.0, {}, states, ends="cut"), as_stored) == verdict
    expected = reading(meant, semantics, word)
    if expected == {"violated"}:
        assert verdict.violations, (meant, word)
    elif expected == {"kept"}:
        assert verdict.satisfied, (meant, word)
    else:
        (found,) = verdict.open
        assert not verdict.violations
        assert ("not over" in found.because) >= (expected == {"pending"})
        assert ("began before" in found.because) == (len(expected) > 1), (meant, word, expected)


LONG = "true then p then[>= 3 s] true"
"""For three states or longer, and some state before."""


@pytest.mark.parametrize(
    ("text", "values", "outcome"),
    [
        (f"require never ({LONG})", "TF", "open"),
        (f"require never ({LONG})", "FTTF", "kept"),
        (f"require never ({LONG})", "TTTTT", "violated"),
        # Nobody knows for how long, but of what is not under way
        (f"require never ({LONG})", "TTFTTF", "open"),
        ("require never (p then not p)", "FF", "open"),
        ("require always not (p and next not p)", "FF", "kept"),
        # What was violated before is no matter of the trace
        (f"require never ({LONG})", "F", "kept"),
    ],
)
def test_a_sequence_that_was_under_way_is_open(text, values, outcome):
    book = parse_rulebook(f"rulebook r signal p hard rule r {{ {text} }}")
    states = tuple({"p": value == "T"} for value in values)
    verdict = verify(Trace("t", 1.0, {}, states, ends="cut"), compile_here(book, Fraction(1)))
    assert [bool(verdict.violations), bool(verdict.open)] == [
        outcome == "violated",
        outcome == "open",
    ]
    assert all(own.because == ("began before",) for own in verdict.open)


SCOPES = ("throughout", "at start", "at end", "at some point", "initially")


@pytest.mark.parametrize(
    "exception", ["", "when not x", *(f"unless x {scope}" for scope in SCOPES)]
)
@pytest.mark.parametrize("phases", ["q then p", "q then p then not p", "q then q then p"])
def test_no_exception_hides_that_a_sequence_may_be_under_way(exception, phases):
    """It may be, whatever the rule's formula is made of: before the last phase ``q`` was seen."""
    text = f"require never ({phases}) {exception}"
    book = compile_here(
        parse_rulebook(f"rulebook r signal p, q, x default false hard rule r {{ {text} }}"),
        Fraction(1),
    )

    def outcome(*states, ends):
        named = tuple({name: name in state for name in "pqx"} for state in states)
        verdict = verify(Trace("t", 1.0, {}, named, ends=ends), book)
        return bool(verdict.violations), [one.because for one in verdict.open]

    rest = ["p", ""] if phases.endswith("not p") else ["p"]
    # With the state before that was not seen it is violated; without it, nobody knows
    assert outcome("q", "q", *rest, ends="complete") == (True, [])
    assert outcome(*rest, ends="cut") == (False, [("began before",)])


def test_what_is_with_others_begins_where_they_are_there():
    text = "type car signal p(o: car) hard rule r (o: car) { require never (p(o) then not p(o)) }"
    book = compile_here(parse_rulebook(f"rulebook r {text}"), Fraction(1))
    states = ({"p": {"a": False}},) * 2
    assert verify(Trace("t", 1.0, {"a": "car"}, states, ends="cut"), book).satisfied


@pytest.mark.parametrize(
    ("rule", "why"),
    [
        ("eventually once p", "only Spot can make it, which is not what compiled the rulebook"),
        ("eventually once p and always[<= 1 s] p", "it is smaller for larger time steps"),
    ],
)
def test_a_rule_that_takes_spot_is_not_said_to_be_too_large_alone(monkeypatch, rule, why):
    monkeypatch.setenv("RULEC_COMPILER", "diagrams")
    book = parse_rulebook(f"rulebook b signal p hard rule r {{ require {rule} }}")
    verdict = verify(Trace("", Fraction(1), {}, ({"p": False},), ends="cut"), compile_here(book))
    (left_out,) = verdict.not_judged
    assert left_out.why.endswith(why)
