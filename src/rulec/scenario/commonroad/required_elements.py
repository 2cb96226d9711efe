"""Check a CommonRoad file for elements without which the library fails.

Only what the library fails on without is asked for; what it makes of the rest it says itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from rulec.scenario.safe_xml import is_packed, scan
from rulec.scenario.xml_element import XmlElement, XmlFormat, short

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


def check_form(path: Path) -> frozenset[str]:
    """Check that a file is well-formed XML with CommonRoad's required elements.

    Returns the ids of lanelets whose stop lines have a place: the library gives others one. Raises
    RulecError R0610 for a file that is none, R0701 for one that cannot be read.
    """
    # Name, line and children so far of the elements that have begun
    open_elements: list[tuple[str, int, list[str]]] = []
    lanelets, drawn = [""], set[str]()

    def begin(element: XmlElement) -> None:
        name, line = element.name, element.parser.CurrentLineNumber
        version = element.get("commonRoadVersion")
        if name == COMMONROAD.root and version not in VERSIONS:
            why = f"its `commonRoadVersion` is `{short(version)}`"
            raise element.wrong(why, " or ".join(VERSIONS))
        # A lanelet may also be referred to, by `ref` instead of an id
        is_reference = "ref" in element.attributes
        for attribute in _ATTRIBUTES.get(name, ()):
            if attribute not in element.attributes and not is_reference:
                raise element.wrong(f"the element `{name}` has no `{attribute}`")
        if name == "lanelet" and not is_reference:
            lanelets.append(element.get("id"))
        if open_elements:
            open_elements[-1][2].append(name)
        open_elements.append((name, line, list(_CHILDREN.get(name, ())) if is_reference else []))

    def end(_: str) -> None:
        name, line, children = open_elements.pop()
        for child in _CHILDREN.get(name, ()):
            if child not in children:
                raise COMMONROAD.refused(path, f"the element `{name}` has no `{child}`", line)
        if name == "stopLine" and "point" in children:
            drawn.add(lanelets[-1])
        fewest = _FEWEST_POINTS.get(name, 0)
        if children.count("point") < fewest:
            why = f"the element `{name}` has fewer than {fewest} points"
            raise COMMONROAD.refused(path, why, line)

    scan(path, COMMONROAD, begin, end=end)
    if is_packed(path):
        raise COMMONROAD.refused(path, "it is packed", help_text="unpack it with `gzip -d`")
    return frozenset(drawn)
