"""The batch engine for unknown values: all rules and bindings on traces of one shape."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Indices
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
from rulec.monitoring.batch.uncertain.supposed_rows import SupposedRows, supposed_rows
from rulec.monitoring.batch.verdict_columns import RuleBinding, VerdictColumns
from rulec.monitoring.letter_reader import present_in
from rulec.monitoring.uncertainty.judged_rules import JudgedRules
from rulec.monitoring.uncertainty.state_letters.entangled_reads import (
    EntangledReads,
    NothingKnown,
)
from rulec.monitoring.uncertainty.state_letters.letter_classes import RuleLetters
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import Numbers
from rulec.monitoring.uncertainty.state_letters.possible_letters import (
    bound_letters,
    letters_of_rule,
)
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.monitoring.uncertainty.supposed_constants import ConstantsReader
from rulec.monitoring.uncertainty.uncertain_machine import UncertainMachine
from rulec.trace import Value
from rulec.trace.trace_columns import Array, Layout, TraceColumns, smallest_unsigned
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN

_RuleReads: TypeAlias = tuple[RuleLetters, SupposedRows, Sequence[Numbers]]
"""A rule's letters, and the numbers of its reads in the states of rows."""

_MOST_CODES = 1 << 62
"""The most combinations that NumPy's integers can number."""


@dataclass(frozen=True, slots=True)
class UncertainOutcomes:
    """The outcomes of one rule and binding: places of traces in the layout's order.

    ``violated`` are violated by all completions, with the states after which they are lost (-1 for
    none); ``open`` are neither violated nor kept; for ``unread`` this cannot be decided here.
    """

    binding: RuleBinding
    violated: Indices
    lost_at: NDArray[np.int64]
    open: Indices
    unread: Indices


