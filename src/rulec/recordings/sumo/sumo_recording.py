"""Reads SUMO's floating-car data and their companion files as one recording."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import pairwise
from math import gcd
from pathlib import Path

import numpy as np
from numpy import float64, int64, intp
from numpy.typing import NDArray

from rulec.diagnostics import SourceLocation, first_of
from rulec.recordings.encodings.file_values import short
from rulec.recordings.mending.derived_motion import velocities_of
from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import (
    MOST_STEPS,
    SPARSEST,
    Lamp,
    Lanelet,
    Participant,
    Recording,
    Rounding,
)
from rulec.recordings.recording_messages import OTHER_NET
from rulec.recordings.road_map import RoadMap
from rulec.recordings.sumo.fcd import demand_beside, net_beside, read_fcd
from rulec.recordings.sumo.fcd_content import FCD, MICROSECONDS, FcdTrack, FloatingCarData
from rulec.recordings.sumo.fcd_holes import FcdGrid, FcdHoles, holes_of_rows, starts_of
from rulec.recordings.sumo.lanelets import net_lanelets
from rulec.recordings.sumo.light_states import (
    light_states_beside,
    programmes_beside,
    read_light_states,
)
from rulec.recordings.sumo.net import SumoNet, read_net
from rulec.recordings.sumo.vehicle_types import VehicleType, read_vehicle_types, vehicle_type
from rulec.recordings.track import Track, tracked
from rulec.recordings.tracks.even_times import unit_of

ON_NETS = frozenset({"STOP", "YIELD", "PRIORITY", "GREEN_ARROW", "light", "rail", "roundabout"})
ON_NETS |= {"lanes", "junctions"}
"""A net contains every lane, junction, sign, light and rail track."""

COMPLETE = ON_NETS | {"officer", "arrivals"}
"""What data and net contain completely: SUMO has no police officers at all.

A participant who disappears from the data has arrived at its destination.
"""

_TRAFFIC = frozenset({"arrivals"})

NEAR_M = 1000.0
"""No participant in the data is farther than this from the net."""

_NAMED = 5

_LAMPS: tuple[tuple[int, frozenset[Lamp]], ...] = (
    (1, frozenset({"right_indicator"})),
    (2, frozenset({"left_indicator"})),
    (4, frozenset({"hazard_lights"})),
    (8, frozenset({"brake_light"})),
    (512, frozenset({"doors", "left_doors"})),
    (1024, frozenset({"doors", "right_doors"})),
    (2048 | 4096, frozenset({"blue_light"})),
)
"""Bits of SUMO's ``signals`` -> lamps; only those that others can see and that rules use."""


def read_sumo(path: Path, net_path: Path | None = None) -> Recording:
    """Read floating-car data with a net: the one given, or the one beside the data.

    Raises RulecError R0610 for a file of another kind than expected, R0614 if there is no net,
    R0615 for the net of another road, R0701 if a file cannot be opened.
    """
    data = read_fcd(path)
    if data.head.geographic:
        why = "its positions are geographic, in degrees of longitude and latitude"
        raise FCD.refused(path, why, help_text="have SUMO write them without --fcd-output.geo")
    if not data.tracks:
        raise FCD.refused(path, "it contains no road users")
    net_path = net_beside(path, data.head) if net_path is None else net_path
    net = read_net(net_path)
    _check_places(path, data, net_path, net)
    step_s = time_step(path, data.moments)
    types = read_vehicle_types(demand_beside(path, data.head))
    unknown: set[str] = set()
    rounding = _rounding(data)  # before ``_participants`` frees the tracks
    holes = FcdHoles()
    participants = tuple(_participants(data, types, step_s, unknown, holes))
    replaced = programmes_beside(path, data.head)
    # A missing file may replace the programme of any light
    replaced = dict.fromkeys(net.programmes) if replaced is None else replaced
    net.programmes.update({name: [programme] for name, programme in replaced.items()})
    for file in light_states_beside(path, data.head):
        shown = read_light_states(file).items()
        net.programmes.update({name: [programme] for name, programme in shown})
    start_s = data.moments[0] % round(step_s * MICROSECONDS) / MICROSECONDS
    net.begin_later(-start_s)
    lanelets = net_lanelets(net, step_s)
    _check_near(path, participants, lanelets.values())
    return Recording(
        name=path.name.split(".")[0] or path.name,
        step_s=step_s,
        lanelets=lanelets,
        participants=participants,
        form="SUMO data",
        side=net.side,
        remarks=(
            *_remarks(unknown, net),
            *_left_out(data),
            *holes.remarks(),
            *_start(start_s),
        ),
        complete=COMPLETE - _TRAFFIC if data.head.leaves_out or holes.missing else COMPLETE,
        rounding=rounding,
    )


