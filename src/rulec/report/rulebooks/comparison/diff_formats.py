"""The difference of two rulebooks as Markdown, CSV or another requested format."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rulec.analysis.diff.rulebook_comparison import RulebookDiff, RulePair
from rulec.report.rulebooks.comparison import diff_overview, diff_text
from rulec.report.rulebooks.comparison.diff_json import as_json
from rulec.report.text.csv_text import csv_text
from rulec.report.text.html_page import as_html
from rulec.report.text.markdown import (
    CONTENTS,
    Block,
    Heading,
    PageTexts,
    code,
    escaped,
    table,
    with_contents,
    written,
)
from rulec.rulebook.vocabulary_phrases import phrases_of

CSV_COLUMNS = ("rule", "relation", "strength 1", "strength 2", "cite 1", "cite 2")


def render(diff: RulebookDiff, output_format: str, width: int, *, in_full: bool) -> str:
    """Write the difference as ``text``, ``markdown``, ``json``, ``html`` or ``csv``.

    Text has a width in characters, and traces only ``in_full``.
    """
    match output_format:
        case "json":
            return as_json(diff)
        case "html":
            texts = PageTexts(_title(diff), CONTENTS, is_closed=len(diff.pairs) > 1)
            return as_html(_as_markdown(diff), texts)
        case "markdown":
            return _as_markdown(diff)
        case "csv":
            rows = (row.values() for row in diff.rows())
            return csv_text([CSV_COLUMNS, *rows], "\n").rstrip("\n")
        case _:
            return (
                diff_text.as_text(diff, width)
                if in_full
                else diff_overview.as_overview(diff, width)
            )


def _as_markdown(rulebook_diff: RulebookDiff) -> str:
    first, second = rulebook_diff.first.name, rulebook_diff.second.name
    top: list[Block] = [Heading(1, _title(rulebook_diff))]
    sentences = [diff_text.summary(rulebook_diff), *diff_text.sides(rulebook_diff)]
    top += [f"{escaped(sentence)}." for sentence in sentences]
    body: list[Block] = []
    for heading, pairs in diff_overview.by_topic(rulebook_diff).items():
        body += [
            Heading(2, heading),
            *(part for pair in pairs for part in _pair(pair, rulebook_diff)),
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
                + (f"\\\n  {escaped(one_sided.rule.says)}" if one_sided.rule.says else "")
                for one_sided in rules
                for offers in (bool(one_sided.alike) and has == first,)
            )
            body += [Heading(2, f"Only in {has}"), "\n".join(only)]
    if rulebook_diff.settings:
        rows = [
            [f"{setting.kind} {code(setting.name)}", code(setting.first), code(setting.second)]
            for setting in rulebook_diff.settings
        ]
        body += [Heading(2, "Set otherwise"), table(["", code(first), code(second)], rows)]
    same = [pair for pair in rulebook_diff.pairs if not diff_overview.differs(pair)]
    if same:
        rows = [[code(pair.name), *_sides(pair.notes)] for pair in same]
        body += [Heading(2, "The same in both"), table(["", code(first), code(second)], rows)]
    return written(with_contents(top, CONTENTS, body))


def _sides(notes: Sequence[tuple[str, str, str]]) -> list[str]:
    """What two rules of the same meaning are noted with, for either rulebook."""
    return [", ".join(escaped(note[side]) for note in notes) for side in (1, 2)]


def _pair(pair: RulePair, rulebook_diff: RulebookDiff) -> Iterator[Block]:
    yield Heading(3, f"{pair.name}: {diff_overview.relation(pair, rulebook_diff)}")
    yield f"{escaped(diff_text.verdict(pair, rulebook_diff))}."
    types = diff_text.about_types(pair, rulebook_diff)
    if types:
        yield f"{escaped(types)}."
    books = rulebook_diff.first.name, rulebook_diff.second.name
    notes = [[escaped(cell) for cell in note] for note in pair.notes]
    says = [escaped(rule.says) for rule in (pair.first, pair.second)]
    if any(says):
        notes.insert(0, ["says", *says])
    if notes:
        yield table(["", *map(code, books)], notes)
    phrases = phrases_of(rulebook_diff.first)
    for forbids, allows, states in rulebook_diff.tables(pair):
        yield Heading(4, f"{forbids} forbids, {allows} allows")
        told = [f"- {escaped(line)}" for line in diff_text.in_words(states, rulebook_diff, phrases)]
        if told:
            yield "\n".join(told)
        yield table(
            ["state", *diff_text.state_titles(states)],
            [[*map(escaped, (title, *cells))] for title, cells in diff_text.table_rows(states)],
        )
        rest = diff_text.left_out(states)
        if rest:
            yield f"By default: {', '.join(map(code, rest))}."


def _title(rulebook_diff: RulebookDiff) -> str:
    return f"{rulebook_diff.first.name} compared to {rulebook_diff.second.name}"
