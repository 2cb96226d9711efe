"""Make a scene of a recorded drive and its verdict."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import inf

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.diagnostics import first_of
from rulec.extraction.presences import participant_called
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.traces.recorded_drive import Drive
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.extraction.tracks.tracks import Tracks, tracks_of
from rulec.monitoring.explain.explained_parts import Deciding
from rulec.monitoring.explain.explanation import Explanation, explain
from rulec.monitoring.verdict import Verdict, Violation
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import Points
from rulec.report.pictures.drives.drive_scene import (
    Body,
    DriveScene,
    SceneViolation,
    lanelets_near,
    road_areas,
    road_marks,
    scene_lights,
    scene_signs,
)
from rulec.report.pictures.picture_captions import trace_title
from rulec.report.pictures.trace_ribbon import in_words, ribbon
from rulec.report.verdicts.verdict_report import in_a_line, open_in_words
from rulec.vocabulary.partial_values import Interval

SIGHT_M = 120.0
"""A participant farther from ego (m) is not drawn."""

MOST_VIOLATIONS = 50
"""Number of a drive's violations that are drawn."""

MOST_OPEN = 6
"""Number of rules named that are open, or that cannot be judged."""


def drive_scene(
    drive: Drive,
    verdict: Verdict,
    verdicts: RecordingVerdicts,
    kept: frozenset[str] | None,
) -> DriveScene:
    """The scene of a drive, with its violations of the rules ``kept``; None for all rules.

    A recording that was mirrored for judging is drawn as recorded.
    """
    if kept is not None:
        verdict = replace(
            verdict,
            violations=tuple(one for one in verdict.violations if one.rule in kept),
            open=tuple(one for one in verdict.open if one.rule in kept),
            not_judged=tuple(one for one in verdict.not_judged if one.rule in kept),
        )
    recording = verdicts.recording
    if verdicts.mirrored:
        recording = mirrored_recording(recording)
    tracks = tracks_of(recording, verdicts.request.thresholds)
    first = round(drive.start_s / recording.step_s)
    columns = slice(first - tracks.first, first - tracks.first + drive.arrays.n_states)
    tracks = tracks.part(np.arange(len(tracks.participants)), columns)
    row = next(n for n, body in enumerate(tracks.participants) if body.id == drive.ego)
    path = np.stack([tracks.x[row], tracks.y[row]], axis=1)
    origin: Points = np.round(path.mean(axis=0))
    lanelets = lanelets_near(recording, path)
    bodies = _bodies(tracks, row, origin)
    known = recording.ids
    participants = {name: participant_called(name, known) for name in drive.arrays.objects}
    ids = {body.id: body for body in bodies}
    steps = range(first, first + drive.arrays.n_states)
    in_time = sorted(verdict.violations, key=lambda one: inf if one.step is None else one.step)
    return DriveScene(
        title=f"{recording.name}, {trace_title(verdict, verdicts.rules)}",
        notes=tuple(_notes(verdicts, verdict)),
        ego=drive.ego,
        start_s=drive.start_s,
        step_s=recording.step_s,
        states=drive.arrays.n_states,
        areas=tuple(road_areas(lanelets, origin)),
        marks=tuple(road_marks(lanelets, origin)),
        lights=tuple(scene_lights(lanelets, origin, steps)),
        signs=tuple(scene_signs(lanelets, origin)),
        bodies=bodies,
        violations=tuple(
            _violation(violation, drive, verdicts.rules, ids, participants)
            for violation in in_time[:MOST_VIOLATIONS]
        ),
    )


def _notes(verdicts: RecordingVerdicts, verdict: Verdict) -> Iterator[str]:
    """Further remarks: open verdicts, rules not judged, and how it was judged."""
    for result in verdict.open[:MOST_OPEN]:
        about = f" for {' and '.join(result.binding.values())}" if result.binding else ""
        yield f"{result.rule}{about}: {open_in_words(result)}"
    if len(verdict.open) > MOST_OPEN:
        yield f"and {len(verdict.open) - MOST_OPEN:,} more open"
    if verdict.not_judged:
        names = first_of([rule.rule for rule in verdict.not_judged], MOST_OPEN)
        yield f"cannot be judged from this recording: {names}"
    if verdicts.defaults:
        yield "what the recording does not tell has its default"
    if verdicts.mirrored:
        yield "drawn as recorded; judged as its mirror image, so that left is right in the rules"


