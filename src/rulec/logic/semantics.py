"""The meaning of a formula on a word, directly from the definitions.

The definitions are those of Esterle, Aravantinos, Knoll (2019), section IV-A, with the standard
until, as in that paper's tables I and II. A finite word stands for the infinite one that repeats
its last letter for ever (the paper's reading, ``stutter``) or for itself alone (``finite``: De
Giacomo, Vardi, "Linear temporal logic and linear dynamic logic on finite traces", 2013). The past
begins with the word: past operators look back from an instant to the first one, as in Lichtenstein,
Pnueli, Zuck, "The glory of the past" (1985). Bounds count instants, as in Koymans, "Specifying
real-time properties with metric temporal logic" (1990), on a clock that ticks with the trace.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence, Set
from dataclasses import dataclass
from typing import Literal

from rulec.logic import formula as ltl
from rulec.logic.bounds import PAST, Range, range_of

Semantics = Literal["stutter", "finite"]
"""How a word ends: its last letter is repeated for ever, or nothing follows it."""

Letter = Set[ltl.Proposition]
"""The atoms and comparisons that are true at one instant; all others are false."""


def holds(formula: ltl.Formula, word: Sequence[Letter], semantics: Semantics = "stutter") -> bool:
    """Whether ``formula`` holds for ``word`` at its first instant.

    Its bounds are in steps. Raises ValueError for an empty word or a bound in seconds.
    """
    return truth_values(formula, word, semantics)[0]


def truth_values(
    formula: ltl.Formula, word: Sequence[Letter], semantics: Semantics = "stutter"
) -> list[bool]:
    """The formula's truth value at each instant of a word. Raises ValueError as ``holds`` does."""
    if not word:
        raise ValueError("an empty word has no last letter")
    ends = semantics == "finite"
    settling = 0 if ends else steps_to_settle(formula)
    return _evaluate(formula, _Word(_spelled(word), len(word), settling, ends), {})[: len(word)]


_Truths = Callable[[ltl.Proposition], Sequence[bool]]
"""A proposition's truth value at each of a word's instants."""


def _spelled(word: Sequence[Letter]) -> _Truths:
    letters = {id(letter): letter for letter in word}

    def truths(proposition: ltl.Proposition) -> list[bool]:
        true = {key: proposition in letter for key, letter in letters.items()}
        return [true[id(letter)] for letter in word]

    return truths


_Parts = dict[int, tuple[ltl.Formula, list[bool]]]
"""Parts and their values by identity: hashing a formula takes longer than evaluating it."""


@dataclass(frozen=True, slots=True)
class _Word:
    """A word, with its last letter repeated ``n_settling`` times while values settle."""

    truths: _Truths
    n_letters: int
    n_settling: int
    ends: bool


def steps_to_settle(formula: ltl.Formula) -> int:
    """An upper bound on the steps until values settle under a repeated last letter.

    Only past operators delay changes: once their operands are constant from some instant on, their
    value is constant as soon as their range covers only such instants or, if the range is
    unbounded, as soon as it reaches them. Future operators are constant where their operands are.
    """
    match formula:
        case ltl.Unary(operator, operand):
            carried = _carried(range_of(formula)) if operator in PAST else 0
            return carried + steps_to_settle(operand)
        case ltl.Binary(operator, left, right):
            carried = _carried(range_of(formula)) if operator in PAST else 0
            return carried + max(steps_to_settle(left), steps_to_settle(right))
        case ltl.Atom() | ltl.Comparison() | ltl.Constant() | ltl.Same():
            return 0


def _carried(span: Range) -> int:
    return span.low if span.high is None else span.high


def _evaluate(formula: ltl.Formula, word: _Word, parts: _Parts) -> list[bool]:
    """The truth values of a formula on a word that ends or repeats its last letter.

    In the second case the values at the last instant are repeated for ever.
    """
    if id(formula) in parts:
        return parts[id(formula)][1]
    match formula:
        case ltl.Atom() | ltl.Comparison():
            own = word.truths(formula)
            values = [*own, *[own[-1]] * word.n_settling]
        case ltl.Same():
            raise ValueError(f"`{formula}` is asked of counted objects, not of a word")
        case ltl.Constant(value):
            values = [value] * (word.n_letters + word.n_settling)
        case ltl.Unary(operator, operand):
            inner = _evaluate(operand, word, parts)
            values = _unary(operator, inner, range_of(formula), word.ends)
        case ltl.Binary(operator, left, right):
            first = _evaluate(left, word, parts)
            second = _evaluate(right, word, parts)
            values = _binary(operator, first, second, range_of(formula), word.ends)
    parts[id(formula)] = formula, values
    return values


