"""The difference of two rulebooks as Markdown, CSV or another requested format."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal

from msgspec import UNSET, UnsetType

from rulec.analysis.diff.rule_comparison import RuleRelation
from rulec.analysis.diff.rulebook_comparison import OneSided, RulebookDiff, RulePair, SettingPair
from rulec.logic.printing import number_in_words
from rulec.report.json_document import JsonDocument, JsonPart, as_indented, filled
from rulec.report.rulebooks.comparison import diff_text
from rulec.report.rulebooks.rule_list import first_provision
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
from rulec.report.text.outgoing import csv_text
from rulec.report.text.terminal_text import broken, cell_width, column_lines, visible
from rulec.rulebook.rulebook_model import Certainty, Strength, Variable
from rulec.rulebook.rules.rule_topics import OTHER, by_group
from rulec.rulebook.vocabulary_phrases import phrases_of
from rulec.trace import Trace
from rulec.trace.trace_model import Ending

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
            return diff_text.as_text(diff, width) if in_full else as_overview(diff, width)


def _as_markdown(rulebook_diff: RulebookDiff) -> str:
    first, second = rulebook_diff.first.name, rulebook_diff.second.name
    top: list[Block] = [Heading(1, _title(rulebook_diff))]
    sentences = [diff_text.summary(rulebook_diff), *diff_text.sides(rulebook_diff)]
    top += [f"{escaped(sentence)}." for sentence in sentences]
    body: list[Block] = []
    for heading, pairs in by_topic(rulebook_diff).items():
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
    same = [pair for pair in rulebook_diff.pairs if not differs(pair)]
    if same:
        rows = [[code(pair.name), *_sides(pair.notes)] for pair in same]
        body += [Heading(2, "The same in both"), table(["", code(first), code(second)], rows)]
    return written(with_contents(top, CONTENTS, body))


def _sides(notes: Sequence[tuple[str, str, str]]) -> list[str]:
    """What two rules of the same meaning are noted with, for either rulebook."""
    return [", ".join(escaped(note[side]) for note in notes) for side in (1, 2)]


def _pair(pair: RulePair, rulebook_diff: RulebookDiff) -> Iterator[Block]:
    yield Heading(3, f"{pair.name}: {relation(pair, rulebook_diff)}")
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


def as_overview(rulebook_diff: RulebookDiff, width: int) -> str:
    """Counts, a line for each rule that differs, by topic, and what only one of the two has."""
    first, second = rulebook_diff.first.name, rulebook_diff.second.name
    lines = diff_text.head(rulebook_diff, width)
    rows = list(_rows(rulebook_diff))
    lines += [diff_text.summary(rulebook_diff), *column_lines(rows, width)]
    for book, rules in ((first, rulebook_diff.only_first), (second, rulebook_diff.only_second)):
        lines += _packed(f"only in {book}", [one.rule.name for one in rules], width)
    lines += _packed("set otherwise", diff_text.settings(rulebook_diff), width)
    if rows:
        lines.append("a RULE's name, too, shows traces on which it differs, -v those of all")
    return "\n".join(line for text in lines for line in broken(text, width, later="  "))


def differs(pair: RulePair) -> bool:
    """Whether two rules forbid different traces, or with another strength."""
    return pair.relation != "equal" or pair.first.strength != pair.second.strength


def by_topic(rulebook_diff: RulebookDiff) -> dict[str, list[RulePair]]:
    """The rules that differ, below the headings of their topics."""
    pairs = {pair.first.name: pair for pair in rulebook_diff.pairs if differs(pair)}
    return {
        visible(heading): differing
        for heading, names in by_group([rulebook_diff.first]).items()
        if (differing := [pairs[name] for name in names if name in pairs])
    }


def _rows(rulebook_diff: RulebookDiff) -> Iterator[tuple[str, ...]]:
    groups = by_topic(rulebook_diff)
    indent = 0 if groups.keys() == {OTHER} else max(map(cell_width, groups), default=0)
    for heading, differing in groups.items():
        for number, pair in enumerate(differing):
            about = heading if indent and not number else ""
            cites = dict.fromkeys(map(first_provision, (pair.first, pair.second)))
            yield (
                about + " " * (indent - cell_width(about)),
                visible(pair.name),
                visible(relation(pair, rulebook_diff)),
                visible(" | ".join(filter(None, cites))),
            )


def relation(pair: RulePair, rulebook_diff: RulebookDiff) -> str:
    """How two rules that differ relate, in two or three words."""
    match pair.relation:
        case "equal":
            soft_in = rulebook_diff.first if pair.first.strength == "soft" else rulebook_diff.second
            return f"soft in {soft_in.name}"
        case "stricter":
            return f"{rulebook_diff.first.name} stricter"
        case "laxer":
            return f"{rulebook_diff.second.name} stricter"
        case "incomparable":
            return "each stricter"
        case _:
            return "not decided"


def _packed(title: str, texts: Sequence[str], width: int) -> list[str]:
    """A title with texts beside it, none if there are no texts."""
    if not texts:
        return []
    return broken(visible(f"{title}: {', '.join(texts)}"), width, later="  ")


class BookData(JsonPart, frozen=True, kw_only=True):
    """A rulebook, and the day whose law it is."""

    name: str
    title: str
    at: str


class RuleSide(JsonPart, frozen=True, kw_only=True):
    """A rule as in one rulebook, with its exact weight."""

    strength: Strength
    variables: Sequence[Variable]
    level: str | None
    weight: str
    cite: str
    says: str
    certainty: Certainty
    book: str


class TraceData(JsonPart, frozen=True, kw_only=True):
    """A trace, as docs/traces.md describes it."""

    id: str
    step_s: float
    objects: Mapping[str, str]
    states: Sequence[Mapping[str, Any]]
    present: Mapping[str, tuple[int, int]] | UnsetType = UNSET
    ends: Ending | UnsetType = UNSET
    told: Sequence[str] | UnsetType | None = UNSET


class RulePairData(JsonPart, frozen=True, kw_only=True):
    """A rule of both rulebooks; the relation is that of the first to the second.

    If they refer to different types of objects, they are compared on the common ones; with an empty
    list of them no object is of the types of both.
    """

    rule: str
    second_rule: str
    relation: RuleRelation
    undecided: str | None
    first: RuleSide
    second: RuleSide
    common_types: Sequence[str] | None
    on_common_types: RuleRelation | None
    first_forbids: Sequence[TraceData]
    second_forbids: Sequence[TraceData]


class OneSidedRule(RuleSide, frozen=True, kw_only=True):
    """A rule of one rulebook, with the other one's remark on it."""

    rule: str
    remark: Literal["dropped", "silent", "softened"] | None
    because: str | None
    alike: Sequence[str]


