"""Formulas as plain data for JSON, with numbers as text of fractions. For example, ``"5/18"``."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any, get_args

from rulec.logic import formula as ltl
from rulec.logic.bounds import BOOLEAN, DISTANCE
from rulec.logic.free_names import terms_of, variables_of
from rulec.resource_limits import MOST_DIGITS

DEEPEST = 250
"""The greatest nesting depth of formulas that are read; no rulebook nests deeper."""

_OPERATORS: dict[str, ltl.UnaryOperator | ltl.BinaryOperator] = {
    operator.value: operator
    for kind in (ltl.UnaryOperator, ltl.BinaryOperator)
    for operator in kind
}
_RELATIONS = {relation: relation for relation in get_args(ltl.Relation)}


def to_data(formula: ltl.Formula) -> Any:
    """A formula as data: Booleans for constants, lists for operations, objects otherwise.

    A list begins with its operator.

    The bound of an operator, if it has one, is the last item of its list.
    """
    match formula:
        case ltl.Atom(name, arguments, value):
            data = {"name": name, "variables": list(arguments), "value": value}
            if isinstance(formula, ltl.Calculated):
                data |= {"number": _number(formula.number), "relation": formula.relation}
            return data
        case ltl.Comparison(terms, relation, limit, text):
            kept = {"relation": relation, "limit": str(limit), "text": text}
            return {"terms": terms_to_data(terms), **kept}
        case ltl.Same(left, right):
            return {"same": [left, right]}
        case ltl.Constant(value):
            return value
        case ltl.Unary(operator, operand, bound):
            return [operator.value, to_data(operand), *_bound(bound)]
        case ltl.Binary(operator, left, right, bound):
            return [operator.value, to_data(left), to_data(right), *_bound(bound)]


def terms_to_data(terms: tuple[tuple[Fraction, ltl.Term], ...]) -> list[list[Any]]:
    """The terms of a comparison as pairs of a coefficient and a term."""
    return [[str(coefficient), _term(term)] for coefficient, term in terms]


def _term(term: ltl.Term) -> dict[str, Any]:
    match term:
        case ltl.QuantityTerm(name, arguments):
            return {"quantity": name, "variables": list(arguments)}
        case ltl.Count(variable, type_name, body):
            return {"count": variable, "type": type_name, "body": to_data(body)}


def _number(number: ltl.NumberSum) -> list[Any]:
    """The constant of a number, then pairs of a coefficient and a part."""
    return [str(number.constant), *([str(own), _part(part)] for own, part in number.parts)]


def _part(part: ltl.Term | ltl.Operation) -> Any:
    if isinstance(part, ltl.Operation):
        return [part.operator, _number(part.left), _number(part.right)]
    return _term(part)


def _bound(bound: ltl.Bound | None) -> list[dict[str, str | None]]:
    if bound is None:
        return []
    high = None if bound.high is None else str(bound.high)
    return [{"from": str(bound.low), "to": high, "unit": bound.unit}]


def from_data(data: Any, depth: int = 0) -> ltl.Formula:
    """The formula that ``to_data`` converted to this data. Raises ValueError if there is none."""
    if depth > DEEPEST:
        raise ValueError("a formula is nested too deep")
    match data:
        case bool():
            return ltl.Constant(data)
        case {"name": str(name), "variables": variables, "value": None | str() as value} if (
            len(data) == 3
        ):
            return ltl.Atom(name, _names(variables), value)
        case {"name": str(name), "variables": variables, "value": None, "number": number} if (
            len(data) == 5 and data.get("relation") in _RELATIONS
        ):
            own = _read_number(number, depth + 1)
            return _calculation(name, _names(variables), own, _RELATIONS[data["relation"]])
        case {"terms": terms, "relation": str(relation), "limit": limit, "text": str(text)} if (
            len(data) == 4 and relation in _RELATIONS
        ):
            read = terms_from_data(terms, depth + 1)
            return ltl.Comparison(read, _RELATIONS[relation], number_from_data(limit), text)
        case {"same": [str(left), str(right)]} if len(data) == 1:
            return ltl.Same(left, right)
        case [str(operator), *rest] if operator in _OPERATORS:
            return _operation(_OPERATORS[operator], rest, depth + 1)
    raise ValueError("a formula is neither an atom, a comparison, a constant nor an operation")


def _calculation(
    name: str, arguments: tuple[str, ...], number: ltl.NumberSum, relation: ltl.Relation
) -> ltl.Calculated:
    places = {f"x{place}" for place in range(1, len(arguments) + 1)}
    if {x for term in terms_of(number) for x in variables_of(term)} != places or " " not in name:
        raise ValueError("a calculated number is about other objects than its comparison")
    return ltl.Calculated(name, arguments, number=number, relation=relation)


def _read_number(data: Any, depth: int) -> ltl.NumberSum:
    if depth > DEEPEST or not isinstance(data, list) or not data:
        raise ValueError("a number is none, or nested too deep")
    constant, *parts = data
    read: list[tuple[Fraction, ltl.Term | ltl.Operation]] = []
    for part in parts:
        match part:
            case [coefficient, ["*" | "/" as operator, left, right]]:
                sides = (_read_number(side, depth + 1) for side in (left, right))
                read.append((number_from_data(coefficient), ltl.Operation(operator, *sides)))
            case _:
                read += terms_from_data([part], depth + 1)
    return ltl.NumberSum(tuple(read), number_from_data(constant))


def _operation(
    operator: ltl.UnaryOperator | ltl.BinaryOperator, rest: list[Any], depth: int
) -> ltl.Unary | ltl.Binary:
    n_operands = 1 if isinstance(operator, ltl.UnaryOperator) else 2
    bound = None
    if len(rest) == n_operands + 1:
        bound = _read_bound(operator, rest.pop())
    if len(rest) != n_operands:
        raise ValueError(f"`{operator.value}` has a wrong number of operands")
    if isinstance(operator, ltl.UnaryOperator):
        return ltl.Unary(operator, from_data(rest[0], depth), bound)
    return ltl.Binary(operator, from_data(rest[0], depth), from_data(rest[1], depth), bound)


def _read_bound(operator: ltl.UnaryOperator | ltl.BinaryOperator, data: Any) -> ltl.Bound:
    match data:
        case {"from": low_text, "to": high_text, "unit": "s" | "steps" as unit} if len(data) == 3:
            low = number_from_data(low_text)
            high = None if high_text is None else number_from_data(high_text)
            fits = low >= 0 and (high is None or low <= high)
            if operator in DISTANCE:
                fits = fits and low == high
            if unit == "steps":
                fits = fits and low.denominator == 1 and (high is None or high.denominator == 1)
            if fits and operator not in BOOLEAN:
                return ltl.Bound(low, high, unit)
    raise ValueError(f"`{operator.value}` has a bound that is none")


def terms_from_data(data: Any, depth: int = 0) -> tuple[tuple[Fraction, ltl.Term], ...]:
    """The terms that ``terms_to_data`` converted to this data. ValueError if there are none."""
    if not isinstance(data, list):
        raise ValueError("the terms of a comparison are no list")
    read = []
    for term in data:  # no comprehension, which would add a frame to each level of nesting
        read.append(_read_term(term, depth))  # noqa: PERF401
    return tuple(read)


def _read_term(data: Any, depth: int) -> tuple[Fraction, ltl.Term]:
    match data:
        case [coefficient, {"quantity": str(name), "variables": variables} as term] if (
            len(term) == 2
        ):
            return number_from_data(coefficient), ltl.QuantityTerm(name, _names(variables))
        case [
            coefficient,
            {"count": str(variable), "type": str(type_name), "body": body} as term,
        ] if len(term) == 3:
            return number_from_data(coefficient), ltl.Count(
                variable, type_name, from_data(body, depth + 1)
            )
    raise ValueError("a term of a comparison is neither a quantity nor a count")


def _names(data: Any) -> tuple[str, ...]:
    if isinstance(data, list) and all(isinstance(name, str) for name in data):
        return tuple(data)
    raise ValueError("a list of variables is none")


def number_from_data(data: Any) -> Fraction:
    """The fraction that a text represents. Raises ValueError if it is not in lowest terms."""
    if isinstance(data, str) and len(data) <= MOST_DIGITS and _FRACTION.fullmatch(data):
        number = Fraction(data)
        if str(number) == data:
            return number
    raise ValueError("a number is no fraction in lowest terms")


_FRACTION = re.compile(r"-?[0-9]+(?:/[0-9]*[1-9][0-9]*)?")
