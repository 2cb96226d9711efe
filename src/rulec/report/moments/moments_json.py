"""Moments as lines of JSON."""

from __future__ import annotations

from typing import Literal

from rulec.extraction.moment_search import DriveMoments
from rulec.report.json_document import JsonDocument, as_line


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


def as_json(found: DriveMoments) -> list[str]:
    """A line for each moment."""
    return [
        as_line(
            MomentLine(
                file=found.file,
                recording=found.recording,
                vehicle=found.vehicle,
                objects=dict(one.objects),
                holds=one.holds,
                from_s=found.time_s(one.first),
                to_s=found.time_s(one.last),
                first_state=one.first,
                last_state=one.last,
            )
        )
        for one in found.moments
    ]
