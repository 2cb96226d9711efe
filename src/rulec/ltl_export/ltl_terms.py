"""Formulas in the operators that all tools for linear temporal logic share, and their texts.

Bounds are unfolded; weak until and strong release are expressed by until and release. A finite word
ends where a proposition becomes false (De Giacomo, Vardi, "Linear temporal logic and linear dynamic
logic on finite traces", 2013).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import NamedTuple

from rulec.logic import formula as ltl
from rulec.logic.bounds import Range
from rulec.logic.fold import Algebra, fold, temporal_operation


class Term(NamedTuple):
    """An operator with its operands; or a proposition, or ``true``.

    Operators are ``!``, ``&``, ``|``, ``->``, ``<->``, ``X``, ``F``, ``G``, ``U`` and ``R``.
    """

    sign: str
    operands: tuple[Term, ...] = ()


TRUE = Term("true")
FALSE = Term("!", (TRUE,))


@dataclass(frozen=True, slots=True)
class Syntax:
    """A tool's own notation: operators, ``true``, and propositions that differ from the usual form.

    ``has_implication``: it has implication and equivalence between temporal formulas.
    """

    signs: Mapping[str, str]
    proposition: str = "{}"
    has_implication: bool = True


SPOT = Syntax({})
PRISM = Syntax({}, '"{}"', has_implication=False)
NUXMV = Syntax({"R": "V", "true": "TRUE"})


def conjunction(terms: Sequence[Term]) -> Term:
    """The conjunction of all terms that are not ``true``; true if there are none."""
    kept = [term for term in terms if term != TRUE]
    return reduce(lambda left, right: Term("&", (left, right)), kept) if kept else TRUE


class Terms:
    """Formulas without past as terms, each subformula translated once.

    ``names`` maps propositions to names; ``alive`` is the name of the proposition that is true
    while a finite word lasts, None if words are infinite.
    """

    def __init__(self, names: Mapping[ltl.Proposition, str], alive: str | None) -> None:
        self._alive = None if alive is None else Term(alive)
        self._known: dict[ltl.Formula, Term] = {}
        self._algebra = Algebra(
            proposition=lambda proposition: Term(names[proposition]),
            constant=lambda value: TRUE if value else FALSE,
            negation=_not,
            conjunction=lambda left, right: Term("&", (left, right)),
            disjunction=lambda left, right: Term("|", (left, right)),
            implication=lambda left, right: Term("->", (left, right)),
            equivalence=lambda left, right: Term("<->", (left, right)),
            operation=temporal_operation(
                _not,
                until=self._until,
                release=self._release,
                weak_until=self._weak_until,
                strong_release=self._strong_release,
            ),
        )

    def term_of(self, formula: ltl.Formula) -> Term:
        """The term of a formula with bounds in steps; raises ValueError for a past operator."""
        return fold(formula, self._algebra, self._known)

    def always(self, fact: ltl.Formula) -> Term:
        """The term that a formula holds in every state."""
        return self._release(None, self.term_of(fact), Range(0, None))

    @property
    def lasting(self) -> Term:
        """The assumption that a finite word has an end, after its first state; else true."""
        if self._alive is None:
            return TRUE
        ended = Term("G", (_not(self._alive),))
        return Term("&", (self._alive, Term("U", (self._alive, ended))))

    def _while_alive(self, term: Term) -> Term:
        """The term, in a state of the word."""
        return term if self._alive is None else Term("&", (self._alive, term))

    def _if_there(self, term: Term) -> Term:
        return term if self._alive is None else Term("|", (_not(self._alive), term))

    def _until(self, left: Term | None, right: Term, span: Range) -> Term:
        low, high = span
        if high is not None and high < low:
            return FALSE
        now = right
        if high is None:
            meets = self._while_alive(right)
            now = Term("F", (meets,)) if left is None else Term("U", (left, meets))
        for _ in range(0 if high is None else high - low):
            now = Term("|", (right, _and_later(left, Term("X", (self._while_alive(now),)))))
        for _ in range(low):
            now = _and_later(left, Term("X", (self._while_alive(now),)))
        return now

    def _release(self, left: Term | None, right: Term, span: Range) -> Term:
        low, high = span
        if high is not None and high < low:
            return TRUE
        now = right
        if high is None:
            keeps = self._if_there(right)
            now = Term("G", (keeps,)) if left is None else Term("R", (left, keeps))
        for _ in range(0 if high is None else high - low):
            now = Term("&", (right, _or_later(left, Term("X", (self._if_there(now),)))))
        for _ in range(low):
            now = _or_later(left, Term("X", (self._if_there(now),)))
        return now

    def _weak_until(self, left: Term, right: Term, span: Range) -> Term:
        lasting = self._release(None, left, Range(0, span.high))
        return Term("|", (self._until(left, right, span), lasting))

    def _strong_release(self, left: Term, right: Term, span: Range) -> Term:
        reached = self._until(None, left, Range(0, span.high))
        return Term("&", (self._release(left, right, span), reached))


def _not(term: Term) -> Term:
    return Term("!", (term,))


def _and_later(left: Term | None, later: Term) -> Term:
    return later if left is None else Term("&", (left, later))


def _or_later(left: Term | None, later: Term) -> Term:
    return later if left is None else Term("|", (left, later))


def text_of(term: Term, syntax: Syntax) -> str:
    """The term in a tool's notation."""
    parts: list[str] = []
    # With an explicit stack, since bounds of hundreds of steps nest as deep.
    left: list[Term | str] = [term]
    while left:
        piece = left.pop()
        if isinstance(piece, str):
            parts.append(piece)
            continue
        if not syntax.has_implication:
            piece = _by_negation(piece)
        sign = syntax.signs.get(piece.sign, piece.sign)
        match piece.operands:
            case ():
                parts.append(sign if piece == TRUE else syntax.proposition.format(sign))
            case (inner,):
                # A binary operand has its own parentheses.
                left += [inner, sign if piece.sign == "!" else f"{sign} "]
            case (first, second):
                left += [")", second, f" {sign} ", first, "("]
    return "".join(parts)


def _by_negation(term: Term) -> Term:
    """An implication or equivalence expressed by ``!``, ``&`` and ``|``."""
    match term:
        case Term("->", (left, right)):
            return Term("|", (_not(left), right))
        case Term("<->", (left, right)):
            there, back = Term("|", (_not(left), right)), Term("|", (left, _not(right)))
            return Term("&", (there, back))
    return term


def size_of(term: Term) -> int:
    """The greatest number of characters of the term's text, without writing it."""
    known: dict[int, int] = {}
    stack = [term]
    while stack:
        piece = stack[-1]
        missing = [inner for inner in piece.operands if id(inner) not in known]
        if missing:
            stack += missing
            continue
        stack.pop()
        known[id(piece)] = len(piece.sign) + 6 + sum(known[id(inner)] for inner in piece.operands)
    return known[id(term)]
