"""The tables of a monitor as static constants in C."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import accumulate

from rulec.automata.mealy_monitor import IMPOSSIBLE
from rulec.code_generation.monitor_layout import MonitorLayout, RuleLayout
from rulec.code_generation.written_names import c_string, in_comment
from rulec.files.text_templates import Places
from rulec.vocabulary import Vocabulary


def table_texts(layout: MonitorLayout) -> Places:
    """The tables in ``c_texts/monitor.c``.

    They are which types are subtypes of which, with the seats of each; the cells and entries of all
    rules, and where each rule's begin; names, articles, and digests of the sources.
    """
    kinds, vocabulary = layout.fields.types, layout.fields.vocabulary
    rules, needed, book = layout.rules, layout.array_sizes, layout.rulebook
    # Padding, so that even a wrong place reads within the array.
    behind = needed["NODES"] + needed["MOST_DIGIT"] + 1
    together = [place for rule in rules for place in rule.together]
    together += [0] * max(1, *[len(rule.together) for rule in rules])
    sizes = [size for own in layout.sizes for size in own]
    world, own, _ = map(len, layout.sizes)
    sizes += [0] * (needed["PLACES"] + 1)
    digests = [f"{source.name} {source.sha256}" for source in book.sources] or [""]
    return {
        "fits": (
            f"{{{_listed([*(int(_fits(own, of, vocabulary)) for own in kinds), 0])}}},"
            for of in kinds
        ),
        "first": _listed(layout.seats[kind][0] for kind in kinds),
        "end": _listed(layout.seats[kind][1] for kind in kinds),
        "cells": _stretches("cells", rules, [rule.cells for rule in rules], behind),
        "entries": _stretches("entries", rules, [rule.entries for rule in rules]),
        "n_together": len(together),
        "together": _lines(together),
        "n_sizes": len(sizes),
        "sizes": _lines(sizes),
        "sizes_of": _listed([0, *[world] * 6, world + own, *[0] * 8]),
        "rules": _rows(layout),
        "rule_names": (f"{c_string(own.rule.name)}," for own in rules),
        "rule_articles": (f"{c_string(own.rule.cite)}," for own in rules),
        "sources": (f"{c_string(text)}," for text in digests),
        "rule_variables": _listed(len(own.rule.variables) for own in rules),
    }


def _fits(kind: str, of: str, vocabulary: Vocabulary) -> bool:
    return kind == of or vocabulary.is_subtype(kind, of)


def _rows(layout: MonitorLayout) -> Iterator[str]:
    rules, kinds = layout.rules, layout.fields.types
    firsts = zip(
        _firsts(len(own.cells) for own in rules),
        _firsts(len(own.entries) for own in rules),
        _firsts(own.n_instances for own in rules),
        _firsts(own.n_words for own in rules),
        _firsts(len(own.together) for own in rules),
        strict=True,
    )
    for own, (cell, entry, instance, word, together) in zip(rules, firsts, strict=True):
        machine, n = own.rule.machine, layout.n_variables
        types = [kinds.index(variable.type) for variable in own.rule.variables]
        numbers = [
            *(cell, entry, instance, own.n_instances, word, len(own.cells)),
            *(len(machine.successors[0]), len(machine.successors), len(own.seats)),
            *(max(0, len(own.seats) - 1), together, len(own.together)),
        ]
        lists = [
            _listed([*column, *[0] * (n - len(column))])
            for column in ([x for x, _ in own.seats], [x for _, x in own.seats], types)
        ]
        flags = own.start, int(own.rule.strength == "hard"), int(IMPOSSIBLE in machine.letters)
        columns = ", ".join(f"{{{column}}}" for column in lists)
        yield f"/* {in_comment(own.rule.name)}: {in_comment(own.rule.cite)} */"
        yield f"{{{_listed(numbers)}, {columns}, {_listed(flags)}}},"


def _stretches(
    name: str, rules: Sequence[RuleLayout], stretches: Sequence[Sequence[int]], behind: int = 0
) -> Iterator[str]:
    size = sum(map(len, stretches)) + behind
    yield f"static const uint16_t rulec_{name}[{size}u] = {{"
    for own, stretch in zip(rules, stretches, strict=True):
        yield f"    /* {in_comment(own.rule.name)} */"
        yield from (f"    {line}" for line in _lines(stretch))
    if behind:
        yield "    /* behind what is read */"
    yield from (f"    {line}" for line in _lines([0] * behind))
    yield "};"


def _lines(numbers: Sequence[int]) -> Iterator[str]:
    for start in range(0, len(numbers), 14):
        yield f"{_listed(numbers[start : start + 14])},"


def _listed(numbers: Iterable[int]) -> str:
    return ", ".join(f"{number}u" for number in numbers)


def _firsts(lengths: Iterable[int]) -> list[int]:
    return list(accumulate(lengths, initial=0))[:-1]
