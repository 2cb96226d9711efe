"""How much of a rule its examples show: which edges they take, which atoms they see both ways."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from rulec.automata.machine import Machine, Read
from rulec.logic.formula import Atom, atoms_of
from rulec.rulebook.model import ExampleState, Rule
from rulec.runtime.examples import ExampleRun, Outcome
from rulec.vocabulary import Enumeration, Quantity, Vocabulary


@dataclass(frozen=True, slots=True)
class MissingEdge:
    """An edge of a rule's machine that no example takes, with a shortest example that would.

    The edge leads from state ``source`` to ``target``; ``accepted`` is what the rule does with the
    example.
    """

    source: int
    target: int
    states: tuple[ExampleState, ...]
    accepted: bool


@dataclass(frozen=True, slots=True)
class RuleCoverage:
    """What a rule's examples take and see.

    An edge is a state of its machine and a class of letters; the edges of the two states in which
    the verdict is settled for good do not count. An atom's values are true and false, as far as it
    can have them.
    """

    rule: str
    n_edges: int
    missing_edges: tuple[MissingEdge, ...]
    n_values: int
    missing_values: tuple[tuple[Atom, bool], ...]

    @property
    def total(self) -> int:
        """Edges and values of atoms, together."""
        return self.n_edges + self.n_values

    @property
    def covered(self) -> int:
        """Those of them that are taken or seen."""
        return self.total - len(self.missing_edges) - len(self.missing_values)


def percent(rules: Iterable[RuleCoverage]) -> float:
    """The part of all edges and values that is covered, from 0 to 100; 100 if there are none."""
    rules = list(rules)
    total = sum(one.total for one in rules)
    return 100.0 * sum(one.covered for one in rules) / total if total else 100.0


def coverage(run: ExampleRun) -> tuple[RuleCoverage, ...]:
    """The coverage of every rule by the examples that were run.

    Where a pattern chose among the examples, rules without a chosen one are left out.
    """
    found = []
    for rule, compiled in zip(run.rulebook.rules, run.compiled.rules, strict=True):
        outcomes = [one for one in run.outcomes if one.rule is rule]
        if outcomes or run.pattern is None:
            found.append(_coverage(rule, compiled.machine, outcomes, run.rulebook.vocabulary))
    return tuple(found)


def _coverage(
    rule: Rule, machine: Machine, outcomes: Sequence[Outcome], vocabulary: Vocabulary
) -> RuleCoverage:
    edges = list(_edges(machine))
    taken = {edge for one in outcomes for edge in _taken(machine, one.word)}
    paths = _shortest_paths(machine)
    letters = _letters(machine, vocabulary)
    missing_edges = tuple(
        MissingEdge(
            source,
            machine.following[source][symbol],
            tuple(letters[one] for one in (*paths[source], symbol)),
            machine.accepting[source][symbol],
        )
        for source, symbol in edges
        if (source, symbol) not in taken
    )
    values = [
        (atom, v)
        for atom in dict.fromkeys(atoms_of(rule.formula))
        for v in _possible(atom, vocabulary)
    ]
    seen = {
        (atom, _holds(atom, state, vocabulary))
        for atom, _ in values
        for one in outcomes
        for state in one.example.states
    }
    missing_values = tuple(value for value in values if value not in seen)
    return RuleCoverage(rule.name, len(edges), missing_edges, len(values), missing_values)


def _edges(machine: Machine) -> Iterator[tuple[int, int]]:
    for state, row in enumerate(machine.following):
        if state not in (machine.dead, machine.safe):
            for symbol in range(len(row)):
                yield state, symbol


def _taken(machine: Machine, word: Sequence[int]) -> Iterator[tuple[int, int]]:
    state = 0
    for symbol in word:
        yield state, symbol
        state = machine.following[state][symbol]


def _shortest_paths(machine: Machine) -> Mapping[int, tuple[int, ...]]:
    """For every state a shortest word of letter classes that leads to it."""
    paths: dict[int, tuple[int, ...]] = {0: ()}
    waiting = [0]
    for state in waiting:
        for symbol, target in enumerate(machine.following[state]):
            if target not in paths:
                paths[target] = (*paths[state], symbol)
                waiting.append(target)
    return paths


def _letters(machine: Machine, vocabulary: Vocabulary) -> Mapping[int, ExampleState]:
    """For every class the first of its letters, as what a state says."""
    first: dict[int, int] = {}
    for letter, symbol in enumerate(machine.letters):
        first.setdefault(symbol, letter)
    return {symbol: _said(letter, machine.reads, vocabulary) for symbol, letter in first.items()}


def _said(letter: int, reads: Sequence[Read], vocabulary: Vocabulary) -> ExampleState:
    said: dict[tuple[str, tuple[str, ...]], bool | str] = {}
    for read in reads:
        letter, digit = divmod(letter, read.size)
        said[read.name, read.variables] = _value(read, digit, vocabulary)
    return said


def _value(read: Read, digit: int, vocabulary: Vocabulary) -> bool | str:
    declaration = vocabulary.declarations[read.name]
    if not isinstance(declaration, Enumeration):
        return bool(digit)
    if digit < len(read.values):
        return read.values[digit]
    return next(value for value in declaration.values if value not in read.values)


def _possible(atom: Atom, vocabulary: Vocabulary) -> tuple[bool, ...]:
    declaration = vocabulary.declarations[atom.name]
    only = isinstance(declaration, Enumeration) and len(declaration.values) == 1
    return (True,) if only else (True, False)


def _holds(atom: Atom, state: ExampleState, vocabulary: Vocabulary) -> bool:
    declaration = vocabulary.declarations[atom.name]
    assert not isinstance(declaration, Quantity), "quantities are no atoms"
    value = state.get((atom.name, atom.arguments), declaration.default)
    return bool(value) if atom.value is None else value == atom.value
