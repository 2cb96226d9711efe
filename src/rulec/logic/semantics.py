"""The meaning of a formula on a word, straight from the definitions.

Definitions: Esterle, Aravantinos, Knoll (2019), section IV-A, with the standard until, as the
paper's own tables I and II have it. A finite word stands for the infinite one that repeats its last
letter for ever (the paper's reading, ``stutter``). The past begins with the word: operators of the
past look back from an instant to the first one, as in Lichtenstein, Pnueli, Zuck, "The glory of the
past" (1985).
"""

from __future__ import annotations

from collections.abc import Sequence, Set

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Constant,
    Formula,
    Unary,
    UnaryOperator,
)

Letter = Set[Atom]
"""The atoms that are true at one instant; every other atom is false."""


def holds(formula: Formula, word: Sequence[Letter]) -> bool:
    """Does ``formula`` hold for ``word`` at its first instant? ValueError for an empty word."""
    return truth_values(formula, word)[0]


def truth_values(formula: Formula, word: Sequence[Letter]) -> list[bool]:
    """The formula's truth value at each of the word's instants. ValueError for an empty word."""
    return values_of_parts(formula, word)[formula]


def values_of_parts(formula: Formula, word: Sequence[Letter]) -> dict[Formula, list[bool]]:
    """The same for the formula and every part of it. ValueError for an empty word."""
    if not word:
        raise ValueError("an empty word has no last letter to repeat")
    settling = [word[-1]] * _steps_to_settle(formula)
    known: dict[Formula, list[bool]] = {}
    _evaluate(formula, [*word, *settling], known)
    return {part: values[: len(word)] for part, values in known.items()}


def _steps_to_settle(formula: Formula) -> int:
    """For how long may values still change, at most, while the last letter is repeated?

    Only ``previously`` carries a change on to the next instant: where its operand is the same for
    ever from some instant on, it is so from one instant later. All other operators are the same for
    ever as soon as their operands are.
    """
    match formula:
        case Unary(operator, operand):
            carries = operator in (UnaryOperator.PREVIOUSLY, UnaryOperator.WEAK_PREVIOUSLY)
            return carries + _steps_to_settle(operand)
        case Binary(_, left, right):
            return max(_steps_to_settle(left), _steps_to_settle(right))
        case Atom() | Constant():
            return 0


def _evaluate(
    formula: Formula, word: Sequence[Letter], known: dict[Formula, list[bool]]
) -> list[bool]:
    """Truth values on a word from whose last instant on they are the same for ever."""
    if formula not in known:
        match formula:
            case Atom():
                values = [formula in letter for letter in word]
            case Constant(value):
                values = [value] * len(word)
            case Unary(operator, operand):
                values = _unary(operator, _evaluate(operand, word, known))
            case Binary(operator, left, right):
                first, second = _evaluate(left, word, known), _evaluate(right, word, known)
                values = _binary(operator, first, second)
        known[formula] = values
    return known[formula]


def _unary(operator: UnaryOperator, values: list[bool]) -> list[bool]:
    match operator:
        case UnaryOperator.NOT:
            return [not value for value in values]
        case UnaryOperator.NEXT | UnaryOperator.WEAK_NEXT:
            # The last instant is followed by its like; so there always is a next one.
            return values[1:] + values[-1:]
        case UnaryOperator.EVENTUALLY:
            return _until([True] * len(values), values)
        case UnaryOperator.ALWAYS:
            return [not value for value in _until([True] * len(values), [not v for v in values])]
        case UnaryOperator.NEVER:
            return [not value for value in _until([True] * len(values), values)]
        case UnaryOperator.PREVIOUSLY:
            return [False, *values[:-1]]
        case UnaryOperator.WEAK_PREVIOUSLY:
            return [True, *values[:-1]]
        case UnaryOperator.ONCE:
            return _since([True] * len(values), values)
        case UnaryOperator.HISTORICALLY:
            return [not value for value in _since([True] * len(values), [not v for v in values])]


def _binary(operator: BinaryOperator, left: list[bool], right: list[bool]) -> list[bool]:
    pairs = zip(left, right, strict=True)
    match operator:
        case BinaryOperator.AND:
            return [a and b for a, b in pairs]
        case BinaryOperator.OR:
            return [a or b for a, b in pairs]
        case BinaryOperator.IMPLIES:
            return [not a or b for a, b in pairs]
        case BinaryOperator.IFF:
            return [a == b for a, b in pairs]
        case BinaryOperator.XOR:
            return [a != b for a, b in pairs]
        case BinaryOperator.UNTIL:
            return _until(left, right)
        case BinaryOperator.WEAK_UNTIL:
            # a W b = not (not b U (not a and not b))
            neither = [not a and not b for a, b in pairs]
            return [not value for value in _until([not b for b in right], neither)]
        case BinaryOperator.RELEASE:
            # a R b = not (not a U not b)
            return [not v for v in _until([not a for a in left], [not b for b in right])]
        case BinaryOperator.STRONG_RELEASE:
            # a M b = b U (a and b)
            return _until(right, [a and b for a, b in pairs])
        case BinaryOperator.SINCE:
            return _since(left, right)
        case BinaryOperator.THEN:
            # a then b = a and next (a until b)
            later = _until(left, right)
            return [a and b for a, b in zip(left, later[1:] + later[-1:], strict=True)]


def _until(left: list[bool], right: list[bool]) -> list[bool]:
    """Some later instant has ``right``, and every instant before it from here on has ``left``."""
    values = list(right)
    for instant in range(len(values) - 2, -1, -1):
        values[instant] = right[instant] or (left[instant] and values[instant + 1])
    return values


def _since(left: list[bool], right: list[bool]) -> list[bool]:
    """Some instant up to here had ``right``, and every instant after it up to here ``left``."""
    values: list[bool] = []
    for a, b in zip(left, right, strict=True):
        values.append(b or (a and bool(values) and values[-1]))
    return values
