"""Random rulebooks over the small vocabulary: any strengths, levels, weights and priorities."""

from dataclasses import replace
from fractions import Fraction

from hypothesis import strategies as st

from rulec.automata.compiler import compile_rulebook
from rulec.logic.formula import Unary, UnaryOperator
from support.builders.rulebooks import (
    P,
    Q,
    always,
    book,
    both,
    eventually,
    far,
    implies,
    near,
    no,
    rule,
)

LEVELS = ("a", "b", "c")


_BOOK = book(
    rule("never_near_then_far", always(no(both(near("x"), eventually(far("x"))))), "x: car"),
    rule("no_two_near", always(no(both(near("x"), near("y")))), "x: thing", "y: thing"),
    rule("p_is_answered", always(implies(P, eventually(Q)))),
    rule("never_far", always(no(far("x"))), "x: car"),
    rule("never_p", always(no(P))),
    rule("ends_in_q", eventually(always(Q))),
    rule("p_goes_on", always(implies(P, Unary(UnaryOperator.NEXT, P)))),
)
RULES = compile_rulebook(_BOOK)
FINITE = compile_rulebook(replace(_BOOK, semantics="finite"))


def closed(pairs):
    """The pre-order that these pairs (higher, lower) lead to."""
    order = set(pairs)
    for middle in LEVELS:
        order |= {
            (one, other)
            for one, first in order
            if first == middle
            for second, other in order
            if second == middle
        }
    return frozenset((one, other) for one, other in order if one != other)


PAIRS = [(one, other) for one in LEVELS for other in LEVELS if one != other]


@st.composite
def rulebooks(draw, strengths=("hard", "soft")):
    """Any of the rules with any strength, level and weight, and any pre-order of the levels."""
    compiled = draw(st.sampled_from([RULES, FINITE]))
    rules = draw(st.lists(st.sampled_from(compiled.rules), unique_by=lambda one: one.name))
    return replace(
        compiled,
        rules=tuple(
            replace(
                one,
                strength=draw(st.sampled_from(strengths)),
                level=draw(st.sampled_from(["", *LEVELS])),
                weight=draw(st.sampled_from([Fraction(1), Fraction(2), Fraction(1, 3)])),
            )
            for one in rules
        ),
        levels=LEVELS,
        priorities=closed(draw(st.sets(st.sampled_from(PAIRS)))),
    )
