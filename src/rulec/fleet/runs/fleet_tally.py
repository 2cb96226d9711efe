"""Sums over files of findings: drives, hours, kilometres, rules by outcome."""

from __future__ import annotations

from collections import Counter
from collections.abc import Set
from dataclasses import dataclass, field
from pathlib import Path

from rulec.diagnostics.fault_messages import SAYS
from rulec.trace.formats.arrow.parquet import arrow

_NAMES = ("file", "recording", "vehicle")
_COLUMNS = (
    *("kind", "outcome", "strength", "rule", "ego", "because", *_NAMES),
    *("duration_s", "distance_m", "remarks"),
)

ROWS_AT_ONCE = 1 << 12
"""So many findings of a file are in memory at a time."""


@dataclass
class FleetTally:
    """Sums over drives.

    ``drives``: a verdict's outcome, or "not judged" -> number. ``rules``: rule and outcome ->
    number of drives. ``reasons``: why drives were not judged -> number. ``examples``: such a
    reason -> the alphabetically first file with such a drive; in a table without file names, its
    recording or trace. ``remarks``: what is
    odd about a recording -> the number of its drives; ``examples`` has these, too. ``unread``:
    number of files, recordings and traces (not vehicles) that could not be judged. ``lost``: units
    whose process was killed twice. ``faults`` of rulec -> how many rows they cost.
    """

    drives: Counter[str] = field(default_factory=Counter)
    rules: Counter[tuple[str, str]] = field(default_factory=Counter)
    reasons: Counter[str] = field(default_factory=Counter)
    examples: dict[str, str] = field(default_factory=dict)
    remarks: Counter[str] = field(default_factory=Counter)
    unread: int = 0
    hours: float = 0.0
    km: float = 0.0
    lost: list[str] = field(default_factory=list)
    faults: Counter[str] = field(default_factory=Counter)

    def add(self, other: FleetTally) -> None:
        """Add the sums of other drives."""
        self.drives.update(other.drives)
        self.rules.update(other.rules)
        self.reasons.update(other.reasons)
        self.remarks.update(other.remarks)
        for why, where in other.examples.items():
            self.examples[why] = min(where, self.examples.get(why, where))
        self.unread += other.unread
        self.hours += other.hours
        self.km += other.km
        self.lost += other.lost
        self.faults.update(other.faults)

    @property
    def judged(self) -> int:
        """The number of drives that have a verdict."""
        return self.drives.total() - self.drives["not judged"]


def _outcome(drive: str, rules: Set[tuple[str, str]]) -> str:
    """A drive's outcome as in a verdict, by its row, and by outcomes and strengths of its rules."""
    if drive == "open":
        if ("violated", "soft") in rules:
            return "only soft rules"
        return "open" if ("open", "hard") in rules else "nothing found"
    return "satisfied" if drive == "kept" else drive.replace("_", " ")


def tally_of(path: Path) -> FleetTally:
    """The sums over a file of findings."""
    _, parquet = arrow(str(path))
    tally = FleetTally()
    drive, rules = "", set[tuple[str, str]]()
    with parquet.ParquetFile(path) as source:
        for batch in source.iter_batches(ROWS_AT_ONCE, columns=list(_COLUMNS), use_threads=False):
            for row in zip(*(batch.column(name).to_pylist() for name in _COLUMNS), strict=True):
                kind, outcome, strength, rule, ego, because, *names, duration, driven, remarks = row
                where = next(filter(None, names), "")
                if because and SAYS in because:
                    tally.faults[because] += 1
                if kind == "rule":
                    tally.rules[rule, outcome] += 1
                    rules.add((outcome, strength))
                elif kind == "drive":
                    # The rows of its rules follow that of a drive
                    tally.drives.update([_outcome(drive, rules)] if drive else [])
                    drive, rules = outcome, set()
                    tally.hours += (duration or 0.0) / 3600
                    tally.km += (driven or 0.0) / 1000
                    tally.remarks.update(remarks)
                    for remark in remarks:
                        tally.examples[remark] = min(where, tally.examples.get(remark, where))
                    if outcome == "not_judged":
                        # One reason, whichever recording it names
                        because = because.replace(f"`{names[1]}`", "`…`") if names[1] else because
                        tally.reasons[because] += 1
                        tally.examples[because] = min(where, tally.examples.get(because, where))
                        tally.unread += not ego
    tally.drives.update([_outcome(drive, rules)] if drive else [])
    return tally
