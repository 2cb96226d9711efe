"""The parser's tables, ``grammar/rulec.tables.json``, made by Lark of ``grammar/rulec.lark``."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, Final

from lark import Lark
from lark.grammar import Rule
from lark.lexer import TerminalDef

from rulec.resources import grammar_file
from rulec.syntax.parse_nodes import Start
from rulec.syntax.parser_tables import stamp

STARTS: tuple[Start, ...] = ("item", "rule_head", "clause", "example_head", "state", "formula")

_SHIFT: Final = 0
_ENDLESS: Final = 2**32 - 1
"""An unbounded width, which newer versions of Python count higher."""


def parser_tables() -> str:
    """Generate the tables, so that the parser needs no Lark."""
    return tables_of(grammar_file("rulec.lark").read_text(encoding="utf-8"))


def lark_of(grammar: str) -> Lark:
    """Lark's own parser of the pieces."""
    return Lark(
        grammar,
        parser="lalr",
        lexer="contextual",
        start=list(STARTS),
        propagate_positions=True,
        maybe_placeholders=False,
    )


def tables_of(grammar: str) -> str:
    """The text of ``grammar/rulec.tables.json``, one line a terminal, rule and state.

    What Lark numbers in the order of a set is renumbered, so that a grammar always gives the same.
    """
    lark = lark_of(grammar)
    data, memo = lark.memo_serialize([TerminalDef, Rule])
    table = data["parser"]["parser"]
    symbols = sorted(table["tokens"].values())
    order = _state_order(table)
    rules = {number: _rule(own) for number, own in memo.items() if own["__type__"] == "Rule"}
    lines = sorted({json.dumps(rule) for rule in rules.values()})
    numbers = {number: lines.index(json.dumps(rule)) for number, rule in rules.items()}
    places = {symbol: place for place, symbol in enumerate(symbols)}
    head = {
        "made_of": stamp(grammar),
        "symbols": symbols,
        "first_states": {start: order[state] for start, state in table["start_states"].items()},
        "last_states": {start: order[state] for start, state in table["end_states"].items()},
    }
    parts = {
        "terminals": _terminals(lark),
        "rules": [json.loads(line) for line in lines],
        "states": [_row(table, state, (places, order, numbers)) for state in order],
    }
    texts = [json.dumps(head, sort_keys=True)[:-1]]
    texts += [f'"{name}": [\n{_lines(values)}\n]' for name, values in parts.items()]
    return ",\n".join(texts) + "}\n"


def _lines(values: list[Any]) -> str:
    return ",\n".join([json.dumps(value, separators=(",", ":")) for value in values])


def _terminals(lark: Lark) -> list[tuple[str, str]]:
    """The names and patterns of terminals, in the order in which Lark's lexer tries them."""

    def rank(terminal: TerminalDef) -> tuple[Any, ...]:
        pattern = terminal.pattern
        widest = min(pattern.max_width, _ENDLESS)
        return -terminal.priority, -widest, -len(pattern.value), terminal.name

    terminals = [own for own in lark.terminals if own.name not in lark.ignore_tokens]
    return [(own.name, own.pattern.to_regexp()) for own in sorted(terminals, key=rank)]


def _rule(rule: Mapping[str, Any]) -> list[Any]:
    """The fields of a ``GrammarRule``."""
    symbol, alias, size = rule["origin"]["name"], rule["alias"], len(rule["expansion"])
    kind = None if symbol.startswith("_") else alias or symbol
    return [symbol, size, kind, size == 1 and rule["options"]["expand1"] and not alias]


def _state_order(table: Mapping[str, Any]) -> dict[int, int]:
    """The new numbers of states by old ones, in the order of a traversal."""
    names = table["tokens"]
    order: dict[int, int] = {}
    todo = [state for _, state in sorted(table["start_states"].items(), reverse=True)]
    while todo:
        state = todo.pop()
        if state in order:
            continue
        order[state] = len(order)
        row = sorted((names[token], action) for token, action in table["states"][state].items())
        todo += [target for _, (kind, target) in reversed(row) if kind == _SHIFT]
    return order


def _row(
    table: Mapping[str, Any],
    state: int,
    numbers: tuple[Mapping[str, int], Mapping[int, int], Mapping[int, int]],
) -> list[list[int]]:
    """The actions of a state, as they are read back; numbers of symbols, states and rules."""
    symbols, states, rules = numbers
    shifts: list[tuple[int, int]] = []
    reductions: dict[int, list[int]] = {}
    for token, (kind, target) in table["states"][state].items():
        symbol = symbols[table["tokens"][token]]
        if kind == _SHIFT:
            shifts.append((symbol, states[target]))
        else:
            reductions.setdefault(rules[target["@"]], []).append(symbol)
    rows = [[rule, *sorted(before)] for rule, before in sorted(reductions.items())]
    return [[number for pair in sorted(shifts) for number in pair], *rows]
