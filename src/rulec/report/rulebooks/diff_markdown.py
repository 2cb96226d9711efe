"""How two rulebooks differ, in Markdown; ``html_page`` makes a page for a browser of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rulec.analysis.diff.rulebook_comparison import OneSided, RulebookDiff, RulePair
from rulec.report.rulebooks.diff_text import (
    about_types,
    is_worth_a_block,
    only_why,
    sides,
    summary,
    verdict,
)
from rulec.report.text.markdown import code, escaped, table
from rulec.report.verdicts import trace_table_text


def as_markdown(found: RulebookDiff) -> str:
    """A document of its own."""
    one, other = found.first.name, found.second.name
    parts = [f"# {code(one)} compared to {code(other)}", f"{escaped(summary(found))}."]
    parts += [f"{escaped(line)}." for line in sides(found)]
    parts += [part for pair in found.pairs if is_worth_a_block(pair) for part in _pair(pair, found)]
    for rules, has, lacks in ((found.only_first, one, other), (found.only_second, other, one)):
        if rules:
            parts += [f"## Only in {code(has)}", _only(rules, lacks)]
    if found.settings:
        rows = [
            [f"{setting.kind} {code(setting.name)}", code(setting.first), code(setting.second)]
            for setting in found.settings
        ]
        parts += ["## Set otherwise", table(["", code(one), code(other)], rows)]
    same = [code(pair.name) for pair in found.pairs if not is_worth_a_block(pair)]
    if same:
        parts += ["## The same in both", ", ".join(same)]
    return "\n\n".join(parts)


def _pair(pair: RulePair, found: RulebookDiff) -> Iterator[str]:
    yield f"## {code(pair.name)}"
    yield f"{escaped(verdict(pair, found))}."
    types = about_types(pair, found)
    if types:
        yield f"{escaped(types)}."
    if pair.notes:
        yield table(
            ["", code(found.first.name), code(found.second.name)],
            [[escaped(cell) for cell in note] for note in pair.notes],
        )
    for forbids, allows, states in found.tables(pair):
        yield f"A trace that {code(forbids)} forbids and {code(allows)} allows:"
        yield table(
            ["state", *trace_table_text.titles(states)],
            [
                [escaped(title), *map(escaped, cells)]
                for title, cells in trace_table_text.rows(states)
            ],
        )
        rest = trace_table_text.left_out(states)
        if rest:
            yield f"By default: {', '.join(map(code, rest))}."


def _only(rules: Sequence[OneSided], lacks: str) -> str:
    return "\n".join(
        f"- {rule.rule.strength} rule {code(rule.rule.name)}{escaped(only_why(rule, lacks))}"
        for rule in rules
    )
