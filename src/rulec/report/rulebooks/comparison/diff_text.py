"""Differences of two rulebooks as text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from rulec.analysis.diff.rule_comparison import RuleRelation
from rulec.analysis.diff.rulebook_comparison import OneSided, RulebookDiff, RulePair
from rulec.analysis.trace_display import SignalRow, TraceTable
from rulec.logic.sentences.fact_clauses import facts_in_words
from rulec.report.text.terminal_text import broken, stacked_tables, styled, visible
from rulec.report.verdicts.violation_table import shown
from rulec.rulebook.vocabulary_phrases import phrases_of
from rulec.trace import Value

_INDENT = "    "

MOST_ROWS = 8
"""A table with more rows omits those that have the default in all states."""

NO_SIGN = {("limit", "km/h", 1000), ("minimum_limit", "km/h", 0)}
"""Values of the vocabulary `road` that mean no sign: word, unit and number."""

COLOURS: dict[RuleRelation, str] = {
    "equal": "green",
    "stricter": "red",
    "laxer": "blue",
    "incomparable": "magenta",
    "undecided": "yellow",
}


def as_text(rulebook_diff: RulebookDiff, width: int) -> str:
    """Write the differences first, with traces that show them, and the agreements last."""
    first, second = rulebook_diff.first.name, rulebook_diff.second.name
    blocks = ["\n".join(head(rulebook_diff, width))]
    blocks += [
        "\n".join(_pair(pair, rulebook_diff, width))
        for pair in rulebook_diff.pairs
        if is_worth_a_block(pair)
    ]
    blocks += [
        "\n".join(_only(rules, (has, lacks), width, from_first=rules is rulebook_diff.only_first))
        for rules, has, lacks in (
            (rulebook_diff.only_first, first, second),
            (rulebook_diff.only_second, second, first),
        )
        if rules
    ]
    if rulebook_diff.settings:
        written = [
            line
            for text in settings(rulebook_diff)
            for line in broken(visible(text), width, "  ", "    ")
        ]
        blocks.append("\n".join([styled("set otherwise", "bold"), *written]))
    same = [pair.name for pair in rulebook_diff.pairs if not is_worth_a_block(pair)]
    agreeing = f"the same in both: {', '.join(same)}"
    blocks += ["\n".join(broken(visible(agreeing), width, later="  "))] if same else []
    blocks.append("\n".join(broken(summary(rulebook_diff), width)))
    return "\n\n".join(blocks)


def settings(rulebook_diff: RulebookDiff) -> list[str]:
    """What the two set differently, a text for each option or parameter."""
    first, second = rulebook_diff.first.name, rulebook_diff.second.name
    return [
        f"{pair.kind} {pair.name}: {pair.first} in {first}, {pair.second} in {second}"
        for pair in rulebook_diff.settings
    ]


def is_worth_a_block(pair: RulePair) -> bool:
    """Whether there is more to say about two rules than that they are equal."""
    return pair.relation != "equal" or bool(pair.notes)


def head(rulebook_diff: RulebookDiff, width: int) -> list[str]:
    """The names of both rulebooks, the days of their laws, and the sides of traffic."""
    first, second = rulebook_diff.first, rulebook_diff.second
    days = f"the law of {first.at}"
    if first.at != second.at:
        days = f"{first.name} is the law of {first.at}, {second.name} that of {second.at}"
    texts = [f"{first.name} compared to {second.name}; {days}", *sides(rulebook_diff)]
    return [line for text in texts for line in broken(visible(text), width, later="  ")]


def sides(rulebook_diff: RulebookDiff) -> list[str]:
    """A line on the side of traffic, if the rulebooks differ in it."""
    first, second = rulebook_diff.first, rulebook_diff.second
    if {first.traffic, second.traffic} != {"left", "right"}:
        return []
    ours = f"{first.name} drives on the {first.traffic}"
    return [f"{ours}, {second.name} on the {second.traffic}: near and far change sides"]


def verdict(pair: RulePair, rulebook_diff: RulebookDiff) -> str:
    """The relation of the two rules in words."""
    first, second = rulebook_diff.first.name, rulebook_diff.second.name
    match pair.relation:
        case "equal":
            return "the same traces are forbidden"
        case "stricter":
            return f"{first} is stricter: it forbids all that {second} forbids, and more"
        case "laxer":
            return f"{first} is laxer: it allows all that {second} allows, and more"
        case "incomparable":
            return "each forbids something that the other allows"
        case _:
            return f"not decided: {pair.comparison.undecided}"


def about_types(pair: RulePair, rulebook_diff: RulebookDiff) -> str:
    """The object types compared, if they differ: which the two share, and which one lacks."""
    common = pair.comparison.common
    if common is None:
        return ""
    sides = ((rulebook_diff.first, pair.first), (rulebook_diff.second, pair.second))
    heads = ", ".join(
        f"{book.name} speaks of "
        f"({', '.join(f'{variable.name}: {variable.type}' for variable in rule.variables)})"
        for book, rule in sides
    )
    lacks = [
        f"{book.name} has no type {kind}"
        for (book, _), (_, rule) in (sides, sides[::-1])
        for kind in dict.fromkeys(variable.type for variable in rule.variables)
        if kind not in book.vocabulary.types
    ]
    shared = "no objects are of both kinds"
    if common:
        shared = f"of ({', '.join(common)}), which both speak of: {pair.comparison.on_common}"
    return "; ".join([heads, shared, *([", ".join(lacks)] if lacks else [])])


def _pair(pair: RulePair, rulebook_diff: RulebookDiff, width: int) -> Iterator[str]:
    said = visible(f"{pair.name}: {verdict(pair, rulebook_diff)}")
    yield from (styled(line, COLOURS[pair.relation]) for line in broken(said, width, later="  "))
    types = about_types(pair, rulebook_diff)
    if types:
        yield from broken(visible(types), width, "  ", "    ")
    book, other = rulebook_diff.first.name, rulebook_diff.second.name
    for part, ours, theirs in pair.notes:
        note = f"{part}: {ours} in {book}, {theirs} in {other}"
        yield from broken(visible(note), width, "  ", "    ")
    phrases = phrases_of(rulebook_diff.first)
    for forbids, allows, table in rulebook_diff.tables(pair):
        yield f"  {forbids} forbids, {allows} allows"
        if table.rows:
            yield from _table_lines(table, width)
            for line in in_words(table, rulebook_diff, phrases):
                yield from broken(visible(line), width, _INDENT, f"{_INDENT}  ")
        else:
            start, end = table.columns[0]
            yield f"    any trace of {end - start + 1} states"


def in_words(
    table: TraceTable, rulebook_diff: RulebookDiff, phrases: Mapping[str, str]
) -> Iterator[str]:
    """What changes in each state, as a sentence for each."""
    for place, title in enumerate(state_titles(table)):
        facts = []
        for row in table.rows:
            value = row.values[place]
            before = row.values[place - 1] if place else None
            if value is not None and not row.is_default and (not place or value != before):
                facts.append((row.title, value, shown(value)))
        words = facts_in_words(facts, rulebook_diff.first.vocabulary, phrases)
        if words:
            yield f"{title}: {words}"


def _only(
    rules: Sequence[OneSided], names: tuple[str, str], width: int, *, from_first: bool
) -> Iterator[str]:
    """The rules that the first of two rulebooks has, and the second lacks."""
    has, lacks = names
    yield styled(f"only in {has}", "bold")
    for rule in rules:
        about = f"{rule.rule.strength} rule {rule.rule.name}{only_why(rule, lacks)}"
        yield from broken(visible(about), width, "  ", "    ")
        # Once for both: the other rulebook would offer the same pairs.
        if from_first and rule.alike:
            yield from broken(visible(offered(rule)), width, "    ", "      ")


def only_why(one_sided: OneSided, lacks: str) -> str:
    """The remark of the rulebook that lacks a rule."""
    if one_sided.remark is None:
        return ""
    verb = "is silent on it" if one_sided.remark.kind == "silent" else "dropped it"
    because = f': "{one_sided.remark.because}"' if one_sided.remark.because else ""
    source = one_sided.remark.book
    inherited = "" if source == lacks else f", as {source} {'is' if 'is' in verb else 'has'}"
    return f"; {lacks} {verb}{inherited}{because}"


def offered(one_sided: OneSided) -> str:
    """How to compare a rule of the first rulebook with rules that read the same words."""
    ways = [f"--pair {one_sided.rule.name}={name}" for name in one_sided.alike]
    return f"reads the same words as {' and '.join(one_sided.alike)}: {' or '.join(ways)}"


def summary(rulebook_diff: RulebookDiff) -> str:
    """The summary line."""
    counted = Counter(pair.relation for pair in rulebook_diff.pairs)
    parts = [f"{counted[relation]:,} {relation}" for relation in COLOURS if counted[relation]]
    parts += [
        f"{len(rules):,} only in {book.name}"
        for rules, book in (
            (rulebook_diff.only_first, rulebook_diff.first),
            (rulebook_diff.only_second, rulebook_diff.second),
        )
        if rules
    ]
    number = len(rulebook_diff.pairs)
    noun = "rule" if number == 1 else "rules"
    return f"{number:,} shared {noun}: {', '.join(parts) or 'nothing to compare'}"


def state_titles(table: TraceTable) -> list[str]:
    """For each column the numbers of its states."""
    return [str(first) if first == last else f"{first}-{last}" for first, last in table.columns]


def table_rows(table: TraceTable) -> list[tuple[str, list[str]]]:
    """The title and cells of each row."""
    return [
        (
            visible(f"{row.title} in {row.unit}" if row.unit else row.title),
            [_cell(row, value) for value in row.values],
        )
        for row in table.rows
        if not (row.is_default and len(table.rows) > MOST_ROWS)
    ]


def _cell(row: SignalRow, value: Value | None) -> str:
    if (row.title, row.unit, value) in NO_SIGN:
        return "no sign"
    return "" if value is None else shown(value)


def left_out(table: TraceTable) -> list[str]:
    """Names without a row, because all their values are defaults."""
    usual = [visible(row.title) for row in table.rows if row.is_default]
    return usual if len(table.rows) > MOST_ROWS else []


def _table_lines(table: TraceTable, width: int) -> list[str]:
    whole = [("state", state_titles(table)), *table_rows(table)]
    titled = [(f"{title} ", *cells) for title, cells in whole]
    lines = stacked_tables(titled, width, indent=_INDENT, ruled=(0,))
    rest = left_out(table)
    return lines + broken(f"by default: {', '.join(rest)}" if rest else "", width, _INDENT, _INDENT)
