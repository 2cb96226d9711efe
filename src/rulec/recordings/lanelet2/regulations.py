"""Regulatory elements of lanelets: lights, signs, limits, stop lines.

In Lanelet2, the lanelet before a line refers to its light or sign; in Autoware, the one behind it
does. Here they belong to the lanelets that end at the line, as in all recordings.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
import shapely

from rulec.recordings.commonroad.traffic_signs import MAX_SPEED, MIN_SPEED, UNKNOWN, effect_name
from rulec.recordings.lanelet2.osm_file import OsmFile, OsmRelation
from rulec.recordings.lanelet2.signs import Plates, element_signs, plates_of, tells_speed
from rulec.recordings.recording import GIVE_WAY_SIGNS, Lanelet, ObservedLight, Points, is_lane

MOST_MEMBERS = 1_000
"""The most members of one regulatory element."""

_MOST_CROSSED = 1_000_000
_AT_END_M = 1.0
_ON_LINE_M = 0.5
_SHORTEST_M = 0.5
"""A line that covers less than this of a lane is used as it is."""

_GOES_FIRST = frozenset({"PRIORITY", "RIGHT_OF_WAY"})
_YES = ("yes", "true", "1")


@dataclass(slots=True)
class LaneRules:
    """The rules that apply to a lanelet; lights are in the order of the file.

    ``untold`` are names of signs that may hold, ``unnumbered`` says whether one limits the speed
    without a number, which the lanelet's own tag may give.
    """

    # Not frozen: rules are added one by one
    signs: set[str] = field(default_factory=set)
    limits: list[float] = field(default_factory=list)
    minima: list[float] = field(default_factory=list)
    untold: set[str] = field(default_factory=set)
    unnumbered: bool = False
    lights: list[ObservedLight] = field(default_factory=list)
    lights_to: dict[str, list[ObservedLight]] = field(default_factory=dict)
    stop_line: Points | None = None
    directed: bool = False

    def add_light(self, light: ObservedLight, onward: str) -> None:
        """Add a light; if ``onward`` is not empty, it is only for the way to that lanelet."""
        if not any(light is known for known in self.lights):
            self.lights.append(light)
        if onward:
            self.lights_to.setdefault(onward, []).append(light)


@dataclass(frozen=True, slots=True)
class Surveyed:
    """A file's connected lanelets; ``points`` are the positions of its nodes."""

    file: OsmFile
    points: Points
    lanelets: dict[str, Lanelet]

    @property
    def lanes(self) -> list[Lanelet]:
        """The lanelets that are part of the carriageway."""
        return [lanelet for lanelet in self.lanelets.values() if is_lane(lanelet)]

    def rules_of(self, lanelet: Lanelet) -> Iterator[str]:
        """The regulatory elements to which a lanelet refers.

        They apply only in the direction of its bounds.
        """
        relation = self.file.relations.get(lanelet.id)
        return iter(()) if relation is None else relation.refs("regulatory_element", "relation")

    def line(self, way: str) -> Points | None:
        """The ends of a line of the file; None if there is no such line."""
        nodes = self.file.ways[way].nodes if way in self.file.ways else ()
        return self.points[[nodes[0], nodes[-1]]] if len(set(nodes)) > 1 else None


def regulations(survey: Surveyed) -> dict[str, LaneRules]:
    """Lanelet -> its rules. Raises RulecError R0610 for an element with too many members."""
    rules = {name: LaneRules() for name in survey.lanelets}
    for element in regulatory_elements(survey.file):
        if element.tags.get("subtype") == "all_way_stop":
            _all_way_stop(survey, element, rules)
    plates = plates_of(survey.file, survey.points)
    elements = {x.id: _Element(survey, x, plates) for x in regulatory_elements(survey.file)}
    for entry in survey.lanelets.values():
        for name in survey.rules_of(entry):
            if name in elements:
                elements[name].apply(entry, rules)
    for element in regulatory_elements(survey.file):
        if element.tags.get("subtype") == "right_of_way":
            _right_of_way_signs(survey, elements[element.id], rules)
    _drawn_stop_lines(survey, rules, _lines_of_rules(survey, elements.values()))
    return rules


def regulatory_elements(file: OsmFile) -> Iterator[OsmRelation]:
    """The regulatory elements of a file. Raises RulecError R0610 for too many members."""
    for relation in file.relations.values():
        if relation.tags.get("type") == "regulatory_element":
            if len(relation.members) > MOST_MEMBERS:
                why = f"a regulatory element has more than {MOST_MEMBERS:,} members"
                raise file.refused(why, relation.place)
            yield relation


