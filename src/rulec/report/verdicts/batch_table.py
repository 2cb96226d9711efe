"""The verdicts on many recordings, summed up in one table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.verdict import Verdict
from rulec.report.text.terminal_text import counted, table_lines, visible
from rulec.report.verdicts import verdict_report

if TYPE_CHECKING:
    from rulec.extraction.recording_verdicts import ViolationTally


@dataclass
class BatchTally:
    """Verdicts on recordings, summed up per rule.

    ``drives`` and ``recordings``: rule -> the number of them in which it is violated; ``first``:
    rule -> file, drive and time (s) of its first violation. ``satisfied`` etc. count drives.
    """

    satisfied: int = 0
    violated: int = 0
    doubtful: int = 0
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
        self.satisfied += len(tally.satisfied)
        self.violated += len(tally.violated)
        self.doubtful += len(tally.doubtful)
        self.not_judged += len(tally.not_judged)
        self.judged_in.update(tally.judged_in)
        self.open_in.update(dict.fromkeys(tally.open_rules, 1))
        for rule, times in tally.first_s.items():
            self.drives[rule] += len(times)
            self.recordings[rule] += 1
            ego = min(times, key=lambda name: times[name])
            self.first.setdefault(rule, (file, ego, times[ego]))

    def add_trace(self, verdict: Verdict, rules: Collection[str]) -> None:
        """Add the verdict on a trace by these rules."""
        satisfied = verdict.satisfied
        self.satisfied += satisfied is True
        self.violated += satisfied is False
        self.doubtful += satisfied is None
        if verdict.violations:
            self.drives.update({violation.rule for violation in verdict.violations})
        if verdict.open or verdict.not_judged:
            is_open = {open_verdict.rule for open_verdict in verdict.open}
            self.open_in.update(is_open)
            rules = set(rules) - is_open - {rule.rule for rule in verdict.not_judged}
        self.judged_in.update(rules)

    def include(self, other: BatchTally) -> None:
        """Add another tally by the same rulebook; ``first`` and ``recordings`` stay as they are."""
        self.satisfied += other.satisfied
        self.violated += other.violated
        self.doubtful += other.doubtful
        self.not_judged += other.not_judged
        for rules in ("drives", "open_in", "judged_in"):
            getattr(self, rules).update(getattr(other, rules))

    @property
    def with_verdict(self) -> set[str]:
        """The rules with a verdict in some drive."""
        return {*+self.judged_in, *+self.drives}

    @property
    def counts(self) -> dict[bool | None, int]:
        """The number of drives satisfied (True), violated (False) and open (None)."""
        return {True: self.satisfied, False: self.violated, None: self.doubtful}

    @property
    def judged(self) -> int:
        """The number of drives that have a verdict."""
        return self.satisfied + self.violated + self.doubtful


def as_text(total: BatchTally, rules: CompiledRulebook, unread: Sequence[str]) -> str:
    """A table of the violations in all recordings, and the summary line of the run."""
    recordings = counted(total.judged_recordings, "recording")
    lines = [f"altogether  {recordings} with {counted(total.judged, 'drive')}"]
    if unread:
        lines.append(f"not read    {counted(len(unread), 'file')}, as said above")
    lines.append(f"rules       {_rules(total, rules)}")
    rows = [
        (
            verdict_report.short_title(rule),
            rule.strength,
            f"{total.drives[rule.name]:,}/{total.judged:,}",
            f"{total.recordings[rule.name]:,}/{total.judged_recordings:,}",
            _first(total.first[rule.name]),
        )
        for rule in rules.rules
        if rule.name in total.drives
    ]
    if rows:
        head = ("violated", "", " drives", " recordings", "first")
        lines += ["", *table_lines([head, *rows], right=(2, 3))]
    lines.append(verdict_report.summary(total.counts, total.not_judged, "drive"))
    return "\n".join(visible(line) for line in lines)


def _rules(total: BatchTally, rules: CompiledRulebook) -> str:
    return verdict_report.rule_counts(
        rules.rules, total.with_verdict, {*+total.open_in}, "these recordings"
    )


def _first(first: tuple[str, str, float]) -> str:
    file, ego, at = first
    return f"{ego} at {at:g} s in {file}"
