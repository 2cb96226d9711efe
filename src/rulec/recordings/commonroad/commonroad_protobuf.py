"""Reads CommonRoad scenarios in Protocol Buffers, in one file or in parts, as recordings.

Messages are turned into the XML elements of the same meaning, and then read as these are.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

from rulec.recordings.commonroad import protobuf_tables as tables
from rulec.recordings.commonroad.commonroad_file import begin
from rulec.recordings.commonroad.scenario_content import Content, add, add_step, to_recording
from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.tree import LONGEST_TEXT, Tree
from rulec.recordings.encodings.wire_format import Message, Table, WireField, WireFile, wire_file
from rulec.recordings.recording import Recording

PROTOBUF = BinaryFormat(
    "a CommonRoad scenario in Protocol Buffers",
    "the format is the one of `commonroad-io`, described at https://commonroad.in.tum.de",
)
_PROBLEMS = "-SC.pb"
_MOST_LANELETS = 4
"""The most lanelets that a bound may belong to on average, in maps of more than ``FEW_POINTS``."""
FEW_POINTS = 1_000_000


def read_protobuf(path: Path) -> Recording:
    """Read the recording in a CommonRoad file in Protocol Buffers.

    For a scenario in parts, the path is that of the part with the traffic or of the one with the
    planning problems; the other parts are expected in the same folder.

    Raises RulecError R0610 for a file that cannot be read as CommonRoad or a missing part, R0701 if
    it cannot be opened.
    """
    file = wire_file(path, PROTOBUF)
    kind = _kind(file)
    content = Content()
    if kind is tables.SINGLE:
        begin(content, _scan(file, kind, lambda tree: add(content, tree)))
        return to_recording(content, path, PROTOBUF)
    if kind is tables.MAP:
        why = "it is the map of a scenario in parts, without traffic"
        way_out = "give the part with the traffic; the map is found in the same folder"
        raise PROTOBUF.refused(path, why, help_text=way_out)
    problems = file if kind is tables.SCENARIO else None
    if problems is not None:
        dynamic = _scan(problems, tables.DYNAMIC_OF_SCENARIO, _ignore).attribute("dynamic")
        file = _part(path, dynamic, tables.DYNAMIC)
    elif (beside := path.with_name(path.stem + _PROBLEMS)).is_file():
        problems = _part(path, beside.stem, tables.SCENARIO)
    root = _scan(file, tables.MAP_OF_DYNAMIC, _ignore)
    add_step(content, root)
    name = f"{root.attribute('country')}_{root.attribute('map')}-{root.id('mapNumber')}"
    _add_map(content, _part(path, name, tables.MAP))
    _scan(file, tables.DYNAMIC, lambda tree: add(content, tree))
    if problems is not None:
        _scan(problems, tables.SCENARIO, lambda tree: add(content, tree))
    return to_recording(content, file.path, PROTOBUF)


def _kind(file: WireFile) -> Table:
    """The kind of a file, found from the first bytes of the first message in its first message."""
    head = b""
    has_second = False
    for item in file.fields(tables.BEGIN):
        if isinstance(item.value, Message) and item.value.fields:
            (first, *_) = item.value.fields
            head = first.value if isinstance(first.value, bytes) else b""
        has_second |= isinstance(item.value, bytes)
    match head[:1]:
        case b"2":
            return tables.SINGLE
        case b"\n":
            return tables.MAP
        case b"\b":
            return tables.DYNAMIC if has_second else tables.SCENARIO
    raise PROTOBUF.refused(file.path, "it does not begin like a scenario or a part of one")


def _part(path: Path, stem: str, kind: Table) -> WireFile:
    """Another part of the scenario, in the same folder as ``path``."""
    name = f"{stem}.pb"
    # The name comes from the file and may be any text
    if "/" in name or "\\" in name or not name.isprintable():
        raise PROTOBUF.refused(path, f"the name of another part of it is `{short(name)}`")
    beside = path.with_name(name)
    if not beside.is_file():
        why = f"it is a part of a scenario, and another part, `{short(name)}`, is not beside it"
        raise PROTOBUF.refused(path, why, help_text="put the parts into one folder")
    file = wire_file(beside, PROTOBUF)
    if _kind(file) is not kind:
        raise PROTOBUF.refused(beside, f"it is not the part that `{short(path.name)}` refers to")
    return file


def _scan(file: WireFile, table: Table, child: Callable[[Tree], None]) -> Tree:
    """The root element with its attributes; each of its children is passed to the callback."""
    root = Tree("commonRoad", {}, 0, file.path, file.form)
    for item in file.fields(table):
        _grow(root, item)
        while root.children:
            child(root.children.pop())
    return root


def _ignore(_: Tree) -> None:
    """Skip a child: only the attributes of the root are wanted."""


def _add_map(content: Content, file: WireFile) -> None:
    """Read the map, and give its lanelets the points of the bounds and stop lines they refer to."""
    bounds: dict[tuple[str, str], Tree] = {}

    def note(tree: Tree) -> None:
        bounds[tree.name, tree.attribute("id")] = tree

    _scan(file, tables.BOUNDS, note)
    points = sum(len(bound.children) for bound in bounds.values())
    left = max(_MOST_LANELETS * points, FEW_POINTS)

    def join(tree: Tree) -> None:
        nonlocal left
        for child in tree.children:
            if (kind := _REFERENCES.get(child.name)) is not None:
                bound = bounds.get((kind, child.text))
                if bound is None:
                    raise child.wrong(f"`{child.name}` is {child.text}, which is not in the map")
                is_reverse = child.attributes.get("reverse") == "true"
                child.children = bound.children[::-1] if is_reverse else bound.children
                left -= len(bound.children)
                if left < 0:
                    raise child.wrong(f"bounds belong to more than {_MOST_LANELETS} lanelets each")
        add(content, tree)

    _scan(file, tables.MAP, join)


_REFERENCES = {"leftBound": "bound", "rightBound": "bound", "stopLine": "stopLine"}


def _grow(tree: Tree, item: WireField) -> None:
    """Add a field of a message to a tree, as the element or attribute that it corresponds to."""
    outer, name, attribute = _steps(item.field.name)
    for step in outer:
        tree = tree.first(step) or _branch(tree, step, item.place)
    if name:
        # Several fields may belong to one element
        known = None if item.field.many else tree.first(name)
        tree = known or _branch(tree, name, item.place)
    if isinstance(item.value, Message):
        for field in item.value.fields:
            _grow(tree, field)
        return
    text = str(item.value)[:LONGEST_TEXT]
    text = text.lower() if isinstance(item.value, bool) else text
    if attribute:
        tree.attributes[attribute] = text
    else:
        tree.text = text


def _branch(tree: Tree, name: str, place: int) -> Tree:
    branch = Tree(name, {}, place, tree.path, tree.form)
    tree.children.append(branch)
    return branch


@cache
def _steps(name: str) -> tuple[tuple[str, ...], str, str]:
    """The outer elements, the innermost element and the attribute in a field's name."""
    elements, _, attribute = name.partition("@")
    *outer, last = elements.split("/")
    return tuple(outer), last, attribute
