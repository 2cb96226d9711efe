"""Batch engine where not all is known: all rules and bindings on traces of one shape."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.monitoring.batch.engine import rule_bindings
from rulec.monitoring.batch.machines.table_run import run
from rulec.monitoring.batch.uncertain.partial_reader import (
    PartialReader,
    meanings_of,
    number_of_value,
    quantity,
)
from rulec.monitoring.batch.uncertain.set_table import (
    CERTAIN,
    POSSIBLE,
    SetTable,
    SetTables,
    set_tables,
)
from rulec.monitoring.batch.verdict_columns import RuleBinding, VerdictColumns
from rulec.monitoring.letter_reader import present_in
from rulec.monitoring.uncertainty.judged_rules import JudgedRules
from rulec.monitoring.uncertainty.state_letters.entangled_reads import (
    EntangledReads,
    NothingKnown,
    known_parts,
    local_reads,
)
from rulec.monitoring.uncertainty.state_letters.letter_classes import RuleLetters
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import Numbers
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.monitoring.uncertainty.supposed_constants import ConstantsReader
from rulec.monitoring.uncertainty.uncertain_machine import UncertainMachine
from rulec.trace import Value
from rulec.trace.trace_columns import Array, TraceColumns, smallest_unsigned
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, PartialValue

Places = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class UncertainOutcomes:
    """What one rule and binding come to: places of traces in the layout's order.

    ``violated`` are by all completions, with the states after which they are lost, -1 for none;
    ``open`` are neither violated nor kept, ``unread`` those of which this cannot be told.
    """

    binding: RuleBinding
    violated: Places
    lost_at: NDArray[np.int64]
    open: Places
    unread: Places


def uncertain_outcomes(
    columns: TraceColumns, rulebook: CompiledRulebook, judged: JudgedRules
) -> Iterator[UncertainOutcomes]:
    """Outcomes in the order of rules and objects.

    Raises NotGivenError where a rule needs what is neither given nor has a default.
    """
    engine = _Engine(columns, rulebook, judged.vocabulary)
    machines = {rule.name: machine for rule, machine in judged.machines}
    rules = tuple([rule for rule, _ in judged.machines])
    for binding in rule_bindings(columns, replace(rulebook, rules=rules)):
        yield engine.outcomes(binding, machines[binding.rule.name])


class _Engine:
    def __init__(
        self, columns: TraceColumns, rulebook: CompiledRulebook, vocabulary: Vocabulary
    ) -> None:
        self._columns = columns
        self._rulebook = rulebook
        self._vocabulary = vocabulary
        self._reader = PartialReader(columns, vocabulary)
        self._constants = ConstantsReader(rulebook, vocabulary, columns.objects)
        self._everybody = NothingKnown(columns.objects, vocabulary)
        self._bound: dict[tuple[str, ...], RuleLetters] = {}
        self._machines: dict[str, SetTables] = {}

    def outcomes(self, binding: RuleBinding, machine: UncertainMachine) -> UncertainOutcomes:
        """What a rule comes to for some objects."""
        machines = self._set_tables(binding.rule, machine)
        alternatives, unread = self._alternatives(binding, machine)
        words = [self._letters(binding, machines, values) for values in alternatives]
        tables = machines.now()
        n_traces = self._columns.layout.n_traces
        if tables is None:
            nothing = np.empty(0, dtype=np.intp)
            every = np.arange(n_traces)
            return UncertainOutcomes(binding, nothing, nothing.astype(np.int64), nothing, every)
        first, last = binding.stretch
        layout = self._columns.layout
        runs = [run(tables.joint, cells, layout, first, last) for cells in words]
        possible = np.any([(one & POSSIBLE) != 0 for one in runs], axis=0)
        certain = np.all([(one & CERTAIN) != 0 for one in runs], axis=0)
        unread = np.union1d(unread, self._impossible(binding, tables, words))
        return UncertainOutcomes(
            binding,
            np.flatnonzero(~possible),
            _lost_at(binding, tables, (self._columns, words), possible),
            np.flatnonzero(possible & ~certain),
            unread,
        )

    def _set_tables(self, rule: CompiledRule, machine: UncertainMachine) -> SetTables:
        if rule.name not in self._machines:
            meanings = tuple(
                [tuple(meanings_of(read, self._vocabulary)) for read in rule.machine.reads]
            )
            self._machines[rule.name] = set_tables(machine, meanings)
        return self._machines[rule.name]

    def _letters(
        self, binding: RuleBinding, machines: SetTables, supposed: Mapping[Subject, Value]
    ) -> Array:
        """The number of the set of letters in each state."""
        n_states = self._columns.layout.n_states
        numbers = [self._supposed(read, binding, supposed) for read in binding.rule.machine.reads]
        letters = np.broadcast_to(np.asarray(machines.letters.numbers(numbers)), (n_states,))
        own = self._rule_letters(binding, machines.machine)
        if own.entangled.numbers:
            partial = machines.letters.are_partial(numbers, own.entangled.numbers)
            dark = self._are_entangled(binding, own) & partial
            places = self._on_stretch(binding, np.flatnonzero(dark))
            if len(places):
                letters = letters.copy()
                digits = [machines.digits(n, numbers[n], places) for n in own.independent]
                keys = self._keys(binding, own.entangled, (places, digits), supposed)
                letters[places] = [machines.letters.number_of(each) for each in own.classes(keys)]
        cells: Array = letters.astype(smallest_unsigned(len(machines.letters.sets)))
        return cells

    def _rule_letters(self, binding: RuleBinding, machine: UncertainMachine) -> RuleLetters:
        """The letters of a rule that does not read its values apart from each other."""
        rule, axioms = binding.rule, self._rulebook.axioms
        key = rule.name, *binding.objects.values()
        if key not in self._bound:
            reads = local_reads(rule, self._rulebook)
            if reads is not None:
                self._bound[key] = machine.classes.of_rule(rule, reads)
            else:
                reads = EntangledReads(
                    *(rule, binding.objects, axioms, self._everybody),
                    counted_parts=known_parts(self._rulebook),
                )
                self._bound[key] = RuleLetters(machine.classes, rule, reads)
        return self._bound[key]

    def _keys(
        self,
        binding: RuleBinding,
        entangled: EntangledReads,
        told: tuple[Places, Sequence[Sequence[int]]],
        supposed: Mapping[Subject, Value],
    ) -> list[tuple[int, ...]]:
        """The keys of letters at some places, where independent reads have these digits."""
        places, digits = told
        columns = [
            self._reader.values_at(subject, places, supposed.get(subject))
            for subject in entangled.subjects_of(binding.objects)
        ]
        rows = zip(*columns, strict=True) if columns else [()] * len(places)
        numbers = map(entangled.number, rows)
        if not entangled.is_local:
            own, starts = self._columns, self._columns.layout.starts
            steps = np.searchsorted(starts, places, side="right") - 1
            there = [present_in(step, own.objects, own.present) for step in steps.tolist()]
            numbers = map(entangled.number, rows, there)
        return list(zip(*digits, numbers, strict=True))

    def _are_entangled(self, binding: RuleBinding, own: RuleLetters) -> NDArray[np.bool_]:
        """The states in which unknown values have to do with each other."""
        columns = self._columns
        found = np.zeros(columns.layout.n_states, dtype=bool)
        reads = own.entangled
        asked = zip(reads.subjects, reads.subjects_of(binding.objects), strict=True)
        for about, subject in asked:
            if about in reads.shared and self._reader.is_dark(subject):
                found[:] = True
            if about in reads.shared and subject in columns.unknown:
                found |= columns.unknown[subject]
            if subject in columns.upper:
                found |= columns.upper[subject] != columns.values[subject]
        return found

    def _on_stretch(self, binding: RuleBinding, places: Places) -> Places:
        (first, last), starts = binding.stretch, self._columns.layout.starts
        end = starts[-1 if last is None else last + 1]
        chosen: Places = places[(places >= starts[first]) & (places < end)]
        return chosen

    def _supposed(
        self, read: Read | NumberRead, binding: RuleBinding, supposed: Mapping[Subject, Value]
    ) -> Numbers:
        """A read's numbers, where constants that are unknown have these values."""
        numbers = self._reader.numbers(read, binding.objects)
        if not supposed:
            return numbers
        name, variables = (read.name, read.variables) if isinstance(read, Read) else quantity(read)
        value = supposed.get((name, tuple([binding.objects[variable] for variable in variables])))
        if value is None:
            return numbers
        unknown, number = number_of_value(read, value, self._vocabulary)
        return np.where(np.equal(numbers, unknown), number, numbers)

    def _impossible(self, binding: RuleBinding, tables: SetTable, words: Sequence[Array]) -> Places:
        if not tables.impossible:
            return np.empty(0, dtype=np.intp)
        wrong = [np.flatnonzero(np.isin(word, list(tables.impossible))) for word in words]
        places = self._on_stretch(binding, np.concatenate(wrong))
        return np.unique(self._columns.layout.traces_at(places))

    def _alternatives(
        self, binding: RuleBinding, machine: UncertainMachine
    ) -> tuple[Sequence[Mapping[Subject, Value]], Places]:
        """Values of constants that are unknown in some trace, and traces to look at one by one."""
        columns, first = self._columns, binding.first
        layout = columns.layout
        now = slice(layout.starts[first], layout.starts[first + 1])
        dark, odd = np.zeros((2, layout.active(first)), dtype=bool)
        given: dict[Subject, PartialValue | None] = {}
        for subject in self._constants.read_by(binding.rule, binding.objects):
            unknown = columns.unknown.get(subject)
            if self._reader.is_dark(subject) or (unknown is not None and unknown[now].any()):
                given[subject] = UNKNOWN
                dark |= True if unknown is None else unknown[now]
            if subject in columns.upper:
                odd |= columns.upper[subject][now] != columns.values[subject][now]
        if not given:
            return [{}], np.flatnonzero(odd)
        supposed, _ = self._constants.suppositions(binding.rule, given)
        own = self._rule_letters(binding, machine).entangled.numbers
        if (own and self._constants.of_facts) or (supposed == [{}] and len(given) > 1):
            return [{}], np.flatnonzero(odd | dark)
        return supposed, np.flatnonzero(odd)


def _lost_at(
    binding: RuleBinding,
    tables: SetTable,
    read: tuple[TraceColumns, Sequence[Array]],
    accepted: NDArray[np.bool_],
) -> NDArray[np.int64]:
    """The states after which violating traces are lost for all words; -1 where one never is."""
    columns, words = read
    if accepted.all():
        return np.empty(0, dtype=np.int64)
    task = replace(binding, rule=replace(binding.rule, machine=tables.possible))
    steps = np.stack(
        [
            VerdictColumns(
                task=task,
                accepted=accepted,
                unread=np.empty(0, dtype=np.intp),
                _layout=columns.layout,
                _cells=word,
                _letters=tables.joint.letters,
            ).lost_at()
            for word in words
        ]
    )
    return np.where((steps < 0).any(axis=0), -1, steps.max(axis=0))
