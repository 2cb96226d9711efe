"""Whether some state satisfies formulas together, by trying values (Davis, Putnam).

The truth of a formula about other moments, and sums of numbers, are taken to be anything. So if no
state is found, there is none; if one is found, there may be one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from math import floor

from rulec.logic import formula as ltl
from rulec.logic.linear_comparison import stands
from rulec.vocabulary import Enumeration, Vocabulary

_MOST_ATOMS = 100
_MOST_LOOKED_AT = 200_000
"""The most atoms in one question, and the most evaluations.

Larger questions are left to the compiler.
"""


@dataclass(frozen=True, slots=True)
class _Open:
    """The unknown value that decides: of an atom, a number, or a temporal part."""

    subject: object


def may_hold(formulas: Sequence[ltl.Formula], vocabulary: Vocabulary) -> bool:
    """False if no state satisfies all formulas; True also if this takes too long to decide."""
    atoms = [atom for formula in formulas for atom in ltl.atoms_of(formula)]
    if len(atoms) > _MOST_ATOMS:
        return True
    return _Search(formulas, _values(atoms, vocabulary), size=len(formulas) + len(atoms)).finds({})


@dataclass(slots=True)
class _Search:
    formulas: Sequence[ltl.Formula]
    values: Mapping[object, Sequence[object]]
    size: int
    left: int = field(default=_MOST_LOOKED_AT)

    def finds(self, known: Mapping[object, object]) -> bool:
        """Whether what is known of a state can be completed such that all formulas hold."""
        self.left -= self.size
        if self.left < 0:
            return True
        first: _Open | None = None
        for formula in self.formulas:
            value = _truth(formula, known)
            if value is False:
                return False
            if isinstance(value, _Open) and first is None:
                first = value
        if first is None:
            return True
        values = self.values.get(first.subject, (False, True))
        return any(self.finds({**known, first.subject: value}) for value in values)


def _truth(formula: ltl.Formula, known: Mapping[object, object]) -> bool | _Open:
    match formula:
        case ltl.Constant(value):
            return value
        case ltl.Atom():
            subject = ltl.subject_of(formula)
            known_value = known.get(subject)
            return _Open(subject) if known_value is None else known_value == (formula.value or True)
        case ltl.Comparison(terms, relation, limit):
            number = known.get(terms)
            return _Open(terms) if number is None else stands(number, relation, limit)  # type: ignore[arg-type]
        case ltl.Unary(ltl.UnaryOperator.NOT, operand):
            return _negated(_truth(operand, known))
        case ltl.Binary(operator, left, right) if operator in _OF_ONE_STATE:
            first, second = _truth(left, known), _truth(right, known)
            return _joined(operator, first, second)
    known_value = known.get(formula)
    return _Open(formula) if known_value is None else known_value is True


_OF_ONE_STATE = frozenset(
    (
        *(ltl.BinaryOperator.AND, ltl.BinaryOperator.OR, ltl.BinaryOperator.IMPLIES),
        *(ltl.BinaryOperator.IFF, ltl.BinaryOperator.XOR),
    )
)


def _negated(value: bool | _Open) -> bool | _Open:
    return value if isinstance(value, _Open) else not value


def _joined(
    operator: ltl.BinaryOperator, first: bool | _Open, second: bool | _Open
) -> bool | _Open:
    match operator:
        case ltl.BinaryOperator.IMPLIES:
            return _joined(ltl.BinaryOperator.OR, _negated(first), second)
        case ltl.BinaryOperator.AND | ltl.BinaryOperator.OR:
            settles = operator is ltl.BinaryOperator.OR
            if first is settles or second is settles:
                return settles
            return first if isinstance(first, _Open) else second
    if isinstance(first, _Open):
        return first
    if isinstance(second, _Open):
        return second
    return (first is second) is (operator is ltl.BinaryOperator.IFF)


def _values(
    atoms: Iterable[ltl.Proposition], vocabulary: Vocabulary
) -> dict[object, Sequence[object]]:
    """The values to try for everything in atoms, the most usual first."""
    limits: dict[tuple[tuple[Fraction, ltl.Term], ...], set[Fraction]] = {}
    values: dict[object, Sequence[object]] = {}
    for proposition in atoms:
        if isinstance(proposition, ltl.Comparison):
            limits.setdefault(proposition.terms, set()).add(proposition.limit)
            continue
        declaration = vocabulary.declarations[proposition.name]
        usual = declaration.default
        every = declaration.values if isinstance(declaration, Enumeration) else (False, True)
        values[ltl.subject_of(proposition)] = sorted(every, key=lambda value: value != usual)
    for terms, own in limits.items():
        is_count = len(terms) == 1 and isinstance(terms[0][1], ltl.Count)
        values[terms] = _whole(own) if is_count else _around(own)
    return values


def _around(limits: Iterable[Fraction]) -> list[Fraction]:
    """A number in each part of the number line between limits."""
    ascending = sorted(limits)
    between = [(low + high) / 2 for low, high in pairwise(ascending)]
    return [*ascending, *between, ascending[0] - 1, ascending[-1] + 1]


def _whole(limits: Iterable[Fraction]) -> list[Fraction]:
    """The same for numbers of objects."""
    near = {floor(limit) + more for limit in limits for more in (-1, 0, 1)}
    return [Fraction(number) for number in sorted({0, *near}) if number >= 0]
