"""Tables of formulas whose past is in registers, from a table that reads the registers' values.

The small table is the same for bounds of any length. Here it runs beside its registers, which gives
the table for letters alone. No formula is looked at again, so a bound costs states but hardly time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import product

from rulec.automata.compiler_jobs import MOST_EDGES, MOST_STATES, SizeError
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.automata.tables import VerdictTable, loop_verdicts, places_of
from rulec.logic.fold import bit_sets, fold
from rulec.logic.formula import Formula, Proposition
from rulec.logic.past_registers import Register

MOST_REGISTERS = 8
"""The small table has a letter for each set of registers that hold."""

_SIDES = ((True, True), (True, False), (False, True), (False, False))
"""The values of a register's left and right operand."""

_Due = tuple[int, ...]
"""For each register whether it holds its proposition true, if its left operand is."""

_Operands = tuple[tuple[bool, bool], ...]
"""For each register the values of its operands."""


@dataclass(frozen=True)
class Skeleton:
    """A formula over parts about the present state and over registers.

    ``rest`` is the same over the parts' own propositions. ``groups``: letters that no part tells
    apart, as bit sets, in the order of their least letters. ``true_in`` has for each part, and each
    proposition, the groups in whose least letter it holds, as bits. A letter of the small table is
    a group and a value of each register: ``group + n_groups * values``, values as bits.
    """

    present: Formula
    rest: Formula
    registers: tuple[Register, ...]
    groups: tuple[int, ...]
    true_in: Mapping[Proposition, int]

    @property
    def n_letters(self) -> int:
        """The number of the small table's letters."""
        return len(self.groups) << len(self.registers)

    @cached_property
    def letters_with(self) -> dict[Proposition, int]:
        """The letters of the small table in which each part, proposition and register is true."""
        n_groups, n_values = len(self.groups), 1 << len(self.registers)
        every = (1 << n_groups) - 1
        sets: dict[Proposition, int] = {}
        for part, groups in self.true_in.items():
            sets[part] = sum([groups << (n_groups * values) for values in range(n_values)])
        for place, register in enumerate(self.registers):
            true = [values for values in range(n_values) if values >> place & 1]
            sets[register.atom] = sum([every << (n_groups * values) for values in true])
        return sets

    @cached_property
    def steps(self) -> dict[_Due, list[tuple[int, int, _Operands]]]:
        """For what registers hold: groups as bits, the registers' values, and their operands."""
        return {due: list(self._steps(due)) for due in product((0, 1), repeat=len(self.registers))}

    def _steps(self, due: _Due) -> Iterator[tuple[int, int, _Operands]]:
        every = (1 << len(self.groups)) - 1
        true_in = dict(self.true_in)
        split: list[tuple[int, int, _Operands]] = [(every, 0, ())]
        for place, register in enumerate(self.registers):
            algebra = bit_sets(true_in, every)
            left, right = (fold(side, algebra) for side in (register.left, register.right))
            finer, true = [], 0
            for sides in _SIDES:
                inside = (left if sides[0] else every ^ left) & (
                    right if sides[1] else every ^ right
                )
                value = register.after(due[place] << 1, *sides) & 1
                true |= inside if value else 0
                finer += [
                    (both, values | value << place, (*operands, sides))
                    for groups, values, operands in split
                    if (both := groups & inside)
                ]
            true_in[register.atom] = true
            split = finer
        yield from split

    @cached_property
    def possible(self) -> int:
        """The letters of the small table that can come, as bits."""
        steps = [(groups, values) for step in self.steps.values() for groups, values, _ in step]
        found = 0
        for groups, values in steps:
            found |= groups << (len(self.groups) * values)
        return found


@dataclass(frozen=True, slots=True)
class _Move:
    """Groups, as bits, for which the small table reads one class, and registers their operands."""

    groups: int
    symbol: int
    operands: _Operands


def with_registers(small: MealyMonitor, skeleton: Skeleton, *, ends: bool) -> VerdictTable:
    """The table for letters from the small table; ``ends`` if nothing follows a word.

    Raises SizeError.
    """
    registers = skeleton.registers
    moves = {due: _moves(steps, small, skeleton) for due, steps in skeleton.steps.items()}
    at_first = tuple([register.at_first for register in registers])
    sinks = {small.rejecting_sink, small.accepting_sink}
    after = [cache(register.after) for register in registers]
    numbers = {(0, at_first): 0}
    rows: list[tuple[int, _Due, list[int]]] = []
    n_edges = 0
    for state, held in (reached := list(numbers)):
        due = tuple([value >> 1 & 1 for value in held])
        row = []
        for move in moves[due]:
            target, later = small.successors[state][move.symbol], at_first
            if target not in sinks:
                # In a sink the past makes no difference.
                each = zip(after, held, move.operands, strict=True)
                later = tuple([advance(value, *sides) for advance, value, sides in each])
            pair = target, later
            if pair not in numbers:
                numbers[pair] = len(reached)
                reached.append(pair)
            row.append(numbers[pair])
        rows.append((state, due, row))
        n_edges += len(row)
        if len(reached) > MOST_STATES or n_edges > MOST_EDGES:
            raise SizeError
    met = {due: _places(moves[due], len(skeleton.groups)) for due in {due for _, due, _ in rows}}
    # Groups that are told apart nowhere form a class.
    members: dict[tuple[int, ...], int] = {}
    for letters, key in zip(skeleton.groups, zip(*met.values(), strict=True), strict=True):
        members[key] = members.get(key, 0) | letters
    place_of = {due: [key[place] for key in members] for place, due in enumerate(met)}
    successors = [[row[place] for place in place_of[due]] for _, due, row in rows]
    verdicts = [
        [small.outputs[state][moves[due][place].symbol] for place in place_of[due]]
        for state, due, _ in rows
    ]
    if not ends:
        # A letter that is repeated settles the registers sooner or later.
        columns = zip(zip(*successors, strict=True), zip(*verdicts, strict=True), strict=True)
        settled = [loop_verdicts(list(zip(*column, strict=True)), bool) for column in columns]
        verdicts = [list(row) for row in zip(*settled, strict=True)]
    return VerdictTable(list(members.values()), successors, verdicts)


def _moves(
    steps: Sequence[tuple[int, int, _Operands]], small: MealyMonitor, skeleton: Skeleton
) -> list[_Move]:
    moves: dict[tuple[int, _Operands], int] = {}
    for groups, values, operands in steps:
        first = len(skeleton.groups) * values
        for group in places_of(groups):
            key = small.letters[first + group], operands
            moves[key] = moves.get(key, 0) | 1 << group
    return [_Move(groups, symbol, operands) for (symbol, operands), groups in moves.items()]


def _places(moves: Sequence[_Move], n_groups: int) -> list[int]:
    """For each group the place of its move."""
    result = [0] * n_groups
    for place, move in enumerate(moves):
        for group in places_of(move.groups):
            result[group] = place
    return result
