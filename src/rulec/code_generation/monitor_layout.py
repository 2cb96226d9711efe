"""Memory layout of a generated monitor: seats, reads, cells, entries, instances.

A rule has an instance for each choice of seats for its variables. Objects of a type sit on the
seats of the nearest supertype (or the type itself) that has a bound.

A rule's letters become a reduced ordered decision diagram with a node for each read that still
matters, in cells of an array (R. E. Bryant, "Graph-based algorithms for Boolean function
manipulation", 1986; for several values: A. Srinivasan et al., "Algorithms for discrete function
manipulation", 1990). A table of 61,440 letters becomes about a hundred cells, and only the reads on
one path are evaluated.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import IMPOSSIBLE, NumberRead, Read
from rulec.code_generation.code_messages import too_large
from rulec.code_generation.input_fields import InputFields, input_fields
from rulec.code_generation.reading_code import ReadingCode
from rulec.diagnostics import did_you_mean
from rulec.logic.free_names import variables_of
from rulec.monitoring.online.four_valued import WORST_FIRST, four_valued
from rulec.vocabulary import Vocabulary

USUAL_SEATS = 16
"""For objects of each type that has no supertype."""

MOST_SEATS = 4096
MOST_VARIABLES = 6
MOST_STATES = (1 << 14) - 1
MOST_INSTANCES = (1 << 16) - 1
MOST_READS = 1 << 12

WORLD, OWN, TOGETHER = 0, 1, 7
"""Sources of digits: no object; the first variable's object (others follow); several objects."""

VERDICTS = WORST_FIRST[::-1]
"""The verdicts in the order of their numbers in C; 0 is the best."""


