"""Rules as text."""

from __future__ import annotations

from rulec.syntax import tree
from rulec.syntax.printer.formulas import (
    Style,
    print_atom,
    print_formula,
    print_parameters,
    print_text,
    print_whole,
    quoted,
)
from rulec.syntax.printer.items import print_in_force, print_place


def print_rule_head(rule: tree.RuleItem) -> str:
    """A rule's head, without the brace."""
    words = [*(["override"] if rule.override else []), *([rule.strength] if rule.strength else [])]
    variables = f" {print_parameters(rule.variables)}" if rule.variables else ""
    place = print_place(rule.level, rule.weight)
    return f"{' '.join([*words, 'rule'])} {rule.name.text}{variables}{place}"


def clauses_of(rule: tree.RuleItem, style: Style = "words") -> list[tuple[str, str]]:
    """A rule's clauses but for its examples, in one order, as their words and what they say."""
    unless = (
        (print_whole(one.formula, style), f" {one.scope}" if one.scope else "")
        for one in rule.unless
    )
    said = [
        ("cite", rule.cite and print_text(rule.cite)),
        ("source", rule.source and print_text(rule.source)),
        ("certainty", rule.certainty),
        ("says", rule.says and print_text(rule.says)),
        ("in", rule.in_force and print_in_force(rule.in_force).removeprefix("in ")),
        ("when", rule.when and print_whole(rule.when, style)),
        ("require", rule.require and print_whole(rule.require, style)),
        *(("unless", formula + scope) for formula, scope in unless),
    ]
    return [(word, text) for word, text in said if text]


def print_rule(rule: tree.RuleItem, style: Style) -> str:
    """A whole rule. ValueError if it lacks its formula."""
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
    label = f" {quoted(example.label)}" if example.label else ""
    objects = f" {print_parameters(example.objects)}" if example.objects else ""
    return f"{word}{label}{objects}"


def print_state(state: tree.ExampleState, style: Style = "words") -> str:
    """A state of an example."""
    join, deny = (" & ", "!") if style == "symbols" else (" and ", "not ")
    facts = join.join(
        (deny if one.negated else "")
        + print_atom(one.atom)
        + (f" = {print_formula(one.value)}" if one.value else "")
        for one in state.literals
    )
    return facts or "true"
