"""Marks between lanes, as seen from each of the two lanes.

A lane's mark is on its outer border; the centre lane's mark lies between both sides of the road.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rulec.recordings.opendrive.content.elements import LaneSection, MarkRecord, record_at
from rulec.recordings.recording import LaneMark

_MARKS: Mapping[str, tuple[LaneMark, LaneMark]] = MappingProxyType(
    {
        "none": ("none", "none"),
        "solid": ("solid", "solid"),
        "broken": ("broken", "broken"),
        "solid solid": ("double_solid", "double_solid"),
        "broken broken": ("broken", "broken"),
        "solid broken": ("solid", "broken"),
        "broken solid": ("broken", "solid"),
    }
)
"""Types of marks as seen from the inner lane (for the centre lane, from its left), and the other.

Kerbs, grass, Botts' dots and the like are missing: they do not show a kind of line.
"""

_CHANGES: Mapping[str, tuple[LaneMark, LaneMark]] = MappingProxyType(
    {"none": ("solid", "solid"), "both": ("broken", "broken")}
)
_OWN_LINES = frozenset({"botts dots", "custom"})
_UNKNOWN = None, None

Marks = tuple["LaneMark | None", "LaneMark | None"]


def marks_of(mark: MarkRecord | None) -> Marks:
    """A mark as seen from the inner lane (for the centre lane, from its left), and from the other.

    For Botts' dots and custom lines, it follows from whether lanes may be changed across them.
    """
    if mark is None:
        return _UNKNOWN
    if mark.type in _OWN_LINES:
        return _CHANGES.get(mark.change, _UNKNOWN)
    return _MARKS.get(mark.type, _UNKNOWN)


def mark_at(section: LaneSection, lane: int, s: float) -> MarkRecord | None:
    """The mark of a lane at ``s``."""
    own = section.lanes.get(lane)
    return None if own is None else record_at(own.marks, s, section.start)


def mark_beside(section: LaneSection, lane: int, s: float, *, left: bool) -> LaneMark | None:
    """The mark on a lane's border at greater ``t`` (``left``) or smaller, as seen from the lane."""
    away = left == (lane > 0)
    if away:
        return marks_of(mark_at(section, lane, s))[0]
    inner = lane - 1 if lane > 0 else lane + 1
    marks = marks_of(mark_at(section, inner, s))
    # The centre lane's marks are ordered from left to right
    return marks[0] if inner == 0 and lane > 0 else marks[1]
