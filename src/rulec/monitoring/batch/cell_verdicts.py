"""All rules and bindings on traces of one shape whose states are taken from a few."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.machines.joint_machine import join_machines
from rulec.monitoring.batch.machines.table_run import first_lost, run
from rulec.monitoring.bindings import Cast
from rulec.monitoring.uncertainty.known_words import KnownLetters
from rulec.trace import Trace
from rulec.trace.trace_columns import TraceCells, TraceColumns
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True, eq=False)
class RuleBinding:
    """A rule bound to ``objects`` from step ``first`` to ``last`` (inclusive).

    ``last`` is None for each trace's own end. Bindings are compared by identity, since they are
    keys.
    """

    rule: CompiledRule
    objects: Mapping[str, str]
    first: int
    last: int | None

    @property
    def stretch(self) -> tuple[int, int | None]:
        """The first and the last step."""
        return self.first, self.last


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class VerdictColumns:
    """Verdicts for a binding; ``accepted`` follows the layout's order of traces.

    ``unread`` are traces without a verdict, since a value is missing or impossible on the
    binding's stretch; what is said of them is meaningless.
    """

    __repr__ = short_repr

    task: RuleBinding
    accepted: NDArray[np.bool_]
    unread: NDArray[np.intp]
    _lost_at: Callable[[NDArray[np.intp]], NDArray[np.int64]] = field(compare=False, repr=False)

    @property
    def violated(self) -> NDArray[np.intp]:
        """The traces that violate the rule."""
        return np.flatnonzero(~self.accepted)

    def lost_at(self) -> NDArray[np.int64]:
        """The first state that loses the rule for each of ``violated``, or -1.

        It is -1 if only the end of the trace, or of the objects' stretch, decides.
        """
        return self._lost_at(self.violated)


def verify_cells(traces: TraceCells, rulebook: CompiledRulebook) -> list[VerdictColumns]:
    """Verdicts on traces as cells, whose states have passed ``check_state``."""
    bound_rules = rule_bindings(traces, rulebook)
    by_stretch: dict[tuple[int, int | None], list[tuple[RuleBinding, list[int]]]] = {}
    all_letters = _letters_by_cell(traces, bound_rules, rulebook)
    for binding, letters in zip(bound_rules, all_letters, strict=True):
        by_stretch.setdefault(binding.stretch, []).append((binding, letters))
    verdicts = chain.from_iterable(_verdicts(traces, group) for group in by_stretch.values())
    by_binding = {verdict.task: verdict for verdict in verdicts}
    return [by_binding[binding] for binding in bound_rules]


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
        states = tuple([traces.states[cell] for cell in cells])
        reader = KnownLetters(Trace("", traces.step_s, objects, states), rulebook)
        for binding, letters in zip(bound_rules, all_letters, strict=True):
            if objects.keys() >= set(binding.objects.values()):
                word = _word(binding, reader, 0, len(cells) - 1)
                for cell, letter in zip(cells, word, strict=True):
                    letters[cell] = letter
    return all_letters


def _word(binding: RuleBinding, reader: KnownLetters, first: int, last: int) -> list[int]:
    try:
        return list(reader.word(binding.rule, binding.objects, first, last))
    except RulecError:
        if first == last:
            return [-1]
        return [_word(binding, reader, place, place)[0] for place in range(first, last + 1)]


def _verdicts(
    traces: TraceCells, group: Sequence[tuple[RuleBinding, Sequence[int]]]
) -> Iterator[VerdictColumns]:
    """Verdicts for some bindings with a common stretch, and their letters in all cells."""
    first, last = group[0][0].stretch
    read = [_read(traces, binding, letters) for binding, letters in group]
    machines = [
        (binding.rule.machine, letters)
        for (binding, _), (_, letters) in zip(group, read, strict=True)
    ]
    for joint in join_machines(machines):
        verdicts = run(joint, traces.cells, traces.layout, first, last)
        for bit, member in enumerate(joint.members):
            (binding, _), (unread, letters) = group[member], read[member]
            yield VerdictColumns(
                task=binding,
                accepted=(verdicts & np.uint8(1 << bit)) != 0,
                unread=unread,
                _lost_at=partial(
                    first_lost,
                    binding.rule.machine,
                    letters,
                    traces.cells,
                    traces.layout,
                    stretch=binding.stretch,
                ),
            )


def _read(
    traces: TraceCells, binding: RuleBinding, letters: Sequence[int]
) -> tuple[NDArray[np.intp], tuple[int, ...]]:
    """The unread traces, and the letters, with 0 for cells without one, which occur only there."""
    if min(letters, default=0) >= 0:
        return np.empty(0, dtype=np.intp), tuple(letters)
    (first, last), layout = binding.stretch, traces.layout
    start = layout.starts[first]
    end = layout.starts[-1 if last is None else last + 1]
    missing = np.array(letters) < 0
    places = np.flatnonzero(missing.take(traces.cells[start:end])) + start
    unread = np.unique(layout.traces_at(places))
    return unread, tuple([max(letter, 0) for letter in letters])
