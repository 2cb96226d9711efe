"""Parser tables as a data file, so that they need not be generated at run time.

Lark's serialisation depends on the order in which Python iterates over sets; here states, tokens
and rules are renumbered, so that a grammar always gives the same file.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import sha256
from typing import Any, Final

_SHIFT: Final = 0
_REDUCE: Final = 1
_ENDLESS: Final = 2**32 - 1

Serialized = dict[str, Any]
"""Lark's ``{"data": …, "memo": …}``."""


def stamp(grammar: str, version: str) -> str:
    """The origin of tables: a grammar's text and the version of Lark."""
    return f"{version} {sha256(grammar.encode()).hexdigest()}"


def to_text(made_of: str, serialized: Serialized) -> str:
    """JSON text of parser tables, one line per rule and state."""
    data, memo = serialized["data"], serialized["memo"]
    numbers, kept = _renumbered_memo(memo)
    table = data["parser"]["parser"]
    tokens = sorted(table["tokens"].values())
    rest = _refer(data, numbers)
    lists = (rest["rules"], rest["parser"]["parser_conf"]["rules"])
    for list_ in (*lists, rest["parser"]["lexer_conf"]["terminals"]):
        list_.sort(key=lambda reference: reference["@"])
    rest["parser"]["parser"] = None
    order = _state_order(table)
    states = [_row(table, state, tokens, order, numbers) for state in order]
    ends = {
        key: {start: order[state] for start, state in table[key].items()}
        for key in ("start_states", "end_states")
    }
    whole = {"made_of": made_of, "rest": rest, "ends": ends, "tokens": tokens}
    head = json.dumps(whole, sort_keys=True)[:-1]
    lines = [f'{head}, "memo": [', _lines(kept), '], "states": [', _lines(states), "]}"]
    return "\n".join(lines) + "\n"


def from_text(text: str, made_of: str) -> Serialized | None:
    """Parser tables for Lark from text; None if they are stale."""
    whole = json.loads(text)
    if not isinstance(whole, dict) or whole.get("made_of") != made_of:
        return None
    data = whole["rest"]
    data["parser"]["parser"] = {
        "tokens": dict(enumerate(whole["tokens"])),
        "states": dict(enumerate(map(_actions, whole["states"]))),
        **whole["ends"],
    }
    return {"data": data, "memo": dict(enumerate(whole["memo"]))}


def _lines(values: list[Any]) -> str:
    return ",\n".join(json.dumps(value, sort_keys=True, separators=(",", ":")) for value in values)


def _renumbered_memo(memo: Mapping[int, Any]) -> tuple[dict[int, int], list[Any]]:
    """The new numbers of rules and terminals, and these in their new order."""
    same = {old: _the_same_everywhere(value) for old, value in memo.items()}
    ranked = sorted(same.items(), key=lambda entry: json.dumps(entry[1], sort_keys=True))
    return {old: new for new, (old, _) in enumerate(ranked)}, [value for _, value in ranked]


def _refer(value: Any, numbers: Mapping[int, int]) -> Any:
    """A copy whose references to rules and terminals have their new numbers."""
    if isinstance(value, dict):
        if "@" in value:
            return {"@": numbers[value["@"]]}
        return {key: _refer(item, numbers) for key, item in value.items() if key != "states"}
    if isinstance(value, list | tuple):
        return [_refer(item, numbers) for item in value]
    return value


def _the_same_everywhere(value: Any) -> Any:
    """A terminal or rule with an unbounded width, made equal for all versions of Python."""
    pattern = value.get("pattern", {})
    if "_width" not in pattern:
        return value
    widths = [min(width, _ENDLESS) for width in pattern["_width"]]
    return {**value, "pattern": {**pattern, "_width": widths}}


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
    tokens: list[str],
    order: Mapping[int, int],
    numbers: Mapping[int, int],
) -> list[Any]:
    """The table row of a state: its shifts, then its reductions.

    Shifts are tokens and next states in turn; a reduction is a rule and its tokens.
    """
    shifts: list[tuple[int, int]] = []
    reductions: dict[int, list[int]] = {}
    for token, (kind, target) in table["states"][state].items():
        number = tokens.index(table["tokens"][token])
        if kind == _SHIFT:
            shifts.append((number, order[target]))
        else:
            reductions.setdefault(numbers[target["@"]], []).append(number)
    rules = [[rule, *sorted(at)] for rule, at in sorted(reductions.items())]
    return [[number for pair in sorted(shifts) for number in pair], *rules]


def _actions(row: list[list[int]]) -> dict[int, tuple[int, Any]]:
    shifts, *reductions = row
    actions: dict[int, tuple[int, Any]] = {
        token: (_SHIFT, target) for token, target in zip(shifts[::2], shifts[1::2], strict=True)
    }
    for rule, *tokens in reductions:
        action = (_REDUCE, {"@": rule})
        actions.update(dict.fromkeys(tokens, action))
    return actions
