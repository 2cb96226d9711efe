"""Counts of findings, drive by drive."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field
from sys import intern
from typing import Any, Literal

from rulec.rates.finding_rows import FindingRow
from rulec.rates.rates_messages import judged_otherwise, no_findings, twice

GroupKey = Literal["rulebook", "country", "road", "source", "file", "recording"]
"""The properties by which rates can be grouped."""

DriveKey = tuple[str, str, str, str]
"""A rulebook's hash, and a drive's file, recording and name."""

_ALIKE = {
    "rulebook_hash": "rules",
    "rulec": "versions of rulec",
    "thresholds": "thresholds",
    "assumptions": "assumptions",
}


@dataclass(frozen=True, slots=True)
class RuleCounts:
    """A rule's counts in a drive: opportunities, their duration, and how many were violated.

    Each as a pair of least and most; durations in s.
    """

    opportunities: tuple[int, int]
    exposed_s: tuple[float, float]
    violated: tuple[int, int]


@dataclass(slots=True)
class DriveCounts:
    """A drive: its duration (s), its distance (m), and the counts of each rule put to the test.

    ``not_judged`` are the rules that could not be judged in it. ``group`` has a value for each
    property that rates are grouped by.
    """

    group: tuple[str, ...]
    duration_s: float
    distance_m: float | None
    rules: dict[str, RuleCounts] = field(default_factory=dict)
    not_judged: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class RuleTitle:
    """A rule's provision, and whether it is hard or soft."""

    provision: str
    strength: str


@dataclass(slots=True)
class Counted:
    """The drives in files of findings; ``not_judged`` is the number of drives without a verdict.

    ``judged_by`` maps a rulebook's hash to its first row, which names version, thresholds and
    assumptions, in the files' order. ``rules`` maps a hash to the rules that drives were judged by.
    """

    by: tuple[GroupKey, ...]
    drives: dict[DriveKey, DriveCounts] = field(default_factory=dict)
    rules: dict[str, dict[str, RuleTitle]] = field(default_factory=dict)
    judged_by: dict[str, FindingRow] = field(default_factory=dict)
    not_judged: int = 0
    _files: dict[DriveKey, str] = field(default_factory=dict)
    _alike: dict[Any, Any] = field(default_factory=dict)
    _first: tuple[str, FindingRow] | None = None
    _waiting: list[tuple[str, DriveKey, FindingRow]] = field(default_factory=list)

    def add(self, file: str, rows: Iterable[FindingRow]) -> None:
        """Add the rows of a file.

        Raises RulecError R0715 if they were judged differently from those before, R0716 for a drive
        that was added already.
        """
        for row in rows:
            self._check(file, row)
            texts = row.rulebook_hash, row.file, row.recording, row.vehicle
            # A text that many rows have is kept once: there may be millions of drives.
            key = intern(texts[0]), intern(texts[1]), intern(texts[2]), texts[3]
            if row.kind == "drive":
                self._drive(file, key, row)
            else:
                self._waiting.append((file, key, row))
        still_waiting = []
        for where, key, row in self._waiting:
            if key in self.drives:
                self._rule(where, key, row)
            else:
                still_waiting.append((where, key, row))
        self._waiting = still_waiting

    def close(self, files: Sequence[str]) -> None:
        """Check that nothing is missing in these files. Raises RulecError R0716."""
        for file, (_, _, _, drive), row in self._waiting:
            raise no_findings(file, f"rule `{row.rule}` is of drive `{drive}`, which has no row")
        if not self.drives and not self.not_judged:
            raise no_findings(", ".join(files), "there are no rows of drives")

    def _check(self, file: str, row: FindingRow) -> None:
        if self._first is None:
            self._first = file, row
        first_file, first = self._first
        apart: Collection[str] = ("rulebook_hash",) if "rulebook" in self.by else ()
        for name, column in _ALIKE.items():
            own, other = getattr(row, name), getattr(first, name)
            if own != other and name not in apart:
                values = own, other
                if name == "rulebook_hash":
                    values = (f"{row.rulebook} ({own[:8]})", f"{first.rulebook} ({other[:8]})")
                raise judged_otherwise(file, first_file, column, values)
        self.judged_by.setdefault(row.rulebook_hash, row)

    def _drive(self, file: str, key: DriveKey, row: FindingRow) -> None:
        if key in self._files:
            raise twice(file, self._files[key], " ".join(part for part in key[1:] if part))
        self._files[key] = file
        if row.outcome == "not_judged" or row.duration_s is None:
            self.not_judged += 1
            return
        group = tuple([intern(str(getattr(row, name))) for name in self.by])
        self.drives[key] = DriveCounts(group, row.duration_s, row.distance_m)

    def _rule(self, file: str, key: DriveKey, row: FindingRow) -> None:
        drive, rule = self.drives[key], intern(row.rule)
        self.rules.setdefault(row.rulebook_hash, {}).setdefault(
            rule, RuleTitle(row.provision, row.strength)
        )
        if row.outcome == "not_judged" or row.opportunities is None:
            lacking = *drive.not_judged, rule
            drive.not_judged = self._alike.setdefault(lacking, lacking)
            return
        counts = RuleCounts(
            (row.opportunities, row.perhaps_opportunities or row.opportunities),
            (row.opportunities_s or 0.0, row.perhaps_opportunities_s or row.opportunities_s or 0.0),
            (row.violated or 0, row.perhaps_violated or row.violated or 0),
        )
        if counts.violated[0] > counts.opportunities[1]:
            why = f"rule `{row.rule}` is violated more often than it had opportunities"
            raise no_findings(file, f"{why}, in drive `{row.vehicle}`")
        if counts.opportunities[1] or counts.violated[1]:
            drive.rules[rule] = self._alike.setdefault(counts, counts)
