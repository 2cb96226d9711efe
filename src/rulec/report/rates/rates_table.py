"""Rates as text, Markdown, CSV and JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from types import GenericAlias
from typing import get_type_hints

from rulec.rates.exact_intervals import Interval
from rulec.rates.rule_rates import Rate, RuleRates, ViolationRates
from rulec.report.json_document import JsonDocument, JsonPart, as_indented, filled, made_class
from rulec.report.text import markdown
from rulec.report.text.outgoing import csv_text
from rulec.report.text.terminal_text import broken, counted, cut, stacked_tables, visible

_HEAD = ("rule", "opportunities", "violated", "per hour", "per 1000 km", "per opportunity")


def as_text(rates: ViolationRates, width: int) -> str:
    """Two tables for each group; the interval over drives is in braces below each rate.

    Columns of rates that a width in characters has no room for go on below.
    """
    lines = [row for line in _about(rates) for row in broken(visible(line), width)]
    for group, rules in _groups(rates):
        tested = [rule for rule in rules if _is_tested(rule)]
        lines += ["", *([f"{group}: {_size(rules)}"] if group else [_size(rules)])]
        counts: list[Sequence[str]] = [_HEAD[:3]]
        shares: list[Sequence[str]] = [(_HEAD[0], *_HEAD[3:])]
        for rule in tested:
            title, most, violated, *rated = _cells(rule)
            title = cut(visible(title), width // 2)
            counts.append((title, most, violated))
            shares += [(title, *rated), *(("", *more) for more in _below(rule))]
        for rows in (counts, shares) if tested else ():
            lines += ["", *stacked_tables(rows, width, indent="  ", is_of_numbers=True)]
        for line in _others(rules):
            lines += broken(visible(line), width, "  ", "    ")
    return "\n".join(visible(line.rstrip()) for line in lines)


def as_markdown(rates: ViolationRates) -> str:
    """A table for each group."""
    blocks: list[markdown.Block] = [
        markdown.Heading(1, "How often rules are violated"),
        *(markdown.escaped(line) for line in _about(rates)),
    ]
    for group, rules in _groups(rates):
        if group:
            blocks.append(markdown.Heading(2, group))
        blocks.append(markdown.escaped(_size(rules)))
        rows = [
            [
                markdown.escaped(" ".join(text for text in texts if text))
                for texts in zip(
                    _cells(rule), *(("", "", "", *more) for more in _below(rule)), strict=True
                )
            ]
            for rule in rules
            if _is_tested(rule)
        ]
        if rows:
            blocks.append(markdown.table(_HEAD, rows))
        blocks += [markdown.escaped(line) for line in _others(rules)]
    return markdown.written(blocks)


def as_csv(rates: ViolationRates) -> str:
    """A row for each rule and group, after a header row."""
    rows = rates.rows()
    return csv_text([*rows[:1], *(row.values() for row in rows)]).rstrip("\r\n")


def _about(rates: ViolationRates) -> Iterator[str]:
    percent = f"{100 * rates.confidence:g} %"
    for by in rates.judged_by:
        chosen = [f"rulec {by.rulec}", *filter(None, (by.thresholds, by.assumptions))]
        yield f"rulebook {by.rulebook} ({by.rulebook_hash[:8]}), {', '.join(chosen)}"
    left_out = f"; {rates.not_judged:,} without a verdict" if rates.not_judged else ""
    yield f"{counted(rates.drives, 'drive')}{left_out}"
    yield (
        f"In parentheses {percent} intervals for independent opportunities, in braces over drives "
        f"({rates.replicates:,} times drawn again, seed {rates.seed}), in brackets for independent "
        "drives of any kind."
    )


def _groups(rates: ViolationRates) -> Iterator[tuple[str, list[RuleRates]]]:
    def group_of(rule: RuleRates) -> tuple[str, ...]:
        return (*rule.group, rule.rulebook)

    for _, own in groupby(rates.rules, key=group_of):
        rules = list(own)
        yield group_title(rules[0].group, rates.by), rules


def group_title(group: Sequence[str], by: Sequence[str]) -> str:
    """A group as names and values of its properties."""
    pairs = zip(by, group, strict=True)
    return ", ".join(f"{name} {value or 'unknown'}" for name, value in pairs)


def _size(rules: Sequence[RuleRates]) -> str:
    most = max(rules, key=lambda rule: rule.drives)
    far = "" if most.km is None else f", {number(most.km)} km"
    return f"{counted(most.drives, 'drive')}, {number(most.hours)} h{far}"


def _is_tested(rule: RuleRates) -> bool:
    return bool(rule.perhaps_opportunities or rule.perhaps_violated)


def _others(rules: Sequence[RuleRates]) -> Iterator[str]:
    judged = [rule.rule for rule in rules if rule.drives and not _is_tested(rule)]
    if judged:
        yield f"no opportunity: {', '.join(judged)}"
    not_judged = [rule.rule for rule in rules if not rule.drives]
    if not_judged:
        yield f"not judged: {', '.join(not_judged)}"


def _cells(rule: RuleRates) -> list[str]:
    title = f"{rule.rule} [{rule.provision}]" if rule.provision else rule.rule
    return [
        title,
        _between(rule.opportunities, rule.perhaps_opportunities),
        _between(rule.violated, rule.perhaps_violated),
        *(_rate(rate) for rate in rates_of(rule)),
    ]


def rates_of(rule: RuleRates) -> tuple[Rate | None, ...]:
    """The rates of a rule in the order of the table."""
    return rule.per_hour, rule.per_1000_km, rule.per_opportunity


def _below(rule: RuleRates) -> Iterator[list[str]]:
    """The other intervals: over drives in braces, of clusters in brackets."""
    rates = rates_of(rule)
    if any(rate is not None and rate.bootstrap is not None for rate in rates):
        yield [
            "" if rate is None or rate.bootstrap is None else f"{{{_interval(rate.bootstrap)}}}"
            for rate in rates
        ]
    yield ["" if rate is None else f"[{_interval(rate.clustered)}]" for rate in rates]


def _rate(rate: Rate | None) -> str:
    if rate is None:
        return "-"
    value = number(rate.least)
    if number(rate.most) != value:
        value = f"{value} to {number(rate.most)}"
    return f"{value} ({_interval(rate.exact)})"


def _interval(interval: Interval) -> str:
    low, high = interval
    return f"{number(low)} to {number(high)}"


def _between(least: int, most: int) -> str:
    return f"{least:,}" if least == most else f"{least:,} to {most:,}"


def number(value: float) -> str:
    """A number with three significant digits."""
    if value >= 1000:
        return f"{value:,.0f}"
    return f"{value:.3g}" if value >= 0.001 or value == 0 else f"{value:.1e}"


class JudgedByData(JsonPart, frozen=True, kw_only=True):
    """What drives were judged by."""

    rulebook: str
    rulebook_hash: str
    rulec: str
    thresholds: str
    assumptions: str


RuleRatesData = made_class(
    "RuleRatesData",
    {**get_type_hints(RuleRates), "group": dict[str, str]},
    "The rates of a rule in a group; see docs/rates.md.",
)
_PARTS = {"judged_by": list[JudgedByData], "rules": GenericAlias(list, RuleRatesData)}
RatesDocument = made_class(
    "RatesDocument",
    {**get_type_hints(ViolationRates), **_PARTS},
    "The output of ``rulec rates --json``.",
    JsonDocument,
)


def as_json(rates: ViolationRates) -> str:
    """Write rates over several lines."""
    rules = [
        filled(RuleRatesData, rule, group=dict(zip(rates.by, rule.group, strict=True)))
        for rule in rates.rules
    ]
    return as_indented(filled(RatesDocument, rates, rules=rules))