def _unary(operator: ltl.UnaryOperator, values: list[bool], span: Range, ends: bool) -> list[bool]:
    true = [True] * len(values)
    match operator:
        case ltl.UnaryOperator.NOT:
            return _not(values)
        case ltl.UnaryOperator.NEXT | ltl.UnaryOperator.EVENTUALLY:
            return _until(true, values, span, ends)
        case ltl.UnaryOperator.WEAK_NEXT | ltl.UnaryOperator.ALWAYS:
            return _not(_until(true, _not(values), span, ends))
        case ltl.UnaryOperator.NEVER:
            return _not(_until(true, values, span, ends))
        case ltl.UnaryOperator.PREVIOUSLY | ltl.UnaryOperator.ONCE:
            return _since(true, values, span)
        case ltl.UnaryOperator.WEAK_PREVIOUSLY | ltl.UnaryOperator.HISTORICALLY:
            return _not(_since(true, _not(values), span))


def _binary(
    operator: ltl.BinaryOperator, left: list[bool], right: list[bool], span: Range, ends: bool
) -> list[bool]:
    pairs = zip(left, right, strict=True)
    match operator:
        case ltl.BinaryOperator.AND:
            return [a and b for a, b in pairs]
        case ltl.BinaryOperator.OR:
            return [a or b for a, b in pairs]
        case ltl.BinaryOperator.IMPLIES:
            return [not a or b for a, b in pairs]
        case ltl.BinaryOperator.IFF:
            return [a == b for a, b in pairs]
        case ltl.BinaryOperator.XOR:
            return [a != b for a, b in pairs]
        case ltl.BinaryOperator.UNTIL | ltl.BinaryOperator.THEN:
            return _until(left, right, span, ends)
        case ltl.BinaryOperator.WEAK_UNTIL:
            return _weak_until(left, right, span, ends)
        case ltl.BinaryOperator.RELEASE:
            return _not(_until(_not(left), _not(right), span, ends))
        case ltl.BinaryOperator.STRONG_RELEASE:
            return _not(_weak_until(_not(left), _not(right), span, ends))
        case ltl.BinaryOperator.SINCE:
            return _since(left, right, span)


def _not(values: list[bool]) -> list[bool]:
    return [not value for value in values]


def _weak_until(left: list[bool], right: list[bool], span: Range, ends: bool) -> list[bool]:
    """Until, or ``left`` from here to the range's end."""
    breaks = _until([True] * len(left), _not(left), Range(0, span.high), ends)
    until = _until(left, right, span, ends)
    return [a or not b for a, b in zip(until, breaks, strict=True)]


def _until(left: list[bool], right: list[bool], span: Range, ends: bool) -> list[bool]:
    """The values of until: ``right`` within range, ``left`` before it.

    ``left`` holds at all instants from the present one until before that of ``right``.
    """
    if not span.low and span.high is None:
        return _until_at_all(left, right)
    last = len(right) - 1
    first_right: list[int | None] = [None] * (last + 2)
    """The first instant from here on with ``right``."""
    first_break: list[int | None] = [None] * (last + 2)
    """The first instant from here on without ``left``."""
    for instant in range(last, -1, -1):
        first_right[instant] = instant if right[instant] else first_right[instant + 1]
        first_break[instant] = first_break[instant + 1] if left[instant] else instant
    values = []
    for instant in range(last + 1):
        earliest = instant + span.low
        if earliest > last and not ends:
            # Any such instant is like the last one.
            result = earliest if right[last] else None
        else:
            result = first_right[min(earliest, last + 1)]
        within = result is not None and (span.high is None or result <= instant + span.high)
        broken = first_break[instant]
        values.append(within and (broken is None or result is None or broken >= result))
    return values


def _until_at_all(left: Sequence[bool], right: Sequence[bool]) -> list[bool]:
    """The values of unbounded until, computed backward: each follows from the next instant's."""
    values, after = [], False
    for a, b in zip(reversed(left), reversed(right), strict=True):
        after = b or (a and after)
        values.append(after)
    values.reverse()
    return values


def _since(left: list[bool], right: list[bool], span: Range) -> list[bool]:
    """The values of since: ``right`` within range back, ``left`` after it.

    ``left`` holds at all instants after that of ``right`` up to the present one.
    """
    values = []
    latest: list[int | None] = []
    """For each instant, the latest one up to it with ``right``."""
    broken = -1
    """The latest instant without ``left``."""
    for instant, (a, b) in enumerate(zip(left, right, strict=True)):
        latest.append(instant if b else latest[-1] if latest else None)
        broken = broken if a else instant
        result = latest[instant - span.low] if instant >= span.low else None
        within = result is not None and (span.high is None or result >= instant - span.high)
        values.append(within and result is not None and broken <= result)
    return values