def uncertain_outcomes(
    columns: TraceColumns, rulebook: CompiledRulebook, judged: JudgedRules
) -> Iterator[UncertainOutcomes]:
    """Outcomes in the order of rules and objects.

    Raises NotGivenError if a rule needs a value that is not given and has no default.
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
        self._bound = bound_letters(rulebook, columns.objects, vocabulary)
        self._machines: dict[str, SetTables] = {}
        self._rows: dict[object, SupposedRows] = {}

    def outcomes(self, binding: RuleBinding, machine: UncertainMachine) -> UncertainOutcomes:
        """The outcomes of a rule for some objects."""
        machines = self._set_tables(binding.rule, machine)
        rows, unread = self._rows_of(binding, machine)
        word = self._letters(binding, machines, rows)
        tables = machines.now()
        n_traces = self._columns.layout.n_traces
        if tables is None:
            nothing = np.empty(0, dtype=np.intp)
            every = np.arange(n_traces)
            return UncertainOutcomes(binding, nothing, nothing.astype(np.int64), nothing, every)
        verdicts = run(tables.joint, word, rows.layout, *binding.stretch)
        possible = rows.in_any((verdicts & POSSIBLE) != 0)
        certain = rows.in_all((verdicts & CERTAIN) != 0)
        unread = np.union1d(unread, _impossible(binding, tables, rows, word))
        return UncertainOutcomes(
            binding,
            np.flatnonzero(~possible),
            _lost_at(binding, tables, (rows, word), possible),
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

    def _letters(self, binding: RuleBinding, machines: SetTables, rows: SupposedRows) -> Array:
        """The number of the letter set in each state of rows."""
        n_states = rows.layout.n_states
        numbers = [self._numbers(read, binding, rows) for read in binding.rule.machine.reads]
        letters = np.broadcast_to(np.asarray(machines.letters.numbers(numbers)), (n_states,))
        own = self._rule_letters(binding, machines.machine)
        if own.entangled.numbers:
            partial = machines.letters.are_partial(numbers, own.entangled.numbers)
            dark = self._are_entangled(binding, own, rows) & partial
            places = _on_stretch(binding, rows.layout, np.flatnonzero(dark))
            if len(places):
                letters = letters.copy()
                letters[places] = self._joint_letters(
                    binding, machines, (own, rows, numbers), places
                )
        cells: Array = letters.astype(smallest_unsigned(len(machines.letters.sets)))
        return cells

    def _joint_letters(
        self, binding: RuleBinding, machines: SetTables, rule_reads: _RuleReads, places: Indices
    ) -> list[int]:
        """The number of the letter set at each place, where reads depend on each other.

        It is computed once for all places with the same values.
        """
        own, rows, numbers = rule_reads

        def sets_at(places: Indices) -> list[int]:
            digits = [machines.digits(n, numbers[n], places) for n in own.independent]
            keys = self._keys(binding, own.entangled, (places, digits), rows)
            return [machines.letters.number_of(each) for each in own.classes(keys)]

        coded = self._codes(binding, machines, rule_reads, places)
        if coded is None:
            return sets_at(places)
        kind, codes = coded
        known = machines.by_codes((own, kind))
        try:
            return [known[code] for code in codes]
        except KeyError:
            here = zip(codes, places.tolist(), strict=True)
            new = {code: place for code, place in here if code not in known}
        new_sets = sets_at(np.array([*new.values()], dtype=np.intp))
        known.update(zip(new, new_sets, strict=True))
        return [known[code] for code in codes]

    def _codes(
        self, binding: RuleBinding, machines: SetTables, rule_reads: _RuleReads, places: Indices
    ) -> tuple[object, Sequence[object]] | None:
        """A kind of codes, and a code for each place.

        Codes are equal where states have equal values.

        None if a few numbers do not suffice for this.
        """
        own, rows, numbers = rule_reads
        entangled, kinds = own.entangled, []
        if self._columns.present and not entangled.is_local:
            return None
        columns = [(numbers[n], machines.width(n)) for n in own.independent]
        for subject in entangled.subjects_of(binding.objects):
            coded = self._reader.codes(subject, entangled.regions)
            where = rows.where_supposed(subject)
            is_said = subject in self._columns.values
            if coded is None or (where is not None and not is_said):
                return None
            column, width = rows.numbers(coded[0]), coded[1]
            if where is not None:
                values, chosen = where
                regions = entangled.regions
                of_values = [self._reader.code_of_value(subject, x, regions) for x in values]
                by_value = np.array([*[code for _, code in of_values], 0], dtype=np.intp)
                is_unknown = np.equal(column, of_values[0][0]) & (chosen >= 0)
                column = np.where(is_unknown, by_value.take(chosen), column)
            columns.append((column, width))
            kinds.append((width, is_said))
        return tuple(kinds), _joined_codes(columns, places)

    def _rule_letters(self, binding: RuleBinding, machine: UncertainMachine) -> RuleLetters:
        """The letters of a rule, with all its reads taken together."""
        return letters_of_rule(
            binding.rule,
            machine.classes,
            binding.objects,
            self._rulebook,
            everybody=self._everybody,
            bound=self._bound,
        )

    def _keys(
        self,
        binding: RuleBinding,
        entangled: EntangledReads,
        independent: tuple[Indices, Sequence[Sequence[int]]],
        rows: SupposedRows,
    ) -> list[tuple[int, ...]]:
        """The keys of letters at some places, where independent reads have these digits."""
        places, digits = independent
        of_traces = rows.places(places)
        columns = [
            rows.with_supposed(subject, self._reader.values_at(subject, of_traces), places)
            for subject in entangled.subjects_of(binding.objects)
        ]
        values = zip(*columns, strict=True) if columns else [()] * len(places)
        numbers = map(entangled.number, values)
        if not entangled.is_local:
            own, starts = self._columns, rows.layout.starts
            steps = np.searchsorted(starts, places, side="right") - 1
            there = [present_in(step, own.objects, own.present) for step in steps.tolist()]
            numbers = map(entangled.number, values, there)
        return list(zip(*digits, numbers, strict=True))

    def _are_entangled(
        self, binding: RuleBinding, own: RuleLetters, rows: SupposedRows
    ) -> NDArray[np.bool_]:
        """The states of rows in which unknown values depend on each other."""
        columns = self._columns
        entangled_states = np.zeros(columns.layout.n_states, dtype=bool)
        reads = own.entangled
        supposed = np.zeros(rows.layout.n_states, dtype=bool)
        subjects = zip(reads.subjects, reads.subjects_of(binding.objects), strict=True)
        for about, subject in subjects:
            if about in reads.shared and self._reader.is_dark(subject):
                entangled_states[:] = True
            if about in reads.shared and subject in columns.unknown:
                entangled_states |= columns.unknown[subject]
            if subject in columns.upper:
                entangled_states |= columns.upper[subject] != columns.values[subject]
            # Supposed values are not included in the numbers of counts.
            where = rows.where_supposed(subject)
            if where is not None:
                supposed |= where[1] >= 0
        return rows.flags(entangled_states) | supposed

    def _numbers(
        self, read: Read | NumberRead, binding: RuleBinding, rows: SupposedRows
    ) -> Numbers:
        """A read's numbers in the states of rows."""
        numbers = rows.numbers(self._reader.numbers(read, binding.objects))
        if not rows.supposed:
            return numbers
        where = rows.where_supposed(_subject_of(read, binding))
        if where is None:
            return numbers
        values, places = where
        of_values = [number_of_value(read, value, self._vocabulary) for value in values]
        own = np.array([*[number for _, number in of_values], 0], dtype=np.intp).take(places)
        is_unknown = np.equal(numbers, of_values[0][0])
        return np.where(is_unknown & (places >= 0), own, numbers)

    def _rows_of(
        self, binding: RuleBinding, machine: UncertainMachine
    ) -> tuple[SupposedRows, Indices]:
        """The rows for all choices of unknown constants, and the traces to be judged one by one."""
        layout = self._columns.layout
        unknown, odd = self._unknown_constants(binding)
        if not unknown:
            return SupposedRows(layout), np.flatnonzero(odd)
        if self._constants.of_facts and self._rule_letters(binding, machine).entangled.numbers:
            return SupposedRows(layout), np.flatnonzero(np.any([odd, *unknown.values()], axis=0))
        key = binding.rule.name, binding.first, *unknown
        if key not in self._rows:
            suppose = partial(self._suppositions, binding, machine)
            self._rows[key] = supposed_rows(layout, unknown, suppose)
        return self._rows[key], np.flatnonzero(odd)

    def _suppositions(
        self, binding: RuleBinding, machine: UncertainMachine, subjects: Sequence[Subject]
    ) -> Sequence[Mapping[Subject, Value]]:
        """The joint values of unknown constants, as far as the rule distinguishes them."""
        every, _ = self._constants.suppositions(binding.rule, dict.fromkeys(subjects, UNKNOWN))
        joint = set(self._rule_letters(binding, machine).entangled.subjects_of(binding.objects))
        reads: dict[Subject, list[Read | NumberRead]] = {subject: [] for subject in subjects}
        for read in binding.rule.machine.reads:
            reads.get(_subject_of(read, binding), []).append(read)

        def told_apart(subject: Subject, value: Value) -> object:
            if subject in joint:
                return value
            own = reads[subject]
            return tuple([number_of_value(read, value, self._vocabulary)[1] for read in own])

        different = {
            tuple([told_apart(*own) for own in supposed.items()]): supposed for supposed in every
        }
        return list(different.values())

    def _unknown_constants(
        self, binding: RuleBinding
    ) -> tuple[Mapping[Subject, NDArray[np.bool_]], NDArray[np.bool_]]:
        """The traces in which each constant is unknown, and the traces to be judged one by one."""
        columns, layout = self._columns, self._columns.layout
        unknown_in: dict[Subject, NDArray[np.bool_]] = {}
        odd = np.zeros(layout.n_traces, dtype=bool)
        for subject in sorted(self._constants.read_by(binding.rule, binding.objects)):
            first = max((columns.present.get(x, (0, 0))[0] for x in subject[1]), default=0)
            now = slice(layout.starts[first], layout.starts[first] + layout.n_traces)
            unknown = columns.unknown.get(subject)
            if self._reader.is_dark(subject):
                unknown_in[subject] = ~odd | odd
            elif unknown is not None and unknown[now].any():
                unknown_in[subject] = unknown[now]
            if subject in columns.upper:
                odd |= columns.upper[subject][now] != columns.values[subject][now]
        return unknown_in, odd


