"""What a recording is as a whole, which its parts know, too."""

from __future__ import annotations

from collections.abc import Iterable

from rulec.recordings.recording import Participant, Recording, StatedError, WholeRecording
from rulec.recordings.track import TrackOutlines


def whole_recording(recording: Recording) -> WholeRecording:
    """What is known of all of a recording, or of that which one is a part of."""
    if recording.whole is not None:
        return recording.whole
    spans = [span_of(body) for body in _moving(recording)]
    first = min((begins for begins, _ in spans), default=0)
    stated = [body.stated_error for body in recording.participants if body.stated_error]
    return WholeRecording(
        first=first,
        last=max((ends for _, ends in spans), default=0),
        stated_error=_in_the_middle(stated) if stated else None,
        arrivals=any(
            begins > first
            for body, (begins, _) in zip(_moving(recording), spans, strict=True)
            if "vehicle" in body.object_types
        ),
        shows=frozenset().union(*(body.shows for body in recording.participants)),
    )


def _in_the_middle(stated: Iterable[StatedError]) -> StatedError:
    # 4 ms: only where a source states errors.
    from statistics import median

    return StatedError(*map(median, zip(*stated, strict=True)))


def looked_at(recording: Recording) -> tuple[int, int]:
    """The first and the last time step of a recording's arrays.

    Those of a part have one more on each side, if the recording has: who is there in an array's
    last step may go on, unlike others.
    """
    spans = [span_of(body) for body in _moving(recording)]
    first = min((begins for begins, _ in spans), default=0)
    last = max((ends for _, ends in spans), default=0)
    if recording.whole is None:
        return first, last
    return max(recording.whole.first, first - 1), min(recording.whole.last, last + 1)


def span_of(body: Participant) -> tuple[int, int]:
    """The first and the last time step of a participant, which is somewhere."""
    if isinstance(body.outlines, TrackOutlines):
        steps = body.outlines.track.steps
        return int(steps[0]), int(steps[-1])
    return min(body.outlines), max(body.outlines)


def _moving(recording: Recording) -> Iterable[Participant]:
    """Those who are somewhere, and do not stand for good."""
    return (body for body in recording.participants if body.outlines and not body.standing)
