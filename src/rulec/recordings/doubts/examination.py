"""Recordings examined: what contradicts the choices made, and what cannot be believed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from rulec.diagnostics import SourceLocation
from rulec.recordings.adjacency import with_side
from rulec.recordings.doubts.motion_doubts import with_doubts
from rulec.recordings.doubts.road_doubts import check_near
from rulec.recordings.recording import Recording
from rulec.recordings.recording_format import RECORDING, RecordingSource
from rulec.recordings.recording_messages import OTHER_CHOICE
from rulec.trace.plain_arrays import keep_freed_memory

_SAME_RATE = 0.02


def examination_of(source: RecordingSource, *, takes_map: bool) -> Callable[[Recording], Recording]:
    """A function that takes a recording of this source, and returns it with its doubts.

    It raises RulecError R0610 and R0615.
    """
    keep_freed_memory()
    rate = source.frame_rate
    refused = partial(RECORDING.refused, source.path)

    def examined(recording: Recording) -> Recording:
        if takes_map:
            check_near(recording, source.path)
        if rate is not None and abs(rate * recording.step_s - 1) > _SAME_RATE:
            raise OTHER_CHOICE.error(
                SourceLocation(str(source.path)),
                f"`{source.path.name}` states its own time steps, of {recording.step_s:g} s",
                help=f"leave out --frame-rate; `--frame-rate {1 / recording.step_s:g}` confirms it",
            )
        return with_doubts(with_side(recording), refused, sure=rate is not None)

    return examined
