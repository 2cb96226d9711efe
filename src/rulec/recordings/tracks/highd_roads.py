"""The motorway of a highD recording, from the positions of its lane marks.

highD's y axis points down, that of a ``Recording`` up, so y changes its sign. Traffic on the upper
carriageway drives to the left, against the x axis.
"""

from __future__ import annotations

import numpy as np

from rulec.recordings.encodings.file_values import number_in, short
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.encodings.table_columns import NamedColumns
from rulec.recordings.lanes.lanes_along import lanelet_along
from rulec.recordings.recording import LONGEST_M, Lanelet
from rulec.recordings.road_map import RoadMap

_BEYOND_M = 20.0
_EVERY_M = 20.0
_WIDEST_M = 20.0
_ROUNDED_KMH = 0.1


def highd_roads(about: NamedColumns, reach: tuple[float, float]) -> RoadMap:
    """The roads described by a table about a recording, over all x that vehicles reach.

    Lanes are numbered from the right, as in ``upper_1``. Raises RulecError for invalid marks.
    """
    limit = float(about.numbers["speedLimit"][0])
    kmh = limit * KMH_PER_MPS
    limit_mps = None if limit <= 0 else limit
    if limit_mps is not None and abs(kmh - round(kmh)) < _ROUNDED_KMH:
        limit_mps = round(kmh) / KMH_PER_MPS
    low, high = reach[0] - _BEYOND_M, reach[1] + _BEYOND_M
    if high - low > LONGEST_M:
        raise about.columns.refused(f"tracks reach from x = {low:g} to {high:g}")
    x = np.linspace(low, high, max(2, round((high - low) / _EVERY_M)))
    lanelets: dict[str, Lanelet] = {}
    for side, way in (("upper", -1), ("lower", 1)):
        marks = _marks(about, f"{side}LaneMarkings")
        # The rightmost mark is the one of the smallest y on the upper carriageway, else the largest
        marks = marks if way < 0 else marks[::-1]
        count = len(marks) - 1
        for number in range(1, count + 1):
            right, left = marks[number - 1], marks[number]
            y = np.full(len(x), -(left + right) / 2)
            name = f"{side}_{number}"
            lanelets[name] = lanelet_along(
                name,
                np.column_stack((x[::way], y)),
                abs(left - right),
                left_of=f"{side}_{number + 1}" if number < count else None,
                right_of=f"{side}_{number - 1}" if number > 1 else None,
                types=frozenset({"highway"}),
                limit_mps=limit_mps,
                left_mark="broken" if number < count else "solid",
                right_mark="broken" if number > 1 else "solid",
            )
    return RoadMap(form="highD marks", lanelets=lanelets, side="right", country="DEU")


def _marks(about: NamedColumns, name: str) -> list[float]:
    """The positions of a carriageway's marks by ascending y (m), as in the file."""
    text = about.texts[name].names[int(about.texts[name].codes[0])]
    try:
        marks = sorted(number_in(part) for part in text.split(";") if part.strip())
    except ValueError:
        marks = []
    gaps = np.diff(marks)
    if len(marks) < 2 or not ((gaps > 0) & (gaps < _WIDEST_M)).all():
        why = f"its `{name}` are `{short(text)}`"
        raise about.columns.wrong(0, why, "expected the y of two marks or more, such as `8.5;12.6`")
    return marks
