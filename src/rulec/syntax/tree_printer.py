"""Prints formulas and clauses such that reading them gives the same tree."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from rulec.syntax import keywords, tree

Style = Literal["words", "symbols", "written"]
"""How operators are spelled; ``written`` means as in the file, including parentheses."""

_INFINITE = 99


def print_formula(node: tree.Formula, style: Style = "words") -> str:
    """A formula or an expression on one line."""
    match node:
        case tree.AtomUse():
            return print_atom(node)
        case tree.TruthLiteral(value):
            return "true" if value else "false"
        case tree.NumberLiteral(text, unit):
            return f"{text} {unit}" if unit else text
        case tree.Prefix(operator, operand, bound):
            sign = _sign(operator, node.sign, style)
            inside = _operand(operand, keywords.UNARY_PRECEDENCE, style)
            return f"{sign}{_bound(bound)}{'' if sign == '!' else ' '}{inside}"
        case tree.Infix(operator, left, right, bound):
            mine = keywords.PRECEDENCE[operator]
            to_right = operator in keywords.RIGHT_ASSOCIATIVE
            first = _operand(left, mine + 1 if to_right else mine, style)
            second = _operand(right, mine if to_right else mine + 1, style)
            return f"{first} {_sign(operator, node.sign, style)}{_bound(bound)} {second}"
        case tree.Compare(relation, left, right):
            beside = keywords.COMPARISON_PRECEDENCE + 1
            return f"{_operand(left, beside, style)} {relation} {_operand(right, beside, style)}"
        case tree.Arithmetic(operator, left, right):
            mine = keywords.ARITHMETIC_PRECEDENCE[operator]
            return f"{_operand(left, mine, style)} {operator} {_operand(right, mine + 1, style)}"
        case tree.Minus(operand):
            return f"-{_operand(operand, keywords.MINUS_PRECEDENCE, style)}"
        case tree.Conditional(value, condition, otherwise):
            parts = (_operand(value, 1, style), _operand(condition, 1, style))
            return f"{parts[0]} if {parts[1]} else {_operand(otherwise, 0, style)}"
        case tree.Aggregate(kind, variable, body):
            return f"{kind} {print_parameter(variable)} ({print_whole(body, style)})"


def print_whole(node: tree.Formula, style: Style = "words") -> str:
    """The text of a formula, with parentheses around a bare conditional."""
    text = print_formula(node, style)
    return f"({text})" if isinstance(node, tree.Conditional) else text


def _precedence(node: tree.Formula) -> int:
    """The node's precedence; a larger number binds tighter."""
    match node:
        case tree.Conditional():
            return 0
        case tree.Infix():
            return keywords.PRECEDENCE[node.operator]
        case tree.Prefix():
            return keywords.UNARY_PRECEDENCE
        case tree.Compare():
            return keywords.COMPARISON_PRECEDENCE
        case tree.Arithmetic():
            return keywords.ARITHMETIC_PRECEDENCE[node.operator]
        case tree.Minus():
            return keywords.MINUS_PRECEDENCE
        case _:
            return _INFINITE


def _operand(node: tree.Formula, least: int, style: Style) -> str:
    """The text, in parentheses if it binds less tightly than ``least`` or has them in the file."""
    written = style == "written" and isinstance(node, tree.Grouping) and node.grouped
    text = print_formula(node, style)
    return f"({text})" if written or _precedence(node) < least else text


def _sign(operator: str, sign: str, style: Style) -> str:
    if style == "written" and sign:
        # `weak   next` is one sign.
        return " ".join(sign.split())
    return keywords.SYMBOLS[operator] if style == "symbols" else operator


def _bound(bound: tree.BoundNode | None) -> str:
    if bound is None:
        return ""
    ends = [print_formula(end) for end in (bound.low, bound.high) if end is not None]
    if len(ends) == 1:
        return f"[{'<=' if bound.low is None else '>='} {ends[0]}]"
    return f"[{ends[0] if bound.exact else ' .. '.join(ends)}]"


def print_atom(atom: tree.AtomUse) -> str:
    """An atom with its arguments."""
    return atom.name.text + (f"({comma(atom.arguments)})" if atom.arguments else "")


def comma(names: Iterable[tree.Name]) -> str:
    """Names with commas between them."""
    return ", ".join(name.text for name in names)


def print_parameters(parameters: tuple[tree.Parameter, ...]) -> str:
    """Text of a parameter list with its parentheses; empty if none."""
    return f"({', '.join(map(print_parameter, parameters))})" if parameters else ""


def print_parameter(parameter: tree.Parameter) -> str:
    """``name`` or ``name: type``."""
    return parameter.name.text + (f": {parameter.type.text}" if parameter.type is not None else "")


def quoted(value: str) -> str:
    """A text's value in quotes, escaped."""
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def print_in_force(dates: tree.InForce) -> str:
    """``in force from DATE until DATE``."""
    since = f" from {dates.since}" if dates.since else ""
    until = f" until {dates.until}" if dates.until else ""
    return f"in force{since}{until}"


def clauses_of(rule: tree.RuleItem, style: Style = "words") -> list[tuple[str, str]]:
    """Words and texts of a rule's clauses, without examples, in order."""
    unless = (
        (
            "also unless" if clause.also else "unless",
            print_whole(clause.formula, style) + (f" {clause.scope}" if clause.scope else ""),
        )
        for clause in rule.unless
    )
    clauses = [
        ("cite", rule.cite and quoted(rule.cite.value)),
        ("source", rule.source and quoted(rule.source.value)),
        ("certainty", rule.certainty),
        ("says", rule.says and quoted(rule.says.value)),
        ("topic", comma(rule.topics)),
        ("in", rule.in_force and print_in_force(rule.in_force).removeprefix("in ")),
        ("when", rule.when and print_whole(rule.when, style)),
        ("require", rule.require and print_whole(rule.require, style)),
        *unless,
    ]
    return [(word, text) for word, text in clauses if text]
