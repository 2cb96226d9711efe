"""Header lines, declarations and provisions as text."""

from __future__ import annotations

import re

from rulec.syntax import tree
from rulec.syntax.printer.formulas import (
    Style,
    comma,
    print_formula,
    print_parameters,
    print_text,
    print_whole,
)

SWITCH = re.compile(r"(on|off)\b")


def print_header_line(line: tree.HeaderLine) -> str:
    """A header line."""
    match line:
        case tree.TitleLine(text):
            return f"title {print_text(text)}"
        case tree.LawLine(text, as_of):
            return f"law {print_text(text)}" + (f" as of {as_of}" if as_of else "")
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


def print_declaration(item: tree.Declaration, style: Style) -> str:
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


def print_provision(item: tree.Provision, style: Style) -> str:
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
            return f"drop rule {name.text} because {print_text(because)}"
        case tree.SoftenItem(name, level, weight, because):
            place = print_place(level, weight)
            why = f" because {print_text(because)}" if because else ""
            return f"soften rule {name.text}{place}{why}"
        case tree.SilentItem(name, because):
            return f"silent on {name.text} because {print_text(because)}"


def _dates(in_force: tree.InForce | None) -> str:
    return f" {print_in_force(in_force)}" if in_force else ""


def print_in_force(dates: tree.InForce) -> str:
    """``in force from DATE until DATE``."""
    since = f" from {dates.since}" if dates.since else ""
    until = f" until {dates.until}" if dates.until else ""
    return f"in force{since}{until}"


def print_place(level: tree.Name | None, weight: tree.Number | None) -> str:
    """`` in level weight number``, as much of it as there is."""
    return (f" in {level.text}" if level else "") + (f" weight {weight.text}" if weight else "")
