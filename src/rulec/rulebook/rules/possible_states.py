"""Whether some state satisfies formulas together, by trying values (Davis, Putnam).

The truth of a formula about other moments, and sums of numbers, are taken to be anything. So if no
state is found, there is none; if one is found, there may be one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from itertools import pairwise
from math import floor
from typing import Any

from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold
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
        algebra = _algebra(known)
        for formula in self.formulas:
            value = fold(formula, algebra)
            if value is False:
                return False
            if isinstance(value, _Open) and first is None:
                first = value
        if first is None:
            return True
        values = self.values.get(first.subject, (False, True))
        return any(self.finds({**known, first.subject: value}) for value in values)


def _algebra(known: Mapping[object, object]) -> Algebra[bool | _Open]:
    """The truth of formulas in a state of which something is known, or what else decides it."""

    def proposition(asked: ltl.Proposition) -> bool | _Open:
        if isinstance(asked, ltl.Atom):
            subject = ltl.subject_of(asked)
            value = known.get(subject)
            return _Open(subject) if value is None else value == (asked.value or True)
        number: Any = known.get(asked.terms)
        return _Open(asked.terms) if number is None else stands(number, asked.relation, asked.limit)

    def anything(part: ltl.Formula, *_: object) -> bool | _Open:
        value = known.get(part)
        return _Open(part) if value is None else value is True

    return Algebra(
        proposition=proposition,
        constant=bool,
        negation=lambda value: value if isinstance(value, _Open) else not value,
        conjunction=partial(_joined, settles=False),
        disjunction=partial(_joined, settles=True),
        equivalence=_equivalence,
        identity=anything,
        operation=anything,
    )


def _joined(first: bool | _Open, second: bool | _Open, *, settles: bool) -> bool | _Open:
    if first is settles or second is settles:
        return settles
    return first if isinstance(first, _Open) else second


def _equivalence(first: bool | _Open, second: bool | _Open) -> bool | _Open:
    unknown = [value for value in (first, second) if isinstance(value, _Open)]
    return unknown[0] if unknown else first is second


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
        if isinstance(proposition, ltl.Calculated):
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