def _joined_codes(columns: Sequence[tuple[Numbers, int]], places: Indices) -> Sequence[object]:
    """One or several numbers for the joint values of columns at some places."""
    words, codes, size = [], np.zeros(len(places), dtype=np.int64), 1
    for column, width in columns:
        if size * width > _MOST_CODES:
            words.append(codes.tolist())
            codes, size = np.zeros(len(places), dtype=np.int64), 1
        size *= width
        own = column.take(places) if isinstance(column, np.ndarray) and column.ndim else column
        codes = codes * width + own
    every = codes.tolist()
    return list(zip(*words, every, strict=True)) if words else every


def _subject_of(read: Read | NumberRead, binding: RuleBinding) -> Subject:
    """The value of a binding's objects that a read consists of; none for a sum or a count."""
    name, variables = (read.name, read.variables) if isinstance(read, Read) else quantity(read)
    return name, tuple([binding.objects[variable] for variable in variables])


def _on_stretch(binding: RuleBinding, layout: Layout, places: Indices) -> Indices:
    (first, last), starts = binding.stretch, layout.starts
    end = starts[-1 if last is None else last + 1]
    chosen: Indices = places[(places >= starts[first]) & (places < end)]
    return chosen


def _impossible(binding: RuleBinding, tables: SetTable, rows: SupposedRows, word: Array) -> Indices:
    """The traces with a state that can have no letter, whatever is supposed."""
    if not tables.impossible:
        return np.empty(0, dtype=np.intp)
    wrong = np.flatnonzero(np.isin(word, list(tables.impossible)))
    return rows.traces_at(_on_stretch(binding, rows.layout, wrong))


def _lost_at(
    binding: RuleBinding,
    tables: SetTable,
    read: tuple[SupposedRows, Array],
    accepted: NDArray[np.bool_],
) -> NDArray[np.int64]:
    """The states after which violating traces are lost in all rows.

    -1 if in some row they never are.
    """
    rows, word = read
    if accepted.all():
        return np.empty(0, dtype=np.int64)
    steps = VerdictColumns(
        task=replace(binding, rule=replace(binding.rule, machine=tables.possible)),
        accepted=rows.in_rows(accepted),
        unread=np.empty(0, dtype=np.intp),
        _layout=rows.layout,
        _cells=word,
        _letters=tables.joint.letters,
    ).lost_at()
    if rows.traces is None:
        return steps
    of_traces = rows.traces[~rows.in_rows(accepted)]
    begins = np.flatnonzero(np.diff(of_traces, prepend=-1))
    never = np.minimum.reduceat(steps, begins) < 0
    return np.where(never, -1, np.maximum.reduceat(steps, begins))
