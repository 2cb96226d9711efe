"""Who turns across the way of those who come towards it, and has to let them pass."""

from __future__ import annotations

from collections.abc import Iterator
from math import radians

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.tracks.junction_passages import Passage
from rulec.extraction.tracks.junctions import JunctionWay, approaches
from rulec.scenario.recorded.recording import Light, Recording

_GIVES_WAY = frozenset({"YIELD", "STOP", "STOP_4_WAY"})

_CLEARED_S = 2.0
"""A light that has been red for so long when one gets into the junction was red at its line."""


def turns_far(context: DriveContext, passage: Passage) -> bool:
    """True if a participant turns to the far side, or round."""
    towards_far = 1.0 if context.side == "right" else -1.0
    turned = context.surroundings.passages.way(passage).turned * towards_far
    return turned > radians(context.thresholds.turned_deg)


def gives_way_to(context: DriveContext, own: Passage, other: Passage) -> bool:
    """Does ego turn across the way of one that comes towards it, and that goes first?

    That one goes straight on or turns to its near side, and neither signs nor a red light stop it.
    """
    way_of = context.surroundings.passages.way
    return (
        turns_far(context, own)
        and not turns_far(context, other)
        and goes_first(context.recording, way_of(own), way_of(other))
        and not _came_at_red(context, other)
    )


def goes_first(recording: Recording, own: JunctionWay, other: JunctionWay) -> bool:
    """True unless the map says that the other way, which comes towards one's own, gives way."""
    first = own.lanelets[0].first
    if first is not None:
        return bool(first & other.names)
    its, mine = (
        any(entry.signs & _GIVES_WAY for entry in approaches(recording, way))
        for way in (other, own)
    )
    return mine or not its


def _came_at_red(context: DriveContext, other: Passage) -> bool:
    """True if a participant has come into the junction past a light that was red."""
    passages = context.surroundings.passages
    first = other.first + passages.tracks.first
    since = round(_CLEARED_S / context.recording.step_s)
    lights = list(_lights(context.recording, passages.way(other)))
    steps = range(first - since, first + 1)
    return bool(lights) and all(
        light.colour_at(step) == "red" for light in lights for step in steps
    )


def _lights(recording: Recording, way: JunctionWay) -> Iterator[Light]:
    for entry in (recording.lanelets[name] for name in way.entries if name in recording.lanelets):
        own = entry.lights_to.get(way.lanelets[0].id)
        yield from (own,) if own else entry.lights