def read_sumo_map(path: Path, step_s: float) -> RoadMap:
    """The roads of a net, for recordings not made by SUMO. Raises RulecError R0610, R0701."""
    net = read_net(path)
    return RoadMap(
        form="SUMO net",
        lanelets=net_lanelets(net, step_s),
        side=net.side,
        complete=ON_NETS,
        remarks=tuple(_remarks((), net)),
    )


_MOST_DECIMALS = 6
_MANY = 100
"""With fewer numbers, it may be chance that none has a second decimal, which SUMO writes."""


def _rounding(data: FloatingCarData) -> Rounding:
    """The rounding of positions and speeds: the fewest decimals that hold all of them."""
    tracks = [np.frombuffer(track.rows).reshape(-1, 4) for track in data.tracks.values()]
    speeds = [rows[:, 3] for rows in tracks]
    places = [rows[:, :2] for rows in tracks]
    unit_m, unit_mps = (
        unit_of(own, 0 if sum(map(np.size, own)) >= _MANY else 2, _MOST_DECIMALS)
        for own in (places, speeds)
    )
    return Rounding(unit_m, None if any(map(_has_unknown, speeds)) else unit_mps)


def _has_unknown(numbers: NDArray[float64]) -> bool:
    return bool(np.isnan(numbers).any())


