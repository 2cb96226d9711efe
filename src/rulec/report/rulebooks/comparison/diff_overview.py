"""Where two rulebooks differ, a line a rule."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rulec.analysis.diff.rulebook_comparison import RulebookDiff, RulePair
from rulec.report.rulebooks.comparison import diff_text
from rulec.report.rulebooks.rule_list import first_provision
from rulec.report.text.terminal_text import broken, cell_width, column_lines, visible
from rulec.rulebook.rules.rule_topics import OTHER, by_group


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
