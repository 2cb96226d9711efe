"""Signals of ego's own lamps, where the recording contains them."""

from __future__ import annotations

import numpy as np

from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.signal_columns import Measured, SignalColumns
from rulec.extraction.signals.words import word
from rulec.recordings.recording import Lamp
from rulec.trace.partly_known.partly_known_values import Truth

_FOG_LAMPS: tuple[tuple[str, Lamp], ...] = (
    ("front_fog_lamps", "front_fog_lamp"),
    ("rear_fog_lamps", "rear_fog_lamp"),
)
_HEADLAMPS = ("lamps_off", "dipped_beam", "main_beam")
_BEAMS = frozenset[Lamp]({"dipped_beam", "main_beam"})
FLASH_S = 1.0
"""Flashing lights count as on if they are lit within this time (s)."""


@word("headlamps")
def _headlamps(context: DriveContext) -> Measured | None:
    """The brightest of ego's lamps; without a beam there may be weaker ones, unless it is night.

    At night none of those would be enough.
    """
    egos = context.ego.participants
    if not context.spans.agreed([ego.lamps and ego.shows >= _BEAMS for ego in egos]):
        return None
    lit = ego_lamps(context)
    codes = [2 if "main_beam" in (x or ()) else "dipped_beam" in (x or ()) for x in lit]
    dark = [x is None or not (x & _BEAMS or context.recording.weather.night) for x in lit]
    return Measured(np.array(codes, dtype=int), np.array(dark, dtype=bool), texts=_HEADLAMPS)


@word("front_fog_lamps", "rear_fog_lamps")
def _fog_lamps(context: DriveContext) -> SignalColumns:
    egos = context.ego.participants
    told = [
        (name, lamp)
        for name, lamp in _FOG_LAMPS
        if context.spans.agreed([ego.lamps and lamp in ego.shows for ego in egos])
    ]
    lit = ego_lamps(context) if told else ()
    untold = np.array([x is None for x in lit], dtype=bool)
    shown = {name: np.array([lamp in (x or ()) for x in lit], dtype=bool) for name, lamp in told}
    return SignalColumns({name: Truth(own, own | untold) for name, own in shown.items()})


@word("ego_on_call")
@once
def ego_on_call(context: DriveContext) -> Truth:
    """Ego's blue lights; unknown only for emergency vehicles whose lights are not recorded."""
    egos, spread = context.ego.participants, context.spans.spread
    may_be = spread([ego.type == "priorityVehicle" for ego in egos])
    shows = spread(["blue_light" in ego.shows for ego in egos])
    if not (may_be | shows).any():
        return Truth.known(may_be)
    lit = ego_lamps(context)
    blue = np.array(["blue_light" in (lamps or ()) for lamps in lit], dtype=bool)
    recorded = shows & np.array([lamps is not None for lamps in lit], dtype=bool)
    steps = context.steps_in(FLASH_S)
    flashing = context.spans.within(blue[None], steps, around=True)[0]
    return Truth(flashing, flashing | may_be & ~recorded)


@once
def ego_lamps(context: DriveContext) -> list[frozenset[Lamp] | None]:
    """Ego's lit lamps by state; None where the recording does not contain them."""
    drives = zip(context.ego.participants, context.spans.slices, strict=True)
    return [
        lamps
        for ego, columns in drives
        for lamps in map(ego.lamps.get, context.steps[columns].tolist())
    ]
