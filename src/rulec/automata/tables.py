"""From a deterministic automaton to the smallest table.

Repeating the last letter for ever turns acceptance into a table: repeating a letter from a state
leads into one cycle, whose colours decide. For words that end, the end is repeated for ever
instead. Letters with equal columns are merged, then states that no word distinguishes.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import or_
from typing import TypeVar

from rulec.automata.alphabet import count_letters
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Read, sink_of

Output = TypeVar("Output")

MOST_STATES, MOST_EDGES = 20_000, 1_000_000
"""The most of an automaton while it is built, whatever it is reduced to: sizes, not times, so that
the same rules can be compiled on every machine."""

MOST_STEPS_AHEAD = 10_000
"""An automaton has at least one state per step of a bound; more steps cannot be built in time."""


class SizeError(Exception):
    """An automaton gets more than ``MOST_STATES`` or ``MOST_EDGES``, or ``MOST_STEPS_AHEAD``."""


@dataclass(frozen=True, slots=True)
class TableEdge:
    """An edge of an automaton; ``letters`` and ``colours`` are bit sets."""

    letters: int
    target: int
    colours: int


@dataclass(frozen=True, slots=True)
class DeterministicAutomaton:
    """A complete deterministic automaton over letters, starting in state ``initial``.

    ``accepts`` maps the bit set of colours seen infinitely often to whether a run is accepting.
    ``after_the_end`` is for words that end: for each state the target and colours of the edge that
    is taken after the end; None if the last letter of a word is repeated for ever.
    """

    edges: tuple[tuple[TableEdge, ...], ...]
    initial: int
    accepts: Callable[[int], bool]
    after_the_end: tuple[tuple[int, int], ...] | None = None


@dataclass(frozen=True, slots=True)
class VerdictTable:
    """A complete deterministic table: letters of each class as bits, targets and verdicts by state.

    Classes are in the order of their smallest letters.
    """

    classes: Sequence[int]
    successors: Sequence[Sequence[int]]
    outputs: Sequence[Sequence[bool]]
    initial: int = 0


def rows_of(automaton: DeterministicAutomaton, possible: int) -> VerdictTable:
    """The verdicts of an automaton as a table.

    ``possible`` is the bit set of the letters (at least one) that states can have.
    """
    classes = sorted(_letter_classes(automaton, possible), key=lambda members: members & -members)
    return VerdictTable(classes, *_tables(automaton, classes), automaton.initial)


def build_machine(
    rows: VerdictTable, reads: tuple[Read | NumberRead, ...], n_letters: int | None = None
) -> MealyMonitor:
    """The minimal machine of a table over the letters of ``reads``, or over so many letters.

    The result, including its numbering, is the same for every table of the same language:
    classes are numbered by their smallest letter, states in breadth-first order.
    """
    classes = rows.classes
    successors, outputs = minimise(rows.successors, rows.outputs, rows.initial)
    columns = list(zip(*successors, *outputs, strict=True))
    merged = {column: index for index, column in enumerate(dict.fromkeys(columns))}
    kept = [columns.index(column) for column in merged]
    letters = [IMPOSSIBLE] * (n_letters or count_letters(reads))
    for members, column in zip(classes, columns, strict=True):
        number = merged[column]
        for letter in places_of(members):
            letters[letter] = number
    return MealyMonitor(
        reads,
        tuple(letters),
        tuple(tuple(row[c] for c in kept) for row in successors),
        tuple(tuple(row[c] for c in kept) for row in outputs),
        rejecting_sink=sink_of(successors, outputs, verdict=False),
        accepting_sink=sink_of(successors, outputs, verdict=True),
    )


def bits_at(places: Sequence[int]) -> int:
    """The bit set of some places (at least one, ascending), in linear time."""
    row = bytearray(places[-1] // 8 + 1)
    for place in places:
        row[place // 8] |= 1 << place % 8
    return int.from_bytes(row, "little")


def places_of(members: int) -> Iterator[int]:
    """The positions of the set bits; removing them one by one would be quadratic for large sets."""
    digits = f"{members:b}"[::-1]
    place = digits.find("1")
    while place >= 0:
        yield place
        place = digits.find("1", place + 1)


def _letter_classes(automaton: DeterministicAutomaton, met: int) -> list[int]:
    """The coarsest partition of the letters that every edge respects, as bit sets."""
    classes = [met]
    for letters in {edge.letters for edges in automaton.edges for edge in edges}:
        refined = []
        for members in classes:
            inside = members & letters
            refined += [part for part in (inside, members ^ inside) if part]
        classes = refined
    return classes


def _tables(
    automaton: DeterministicAutomaton, classes: Sequence[int]
) -> tuple[list[tuple[int, ...]], list[tuple[bool, ...]]]:
    targets: list[list[int]] = []
    verdicts: list[list[bool]] = []
    over = automaton.after_the_end
    ends_well = None if over is None else loop_verdicts(over, automaton.accepts)
    firsts = [members & -members for members in classes]
    # Far fewer sets of letters than edges have them, and each may have 100,000 bits.
    labels = {edge.letters for edges in automaton.edges for edge in edges}
    within = {
        label: [place for place, first in enumerate(firsts) if label & first] for label in labels
    }
    rows = []
    for edges in automaton.edges:
        taken = {place: edge for edge in reversed(edges) for place in within[edge.letters]}
        rows.append([(edge.target, edge.colours) for _, edge in sorted(taken.items())])
    for step in zip(*rows, strict=True):
        targets.append([target for target, _ in step])
        if ends_well is None:
            verdicts.append(loop_verdicts(step, automaton.accepts))
        else:
            verdicts.append([ends_well[target] for target, _ in step])
    return list(zip(*targets, strict=True)), list(zip(*verdicts, strict=True))


def loop_verdicts(step: Sequence[tuple[int, int]], accepts: Callable[[int], bool]) -> list[bool]:
    """For each state, whether repeating one letter for ever is accepted.

    ``step`` has each state's target and colours; ``accepts`` is about all colours of a loop.
    """
    verdicts: dict[int, bool] = {}
    for first in range(len(step)):
        path: dict[int, int] = {}
        state = first
        while state not in verdicts and state not in path:
            path[state] = len(path)
            state = step[state][0]
        if state in path:
            cycle = list(path)[path[state] :]
            verdicts[state] = accepts(reduce(or_, (step[member][1] for member in cycle)))
        verdicts.update(dict.fromkeys(path, verdicts[state]))
    return [verdicts[state] for state in range(len(step))]


def minimise(
    successors: Sequence[Sequence[int]], outputs: Sequence[Sequence[Output]], initial: int
) -> tuple[list[list[int]], list[Sequence[Output]]]:
    """Merge equivalent states; number the rest in breadth-first order from ``initial``.

    States with different outputs (verdicts) are different.
    """

    def after(state: int, blocks: Sequence[int]) -> Hashable:
        return tuple(map(blocks.__getitem__, successors[state]))

    blocks = refined([tuple(row) for row in outputs], successors, after)
    representative: dict[int, int] = {}
    for state, block in enumerate(blocks):
        representative.setdefault(block, state)
    position = {blocks[initial]: 0}
    rows = [representative[blocks[initial]]]
    for state in rows:
        for target in successors[state]:
            if blocks[target] not in position:
                position[blocks[target]] = len(rows)
                rows.append(representative[blocks[target]])
    return (
        [[position[blocks[t]] for t in successors[row]] for row in rows],
        [outputs[row] for row in rows],
    )


def refined(
    kinds: Sequence[Hashable],
    targets_of: Sequence[Iterable[int]],
    after: Callable[[int, Sequence[int]], Hashable],
) -> list[int]:
    """For each state a block, equal for states of one kind that agree in what comes ``after`` them.

    Moore's partition refinement. ``after`` depends on the blocks of a state's targets. When a block
    splits, its largest part keeps its number, so that only states with a target in one of the
    others are looked at again: each about log n times (Hopcroft, *An n log n algorithm for
    minimizing states in a finite automaton*, 1971). Else a chain of counted steps, whose states
    all differ, would take quadratic time.
    """
    numbers: dict[Hashable, int] = {}
    blocks = [numbers.setdefault(kind, len(numbers)) for kind in kinds]
    before: list[set[int]] = [set() for _ in blocks]
    for state, targets in enumerate(targets_of):
        for target in set(targets):
            before[target].add(state)
    members: dict[int, set[int]] = {}
    for state, block in enumerate(blocks):
        members.setdefault(block, set()).add(state)
    changed = set(range(len(blocks)))
    while changed:
        parts: dict[int, dict[Hashable, list[int]]] = {}
        for state in changed:
            parts.setdefault(blocks[state], {}).setdefault(after(state, blocks), []).append(state)
        moved: list[int] = []
        for block, by_target in parts.items():
            apart = sorted(map(set, by_target.values()), key=len)
            # Those that were not looked at still agree with each other, and with none of these.
            others = members[block]
            others.difference_update(*apart)
            if len(others) < len(apart[-1]):
                members[block] = apart.pop()
                apart += [others] if others else []
            for part in apart:
                number = len(members)
                members[number] = part
                moved += part
                for state in part:
                    blocks[state] = number
        changed = {state for target in moved for state in before[target]}
    return blocks
