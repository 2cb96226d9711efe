"""Runs the grammar: an LALR(1) parser with a contextual lexer, on the tables that Lark makes.

Lark's own loop is not used: with its tokens and trees, which are to be converted, it takes four
times as long, and 40 ms to load. A test compares both.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache
from typing import TypeAlias

from rulec.resources import grammar_file
from rulec.syntax.parse_nodes import (
    MAX_DEPTH,
    Mismatch,
    ParseLeaf,
    ParseNode,
    Start,
    TooDeep,
)
from rulec.syntax.parser_tables import (
    END,
    GrammarRule,
    ParserTables,
    behind_spaces,
    from_text,
    stamp,
)

_LEVELS = frozenset(
    (*("infix", "prefix", "group", "compare"), *("arithmetic", "minus", "conditional", "aggregate"))
)

_Part: TypeAlias = "ParseNode | ParseLeaf"


def parse_piece(start: Start, text: str, begin: int, end: int) -> ParseNode | Mismatch | TooDeep:
    """Parse characters ``begin`` to ``end`` of a text. Positions count from the text's start."""
    run = _Run.of(start)
    position = run.through(text, begin, end)
    if position is None and not run.ends():
        position = end
    if position is not None:
        return Mismatch(position, _accepted(start, text, begin, position))
    too_deep = _too_deep(run.root) if run.n_levels > MAX_DEPTH else None
    return too_deep or run.root


def accepted_after(start: Start, text: str) -> frozenset[str]:
    """The terminals that may follow the beginning of a piece; none if it cannot be read."""
    return _accepted(start, text, 0, len(text))


@cache
def _tables() -> ParserTables:
    """The tables, which `src/tools/parser_tables.py` makes of the grammar."""
    grammar = grammar_file("rulec.lark").read_text(encoding="utf-8")
    tables = grammar_file("rulec.tables.json").read_text(encoding="utf-8")
    with suppress(ValueError):
        if (ready := from_text(tables, stamp(grammar))) is not None:
            return ready
    raise ValueError("grammar/rulec.tables.json is not of grammar/rulec.lark; make it again")


def _accepted(start: Start, text: str, begin: int, end: int) -> frozenset[str]:
    """The terminals that may follow these characters; none if they cannot be read.

    They are parsed again, up to the wrong token: acting on it has hidden what else could follow.
    """
    run = _Run.of(start)
    if run.through(text, begin, end) is not None:
        return frozenset()
    return frozenset(run.next_kinds())


@dataclass(slots=True)
class _Run:
    """A run of the parser: the states on its stack, and what was matched between each two.

    A list is what a rule matched that makes no node: its parts belong to the node around it.
    """

    tables: ParserTables
    last_state: int
    states: list[int]
    matched: list[_Part | list[_Part]] = field(default_factory=list)
    n_levels: int = 0

    @staticmethod
    def of(start: Start) -> _Run:
        """A run at the beginning of a piece."""
        tables = _tables()
        return _Run(tables, tables.last_states[start], [tables.first_states[start]])

    @property
    def root(self) -> ParseNode:
        """The node of a complete piece."""
        (root,) = self.matched
        assert isinstance(root, ParseNode)
        return root

    def through(self, text: str, begin: int, end: int) -> int | None:
        """Read all tokens; returns where one does not fit, None if all do."""
        tables, states, matched = self.tables, self.states, self.matched
        position = begin
        while True:
            match = tables.token_matcher(states[-1])(text, position, end)
            if match is None:
                behind = behind_spaces(text, position, end)
                if behind in (position, end):
                    return None if behind == end else behind
                position = behind
                continue
            kind = match.lastgroup
            assert kind is not None, "each alternative is named"
            first, position = match.span(kind)
            target = self._reduced(kind)
            if target is None:
                return first
            states.append(target)
            matched.append(ParseLeaf(kind, text[first:position], first, position))

    def ends(self) -> bool:
        """Whether the piece may end here; this completes it."""
        self._reduced(END)
        return self.states[-1] == self.last_state

    def next_kinds(self) -> Iterator[str]:
        """The terminals that may follow, and the end."""
        for kind in filter(str.isupper, self.tables.actions[self.states[-1]]):
            trial = replace(self, states=[*self.states], matched=[*self.matched])
            if trial.ends() if kind == END else trial._reduced(kind) is not None:
                yield kind

    def _reduced(self, kind: str) -> int | None:
        """Apply the rules that end before a token; the state behind it, None if it does not fit."""
        actions, rules, states = self.tables.actions, self.tables.rules, self.states
        while True:
            action = actions[states[-1]].get(kind)
            if action is None or action >= 0:
                return action
            rule = rules[~action]
            if not rule.passes:
                self._reduce(rule)
            del states[-rule.size :]
            states.append(actions[states[-1]][rule.symbol])
            if kind == END and states[-1] == self.last_state:
                return None

    def _reduce(self, rule: GrammarRule) -> None:
        parts: list[_Part] = []
        for own in self.matched[-rule.size :]:
            if isinstance(own, list):
                parts += own
            else:
                parts.append(own)
        made: _Part | list[_Part] = parts
        if rule.kind is not None:
            self.n_levels += rule.kind in _LEVELS
            made = ParseNode(rule.kind, tuple(parts), parts[0].start, parts[-1].end)
        self.matched[-rule.size :] = [made]


def _too_deep(root: ParseNode) -> TooDeep | None:
    """The first part that is inside too many others. Not recursive: a hostile tree is very deep."""
    todo: list[tuple[_Part, int]] = [(root, 0)]
    while todo:
        node, depth = todo.pop()
        if isinstance(node, ParseNode):
            if depth > MAX_DEPTH:
                return TooDeep(node.start)
            below = depth + (node.kind in _LEVELS)
            todo += [(child, below) for child in reversed(node.children)]
    return None
