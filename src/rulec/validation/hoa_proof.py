"""Proof of a rule's HOA text against the formula, for every trace.

The automaton judges infinite words. The word of a trace repeats its last state for ever or, under
`finite`, makes an extra proposition false after it. For such words both sides are compared, in all
pairs of states that a trace leads to; other infinite words do not matter.

The text is read as far as rulec writes it (T. Babiak et al., "The Hanoi Omega-Automata format",
CAV 2015): labels are on edges, states have no names, there are no aliases; all else is refused.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from rulec.validation.formula_words import atoms_in, formula_words
from rulec.validation.letter_sets import Letters, told_apart
from rulec.validation.table_proof import FormulaMachine, led_to
from rulec.validation.unprovable import UnprovableError, require

MOST_STEPS = 1 << 20
"""The greatest number of edges examined, over all classes of letters."""

_ALIVE = re.compile(r"alive(?: \([0-9]+\))?")


def prove_hoa(
    machine: FormulaMachine, text: str, tree: Any, letters: Letters, *, ends: bool
) -> None:
    """Raise UnprovableError unless an automaton accepts exactly the traces its formula keeps.

    ``ends`` if nothing follows a word; the automaton then has each letter twice, the upper half for
    states in which the trace goes on.
    """
    size, possible = letters.count, machine.possible
    truth = {formula_words(atom): letters.of(atom) for atom in atoms_in(tree)}
    going_on = ((1 << size) - 1) << size
    unknown: list[str] = []

    def letters_of(name: str) -> int:
        if name in truth:
            return truth[name] << size | truth[name] if ends else truth[name]
        unknown.append(name)
        return going_on

    every = possible << size | possible if ends else possible
    automaton = read_hoa(text, letters_of, (1 << (size << ends)) - 1)
    fits = len(unknown) <= ends and all(map(_ALIVE.fullmatch, unknown))
    require(fits, "its HOA text has other propositions than its formula")
    for row in automaton.edges:
        met = 0
        for edge in row:
            require(not met & edge.letters & every, "its HOA text is not deterministic")
            met |= edge.letters
        require(not every & ~met, "its HOA text has no edge for a possible letter")
    accepted = _over(automaton, possible) if ends else _repeated(automaton, possible)
    shift = size if ends else 0
    first = machine.progression.start, automaton.start
    seen = {first}
    for state, place in (waiting := [first]):
        for move in machine.moves(state):
            for edge in automaton.edges[place]:
                common = move.letters & (edge.letters >> shift)
                if not common:
                    continue
                right = accepted[edge.target] if ends else accepted[place]
                judged = possible if move.kept else 0
                same = not common & (right ^ judged)
                require(same, "its HOA text judges some trace differently from its tree")
                target = move.target, edge.target
                if target not in seen:
                    require(len(seen) < MOST_STEPS, "its HOA text is too large for this checker")
                    seen.add(target)
                    waiting.append(target)


def _repeated(automaton: HoaAutomaton, possible: int) -> list[int]:
    """For each state, the letters that are accepted if repeated for ever from there."""
    accepted = [0] * len(automaton.edges)
    steps = 0
    labels = {edge.letters for row in automaton.edges for edge in row}
    most = MOST_STEPS // len(accepted)
    for letters in told_apart(possible, labels, most, "its HOA text is too large for this checker"):
        steps += len(accepted)
        require(steps <= MOST_STEPS, "its HOA text is too large for this checker")
        own = [next(edge for edge in row if edge.letters & letters) for row in automaton.edges]
        verdicts: dict[int, bool] = {}
        for start in range(len(own)):
            path: dict[int, None] = {}
            here = start
            while here not in verdicts and here not in path:
                path[here] = None
                here = own[here].target
            if here not in verdicts:
                places = list(path)
                circle = places[places.index(here) :]
                marks = frozenset().union(*[own[place].marks for place in circle])
                verdicts[here] = automaton.accepts(marks)
            verdicts.update(dict.fromkeys(path, verdicts[here]))
        for state, verdict in verdicts.items():
            accepted[state] |= letters if verdict else 0
    return accepted


def _over(automaton: HoaAutomaton, possible: int) -> list[int]:
    """For each state, all letters if a trace that ended on entering it is accepted, else none.

    After the end all words must be judged alike: on all cycles, the edges have the same marks.
    """
    dead = [[edge for edge in row if edge.letters & possible] for row in automaton.edges]
    result: list[int] = []
    for start in range(len(dead)):
        seen = {start}
        for state in (waiting := [start]):
            for edge in dead[state]:
                if edge.target not in seen:
                    seen.add(edge.target)
                    waiting.append(edge.target)
        graph = {state: {edge.target for edge in dead[state]} for state in seen}
        # Only of edges on cycles; others are passed once.
        marks = {
            edge.marks
            for state in seen
            for edge in dead[state]
            if edge.target in led_to({state}, graph)
        }
        verdicts = {automaton.accepts(own) for own in marks}
        require(len(marks) == 1, "its HOA text distinguishes words after the end of a trace")
        result.append(possible if verdicts == {True} else 0)
    return result


_TOKEN = re.compile(
    r"\s+|/\*(?:(?!/\*).)*?\*/|(?P<token>\"(?:[^\"\\]|\\.)*\"|--[A-Z]+--|[A-Za-z_][\w-]*:?|[0-9]+(?!\w)"
    r"|[][{}()!&|])",
    re.DOTALL,
)
_IGNORED = frozenset({"acc-name:", "tool:", "name:", "properties:"})
_NEITHER = "its HOA text is not of the kind that this checker reads"


@dataclass(frozen=True, slots=True)
class HoaEdge:
    """An edge: its letters, as bits, its target state, and its acceptance marks."""

    letters: int
    target: int
    marks: frozenset[int]


@dataclass(frozen=True, slots=True)
class HoaAutomaton:
    """The edges of each state, the start state, and which sets of recurring marks accept."""

    edges: Sequence[Sequence[HoaEdge]]
    start: int
    accepts: Callable[[frozenset[int]], bool]


def read_hoa(text: str, letters_of: Callable[[str], int], everything: int) -> HoaAutomaton:
    """The automaton in a text; ``letters_of`` gives the letters in which a proposition is true.

    ``everything`` is the set of all letters. Raises UnprovableError.
    """
    reader = _Reader(_tokens(text))
    try:
        return reader.automaton(letters_of, everything)
    except (IndexError, ValueError, RecursionError):
        raise UnprovableError(_NEITHER) from None


def _tokens(text: str) -> list[str]:
    tokens, at = [], 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        require(match is not None, _NEITHER)
        assert match is not None
        if match["token"]:
            tokens.append(match["token"])
        at = match.end()
    return tokens


class _Reader:
    def __init__(self, tokens: list[str]) -> None:
        self._tokens = tokens[::-1]

    def automaton(self, letters_of: Callable[[str], int], everything: int) -> HoaAutomaton:
        head: dict[str, list[str]] = {}
        while (word := self._next()) != "--BODY--":
            require(word.endswith(":") and word not in head.keys() - _IGNORED, _NEITHER)
            head[word] = []
            while not self._token().endswith(":") and self._token() != "--BODY--":
                head[word].append(self._next())
        known = {"HOA:", "States:", "Start:", "AP:", "Acceptance:"}
        require(known <= head.keys() <= known | _IGNORED, _NEITHER)
        require(head["HOA:"] == ["v1"] and len(head["Start:"]) == 1, _NEITHER)
        n_states, start = int(*head["States:"]), int(*head["Start:"])
        names = [json.loads(name) for name in head["AP:"][1:]]
        require(len(names) == int(head["AP:"][0]) == len(set(names)), _NEITHER)
        propositions = [letters_of(name) for name in names]
        edges: dict[int, list[HoaEdge]] = {}
        while (word := self._next()) != "--END--":
            require(word == "State:", _NEITHER)
            state = int(self._next())
            require(state not in edges, _NEITHER)
            own, edges[state] = self._marks(), []
            while self._token() == "[":
                self._take("[")
                label = self._or(lambda: self._label(propositions, everything))
                self._take("]")
                edges[state].append(HoaEdge(label, int(self._next()), own | self._marks()))
        require(not self._tokens, _NEITHER)
        leads = {start, *(edge.target for row in edges.values() for edge in row)}
        require(sorted(edges) == list(range(n_states)) and leads <= edges.keys(), _NEITHER)
        n_marks, *condition = head["Acceptance:"]
        numbers = {int(word) for word in condition if word.isdecimal()}
        used = numbers.union(*(edge.marks for row in edges.values() for edge in row))
        require(max(used, default=-1) < int(n_marks), _NEITHER)
        rows = [edges[state] for state in range(n_states)]
        return HoaAutomaton(rows, start, lambda marks: _Reader(condition).holds(marks))

    def holds(self, marks: frozenset[int]) -> bool:
        """Whether the acceptance condition holds if exactly these marks recur."""
        holds = bool(self._or(lambda: self._recurs(marks)))
        require(not self._tokens, _NEITHER)
        return holds

    def _recurs(self, marks: frozenset[int]) -> int:
        word = self._next()
        if word in ("t", "f"):
            return int(word == "t")
        require(word in ("Inf", "Fin"), _NEITHER)
        self._take("(")
        number = int(self._next())
        self._take(")")
        return int((number in marks) is (word == "Inf"))

    def _label(self, propositions: Sequence[int], everything: int) -> int:
        word = self._next()
        if word == "!":
            return everything & ~self._inner(lambda: self._label(propositions, everything))
        if word in ("t", "f"):
            return everything if word == "t" else 0
        return propositions[int(word)]

    def _or(self, atom: Callable[[], int]) -> int:
        letters = self._and(atom)
        while self._tokens and self._token() == "|":
            self._next()
            letters |= self._and(atom)
        return letters

    def _and(self, atom: Callable[[], int]) -> int:
        letters = self._inner(atom)
        while self._tokens and self._token() == "&":
            self._next()
            letters &= self._inner(atom)
        return letters

    def _inner(self, atom: Callable[[], int]) -> int:
        if self._token() != "(":
            return atom()
        self._take("(")
        letters = self._or(atom)
        self._take(")")
        return letters

    def _marks(self) -> frozenset[int]:
        marks: set[int] = set()
        if self._tokens and self._token() == "{":
            self._next()
            while (word := self._next()) != "}":
                marks.add(int(word))
        return frozenset(marks)

    def _token(self) -> str:
        return self._tokens[-1]

    def _next(self) -> str:
        return self._tokens.pop()

    def _take(self, expected: str) -> None:
        require(self._next() == expected, _NEITHER)
