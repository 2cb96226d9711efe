"""Formulas as text, in a rulebook's notation."""

from __future__ import annotations

from fractions import Fraction

from rulec.logic import formula as ltl
from rulec.logic.bounds import DISTANCE

_LOOSEST_FIRST = ("iff", "implies", "then", "xor", "or", "and")
"""As in the grammar; all other operators bind tighter, with equal precedence."""

_BINDING = dict.fromkeys(ltl.BinaryOperator, len(_LOOSEST_FIRST))
_BINDING |= {ltl.BinaryOperator(word): at for at, word in enumerate(_LOOSEST_FIRST)}


def formula_text(formula: ltl.Formula) -> str:
    """The formula in a rulebook's notation, with the fewest readable parentheses."""
    match formula:
        case ltl.Atom() | ltl.Comparison() | ltl.Same():
            # A comparison binds tighter than any operator on formulas.
            return str(formula)
        case ltl.Constant(value):
            return "true" if value else "false"
        case ltl.Unary(operator, operand, bound):
            inner = formula_text(operand)
            word = _operator(operator, bound)
            return f"{word} {f'({inner})' if isinstance(operand, ltl.Binary) else inner}"
        case ltl.Binary(operator, left, right, bound):
            # Nested as the parser nests it: chains of `and` and `or` to the left, phases to the
            # right.
            to_the_left = operator in (ltl.BinaryOperator.AND, ltl.BinaryOperator.OR)
            first = _side(operator, left, chain=to_the_left)
            second = _side(operator, right, chain=operator is ltl.BinaryOperator.THEN)
            return f"{first} {_operator(operator, bound)} {second}"


def _side(operator: ltl.BinaryOperator, formula: ltl.Formula, *, chain: bool) -> str:
    text = formula_text(formula)
    if not isinstance(formula, ltl.Binary):
        return text
    tighter = _BINDING[formula.operator] > _BINDING[operator]
    return text if tighter or (chain and formula.operator is operator) else f"({text})"


def _operator(operator: ltl.UnaryOperator | ltl.BinaryOperator, bound: ltl.Bound | None) -> str:
    if bound is None:
        return str(operator.value)
    if operator in DISTANCE:
        return f"{operator.value}[{time_in_words(bound.low, bound.unit)}]"
    return f"{operator.value}[{_span(bound)}]"


def _span(bound: ltl.Bound) -> str:
    low = time_in_words(bound.low, bound.unit)
    if bound.high is None:
        return f">= {low}"
    high = time_in_words(bound.high, bound.unit)
    return f"{low} .. {high}" if bound.low else f"<= {high}"


def time_in_words(amount: Fraction, unit: str) -> str:
    """``3 s``, ``0.5 s``, ``1 step``, ``2 steps``."""
    return f"{number_in_words(amount)} {'step' if unit == 'steps' and amount == 1 else unit}"


def number_in_words(number: Fraction) -> str:
    """A number as a decimal (which may be long), or else a fraction: ``0.5``, ``5/18``."""
    rest = number.denominator
    places = 0
    for prime in (2, 5):
        times = 0
        while rest % prime == 0:
            rest //= prime
            times += 1
        places = max(places, times)
    if rest != 1:
        return str(number)
    shifted = abs(number) * int(f"1{'0' * places}")
    digits = str(shifted.numerator).zfill(places + 1)
    if places:
        digits = f"{digits[:-places]}.{digits[-places:]}"
    return f"-{digits}" if number < 0 else digits


def term_text(term: ltl.Term | ltl.Operation) -> str:
    """``gap(v)``, ``count v: vehicle (behind(v))``: the text by which terms are sorted."""
    match term:
        case ltl.Operation(operator, left, right):
            return f"({sum_text(left)}) {operator} ({sum_text(right)})"
        case ltl.QuantityTerm(name, arguments):
            return f"{name}({', '.join(arguments)})" if arguments else name
        case ltl.Count(variable, type_name, body):
            return f"count {variable}: {type_name} ({formula_text(body)})"


def sum_text(number: ltl.NumberSum) -> str:
    """``5/18 * speed + 3``: a number with the units of its quantities as declared."""
    parts = [
        term_text(part) if factor == 1 else f"{number_in_words(factor)} * {term_text(part)}"
        for factor, part in number.parts
    ]
    if number.constant or not parts:
        parts.append(number_in_words(number.constant))
    return " + ".join(parts)
