"""The parser's tables, from the data file ``grammar/rulec.tables.json``."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from hashlib import sha256
from typing import Any, NamedTuple, TypeAlias

END = "$END"
"""Stands among terminals for the end of a piece."""

MatchToken: TypeAlias = Callable[[str, int, int], "re.Match[str] | None"]
"""Matches a token, as the last group, from one character to another; white space may precede it."""

_BLANK = re.compile(r"(?:\s+|#[^\n]*)*")


class GrammarRule(NamedTuple):
    """A rule of the grammar, of ``size`` parts; ``symbol`` is what it matches.

    They make a node of this ``kind``, unless a single part ``passes`` for it; without a kind they
    are parts of the node around them.
    """

    symbol: str
    size: int
    kind: str | None
    passes: bool


class ParserTables:
    """The tables of an LALR(1) parser, with a lexer in each state for the tokens that fit there.

    ``rules``: those of the grammar. ``actions``: for each state and each symbol the next state, or
    ``~rule`` if the rule with this number ends before it. ``first_states``, ``last_states``: by
    start symbol.
    """

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.first_states: dict[str, int] = data["first_states"]
        self.last_states: dict[str, int] = data["last_states"]
        self.rules = [GrammarRule(*rule) for rule in data["rules"]]
        self.actions = [_actions(row, data["symbols"]) for row in data["states"]]
        self._patterns: list[tuple[str, str]] = data["terminals"]
        self._matchers: dict[int, MatchToken] = {}
        self._of_terminals: dict[frozenset[str], MatchToken] = {}

    def token_matcher(self, state: int) -> MatchToken:
        """The lexer of a state; where several tokens fit, the grammar decides by their order."""
        matcher = self._matchers.get(state)
        if matcher is None:
            terminals = frozenset(self.actions[state])
            matcher = self._of_terminals.get(terminals)
            if matcher is None:
                fit = [f"(?P<{name}>{own})" for name, own in self._patterns if name in terminals]
                pattern = re.compile(rf"\s*(?:{'|'.join(fit) or '(?!)'})")
                matcher = self._of_terminals[terminals] = pattern.match
            self._matchers[state] = matcher
        return matcher


def behind_spaces(text: str, begin: int, end: int) -> int:
    """The place of the first character that is neither white space nor a comment."""
    blank = _BLANK.match(text, begin, end)
    return begin if blank is None else blank.end()


def stamp(grammar: str) -> str:
    """Identifies a grammar's text."""
    return sha256(grammar.encode()).hexdigest()


def from_text(text: str, made_of: str) -> ParserTables | None:
    """Tables from the text of their file; None if they are not of the grammar with this stamp."""
    whole = json.loads(text)
    if not isinstance(whole, dict) or whole.get("made_of") != made_of:
        return None
    return ParserTables(whole)


def _actions(row: list[list[int]], symbols: list[str]) -> dict[str, int]:
    """A row has symbols and next states in turn, then for each rule its number and its symbols."""
    shifts, *reductions = row
    actions = {
        symbols[symbol]: state for symbol, state in zip(shifts[::2], shifts[1::2], strict=True)
    }
    for rule, *before in reductions:
        actions.update(dict.fromkeys([symbols[symbol] for symbol in before], ~rule))
    return actions