class _Element:
    """A regulatory element to which lanelets refer; they all share its one light."""

    def __init__(self, survey: Surveyed, element: OsmRelation, plates: Plates) -> None:
        self.survey = survey
        self.element = element
        self.light = ObservedLight({})
        self.lines = [x for x in map(survey.line, element.refs("ref_line", "way")) if x is not None]
        self.signs = element_signs(survey.file, survey.points, element, plates)

    @property
    def is_dynamic(self) -> bool:
        """Whether it applies at some times only."""
        return self.element.tags.get("dynamic") in _YES

    @property
    def names_lanelets(self) -> bool:
        """Whether it says itself which lanelets it is for."""
        return self.element.tags.get("subtype") in ("all_way_stop", "right_of_way")

    @property
    def has_line(self) -> bool:
        """Whether the lanelets that refer to it end at its line."""
        gives_way = any(sign.name in GIVE_WAY_SIGNS for sign in self.signs)
        subtype = self.element.tags.get("subtype")
        return not self.is_dynamic and (subtype == "traffic_light" or gives_way)

    def apply(self, entry: Lanelet, rules: Mapping[str, LaneRules]) -> None:
        """Add the rule to the lanelets to which it applies."""
        kind = self.element.tags.get("subtype", "")
        if self.is_dynamic:
            # What it shows is unknown, but not that it may limit the speed
            names = {effect_name(sign.untold or sign.name) for sign in self.signs}
            if kind == "speed_limit" or (kind == "traffic_sign" and MAX_SPEED in names):
                rules[entry.id].untold.add(MAX_SPEED)
            return
        match kind:
            case "traffic_light" if not is_lane(entry):
                rules[entry.id].directed = True
            case "traffic_light":
                line = nearest_line(entry, self.lines)
                for name, onward in approaches(self.survey, entry, line):
                    rules[name].add_light(self.light, onward)
                    _draw(self.survey.lanelets[name], rules[name], line)
            case "traffic_sign" | "speed_limit":
                self._add_signs(entry, rules)

    def _add_signs(self, entry: Lanelet, rules: Mapping[str, LaneRules]) -> None:
        own = rules[entry.id]
        for sign in self.signs:
            if sign.untold == MAX_SPEED and sign.name != UNKNOWN:
                own.unnumbered = True
            elif sign.untold and sign.untold not in GIVE_WAY_SIGNS:
                own.untold.add(sign.untold)
            elif sign.limit_mps is not None:
                (own.minima if sign.name == MIN_SPEED else own.limits).append(sign.limit_mps)
        if self.element.tags.get("subtype") == "speed_limit" and not tells_speed(self.signs):
            own.unnumbered = True
        names = {sign.name for sign in self.signs}
        own.signs |= names - GIVE_WAY_SIGNS
        untold = GIVE_WAY_SIGNS.intersection(sign.untold for sign in self.signs)
        if names & GIVE_WAY_SIGNS or untold:
            line = nearest_line(entry, self.lines)
            for name, _ in approaches(self.survey, entry, line):
                rules[name].signs |= names & GIVE_WAY_SIGNS
                rules[name].untold |= untold
                _draw(self.survey.lanelets[name], rules[name], line)


def _draw(entry: Lanelet, rules: LaneRules, line: Points | None) -> None:
    if rules.stop_line is None and line is not None:
        rules.stop_line = _own_part(entry, line)


def _own_part(entry: Lanelet, line: Points) -> Points:
    """The part of a line between a lanelet's bounds; the line may cross several lanes."""
    whole = shapely.LineString(line)
    bounds = [shapely.LineString(bound) for bound in (entry.left, entry.right)]
    # GEOS divides by the length of a line, which may be almost 0
    with np.errstate(all="ignore"):
        ends: Points = shapely.get_coordinates(shapely.shortest_line(bounds, whole))[1::2]
    # Without a usable length, GEOS may find no point on one of the bounds
    both_met = len(ends) == len(bounds) and np.hypot(*(ends[1] - ends[0])) > _SHORTEST_M
    return ends if both_met else line


def nearest_line(entry: Lanelet, lines: list[Points]) -> Points | None:
    """The rule's line nearest to a lanelet's centre line; None if the rule has no line."""
    if len(lines) < 2:
        return lines[0] if lines else None
    middle = shapely.LineString(entry.centre)
    return min(lines, key=lambda line: middle.distance(shapely.Point(line.mean(axis=0))))


def approaches(survey: Surveyed, entry: Lanelet, line: Points | None) -> Iterator[tuple[str, str]]:
    """The lanelets that end at a rule's line; with the next lanelet if it is only for that way.

    This is the lanelet ``entry`` that refers to the rule. It is its predecessors if the line lies
    at its beginning or, within a junction, in its first half or is missing.
    """
    before = [x for x in entry.predecessors if is_lane(survey.lanelets[x])]
    if before and _begins_behind(entry, line):
        yield from ((name, entry.id) for name in before)
    else:
        yield entry.id, ""