class DiffDocument(JsonDocument, frozen=True, kw_only=True):
    """The rules of two rulebooks side by side."""

    first: BookData
    second: BookData
    rules: Sequence[RulePairData]
    only_first: Sequence[OneSidedRule]
    only_second: Sequence[OneSidedRule]
    settings: Sequence[SettingPair]


def as_json(diff: RulebookDiff) -> str:
    """Write one object."""
    return as_indented(
        filled(
            DiffDocument,
            diff,
            rules=list(map(_pair_data, diff.pairs)),
            only_first=list(map(_one_sided_data, diff.only_first)),
            only_second=list(map(_one_sided_data, diff.only_second)),
        )
    )


def _pair_data(pair: RulePair) -> RulePairData:
    comparison = pair.comparison
    return filled(
        RulePairData,
        pair,
        rule=pair.first.name,
        second_rule=pair.second.name,
        undecided=comparison.undecided or None,
        first=filled(RuleSide, pair.first, weight=number_in_words(pair.first.weight)),
        second=filled(RuleSide, pair.second, weight=number_in_words(pair.second.weight)),
        common_types=comparison.common,
        on_common_types=comparison.on_common,
        first_forbids=list(map(_trace, comparison.first_forbids)),
        second_forbids=list(map(_trace, comparison.second_forbids)),
    )


def _one_sided_data(one_sided: OneSided) -> OneSidedRule:
    rule, remark = one_sided.rule, one_sided.remark
    kind, because = (remark.kind, remark.because) if remark else (None, None)
    own = {"rule": rule.name, "remark": kind, "because": because, "alike": one_sided.alike}
    return filled(OneSidedRule, rule, weight=number_in_words(rule.weight), **own)


def _trace(trace: Trace) -> TraceData:
    return filled(TraceData, trace, ends=UNSET, told=UNSET)
