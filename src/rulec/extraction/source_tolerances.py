"""How well a source of recorded traffic knows places and speeds.

Within these of its threshold a word is unknown.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from rulec.scenario.recorded.recording import Recording


@dataclass(frozen=True, slots=True)
class Tolerances:
    """How far places (m) and speeds (m/s, means over a second) may be wrong."""

    place_m: float
    speed_mps: float

    @property
    def acceleration_mps2(self) -> float:
        """The same of accelerations, differences of two speeds a second apart."""
        return self.speed_mps


NGSIM = Tolerances(0.3, 0.5)
"""Vehicles tracked in video from high buildings, as far as their tracks agree with each other."""

SIMULATED = Tolerances(0.01, 0.01)
"""SUMO writes two decimals."""

OTHERS = Tolerances(0.05, 0.1)
"""Files made by hand or from simulations; the best video, from drones, is good to 0.1 m."""

_NGSIM = re.compile(r"USA_(US101|I80|Lanker|Peach)")


def tolerances_of(recording: Recording) -> Tolerances:
    """The tolerances of a recording, by its form and by where it was made."""
    if recording.form == "SUMO data":
        return SIMULATED
    return NGSIM if _NGSIM.match(recording.name) else OTHERS
