"""How two rulebooks differ, as text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from textwrap import wrap

import click

from rulec.analysis.diff.rule_comparison import RuleRelation
from rulec.analysis.diff.rulebook_comparison import OneSided, RulebookDiff, RulePair
from rulec.analysis.trace_table import TraceTable
from rulec.report.findings.source_excerpt import visible
from rulec.report.verdicts.trace_table_text import as_lines

WIDTH = 100

COLOURS: dict[RuleRelation, str] = {
    "equal": "green",
    "stricter": "red",
    "laxer": "blue",
    "incomparable": "magenta",
    "undecided": "yellow",
}


def as_text(found: RulebookDiff) -> str:
    """What differs first, what is the same last."""
    one, other = found.first.name, found.second.name
    blocks = [_head(found)]
    blocks += ["\n".join(_pair(pair, found)) for pair in found.pairs if is_worth_a_block(pair)]
    blocks += [_only(found.only_first, one, other)] if found.only_first else []
    blocks += [_only(found.only_second, other, one)] if found.only_second else []
    blocks += [_settings(found)] if found.settings else []
    same = [pair.name for pair in found.pairs if not is_worth_a_block(pair)]
    blocks += ["\n".join(_listed("the same in both: ", same))] if same else []
    blocks.append(summary(found))
    return "\n\n".join(blocks)


def is_worth_a_block(pair: RulePair) -> bool:
    """Is there anything to say of these rules, but that they are the same?"""
    return pair.relation != "equal" or bool(pair.notes)


def _head(found: RulebookDiff) -> str:
    first, second = found.first, found.second
    title = click.style(f"{first.name} compared to {second.name}", bold=True)
    days = f"the law of {first.at}"
    if first.at != second.at:
        days = f"{first.name} is the law of {first.at}, {second.name} that of {second.at}"
    return "\n".join([f"{title}; {days}", *sides(found)])


def sides(found: RulebookDiff) -> list[str]:
    """A line on traffic if it keeps to different sides, which many rules differ by."""
    first, second = found.first, found.second
    if {first.traffic, second.traffic} != {"left", "right"}:
        return []
    ours = f"{first.name} drives on the {first.traffic}"
    return [f"{ours}, {second.name} on the {second.traffic}: near and far change sides"]


def verdict(pair: RulePair, found: RulebookDiff) -> str:
    """The relation in words."""
    one, other = found.first.name, found.second.name
    match pair.relation:
        case "equal":
            return "the same traces are forbidden"
        case "stricter":
            return f"{one} is stricter: it forbids all that {other} forbids, and more"
        case "laxer":
            return f"{one} is laxer: it allows all that {other} allows, and more"
        case "incomparable":
            return "each forbids something that the other allows"
        case _:
            return f"not decided: {pair.comparison.undecided}"


def about_types(pair: RulePair, found: RulebookDiff) -> str:
    """Which objects the comparison is about, where one of the rules speaks of more."""
    if not pair.comparison.common:
        return ""
    heads = [
        f"{book.name} speaks of "
        f"({', '.join(f'{variable.name}: {variable.type}' for variable in rule.variables)})"
        for book, rule in ((found.first, pair.first), (found.second, pair.second))
    ]
    kinds = ", ".join(pair.comparison.common)
    return f"{', '.join(heads)}; of ({kinds}), which both speak of: {pair.comparison.on_common}"


def _pair(pair: RulePair, found: RulebookDiff) -> Iterator[str]:
    name = click.style(pair.name, bold=True)
    words = click.style(visible(verdict(pair, found)), fg=COLOURS[pair.relation])
    yield f"{name}: {words}"
    types = about_types(pair, found)
    if types:
        yield f"  {visible(types)}"
    for what, ours, theirs in pair.notes:
        for number, line in enumerate(
            wrap(visible(f"{what}: {ours} in {found.first.name}, {theirs} in {found.second.name}"))
        ):
            yield f"  {'  ' * (number > 0)}{line}"
    for forbids, allows, table in found.tables(pair):
        yield f"  {forbids} forbids, {allows} allows"
        yield from _table(table)


def _table(table: TraceTable) -> list[str]:
    if not table.rows:
        (first, last), *_ = table.columns
        return [f"    any trace of {last - first + 1} states"]
    return as_lines(table, "    ")


def _only(rules: Sequence[OneSided], has: str, lacks: str) -> str:
    lines = [
        f"  {rule.rule.strength} rule {rule.rule.name}{visible(only_why(rule, lacks))}"
        for rule in rules
    ]
    title = click.style(f"only in {has}", bold=True)
    return "\n".join([title, *lines])


def _settings(found: RulebookDiff) -> str:
    lines = [
        f"  {setting.kind} {setting.name}: {setting.first} in {found.first.name}, "
        f"{setting.second} in {found.second.name}"
        for setting in found.settings
    ]
    return "\n".join([click.style("set otherwise", bold=True), *map(visible, lines)])


def only_why(one: OneSided, lacks: str) -> str:
    """What the other rulebook says of a rule that it does not have."""
    if one.remark is None:
        return ""
    verb = "is silent on it" if one.remark.kind == "silent" else "dropped it"
    because = f': "{one.remark.because}"' if one.remark.because else ""
    return f"; {lacks} {verb}{because}"


def _listed(title: str, names: Sequence[str]) -> list[str]:
    return wrap(f"{title}{', '.join(names)}", WIDTH, subsequent_indent="  ")


def summary(found: RulebookDiff) -> str:
    """The line that ends it."""
    counted = Counter(pair.relation for pair in found.pairs)
    parts = [f"{counted[one]:,} {one}" for one in COLOURS if counted[one]]
    parts += [
        f"{len(rules):,} only in {book.name}"
        for rules, book in ((found.only_first, found.first), (found.only_second, found.second))
        if rules
    ]
    number = len(found.pairs)
    rules = "rule" if number == 1 else "rules"
    return f"{number:,} shared {rules}: {', '.join(parts) or 'nothing to compare'}"
