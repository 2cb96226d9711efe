"""How two rulebooks differ, as a page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape

from rulec.analysis.difference import Difference, OneSided, RulePair
from rulec.report import state_table
from rulec.report.differences import about_types, is_worth_a_block, only_why, summary, verdict
from rulec.report.excerpt import visible
from rulec.report.html_page import page, table


def as_html(found: Difference) -> str:
    """A document of its own."""
    one, other = found.first.name, found.second.name
    parts = [f"<p>{_text(summary(found))}.</p>"]
    parts += [part for pair in found.pairs if is_worth_a_block(pair) for part in _pair(pair, found)]
    for rules, has, lacks in (
        (found.only_first, one, other),
        (found.only_second, other, one),
    ):
        if rules:
            parts += [f"<h2>Only in {_text(has)}</h2>", _only(rules, lacks)]
    if found.settings:
        rows = [
            [_text(cell) for cell in (f"{each.kind} {each.name}", each.first, each.second)]
            for each in found.settings
        ]
        parts += ["<h2>Set otherwise</h2>", table(["", _text(one), _text(other)], rows)]
    same = [pair.name for pair in found.pairs if not is_worth_a_block(pair)]
    if same:
        names = ", ".join(f"<code>{_text(name)}</code>" for name in same)
        parts += ["<h2>The same in both</h2>", f"<p>{names}</p>"]
    return page(f"{one} compared to {other}", parts)


def _text(text: str) -> str:
    return escape(visible(text))


def _pair(pair: RulePair, found: Difference) -> Iterator[str]:
    yield f"<h2><code>{_text(pair.name)}</code></h2>"
    yield f'<p class="{pair.relation}">{_text(verdict(pair, found))}</p>'
    types = about_types(pair, found)
    if types:
        yield f"<p>{_text(types)}</p>"
    if pair.notes:
        yield table(
            ["", _text(found.first.name), _text(found.second.name)],
            [[_text(cell) for cell in note] for note in pair.notes],
        )
    for forbids, allows, states in found.tables(pair):
        yield f"<p>{_text(forbids)} forbids, {_text(allows)} allows:</p>"
        yield table(
            ["state", *state_table.titles(states)],
            [[_text(title), *map(_text, cells)] for title, cells in state_table.rows(states)],
        )


def _only(rules: Sequence[OneSided], lacks: str) -> str:
    lines = (
        f"<li>{one.rule.strength} rule <code>{_text(one.rule.name)}</code>"
        f"{_text(only_why(one, lacks))}</li>"
        for one in rules
    )
    return f"<ul>{''.join(lines)}</ul>"
