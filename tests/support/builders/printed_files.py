"""Whole files of the syntax tree as text: one form for everything, comments are not part of it."""

import re

from rulec.syntax import tree
from rulec.syntax.tree_printer import (
    clauses_of,
    comma,
    print_atom,
    print_formula,
    print_in_force,
    print_parameters,
    print_whole,
    quoted,
)


def print_file(file, style="words"):
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


def header_of(file):
    """A rulebook's header lines in one order."""
    single = (file.title, file.law, file.extends, file.traffic)
    behind = (file.semantics, file.step, *file.priorities)
    return [line for line in (*single, *file.uses, *behind) if line is not None]


def print_item(item, style="words"):
    """A declaration, a provision or a rule. ValueError for an item that could not be read."""
    if isinstance(item, tree.BrokenItem):
        raise ValueError("an item that could not be read cannot be printed")
    if isinstance(item, tree.RuleItem):
        return print_rule(item, style)
    if isinstance(item, tree.Definition):
        return print_provision(item, style)
    if isinstance(item, tree.Listing):
        return print_listing(item)
    return print_declaration(item, style)


SWITCH = re.compile(r"(on|off)\b")


def print_header_line(line):
    """A header line."""
    match line:
        case tree.TitleLine(text):
            return f"title {quoted(text.value)}"
        case tree.LawLine(text, as_of):
            return f"law {quoted(text.value)}" + (f" as of {as_of}" if as_of else "")
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


def print_declaration(item, style):
    """A declaration."""
    match item:
        case tree.TypeItem(name, parent):
            return f"type {name.text}" + (f" is {parent.text}" if parent else "")
        case tree.EnumerationItem(name, parameters, values, chosen):
            default = f" default {chosen.text}" if chosen else ""
            head = name.text + print_parameters(parameters)
            return f"{head} is one of {comma(values)}{default}"
        case tree.SignalItem(signals, truth):
            default = "" if truth is None else f" default {str(truth).lower()}"
            heads = (head.name.text + print_parameters(head.parameters) for head in signals)
            return f"signal {', '.join(heads)}{default}"
        case tree.QuantityItem(name, parameters, unit, number):
            default = "" if number is None else f" default {repr(number).removesuffix('.0')}"
            return f"quantity {name.text}{print_parameters(parameters)} in {unit}{default}"
        case tree.FactItem(formula):
            return f"fact {print_whole(formula, style)}"
        case tree.ConstantItem(names):
            return f"constant {', '.join(name.text for name in names)}"
        case tree.PresumedItem(names):
            return f"presumed {', '.join(name.text for name in names)}"


def print_provision(item, style):
    """An option, a parameter, a definition, or what is done to an inherited one."""
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
            text = print_formula(value, style)
            if SWITCH.match(text):  # a name here; bare, the word would switch an option
                text = f"({text})"
            return f"set {name.text} = {text}{_dates(in_force)}"
        case tree.DefineItem(name, parameters, body, again):
            word = "redefine" if again else "define"
            head = name.text + print_parameters(parameters)
            return f"{word} {head} = {print_formula(body, style)}"
        case tree.DropItem(name, because):
            return f"drop rule {name.text} because {quoted(because.value)}"
        case tree.SoftenItem(name, level, weight, because):
            place = print_place(level, weight)
            why = f" because {quoted(because.value)}" if because else ""
            return f"soften rule {name.text}{place}{why}"
        case tree.SilentItem(name, because):
            return f"silent on {name.text} because {quoted(because.value)}"


def print_listing(item):
    """Topics, or the articles of a law."""
    if isinstance(item, tree.TopicsItem):
        entries = (
            f"{entry.name.text} {quoted(entry.title.value)}"
            + (f" of {comma(entry.rules)}" if entry.rules else "")
            for entry in item.entries
        )
        return f"topics {{ {'; '.join(entries)} }}"
    entries = (
        f"{quoted(entry.number.value)} {quoted(entry.heading.value)}"
        + (f" {entry.treatment} because {quoted(entry.because.value)}" if entry.because else "")
        for entry in item.entries
    )
    as_of = f" as of {item.as_of}" if item.as_of else ""
    certainty = f" certainty {item.certainty}" if item.certainty else ""
    return f"provisions {quoted(item.link.value)}{as_of}{certainty} {{ {'; '.join(entries)} }}"


def _dates(in_force):
    return f" {print_in_force(in_force)}" if in_force else ""


def print_place(level, weight):
    """`` in level weight number``, as much of it as there is."""
    return (f" in {level.text}" if level else "") + (f" weight {weight.text}" if weight else "")


def print_rule_head(rule):
    """A rule's head, without the brace."""
    upon = ["confirm" if rule.confirm else "override"] if rule.override else []
    words = [*upon, *([rule.strength] if rule.strength else [])]
    variables = f" {print_parameters(rule.variables)}" if rule.variables else ""
    place = print_place(rule.level, rule.weight)
    return f"{' '.join([*words, 'rule'])} {rule.name.text}{variables}{place}"


def print_rule(rule, style):
    """A whole rule. ValueError if it lacks its formula."""
    if rule.require is None and not rule.override:
        raise ValueError(f"rule {rule.name.text} has no formula")
    lines = [f"{print_rule_head(rule)} {{"]
    lines += [f"  {word} {text}" for word, text in clauses_of(rule, style)]
    lines += [f"  {_example(example, style)}" for example in rule.examples]
    return "\n".join([*lines, "}"])


def _example(example, style):
    states = "; ".join(print_state(state, style) for state in example.states)
    return f"{print_example_head(example)} {{ {states} }}"


def print_example_head(example):
    """``accept "label" (objects)``."""
    word = "accept" if example.accepts else "reject"
    label = f" {quoted(example.label)}" if example.label else ""
    objects = f" {print_parameters(example.objects)}" if example.objects else ""
    return f"{word}{label}{objects}"


def print_state(state, style="words"):
    """A state of an example."""
    join, deny = (" & ", "!") if style == "symbols" else (" and ", "not ")
    facts = join.join(
        (deny if one.negated else "")
        + print_atom(one.atom)
        + (f" = {print_formula(one.value)}" if one.value else "")
        for one in state.literals
    )
    return facts or "true"
