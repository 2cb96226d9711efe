"""Check a CommonRoad file for elements without which the library fails.

Only what the library fails on without is asked for; what it makes of the rest it says itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers.expat import XMLParserType

from rulec.scenario.safe_xml import XmlFormat, is_packed, scan, short

COMMONROAD = XmlFormat(
    "a CommonRoad scenario",
    "commonRoad",
    "CommonRoad's format is described at https://commonroad.in.tum.de",
)
VERSIONS = ("2018b", "2020a")

_ATTRIBUTES: Mapping[str, tuple[str, ...]] = {
    "commonRoad": ("benchmarkID", "timeStepSize"),
    "lanelet": ("id",),
    "obstacle": ("id",),
    "staticObstacle": ("id",),
    "dynamicObstacle": ("id",),
    "planningProblem": ("id",),
}
_CHILDREN: Mapping[str, tuple[str, ...]] = {
    "lanelet": ("leftBound", "rightBound"),
    "point": ("x", "y"),
    "center": ("x", "y"),
    "rectangle": ("length", "width"),
    "circle": ("radius",),
    "obstacle": ("role", "type", "shape", "initialState"),
    "staticObstacle": ("type", "shape", "initialState"),
    "dynamicObstacle": ("type", "shape", "initialState"),
    "planningProblem": ("initialState",),
}
_FEWEST_POINTS = {"leftBound": 2, "rightBound": 2}


@dataclass(slots=True)
class _Open:
    """An element that has begun, with its place and content so far."""

    name: str
    line: int
    children: list[str] = field(default_factory=list)


def check_form(path: Path) -> None:
    """Raise RulecError unless the file is well-formed XML with CommonRoad's required elements.

    Raises:
        RulecError: R0610 for a file that is none, R0701 for one that cannot be read.
    """
    open_ones: list[_Open] = []

    def begin(name: str, attributes: Mapping[str, str], parser: XMLParserType) -> None:
        line = parser.CurrentLineNumber
        version = attributes.get("commonRoadVersion", "")
        if name == COMMONROAD.root and version not in VERSIONS:
            why = f"its `commonRoadVersion` is `{short(version)}`"
            expected = f"expected {' or '.join(VERSIONS)}"
            raise COMMONROAD.refused(path, why, line, expected=expected)
        for attribute in _ATTRIBUTES.get(name, ()):
            # A lanelet may also be referred to, by `ref` instead of an id
            if attribute not in attributes and "ref" not in attributes:
                raise COMMONROAD.refused(path, f"the element `{name}` has no `{attribute}`", line)
        if open_ones:
            open_ones[-1].children.append(name)
        open_ones.append(
            _Open(name, line, list(_CHILDREN.get(name, ())) if "ref" in attributes else [])
        )

    def end(name: str) -> None:
        element = open_ones.pop()
        for child in _CHILDREN.get(name, ()):
            if child not in element.children:
                raise COMMONROAD.refused(
                    path, f"the element `{name}` has no `{child}`", element.line
                )
        fewest = _FEWEST_POINTS.get(name, 0)
        if element.children.count("point") < fewest:
            why = f"the element `{name}` has fewer than {fewest} points"
            raise COMMONROAD.refused(path, why, element.line)

    scan(path, COMMONROAD, begin, end=end)
    if is_packed(path):
        raise COMMONROAD.refused(path, "it is packed", help_text="unpack it with `gzip -d`")
