"""Accuracy of positions and speeds, by the source of a recording.

Within these of its threshold a word is unknown, and a number is an interval. Errors that have
nothing to do with each other add up as squares (JCGM 100:2008, 5.1.2).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.extraction.recording_parts import whole_recording
from rulec.extraction.traffic_thresholds import USUAL, Thresholds
from rulec.recordings.recording import Recording, Rounding, StatedError, WholeRecording

Floats: TypeAlias = NDArray[float64]


@dataclass(frozen=True, slots=True)
class Tolerances:
    """How far the distance of two places (m) and speeds (m/s) may be wrong.

    Speeds are means over a second: what is wrong with a track for longer does not show in them.
    Over a shorter time they are known less well, by as much as it is shorter. ``stated_mps`` is the
    tolerance of the file's own speeds, None if these do not count. ``add_up``: a user states
    bounds, which errors may reach all at once, as those of tracks that drift do.
    """

    place_m: float
    speed_mps: float
    stated_mps: float | None = None
    add_up: bool = False

    def joint(self, one: Floats | float, other: Floats | float) -> Floats:
        """How far a sum may be wrong by two errors that have nothing to do with each other."""
        if self.add_up:
            return np.add(one, other)
        # What hypot does beyond this, for numbers near the largest, takes ten times as long
        found: Floats = np.sqrt(np.square(one) + np.square(other))
        return found


NGSIM = Tolerances(0.3, 0.3)
"""Vehicles tracked in video from high buildings.

Places as far as tracks agree with each other. Of means over a second 95 in 100 differ from the
slope of a smooth curve, the cubic that fits two seconds best, by less than 0.16 m/s (US101, 3,188
means), 0.17 m/s (Lankershim, 1,222), 0.32 m/s (Peachtree, 325).
"""

OTHERS = Tolerances(0.05, 0.1)
"""Files made by hand or from simulations."""

DRONES = Tolerances(0.14, 0.14)
"""Vehicles tracked in video from drones.

The makers of highD state an error of less than 0.1 m (Krajewski, Bock, Kloeker, Eckstein: The highD
dataset, ITSC 2018), which two places have, and both ends of a mean over a second.
"""

AUTO_LABELS = Tolerances(0.2, 0.1)
"""Waymo's motion data: boxes that a network has fitted to lidar, on lanes given by their middles.

Of the places on two coordinates 95 in 100 differ from the cubic that fits two seconds best by less
than 0.034 m, of boxes' half lengths from their median by less than 0.064 m (two scenarios, 13,000
states; a distance is of two of each), of means over a second from the cubic's slope by less than
0.064 m/s (624 means). Bounds of lanes, where no line is drawn, are known less well.
"""

KEYFRAMES = Tolerances(0.3, 0.2)
"""Boxes that people have drawn twice a second, and places in between on straight lines.

As above, of five scenes of nuScenes: 0.12 m, and 0.09 m/s (1,142 means); boxes have one size each.
"""

USUAL_ROUNDING = Rounding(0.01, 0.01)
"""SUMO writes two decimals."""

LIDAR = Tolerances(0.15, 0.1)
"""Boxes around lidar points, as annotated by hand in Argoverse 2's sensor logs.

Where a body ends is known to a step of the lidar, 0.2° (Velodyne VLP-32C), which is 0.1 m at 30 m,
and by as much where another one does. Of means over a second 95 in 100 differ from the slope of a
smooth curve, as above, by less than 0.06 m/s (1,666 means of 48 vehicles).
"""

TRACKER = Tolerances(0.2, 0.2)
"""Tracks of a car's own perception, as in Argoverse 2's motion forecasting.

Places differ from that curve by less than 0.2 m in 99 of 100 states, and means over a second from
its slope by less than 0.2 m/s in 95 of 100 (228 means).
"""

BY_FORM: Mapping[str, Tolerances] = MappingProxyType(
    {
        "NGSIM tracks": NGSIM,
        **dict.fromkeys(("highD tracks", "levelX tracks", "INTERACTION tracks"), DRONES),
        "Waymo scenario": AUTO_LABELS,
        "Argoverse 2 motion forecasting": TRACKER,
        "Argoverse 2 sensor log": LIDAR,
        "123D log of Argoverse 2": LIDAR,
        "123D log of Waymo": AUTO_LABELS,
        # The least exact of its data sets counts for those of which it is not known
        "123D log": KEYFRAMES,
        "ScenarioNet scenario": KEYFRAMES,
        "ScenarioNet scenario of Waymo": AUTO_LABELS,
    }
)
_DIAGONAL = 2**0.5
_MOST_SIGMAS = 4.0
"""Three in 100,000 errors are larger, to one side, than so many standard deviations.

A drive has hundreds of states, each with errors of its own, of which one is enough to be accused:
with three standard deviations it would be one in three of the drives that are just at a limit.
"""
_NGSIM = re.compile(r"USA_(US101|I80|Lanker|Peach)")


def tolerances_of(
    recording: Recording, limits: Thresholds = USUAL, whole: WholeRecording | None = None
) -> Tolerances:
    """The tolerances of a recording, by its form, by where it was made, and by what it says.

    And by the noise that its tracks have, or what a user says of them, if that is more. ``whole``
    is what ``whole_recording`` says of it, if that is known already.
    """
    whole = whole or whole_recording(recording)
    if recording.form == "SUMO data":
        known = rounded_to(recording.rounding or USUAL_ROUNDING)
    else:
        known = NGSIM if _NGSIM.match(recording.name) else BY_FORM.get(recording.form, OTHERS)
    # Of two places, which distances have, and both ends of a mean over a second
    noise = _MOST_SIGMAS * _DIAGONAL * whole.noise_m
    stated = whole.stated_error or StatedError(0.0, 0.0)
    own = known.stated_mps
    # Both of two places may be anywhere in their areas, all of which outlines cover
    return Tolerances(
        place_m=max(known.place_m, noise, 2 * stated.place_m, 2 * limits.place_error_m),
        speed_mps=max(known.speed_mps, noise, stated.speed_mps, limits.speed_error_mps),
        stated_mps=None if own is None else max(own, limits.speed_error_mps),
        add_up=bool(limits.place_error_m or limits.speed_error_mps),
    )


def rounded_to(rounding: Rounding) -> Tolerances:
    """The tolerances of what is exact but for rounding.

    Each of two places may be wrong by half a unit along both axes, and so may a way between them.
    """
    place_m = _DIAGONAL * rounding.place_m
    return Tolerances(place_m, place_m, rounding.speed_mps / 2)
