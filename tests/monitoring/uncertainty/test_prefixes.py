"""Recordings are cut out of something longer: what was before, and comes after, is not seen."""

from dataclasses import replace
from fractions import Fraction
from itertools import product

from hypothesis import Phase, given, settings

from rulec.automata.bundle.stored_prefixes import stored
from rulec.logic.bounds import PAST, operations_of, range_of
from rulec.logic.formula import Atom, Bound, Unary, UnaryOperator
from rulec.monitoring.verify import verify
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
    """The outcome over all histories: violated, kept or open; with the reasons."""
    found = set()
    for length in range(LONGEST + 1):
        there = Unary(UnaryOperator.NEXT, meant, Bound(Fraction(length), Fraction(length), "steps"))
        hope = Hope(there, semantics, LETTERS)
        for before in product(LETTERS, repeat=length):
            whole = [*before, *word]
            if hope.first_lost(whole) is not None:
                found.add("violated")
            else:
                found.add("kept" if is_kept(there, whole, "finite") else "pending")
        if len(found) == 3 or not any(op.operator in PAST for op in operations_of(meant)):
            break
    return found


@given(seeds)
@settings(phases=[Phase.generate])
def test_outcomes_are_those_of_all_that_may_have_been(chance):
    meant = None
    while meant is None or not is_easy(meant) or reach(meant) > LONGEST - 1:
        leaves = chance.randint(1, 3)
        meant = narrowed(formula(chance, lambda chance: chance.choice([P, Q]), leaves))
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
