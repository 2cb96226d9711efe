"""Reads SUMO's floating-car data (positions over time), and finds the files beside them.

A vehicle's ``x`` and ``y`` are the middle of its front bumper; its ``angle`` is in degrees
clockwise from the y axis, as on a compass. Passengers count as part of their vehicle and are left
out.
"""

from __future__ import annotations

from operator import itemgetter
from pathlib import Path, PurePosixPath

from rulec.diagnostics import RulecError, SourceLocation, named
from rulec.recordings.encodings.file_values import LARGEST, numbers_in, short
from rulec.recordings.encodings.safe_xml import scan
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.recording_messages import NET_MISSING
from rulec.recordings.sumo.fcd_content import (
    BODIES,
    FCD,
    LONGEST_ID,
    MICROSECONDS,
    NOWHERE,
    PLACE,
    SPEED,
    FcdHead,
    FcdTrack,
    FloatingCarData,
    fcd_head,
)

_place_of = itemgetter("id", *PLACE)


def read_fcd(path: Path) -> FloatingCarData:
    """The content of a file. Raises RulecError R0610 for another kind, R0701 if unreadable."""
    data = FloatingCarData()
    carriers = 0

    def comment(text: str) -> None:
        if not data.moments and "<" in text:
            data.head = fcd_head(text)

    def begin(element: Tree) -> None:
        nonlocal carriers
        if element.name in BODIES:
            carriers += 1
            if not data.moments:
                raise element.wrong(f"a `{element.name}` is in no `timestep`")
            if carriers == 1 and not element.attributes.get("vehicle"):
                _add(data, element)
        elif element.name == "timestep":
            moment = round(element.number("time") * MICROSECONDS)
            if data.moments and moment <= data.moments[-1]:
                raise element.wrong("its time steps are not in ascending order")
            data.moments.append(moment)

    def end(name: str) -> None:
        nonlocal carriers
        carriers -= name in BODIES

    scan(path, FCD, begin, end=end, comment=comment)
    return data


def _add(data: FloatingCarData, element: Tree) -> None:
    name, attributes = element.name, element.attributes
    try:
        key, *place = _place_of(attributes)
        motion = attributes.get(SPEED, "0"), attributes.get("acceleration", "nan")
        x, y, angle, speed, acceleration = numbers_in((*place, *motion))
    except (KeyError, ValueError):
        raise _wrong(element) from None
    if x == y == NOWHERE:
        return
    # Comparisons with NaN are false
    if not (
        -LARGEST < x < LARGEST
        and -LARGEST < y < LARGEST
        and -LARGEST < angle < LARGEST
        and -LARGEST < speed < LARGEST
    ):
        raise _wrong(element)
    track = data.tracks.get(key)
    if track is not None and track.element != name:
        # SUMO lets a person and a vehicle have the same id; here ids are unique
        key = f"{name} {key}"
        track = data.tracks.get(key)
    moment = len(data.moments) - 1
    if track is None:
        if not 0 < len(key) <= LONGEST_ID:
            raise element.wrong(f"the id of a `{name}` is empty, or longer than {LONGEST_ID}")
        track = data.tracks[key] = FcdTrack(name, attributes.get("type", ""))
    elif track.moments[-1] == moment:
        raise element.wrong(f"`{short(key)}` is twice in one time step")
    track.moments.append(moment)
    track.rows.extend((x, y, angle, speed if SPEED in attributes else float("nan")))
    track.accelerations.append(acceleration if abs(acceleration) < LARGEST else float("nan"))
    if "signals" in attributes:
        track.lamps[moment] = int(element.number("signals"))
    on = attributes.get("lane") or attributes.get("edge")
    if on and on not in data.on:
        kind = "lane" if attributes.get("lane") else "edge"
        data.on[on] = kind, element.place


def _wrong(element: Tree) -> RulecError:
    element.filled("id")
    for key in PLACE:
        element.number(key)
    for key in (SPEED, "acceleration"):
        element.number(key, 0.0)
    raise AssertionError("one of these is not a number")


def net_beside(path: Path, head: FcdHead) -> Path:
    """The net of floating-car data. Raises RulecError R0614 if it is missing or unclear."""
    written = named_beside(path, head.net) if head.net else None
    if written is not None:
        return written
    nets = [*path.parent.glob("*.net.xml"), *path.parent.glob("*.net.xml.gz")]
    if len(nets) == 1:
        return nets[0]
    if nets:
        why = f"there are several nets beside it: {named(sorted(net.name for net in nets))}"
    elif head.net:
        why = f"`{_name(head.net)}`, which it was made with, is not beside it"
    else:
        why = "there is no net beside it"
    raise NET_MISSING.error(
        SourceLocation(str(path)),
        f"SUMO's floating-car data do not say where the roads are, and {why}",
        help="name SUMO's net with --map FILE",
    )


def demand_beside(path: Path, head: FcdHead) -> tuple[Path, ...]:
    """The files beside floating-car data that may describe the types of vehicles."""
    written = [file for name in head.demand if (file := named_beside(path, name)) is not None]
    if written:
        return tuple(written)
    only = [*path.parent.glob("*.rou.xml"), *path.parent.glob("*.rou.xml.gz")]
    return tuple(only) if len(only) == 1 else ()


def named_beside(path: Path, written: str) -> Path | None:
    """The file beside floating-car data that has the name in ``written``; None if it is missing."""
    # Only the file's name is used, so that no other folder can be read
    candidate = path.parent / _name(written)
    return candidate if candidate.is_file() else None


def _name(written: str) -> str:
    return PurePosixPath(written.replace("\\", "/").replace("\0", "")).name