@dataclass(frozen=True)
class RuleLayout:
    """A rule's part of all arrays.

    ``seats`` are, for each variable, the first seat that its objects may have and the one after the
    last. ``reads`` are the source and the place of each read's digits. ``together`` are the places
    of reads about several objects.
    """

    rule: CompiledRule
    cells: tuple[int, ...]
    entries: tuple[int, ...]
    seats: tuple[tuple[int, int], ...]
    reads: tuple[tuple[int, int], ...]
    together: tuple[int, ...]

    @property
    def about(self) -> str:
        """The rule's strength, and the article that it cites."""
        return f"{self.rule.strength}; {self.rule.cite}" if self.rule.cite else self.rule.strength

    @property
    def n_instances(self) -> int:
        """The number of choices of seats."""
        return prod(end - first for first, end in self.seats)

    @property
    def n_words(self) -> int:
        """The number of 32-bit words for the sets of states of all instances."""
        return self.n_instances * (len(self.rule.machine.successors) // 32 + 1)

    @property
    def start(self) -> int:
        """The verdict before the first state."""
        return VERDICTS.index(
            "satisfied" if self.rule.machine.accepting_sink == 0 else "holds so far"
        )


@dataclass(frozen=True, eq=False)
class MonitorLayout:
    """A monitor, without its text.

    ``seats`` are, by type, the first seat for its objects and the one after the last. ``digits``
    are expressions for the reads about no object, about one (at the place ``one``) and about
    several (at the places ``who``); ``sizes`` are their numbers of digits. ``definitions`` are what
    the expressions use.
    """

    rulebook: CompiledRulebook
    fields: InputFields
    seats: Mapping[str, tuple[int, int]]
    rules: tuple[RuleLayout, ...]
    digits: tuple[tuple[str, ...], ...]
    sizes: tuple[tuple[int, ...], ...]
    definitions: tuple[str, ...]

    @property
    def n_seats(self) -> int:
        """The number of seats."""
        return max(end for _, end in self.seats.values())

    @property
    def array_sizes(self) -> dict[str, int]:
        """The sizes of arrays, by their names in the code; no array is empty."""
        rules = self.rules
        machines = [own.rule.machine for own in rules]
        places = (1 << max(0, max(map(len, self.sizes)) - 1).bit_length()) - 1
        cell_words = max(len(own.cells) for own in rules) // 32 + 1
        return {
            "RULES": len(rules),
            "TYPES": len(self.fields.types),
            "SEATS": self.n_seats,
            "VARIABLES": self.n_variables,
            "INSTANCES": sum(own.n_instances for own in rules) or 1,
            "WORDS": sum(own.n_words for own in rules) or 1,
            "WORLD_READS": len(self.sizes[0]) or 1,
            "OWN_READS": len(self.sizes[1]) or 1,
            "SHARED_READS": len(self.sizes[2]) or 1,
            "CELL_WORDS": cell_words,
            "NODES": cell_words * 32,
            "ENTRIES": sum(len(own.entries) for own in rules),
            "PLACES": places,
            # The array ends after the highest index that a place of valid width can have.
            "DIGITS": self.n_own_digits + places + 1,
            "MOST_DIGIT": max([size for sizes in self.sizes for size in sizes], default=1) - 1,
            "CLASS_WORDS": max(len(machine.successors[0]) for machine in machines) // 32 + 1,
            "STATE_WORDS": max(len(machine.successors) for machine in machines) // 32 + 1,
        }

    @property
    def n_own_digits(self) -> int:
        """How many digits are about the world or an object on a seat; those of several follow."""
        world, own, _ = (len(sizes) or 1 for sizes in self.sizes)
        return world + self.n_seats * own

    @property
    def n_variables(self) -> int:
        """The most variables of any rule, at least 1."""
        return max(1, *[len(own.seats) for own in self.rules])


def monitor_layout(rulebook: CompiledRulebook, bounds: Mapping[str, int]) -> MonitorLayout:
    """The layout for a rulebook, at one step.

    ``bounds`` are the most objects present at a time, by type. Raises RulecError R0750.
    """
    rulebook = rulebook.at_one_step()
    if not rulebook.rules:
        raise too_large(f"rulebook `{rulebook.name}` has no rules", "choose a rulebook with rules")
    fields = input_fields(rulebook)
    seats = _seats(fields, bounds)
    placing = _Placing(ReadingCode(fields), fields, seats)
    rules = tuple([placing.rule(rule) for rule in rulebook.rules])
    if sum(own.n_instances for own in rules) > MOST_INSTANCES:
        raise too_large(
            f"its rules have {sum(own.n_instances for own in rules):,} choices of objects, "
            f"at most {MOST_INSTANCES:,}",
            "allow fewer objects with `--objects`",
        )
    return MonitorLayout(
        rulebook,
        fields,
        seats,
        rules,
        digits=tuple([tuple(own) for own in placing.places]),
        sizes=tuple([tuple(own.values()) for own in placing.places]),
        definitions=tuple(placing.code.definitions),
    )


def _seats(fields: InputFields, bounds: Mapping[str, int]) -> dict[str, tuple[int, int]]:
    """The seats for objects of each type: those of the nearest type with a bound."""
    vocabulary = fields.vocabulary
    kinds = fields.types
    unknown = [kind for kind in bounds if kind not in kinds]
    if unknown:
        raise too_large(
            f"`--objects` names the type `{unknown[0]}`, which vocabulary `{vocabulary.name}` "
            f"does not know",
            did_you_mean(unknown[0], kinds) or f"known: {', '.join(kinds)}",
        )
    if any(not 0 < bound <= MOST_SEATS for bound in bounds.values()):
        raise too_large(f"a bound on objects must be from 1 to {MOST_SEATS}", "change `--objects`")
    usual = {kind: USUAL_SEATS for kind in kinds if _parent(kind, vocabulary) is None}
    bounds = usual | dict(bounds)
    seats: dict[str, tuple[int, int]] = {}
    end = 0
    # A type's seats are followed by those of its subtypes, so that each has one range.
    for kind in sorted(
        kinds, key=lambda kind: [kinds.index(above) for above in _above(kind, fields)]
    ):
        parent = _parent(kind, vocabulary)
        if kind in bounds:
            seats[kind] = end, end + bounds[kind]
            end = seats[kind][1]
        else:
            seats[kind] = seats[parent] if parent is not None else (0, 0)
    return seats


def _parent(kind: str, vocabulary: Vocabulary) -> str | None:
    return vocabulary.types[kind].parent if kind in vocabulary.types else None


def _above(kind: str, fields: InputFields) -> list[str]:
    """The types from the root down to this one."""
    if kind not in fields.vocabulary.types:
        return [kind]
    return list(fields.vocabulary.ancestors(kind))[::-1]


class _Placing:
    """Assigns places to reads as rules need them: ``places`` by source, expression to size."""

    def __init__(
        self, code: ReadingCode, fields: InputFields, seats: Mapping[str, tuple[int, int]]
    ) -> None:
        self.code = code
        self.places: tuple[dict[str, int], dict[str, int], dict[str, int]] = ({}, {}, {})
        self._fields = fields
        self._seats = seats

    def rule(self, rule: CompiledRule) -> RuleLayout:
        """The layout of a rule."""
        machine, subject = rule.machine, f"rule `{rule.name}` has"
        if len(rule.variables) > MOST_VARIABLES:
            raise too_large(f"{subject} {len(rule.variables)} variables, at most {MOST_VARIABLES}")
        if len(machine.successors) > MOST_STATES:
            raise too_large(f"{subject} {len(machine.successors)} states, at most {MOST_STATES}")
        reads = [self._placed(read, rule) for read in machine.reads]
        of_nobody = {number for number, (source, _) in enumerate(reads) if source == WORLD}
        cells = letter_cells(machine.letters, [read.size for read in machine.reads], of_nobody)
        if len(cells) >= LEAF or len(machine.successors[0]) >= LEAF - 1:
            raise too_large(f"{subject} too many different letters")
        at = 1
        while at < len(cells):
            read = cells[at]
            source, place = reads[read]
            cells[at] = source << 12 | place
            at += 1 + machine.reads[read].size
        entries = [
            target << 2 | VERDICTS.index(four_valued(machine, target, accepted))
            for targets, row in zip(machine.successors, machine.outputs, strict=True)
            for target, accepted in zip(targets, row, strict=True)
        ]
        return RuleLayout(
            rule,
            cells=tuple(cells),
            entries=tuple(entries),
            seats=tuple([self._seats_of(variable.type) for variable in rule.variables]),
            reads=tuple(reads),
            together=tuple(dict.fromkeys(place for source, place in reads if source == TOGETHER)),
        )

    def _placed(self, read: Read | NumberRead, rule: CompiledRule) -> tuple[int, int]:
        """The source of a read's digits, and their place there."""
        names = [variable.name for variable in rule.variables]
        if isinstance(read, Read):
            used = set(read.variables)
        else:
            used = {name for _, term in read.terms for name in variables_of(term)}
        if len(used) > 1:
            kind, source = 2, TOGETHER
            places = {name: self.code.place_of(number) for number, name in enumerate(names)}
        else:
            kind = len(used)
            source = OWN + names.index(used.pop()) if used else WORLD
            places = dict.fromkeys(names, "one")
        known = self.places[kind]
        expression = self.code.digits(read, places)
        known.setdefault(expression, read.size)
        if len(known) > MOST_READS:
            raise too_large(
                f"its rules read {len(known):,} different values, at most {MOST_READS:,}"
            )
        return source, list(known).index(expression)

    def _seats_of(self, kind: str) -> tuple[int, int]:
        """A range that contains the seats of all objects of a type, and perhaps others."""
        vocabulary = self._fields.vocabulary
        stretches = [
            self._seats[own] for own in vocabulary.types if vocabulary.is_subtype(own, kind)
        ]
        taken = [stretch for stretch in stretches if stretch[0] < stretch[1]] or [(0, 0)]
        return min(first for first, _ in taken), max(end for _, end in taken)


LEAF = 0x8000
"""Cells from this value on are a class, or ``EXCLUDED``."""

EXCLUDED = 0xFFFF
"""The cell of letters that facts exclude."""

Cells = list[int]
"""The first cell is the start of the diagram: a node, or a leaf.

A node is a cell with the place of its read, followed by a cell for each digit: the next node,
always further on in the array, or a leaf.
"""


MOST_CELLS = 2000
"""Of 16 bits each: less than 4 kB per rule."""


def letter_cells(
    letters: Sequence[int], sizes: Sequence[int], of_nobody: Collection[int] = ()
) -> Cells:
    """The diagram of letters in mixed radix, whose first read counts ones.

    ``sizes`` are the numbers of digits of each read. Reads that are ``of_nobody`` (of no object)
    come first, so that they are evaluated once for all objects, unless that takes more than
    ``MOST_CELLS``. Of two orders of the reads the one with fewer cells is chosen.
    """
    table = np.array(letters, dtype=np.int64).reshape(tuple(reversed(sizes))).transpose()
    order = list(range(len(sizes)))
    orders = order, order[::-1]
    first = [sorted(read_order, key=lambda read: read not in of_nobody) for read_order in orders]
    shared = min((_cells(table, read_order) for read_order in first), key=len)
    if len(shared) <= MOST_CELLS:
        return shared
    return min((_cells(table, read_order) for read_order in orders), key=len)


def _cells(table: NDArray[np.int64], order: Sequence[int]) -> Cells:
    """The diagram that tests reads in this order."""
    sizes = [table.shape[read] for read in order]
    flat = table.transpose(order).ravel()
    # Leaves are negative; nodes are numbered, lower levels first.
    below: NDArray[Any] = -(flat + 2)
    nodes: list[tuple[int, list[int]]] = []
    for read, size in reversed(list(zip(order, sizes, strict=True))):
        rows, places = np.unique(below.reshape(-1, size), axis=0, return_inverse=True)
        own = rows[:, 0].copy()
        for number, row in enumerate(rows.tolist()):
            if len(set(row)) > 1:
                own[number] = len(nodes)
                nodes.append((read, row))
        below = own[places.ravel()]
    starts: dict[int, int] = {}
    end = 1
    for number in range(len(nodes) - 1, -1, -1):
        starts[number] = end
        end += 1 + len(nodes[number][1])

    def cell(child: int) -> int:
        if child >= 0:
            return starts[child]
        return EXCLUDED if -child - 2 == IMPOSSIBLE else LEAF - child - 2

    cells = [cell(int(below[0]))]
    for read, row in reversed(nodes):
        cells += [read, *map(cell, row)]
    return cells
