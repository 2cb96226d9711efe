"""Lanes as a table: the points of their centre lines in order, with further attributes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast, get_args

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.diagnostics import RulecError, did_you_mean
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import LARGEST, short
from rulec.recordings.encodings.speed_units import MPS_PER_KMH, MPS_PER_MPH
from rulec.recordings.encodings.table_columns import (
    ColumnKind,
    ColumnTable,
    NamedColumns,
    named_columns,
    unread_remark,
)
from rulec.recordings.encodings.table_files import open_table, table_of
from rulec.recordings.lanes.lanes_along import (
    CLOSEST_M,
    LANE_TYPES,
    USUAL_WIDTH_M,
    lanelet_along,
    linked,
    unknown_references,
    with_ends_that_meet,
)
from rulec.recordings.polylines import arc_lengths, far_apart, line_length
from rulec.recordings.recording import LONGEST_M, Lanelet, LaneMark, Points, Side
from rulec.recordings.road_map import RoadMap

LANES = FileFormat(
    "lanes as a table",
    "it has a row for each point of a lane's centre line, with the columns `lane`, `x`, `y`",
    200_000_000,
)
MOST_LANES = 100_000
WIDEST_M = 50.0
FASTEST_LIMIT_MPS = 200.0

LANE_COLUMNS = (
    ColumnKind("lane", {"lane_id": 1, "lanelet": 1, "lanelet_id": 1}, True, True),
    ColumnKind("x", {"x_m": 1}, required=True),
    ColumnKind("y", {"y_m": 1}, required=True),
    ColumnKind("width", {"width_m": 1}),
    ColumnKind("limit_mps", {"limit_kmh": MPS_PER_KMH, "limit_mph": MPS_PER_MPH}),
    ColumnKind("stop_line", {}),
    *(
        ColumnKind(name, dict.fromkeys(also.split(), 1.0), True)
        for name, also in (
            ("left_mark", ""),
            ("right_mark", ""),
            ("type", "types"),
            ("signs", "sign"),
            ("successors", "successor next"),
            ("predecessors", "predecessor previous"),
            ("left_lane", "left_of left_neighbour left_neighbor"),
            ("right_lane", "right_of right_neighbour right_neighbor"),
            ("junction", "junction_id"),
            ("foes", ""),
            ("first", ""),
            ("side", "traffic_side"),
        )
    ),
)


def read_lane_map(path: Path) -> RoadMap:
    """The roads in a file. Raises RulecError R0610, R0701, R0706."""
    return road_map_of(open_table(path, LANES))


def lane_map(columns: Mapping[str, Any]) -> RoadMap:
    """The roads in columns held in memory. Raises RulecError R0610."""
    return road_map_of(table_of(columns, "lanes"))


def road_map_of(table: ColumnTable) -> RoadMap:
    """The roads in a table. Raises RulecError if its content is inconsistent."""
    named = named_columns(table, LANE_COLUMNS)
    return _LaneTable(named).road_map()


class _LaneTable:
    """A table of lanes while it is read."""

    def __init__(self, named: NamedColumns) -> None:
        self.named = named
        self.columns = named.columns
        self.lane = named.texts["lane"]
        for name in ("x", "y", "width", "limit_mps"):
            self._check_size(name)
        if len(self.lane.names) > MOST_LANES:
            raise self.columns.refused(f"it has more than {MOST_LANES:,} lanes")

    def _check_size(self, name: str) -> None:
        values = self.named.number(name)
        if values is None:
            return
        low, high = {"width": (0.0, WIDEST_M), "limit_mps": (0.0, FASTEST_LIMIT_MPS)}.get(
            name, (-LARGEST, LARGEST)
        )
        bad = ~((values > low) & (values < high)) & ~np.isnan(values)
        if bad.any():
            row = int(np.argmax(bad))
            given, unit = self.named.given[name]
            why = f"its `{short(given)}` is {self.columns.numbers[given][row]:g}"
            expected = f"expected a number between {low / unit:g} and {high / unit:g}"
            metres = "widths are in metres" if name == "width" else ""
            raise self.columns.wrong(row, why, expected, metres)

    def road_map(self) -> RoadMap:
        lanelets = {}
        for _, rows in self.lane.groups():
            lanelet = self._lanelet(rows)
            lanelets[lanelet.id] = lanelet
        self._check_references(lanelets)
        lanelets = _with_known_priorities(lanelets)
        remarks = [unread_remark(self.named.unread, LANE_COLUMNS)]
        if self.named.number("width") is None:
            remarks.append(f"lanes are taken to be {USUAL_WIDTH_M:g} m wide")
        if "successors" in self.named.texts or "predecessors" in self.named.texts:
            lanelets = linked(lanelets)
        else:
            lanelets = with_ends_that_meet(lanelets)
            if any(lanelet.successors for lanelet in lanelets.values()):
                remarks.append("lanes whose ends meet are assumed to be connected")
        side = self._one_of("side", np.arange(len(self.lane.codes)), get_args(Side))
        return RoadMap(
            form="lanes as a table",
            lanelets=lanelets,
            side=cast("Side | None", side),
            remarks=tuple(filter(None, remarks)),
        )

    def _lanelet(self, own: NDArray[np.intp]) -> Lanelet:
        name = self.lane.names[int(self.lane.codes[own[0]])]
        centre, width = self._line(name, own)
        types = self._words("type", own)
        for kind in types:
            if kind not in LANE_TYPES:
                why = f"lane `{short(name)}` is of type `{short(kind)}`"
                known = "write one such as `urban`, `country`, `highway`, or leave it out"
                help_text = did_you_mean(kind, LANE_TYPES) or known
                raise self.columns.wrong(int(own[0]), why, "expected a type of lanes", help_text)
        junction = self._text("junction", own)
        stop = self.named.number("stop_line")
        left_mark, right_mark = (
            self._one_of(side, own, get_args(LaneMark)) for side in ("left_mark", "right_mark")
        )
        return lanelet_along(
            name,
            centre,
            width,
            types=frozenset((*types, *(["intersection"] if junction else []))),
            signs=frozenset(word.upper() for word in self._words("signs", own)),
            limit_mps=self._limit(own),
            left_mark=cast("LaneMark | None", left_mark),
            right_mark=cast("LaneMark | None", right_mark),
            successors=self._words("successors", own),
            predecessors=self._words("predecessors", own),
            left_of=self._text("left_lane", own) or None,
            right_of=self._text("right_lane", own) or None,
            junction=junction,
            foes=frozenset(self._words("foes", own)) if "foes" in self.named.texts else None,
            first=frozenset(self._words("first", own)) if "first" in self.named.texts else None,
            stops_at_end=stop is not None and bool((stop[own] == 1).any()),
        )

    def _line(self, name: str, own: NDArray[np.intp]) -> tuple[Points, NDArray[float64]]:
        numbers = self.named.numbers
        points = np.column_stack((numbers["x"][own], numbers["y"][own]))
        rows = far_apart(points, CLOSEST_M)
        kept = points[rows]
        if len(kept) < 2:
            why = f"lane `{short(name)}` has one place only"
            raise self.columns.wrong(int(own[0]), why, "expected two points or more in order")
        length = line_length(kept)
        if length > LONGEST_M:
            why = f"lane `{short(name)}` is {length:,.0f} m long"
            expected = f"expected {LONGEST_M:,.0f} m at most"
            raise self.columns.wrong(int(own[0]), why, expected)
        width = numbers.get("width")
        stated = np.full(len(own), np.nan) if width is None else width[own]
        known = np.flatnonzero(~np.isnan(stated))
        if not len(known):
            return kept, np.full(len(kept), USUAL_WIDTH_M)
        # By the distance: points lie closer together where a lane bends
        at = arc_lengths(points)
        filled = np.interp(at, at[known], stated[known])
        return kept, filled[rows]

    def _text(self, name: str, own: NDArray[np.intp]) -> str:
        """The value of a lane in a text column: one row suffices, others repeat it or are empty."""
        texts = self.named.texts.get(name)
        if texts is None:
            return ""
        codes = [code for code in dict.fromkeys(texts.codes[own].tolist()) if texts.names[code]]
        if len(codes) > 1:
            row = int(own[np.argmax(texts.codes[own] == codes[1])])
            raise self._two_values(row, name, [texts.names[code] for code in codes[:2]])
        return texts.names[codes[0]] if codes else ""

    def _limit(self, own: NDArray[np.intp]) -> float | None:
        """The limit of a lane (m/s): one row suffices, others repeat it or are empty."""
        limit = self.named.number("limit_mps")
        stated = own[:0] if limit is None else own[~np.isnan(limit[own])]
        if limit is None or not len(stated):
            return None
        others = stated[limit[stated] != limit[stated[0]]]
        if len(others):
            given, _ = self.named.given["limit_mps"]
            values = self.columns.numbers[given][[stated[0], others[0]]]
            raise self._two_values(int(others[0]), given, [f"{value:g}" for value in values])
        return float(limit[stated[0]])

    def _two_values(self, row: int, name: str, values: Sequence[str]) -> RulecError:
        both = " and ".join(f"`{short(value)}`" for value in values)
        why = (
            f"its `{short(name)}` is another than in the rows above of lane "
            f"`{short(self.lane.of(row))}`: {both}"
        )
        way_out = "where something changes, begin another lane"
        if name in self.named.texts:
            way_out = f"separate several with blanks; {way_out}"
        return self.columns.wrong(row, why, help_text=way_out)

    def _words(self, name: str, own: NDArray[np.intp]) -> tuple[str, ...]:
        return tuple(self._text(name, own).split())

    def _one_of(self, name: str, own: NDArray[np.intp], known: Sequence[str]) -> str | None:
        text = self._text(name, own)
        if text and text not in known:
            texts = self.named.texts[name]
            row = int(own[np.argmax(texts.having(text)[own])])
            expected = f"expected {', '.join(f'`{word}`' for word in known)}, or nothing"
            why = f"its `{name}` is `{short(text)}`"
            raise self.columns.wrong(row, why, expected, did_you_mean(text, known))
        return text or None

    def _check_references(self, lanelets: Mapping[str, Lanelet]) -> None:
        for lanelet in lanelets.values():
            for field, name in unknown_references(lanelet, lanelets):
                row = int(np.argmax(self.lane.having(lanelet.id)))
                column = {"left_of": "left_lane", "right_of": "right_lane"}.get(field, field)
                why = (
                    f"`{column}` of lane `{short(lanelet.id)}` has `{short(name)}`, "
                    "which is no lane"
                )
                help_text = did_you_mean(name, lanelets)
                raise self.columns.wrong(row, why, "expected ids of lanes", help_text)


def _with_known_priorities(lanelets: Mapping[str, Lanelet]) -> dict[str, Lanelet]:
    """The lanelets, without ``foes`` and ``first`` where no way of a junction names any.

    An empty cell among cells with names says that there are none; empty cells only say nothing.
    """
    known = {lanelet.junction for lanelet in lanelets.values() if lanelet.foes or lanelet.first}
    return {
        name: lanelet if lanelet.junction in known else replace(lanelet, foes=None, first=None)
        for name, lanelet in lanelets.items()
    }