def _bodies(tracks: Tracks, ego: int, origin: Points) -> tuple[Body, ...]:
    """Ego, then all participants that are within sight of it at some time."""
    distance = np.hypot(tracks.x - tracks.x[ego], tracks.y - tracks.y[ego])
    in_sight = tracks.present & (np.nan_to_num(distance, nan=np.inf) <= SIGHT_M)
    others = [row for row in np.flatnonzero(in_sight.any(axis=1)).tolist() if row != ego]
    return tuple(_body(tracks, row, in_sight[row], origin) for row in (ego, *others))


def _body(tracks: Tracks, row: int, in_sight: NDArray[np.bool_], origin: Points) -> Body:
    body = tracks.participants[row]
    columns = np.flatnonzero(in_sight)
    first, last = int(columns[0]), int(columns[-1])
    poses = np.stack([tracks.x[row], tracks.y[row], tracks.heading[row]], axis=1)
    poses = np.where(in_sight[:, None], poses, np.nan)[first : last + 1]
    known: dict[bytes, int] = {}
    shapes: list[Points] = []
    shape = np.zeros(len(poses), dtype=np.intp)
    standing = next(iter(body.outlines.values())) if body.standing else None
    for at in np.flatnonzero(~np.isnan(poses[:, 0])).tolist():
        outline = body.outlines[tracks.first + first + at] if standing is None else standing
        own = _ring(_in_own_frame(outline, poses[at]))
        shape[at] = known.setdefault(own.tobytes(), len(shapes))
        if shape[at] == len(shapes):
            shapes.append(own)
    return Body(
        id=body.id,
        type=body.type,
        first=first,
        poses=poses - (*origin, 0.0),
        speeds=tracks.speed[row, first : last + 1] * KMH_PER_MPS,
        shapes=tuple(shapes),
        shape=shape,
    )


def _in_own_frame(outline: Points, pose: NDArray[float64]) -> Points:
    x, y, heading = pose
    cos, sin = np.cos(heading), np.sin(heading)
    own: Points = np.round((outline - (x, y)) @ np.array([[cos, -sin], [sin, cos]]), 2) + 0.0
    return own


