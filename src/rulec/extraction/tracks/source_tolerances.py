"""Accuracy of positions and speeds, by the source of a recording.

Where a number is within its tolerance of a threshold, the word is unknown; the number itself is an
interval. Independent errors add up as squares (JCGM 100:2008, 5.1.2).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from rulec.array_types import Floats
from rulec.extraction.recording_parts import whole_recording
from rulec.extraction.traffic_thresholds import USUAL, Thresholds
from rulec.recordings.recording import Recording, Rounding, StatedError, WholeRecording


@dataclass(frozen=True, slots=True)
class Tolerances:
    """The possible errors of the distance between two places (m) and of speeds (m/s).

    Speeds are means over a second; track errors that last longer do not show in them. Over a
    shorter time the error is larger in proportion. ``stated_mps`` is the tolerance of the file's
    own speeds, None if these are not used. ``add_up``: a user states bounds, which errors may all
    reach at once, as the errors of drifting tracks do.
    """

    place_m: float
    speed_mps: float
    stated_mps: float | None = None
    add_up: bool = False

    def joint(self, one: Floats | float, other: Floats | float) -> Floats:
        """The possible error of a sum of two values with independent errors."""
        if self.add_up:
            return np.add(one, other)
        # The extra work of hypot, for numbers near the largest, takes ten times as long
        found: Floats = np.sqrt(np.square(one) + np.square(other))
        return found


NGSIM = Tolerances(0.3, 0.3)
"""Vehicles tracked in video from high buildings.

Places are as accurate as tracks agree with each other. Of means over a second, 95 in 100 differ
from the slope of a smooth curve, the cubic that best fits two seconds, by less than 0.16 m/s
(US101, 3,188 means), 0.17 m/s (Lankershim, 1,222), 0.32 m/s (Peachtree, 325).
"""

OTHERS = Tolerances(0.05, 0.1)
"""Files made by hand or by simulation."""

DRONES = Tolerances(0.14, 0.14)
"""Vehicles tracked in video from drones.

The makers of highD state an error of less than 0.1 m (Krajewski, Bock, Kloeker, Eckstein: The highD
dataset, ITSC 2018); it applies to each of two places, and to both ends of a mean over a second.
"""

AUTO_LABELS = Tolerances(0.2, 0.1)
"""Waymo's motion data: boxes that a network fitted to lidar, on lanes given by their middle lines.

On either coordinate, 95 in 100 places differ from the cubic that best fits two seconds by less than
0.034 m, and boxes' half lengths from their median by less than 0.064 m (two scenarios, 13,000
states; a distance involves two of each); means over a second differ from the cubic's slope by less
than 0.064 m/s (624 means). Lane bounds without a drawn line are known less well.
"""

KEYFRAMES = Tolerances(0.3, 0.2)
"""Boxes that people drew twice a second, with places in between interpolated linearly.

As above, from five scenes of nuScenes: 0.12 m, and 0.09 m/s (1,142 means); boxes keep their size.
"""

USUAL_ROUNDING = Rounding(0.01, 0.01)
"""SUMO writes two decimals."""

LIDAR = Tolerances(0.15, 0.1)
"""Boxes around lidar points, as annotated by hand in Argoverse 2's sensor logs.

The end of a body is known to within a step of the lidar, 0.2° (Velodyne VLP-32C), which is 0.1 m at
30 m, and so is that of the other body. Of means over a second, 95 in 100 differ from the slope of a
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
        # If the data set is unknown, its least accurate one counts
        "ScenarioNet scenario": KEYFRAMES,
        "ScenarioNet scenario of Waymo": AUTO_LABELS,
    }
)
_DIAGONAL = 2**0.5
MOST_SIGMAS = 4.0
"""One-sided, three in 100,000 errors exceed this many standard deviations.

A drive has hundreds of states with independent errors, and one of them is enough for a violation:
with three standard deviations, one in three of the drives exactly at a limit would be hit.
"""
_NGSIM = re.compile(r"USA_(US101|I80|Lanker|Peach)")


def tolerances_of(
    recording: Recording, limits: Thresholds = USUAL, whole: WholeRecording | None = None
) -> Tolerances:
    """The tolerances of a recording, from its format, its location and its own statements.

    At least as large as the noise of its tracks and the errors that a user states. ``whole`` is the
    result of ``whole_recording``, if already known.
    """
    whole = whole or whole_recording(recording)
    if recording.form == "SUMO data":
        known = rounded_to(recording.rounding or USUAL_ROUNDING)
    else:
        known = NGSIM if _NGSIM.match(recording.name) else BY_FORM.get(recording.form, OTHERS)
    # A distance involves two places, and a mean over a second both its ends
    noise = MOST_SIGMAS * _DIAGONAL * whole.noise_m
    stated = whole.stated_error or StatedError(0.0, 0.0)
    own = known.stated_mps
    # Both of two places may be anywhere in their areas, and outlines cover these
    return Tolerances(
        place_m=max(known.place_m, noise, 2 * stated.place_m, 2 * limits.place_error_m),
        speed_mps=max(known.speed_mps, noise, stated.speed_mps, limits.speed_error_mps),
        stated_mps=None if own is None else max(own, limits.speed_error_mps),
        add_up=bool(limits.place_error_m or limits.speed_error_mps),
    )


def rounded_to(rounding: Rounding) -> Tolerances:
    """The tolerances of data that are exact except for rounding.

    Each of two places, and a distance between them, may be off by half a unit along both axes.
    """
    place_m = _DIAGONAL * rounding.place_m
    speed_mps = rounding.speed_mps
    return Tolerances(place_m, place_m, None if speed_mps is None else speed_mps / 2)
