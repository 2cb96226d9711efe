"""The verdicts of several rulebooks on the same traces or drives, side by side."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.report.text.console import PAGE_WIDTH
from rulec.report.text.terminal_text import table_lines, visible
from rulec.report.verdicts.batch_table import BatchTally
from rulec.report.verdicts.verdict_report import OUTCOMES

Tallies = Sequence[tuple[CompiledRulebook, BatchTally]]


def as_text(tallies: Tallies, width: int = PAGE_WIDTH) -> str:
    """A table with a column per rulebook, and a row per rule violated by at least one of them.

    A number counts the traces or drives that violate the rule. Rulebooks that do not fit into the
    width have a table of their own below.
    """
    for number in range(len(tallies), 0, -1):
        lines = _table(tallies[:number])
        if number == 1 or all(len(line) <= width for line in lines):
            rest = ["", *as_text(tallies[number:], width).splitlines()] if tallies[number:] else []
            return "\n".join([*lines, *rest])
    return ""


def _table(tallies: Tallies) -> list[str]:
    names = dict.fromkeys(
        rule.name for rules, total in tallies for rule in rules.rules if total.drives[rule.name]
    )
    rows = [("by", *(rules.name for rules, _ in tallies))]
    rows += [(name, *(_cell(name, *tally) for tally in tallies)) for name in sorted(names)]
    for outcome in OUTCOMES:
        if outcome == "violated" or any(total.outcomes[outcome] for _, total in tallies):
            rows.append((outcome, *(f"{total.outcomes[outcome]:,}" for _, total in tallies)))
    if any(total.not_judged for _, total in tallies):
        rows.append(("not judged", *(f"{total.not_judged:,}" for _, total in tallies)))
    rows.append(("rules not judged", *(f"{_without_any(*tally):,}" for tally in tallies)))
    return table_lines(
        [tuple(map(visible, row)) for row in rows],
        right=range(1, len(tallies) + 1),
        ruled=[0, len(names)] if names else [0],
    )


def _without_any(rules: CompiledRulebook, total: BatchTally) -> int:
    """The number of rules that no trace or drive has a verdict or an open one on."""
    return len({rule.name for rule in rules.rules} - total.with_verdict - {*+total.open_in})


def _cell(name: str, rules: CompiledRulebook, total: BatchTally) -> str:
    if name not in {rule.name for rule in rules.rules}:
        return "no such rule"
    if total.drives[name]:
        return f"{total.drives[name]:,}"
    if total.open_in[name]:
        return "open"
    return "kept" if total.judged_in[name] else "not judged"
