"""An OpenStreetMap file as used by Lanelet2: nodes, ways, relations, and the tags used here."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import nan
from pathlib import Path
from typing import NamedTuple

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import XmlFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.safe_xml import scan
from rulec.recordings.encodings.tree import Tree

LANELET2 = XmlFormat(
    "a Lanelet2 map",
    "Lanelet2's format is described at https://github.com/fzi-forschungszentrum-informatik/Lanelet2",
    root="osm",
)

MOST_NODES = 1_000_000
MOST_WAYS = 500_000
"""The most ways, and the most relations."""

MOST_REFERENCES = 5_000_000
"""The most references to nodes and to members of relations; all take some 500 MB of memory."""

_MOST_TAGS = 50
_LONGEST_TAG = 200
_LONGEST_ID = 20
_KEPT = """
type subtype location region one_way turn_direction speed_limit speed_limit_mandatory
intersection_area lane_change lane_change:left lane_change:right sign_type dynamic
"""
_KEPT_KEYS = frozenset(_KEPT.split())
_PLACE_KEYS = ("local_x", "local_y")
_KEPT_PREFIXES = ("participant:", "one_way:", "speed_limit:")


class Member(NamedTuple):
    """A member of a relation: its kind (node, way, relation), id, and role."""

    kind: str
    id: str
    role: str


@dataclass(slots=True)
class OsmWay:
    """A line through nodes (indices in the file's order).

    ``place`` is its first line in the file.
    """

    # Not frozen: nodes and tags are added one by one
    id: str
    place: int
    refs: list[str] = field(default_factory=list)
    tags: dict[str, str] = field(default_factory=dict)
    nodes: tuple[int, ...] = ()


@dataclass(slots=True)
class OsmRelation:
    """A lanelet or rule with its members; ``place`` is its first line in the file."""

    # Not frozen, as above
    id: str
    place: int
    members: list[Member] = field(default_factory=list)
    tags: dict[str, str] = field(default_factory=dict)

    def refs(self, role: str, kind: str) -> Iterator[str]:
        """The ids of the members with this role and kind."""
        return (x.id for x in self.members if x.role == role and x.kind == kind)


@dataclass(slots=True)
class OsmNode:
    """A position in degrees, and in metres if the file gives them; NaN where it is missing."""

    # Not frozen, as above
    place: int
    lat: float
    lon: float
    local_x: float = nan
    local_y: float = nan


@dataclass(slots=True)
class OsmFile:
    """The content of a file by id; nodes are in the file's order."""

    path: Path
    numbers: dict[str, int] = field(default_factory=dict)
    nodes: list[OsmNode] = field(default_factory=list)
    ways: dict[str, OsmWay] = field(default_factory=dict)
    relations: dict[str, OsmRelation] = field(default_factory=dict)

    def refused(self, why: str, place: int | None = None, expected: str = "") -> RulecError:
        """The error (R0610) for a line."""
        expected = expected and f"expected {expected}"
        return LANELET2.refused(self.path, why, place, expected=expected)


@dataclass(slots=True)
class _Scan:
    """The state of a scan: the depth of nested elements, and the element that is open."""

    file: OsmFile
    depth: int = 0
    open: OsmNode | OsmWay | OsmRelation | None = None
    references: int = 0

    def begin(self, element: Tree) -> None:
        if self.depth == 1:
            self.open = self._opened(element)
        elif self.depth == 2 and self.open is not None:
            self._add(element, self.open)
        self.depth += 1

    def end(self, _: str) -> None:
        self.depth -= 1

    def _opened(self, element: Tree) -> OsmNode | OsmWay | OsmRelation | None:
        # Editors keep deleted elements in the file until the upload
        if element.get("action") == "delete" or element.get("visible") == "false":
            return None
        place, file = element.place, self.file
        match element.name:
            case "node":
                node = OsmNode(place, _degrees(element, "lat", 90), _degrees(element, "lon", 360))
                name = _id(element, "id")
                if name in file.numbers:
                    raise element.wrong(f"there are two nodes `{name}`")
                if len(file.nodes) == MOST_NODES:
                    raise element.wrong(f"there are more than {MOST_NODES:,} nodes")
                file.numbers[name] = len(file.nodes)
                file.nodes.append(node)
                return node
            case "way":
                return _entered(file.ways, OsmWay(_id(element, "id"), place), element)
            case "relation":
                return _entered(file.relations, OsmRelation(_id(element, "id"), place), element)
        return None

    def _add(self, element: Tree, owner: OsmNode | OsmWay | OsmRelation) -> None:
        # Kept fast: a large map has a million of these elements
        name = element.name
        if name == "nd" and isinstance(owner, OsmWay):
            self._count(element)
            owner.refs.append(_id(element, "ref"))
        elif name == "member" and isinstance(owner, OsmRelation):
            self._count(element)
            member = Member(element.get("type"), _id(element, "ref"), element.get("role"))
            owner.members.append(member)
        elif name == "tag":
            key, value = element.get("k"), element.get("v")
            if isinstance(owner, OsmNode):
                if key in _PLACE_KEYS and value:
                    setattr(owner, key, element.as_number(key, value))
            elif (key in _KEPT_KEYS or key.startswith(_KEPT_PREFIXES)) and (
                len(owner.tags) < _MOST_TAGS and len(key) + len(value) < _LONGEST_TAG
            ):
                owner.tags[key] = value.strip()

    def _count(self, element: Tree) -> None:
        self.references += 1
        if self.references > MOST_REFERENCES:
            raise element.wrong(f"there are more than {MOST_REFERENCES:,} references in it")


def read_osm(path: Path) -> OsmFile:
    """Read a file; a way that refers to a missing node is left without any nodes.

    Raises RulecError R0610 for another kind of file, R0701 if it cannot be read.
    """
    file = OsmFile(path)
    state = _Scan(file)
    scan(path, LANELET2, state.begin, end=state.end)
    for way in file.ways.values():
        if all(ref in file.numbers for ref in way.refs):
            way.nodes = tuple([file.numbers[ref] for ref in way.refs])
        way.refs.clear()
    return file


def _id(element: Tree, key: str) -> str:
    """An id: a whole number, which editors make negative for new elements."""
    text = element.filled(key)
    digits = text.removeprefix("-")
    if not (digits.isascii() and digits.isdigit() and len(text) <= _LONGEST_ID):
        raise element.wrong(f"`{key}` of a `{element.name}` is `{short(text)}`", "a whole number")
    return text


def _degrees(element: Tree, key: str, most: float) -> float:
    # Maps in metres leave the degrees empty
    if not element.get(key):
        return nan
    value = element.number(key)
    if abs(value) > most:
        raise element.wrong(f"`{key}` of a node is {value:g}", f"degrees, at most {most:g}")
    return value


def _entered(
    known: dict[str, OsmWay] | dict[str, OsmRelation],
    entry: OsmWay | OsmRelation,
    element: Tree,
) -> OsmWay | OsmRelation:
    if entry.id in known:
        raise element.wrong(f"there are two elements `{element.name}` with the id `{entry.id}`")
    if len(known) == MOST_WAYS:
        raise element.wrong(f"there are more than {MOST_WAYS:,} elements `{element.name}`")
    known[entry.id] = entry  # type: ignore[assignment]
    return entry
