"""A rule's machine beside the clocks that it reads, and the table of both for certain bounds.

What a past operator remembers is a clock (``logic.past_registers``). The machine reads whether each
holds, so it is the same for bounds of any length. For bounds in steps both run side by side, which
gives a table for letters alone: a bound costs states there, but no formula is looked at again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cache, partial
from typing import TypeAlias

from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Read
from rulec.automata.tables import (
    MOST_EDGES,
    MOST_STATES,
    MOST_STEPS_AHEAD,
    SizeError,
    VerdictTable,
    build_machine,
    loop_verdicts,
)
from rulec.logic.bounds import Range, begins_at, bound_in_steps, range_of_bound
from rulec.logic.formula import Bound
from rulec.logic.past_registers import Register, register_after
from rulec.value_display import short_repr

_SIDES = ((False, False), (True, False), (False, True), (True, True))
"""The values of a clock's left and right operand, by their code."""

Due: TypeAlias = tuple[int, ...]
"""For each clock whether it holds its proposition true, if its left operand is."""


@dataclass(frozen=True, slots=True)
class ClockLetters:
    """What clocks make of a group of letters: a letter of the table that reads them.

    That letter is ``group + n_groups * values``, the clocks' values as bits. ``operands`` has for
    each clock, and each letter of the table, 1 if its left operand holds there, plus 2 if its right
    one does; a clock's operands may read earlier clocks.
    """

    n_groups: int
    operands: tuple[tuple[int, ...], ...]

    def read(self, group: int, due: Due, spans: Sequence[Range]) -> tuple[int, Due]:
        """The letter of the table, and for each clock the code of its operands."""
        letter, codes = group, []
        weight = self.n_groups
        for codes_of, is_due, span in zip(self.operands, due, spans, strict=True):
            code = codes_of[letter]
            codes.append(code)
            letter += weight * (register_after(span, is_due << 1, *_SIDES[code]) & 1)
            weight *= 2
        return letter, tuple(codes)

    def possible(self, bounds: Sequence[Bound]) -> frozenset[int]:
        """The letters of the table that can come with clocks of these bounds."""
        letters, weight = frozenset(range(self.n_groups)), self.n_groups
        for codes_of, bound in zip(self.operands, bounds, strict=True):
            now = [low == 0 for low in begins_at(bound)]
            values_of = [
                {int((left and due) or (right and at_once)) for due in (0, 1) for at_once in now}
                for left, right in _SIDES
            ]
            letters = frozenset(
                [x + weight * value for x in letters for value in values_of[codes_of[x]]]
            )
            weight *= 2
        return letters


@dataclass(frozen=True, slots=True)
class ClockedMachine:
    """A machine over what it ``reads`` and over clocks.

    ``groups``: for each letter the number of its group, ``IMPOSSIBLE`` for those that axioms
    exclude; letters of one group are the same for the ``table`` and for the clocks. ``clocks`` say
    which letters of the table these make of groups. ``hoa`` is the automaton that reads clocks, if
    it is wanted.
    """

    reads: tuple[Read | NumberRead, ...]
    groups: tuple[int, ...]
    clocks: ClockLetters
    table: MealyMonitor
    hoa: str = field(default="", compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TimedMachine:
    """A rule's machine for any step of traces: its clocks have ``bounds``, in seconds or steps.

    ``ends`` if nothing follows a word.
    """

    __repr__ = short_repr

    clocked: ClockedMachine
    bounds: tuple[Bound, ...]
    ends: bool

    def at(self, step_s: Fraction | None) -> MealyMonitor:
        """The machine over letters alone for steps of so many seconds; it is minimal.

        Without a step no bound may be in seconds. Raises SizeError.
        """
        spans = [
            range_of_bound(bound if step_s is None else bound_in_steps(bound, step_s))
            for bound in self.bounds
        ]
        if any((span.high or span.low) > MOST_STEPS_AHEAD for span in spans):
            raise SizeError
        clocked = self.clocked
        rows = _side_by_side(clocked, spans, ends=self.ends)
        machine = build_machine(rows, (), clocked.clocks.n_groups)
        numbers = (*machine.letters, IMPOSSIBLE)
        letters = tuple([numbers[group] for group in clocked.groups])
        return replace(machine, reads=clocked.reads, letters=letters)


@dataclass(frozen=True, slots=True)
class _Moves:
    """The different moves where certain clocks are due, and for each group the place of its own.

    A move is the class of letters that the table reads, and the codes of the clocks' operands.
    """

    moves: tuple[tuple[int, Due], ...]
    of_group: tuple[int, ...]


def _side_by_side(machine: ClockedMachine, spans: Sequence[Range], *, ends: bool) -> VerdictTable:
    """The table for groups: its states are pairs of a state of the table and what clocks hold."""
    table = machine.table
    at_first = (Register.at_first,) * len(spans)
    sinks = {table.rejecting_sink, table.accepting_sink}
    after = [cache(partial(register_after, span)) for span in spans]
    met: dict[Due, _Moves] = {}
    numbers = {(0, at_first): 0}
    rows: list[tuple[int, Due, list[int]]] = []
    n_edges = 0
    for state, held in (reached := list(numbers)):
        due = tuple([value >> 1 & 1 for value in held])
        if due not in met:
            met[due] = _moves(machine, due, spans)
        row = []
        for symbol, codes in met[due].moves:
            target, later = table.successors[state][symbol], at_first
            if target not in sinks:
                # In a sink the past makes no difference.
                each = zip(after, held, codes, strict=True)
                later = tuple([advance(value, *_SIDES[code]) for advance, value, code in each])
            pair = target, later
            if pair not in numbers:
                numbers[pair] = len(reached)
                reached.append(pair)
            row.append(numbers[pair])
        rows.append((state, due, row))
        n_edges += len(row)
        if len(reached) > MOST_STATES or n_edges > MOST_EDGES:
            raise SizeError
    # Groups that are told apart nowhere form a class.
    members: dict[tuple[int, ...], int] = {}
    for group, key in enumerate(zip(*[own.of_group for own in met.values()], strict=True)):
        members[key] = members.get(key, 0) | 1 << group
    place_of = {due: [key[place] for key in members] for place, due in enumerate(met)}
    successors = [[row[place] for place in place_of[due]] for _, due, row in rows]
    verdicts = [
        [table.outputs[state][met[due].moves[place][0]] for place in place_of[due]]
        for state, due, _ in rows
    ]
    if not ends:
        # A letter that is repeated settles the clocks sooner or later.
        columns = zip(zip(*successors, strict=True), zip(*verdicts, strict=True), strict=True)
        settled = [loop_verdicts(list(zip(*column, strict=True)), bool) for column in columns]
        verdicts = [list(row) for row in zip(*settled, strict=True)]
    return VerdictTable(list(members.values()), successors, verdicts)


def _moves(machine: ClockedMachine, due: Due, spans: Sequence[Range]) -> _Moves:
    places: dict[tuple[int, Due], int] = {}
    of_group = []
    for group in range(machine.clocks.n_groups):
        letter, codes = machine.clocks.read(group, due, spans)
        of_group.append(places.setdefault((machine.table.letters[letter], codes), len(places)))
    return _Moves(tuple(places), tuple(of_group))
