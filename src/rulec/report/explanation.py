"""An explained violation as a table of states, and as data."""

from __future__ import annotations

from decimal import Decimal
from typing import Any

import click

from rulec.logic.printing import number_in_words
from rulec.report.excerpt import visible
from rulec.runtime.explanation import Explanation, Fact
from rulec.runtime.numbers import exact
from rulec.trace import Value

WIDEST = 60
"""A part of the formula is cut at so many characters; what it is made of stands below it."""

WIDEST_NUMBER = 20
"""A longer number is rounded."""

MOST_OF_NAMES = 16
"""So many characters of the names of counted objects are shown; JSON has them all."""

INDENT = "    "


def as_data(explanation: Explanation) -> dict[str, Any]:
    """The explanation for JSON."""
    return {
        "book": explanation.rule.book,
        "cite": explanation.rule.cite,
        "says": explanation.rule.says,
        "states": explanation.states,
        "decisive": explanation.decisive,
        "facts": [_as_data(fact) for fact in explanation.facts],
        "parts": [
            {
                "formula": part.text,
                "depth": part.depth,
                "values": part.values,
                "changed": part.changed,
            }
            for part in explanation.parts
        ],
    }


def _as_data(fact: Fact) -> dict[str, Any]:
    data = {"reads": fact.text, "values": fact.values, "changed": fact.changed}
    if fact.unit:
        data["unit"] = fact.unit
    if fact.objects is not None:
        data["objects"] = fact.objects
    return data


def as_text(explanation: Explanation) -> str:
    """The rule's sentence and the table; ``*`` marks what changed with the decisive state."""
    decisive = explanation.states.index(explanation.decisive)
    rows: list[tuple[str, list[str]]] = [("state", [str(n) for n in explanation.states])]
    rows += [
        (_title(fact), _marked(_cells(fact), decisive, fact.changed)) for fact in explanation.facts
    ]
    rows += [
        (f"{'  ' * part.depth}{_cut(part.text)}", [shown(value) for value in part.values])
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


def _title(fact: Fact) -> str:
    return f"{_cut(fact.text)} in {visible(fact.unit)}" if fact.unit else _cut(fact.text)


def _cells(fact: Fact) -> list[str]:
    cells = [shown(value) for value in fact.values]
    if fact.objects is None:
        return cells
    return [_with_names(cell, names) for cell, names in zip(cells, fact.objects, strict=True)]


def _with_names(number: str, names: tuple[str, ...]) -> str:
    """A count and whom it counts, as far as there is room."""
    if not names:
        return number
    text = visible(", ".join(names))
    return f"{number}: {text if len(text) <= MOST_OF_NAMES else f'{text[: MOST_OF_NAMES - 1]}…'}"


def _marked(cells: list[str], decisive: int, changed: bool) -> list[str]:
    return [f"{cell}*" if n == decisive and changed else cell for n, cell in enumerate(cells)]


def shown(value: Value) -> str:
    """A value as a cell of a table."""
    if isinstance(value, bool):
        return "T" if value else "F"
    if isinstance(value, str):
        return visible(value)
    text = number_in_words(exact(value)) if abs(value) < 10**WIDEST_NUMBER else ""
    fits = 0 < len(text) <= WIDEST_NUMBER
    return text if fits else f"{Decimal(value):.{WIDEST_NUMBER - 8}g}"


def _cut(text: str) -> str:
    return text if len(text) <= WIDEST else f"{text[: WIDEST - 1]}…"
