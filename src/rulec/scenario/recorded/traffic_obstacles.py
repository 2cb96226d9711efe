"""The participants of a recording as obstacles on ego's road."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import cos, degrees

import numpy as np

from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import Participant, Points, Recording
from rulec.scenario import scenario_model as model
from rulec.scenario.geometry import Box
from rulec.scenario.recorded.joined_outlines import JoinedOutlines
from rulec.scenario.recorded.lane_coordinates import Lanes, kept_off_touched, outline_bounds
from rulec.scenario.recorded.reference_line import ReferenceLine
from rulec.scenario.recorded.route import REACH_M

GOES_ON_S = 600.0
"""How long (s) the participants present at the end of a recording continue after it."""

_LOST_S = 1.0
"""A participant that disappears this shortly (s) before a recording's end is present there."""

_FAR_M = 10.0
_SPEED_OVER_S = 0.5
_AT_ONCE = 20_000


@dataclass(frozen=True, slots=True, kw_only=True)
class TrafficView:
    """A recording seen along a line from ego's place at time 0, with ego's speed (m/s) then."""

    recording: Recording
    line: ReferenceLine
    lanes: Lanes
    ego_s: float
    at_s: float
    road: Box
    ego_d: float = 0.0
    ego_speed: float = 0.0

    def time(self, step: int) -> float:
        """The scenario's time (s) of a time step; 3 x 0.1 s is 0.3 s, as typed."""
        return round(step * self.recording.step_s - self.at_s, 9)

    @property
    def until_s(self) -> float:
        """The scenario's time (s) at which the recording ends."""
        steps = (
            max(participant.outlines)
            for participant in self.recording.participants
            if participant.outlines and not participant.standing
        )
        return self.time(max(steps, default=0))

    def is_followed_by(self, body: Box, time_s: float) -> bool:
        """Whether a body in ego's path is behind the place that ego has reached by then."""
        return body.d_min < self.ego_d < body.d_max and body.s_max < self.ego_speed * time_s

    def boxes(self, outlines: Sequence[Points]) -> list[Box | None]:
        """The bounding boxes of outlines in the scenario; None for one far from the road."""
        # A closed road returns to the same place, so feet are sought only near ego
        near = np.full(len(outlines), self.ego_s), np.full(len(outlines), REACH_M + _FAR_M)
        if not outlines:
            return []
        joined = JoinedOutlines.of(outlines)
        low, high = outline_bounds(joined, self.line, self.lanes.straightened, near)
        low[:, 2], high[:, 2] = kept_off_touched(low[:, 2], high[:, 2], self.lanes.straight)
        low, high = low[:, ::2] - (self.ego_s, 0.0), high[:, ::2] - (self.ego_s, 0.0)
        wide = Box(
            self.road.s_min - _FAR_M,
            self.road.s_max + _FAR_M,
            self.road.d_min - _FAR_M,
            self.road.d_max + _FAR_M,
        )
        boxes = (
            Box(s0, s1, d0, d1)
            for (s0, d0), (s1, d1) in zip(low.tolist(), high.tolist(), strict=True)
        )
        return [box if box.overlaps(wide) else None for box in boxes]


def traffic_obstacles(
    view: TrafficView,
    ego: str | None,
    prediction: model.Prediction | Mapping[model.Prediction, Fraction],
) -> Iterator[model.Obstacle]:
    """The obstacles on the road from time 0 on, in the file's order."""
    predictions = {prediction: Fraction(1)} if isinstance(prediction, str) else prediction
    others = [body for body in view.recording.participants if body.id != ego and body.outlines]
    for participant, steps, own in _laid_out(view, others):
        motions = [
            model.Alternative(weight, motion)
            for kind, weight in predictions.items()
            if (motion := _motion(view, participant, steps, own, kind)) is not None
        ]
        if not motions:
            continue
        likeliest, *alternatives = model.weighted(motions)
        first = next(box for box in own if box is not None)
        words = participant.object_types
        yield model.Obstacle(
            id=participant.id,
            type=words[0],
            length=first.s_max - first.s_min,
            width=first.d_max - first.d_min,
            motion=likeliest.motion,
            walking_direction=_walking_direction(view, participant),
            signals=_signals(participant),
            broader=words[1:],
            weight=likeliest.weight,
            alternatives=tuple(alternatives),
        )


