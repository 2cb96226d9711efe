"""All rules and bindings on traces of one shape whose states are taken from a few."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.verdict_columns import (
    JointCells,
    RuleBinding,
    VerdictColumns,
    verdict_columns,
)
from rulec.monitoring.bindings import Cast
from rulec.monitoring.letter_reader import LetterReader
from rulec.trace.trace_columns import TraceCells, TraceColumns


def verify_cells(traces: TraceCells, rulebook: CompiledRulebook) -> list[VerdictColumns]:
    """Verdicts on traces as cells, whose states have passed ``check_state``."""
    bound_rules = rule_bindings(traces, rulebook)
    by_stretch: dict[tuple[int, int | None], list[tuple[RuleBinding, list[int]]]] = {}
    all_letters = _letters_by_cell(traces, bound_rules, rulebook)
    for binding, letters in zip(bound_rules, all_letters, strict=True):
        by_stretch.setdefault(binding.stretch, []).append((binding, letters))
    joint = (
        JointCells(traces.layout, traces.cells, *zip(*group, strict=True))
        for group in by_stretch.values()
    )
    return _verdicts(joint, bound_rules)


def rule_bindings(
    traces: TraceColumns | TraceCells, rulebook: CompiledRulebook
) -> list[RuleBinding]:
    """All bindings of rules to objects, in the order in which verdicts list violations."""
    present = traces.present
    cast = Cast(traces.objects, rulebook.vocabulary, traces.layout.n_steps, present)
    return [
        # All traces have the steps in ``present``.
        RuleBinding(
            rule,
            binding.objects,
            binding.first,
            None if present.keys().isdisjoint(binding.objects.values()) else binding.last,
        )
        for rule in rulebook.rules
        for binding in cast.bindings(rule)
    ]


def _verdicts(
    joint: Iterable[JointCells], bound_rules: Sequence[RuleBinding]
) -> list[VerdictColumns]:
    verdicts = chain.from_iterable(map(verdict_columns, joint))
    by_binding = {verdict.task: verdict for verdict in verdicts}
    return [by_binding[binding] for binding in bound_rules]


def _letters_by_cell(
    traces: TraceCells, bound_rules: Sequence[RuleBinding], rulebook: CompiledRulebook
) -> list[list[int]]:
    """For each binding the letter class of each cell; -1 where there is nothing to read.

    Where an object of the binding is absent, its machine does not run, so any letter will do.
    """
    # States with the same objects are read together.
    scenes: dict[tuple[tuple[str, str], ...], list[int]] = {}
    for cell, present in enumerate(traces.there or [traces.objects] * len(traces.states)):
        scenes.setdefault(tuple(present.items()), []).append(cell)
    all_letters = [[0] * len(traces.states) for _ in bound_rules]
    for scene, cells in scenes.items():
        objects = dict(scene)
        states = [traces.states[cell] for cell in cells]
        reader = LetterReader(states, rulebook, str, objects=objects)
        for binding, letters in zip(bound_rules, all_letters, strict=True):
            if objects.keys() >= set(binding.objects.values()):
                word = _word(binding, reader, 0, len(cells) - 1)
                for cell, letter in zip(cells, word, strict=True):
                    letters[cell] = letter
    return all_letters


def _word(binding: RuleBinding, reader: LetterReader, first: int, last: int) -> list[int]:
    try:
        return list(reader.word(binding.rule, binding.objects, first, last))
    except RulecError:
        if first == last:
            return [-1]
        return [_word(binding, reader, place, place)[0] for place in range(first, last + 1)]
