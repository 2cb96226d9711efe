"""The verdicts on many recordings, summed up in one table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.verdict import Verdict, VerdictOutcome
from rulec.report.text.console import PAGE_WIDTH
from rulec.report.text.terminal_text import (
    broken,
    counted,
    cut,
    stacked_tables,
    table_lines,
    visible,
)
from rulec.report.verdicts import verdict_report
from rulec.report.verdicts.verdict_report import OUTCOMES

if TYPE_CHECKING:
    from rulec.report.verdicts.violation_tally import ViolationTally


@dataclass
class BatchTally:
    """Verdicts on recordings, summed up per rule.

    ``drives`` and ``recordings``: rule -> the number of them in which it is violated; ``first``:
    rule -> file, drive and time (s) of its first violation. ``outcomes`` counts drives.
    """

    outcomes: Counter[VerdictOutcome] = field(default_factory=Counter)
    not_judged: int = 0
    judged_recordings: int = 0
    drives: Counter[str] = field(default_factory=Counter)
    recordings: Counter[str] = field(default_factory=Counter)
    open_in: Counter[str] = field(default_factory=Counter)
    judged_in: Counter[str] = field(default_factory=Counter)
    first: dict[str, tuple[str, str, float]] = field(default_factory=dict)

    def add(self, file: str, tally: ViolationTally) -> None:
        """Add a recording."""
        self.judged_recordings += 1
        self.outcomes.update({outcome: len(drives) for outcome, drives in tally.drives.items()})
        self.not_judged += len(tally.not_judged)
        self.judged_in.update({rule: tally.judged_in[rule] for rule in tally.with_answer})
        self.open_in.update(dict.fromkeys(tally.open_rules, 1))
        for rule, times in tally.first_s.items():
            self.drives[rule] += len(times)
            self.recordings[rule] += 1
            ego = min(times, key=lambda name: times[name])
            self.first.setdefault(rule, (file, ego, times[ego]))

    def add_trace(self, verdict: Verdict, rules: Collection[str]) -> None:
        """Add the verdict on a trace by these rules."""
        self.outcomes[verdict.outcome] += 1
        if verdict.violations:
            self.drives.update({violation.rule for violation in verdict.violations})
        if verdict.open or verdict.not_judged:
            is_open = {open_verdict.rule for open_verdict in verdict.open}
            self.open_in.update(is_open)
            rules = set(rules) - is_open - {rule.rule for rule in verdict.not_judged}
        self.judged_in.update(rules)

    @staticmethod
    def sum_of(tallies: Iterable[BatchTally]) -> BatchTally:
        """The sum of tallies by the same rulebook, without ``first`` and ``recordings``."""
        total = BatchTally()
        for tally in tallies:
            total.not_judged += tally.not_judged
            for counts in ("outcomes", "drives", "open_in", "judged_in"):
                getattr(total, counts).update(getattr(tally, counts))
        return total

    @property
    def with_verdict(self) -> set[str]:
        """The rules with a verdict in some drive."""
        return {*+self.judged_in, *+self.drives}

    @property
    def judged(self) -> int:
        """The number of drives that have a verdict."""
        return self.outcomes.total()


def as_text(
    total: BatchTally, rules: CompiledRulebook, unread: Sequence[str], width: int = PAGE_WIDTH
) -> str:
    """A table of the violations in all recordings, and the summary line of the run."""
    recordings = counted(total.judged_recordings, "recording")
    lines = [f"altogether  {recordings} with {counted(total.judged, 'drive')}"]
    if unread:
        lines.append(f"not read    {counted(len(unread), 'file')}, as said above")
    is_open = {*+total.open_in}
    counts = verdict_report.rule_counts(
        rules.rules, total.with_verdict, is_open, "these recordings"
    )
    lines += broken(f"rules       {counts}", width, later=" " * 12)
    violated = [rule for rule in rules.rules if rule.name in total.drives]
    if violated:
        rows = [("violated", "", " drives", " recordings")]
        most = width - len("  hard  1,000/1,000  recordings")
        rows += [
            (
                cut(visible(verdict_report.short_title(rule)), most),
                rule.strength,
                f"{total.drives[rule.name]:,}/{total.judged:,}",
                f"{total.recordings[rule.name]:,}/{total.judged_recordings:,}",
            )
            for rule in violated
        ]
        head, *table = table_lines(rows, right=(2, 3))
        lines += ["", cut(visible(head), width)]
        for rule, line in zip(violated, table, strict=True):
            file, ego, at = total.first[rule.name]
            lines.append(cut(visible(line), width))
            lines += broken(visible(f"first: {ego} at {at:g} s in {file}"), width, "  ", "    ")
    lines.append(verdict_report.summary(total.outcomes, total.not_judged, "drive"))
    return "\n".join(lines)


def as_columns(
    tallies: Sequence[tuple[CompiledRulebook, BatchTally]], width: int = PAGE_WIDTH
) -> str:
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
