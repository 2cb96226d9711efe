"""The syntax tree as text again: fewest parentheses, one form for everything.

Reading what is printed gives the same tree back. Comments are not part of the tree.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from rulec.syntax import tree
from rulec.syntax.keywords import (
    ARITHMETIC_PRECEDENCE,
    COMPARISON_PRECEDENCE,
    MINUS_PRECEDENCE,
    PRECEDENCE,
    RIGHT_ASSOCIATIVE,
    SYMBOLS,
    UNARY_PRECEDENCE,
)

Style = Literal["words", "symbols", "written"]
"""How operators are spelled: ``written`` is as in the file, parentheses included."""

_INFINITE = 99


def print_formula(node: tree.Formula, style: Style = "words") -> str:
    """A formula or an expression on one line."""
    match node:
        case tree.AtomUse():
            return _atom(node)
        case tree.Truth(value):
            return "true" if value else "false"
        case tree.Number(text, unit):
            return f"{text} {unit}" if unit else text
        case tree.Prefix(operator, operand, bound):
            sign = _sign(operator, node.sign, style)
            inside = _operand(operand, UNARY_PRECEDENCE, style)
            return f"{sign}{_bound(bound)}{'' if sign == '!' else ' '}{inside}"
        case tree.Infix(operator, left, right, bound):
            mine = PRECEDENCE[operator]
            to_right = operator in RIGHT_ASSOCIATIVE
            first = _operand(left, mine + 1 if to_right else mine, style)
            second = _operand(right, mine if to_right else mine + 1, style)
            return f"{first} {_sign(operator, node.sign, style)}{_bound(bound)} {second}"
        case tree.Compare(relation, left, right):
            beside = COMPARISON_PRECEDENCE + 1
            return f"{_operand(left, beside, style)} {relation} {_operand(right, beside, style)}"
        case tree.Arithmetic(operator, left, right):
            mine = ARITHMETIC_PRECEDENCE[operator]
            return f"{_operand(left, mine, style)} {operator} {_operand(right, mine + 1, style)}"
        case tree.Minus(operand):
            return f"-{_operand(operand, MINUS_PRECEDENCE, style)}"
        case tree.Conditional(value, condition, otherwise):
            parts = (_operand(value, 1, style), _operand(condition, 1, style))
            return f"{parts[0]} if {parts[1]} else {_operand(otherwise, 0, style)}"
        case tree.Aggregate(kind, variable, body):
            return f"{kind} {_parameter(variable)} ({print_formula(body, style)})"


def precedence(node: tree.Formula) -> int:
    """How tightly the node's own operator binds; a larger number binds tighter."""
    match node:
        case tree.Conditional():
            return 0
        case tree.Infix():
            return PRECEDENCE[node.operator]
        case tree.Prefix():
            return UNARY_PRECEDENCE
        case tree.Compare():
            return COMPARISON_PRECEDENCE
        case tree.Arithmetic():
            return ARITHMETIC_PRECEDENCE[node.operator]
        case tree.Minus():
            return MINUS_PRECEDENCE
        case _:
            return _INFINITE


def needs_parentheses(node: tree.Formula, least: int, style: Style) -> bool:
    """Does it bind less tightly than ``least``, or does the file have parentheses there?"""
    written = style == "written" and getattr(node, "grouped", False)
    return written or precedence(node) < least


def _operand(node: tree.Formula, least: int, style: Style) -> str:
    text = print_formula(node, style)
    return f"({text})" if needs_parentheses(node, least, style) else text


def _sign(operator: str, sign: str, style: Style) -> str:
    if style == "written" and sign:
        # `weak   next` is one sign.
        return " ".join(sign.split())
    return SYMBOLS[operator] if style == "symbols" else operator