def _begins_behind(entry: Lanelet, line: Points | None) -> bool:
    inside = "intersection" in entry.types
    if line is None:
        return inside
    middle = shapely.LineString(entry.centre)
    along = middle.project(shapely.Point(line.mean(axis=0)))
    return bool(along < _AT_END_M or (inside and along < middle.length / 2))


def _all_way_stop(survey: Surveyed, element: OsmRelation, rules: Mapping[str, LaneRules]) -> None:
    """Add an all-way stop to its lanelets.

    The lines are in the order of the lanelets; if their numbers differ, no lanelet gets a line.
    """
    names = list(element.refs("yield", "relation"))
    lines = [survey.line(way) for way in element.refs("ref_line", "way")]
    if len(lines) != len(names):
        lines = [None] * len(names)
    for name, line in zip(names, lines, strict=True):
        if name in survey.lanelets:
            for approach, _ in approaches(survey, survey.lanelets[name], line):
                rules[approach].signs.add("STOP_4_WAY")
                _draw(survey.lanelets[approach], rules[approach], line)


def _right_of_way_signs(
    survey: Surveyed, own_element: _Element, rules: Mapping[str, LaneRules]
) -> None:
    """Add the signs of a right of way to the lanelets that give way or have priority.

    At traffic lights, a right of way applies only while the lights are out of order.
    """
    element, lines = own_element.element, own_element.lines
    signs = {sign.name for sign in own_element.signs}
    untold = {sign.untold for sign in own_element.signs}
    for role, own in (("yield", GIVE_WAY_SIGNS), ("right_of_way", _GOES_FIRST)):
        for name in element.refs(role, "relation"):
            if name not in survey.lanelets:
                continue
            entry = survey.lanelets[name]
            line = nearest_line(entry, lines) if role == "yield" else None
            for approach, _ in approaches(survey, entry, line):
                if not rules[approach].lights:
                    rules[approach].signs |= signs & own
                    rules[approach].untold |= untold & own
                    _draw(survey.lanelets[approach], rules[approach], line)


def _drawn_stop_lines(
    survey: Surveyed, rules: Mapping[str, LaneRules], used: Collection[str]
) -> None:
    """Give stop lines of the map to the lanelets that they cross; rules have used some already."""
    ways = survey.file.ways.values()
    drawn = (x.id for x in ways if x.tags.get("type") == "stop_line" and x.id not in used)
    lines = [line for line in map(survey.line, drawn) if line is not None]
    open_lanes = [x for x in survey.lanes if rules[x.id].stop_line is None]
    if not lines or not open_lanes:
        return
    middles = [shapely.LineString(entry.centre) for entry in open_lanes]
    tree, count = shapely.STRtree(middles), 0
    reached: dict[str, tuple[float, Points]] = {}
    for line in lines:
        crossed = tree.query(shapely.LineString(line), predicate="dwithin", distance=_ON_LINE_M)
        count += len(crossed)
        if count > _MOST_CROSSED:
            raise survey.file.refused("too many of its lanelets overlap")
        for number in crossed.tolist():
            entry, middle = open_lanes[number], middles[number]
            along = middle.project(shapely.Point(line.mean(axis=0)))
            known = reached.get(entry.id, (0.0, line))[0]
            if along > max(_AT_END_M, known) and _crosses(middle, along, line):
                reached[entry.id] = along, line
    for name, (_, line) in reached.items():
        _draw(survey.lanelets[name], rules[name], line)


def _lines_of_rules(survey: Surveyed, elements: Iterable[_Element]) -> frozenset[str]:
    """The ways that rules have as their lines, for the lanelets that the rules are for."""
    referred = {name for lane in survey.lanes for name in survey.rules_of(lane)}
    return frozenset(
        way
        for rule in elements
        if rule.names_lanelets or (rule.has_line and rule.element.id in referred)
        for way in rule.element.refs("ref_line", "way")
    )


def _crosses(middle: shapely.LineString, along: float, line: Points) -> bool:
    """Whether a line lies across a lanelet rather than along it."""
    ends = [middle.interpolate(max(along + way, 0.0)) for way in (-0.5, 0.5)]
    ahead = np.array([ends[1].x - ends[0].x, ends[1].y - ends[0].y])
    across = line[1] - line[0]
    return bool(abs(ahead @ across) < 0.7 * np.hypot(*ahead) * np.hypot(*across))


def remarks_on(rules: Collection[LaneRules]) -> Iterator[str]:
    """Remarks on what the map does not contain about its lights and limits."""
    lights = {id(light) for own in rules for light in own.lights}
    if lights:
        yield f"the map does not contain what its {len(lights)} traffic lights show"
    limited = sum(MAX_SPEED in own.untold for own in rules)
    if limited:
        yield (
            f"signs limit the speed on {limited} lanelets only for some or at some times, as "
            "plates say or because they change: the limit is unknown there"
        )
