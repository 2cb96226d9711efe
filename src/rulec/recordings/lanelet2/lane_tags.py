"""Tags of Lanelet2's lanelets and bounds, in the words of recordings.

After LaneletAndAreaTagging and LinestringTagging in the folder lanelet2_core/doc of
https://github.com/fzi-forschungszentrum-informatik/Lanelet2; `road_shoulder` and `pedestrian_lane`
are Autoware's.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isfinite
from types import MappingProxyType

from rulec.recordings.encodings.file_values import number_in
from rulec.recordings.encodings.speed_units import MPS_PER_KMH, SPEED_UNITS
from rulec.recordings.recording import BUSES_ONLY, CYCLES_TOO, TAXIS_TOO, LaneMark

_Tags = Mapping[str, str]

_SUBTYPES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "highway": ("highway",),
        "bus_lane": ("busLane",),
        "bicycle_lane": ("bicycleLane",),
        "emergency_lane": ("shoulder",),
        "road_shoulder": ("shoulder",),
        "exit": ("driveWay",),
        "crosswalk": ("crosswalk",),
        **dict.fromkeys(("walkway", "shared_walkway", "stairs", "pedestrian_lane"), ("sidewalk",)),
        "rail": ("restricted_area", "rail"),
    }
)
"""Subtype of a lanelet -> its types; lanelets of all other subtypes are plain lanes."""

_BY_SUBTYPE = frozenset({"crosswalk", "rail", "emergency_lane", "road_shoulder"})
"""Subtypes whose types do not depend on the permitted participants."""

_PLACES = {"urban": "urban", "city": "urban", "nonurban": "rural"}
"""Location -> type; ``city`` is INTERACTION's word."""

_BUSES = {"vehicle:bus", "vehicle:taxi", "vehicle:emergency"}
_TRUE, _FALSE = ("yes", "true", "1"), ("no", "false", "0")


def lane_types(tags: _Tags) -> frozenset[str]:
    """The types of a lanelet; a tag for turns or a junction puts it in a junction."""
    subtype = tags.get("subtype", "")
    types = set(_SUBTYPES.get(subtype, ()))
    allowed = _participants(tags)
    if allowed is not None and subtype not in _BY_SUBTYPE:
        types = types - {"busLane", "bicycleLane", "sidewalk"} | set(_types_for(allowed))
    types.update(filter(None, [_PLACES.get(tags.get("location", ""))]))
    if tags.get("turn_direction") or tags.get("intersection_area"):
        types.add("intersection")
    return frozenset(types)


def _participants(tags: _Tags) -> set[str] | None:
    """The permitted participants; None if no tag names any and the subtype decides."""
    prefix = "participant:"
    named = {key.removeprefix(prefix): word for key, word in tags.items() if prefix in key}
    return {user for user, word in named.items() if word in _TRUE} if named else None


def _types_for(allowed: set[str]) -> Iterator[str]:
    motorized = {user for user in allowed if user.partition(":")[0] == "vehicle"}
    if motorized and motorized <= _BUSES:
        yield from ("busLane", BUSES_ONLY) if "vehicle:bus" in motorized else ("restricted_area",)
        if "bicycle" in allowed:
            yield CYCLES_TOO
        if "vehicle:taxi" in motorized:
            yield TAXIS_TOO
    elif not motorized and "pedestrian" in allowed:
        yield "sidewalk"
    elif not motorized and "bicycle" in allowed:
        yield "bicycleLane"
    elif not motorized:
        yield "restricted_area"


def leads_both_ways(tags: _Tags) -> bool:
    """Whether a lanelet may be used in both directions by its vehicles or cyclists."""
    keys: tuple[str, ...] = ("one_way:vehicle:car", "one_way:vehicle", "one_way")
    if "bicycle_lane" in tags.get("subtype", ""):
        keys = ("one_way:bicycle", "one_way")
    return next((tags[key] for key in keys if key in tags), "yes") in _FALSE


_UNITS = {**SPEED_UNITS, "": MPS_PER_KMH}


def speed_limit(tags: _Tags) -> float | None:
    """The limit (m/s) for cars in a lanelet's own tags; None for no limit or an advisory one."""
    keys = ("speed_limit:vehicle:car", "speed_limit:vehicle", "speed_limit")
    if tags.get("speed_limit_mandatory", "yes") in _FALSE:
        return None
    return next((velocity(tags[key]) for key in keys if key in tags), None)


def velocity(text: str) -> float | None:
    """A speed (m/s), by default given in km/h; None if the text is not a speed."""
    number = text.rstrip("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ/ ")
    unit = _UNITS.get(text[len(number) :].strip().lower())
    try:
        value = number_in(number)
    except ValueError:
        return None
    return value * unit if unit is not None and isfinite(value) and value >= 0 else None


_LINES = ("line_thin", "line_thick")
_MARKS: Mapping[str, tuple[LaneMark, LaneMark]] = MappingProxyType(
    {
        "solid": ("solid", "solid"),
        "solid_solid": ("double_solid", "double_solid"),
        "dashed": ("broken", "broken"),
        "dashed_dashed": ("broken", "broken"),
        "dashed_solid": ("broken", "solid"),
        "solid_dashed": ("solid", "broken"),
    }
)
"""Subtype of a line -> its mark on the left and on the right; a broken side may be crossed."""


def mark(tags: _Tags, *, turned: bool, on_left: bool) -> LaneMark | None:
    """The mark on a bound's left or right in the direction of travel; None if it is unknown.

    ``turned``: the bound is reversed compared with the file. Kerbs and borders are not marks. If a
    line's subtype and its tags on changing lanes contradict each other, the mark is unknown. Lines
    without a subtype, as from SUMO, get it from these tags: a line that may not be crossed is
    solid.
    """
    if tags.get("type") == "virtual":
        return "none"
    if tags.get("type") not in _LINES:
        return None
    left = on_left != turned
    own = _MARKS.get(tags.get("subtype", ""))
    drawn = own and own[0 if left else 1]
    may = _may_cross(tags, from_left=left)
    if may is None:
        return drawn
    by_tag: LaneMark = "broken" if may else "solid"
    if drawn is None:
        return None if tags.get("subtype") else by_tag
    return drawn if (drawn == "broken") == may else None


def _may_cross(tags: _Tags, *, from_left: bool) -> bool | None:
    """Whether a line may be crossed from one of its sides; None if no tag says so."""
    own = "lane_change:right" if from_left else "lane_change:left"
    for key in ("lane_change", own):
        if tags.get(key) in (*_TRUE, *_FALSE):
            return tags[key] in _TRUE
    return None
