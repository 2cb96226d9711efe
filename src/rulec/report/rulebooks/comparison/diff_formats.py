"""The difference of two rulebooks as Markdown, CSV or another requested format."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.analysis.diff.rulebook_comparison import RulebookDiff, RulePair
from rulec.report.rulebooks.comparison import diff_text
from rulec.report.rulebooks.comparison.diff_json import as_json
from rulec.report.rulebooks.comparison.diff_overview import as_overview
from rulec.report.text.csv_text import csv_text
from rulec.report.text.markdown import code, escaped, table

CSV_COLUMNS = ("rule", "relation", "strength 1", "strength 2", "cite 1", "cite 2")


def render(diff: RulebookDiff, output_format: str, width: int, *, in_full: bool) -> str:
    """Write the difference as ``text``, ``markdown``, ``json``, ``html`` or ``csv``.

    Text has a width in characters, and traces only ``in_full``.
    """
    match output_format:
        case "json":
            return as_json(diff)
        case "html":
            # markdown-it and Pygments take 0.1 s.
            from rulec.report.text.html_page import PageTexts, as_html

            title = f"{diff.first.name} compared to {diff.second.name}"
            return as_html(_as_markdown(diff), PageTexts(title))
        case "markdown":
            return _as_markdown(diff)
        case "csv":
            rows = (row.values() for row in diff.rows())
            return csv_text([CSV_COLUMNS, *rows], "\n").rstrip("\n")
        case _:
            return diff_text.as_text(diff, width) if in_full else as_overview(diff, width)


def _as_markdown(rulebook_diff: RulebookDiff) -> str:
    first, second = rulebook_diff.first.name, rulebook_diff.second.name
    sentences = [diff_text.summary(rulebook_diff), *diff_text.sides(rulebook_diff)]
    parts = [f"# {code(first)} compared to {code(second)}"]
    parts += [f"{escaped(sentence)}." for sentence in sentences]
    parts += [
        part
        for pair in rulebook_diff.pairs
        if diff_text.is_worth_a_block(pair)
        for part in _pair(pair, rulebook_diff)
    ]
    for rules, has, lacks in (
        (rulebook_diff.only_first, first, second),
        (rulebook_diff.only_second, second, first),
    ):
        if rules:
            only = (
                f"- {one_sided.rule.strength} rule {code(one_sided.rule.name)}"
                f"{escaped(diff_text.only_why(one_sided, lacks))}"
                + (f"; {escaped(diff_text.offered(one_sided))}" if offers else "")
                for one_sided in rules
                for offers in (bool(one_sided.alike) and has == first,)
            )
            parts += [f"## Only in {code(has)}", "\n".join(only)]
    if rulebook_diff.settings:
        rows = [
            [f"{setting.kind} {code(setting.name)}", code(setting.first), code(setting.second)]
            for setting in rulebook_diff.settings
        ]
        parts += ["## Set otherwise", table(["", code(first), code(second)], rows)]
    same = [code(pair.name) for pair in rulebook_diff.pairs if not diff_text.is_worth_a_block(pair)]
    if same:
        parts += ["## The same in both", ", ".join(same)]
    return "\n\n".join(parts)


def _pair(pair: RulePair, rulebook_diff: RulebookDiff) -> Iterator[str]:
    yield f"## {code(pair.name)}"
    yield f"{escaped(diff_text.verdict(pair, rulebook_diff))}."
    types = diff_text.about_types(pair, rulebook_diff)
    if types:
        yield f"{escaped(types)}."
    if pair.notes:
        yield table(
            ["", code(rulebook_diff.first.name), code(rulebook_diff.second.name)],
            [[escaped(cell) for cell in note] for note in pair.notes],
        )
    for forbids, allows, states in rulebook_diff.tables(pair):
        yield f"A trace that {code(forbids)} forbids and {code(allows)} allows:"
        rows = diff_text.table_rows(states)
        yield table(
            ["state", *diff_text.state_titles(states)],
            [[*map(escaped, (title, *cells))] for title, cells in rows],
        )
        rest = diff_text.left_out(states)
        if rest:
            yield f"By default: {', '.join(map(code, rest))}."