def _ring(points: Points) -> Points:
    """The corners in order, without the middles of the sides that may follow them in the array."""
    corners = points[: len(points) // 2]
    middles = (corners + np.roll(corners, -1, axis=0)) / 2
    behind = len(points) % 2 == 0 and np.allclose(points[len(corners) :], middles, atol=0.02)
    return corners if behind else points


def _violation(
    violation: Violation,
    drive: Drive,
    rules: CompiledRulebook,
    bodies: Mapping[str, Body],
    participants: Mapping[str, str],
) -> SceneViolation:
    trace = drive.trace
    rule = next(rule for rule in rules.rules if rule.name == violation.rule)
    only = replace(rules, rules=(rule,))
    objects = tuple(violation.binding.values())
    last = len(trace.states) - 1
    state = last if violation.step is None else violation.step
    explanation = explain(violation, trace, only, drive.decided_by)
    against = tuple(dict.fromkeys(participants[item] for item in objects))
    other = next((bodies[item] for item in against if item in bodies), None)
    return SceneViolation(
        rule=rule.name,
        strength=violation.strength,
        state=state,
        time_s=drive.time_s(state),
        title=in_a_line(violation, rule, rules.name),
        short=_short(violation, rule),
        says=rule.says,
        against=against,
        measured=tuple(
            f"at {drive.time_s(at):g} s: {margin}" for margin, at in explanation.measured()
        ),
        deciding_values=tuple(_deciding_values(explanation)),
        read=ribbon(trace, only, Verdict(trace.id, (violation,)), objects),
        decides=frozenset(fact.text for fact in explanation.facts if fact.decides),
        narrowly={
            f"{name}({item})": tuple(_sides(numbers, item, last + 1))
            for name, numbers in drive.decided_by.items()
            for item in objects
        },
        links=nearest_points(bodies[drive.ego], other, last + 1),
        gaps=tuple(_gaps(drive, objects)),
    )


def _short(violation: Violation, rule: CompiledRule) -> str:
    """The rule's strength and its article, the objects, and whether only the end decides."""
    objects = " and ".join(violation.binding.values())
    end = "decided by the end" if violation.step is None else ""
    return ", ".join(filter(None, (rule.strength, rule.cite, objects and f"for {objects}", end)))


def _deciding_values(explanation: Explanation) -> Iterator[str]:
    """The deciding values except numbers, which are in ``measured``."""
    at = explanation.states.index(explanation.decisive)
    for fact in explanation.facts:
        value = fact.values[at]
        if fact.decides and isinstance(value, bool | str) and not any(fact.margins):
            yield f"{fact.text} {in_words(value)}"


def _sides(numbers: Deciding, item: str, states: int) -> Iterator[str]:
    for state in range(states):
        margin = numbers.margin(item, state)
        yield f"{margin.sides} {margin.unit}" if margin else ""


def _gaps(drive: Drive, objects: Sequence[str]) -> Iterator[float | Interval | None]:
    """The gap to the first object by state: the one that decided a signal, if one did.

    Its error is less than that of the gap alone, whose bounds hold for every rule.
    """
    for number, state in enumerate(drive.trace.states):
        decided = (by.margin(objects[0], number) for by in drive.decided_by.values() if objects)
        own = next((by for by in decided if by and by.text == f"gap({objects[0]})"), None)
        if own is not None:
            yield Interval(own.value - own.value_error, own.value + own.value_error)
            continue
        gaps = state.get("gap")
        gap = gaps.get(objects[0]) if objects and isinstance(gaps, Mapping) else None
        yield gap if isinstance(gap, float | Interval) else None


_AS_NEAR_M = 0.25
"""Points farther by less (m) count as equally near: for parallel sides the middle is taken."""


def nearest_points(ego: Body, other: Body | None, states: int) -> NDArray[float64]:
    """The nearest points (x, y, x, y) by state, NaN where one body is absent."""
    links = np.full((states, 4), np.nan)
    for state in range(states) if other else ():
        own, theirs = ego.outline(state), other.outline(state) if other else None
        if own is not None and theirs is not None:
            links[state] = _nearest(own, theirs)
    return links


def _nearest(own: Points, theirs: Points) -> NDArray[float64]:
    """The middle of all point pairs that are about as near as the nearest one.

    For overlapping bodies, a point that both cover, twice.
    """
    common = np.concatenate([own[_inside(own, theirs)], theirs[_inside(theirs, own)]])
    if len(common):
        return np.tile(common.mean(axis=0), 2)
    feet, corners = _feet(own, theirs), _feet(theirs, own)
    pairs = np.concatenate([np.hstack(feet[:2]), np.hstack(corners[1::-1])])
    distances = np.concatenate([feet[2], corners[2]])
    nearest: NDArray[float64] = pairs[distances <= distances.min() + _AS_NEAR_M]
    low, high = nearest.min(axis=0), nearest.max(axis=0)
    middle: NDArray[float64] = (low + high) / 2 if len(nearest) > 1 else nearest[0]
    return middle


def _feet(corners: Points, ring: Points) -> tuple[Points, Points, NDArray[float64]]:
    """The corners, the nearest point on a ring for each, and their distances."""
    start, along = ring, np.roll(ring, -1, axis=0) - ring
    length = np.maximum((along**2).sum(axis=1), 1e-12)
    part = np.clip(((corners[:, None] - start) * along).sum(axis=2) / length, 0, 1)
    feet = start + part[..., None] * along
    distances = np.hypot(*np.moveaxis(corners[:, None] - feet, 2, 0))
    nearest = distances.argmin(axis=1)
    rows = np.arange(len(corners))
    return corners, feet[rows, nearest], distances[rows, nearest]


def _inside(points: Points, ring: Points) -> NDArray[np.bool_]:
    """Mask of the points inside a convex ring."""
    along = np.roll(ring, -1, axis=0) - ring
    to = points[:, None] - ring
    across = along[:, 0] * to[..., 1] - along[:, 1] * to[..., 0]
    inside: NDArray[np.bool_] = np.abs(np.sign(across).sum(axis=1)) == len(ring)
    return inside