def _laid_out(
    view: TrafficView, others: Sequence[Participant]
) -> Iterator[tuple[Participant, list[int], list[Box | None]]]:
    waiting: list[tuple[Participant, list[int]]] = []
    count = 0
    for number, participant in enumerate(others, 1):
        steps = [
            k for k in sorted(participant.outlines) if participant.standing or view.time(k) >= 0
        ]
        waiting.append((participant, steps))
        count += len(steps)
        if count >= _AT_ONCE or number == len(others):
            boxes = iter(view.boxes([body.outlines[k] for body, known in waiting for k in known]))
            for participant, known in waiting:
                yield participant, known, [next(boxes) for _ in known]
            waiting, count = [], 0


def _motion(
    view: TrafficView,
    participant: Participant,
    steps: Sequence[int],
    boxes: Sequence[Box | None],
    prediction: model.Prediction,
) -> model.Motion | None:
    """A participant's motion; None off the road, or if constant without a state at time 0."""
    now = boxes[0] if steps and (participant.standing or view.time(steps[0]) == 0) else None
    if participant.standing or prediction == "constant" or (now and len(participant.outlines) == 1):
        if now is None:
            return None
        if participant.standing and not now.overlaps(view.road):
            return None
        return _constant(view, participant, steps[0], now)
    if not any(box is not None and box.overlaps(view.road) for box in boxes):
        return None
    times = [view.time(step) for step in steps]
    known = list(boxes)
    last, is_lost = known[-1], times[-1] < view.until_s
    # How a lost follower would have braked for ego is unknown
    goes_on = last is not None and not (is_lost and view.is_followed_by(last, times[-1]))
    if times[-1] >= view.until_s - _LOST_S and last is not None and goes_on:
        goes_on_s = view.until_s - times[-1] + GOES_ON_S
        along = _speed(times, known) * goes_on_s
        times.append(times[-1] + goes_on_s)
        known.append(replace(last, s_min=last.s_min + along, s_max=last.s_max + along))
    return model.Footprints(tuple(times), tuple(known))


def _constant(
    view: TrafficView, participant: Participant, step: int, box: Box
) -> model.ConstantAcceleration:
    s, d = (box.s_min + box.s_max) / 2, (box.d_min + box.d_max) / 2
    state = participant.states.get(step)
    if participant.standing or state is None:
        return model.ConstantAcceleration(s, d)
    along = cos(state.heading - view.line.heading_at(s + view.ego_s))
    return model.ConstantAcceleration(s, d, state.speed * along, state.acceleration * along)


def _speed(times: Sequence[float], boxes: Sequence[Box | None]) -> float:
    """The mean speed (m/s) along the road over the last half second."""
    last = boxes[-1]
    first, since = last, times[-1]
    for time, box in zip(reversed(times), reversed(boxes), strict=True):
        if box is None or time < times[-1] - _SPEED_OVER_S:
            break
        first, since = box, time
    if last is None or first is None or since == times[-1]:
        return 0.0
    return first.shift_to(last)[0] / (times[-1] - since)


def _walking_direction(view: TrafficView, participant: Participant) -> float | None:
    """The direction (degrees) of a pedestrian that never moves; None if its motion shows it."""
    state = next(iter(participant.states.values()), None)
    if participant.object_types[0] != model.PEDESTRIAN or state is None:
        return None
    if len({(own.x, own.y) for own in participant.states.values()}) > 1:
        return None
    place = view.line.coordinates(np.array([[state.x, state.y]]))
    turn = state.heading - view.line.heading_at(float(np.nan_to_num(place[0, 0])))
    return degrees(wrapped(turn))


def _signals(participant: Participant) -> dict[str, model.SignalValue]:
    signals: dict[str, model.SignalValue] = {
        "two_wheeled": participant.type in ("motorcycle", "bicycle")
    }
    if participant.type == "parkedVehicle":
        signals["parked"] = True
    return signals
