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
                objects=dict(moment.objects),
                holds=moment.holds,
                from_s=found.time_s(moment.first),
                to_s=found.time_s(moment.last),
                first_state=moment.first,
                last_state=moment.last,
            )
        )
        for moment in found.moments
    ]
