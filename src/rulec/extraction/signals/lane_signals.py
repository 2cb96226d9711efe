"""Signals of lane changes, ego's indicator, and road marks where the map has marks."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.signal_columns import SignalColumns, named_values
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.recordings.recording import Lanelet, LaneMark

_INDICATORS = frozenset({"left_indicator", "right_indicator"})
_INDICATIONS = ("no_indicator", "near_indicator", "far_indicator")
_SOLID = frozenset({"solid", "double_solid"})
_SINGLE = (
    ("solid", "solid"),
    ("solid", None),
    (None, "solid"),
    ("solid", "none"),
    ("none", "solid"),
)
"""One line between two lanes is the mark of both, or of the one whose bound it is."""

_Marks = tuple[LaneMark | None, LaneMark | None]
_Body = tuple[Floats, Floats]
"""How far (m) left of each line a body begins and ends."""


def lane_change_signals(context: DriveContext) -> SignalColumns:
    """The signals of ego's lane changes."""
    lane = context.steady_lane
    changes = np.append(False, lane[1:] != lane[:-1])
    clear = ~changes | ~_disturbs(context)
    changing = SignalColumns(
        {"lane_change": changes, "lane_is_clear": clear},
        unknown={"lane_change": _within_tolerance(context, changes)},
    )
    return changing | _indicator(context)


def _within_tolerance(context: DriveContext, changes: Flags) -> Flags:
    """Flags of those changes of which the marks may be so far off that there is none.

    Before or after it, until the next one, ego's middle is never farther from the mark.
    """
    lane, left_of = context.steady_lane, context.ego_extents.left_of[0]
    error = context.tolerances.place_m + np.abs(context.map_offset_m)
    least = np.maximum(context.thresholds.changed_m, error)
    unsure = np.zeros_like(changes)
    borders = [0, *np.flatnonzero(changes).tolist(), len(changes)]
    for begin, at, end in zip(borders[:-2], borders[1:-1], borders[2:], strict=True):
        mark = left_of[begin:end, max(lane[at - 1], lane[at])]
        if lane[at] < lane[at - 1]:
            mark = -mark
        unsure[at] = min(-mark[: at - begin].min(), mark[at - begin :].max()) < least[at]
    return unsure


def _indicator(context: DriveContext) -> SignalColumns:
    """Ego's indicator, if the recording has its lamps; both at once are no indication."""
    (ego,) = context.ego.participants
    if not ego.lamps or not ego.shows >= _INDICATORS:
        return SignalColumns()
    far = "left_indicator" if context.side == "right" else "right_indicator"
    steps = [ego.lamps.get(context.first_step + state) for state in range(context.states)]
    lit = [(lamps or frozenset()) & _INDICATORS for lamps in steps]
    codes = np.array([0 if len(lamps) != 1 else 2 if far in lamps else 1 for lamps in lit])
    return SignalColumns(
        {"indicator": named_values(codes, _INDICATIONS)},
        unknown={"indicator": np.array([lamps is None for lamps in steps])},
    )


def _disturbs(context: DriveContext) -> Flags:
    """Flags of states in which a vehicle in ego's lane must brake for ego.

    One beside ego has to, and one behind it that would have to brake harder than
    ``disturbing_mps2`` after its reaction time not to run into it.
    """
    limits = context.thresholds
    station = relations.station(context)
    lanes = np.arange(context.touched.shape[-1])
    same = context.touched & (lanes == context.ego_lane[None, :, None])
    faster = np.maximum(context.extents.along - context.ego_extents.along, 0.0)
    braking_distance = relations.gap(context) - faster * limits.reaction_s
    brakes = faster**2 > 2 * limits.disturbing_mps2 * np.maximum(braking_distance, 0.0)
    behind = (station == relations.IN_FRONT_OF) & brakes
    beside = station == relations.BESIDE
    disturbs: Flags = (context.going_along & same.any(axis=-1) & (behind | beside)).any(axis=0)
    return disturbs