def _bound(bound: tree.Bound | None) -> str:
    match bound:
        case None:
            return ""
        case tree.Bound(low=None, high=high) if high is not None:
            return f"[<= {print_formula(high)}]"
        case tree.Bound(low=low, high=None) if low is not None:
            return f"[>= {print_formula(low)}]"
        case tree.Bound(low=low, high=high, exact=exact) if low is not None and high is not None:
            return f"[{print_formula(low)}{'' if exact else f' .. {print_formula(high)}'}]"
    raise ValueError("a bound has at least one side")


def _atom(atom: tree.AtomUse) -> str:
    return atom.name.text + (f"({_comma(atom.arguments)})" if atom.arguments else "")


def _comma(names: Iterable[tree.Name]) -> str:
    return ", ".join(name.text for name in names)


def print_file(file: tree.File, style: Style = "words") -> str:
    """A whole file, without its comments; a rule's clauses come in one order.

    Raises:
        ValueError: the tree has an item that could not be read.
    """
    if file.name is None:
        raise ValueError("the tree lacks the file's name")
    items = [print_item(item, style) for item in file.items]
    if file.kind == "vocabulary":
        body = "".join(f"  {item}\n" for item in items)
        return f"vocabulary {file.name.text} {{\n{body}}}\n"
    lines = [f"rulebook {file.name.text}", *(print_header_line(line) for line in header_of(file))]
    for item, text in zip(file.items, items, strict=True):
        lines.append(f"\n{text}" if isinstance(item, tree.RuleItem) else text)
    return "\n".join(lines) + "\n"


def header_of(file: tree.File) -> list[tree.HeaderLine]:
    """A rulebook's header lines in one order."""
    single = (file.title, file.law, file.extends, file.traffic)
    behind = (file.semantics, file.step, *file.priorities)
    return [line for line in (*single, *file.uses, *behind) if line is not None]


def print_header_line(line: tree.HeaderLine) -> str:
    """A header line."""
    match line:
        case tree.TitleLine(text):
            return f"title {_text(text)}"
        case tree.LawLine(text, as_of):
            return f"law {_text(text)}" + (f" as of {as_of}" if as_of else "")
        case tree.UseLine(name):
            return f"use {name.text}"
        case tree.ExtendsLine(name):
            return f"extends {name.text}"
        case tree.TrafficLine(side):
            return f"traffic {side}"
        case tree.SemanticsLine(kind):
            return f"semantics {kind}"
        case tree.StepLine(amount):
            return f"step {print_formula(amount)}"
        case tree.PriorityLine(levels, relations):
            first, *others = (level.text for level in levels)
            pairs = zip(relations, others, strict=True)
            return f"priority {first}" + "".join(f" {sign} {level}" for sign, level in pairs)


def print_item(item: tree.Item, style: Style = "words") -> str:
    """A declaration, a provision or a rule. ValueError for an item that could not be read."""
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
        case tree.FactItem(formula):
            return f"fact {print_formula(formula, style)}"
        case tree.RuleItem():
            return _rule(item, style)
        case tree.BrokenItem():
            raise ValueError("an item that could not be read cannot be printed")
        case _:
            return _provision(item, style)


def _provision(item: tree.Provision, style: Style) -> str:
    match item:
        case tree.OptionItem(name, value):
            return f"option {name.text} = {'on' if value else 'off'}"
        case tree.ParamItem(name, dimension, value, in_force):
            kind = f" : {dimension.text}" if dimension else ""
            return f"param {name.text}{kind} = {print_formula(value, style)}{_dates(in_force)}"
        case tree.SetItem(name, bool(value)):
            return f"set {name.text} = {'on' if value else 'off'}"
        case tree.SetItem(name, value, in_force):
            assert not isinstance(value, bool), "the case above"
            return f"set {name.text} = {print_formula(value, style)}{_dates(in_force)}"
        case tree.DefineItem(name, parameters, body, again):
            word = "redefine" if again else "define"
            head = name.text + _parameters(parameters)
            return f"{word} {head} = {print_formula(body, style)}"
        case tree.DropItem(name, because):
            return f"drop rule {name.text} because {_text(because)}"
        case tree.SoftenItem(name, level, weight, because):
            place = _place(level, weight)
            why = f" because {_text(because)}" if because else ""
            return f"soften rule {name.text}{place}{why}"
        case tree.SilentItem(name, because):
            return f"silent on {name.text} because {_text(because)}"


