"""A rule's machine beside the clocks that it reads, and the table of both for certain bounds.

What a past operator remembers is a clock (``logic.past_registers``). The machine reads whether each
holds, so it is the same for bounds of any length. For bounds in steps both run side by side, which
gives a table for letters alone: a bound costs states there, but no formula is looked at again.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cache, partial

from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Read
from rulec.automata.tables import (
    MOST_STATES,
    MOST_STEPS_AHEAD,
    SizeError,
    VerdictTable,
    bits_at,
    build_machine,
    loop_verdicts,
)
from rulec.logic.bounds import Range, begins_at, bound_in_steps, range_of_bound
from rulec.logic.formula import Bound
from rulec.logic.past_registers import Register, register_after
from rulec.value_display import short_repr

MOST_PAIRS = 100_000
"""The most states of a table beside a clock before it is minimised: no compiler has to see them."""

_SIDES = ((False, False), (True, False), (False, True), (True, True))
"""The values of a clock's left and right operand, by their code."""


@dataclass(frozen=True, slots=True)
class ClockLetters:
    """What clocks make of a group of letters: a letter of the table that reads them.

    That letter is ``group + n_groups * values``, the clocks' values as bits. ``operands`` has for
    each clock, and each letter of the table, 1 if its left operand holds there, plus 2 if its right
    one does; a clock's operands may read earlier clocks.
    """

    n_groups: int
    operands: tuple[tuple[int, ...], ...]

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
        if any(max(span.low, span.high or 0) > MOST_STEPS_AHEAD for span in spans):
            raise SizeError
        clocked, machine = self.clocked, self.clocked.table
        for codes, span in reversed([*zip(clocked.clocks.operands, spans, strict=True)]):
            machine = _with_last_clock(machine, codes, span)
        if len(machine.successors) > MOST_STATES:
            raise SizeError
        if not self.ends:
            machine = _settled(machine)
        numbers = (*machine.letters, IMPOSSIBLE)
        letters = tuple([numbers[group] for group in clocked.groups])
        return replace(machine, reads=clocked.reads, letters=letters)


def _with_last_clock(table: MealyMonitor, codes: Sequence[int], span: Range) -> MealyMonitor:
    """The table beside the last clock that it reads, over what it reads else.

    Of what the clock holds only that is kept which can matter. So states multiply only where the
    table really waits for both. Raises SizeError.
    """
    half = len(table.letters) // 2
    members: dict[tuple[int, int, int], list[int]] = {}
    each = zip(codes, table.letters[:half], table.letters[half:], strict=False)
    for letter, key in enumerate(each):
        members.setdefault(key, []).append(letter)
    # By the class that is read if the clock is not due, and if it is: the letters, as bits
    moves: dict[tuple[int, int, int], int] = {}
    for (code, *classes), letters in members.items():
        values = [register_after(span, due << 1, *_SIDES[code]) & 1 for due in (0, 1)]
        idle, due = (classes[value] for value in values)
        if IMPOSSIBLE not in (idle, due):
            move = code, idle, due
            moves[move] = moves.get(move, 0) | bits_at(letters)
    reach = _until_it_matters(table, moves)
    after = cache(partial(register_after, span))
    numbers = {(0, Register.at_first): 0}
    rows, outputs = [], []
    for state, held in (reached := list(numbers)):
        is_due, row = held >> 1 & 1, []
        symbols = [move[1 + is_due] for move in moves]
        for (code, *_), symbol in zip(moves, symbols, strict=True):
            target = table.successors[state][symbol]
            later = 0
            if target in reach:
                later = after(held, *_SIDES[code]) & -1 << reach[target]
            pair = target, later
            if pair not in numbers:
                numbers[pair] = len(reached)
                reached.append(pair)
            row.append(numbers[pair])
        rows.append(row)
        outputs.append([table.outputs[state][symbol] for symbol in symbols])
        if len(reached) > MOST_PAIRS:
            raise SizeError
    return build_machine(VerdictTable([*moves.values()], rows, outputs), (), half)


def _until_it_matters(table: MealyMonitor, moves: Iterable[tuple[int, int, int]]) -> dict[int, int]:
    """For each state after how many letters it may matter whether the clock has been due since.

    States from which it never does are left out: the clock is reset, or the table goes on alike.
    """
    before: dict[int, set[int]] = {}
    apart: dict[int, int] = {}
    for state, (targets, verdicts) in enumerate(zip(table.successors, table.outputs, strict=True)):
        for code, idle, due in moves:
            if (targets[idle], verdicts[idle]) != (targets[due], verdicts[due]):
                apart[state] = 1
            if code & 1:
                before.setdefault(targets[idle], set()).add(state)
                before.setdefault(targets[due], set()).add(state)
    for state in (waiting := list(apart)):
        for earlier in before.get(state, ()):
            if earlier not in apart:
                apart[earlier] = apart[state] + 1
                waiting.append(earlier)
    return apart


def _settled(machine: MealyMonitor) -> MealyMonitor:
    """The machine whose verdicts are about the last letter repeated until the clocks have run."""
    columns = zip(
        zip(*machine.successors, strict=True), zip(*machine.outputs, strict=True), strict=True
    )
    settled = [loop_verdicts(list(zip(*column, strict=True)), bool) for column in columns]
    members: list[list[int]] = [[] for _ in settled]
    for letter, number in enumerate(machine.letters):
        members[number].append(letter)
    classes = [bits_at(letters) for letters in members]
    outputs = [list(row) for row in zip(*settled, strict=True)]
    rows = VerdictTable(classes, machine.successors, outputs)
    return build_machine(rows, (), len(machine.letters))
