"""A second evaluation of OpenDRIVE's curves, by the standard's formulas and plain steps.

Headings of lines, arcs and spirals are those of their curvature, and places are summed up from
headings, by the midpoint rule in steps of some millimetres; polynomials are as long as their chords
in tiny steps. Nothing is shared with the reader, not even the XML parser.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import atan2, cos, hypot, sin
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


def lane_curves(path, every_m=0.25):
    """The middles of all lanes of a file that have a type."""
    root = ElementTree.parse(path).getroot()
    for road in root.iter("road"):
        yield from _of_road(road, every_m)


def reference_gaps(path):
    """How far (m) each piece of a reference line ends from where the next one begins."""
    for road in ElementTree.parse(path).getroot().iter("road"):
        pieces = road.find("planView").findall("geometry")
        for piece, following in pairwise(pieces):
            x, y, _ = _walk(piece, [_number(piece, "length")])[0]
            yield hypot(x - _number(following, "x"), y - _number(following, "y"))


def _of_road(road, every_m):
    length = _number(road, "length")
    lanes = road.find("lanes")
    sections = lanes.findall("laneSection")
    starts = [_number(part, "s") for part in sections]
    left_hand = road.get("rule") == "LHT"
    for index, part in enumerate(sections):
        end = starts[index + 1] if index + 1 < len(starts) else length
        count = max(FEWEST, int((end - starts[index]) / every_m) + 1)
        # Short of the end, where what follows begins
        last = max(end - 1e-6, starts[index])
        begun = [starts[index] + _number(x, "sOffset") for x in part.iter("width")]
        steep = [at + np.linspace(0.0, STEEP_M, FEWEST) for at in set(begun)]
        s = np.unique(np.concatenate((np.linspace(starts[index], last, count), *steep)))
        s = s[(s >= starts[index]) & (s <= last)]
        line = _reference(road.find("planView").findall("geometry"), s)
        offset = [_polynomial(lanes.findall("laneOffset"), "s", at) for at in s]
        for side, sign in (("left", 1), ("right", -1)):
            group = part.find(side)
            if group is None:
                continue
            inner = np.array(offset)
            for lane in sorted(group.findall("lane"), key=lambda x: abs(int(x.get("id")))):
                widths, borders = lane.findall("width"), lane.findall("border")
                if widths or not borders:
                    own = [_polynomial(widths, "sOffset", at - starts[index]) for at in s]
                    outer = inner + sign * np.array(own)
                else:
                    own = [_polynomial(borders, "sOffset", at - starts[index]) for at in s]
                    outer = np.array(offset) + sign * np.abs(own)
                t = (inner + outer) / 2
                middle = np.array(
                    [
                        (x - t_ * sin(h), y + t_ * cos(h))
                        for (x, y, h), t_ in zip(line, t, strict=True)
                    ]
                )
                number = int(lane.get("id"))
                yield LaneCurve(
                    road.get("id"),
                    index,
                    number,
                    lane.get("type"),
                    (number < 0) != left_hand,
                    s,
                    middle,
                    np.abs(outer - inner),
                )
                inner = outer


def _reference(pieces, s):
    starts = [_number(piece, "s") for piece in pieces]
    found = []
    for index, piece in enumerate(pieces):
        last = index + 1 == len(pieces)
        own = [
            at - starts[index]
            for at in s
            if (at >= starts[index] or index == 0) and (last or at < starts[index + 1])
        ]
        found += _walk(piece, own)
    return found


def _walk(piece, ways):
    """Places and headings after some ways, which ascend, along a piece."""
    x, y, heading = (_number(piece, key) for key in ("x", "y", "hdg"))
    length = _number(piece, "length")
    shape = next(iter(piece))
    if shape.tag in ("line", "arc", "spiral"):
        first = last = 0.0
        if shape.tag == "arc":
            first = last = _number(shape, "curvature")
        elif shape.tag == "spiral":
            first, last = _number(shape, "curvStart"), _number(shape, "curvEnd")
        return [*_by_curvature((x, y, heading), (first, last, length), ways)]
    local = _by_polynomials(shape, length, ways)
    return [
        (
            x + u * cos(heading) - v * sin(heading),
            y + u * sin(heading) + v * cos(heading),
            heading + h,
        )
        for u, v, h in local
    ]


def _by_curvature(pose, curvature, ways):
    (x, y, heading), (first, last, length) = pose, curvature
    done = 0.0
    for way in ways:
        count = max(1, int((way - done) / STEP_M))
        step = (way - done) / count
        for index in range(count):
            middle = done + (index + 0.5) * step
            # The heading there is the integral of a linear curvature
            turned = first * middle + (last - first) / length * middle**2 / 2
            x += step * cos(heading + turned)
            y += step * sin(heading + turned)
        done = way
        yield x, y, heading + first * way + (last - first) / length * way**2 / 2


def _by_polynomials(shape, length, ways):
    if shape.tag == "poly3":
        u = [0.0, 1.0, 0.0, 0.0]
        v = [_number(shape, key) for key in "abcd"]
    else:
        u = [_number(shape, f"{key}U") for key in "abcd"]
        v = [_number(shape, f"{key}V") for key in "abcd"]
    if shape.tag == "paramPoly3" and shape.get("pRange") == "arcLength":
        parameters = ways
    else:
        # Steps so small that chords are as long as the curve
        normalized = shape.tag == "paramPoly3"
        p = np.linspace(0.0, 1.0 if normalized else max([*ways, 1.0]), 200_001)
        places = np.stack([_at(u, p), _at(v, p)])
        reached = np.append(0.0, np.cumsum(np.hypot(*np.diff(places, axis=1))))
        scale = reached[-1] / length if normalized else 1.0
        parameters = np.interp(np.array(ways) * scale, reached, p)
    for p in parameters:
        du, dv = (c[1] + 2 * c[2] * p + 3 * c[3] * p**2 for c in (u, v))
        yield _at(u, p), _at(v, p), atan2(dv, du)


def _at(numbers, p):
    return sum(number * p**power for power, number in enumerate(numbers))


def _polynomial(elements, at, s):
    found = None
    for element in elements:
        if _number(element, at) <= s:
            found = element
    if found is None:
        return 0.0
    value = _at([_number(found, key) for key in "abcd"], s - _number(found, at))
    return max(value, 0.0) if found.tag == "width" else value


def _number(element, key):
    return float(element.get(key))
