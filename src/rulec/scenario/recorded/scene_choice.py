"""The choice of ego, time, road and prediction in a recorded scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Literal, get_args

Prediction = Literal["recorded", "constant"]
PREDICTIONS: tuple[Prediction, ...] = get_args(Prediction)

CONGESTED_BELOW_KMH = 30.0
"""Traffic is taken to be congested where the middle one of its vehicles is slower than this."""


@dataclass(frozen=True, slots=True)
class Choice:
    """A choice of ego, time, road and prediction.

    ``ego``: a planning problem or a participant; None is the first planning problem. ``at_s``: the
    time of the file that becomes time 0; None is the planning problem's, the participant's first.
    ``reference``: the lanelet whose centre line is the reference line; None is the one ego is on.
    ``prediction``: others move as recorded, or from time 0 on with constant acceleration; or each
    of them does the one or the other, with these probabilities. Traffic
    is ``congested`` below a median speed. ``ego_width_m``: None is what the participant has whose
    part ego takes, if it takes one's; else ego is a point. ``net`` is the file with the roads, for
    formats that keep them apart. Ids are those of the file; numbers will do.
    """

    ego: str | int | None = None
    at_s: float | None = None
    reference: str | int | None = None
    prediction: Prediction | Mapping[Prediction, Fraction] = "recorded"
    congested_below_kmh: float = CONGESTED_BELOW_KMH
    net: Path | None = None
    ego_width_m: float | None = None
