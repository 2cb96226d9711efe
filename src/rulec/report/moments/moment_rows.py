"""Moments as lines of text and of JSON, and as rows of tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from rulec.extraction.moment_search import DriveMoments
from rulec.report.json_document import JsonDocument, as_line
from rulec.report.text.terminal_text import broken, counted, visible

COLUMNS: Mapping[str, type] = {
    **dict.fromkeys(("file", "recording", "vehicle"), str),
    "objects": list,
    "holds": str,
    **dict.fromkeys(("from_s", "to_s"), float),
    **dict.fromkeys(("first_state", "last_state"), int),
}
"""The columns of tables of moments, with the types of their values; ``objects`` as ``v=car 1``."""


def rows(drive: DriveMoments) -> Iterator[dict[str, Any]]:
    """A row for each moment."""
    for moment in drive.moments:
        yield {
            "file": drive.file,
            "recording": drive.recording,
            "vehicle": drive.vehicle,
            "objects": tuple([f"{name}={item}" for name, item in moment.objects.items()]),
            "holds": moment.holds,
            "from_s": drive.time_s(moment.first),
            "to_s": drive.time_s(moment.last),
            "first_state": moment.first,
            "last_state": moment.last,
        }


def lines(drive: DriveMoments, width: int) -> Iterator[str]:
    """A line for each moment, wrapped to a width."""
    where = drive.file
    if drive.recording and drive.recording not in drive.file:
        where = f"{drive.file}: {drive.recording}"
    for row, moment in zip(rows(drive), drive.moments, strict=True):
        objects = "".join(f" {name}={item}" for name, item in moment.objects.items())
        when = f"at {row['from_s']:g} s (state {moment.first})"
        if moment.last > moment.first:
            when = (
                f"{row['from_s']:g} to {row['to_s']:g} s (states {moment.first} to {moment.last})"
            )
        perhaps = "" if moment.holds == "surely" else ", perhaps"
        line = visible(f"{where}: {drive.vehicle}{objects}: {when}{perhaps}")
        yield from broken(line, width, later="  ")


class MomentLine(JsonDocument, frozen=True, kw_only=True):
    """A moment at which a formula holds, ``surely`` or ``perhaps``, for some ``objects``.

    Times are those of the recording, states counted from 0.
    """

    file: str
    recording: str
    vehicle: str
    objects: dict[str, str]
    holds: Literal["surely", "perhaps"]
    from_s: float
    to_s: float
    first_state: int
    last_state: int


def json_lines(drive: DriveMoments) -> Iterator[str]:
    """A line of JSON for each moment."""
    for row, moment in zip(rows(drive), drive.moments, strict=True):
        yield as_line(MomentLine(**{**row, "objects": dict(moment.objects)}))


@dataclass(slots=True)
class MomentTally:
    """The number of moments found, and in how many of all drives."""

    surely: int = 0
    perhaps: int = 0
    drives: int = 0
    with_some: int = 0

    def add(self, drive: DriveMoments) -> None:
        """Count a drive."""
        surely = sum(moment.holds == "surely" for moment in drive.moments)
        self.surely += surely
        self.perhaps += len(drive.moments) - surely
        self.drives += 1
        self.with_some += bool(drive.moments)

    def as_text(self) -> str:
        """The summary line of the list."""
        perhaps = f", {self.perhaps:,} more perhaps" if self.perhaps else ""
        drives = f"{self.with_some:,} of {counted(self.drives, 'drive')}"
        return f"{counted(self.surely, 'moment')}{perhaps}, in {drives}"
