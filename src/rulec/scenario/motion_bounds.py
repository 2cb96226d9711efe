"""Bounds of ego's motion along and across the road, by type of vehicle.

Sources: speeds, accelerations and body sizes are those of CommonRoad's vehicle models 2 (BMW 320i),
3 (VW Vanagon) and 4 (a lorry), package commonroad-vehicle-models 3.0.2: Althoff, Koschi, Manzinger,
"CommonRoad: Composable benchmarks for motion planning on roads", IV 2017; 11.5 m/s² is the limit of
the tyres. The limits of the engine and of motion across the road are the default settings of
commonroad-reach 2025.2.1. A bus has the lorry's bounds; motorcycles and bicycles have the body
sizes and speeds of SUMO's vehicle types of these names.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from math import isfinite
from types import MappingProxyType

from rulec.diagnostics.phrases import any_of
from rulec.scenario.scenario_messages import UNFITTING_BOUNDS


@dataclass(frozen=True, slots=True)
class MotionBounds:
    """Greatest speeds (m/s) and accelerations (m/s²) of ego, and the size of its body (m).

    Ego does not reverse, and moves sideways at most as fast as ahead: its heading stays within 45°
    of the road's, unless it starts with a larger angle. All values are in road coordinates.
    """

    speed: float = 50.8
    acceleration: float = 8.0
    braking: float = 11.5
    lateral_speed: float = 4.0
    lateral_acceleration: float = 2.0
    length: float = 4.508
    width: float = 1.61


BOUNDS_OF: Mapping[str, MotionBounds] = MappingProxyType(
    {
        "car": MotionBounds(),
        "van": MotionBounds(speed=41.7, length=4.569, width=1.844),
        "truck": MotionBounds(speed=22.22, length=5.1, width=2.55),
        "bus": MotionBounds(speed=22.22, length=12.0, width=2.5),
        "motorcycle": MotionBounds(speed=55.6, length=2.2, width=0.9),
        "bicycle": MotionBounds(speed=13.9, length=1.6, width=0.65),
    }
)
"""The bounds of each type of vehicle."""

NO_BOUNDS = "none"
"""The word for no bounds: ego may be anywhere at any moment, as in the paper."""

_TYPES = MappingProxyType({"cyclist": "bicycle", "taxi": "car", "vehicle": "car"})

FARTHEST = 1000.0
"""The largest value accepted for a bound."""


def bounds_of(types: Sequence[str]) -> MotionBounds:
    """The bounds of the first of these types that has any, else those of a car."""
    known = (BOUNDS_OF.get(_TYPES.get(word, word)) for word in types)
    return next((bounds for bounds in known if bounds is not None), BOUNDS_OF["car"])


def read_bounds(text: str, own: MotionBounds | None) -> MotionBounds | None:
    """Parse bounds: ``none``, a type of vehicle, numbers by name, or a type and numbers.

    Numbers without a type change the ``own`` bounds, or a car's if there are none. Raises
    RulecError R0770.
    """
    if text.strip() == NO_BOUNDS:
        return None
    bounds = own or BOUNDS_OF["car"]
    names = [field.name for field in fields(MotionBounds)]
    for place, part in enumerate(text.split(",")):
        name, is_number, value = (piece.strip() for piece in part.partition("="))
        if not is_number and place == 0 and name in BOUNDS_OF:
            bounds = BOUNDS_OF[name]
            continue
        number = _number(value) if is_number and name in names else None
        if number is None:
            raise UNFITTING_BOUNDS.error(
                None,
                f"`{part.strip()}` is not a bound of ego's motion",
                expected=f"expected {any_of([f'`{word}`' for word in (NO_BOUNDS, *BOUNDS_OF)])}; "
                f"or a number above 0, up to {FARTHEST:g}, for "
                f"{any_of([f'`{name}`' for name in names])}",
                help="write a type, as in `truck`, numbers, as in `braking=6,acceleration=3`, or "
                "both, the type first",
            )
        bounds = replace(bounds, **{name: number})
    return bounds


def _number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if isfinite(number) and 0 < number <= FARTHEST else None
