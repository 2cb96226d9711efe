"""Which lamps of participants are lit, and for which that is recorded."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rulec.array_types import Flags
from rulec.extraction.computed_once import once_a_recording
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.conduct.lamp_signals import FLASH_S
from rulec.recordings.recording import Lamp


@once_a_recording
def lamps_of_all(context: DriveContext) -> Mapping[Lamp, tuple[Flags, Flags]]:
    """Lamp -> masks of the recording's participants with it lit, and with it recorded."""
    tracks = context.surroundings.tracks
    flags: dict[Lamp, tuple[Flags, Flags]] = {}
    for row, body in enumerate(tracks.participants):
        steps = np.fromiter(body.lamps, dtype=int, count=len(body.lamps)) - tracks.first
        inside = (steps >= 0) & (steps < tracks.present.shape[1])
        for lamp in body.shows if inside.any() else ():
            if lamp not in flags:
                flags[lamp] = np.zeros_like(tracks.present), np.zeros_like(tracks.present)
            lit, told = flags[lamp]
            told[row, steps[inside]] = True
            shown = np.array([lamp in lamps for lamps in body.lamps.values()], dtype=bool)
            lit[row, steps[inside]] = shown[inside]
    return flags


def own_part(context: DriveContext, flags: Flags) -> Flags:
    """The drive's rows and columns of a mask for the whole recording."""
    return flags.take(context.tracks.rows, axis=0).take(context.columns, axis=1)


def lit_lamps(context: DriveContext, lamp: Lamp) -> tuple[Flags, Flags]:
    """Masks of participants whose lamp is lit, and of those for which it is recorded."""
    if lamp not in lamps_of_all(context):
        shape = context.relevant.shape
        return np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
    lit, told = lamps_of_all(context)[lamp]
    return own_part(context, lit), own_part(context, told)


def flashing(lit: Flags, context: DriveContext) -> Flags:
    """A mask of lit lamps that includes the time between two flashes."""
    return context.spans.within(lit, context.steps_in(FLASH_S), around=True)