def _participants(
    data: FloatingCarData,
    types: dict[str, VehicleType],
    step_s: float,
    unknown: set[str],
    holes: FcdHoles,
) -> Iterator[Participant]:
    """All participants; each track is freed once its participants are made."""
    step = round(step_s * MICROSECONDS)
    grid = FcdGrid([moment // step for moment in data.moments], step_s)
    for key in list(data.tracks):
        track = data.tracks.pop(key)
        kind, known = vehicle_type(track.type, track.element, types)
        if not known:
            unknown.add(f"`{short(track.type)}` ({kind.kind}, {kind.length:g} m)")
        yield from fcd_participants(key, track, kind, grid, holes)


def _remarks(unknown: Iterable[str], net: SumoNet) -> Iterator[str]:
    guessed = sorted(unknown)
    if guessed:
        yield f"types that no file describes get default values: {first_of(guessed, _NAMED)}"
    lights = [f"`{short(name)}`" for name in net.unknown_lights()]
    if lights:
        yield f"the programmes of these traffic lights are unknown: {first_of(lights, _NAMED)}"


def _left_out(data: FloatingCarData) -> Iterator[str]:
    if data.head.leaves_out:
        options = first_of([f"--{name}" for name in data.head.leaves_out], _NAMED)
        yield f"only part of the traffic is recorded, because of {options}: the rest is unknown"


def _start(start_s: float) -> Iterator[str]:
    if start_s:
        yield f"times count from {start_s:g} s, as SUMO's steps do not begin at a multiple of them"


def _check_places(path: Path, data: FloatingCarData, net_path: Path, net: SumoNet) -> None:
    for name, (kind, line) in data.on.items():
        if name not in (net.lanes if kind == "lane" else net.edges):
            raise OTHER_NET.error(
                SourceLocation(str(path), line),
                f"a participant is on {kind} `{short(name)}`, which the net {net_path.name} lacks",
                help="use --map to give the net that the data were made with",
            )


def _check_near(
    path: Path, participants: Iterable[Participant], lanelets: Iterable[Lanelet]
) -> None:
    roads = np.concatenate([lanelet.centre for lanelet in lanelets])
    low, high = roads.min(axis=0) - NEAR_M, roads.max(axis=0) + NEAR_M
    for participant in participants:
        state = participant.states[next(iter(participant.states))]
        place = np.array([state.x, state.y])
        if (place < low).any() or (place > high).any():
            raise OTHER_NET.error(
                SourceLocation(str(path)),
                f"`{short(participant.id)}` is at x = {state.x:g}, y = {state.y:g}, far from all "
                "roads of the net",
                help="have SUMO write positions in the net's own metres, without "
                "--fcd-output.geo and --fcd-output.utm",
            )


def time_step(path: Path, moments: list[int]) -> float:
    """The time step (s): the shortest time between two moments of the file.

    Moments may be missing, as when there is no traffic, but none may lie between two steps. The
    first may lie between two multiples of the step, as with SUMO's --begin. For a single moment it
    is the longest step of which both a second and its time are multiples. Raises RulecError R0610
    for moments that are too far apart, or uneven.
    """
    if len(moments) < 2:
        return gcd(MICROSECONDS, *moments) / MICROSECONDS
    step = min(after - before for before, after in pairwise(moments))
    off = next((moment for moment in moments if (moment - moments[0]) % step), None)
    if off is not None:
        why = (
            f"its times are uneven: from {moments[0] / MICROSECONDS:g} s to "
            f"{off / MICROSECONDS:g} s is not a multiple of {step / MICROSECONDS:g} s, the "
            "shortest time from one to the next"
        )
        way_out = "have SUMO write every step, or every n-th one (--device.fcd.period)"
        raise FCD.refused(path, why, help_text=way_out)
    spread = (moments[-1] - moments[0]) // step
    if spread > min(MOST_STEPS, SPARSEST * len(moments)):
        why = (
            f"its {len(moments)} time steps of {step / MICROSECONDS:g} s are spread over "
            f"{(moments[-1] - moments[0]) / MICROSECONDS:g} s"
        )
        raise FCD.refused(path, why, help_text="look for a time that is wrong, or take a part")
    return step / MICROSECONDS


def fcd_participants(
    key: str, track_rows: FcdTrack, kind: VehicleType, grid: FcdGrid, holes: FcdHoles
) -> Iterator[Participant]:
    """The participants of a track; one that is away for long, or jumps meanwhile, becomes another.

    ``holes`` counts what was found of vehicles.
    """
    steps, step_s = grid
    count = len(track_rows.moments)
    own = np.fromiter(map(steps.__getitem__, track_rows.moments), dtype=int64, count=count)
    rows = np.array(track_rows.rows, dtype=float).reshape(-1, 4)
    if _has_unknown(rows[:, 3]):
        _fill_in_speeds(rows, own, step_s)
    is_vehicle = track_rows.element == "vehicle"
    found = holes_of_rows(own, rows, step_s)
    if found is not None and is_vehicle:
        holes.note(key, found, rows[:, 3])
    starts = starts_of(found)
    if is_vehicle:
        rows[:, 2] = _steered(rows, starts)
    rows = (
        _centres_along_way(rows, starts, kind.length, np.diff(own) * step_s)
        if is_vehicle and kind.articulated
        else _centres(rows, kind.length)
    )
    rows = np.column_stack((rows, _accelerations(track_rows, rows[:, 3], own, step_s)))
    # All tracks share these step objects, to save memory
    lamps = {steps[moment]: _lit(bits) for moment, bits in track_rows.lamps.items()}
    for number, (start, end) in enumerate(zip(starts, [*starts[1:], len(own)], strict=True), 1):
        track = Track(own[start:end], rows[start:end], kind.length, kind.width)
        name = key if number == 1 else f"{key}_{number}"
        first, last = int(own[start]), int(own[end - 1])
        yield tracked(
            name,
            kind.kind,
            track,
            lamps={step: lit for step, lit in lamps.items() if first <= step <= last},
            shows=_SHOWN if lamps else frozenset(),
            resumes=None if number == 1 else int(own[start - 1]),
        )


def _fill_in_speeds(rows: NDArray[float64], steps: NDArray[int64], step_s: float) -> None:
    """Fill in unknown speeds (m/s), from places one step apart."""
    runs = np.split(np.arange(len(rows)), (np.diff(steps) > 1).nonzero()[0] + 1)
    driven = [np.hypot(*velocities_of(rows[run, :2], step_s).T) for run in runs]
    rows[:, 3] = np.where(np.isnan(rows[:, 3]), np.concatenate(driven), rows[:, 3])


def _steered(rows: NDArray[float64], starts: NDArray[intp]) -> NDArray[float64]:
    """The angles (degrees) of a vehicle; while it stands, it keeps its last one.

    SUMO turns a vehicle that has to stop while changing lanes, and moves it sideways. ``starts``
    are the rows at which the vehicle appears.
    """
    moves = rows[:, 3] != 0.0
    moves[starts] = True
    last = np.maximum.accumulate(np.where(moves, np.arange(len(rows)), 0))
    angles: NDArray[float64] = rows[last, 2]
    return angles


def _centres_along_way(
    rows: NDArray[float64], starts: NDArray[intp], length: float, times: NDArray[float64]
) -> NDArray[float64]:
    """The rows of an articulated vehicle: x, y of its middle, heading (rad), and speed.

    The angle in the data is that of the first part. Here the middle and the rear are where the
    front was half a length and a length earlier on its way, and the heading points from the rear to
    the front. A straight way leads to the first position. A movement more across the heading than
    along it that is longer than the speed permits is a lane change by a jump, or sliding: it moves
    all parts. So does any movement while it stands, and no movement is longer on the way than the
    speed permits: noise of positions would add up to a way that was never driven. ``times`` (s)
    lead from each row to the next.
    """
    centred: NDArray[float64] = rows.copy()
    for start, end in zip(starts, [*starts[1:], len(rows)], strict=True):
        x, y, angle, speed = rows[start:end].T
        heading = np.pi / 2 - np.radians(angle)
        drives = _JUMPS * times[start : end - 1] * np.maximum(speed[1:], speed[:-1])
        ways = np.stack((np.diff(x), np.diff(y)), axis=1)
        cos, sin = np.cos(heading[1:]), np.sin(heading[1:])
        along, across = ways[:, 0] * cos + ways[:, 1] * sin, ways[:, 1] * cos - ways[:, 0] * sin
        # The first part turns late where the vehicle turns round at the end of a road
        shifts = (np.abs(across) > np.abs(along)) & (np.hypot(along, across) > drives)
        ways[shifts | (drives == 0.0)] = 0.0
        behind = 2 * length * np.array([[np.cos(heading[0]), np.sin(heading[0])]])
        lengths = np.append(2 * length, np.minimum(np.hypot(*ways.T), drives))
        ways = np.concatenate((behind, ways))
        driven = np.append(0.0, lengths.cumsum())
        places = np.concatenate((np.zeros((1, 2)), ways.cumsum(axis=0)))
        middle, rear = (
            places[1:]
            - np.stack([np.interp(driven[1:] - back, driven, axis) for axis in places.T], 1)
            for back in (length / 2, length)
        )
        centred[start:end, :2] -= middle
        centred[start:end, 2] = np.arctan2(rear[:, 1], rear[:, 0])
    return centred


def _centres(rows: NDArray[float64], length: float) -> NDArray[float64]:
    heading = wrapped(np.pi / 2 - np.radians(rows[:, 2]))
    x = rows[:, 0] - length / 2 * np.cos(heading)
    y = rows[:, 1] - length / 2 * np.sin(heading)
    return np.column_stack((x, y, heading, rows[:, 3]))


def _accelerations(
    track_rows: FcdTrack, speeds: NDArray[float64], steps: NDArray[int64], step_s: float
) -> NDArray[float64]:
    """The accelerations (m/s²): those in the data, or else from the speed at the last step."""
    stated = np.array(track_rows.accelerations, dtype=float)
    changes = np.diff(speeds, prepend=speeds[0]) / (np.diff(steps, prepend=steps[0] - 1) * step_s)
    return np.where(np.isnan(stated), changes, stated)


_JUMPS = 1.25
"""A vehicle that moves farther than this multiple of its speed's distance was placed there."""

_SHOWN = frozenset(lamp for _, lamps in _LAMPS for lamp in lamps)


@lru_cache(maxsize=1 << 10)
def _lit(bits: int) -> frozenset[Lamp]:
    # Most states of all vehicles share a few of these sets
    return frozenset(lamp for bit, lamps in _LAMPS if bits & bit for lamp in lamps)
