"""Which participants turn across the way of oncoming traffic, and have to let it pass."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, radians, sin

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_lanelets import map_contents
from rulec.extraction.tracks.at_junctions.junction_passages import Passage
from rulec.extraction.tracks.at_junctions.junctions import JunctionWay, entry_lights
from rulec.recordings.recording import (
    ALL_STOP,
    GIVE_WAY_SIGNS,
    STOP_SIGNS,
    Points,
    is_there,
)

_ONE_GIVES_WAY = GIVE_WAY_SIGNS - {ALL_STOP}
"""Where all have to stop, the participant that came first goes first."""

SLOWEST_MPS = 1.0
"""A slower vehicle waits; one standing in a junction as its track ends goes on this fast."""

_STOPPED_S = 10.0
"""Who stood so short a time before entering a junction may have had to stop at its line."""

_CLEARED_S = 2.0
"""A light that has been red for this long as a vehicle enters the junction was red before."""


def turns_far(context: DriveContext, passage: Passage) -> bool:
    """Whether a participant turns to the far side, or round."""
    towards_far = 1.0 if context.side == "right" else -1.0
    turned = context.surroundings.passages.way(passage).turned * towards_far
    return turned > radians(context.thresholds.turned_deg)


def gives_way_to(context: DriveContext, own: Passage, other: Passage) -> bool:
    """Whether ego turns across the way of an oncoming participant that has priority.

    That one goes straight on or turns to its near side, and neither signs nor a red light stop it;
    where all have to stop, it does not enter more than ``together_s`` after ego.
    """
    way_of = context.surroundings.passages.way
    return (
        turns_far(context, own)
        and not turns_far(context, other)
        and goes_first(way_of(own), way_of(other))
        and not _came_at_red(context, other)
        and not _stopped_later(context, own, other)
    )


def _stopped_later(context: DriveContext, own: Passage, other: Passage) -> bool:
    """Whether all have to stop, and the other one entered the junction later."""
    later_s = (other.first - own.first) * context.recording.step_s
    if later_s <= context.thresholds.together_s:
        return False
    return context.surroundings.passages.junctions[own.junction].all_have_to_stop is True


def goes_first(own: JunctionWay, other: JunctionWay) -> bool:
    """True unless the map says that the other way, which is oncoming, gives way to one's own."""
    first = own.lanelets[0].first
    if first is not None:
        return bool(first & other.names)
    its, mine = (
        any(entry.signs & GIVE_WAY_SIGNS for entry in way.approaches) for way in (other, own)
    )
    return mine or not its


def is_settled(own: JunctionWay, other: JunctionWay) -> bool | None:
    """Whether signs stop both ways, and the map says that one's own does not have to wait.

    None if they do and the map does not say which has to: then signs give priority to neither.
    """
    stopped = [
        any(entry.signs & _ONE_GIVES_WAY for entry in way.approaches) for way in (own, other)
    ]
    if not all(stopped):
        return False
    first = own.lanelets[0].first
    return None if first is None else not first & other.names


def _came_at_red(context: DriveContext, other: Passage) -> bool:
    """Whether a participant has entered the junction past a light that was red."""
    shown = list(_shown(context, other))
    return bool(shown) and all(colour == "red" for colour in shown)


def _shown(context: DriveContext, other: Passage) -> Iterator[str | None]:
    """What a participant's lights showed when it crossed their line, if that is on the map.

    Otherwise during all of the time in which it may have crossed it.
    """
    passages = context.surroundings.passages
    since = context.steps_in(_CLEARED_S)
    for entry, lights in entry_lights(passages.way(other)):
        crossed = _crossed(context, other, entry.stop_line)
        columns = range(other.first - since, other.first + 1)
        if crossed is not None:
            columns = range(crossed - 1, crossed + 1)
        for light in lights:
            yield from (light.colour_at(passages.tracks.first + column) for column in columns)


def _crossed(context: DriveContext, other: Passage, line: Points | None) -> int | None:
    """The column in which a participant's front crosses a line before a passage, or None."""
    if line is None:
        return None
    passages, until = context.surroundings.passages, slice(0, other.first + 1)
    (x, y), ahead = line.mean(axis=0), (cos(other.heading), sin(other.heading))
    tracks, half = passages.tracks, float(passages.lengths[other.row]) / 2
    way = (tracks.x[other.row, until] - x) * ahead[0] + (tracks.y[other.row, until] - y) * ahead[1]
    before = (way + half < 0).nonzero()[0]
    return int(before[-1]) + 1 if len(before) else None


def may_have_to_stop(context: DriveContext, own: Passage, other: Passage) -> bool:
    """Whether an oncoming participant may have entered later because all have to stop, as it did.

    A map without any stop sign does not show that there are none; where lights are, nobody has to.
    """
    passages, step_s = context.surroundings.passages, context.recording.step_s
    if (other.first - own.first) * step_s <= context.thresholds.together_s:
        return False
    if passages.junctions[own.junction].all_have_to_stop is False:
        stop_signs = STOP_SIGNS & (context.recording.complete | map_contents(context).signs)
        by_entry = entry_lights(passages.way(other))
        if stop_signs or any(is_there(light) for _, lights in by_entry for light in lights):
            return False
    since = max(other.first - round(_STOPPED_S / step_s), 0)
    waits = passages.tracks.speed[other.row, since : other.first + 1] < SLOWEST_MPS
    return bool(waits.any())
