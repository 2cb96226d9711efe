"""Checked values of attributes in OpenDRIVE's elements."""

from __future__ import annotations

from math import inf

from rulec.recordings.encodings.file_values import number_in, short
from rulec.recordings.encodings.speed_units import SPEED_UNITS
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.opendrive.content.elements import ContactPoint, Cubic, Orientation, Speed

LONGEST_NAME = 200
_UNITS = {**SPEED_UNITS, "": 1.0}
"""Units of speed; m/s where the file gives none."""

_MOST_LANES = 1_000
_STEEPEST = 1e30
_ENDS: dict[str, ContactPoint] = {"start": "start", "end": "end"}
_DIRECTIONS: dict[str, Orientation] = {"+": "+", "-": "-"}


def name(tree: Tree, key: str = "id") -> str:
    """An id, which may be any text that is not empty."""
    text = tree.attribute(key).strip()
    if not text or len(text) > LONGEST_NAME:
        expected = f"1 to {LONGEST_NAME} characters"
        raise tree.wrong(f"`{key}` of a `{tree.name}` is `{short(text)}`", expected)
    return "".join(c if c.isprintable() else "?" for c in text)


def text(tree: Tree, key: str) -> str:
    """A word, empty if it is missing."""
    return tree.attributes.get(key, "").strip()[:LONGEST_NAME]


def number(tree: Tree, key: str, default: float) -> float:
    """A number, or its default if it is missing or empty."""
    return tree.number(key) if text(tree, key) else default


def length(tree: Tree, key: str, default: float | None = None) -> float:
    """A number not below 0; slightly negative ones, from rounding, become 0."""
    value = tree.number(key) if default is None else number(tree, key, default)
    if value < -1e-3:
        raise tree.wrong(f"`{key}` of a `{tree.name}` is {value:g}", "a number not below 0")
    return max(value, 0.0)


def lane_number(tree: Tree, key: str = "id") -> int:
    """The number of a lane."""
    written = tree.attribute(key).strip()
    digits = written.removeprefix("-").removeprefix("+")
    if not (digits.isascii() and digits.isdigit()) or len(digits) > 4 or int(digits) > _MOST_LANES:
        expected = f"a whole number from {-_MOST_LANES} to {_MOST_LANES}"
        raise tree.wrong(f"`{key}` of a `{tree.name}` is `{short(written)}`", expected)
    return int(written)


def cubic(tree: Tree, key: str) -> Cubic:
    """The polynomial in an element; the attribute ``key`` gives its start.

    Tools write pieces a micrometre long, with huge coefficients but ordinary values.
    """
    b, c, d = (_coefficient(tree, name_) for name_ in "bcd")
    return Cubic(length(tree, key), number(tree, "a", 0.0), b, c, d)


def _coefficient(tree: Tree, key: str) -> float:
    """A finite number, or 0 if it is missing or empty."""
    written = text(tree, key)
    try:
        value = number_in(written or "0")
    except ValueError:
        value = inf
    return value if abs(value) < _STEEPEST else tree.number(key)


def contact_point(tree: Tree) -> ContactPoint | None:
    """The end of a road in a link; None if the file does not give it."""
    return _ENDS.get(text(tree, "contactPoint"))


def orientation(tree: Tree) -> Orientation:
    """The direction along the road in which an element applies."""
    return _DIRECTIONS.get(text(tree, "orientation"), "none")


def validity(tree: Tree) -> tuple[tuple[int, int], ...] | None:
    """The ranges of lanes that an element applies to; None for all lanes."""
    ranges = []
    for child in tree.all("validity"):
        ends = lane_number(child, "fromLane"), lane_number(child, "toLane")
        ranges.append((min(ends), max(ends)))
    return tuple(ranges) or None


def speed(tree: Tree, key: str | None) -> Speed:
    """The speed limit in an element; for a lane, the attribute ``key`` gives its start."""
    start = 0.0 if key is None else length(tree, key, 0.0)
    match tree.attribute("max").strip().lower():
        case "no limit":
            return Speed(start, inf)
        case "undefined" | "":
            return Speed(start, None)
    most = tree.number("max")
    if most < 0:
        raise tree.wrong(f"`max` of a `speed` is {most:g}", "a number not below 0")
    # Some tools write 0 for an unknown limit
    return Speed(start, most * unit_mps(tree) if most else None)


def unit_mps(tree: Tree) -> float:
    """A unit of speed in m/s."""
    unit = text(tree, "unit")
    if unit not in _UNITS:
        raise tree.wrong(f"`unit` of a `{tree.name}` is `{short(unit)}`", "`m/s`, `km/h` or `mph`")
    return _UNITS[unit]