def _dates(in_force: tree.InForce | None) -> str:
    return f" {print_in_force(in_force)}" if in_force else ""


def print_in_force(dates: tree.InForce) -> str:
    """``in force from DATE until DATE``."""
    since = f" from {dates.since}" if dates.since else ""
    until = f" until {dates.until}" if dates.until else ""
    return f"in force{since}{until}"


def _place(level: tree.Name | None, weight: tree.Number | None) -> str:
    return (f" in {level.text}" if level else "") + (f" weight {weight.text}" if weight else "")


def print_rule_head(rule: tree.RuleItem) -> str:
    """A rule's head, without the brace."""
    words = [*(["override"] if rule.override else []), *([rule.strength] if rule.strength else [])]
    variables = f" {_parameters(rule.variables)}" if rule.variables else ""
    place = _place(rule.level, rule.weight)
    return f"{' '.join([*words, 'rule'])} {rule.name.text}{variables}{place}"


def clauses_of(rule: tree.RuleItem, style: Style = "words") -> list[tuple[str, str]]:
    """A rule's clauses but for its examples, in one order, as their words and what they say."""
    unless = (
        (print_formula(one.formula, style), f" {one.scope}" if one.scope else "")
        for one in rule.unless
    )
    said = [
        ("cite", rule.cite and _text(rule.cite)),
        ("source", rule.source and _text(rule.source)),
        ("certainty", rule.certainty),
        ("says", rule.says and _text(rule.says)),
        ("in", rule.in_force and print_in_force(rule.in_force).removeprefix("in ")),
        ("when", rule.when and print_formula(rule.when, style)),
        ("require", rule.require and print_formula(rule.require, style)),
        *(("unless", formula + scope) for formula, scope in unless),
    ]
    return [(word, text) for word, text in said if text]


def _rule(rule: tree.RuleItem, style: Style) -> str:
    if rule.require is None and not rule.override:
        raise ValueError(f"rule {rule.name.text} has no formula")
    lines = [f"{print_rule_head(rule)} {{"]
    lines += [f"  {word} {text}" for word, text in clauses_of(rule, style)]
    lines += [f"  {_example(example, style)}" for example in rule.examples]
    return "\n".join([*lines, "}"])


def _example(example: tree.Example, style: Style) -> str:
    states = "; ".join(print_state(state, style) for state in example.states)
    return f"{print_example_head(example)} {{ {states} }}"


def print_example_head(example: tree.Example) -> str:
    """``accept "label" (objects)``."""
    word = "accept" if example.accepts else "reject"
    label = f" {_quoted(example.label)}" if example.label else ""
    objects = f" {_parameters(example.objects)}" if example.objects else ""
    return f"{word}{label}{objects}"


def print_state(state: tree.ExampleState, style: Style = "words") -> str:
    """A state of an example."""
    join, deny = (" & ", "!") if style == "symbols" else (" and ", "not ")
    return join.join(
        (deny if one.negated else "")
        + _atom(one.atom)
        + (f" = {print_formula(one.value)}" if one.value else "")
        for one in state.literals
    )


def _parameters(parameters: tuple[tree.Parameter, ...]) -> str:
    if not parameters:
        return ""
    return f"({', '.join(map(_parameter, parameters))})"


def _parameter(one: tree.Parameter) -> str:
    return one.name.text + (f": {one.type.text}" if one.type is not None else "")


def _text(text: tree.Text) -> str:
    return _quoted(text.value)


def _quoted(value: str) -> str:
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
