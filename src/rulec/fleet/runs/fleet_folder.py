"""The folder of a fleet's findings: its content, its origin, the units that are done, and sums.

Sums are over files of findings: drives, hours, kilometres, rules by outcome.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any

from rulec.diagnostics import RulecError
from rulec.diagnostics.fault_messages import SAYS
from rulec.files.read_files import file_state, opened
from rulec.files.written_files import make_folder, refusals, written_whole
from rulec.fleet.drive_rows import JudgedBy
from rulec.fleet.fleet_messages import folder_in_use, no_fleet, other_fleet
from rulec.fleet.runs.work_units import WorkUnit
from rulec.recordings.recording_format import RecordingSource
from rulec.trace.formats.arrow.parquet import arrow

MANIFEST = "_manifest.json"
"""Engines that read the folder as a table skip files whose names begin with ``_``."""
VERSION = 1

STATE = b"rulec.unit"
"""The metadata key for the state of what the file's unit read."""

READ = b"rulec.read"
"""The metadata key for other files read, such as maps, each with its state at the time."""

_SHORT = 12


@dataclass(frozen=True, slots=True)
class FleetFolder:
    """A folder with a manifest, and a file of findings for each unit of work that is done."""

    path: Path
    by: JudgedBy

    @property
    def findings(self) -> Path:
        """The folder of the part files, named as engines name partitions of tables."""
        return self.path / f"book={self.by.rulebook_hash[:_SHORT]}"

    def part(self, unit: WorkUnit) -> Path:
        """The file of a unit's findings."""
        return self.findings / f"part-{unit.digest}.parquet"

    def is_done(self, unit: WorkUnit) -> bool:
        """Whether a unit's file is there, undamaged, and made from the inputs' current state."""
        path = self.part(unit)
        if not path.is_file():
            return False
        pyarrow, parquet = arrow(str(path))
        try:
            metadata = parquet.read_metadata(path).metadata or {}
            if metadata.get(STATE) != unit.state().encode():
                return False
            beside = json.loads(metadata[READ]).items()
            if not all(file_state(name) == tuple(then) for name, then in beside):
                return False
            with parquet.ParquetFile(path, page_checksum_verification=True) as source:
                for _ in source.iter_batches(ROWS_AT_ONCE, use_threads=False):
                    pass
            return True
        except (pyarrow.ArrowException, OSError, KeyError, ValueError):
            return False

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Create the folder, and keep other runs out of it.

        Raises RulecError R0702, R0712 if another run uses it.
        """
        make_folder(self.path)
        with refusals(self.path):
            handle = os.open(self.path, os.O_RDONLY)
        try:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise folder_in_use(self.path) from None
            except OSError:
                # Some file systems do not support locks
                pass
            yield
        finally:
            os.close(handle)

    def open(
        self, inputs: Sequence[str], source: RecordingSource, egos: Sequence[str] = ()
    ) -> None:
        """Start in the folder, or continue with the same settings and at least the same inputs.

        Raises RulecError R0702, R0712 if it belongs to another fleet, R0701 for a missing map.
        """
        settings = {
            **self.by.columns(),
            "map": _map(source.map_path),
            "input_format": source.form or "",
            "scenario": source.scenario_id or "",
            "egos": "; ".join(egos),
        }
        if source.frame_rate is not None:
            settings["frame_rate"] = repr(source.frame_rate)
        manifest = self.path / MANIFEST
        if manifest.is_file():
            self._check(_read(manifest), settings, inputs)
        elif any(path.is_file() and path.name[0] != "." for path in self.path.rglob("*")):
            raise no_fleet(self.path)
        make_folder(self.findings)
        for left in (*self.findings.glob(".*.part"), *self.path.glob(".*.part")):
            # Left by a killed process: no other process writes here.
            with suppress(OSError):
                left.unlink()
        content = {"version": VERSION, "settings": settings, "inputs": list(inputs)}
        with written_whole(manifest) as stream:
            text = json.dumps(content, indent=1, ensure_ascii=False)
            # Names of files may not be valid text.
            stream.write(f"{text}\n".encode(errors="backslashreplace"))

    def _check(
        self, before: Mapping[str, Any], settings: Mapping[str, Any], inputs: Sequence[str]
    ) -> None:
        known = before.get("settings")
        if before.get("version") != VERSION or not isinstance(known, dict):
            raise other_fleet(self.path, "its _manifest.json is of another version, or damaged")
        for name, value in settings.items():
            if known.get(name) != value:
                was, now = _shown(known.get(name)), _shown(value)
                raise other_fleet(self.path, f"its {name} is {was}, and would be {now}")
        earlier = before.get("inputs", [])
        if not isinstance(earlier, list) or not all(isinstance(path, str) for path in earlier):
            raise _damaged(self.path / MANIFEST)
        missing = [path for path in earlier if path not in {*inputs}]
        if missing:
            more = f" and {len(missing) - 1:,} more" if len(missing) > 1 else ""
            raise other_fleet(
                self.path, f"it also has findings of `{missing[0]}`{more}, which is not given now"
            )

    def leftovers(self, units: Sequence[WorkUnit]) -> Iterator[Path]:
        """Files of findings that belong to no unit of work."""
        own = {self.part(unit) for unit in units}
        yield from (path for path in sorted(self.findings.glob("*.parquet")) if path not in own)


def _map(path: Path | None) -> str:
    if path is None:
        return ""
    with opened(path) as stream:
        return f"{path.name} {sha256(stream.read()).hexdigest()}"


def _read(manifest: Path) -> Mapping[str, Any]:
    try:
        content = json.loads(manifest.read_bytes())
    except (OSError, ValueError, RecursionError):
        content = None
    if not isinstance(content, dict):
        raise _damaged(manifest)
    return content


def _damaged(manifest: Path) -> RulecError:
    return other_fleet(manifest.parent, "its _manifest.json cannot be read")


def _shown(value: object) -> str:
    return f"`{value}`" if value else "none"


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
        for counts in ("drives", "rules", "reasons", "remarks", "faults"):
            getattr(self, counts).update(getattr(other, counts))
        for why, where in other.examples.items():
            self.examples[why] = min(where, self.examples.get(why, where))
        self.unread += other.unread
        self.hours += other.hours
        self.km += other.km
        self.lost += other.lost

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
