"""An explained violation as a table of states, and as data."""

from __future__ import annotations

from typing import Any

import click

from rulec.report.excerpt import visible
from rulec.runtime.explanation import Explanation
from rulec.trace import Value

WIDEST = 60
"""A part of the formula is cut at so many characters; what it is made of stands below it."""

INDENT = "    "


def as_data(explanation: Explanation) -> dict[str, Any]:
    """The explanation for JSON."""
    return {
        "cite": explanation.rule.cite,
        "says": explanation.rule.says,
        "states": explanation.states,
        "decisive": explanation.decisive,
        "facts": [{"reads": fact.text, "values": fact.values} for fact in explanation.facts],
        "parts": [
            {"formula": part.text, "depth": part.depth, "values": part.values}
            for part in explanation.parts
        ],
    }


def as_text(explanation: Explanation) -> str:
    """The rule's sentence and the table; ``*`` marks what changed with the decisive state."""
    decisive = explanation.states.index(explanation.decisive)
    rows: list[tuple[str, list[str]]] = [("state", [str(n) for n in explanation.states])]
    rows += [
        (fact.text, _marked([_shown(value) for value in fact.values], decisive))
        for fact in explanation.facts
    ]
    rows += [
        (f"{'  ' * part.depth}{_cut(part.text)}", [_shown(value) for value in part.values])
        for part in explanation.parts
    ]
    title_width = max(len(title) for title, _ in rows)
    widths = [max(len(cells[n]) for _, cells in rows) for n in range(len(explanation.states))]
    lines = [f"{INDENT}{visible(explanation.rule.says)}"] if explanation.rule.says else []
    for number, (title, cells) in enumerate(rows):
        padded = [
            f"{click.style(cell, bold=True) if n == decisive else cell}{' ' * (width - len(cell))}"
            for n, (cell, width) in enumerate(zip(cells, widths, strict=True))
        ]
        lines.append(f"{INDENT}{title.ljust(title_width)}   {'  '.join(padded)}".rstrip())
        if number in (0, len(explanation.facts)):
            lines.append(f"{INDENT}{'─' * (title_width + 3 + sum(widths) + 2 * len(widths) - 2)}")
    return "\n".join(lines)


def _marked(cells: list[str], decisive: int) -> list[str]:
    changed = decisive > 0 and cells[decisive] != cells[decisive - 1]
    return [f"{cell}*" if n == decisive and changed else cell for n, cell in enumerate(cells)]


def _shown(value: Value) -> str:
    if isinstance(value, bool):
        return "T" if value else "F"
    return visible(f"{value:g}" if isinstance(value, int | float) else value)


def _cut(text: str) -> str:
    return text if len(text) <= WIDEST else f"{text[: WIDEST - 1]}…"
