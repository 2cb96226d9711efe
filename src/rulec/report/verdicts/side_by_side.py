"""The verdicts of several rulebooks on the same traces or drives, side by side."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.report.text.console import PAGE_WIDTH
from rulec.report.text.terminal_text import stacked_tables, visible
from rulec.report.verdicts.batch_table import BatchTally
from rulec.report.verdicts.verdict_report import OUTCOMES


def as_text(tallies: Sequence[tuple[CompiledRulebook, BatchTally]], width: int = PAGE_WIDTH) -> str:
    """A table with a column per rulebook, and a row per rule violated by at least one of them.

    A number counts the traces or drives that violate the rule. Rulebooks that do not fit into the
    width have a table of their own below.
    """
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
    lines = stacked_tables(
        [tuple(map(visible, row)) for row in rows],
        width,
        ruled=[0, len(names)] if names else [0],
        is_of_numbers=True,
    )
    return "\n".join(lines)


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
