"""Differences of two rulebooks in Markdown; ``html_page`` makes HTML of it."""

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


def as_markdown(rulebook_diff: RulebookDiff) -> str:
    """A document of its own."""
    one, other = rulebook_diff.first.name, rulebook_diff.second.name
    parts = [f"# {code(one)} compared to {code(other)}", f"{escaped(summary(rulebook_diff))}."]
    parts += [f"{escaped(line)}." for line in sides(rulebook_diff)]
    parts += [
        part
        for pair in rulebook_diff.pairs
        if is_worth_a_block(pair)
        for part in _pair(pair, rulebook_diff)
    ]
    for rules, has, lacks in (
        (rulebook_diff.only_first, one, other),
        (rulebook_diff.only_second, other, one),
    ):
        if rules:
            parts += [f"## Only in {code(has)}", _only(rules, lacks)]
    if rulebook_diff.settings:
        rows = [
            [f"{setting.kind} {code(setting.name)}", code(setting.first), code(setting.second)]
            for setting in rulebook_diff.settings
        ]
        parts += ["## Set otherwise", table(["", code(one), code(other)], rows)]
    same = [code(pair.name) for pair in rulebook_diff.pairs if not is_worth_a_block(pair)]
    if same:
        parts += ["## The same in both", ", ".join(same)]
    return "\n\n".join(parts)


def _pair(pair: RulePair, rulebook_diff: RulebookDiff) -> Iterator[str]:
    yield f"## {code(pair.name)}"
    yield f"{escaped(verdict(pair, rulebook_diff))}."
    types = about_types(pair, rulebook_diff)
    if types:
        yield f"{escaped(types)}."
    if pair.notes:
        yield table(
            ["", code(rulebook_diff.first.name), code(rulebook_diff.second.name)],
            [[escaped(cell) for cell in note] for note in pair.notes],
        )
    for forbids, allows, states in rulebook_diff.tables(pair):
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
