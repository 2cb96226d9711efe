"""The meaning of a formula on a word, straight from the definitions.

Definitions: Esterle, Aravantinos, Knoll (2019), section IV-A, with the standard until, as the
paper's own tables I and II have it. A finite word stands for the infinite one that repeats its last
letter for ever (the paper's reading, ``stutter``).
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
    if not word:
        raise ValueError("an empty word has no last letter to repeat")
    match formula:
        case Atom():
            return [formula in letter for letter in word]
        case Constant(value):
            return [value] * len(word)
        case Unary(operator, operand):
            return _unary(operator, truth_values(operand, word))
        case Binary(operator, left, right):
            return _binary(operator, truth_values(left, word), truth_values(right, word))


def _unary(operator: UnaryOperator, values: list[bool]) -> list[bool]:
    match operator:
        case UnaryOperator.NOT:
            return [not value for value in values]
        case UnaryOperator.NEXT | UnaryOperator.WEAK_NEXT:
            # The last letter is its own successor; so there always is a next instant.
            return values[1:] + values[-1:]
        case UnaryOperator.EVENTUALLY:
            return _until([True] * len(values), values)
        case UnaryOperator.ALWAYS:
            return [not value for value in _until([True] * len(values), [not v for v in values])]


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


def _until(left: list[bool], right: list[bool]) -> list[bool]:
    """Some later instant has ``right``, and every instant before it from here on has ``left``."""
    values = list(right)
    for instant in range(len(values) - 2, -1, -1):
        values[instant] = right[instant] or (left[instant] and values[instant + 1])
    return values
