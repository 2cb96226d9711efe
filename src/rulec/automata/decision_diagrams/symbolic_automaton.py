"""Deterministic automata whose edges carry functions of letters, and operations on them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeVar

from rulec.automata.compiler_jobs import BeyondReachError
from rulec.automata.decision_diagrams.diagrams import FALSE, TRUE, Diagrams
from rulec.automata.tables import MOST_EDGES, MOST_STATES, SizeError, refined
from rulec.logic.past_registers import Register

Edges: TypeAlias = Mapping[tuple[int, int], int]
"""The letters of each edge, as a function, by its target and its marks (as bits)."""

MOST_MARKS = 8
"""All combinations of marks are enumerated."""

State = TypeVar("State")

Connective: TypeAlias = Callable[[bool, bool], bool]


@dataclass(frozen=True, slots=True)
class SymbolicAutomaton:
    """A complete deterministic automaton that begins in state 0.

    On infinite words ``accepts`` maps the recurring marks (as bits) to whether a run is accepting.
    The automaton is weak if there is one mark, and no cycle has edges both with and without it. On
    finite words, which have no marks, ``ends_well`` says for each state whether a word may end
    there; on infinite words it is None.
    """

    edges: tuple[Edges, ...]
    ends_well: tuple[bool, ...] | None = None
    n_marks: int = 1
    accepts: Callable[[int], bool] = bool
    is_weak: bool = True


def explored(
    first: State, step: Callable[[State], Iterable[tuple[State, int, int]]]
) -> tuple[list[State], list[dict[tuple[int, int], int]]]:
    """All reachable states, and the edges of each.

    ``step`` yields a state's edges as target, marks and letters; the letters of two edges are
    disjoint. Raises SizeError.
    """
    n_edges = 0
    states = [first]
    numbers = {first: 0}
    rows = []
    for state in states:
        row: dict[tuple[int, int], int] = {}
        for target, marks, letters in step(state):
            if target not in numbers:
                numbers[target] = len(states)
                states.append(target)
            row[numbers[target], marks] = letters
        rows.append(row)
        n_edges += len(row)
        if len(states) > MOST_STATES or n_edges > MOST_EDGES:
            raise SizeError
    return states, rows


def negated(automaton: SymbolicAutomaton) -> SymbolicAutomaton:
    """The automaton of the complement language."""
    if automaton.ends_well is not None:
        return replace(automaton, ends_well=tuple([not well for well in automaton.ends_well]))
    if automaton.is_weak:
        rows = [
            {(target, 1 - marks): letters for (target, marks), letters in row.items()}
            for row in automaton.edges
        ]
        return replace(automaton, edges=tuple(rows))
    accepts = automaton.accepts
    return replace(automaton, accepts=lambda marks: not accepts(marks))


def joined(
    left: SymbolicAutomaton,
    right: SymbolicAutomaton,
    connective: Connective,
    diagrams: Diagrams,
) -> SymbolicAutomaton:
    """The automaton of the words whose verdicts by both automata satisfy ``connective``.

    Raises BeyondReachError for more than ``MOST_MARKS``.
    """
    if left.n_marks + right.n_marks > MOST_MARKS:
        raise BeyondReachError
    are_weak = left.is_weak and right.is_weak
    ends = left.ends_well is not None

    def step(state: tuple[int, int]) -> Iterable[tuple[tuple[int, int], int, int]]:
        edges: dict[tuple[tuple[int, int], int], int] = {}
        for (first, own), letters in left.edges[state[0]].items():
            for (second, others), more in right.edges[state[1]].items():
                met = diagrams.both(letters, more)
                if met != FALSE:
                    marks = own | others << left.n_marks
                    if are_weak:
                        marks = 0 if ends else int(connective(bool(own), bool(others)))
                    key = (first, second), marks
                    edges[key] = diagrams.either(edges.get(key, FALSE), met)
        return [(target, marks, letters) for (target, marks), letters in edges.items()]

    states, rows = explored((0, 0), step)
    if left.ends_well is not None and right.ends_well is not None:
        ends_well = tuple([connective(left.ends_well[a], right.ends_well[b]) for a, b in states])
        return merged(SymbolicAutomaton(tuple(rows), ends_well), diagrams)
    if are_weak:
        return merged(SymbolicAutomaton(tuple(rows)), diagrams)
    own_marks, n_marks = (1 << left.n_marks) - 1, left.n_marks
    first_accepts, second_accepts = left.accepts, right.accepts
    return merged(
        SymbolicAutomaton(
            tuple(rows),
            n_marks=n_marks + right.n_marks,
            accepts=lambda marks: connective(
                first_accepts(marks & own_marks), second_accepts(marks >> n_marks)
            ),
            is_weak=False,
        ),
        diagrams,
    )


def merged(automaton: SymbolicAutomaton, diagrams: Diagrams) -> SymbolicAutomaton:
    """The automaton with states merged that no word distinguishes by its marks or its end."""

    def after(state: int, blocks: Sequence[int]) -> Hashable:
        return frozenset(_regrouped(automaton.edges[state], blocks, diagrams).items())

    ends = automaton.ends_well or [False] * len(automaton.edges)
    targets = [[target for target, _ in row] for row in automaton.edges]
    blocks = refined(ends, targets, after)
    # Numbered by first appearance, so the first state gets 0.
    numbers = {block: number for number, block in enumerate(dict.fromkeys(blocks))}
    if len(numbers) == len(blocks):
        return automaton
    kept = [blocks.index(block) for block in numbers]
    of = [numbers[block] for block in blocks]
    return replace(
        automaton,
        edges=tuple([_regrouped(automaton.edges[state], of, diagrams) for state in kept]),
        ends_well=automaton.ends_well and tuple([automaton.ends_well[state] for state in kept]),
    )


def _regrouped(row: Edges, blocks: Sequence[int], diagrams: Diagrams) -> dict[tuple[int, int], int]:
    regrouped: dict[tuple[int, int], int] = {}
    for (target, marks), letters in row.items():
        key = blocks[target], marks
        regrouped[key] = diagrams.either(regrouped[key], letters) if key in regrouped else letters
    return regrouped


def with_registers(
    automaton: SymbolicAutomaton, registers: Sequence[Register], diagrams: Diagrams
) -> SymbolicAutomaton:
    """The product of the automaton and registers of the past; the registers' atoms disappear.

    A state combines a state of the automaton and one of each register. These and a letter determine
    the registers' values, by them the automaton's edge, and the registers' next states. In a state
    that is never left the past makes no difference.
    """
    nothing = tuple([register.at_first for register in registers])
    never_left = [
        len(row) == 1 and next(iter(row))[0] == state for state, row in enumerate(automaton.edges)
    ]
    operands = [
        (register, diagrams.of_state(register.left), diagrams.of_state(register.right))
        for register in registers
    ]
    names = [diagrams.parts(diagrams.of_letter(register.atom))[0] for register in registers]
    known: dict[tuple[int, ...], list[tuple[int, dict[str, bool], tuple[int, ...]]]] = {}

    def moves(values: tuple[int, ...]) -> list[tuple[int, dict[str, bool], tuple[int, ...]]]:
        """Steps of the registers: letters, the registers' values, and their next states."""
        if values not in known:
            steps: list[tuple[int, dict[str, bool], tuple[int, ...]]] = [(TRUE, {}, ())]
            for value, name, (register, left, right) in zip(values, names, operands, strict=True):
                steps = [
                    (met, {**values_of, name: bool(after & 1)}, (*others, after))
                    for letters, values_of, others in steps
                    for after, more in _steps(
                        register,
                        value,
                        (diagrams.given(left, values_of), diagrams.given(right, values_of)),
                        diagrams,
                    ).items()
                    if (met := diagrams.both(letters, more)) != FALSE
                ]
            known[values] = steps
        return known[values]

    def step(
        state: tuple[int, tuple[int, ...]],
    ) -> Iterable[tuple[tuple[int, tuple[int, ...]], int, int]]:
        edges: dict[tuple[tuple[int, tuple[int, ...]], int], int] = {}
        if never_left[state[0]]:
            return [(state, marks, TRUE) for _, marks in automaton.edges[state[0]]]
        for letters, values_of, after in moves(state[1]):
            for (target, marks), own in automaton.edges[state[0]].items():
                met = diagrams.both(diagrams.given(own, values_of), letters)
                if met != FALSE:
                    key = (target, nothing if never_left[target] else after), marks
                    edges[key] = diagrams.either(edges.get(key, FALSE), met)
        return [(target, marks, letters) for (target, marks), letters in edges.items()]

    states, rows = explored((0, nothing), step)
    ends = automaton.ends_well
    product = replace(
        automaton,
        edges=tuple(rows),
        ends_well=None if ends is None else tuple([ends[state] for state, _ in states]),
    )
    return merged(product, diagrams)


def _steps(
    register: Register, value: int, operands: tuple[int, int], diagrams: Diagrams
) -> dict[int, int]:
    """The register's next states, each with the letters that lead there."""
    letters_to: dict[int, int] = {}
    for is_left in (True, False):
        for is_right in (True, False):
            after = register.after(value, is_left, is_right)
            left, right = operands
            letters = diagrams.both(left if is_left else -left, right if is_right else -right)
            letters_to[after] = diagrams.either(letters_to.get(after, FALSE), letters)
    return letters_to
