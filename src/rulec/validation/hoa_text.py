"""Reader of automata in the Hanoi Omega-Automata format, as far as rulec writes it.

T. Babiak et al., "The Hanoi Omega-Automata format", CAV 2015. Labels are on edges, states have no
names, and there are no aliases; anything else is refused.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from rulec.validation.unprovable import UnprovableError, require

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
