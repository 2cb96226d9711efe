"""The rows of any table of tracks, how bodies move by them, and what is wrong in them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy import int64, intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.encodings.file_values import LARGEST
from rulec.recordings.encodings.table_columns import Columns, Texts
from rulec.recordings.polylines import noise_by_thirds, wrapped
from rulec.recordings.recording import Lamp
from rulec.recordings.tracks.even_times import EvenTimes

MOVING_MPS = 2.0

_SAMPLE = 10_000


class Motions(NamedTuple):
    """Velocities (m/s) of bodies, and the row in the middle of the time of each."""

    middle: NDArray[intp]
    dx: Floats
    dy: Floats


class PlacesOfRows(NamedTuple):
    """The rows of a table: the code of each one's track, its time and place (m)."""

    codes: NDArray[int64]
    times: EvenTimes
    x: Floats
    y: Floats


def motions_of(rows: PlacesOfRows, noises: float) -> Motions:
    """The velocities from each row of a track to the next, or if places are noisy to a later one.

    A body at ``MOVING_MPS`` gets by ``noises`` times the noise there. No velocity is one across
    missing rows.
    """
    codes, times, x, y = rows
    order = np.lexsort((times.steps, codes))
    own, steps, x, y = codes[order], times.steps[order], x[order], y[order]
    window = max(1, ceil(noises * _noise(own, steps, x, y) / MOVING_MPS / times.step_s))
    begin, end = slice(None, -window), slice(window, None)
    on = (own[begin] == own[end]) & (steps[end] - steps[begin] == window)
    first = on.nonzero()[0]
    took = window * times.step_s
    dx, dy = ((place[first + window] - place[first]) / took for place in (x, y))
    return Motions(order[first + window // 2], dx, dy)


def _noise(codes: NDArray[int64], steps: NDArray[int64], x: Floats, y: Floats) -> float:
    """The noise (m) of the places of rows by track and time, from some of them."""
    first = np.arange(0, len(codes) - 3, max(1, len(codes) // _SAMPLE))
    on = (codes[first] == codes[first + 3]) & (steps[first + 3] - steps[first] == 3)
    first = first[on]
    thirds = [own[first + 3] - own[first] - 3 * (own[first + 2] - own[first + 1]) for own in (x, y)]
    return noise_by_thirds(np.concatenate(thirds))


LONGEST_BODY_M = 100.0
_TURNED = np.pi / 4
_ALIKE = 1.25
_ENOUGH = 20
_NOISES_OF_DIRECTION, _NOISES_OF_SPEED = 8.0, 20.0
"""How far (in the noise of places) bodies move while their direction or speed is measured.

No body that stands seems to move in so long a time, none that moves seems faster by 1.25.
"""

_UNITS = ((3.6, "`speed_kmh` if it holds km/h"), (2.237, "`speed_mph` if it holds miles an hour"))
_BOUNDED = ("x", "y", "heading", "speed", "acceleration", "length", "width")


@dataclass(frozen=True, kw_only=True, eq=False)
class TrackRows:
    """Tracks as arrays with one value per row, in the map's frame (m, rad, m/s, m/s²).

    NaN means that the table has no value; None that it has no such column. ``columns`` know the
    rows' places in the table. ``front``: x and y are the middle of the front, not of the body.
    Unsigned speeds are taken to follow the track. ``lamps``: 1 if lit, 0 if not.
    """

    columns: Columns
    track: Texts
    times: EvenTimes
    x: Floats
    y: Floats
    heading: Floats | None = None
    speed: Floats | None = None
    velocity: tuple[Floats, Floats] | None = None
    acceleration: Floats | None = None
    type: Texts | None = None
    length: Floats | None = None
    width: Floats | None = None
    standing: Floats | None = None
    ego: Floats | None = None
    front: bool = False
    lamps: Mapping[Lamp, Floats] = field(default_factory=dict)


def check_rows(rows: TrackRows) -> None:
    """Check that values are within bounds, and headings fit the motion. Raises RulecError."""
    for name in _BOUNDED:
        values = getattr(rows, name)
        if values is None:
            continue
        largest = LONGEST_BODY_M if name in ("length", "width") else LARGEST
        low = 0.0 if name in ("length", "width") else -LARGEST
        bad = ~((values >= low) & (values < largest)) & ~np.isnan(values)
        if bad.any():
            row = int(np.argmax(bad))
            why = f"its `{name}` is {values[row]:g}"
            expected = f"expected a number from {low:g} to {largest:g}"
            metres = f"`{name}` is in metres" if name in ("length", "width") else ""
            raise rows.columns.wrong(row, why, expected, metres)
    for name, values in (("ego", rows.ego), ("standing", rows.standing), *rows.lamps.items()):
        if values is None:
            continue
        bad = ~np.isnan(values) & (values != 0) & (values != 1)
        if bad.any():
            row = int(np.argmax(bad))
            raise rows.columns.wrong(row, f"its `{name}` is {values[row]:g}", "expected 0 or 1")
    if rows.heading is not None:
        _check_headings(rows)


def _check_headings(rows: TrackRows) -> None:
    """Refuse headings that are not in radians, or contradict the motion of most participants."""
    heading = rows.heading
    assert heading is not None
    large = np.abs(heading) > 2 * np.pi + 0.01
    if large.any():
        row = int(np.argmax(large))
        why = f"its heading is {heading[row]:g}, which is no angle in radians"
        way_out = "call the column `heading_deg` if it holds degrees"
        raise rows.columns.wrong(row, why, help_text=way_out)
    found = motions_of(_places(rows), _NOISES_OF_DIRECTION)
    own = heading[found.middle]
    moving = (np.hypot(found.dx, found.dy) > MOVING_MPS) & ~np.isnan(own)
    # Who backs, by its own speeds, goes the other way
    backs = 0.0 if rows.speed is None else np.pi * (rows.speed[found.middle] < 0)
    turned = np.arctan2(found.dy, found.dx) - own
    off = np.abs(wrapped(turned - backs))[moving]
    if len(off) > _ENOUGH and np.median(off) > _TURNED:
        row = int(found.middle[moving][int(np.argmax(off))])
        if np.median(np.abs(wrapped(turned))[moving]) <= _TURNED:
            why = "most who move have a negative speed, and do not move backwards by their headings"
            way_out = "leave out the sign: only who drives backwards has a negative speed"
            raise rows.columns.wrong(row, why, help_text=way_out)
        why = (
            f"headings do not fit the motion: most of those who move are turned by more than 45° "
            f"away from where they go, {np.degrees(np.median(off)):.0f}° in the median"
        )
        way_out = (
            "headings are counter-clockwise from the x axis, y points to the left of x; those of a "
            "compass are 90° minus that. Without the column they are taken from places"
        )
        raise rows.columns.wrong(row, why, help_text=way_out)


def speeds_that_differ(rows: TrackRows) -> Iterator[str]:
    """Remarks on speeds that differ from those of positions by a factor; they are not used."""
    if rows.speed is None or rows.front:
        return
    found = motions_of(_places(rows), _NOISES_OF_SPEED)
    moved, stated = np.hypot(found.dx, found.dy), np.abs(rows.speed[found.middle])
    chosen = moved + stated > 2 * MOVING_MPS
    if chosen.sum() < _ENOUGH:
        return
    by_places, by_column = float(np.median(moved[chosen])), float(np.median(stated[chosen]))
    if by_places < 1e-3 or not by_column or 1 / _ALIKE <= by_column / by_places <= _ALIKE:
        return
    factor = by_column / by_places
    near = (name for times, name in _UNITS if abs(factor / times - 1) < 0.05)
    unit = next(near, "")
    yield (
        f"speeds are {factor:.3g} times what places and times say, by which it is judged: "
        + (f"call the column {unit}" if unit else "look at the units of `speed`, times and places")
    )


def _places(rows: TrackRows) -> PlacesOfRows:
    return PlacesOfRows(rows.track.codes, rows.times, rows.x, rows.y)
