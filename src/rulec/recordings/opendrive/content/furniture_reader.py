"""Reads signals and objects on a road from the elements of an OpenDRIVE file."""

from __future__ import annotations

from rulec.recordings.encodings.tree import Tree
from rulec.recordings.opendrive.content.elements import RoadObject, RoadSignal, SignalReference
from rulec.recordings.opendrive.content.tree_values import (
    length,
    name,
    number,
    orientation,
    text,
    validity,
)

_MOST_CORNERS = 10_000


def read_signals(road: Tree) -> tuple[tuple[RoadSignal, ...], tuple[SignalReference, ...]]:
    """The signals on a road, and its references to signals of other roads."""
    signals, references = [], []
    for group in road.all("signals"):
        signals += [_signal(tree) for tree in group.all("signal")]
        references += [_reference(tree) for tree in group.all("signalReference")]
    return tuple(signals), tuple(references)


def _signal(tree: Tree) -> RoadSignal:
    # Some tools write a text where there is no value
    try:
        value = float(text(tree, "value"))
    except ValueError:
        value = 0.0
    return RoadSignal(
        id=name(tree),
        s=length(tree, "s"),
        orientation=orientation(tree),
        type=text(tree, "type"),
        subtype=text(tree, "subtype"),
        country=text(tree, "country"),
        dynamic=text(tree, "dynamic") == "yes",
        value=value if 0.0 < value < 1000.0 else None,
        unit=text(tree, "unit"),
        lanes=validity(tree),
    )


def _reference(tree: Tree) -> SignalReference:
    return SignalReference(name(tree), length(tree, "s"), orientation(tree), validity(tree))


def read_objects(road: Tree) -> tuple[RoadObject, ...]:
    """The crosswalks, stop lines and other objects on a road."""
    return tuple([_object(x) for group in road.all("objects") for x in group.all("object")])


def _object(tree: Tree) -> RoadObject:
    # Since 1.5 there may be several outlines; the first is that of the whole object
    group = tree.first("outlines")
    outline = tree.first("outline") if group is None else group.first("outline")
    corners: list[tuple[float, float]] = []
    on_road = False
    for corner in () if outline is None else outline.children[:_MOST_CORNERS]:
        if corner.name == "cornerLocal":
            corners.append((corner.number("u"), corner.number("v")))
        elif corner.name == "cornerRoad":
            on_road = True
            corners.append((corner.number("s"), corner.number("t")))
    return RoadObject(
        id=text(tree, "id"),
        type=text(tree, "type"),
        subtype=text(tree, "subtype"),
        name=text(tree, "name"),
        s=length(tree, "s", 0.0),
        t=number(tree, "t", 0.0),
        heading=number(tree, "hdg", 0.0),
        orientation=orientation(tree),
        length=length(tree, "length", 0.0),
        width=length(tree, "width", 0.0),
        corners=tuple(corners),
        on_road=on_road,
    )
