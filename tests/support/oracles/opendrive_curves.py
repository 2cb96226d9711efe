"""A second evaluation of OpenDRIVE's curves, by the standard's formulas and plain steps.

Headings of lines, arcs and spirals are those of their curvature, and places are summed up from
headings, by the midpoint rule in steps of some millimetres; polynomials are as long as their chords
in tiny steps. Nothing is shared with the reader, not even the XML parser.
"""

from dataclasses import dataclass
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np

STEP_M = 0.005
FEWEST = 40
"""Places in a section, and where a width begins, which may change steeply there."""

STEEP_M = 0.04


@dataclass(frozen=True)
class LaneCurve:
    """The middle of a lane in one section of its road, densely, in the road's direction."""

    road: str
    section: int
    lane: int
    kind: str
    forward: bool
    s: np.ndarray
    middle: np.ndarray
    width: np.ndarray


def lane_curves(path, every_m=0.5):
    """The middles of all lanes of a file that have a type."""
    root = ElementTree.parse(path).getroot()
    for road in root.iter("road"):
        yield from _of_road(road, every_m)


def reference_gaps(path):
    """How far (m) each piece of a reference line ends from where the next one begins."""
    for road in ElementTree.parse(path).getroot().iter("road"):
        pieces = road.find("planView").findall("geometry")
        for piece, following in pairwise(pieces):
            x, y, _ = _walk(piece, np.array([_number(piece, "length")]))[:, 0]
            yield np.hypot(x - _number(following, "x"), y - _number(following, "y"))


def _of_road(road, every_m):
    length = _number(road, "length")
    lanes = road.find("lanes")
    sections = lanes.findall("laneSection")
    starts = [_number(part, "s") for part in sections]
    left_hand = road.get("rule") == "LHT"
    for index, part in enumerate(sections):
        start = starts[index]
        end = starts[index + 1] if index + 1 < len(starts) else length
        count = max(FEWEST, int((end - start) / every_m) + 1)
        # Short of the end, where what follows begins
        last = max(end - 1e-6, start)
        begun = [start + _number(x, "sOffset") for x in part.iter("width")]
        steep = [at + np.linspace(0.0, STEEP_M, FEWEST) for at in set(begun)]
        s = np.unique(np.concatenate((np.linspace(start, last, count), *steep)))
        s = s[(s >= start) & (s <= last)]
        x, y, heading = _reference(road.find("planView").findall("geometry"), s)
        offset = _polynomials(lanes.findall("laneOffset"), "s", s)
        for side, sign in (("left", 1), ("right", -1)):
            group, inner = part.find(side), offset
            found = [] if group is None else group.findall("lane")
            for lane in sorted(found, key=lambda x: abs(int(x.get("id")))):
                widths, borders = lane.findall("width"), lane.findall("border")
                if widths or not borders:
                    own = _polynomials(widths, "sOffset", s - start)
                    outer = inner + sign * np.maximum(own, 0.0)
                else:
                    own = _polynomials(borders, "sOffset", s - start)
                    outer = offset + sign * np.abs(own)
                t = (inner + outer) / 2
                number = int(lane.get("id"))
                yield LaneCurve(
                    road=road.get("id"),
                    section=index,
                    lane=number,
                    kind=lane.get("type"),
                    forward=(number < 0) != left_hand,
                    s=s,
                    middle=np.column_stack((x - t * np.sin(heading), y + t * np.cos(heading))),
                    width=np.abs(outer - inner),
                )
                inner = outer


def _reference(pieces, s):
    """Places and headings of a reference line, a row each."""
    starts = [_number(piece, "s") for piece in pieces]
    parts = []
    for index, piece in enumerate(pieces):
        low = -np.inf if index == 0 else starts[index]
        high = starts[index + 1] if index + 1 < len(pieces) else np.inf
        ways = s[(s >= low) & (s < high)] - starts[index]
        if len(ways):
            parts.append(_walk(piece, ways))
    return np.concatenate(parts, axis=1)


def _walk(piece, ways):
    """Places and headings after some ways, which ascend, along a piece."""
    x, y, heading, length = (_number(piece, key) for key in ("x", "y", "hdg", "length"))
    shape = next(iter(piece))
    if shape.tag in ("line", "arc", "spiral"):
        first = last = 0.0
        if shape.tag == "arc":
            first = last = _number(shape, "curvature")
        elif shape.tag == "spiral":
            first, last = _number(shape, "curvStart"), _number(shape, "curvEnd")
        u, v, turned = _by_curvature(first, (last - first) / length, ways)
    else:
        u, v, turned = _by_polynomials(shape, length, ways)
    cos, sin = np.cos(heading), np.sin(heading)
    return np.stack((x + u * cos - v * sin, y + u * sin + v * cos, heading + turned))


def _by_curvature(curvature, sharper, ways):
    """In steps of some millimetres, in the direction that the middle of each has."""
    steps = max(1, int(max(ways) / STEP_M))
    ends = np.unique(np.concatenate((np.linspace(0.0, max(ways), steps + 1), ways)))
    middles, lengths = (ends[1:] + ends[:-1]) / 2, np.diff(ends)
    heading = curvature * middles + sharper * middles**2 / 2
    at = np.searchsorted(ends, ways)
    u, v = (np.append(0.0, np.cumsum(lengths * turned(heading)))[at] for turned in (np.cos, np.sin))
    return u, v, curvature * ways + sharper * ways**2 / 2


def _by_polynomials(shape, length, ways):
    if shape.tag == "poly3":
        u, v = [0.0, 1.0, 0.0, 0.0], [_number(shape, key) for key in "abcd"]
    else:
        u, v = ([_number(shape, f"{key}{axis}") for key in "abcd"] for axis in "UV")
    p = np.array(ways)
    if shape.tag == "poly3" or shape.get("pRange") != "arcLength":
        # Steps so small that chords are as long as the curve
        normalized = shape.tag == "paramPoly3"
        steps = np.linspace(0.0, 1.0 if normalized else max([*ways, 1.0]), 200_001)
        reached = np.append(
            0.0, np.cumsum(np.hypot(np.diff(_at(u, steps)), np.diff(_at(v, steps))))
        )
        p = np.interp(p * (reached[-1] / length if normalized else 1.0), reached, steps)
    du, dv = (c[1] + 2 * c[2] * p + 3 * c[3] * p**2 for c in (u, v))
    return _at(u, p), _at(v, p), np.arctan2(dv, du)


def _at(numbers, p):
    return sum(number * p**power for power, number in enumerate(numbers))


def _polynomials(elements, at, s):
    """Each holds from its start to where the next one begins."""
    values = np.zeros(len(s))
    for element in elements:
        start = _number(element, at)
        own = _at([_number(element, key) for key in "abcd"], s - start)
        values = np.where(s >= start, own, values)
    return values


def _number(element, key):
    return float(element.get(key))
