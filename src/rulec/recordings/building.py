"""Recordings built by programs: lanelets, participants, and checks that all of it fits together.

All mistakes are reported together, as one RulecError R0617.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import cast, get_args

import numpy as np
from numpy import float64
from numpy.typing import ArrayLike, NDArray

from rulec.diagnostics import did_you_mean, named
from rulec.diagnostics.argument_kinds import checked_kinds, expected, expected_fields
from rulec.recordings.building_checks import BuildingChecks
from rulec.recordings.encodings.file_values import LARGEST
from rulec.recordings.lane_centres.centre_lanelets import ALL_JUNCTIONS
from rulec.recordings.lanes.lane_table import FASTEST_LIMIT_MPS, WIDEST_M
from rulec.recordings.lanes.lanes_along import (
    LANE_TYPES,
    USUAL_WIDTH_M,
    lanelet_along,
    linked,
    unknown_references,
)
from rulec.recordings.mending import derived_motion as motion
from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import (
    HEADINGS,
    MENDED,
    MOST_STEPS,
    OBSTACLE_TYPES,
    Lamp,
    Lanelet,
    LaneMark,
    Light,
    ObservedLight,
    Participant,
    Points,
    Recording,
    Side,
)
from rulec.recordings.track import Track, tracked
from rulec.recordings.tracks.road_user_types import usual_size
from rulec.recordings.tracks.track_rows import LONGEST_BODY_M

_OFF_STEP = 0.02

_OTHER_STEP = 1.8
"""Speeds that differ by this factor all along are those of another time step, or other units."""

_ENOUGH_PAIRS, _MOVES_MPS = 3, 1.0
"""So many pairs of states of one that is this fast (m/s) tell."""

COMPLETE = frozenset(
    {"STOP", "YIELD", "PRIORITY", "GREEN_ARROW", "light", "rail", "roundabout", "lanes"}
    | {"officer", "arrivals", HEADINGS, MENDED}
    | ALL_JUNCTIONS
)
"""The kinds of things of which a recording can be declared complete."""


@checked_kinds
def build_lanelet(
    identifier: str | int,
    centre: ArrayLike,
    width: ArrayLike = USUAL_WIDTH_M,
    *,
    successors: Iterable[str | int] = (),
    predecessors: Iterable[str | int] = (),
    left_of: str | int | None = None,
    right_of: str | int | None = None,
    types: Iterable[str] = (),
    signs: Iterable[str] = (),
    limit_mps: float | None = None,
    left_mark: LaneMark | None = None,
    right_mark: LaneMark | None = None,
    stop_line: ArrayLike | None = None,
    lights: Iterable[Light | ObservedLight] = (),
    junction: str = "",
    foes: Iterable[str | int] | None = None,
    first: Iterable[str | int] | None = None,
) -> Lanelet:
    """A lanelet along the points of its centre line (m), in the direction of travel.

    ``width`` (m) is one number, or one for each point. ``left_of`` and ``right_of`` are the ids of
    the lanelets to its left and right that lead the same way; ``stop_line`` has two ends. Lights
    show ``LIGHT_COLOURS``, such as ``yellow``, an ``ObservedLight`` by time step. The other
    arguments are as in a ``Lanelet``. Raises RulecError R0617 with all mistakes.
    """
    name = str(identifier)
    checks = BuildingChecks(f"lanelet `{name:.40}`")
    if not name:
        checks.wrong("its id is empty")
    points = checks.points("centre", centre)
    widths = _widths(checks, width, centre, points)
    kinds, drawn = frozenset(types), None
    for kind in sorted(kinds - LANE_TYPES):
        checks.one_of("types", kind, LANE_TYPES)
    for side, mark in (("left_mark", left_mark), ("right_mark", right_mark)):
        if mark is not None:
            checks.one_of(side, mark, get_args(LaneMark))
    if limit_mps is not None:
        checks.positive("limit_mps", limit_mps, "m/s", FASTEST_LIMIT_MPS)
    if stop_line is not None:
        drawn = checks.points("stop_line", stop_line)
    shown = tuple(lights)
    for light in shown:
        checks.light(light)
    checks.raise_problems()
    return lanelet_along(
        name,
        points,
        widths,
        successors=tuple(map(str, successors)),
        predecessors=tuple(map(str, predecessors)),
        left_of=None if left_of is None else str(left_of),
        right_of=None if right_of is None else str(right_of),
        types=kinds | ({"intersection"} if junction else set()),
        signs=frozenset(signs),
        limit_mps=limit_mps,
        left_mark=left_mark,
        right_mark=right_mark,
        stop_line=drawn,
        lights=shown,
        junction=junction,
        foes=None if foes is None else frozenset(map(str, foes)),
        first=None if first is None else frozenset(map(str, first)),
    )


def _widths(
    checks: BuildingChecks, width: ArrayLike, centre: ArrayLike, kept: Points
) -> NDArray[float64] | float:
    try:
        is_one = np.ndim(width) == 0
    except ValueError:  # rows of different lengths
        is_one = False
    if is_one:
        return checks.positive("width", cast("float", width), "m", WIDEST_M)
    if checks.problems:
        return 1.0
    given = np.array(centre, dtype=float)
    widths = checks.numbers("width", width, len(given))
    if checks.problems:
        return 1.0
    if not (widths > 0).all():
        checks.wrong(f"`width[{int(np.argmin(widths))}]` is {widths.min():g}", "expected above 0")
    first = [int(np.argmax((given == point).all(axis=1))) for point in kept]
    kept_widths: NDArray[float64] = widths[first]
    return kept_widths


@checked_kinds
def build_participant(
    identifier: str | int,
    kind: str,
    t: ArrayLike,
    x: ArrayLike,
    y: ArrayLike,
    *,
    step_s: float,
    heading: ArrayLike | None = None,
    speed: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    length: float | None = None,
    width: float | None = None,
    standing: bool = False,
    lamps: Mapping[Lamp, Sequence[bool]] | None = None,
) -> Participant:
    """A participant from its track: times (s) and positions of its centre (m), one step apart.

    ``kind`` is CommonRoad's type of obstacles, such as ``car``. Headings are radians,
    counter-clockwise from the x axis, speeds m/s along them; missing ones are derived from
    positions, and missing sizes (m) are the usual ones. ``standing``: it is at its first position
    all the time. ``lamps``: for each known lamp, whether it is lit at each time. Raises RulecError
    R0617 with all mistakes.
    """
    name = str(identifier)
    checks = BuildingChecks(f"participant `{name:.40}`")
    if not name:
        checks.wrong("its id is empty")
    checks.one_of("kind", kind, OBSTACLE_TYPES)
    step_s = checks.positive("step_s", step_s, "s")
    times = checks.numbers("t", t)
    count = len(times)
    if not count:
        checks.wrong("it has no states", "expected one time or more")
    places = np.column_stack((checks.numbers("x", x, count), checks.numbers("y", y, count)))
    given = {"heading": heading, "speed": speed, "acceleration": acceleration}
    stated = {
        argument: checks.numbers(argument, values, count)
        for argument, values in given.items()
        if values is not None
    }
    usual = usual_size(kind)
    # Trains and buildings may be longer.
    is_vehicle = "vehicle" in OBSTACLE_TYPES.get(kind, ())
    longest_m = LONGEST_BODY_M if is_vehicle else LARGEST
    size = [
        checks.positive(argument, value, "m", longest_m) if value is not None else usual[at]
        for at, (argument, value) in enumerate((("length", length), ("width", width)))
    ]
    steps = _steps(checks, times, step_s)
    lit = _lit(checks, lamps or {}, steps)
    checks.raise_problems()
    derives = "heading" not in stated
    if derives:
        derived = motion.headings_of(places)
        stated["heading"] = np.zeros(count) if derived is None else derived
    turned = wrapped(stated["heading"])
    moved = motion.along(motion.velocities_of(places, step_s), turned)
    speeds = stated.get("speed", moved)
    gained = stated.get("acceleration", motion.accelerations_of(speeds, step_s))
    track = Track(steps, np.column_stack((places, turned, speeds, gained)), size[0], size[1])
    return tracked(
        name,
        kind,
        track,
        standing=standing,
        lamps=lit,
        shows=frozenset(lamps or ()),
        heads_as_it_moves=derives,
    )


def _steps(checks: BuildingChecks, times: NDArray[float64], step_s: float) -> NDArray[np.int64]:
    steps = np.round(times / step_s).astype(np.int64)
    off = np.abs(times - steps * step_s) > _OFF_STEP * step_s
    gaps = np.diff(steps) != 1
    if off.any():
        at = int(np.argmax(off))
        why = f"`t[{at}]` is {times[at]:g}, which is no whole number of steps of {step_s:g} s"
        checks.wrong(why, help_text="resample it to even steps")
    elif gaps.any():
        at = int(np.argmax(gaps))
        why = f"`t[{at + 1}]` is {times[at + 1]:g}, and `t[{at}]` {times[at]:g}"
        way_out = "build another participant for when it comes back"
        checks.wrong(why, f"expected one step of {step_s:g} s from each to the next", way_out)
    if len(steps) > MOST_STEPS:
        checks.wrong(f"it has {len(steps):,} states", f"expected {MOST_STEPS:,} at most")
    return steps


def _lit(
    checks: BuildingChecks, lamps: Mapping[Lamp, Sequence[bool]], steps: NDArray[np.int64]
) -> dict[int, frozenset[Lamp]]:
    for name, values in lamps.items():
        checks.one_of("lamps", name, get_args(Lamp))
        values = expected(f"lamps[{name!r}]", "Sequence[bool | float]", values)
        if len(values) != len(steps):
            checks.wrong(
                f"`lamps[{name!r}]` has {len(values):,} values", f"expected {len(steps):,}"
            )
            return {}
    if not lamps:
        return {}
    return {
        int(step): frozenset(name for name, values in lamps.items() if values[at])
        for at, step in enumerate(steps.tolist())
    }


@checked_kinds
def build_recording(
    lanelets: Iterable[Lanelet],
    participants: Iterable[Participant],
    *,
    step_s: float,
    name: str = "recording",
    side: Side | None = None,
    ego: str | int = "",
    country: str = "",
    complete: Collection[str] = (),
) -> Recording:
    """A recording of lanelets and participants, with a time step of ``step_s`` seconds.

    Predecessors are added from successors, and the reverse; likewise neighbours. ``side`` is the
    side of traffic, None if unknown; ``complete`` names kinds of things of which the recording has
    all, such as ``STOP`` for signs (``docs/recordings.md``). Raises RulecError R0617 with all
    mistakes: wrong shapes of arrays, invalid numbers, and ids that are duplicate or refer to
    nothing.
    """
    lanes, bodies = tuple(lanelets), tuple(participants)
    for part in (*lanes, *bodies):
        expected_fields(part)
    checks = BuildingChecks("the recording")
    step_s = checks.positive("step_s", step_s, "s")
    if side is not None:
        checks.one_of("side", side, get_args(Side))
    for kind in sorted(set(complete) - COMPLETE):
        checks.one_of("complete", kind, COMPLETE)
    for called, ids in (
        ("lanelets", [lane.id for lane in lanes]),
        ("participants", [participant.id for participant in bodies]),
    ):
        if not ids:
            checks.wrong(f"it has no {called}")
        twice = sorted({x for x in ids if ids.count(x) > 1}) if len(set(ids)) < len(ids) else []
        if twice:
            checks.wrong(f"there are two {called} {named(twice)}", help_text="give each its own id")
    known = {lane.id: lane for lane in lanes}
    for lanelet in lanes:
        _check_lanelet(lanelet, known, checks)
    for body in bodies:
        _check_participant(body, checks, step_s)
    if str(ego):
        checks.one_of("ego", str(ego), [participant.id for participant in bodies])
    checks.raise_problems()
    return Recording(
        name=name,
        step_s=step_s,
        lanelets=linked(known),
        participants=bodies,
        form="recording",
        side=side,
        country=country,
        complete=frozenset(complete),
        ego=str(ego),
    )


def _check_lanelet(lanelet: Lanelet, known: Mapping[str, Lanelet], to: BuildingChecks) -> None:
    checks = BuildingChecks(f"lanelet `{lanelet.id:.40}`")
    for side in ("left", "right", "centre"):
        checks.points(side, getattr(lanelet, side))
    for field, name in unknown_references(lanelet, known):
        why = f"`{field}` has `{name!s:.40}`, which is no lanelet of the recording"
        checks.wrong(why, help_text=did_you_mean(str(name), known))
    to.problems += checks.problems


def _check_speeds(checks: BuildingChecks, body: Participant, step_s: float) -> None:
    """Check that the speeds of one that drives fit its positions, one time step apart."""
    steps = sorted(body.states)
    pairs = [(body.states[k], body.states[k + 1]) for k in steps if k + 1 in body.states]
    stated = [(abs(a.speed) + abs(b.speed)) / 2 for a, b in pairs]
    driven = [float(np.hypot(b.x - a.x, b.y - a.y)) / step_s for a, b in pairs]
    if len(pairs) < _ENOUGH_PAIRS or min(np.median(stated), np.median(driven)) < _MOVES_MPS:
        return
    ratio = float(np.median(driven) / np.median(stated))
    if not 1 / _OTHER_STEP < ratio < _OTHER_STEP:
        checks.wrong(
            f"by its positions, {step_s:g} s apart, it drives {np.median(driven):.1f} m/s, and by "
            f"its speeds {np.median(stated):.1f} m/s",
            "expected the same",
            "give `build_participant` the time step of the recording, and speeds in m/s",
        )


def _check_participant(body: Participant, to: BuildingChecks, step_s: float) -> None:
    checks = BuildingChecks(f"participant `{body.id:.40}`")
    checks.one_of("type", body.type, OBSTACLE_TYPES)
    if not body.states:
        checks.wrong("it has no states")
    if missing := sorted(set(body.states) - set(body.outlines)):
        checks.wrong(f"it has no outline at step {missing[0]}")
    for step, state in body.states.items():
        expected(f"states[{step!r:.40}]", "TrackState", state)
        values = (state.x, state.y, state.heading, state.speed, state.acceleration)
        if not all(abs(value) < LARGEST for value in values):
            checks.wrong(f"at step {step} it is {state}", "expected finite numbers")
            break
    if not checks.problems:
        _check_speeds(checks, body, step_s)
    if body.standing and len(body.states) != 1:
        checks.wrong(f"it stands, and has {len(body.states):,} states", "expected one")
    to.problems += checks.problems