def lane_mark_signals(context: DriveContext) -> SignalColumns:
    """The signals of marks; none at all if the map has none."""
    known = context.recording.lanelets.values()
    if not any(lanelet.left_mark or lanelet.right_mark for lanelet in known):
        return SignalColumns()
    pieces = context.road.piece(context.ego_extents.s[0]).tolist()
    names = ("marked_lanes", "on_solid_line", "broken_on_own_side", "single_line")
    columns = np.zeros((len(names), context.states), dtype=bool)
    unknown, not_told = np.zeros((2, context.states), dtype=bool)
    place, offsets = context.tolerances.place_m, context.map_offset_m
    near = _near_a_line(context, place + np.abs(offsets))
    bodies = _bodies(context)
    for state, piece in enumerate(pieces):
        lanelets = zip(context.road.rows[piece], context.existing_lanes[state], strict=True)
        row = [lanelet if exists else None for lanelet, exists in lanelets]
        between = [_between(*pair) for pair in pairwise(row) if all(pair)]
        unknown[state] = any(not any(marks) for marks in between)
        columns[0, state] = bool(between) and all(set(marks) != {"none"} for marks in between)
        body, parallel = bodies[state]
        crossed = _marks_under_ego(context, state, row, body)
        found = columns[1:, state] = _solid_lines(crossed)
        not_told[state] = not found[0] and any(not any(marks) for marks in crossed)
        others = list(product((place, -place), {0.0, float(offsets[state])}))
        tried = [(body, *other) for other in others] if near[state] else []
        # Where places are known so badly, a body's direction is that of its slow or slipping track
        if place >= context.thresholds.touching_m and (near[state] or found[0]):
            tried += [(parallel, *other) for other in [(0.0, 0.0), *others]]
        not_told[state] |= any(
            _solid_lines(_marks_under_ego(context, state, row, *each)) != found for each in tried
        )
    return SignalColumns(
        dict(zip(names, columns, strict=True)),
        unknown={"marked_lanes": unknown, **dict.fromkeys(names[1:], not_told)},
    )


def _between(right: Lanelet | None, left: Lanelet | None) -> _Marks:
    return right.left_mark if right else None, left.right_mark if left else None


def _solid_lines(crossed: list[_Marks]) -> tuple[bool, bool, bool]:
    """Is ego on a solid line, is one broken on its own side, and is it a single one?"""
    solid = [marks for marks in crossed if _SOLID & set(marks)]
    broken = any(marks[0] == "broken" for marks in solid)
    return bool(solid), broken, len(solid) == 1 and solid[0] in _SINGLE


def _near_a_line(context: DriveContext, margin_m: Floats) -> Flags:
    """Flags of states in which so much decides whether ego's body lies across a line."""
    own = context.ego_extents
    across = np.minimum(-own.left_of_min[0], own.left_of_max[0])
    near: Flags = (np.abs(across - context.thresholds.touching_m) <= margin_m[:, None]).any(axis=1)
    return near


def _bodies(context: DriveContext) -> list[tuple[_Body, _Body]]:
    """Ego's body in each state, as it stands and parallel to the road."""
    own, bodies = context.ego_extents, []
    low, middle, high = (values[0] for values in (own.left_of_min, own.left_of, own.left_of_max))
    headings = context.ego.heading[0]
    for _, state, outline in context.ego.outlines(repeated=True):
        way = headings[state]
        width = float(np.ptp(outline @ (-np.sin(way), np.cos(way))))
        parallel = middle[state] - width / 2, middle[state] + width / 2
        bodies.append(((low[state], high[state]), parallel))
    return bodies


def _marks_under_ego(
    context: DriveContext,
    state: int,
    row: list[Lanelet | None],
    body: _Body,
    more: float = 0,
    shift: float = 0,
) -> list[_Marks]:
    """The marks of the lines that ego's body lies across, those at ego's side first.

    Line ``k`` lies right of lane ``k``. By so much (m) ``more``, and with ego so far right.
    """
    reach = context.thresholds.touching_m + more
    across = np.minimum(shift - body[0], body[1] - shift).tolist()
    crossed = []
    for line, (right, left) in enumerate(pairwise([None, *row, None])):
        if across[line] > reach:
            marks = _between(right, left)
            crossed.append(marks[::-1] if context.steady_lane[state] >= line else marks)
    return crossed
