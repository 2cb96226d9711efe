"""A mirrored recording, in which traffic keeps to the other side."""

from __future__ import annotations

from dataclasses import replace

from rulec.recordings import recording as model

_LAMPS: dict[model.Lamp, model.Lamp] = {
    "left_indicator": "right_indicator",
    "right_indicator": "left_indicator",
    "left_doors": "right_doors",
    "right_doors": "left_doors",
}
_BROAD_LINES = {
    model.BROAD_LEFT: model.BROAD_RIGHT,
    model.BROAD_RIGHT: model.BROAD_LEFT,
}
_OTHER: dict[model.Side | None, model.Side | None] = {"left": "right", "right": "left", None: None}


def mirrored_recording(recording: model.Recording) -> model.Recording:
    """Mirror a recording: negate ``y``, exchange left and right."""
    return replace(
        recording,
        lanelets={number: _lanelet(item) for number, item in recording.lanelets.items()},
        participants=tuple(mirrored_participant(item) for item in recording.participants),
        problems=tuple(
            replace(problem, start=_state(problem.start), goals=_points(problem.goals))
            for problem in recording.problems
        ),
        side=_OTHER[recording.side],
    )


def _points(points: model.Points) -> model.Points:
    return points * (1.0, -1.0)


def _lanelet(lanelet: model.Lanelet) -> model.Lanelet:
    return replace(
        lanelet,
        left=_points(lanelet.right),
        right=_points(lanelet.left),
        centre=_points(lanelet.centre),
        left_of=lanelet.right_of,
        right_of=lanelet.left_of,
        left_mark=lanelet.right_mark,
        right_mark=lanelet.left_mark,
        types=frozenset(_BROAD_LINES.get(kind, kind) for kind in lanelet.types),
        stop_line=None if lanelet.stop_line is None else _points(lanelet.stop_line),
    )


def mirrored_participant(participant: model.Participant) -> model.Participant:
    """Mirror a participant of a recording, and its lamps."""
    return replace(
        participant,
        states={step: _state(state) for step, state in participant.states.items()},
        outlines={step: _points(outline) for step, outline in participant.outlines.items()},
        lamps={
            step: frozenset(_LAMPS.get(lamp, lamp) for lamp in lit)
            for step, lit in participant.lamps.items()
        },
    )


def _state(state: model.TrackState) -> model.TrackState:
    return replace(state, y=-state.y, heading=-state.heading)
