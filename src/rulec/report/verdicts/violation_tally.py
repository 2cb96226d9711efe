"""Verdicts on recorded drives counted drive by drive, and what became of each rule."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, Literal, TypeAlias

from rulec.extraction.recording_verdicts import DriveVerdict
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.monitoring.verdict import Verdict, VerdictOutcome

RuleOutcome: TypeAlias = Literal[
    "found", "nothing found", "idle", "kept regardless", "open", "not judged"
]
"""What became of a rule in drives: violated in some; else open in some; else judged in some,
without a violation; judged, but none of them gave an opportunity to violate it; kept in all
whatever their source does not tell; kept so in some, and not judged in the others."""


@dataclass(slots=True)
class ViolationTally:
    """Verdicts, counted drive by drive.

    ``drives``: outcome -> the drives with it.
    ``first_s``: rule -> drive -> time of its first violation (s of the recording). ``open_rules``
    are open in some drive; ``open_on`` has all names on which open rules depend. ``untold``: rule
    -> the missing names because of which it is not judged in some drive; ``reasons``: rule ->
    another reason. ``causes``: rule -> the objects that its violation is about -> the drives, so
    that many drives past one standing car are one finding. ``judged_in``: rule -> the number of
    drives in which it is neither open nor not judged, ``regardless_in`` of those in which it is
    kept whatever the words are that it lacks, ``idle_in`` of those with no opportunity to violate
    it, and ``opportunities`` their number in all drives, if these have been looked for. ``words``
    are the names of the signals that every drive supplies. ``faults`` of rulec cost rules in some
    drives, or drives.
    """

    drives: dict[VerdictOutcome, list[str]] = field(default_factory=dict)
    not_judged: list[NoDrive] = field(default_factory=list)
    first_s: dict[str, dict[str, float]] = field(default_factory=dict)
    open_rules: dict[str, None] = field(default_factory=dict)
    open_on: set[str] = field(default_factory=set)
    untold: dict[str, dict[str, None]] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)
    causes: dict[str, dict[tuple[str, ...], list[str]]] = field(default_factory=dict)
    judged_in: Counter[str] = field(default_factory=Counter)
    regardless_in: Counter[str] = field(default_factory=Counter)
    idle_in: Counter[str] = field(default_factory=Counter)
    opportunities: Counter[str] = field(default_factory=Counter)
    open_hard: int = 0
    words: frozenset[str] | None = None
    faults: dict[str, None] = field(default_factory=dict)

    @property
    def judged(self) -> int:
        """The number of drives that have a verdict."""
        return sum(map(len, self.drives.values()))

    @property
    def with_answer(self) -> set[str]:
        """The rules that are judged, and not only in drives that would keep them anyway."""
        unknown = self.untold.keys() | self.reasons.keys()
        answered = {
            rule
            for rule, number in self.judged_in.items()
            if number > (self.regardless_in[rule] if rule in unknown else 0)
        }
        return answered.union(self.first_s)

    def include(self, later: ViolationTally) -> None:
        """Add the counts of later drives."""
        words = [words for words in (self.words, later.words) if words is not None]
        for part in fields(self):
            setattr(self, part.name, _joined(getattr(self, part.name), getattr(later, part.name)))
        self.words = frozenset.intersection(*words) if words else None

    def outcomes(self, rules: Iterable[str]) -> dict[str, RuleOutcome]:
        """What became of each of these rules."""
        answered = self.with_answer
        return {rule: self._outcome(rule, is_answered=rule in answered) for rule in rules}

    def _outcome(self, rule: str, *, is_answered: bool) -> RuleOutcome:
        if rule in self.first_s:
            return "found"
        if rule in self.open_rules:
            return "open"
        if not is_answered:
            return "not judged"
        if self.judged_in[rule] == self.regardless_in[rule]:
            return "kept regardless"
        return "idle" if self.judged_in[rule] == self.idle_in[rule] else "nothing found"

    def add(
        self,
        verdict: DriveVerdict | NoDrive,
        rules: Sequence[str],
        opportunities: Counter[str] | None = None,
    ) -> None:
        """Count a drive's verdict on these rules, with so many opportunities to violate each."""
        if isinstance(verdict, NoDrive):
            self.not_judged.append(verdict)
            return
        drive, answer = verdict.drive, verdict.answer
        if not isinstance(answer, Verdict):
            self.not_judged.append(NoDrive(drive.ego, answer.error.diagnostics[0].message))
            return
        self.words = drive.words if self.words is None else self.words & drive.words
        self.faults.update({fault.diagnostics[0].message: None for fault in answer.faults})
        self.drives.setdefault(answer.outcome, []).append(drive.arrays.id)
        for violation in answer.violations:
            times = self.first_s.setdefault(violation.rule, {})
            at = drive.time_s(violation.step)
            times[drive.arrays.id] = min(at, times.get(drive.arrays.id, at))
            about = self.causes.setdefault(violation.rule, {})
            members = about.setdefault(tuple(violation.binding.values()), [])
            if drive.arrays.id not in members:
                members.append(drive.arrays.id)
        for result in answer.open:
            self.open_rules[result.rule] = None
            self.open_on |= result.depends_beyond(self.open_on)
            self.open_hard += result.strength == "hard"
        for rule in answer.not_judged:
            self.untold.setdefault(rule.rule, {}).update(dict.fromkeys(rule.untold))
            if rule.why:
                self.reasons[rule.rule] = rule.why
        doubtful = {x.rule for x in answer.open} | {x.rule for x in answer.not_judged}
        judged = [rule for rule in rules if rule not in doubtful]
        self.judged_in.update(judged)
        self.regardless_in.update(answer.kept_regardless)
        if opportunities is not None:
            met = opportunities.keys() | answer.kept_regardless
            self.idle_in.update([rule for rule in judged if rule not in met])
            self.opportunities.update(opportunities)


def _joined(own: Any, later: Any) -> Any:
    """Both counts, lists or sets, key by key in dicts; of other values the later one."""
    if isinstance(own, dict):
        for key, value in later.items():
            own[key] = _joined(own[key], value) if key in own else value
    elif isinstance(own, set):
        own |= later
    elif isinstance(own, int | list):
        own += later
    else:
        return later
    return own
