"""The syntax tree as text again: fewest parentheses, one form for everything.

Reading what is printed gives the same tree back. Comments are not part of the tree.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from rulec.syntax import tree
from rulec.syntax.keywords import (
    PRECEDENCE,
    RIGHT_ASSOCIATIVE,
    SYMBOLS,
    UNARY_PRECEDENCE,
)

Style = Literal["words", "symbols"]


def print_formula(node: tree.Formula, style: Style = "words") -> str:
    """A formula on one line, its operators in words or in symbols, where it has one."""
    match node:
        case tree.AtomUse():
            return _atom(node)
        case tree.Truth(value):
            return "true" if value else "false"
        case tree.Prefix(operator, operand):
            inside = print_formula(operand, style)
            if isinstance(operand, tree.Infix):
                inside = f"({inside})"
            sign = operator if style == "words" else SYMBOLS[operator]
            return f"{sign}{'' if sign == '!' else ' '}{inside}"
        case tree.Infix(operator, left, right):
            mine = PRECEDENCE[operator]
            to_right = operator in RIGHT_ASSOCIATIVE
            sides = (
                _operand(left, mine + 1 if to_right else mine, style),
                _operand(right, mine if to_right else mine + 1, style),
            )
            return f" {operator if style == 'words' else SYMBOLS[operator]} ".join(sides)


def _operand(node: tree.Formula, least: int, style: Style) -> str:
    """In parentheses if it binds less tightly than ``least``."""
    text = print_formula(node, style)
    mine = PRECEDENCE[node.operator] if isinstance(node, tree.Infix) else UNARY_PRECEDENCE
    return text if mine >= least else f"({text})"


def _atom(atom: tree.AtomUse) -> str:
    return atom.name.text + (f"({_comma(atom.arguments)})" if atom.arguments else "")


def _comma(names: Iterable[tree.Name]) -> str:
    return ", ".join(name.text for name in names)


def print_file(file: tree.File, style: Style = "words") -> str:
    """A whole file; a rule's clauses come in the order cite, says, require, examples.

    Raises:
        ValueError: the tree has an item that could not be read.
    """
    if file.name is None:
        raise ValueError("the tree lacks the file's name")
    items = [_item(item, style) for item in file.items]
    if file.kind == "vocabulary":
        body = "".join(f"  {item}\n" for item in items)
        return f"vocabulary {file.name.text} {{\n{body}}}\n"
    lines = [f"rulebook {file.name.text}"]
    if file.title is not None:
        lines.append(f"title {_text(file.title.text)}")
    if file.law is not None:
        as_of = f" as of {file.law.as_of}" if file.law.as_of else ""
        lines.append(f"law {_text(file.law.text)}{as_of}")
    lines += [f"use {use.name.text}" for use in file.uses]
    for item, text in zip(file.items, items, strict=True):
        lines.append(f"\n{text}" if isinstance(item, tree.RuleItem) else text)
    return "\n".join(lines) + "\n"


def _item(item: tree.Declaration | tree.RuleItem | tree.BrokenItem, style: Style) -> str:
    match item:
        case tree.TypeItem(name, parent):
            return f"type {name.text}" + (f" is {parent.text}" if parent else "")
        case tree.EnumerationItem(name, parameters, values, chosen):
            default = f" default {chosen.text}" if chosen else ""
            head = name.text + _parameters(parameters)
            return f"{head} is one of {_comma(values)}{default}"
        case tree.SignalItem(signals, truth):
            default = "" if truth is None else f" default {str(truth).lower()}"
            heads = (head.name.text + _parameters(head.parameters) for head in signals)
            return f"signal {', '.join(heads)}{default}"
        case tree.QuantityItem(name, parameters, unit, number):
            default = "" if number is None else f" default {repr(number).removesuffix('.0')}"
            return f"quantity {name.text}{_parameters(parameters)} in {unit}{default}"
        case tree.RuleItem():
            return _rule(item, style)
        case tree.BrokenItem():
            raise ValueError("an item that could not be read cannot be printed")


def _rule(rule: tree.RuleItem, style: Style) -> str:
    if rule.require is None:
        raise ValueError(f"rule {rule.name.text} has no formula")
    variables = f" {_parameters(rule.variables)}" if rule.variables else ""
    lines = [f"{rule.strength} rule {rule.name.text}{variables} {{"]
    if rule.cite is not None:
        lines.append(f"  cite {_text(rule.cite)}")
    if rule.says is not None:
        lines.append(f"  says {_text(rule.says)}")
    lines.append(f"  require {print_formula(rule.require, style)}")
    lines += [f"  {_example(example, style)}" for example in rule.examples]
    return "\n".join([*lines, "}"])


def _example(example: tree.Example, style: Style) -> str:
    word = "accept" if example.accepts else "reject"
    label = f" {_quoted(example.label)}" if example.label else ""
    states = "; ".join(_state(state, style) for state in example.states)
    return f"{word}{label} {{ {states} }}"


def _state(state: tree.ExampleState, style: Style) -> str:
    join, deny = (" and ", "not ") if style == "words" else (" & ", "!")
    facts = ((deny if one.negated else "") + _atom(one.atom) for one in state.literals)
    return join.join(facts)


def _parameters(parameters: tuple[tree.Parameter, ...]) -> str:
    if not parameters:
        return ""
    parts = (
        one.name.text + (f": {one.type.text}" if one.type is not None else "") for one in parameters
    )
    return f"({', '.join(parts)})"


def _text(text: tree.Text) -> str:
    return _quoted(text.value)


def _quoted(value: str) -> str:
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
