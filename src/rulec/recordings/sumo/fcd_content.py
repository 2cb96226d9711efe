"""The content of floating-car data: head, moments, and a track per participant."""

from __future__ import annotations

import re
from array import array
from dataclasses import dataclass, field
from html import unescape

from rulec.recordings.encodings.file_format import XmlFormat

FCD = XmlFormat(
    "SUMO's floating-car data",
    "SUMO writes them with the option --fcd-output",
    2_000_000_000,
    root="fcd-export",
)
BODIES = frozenset({"vehicle", "person", "container"})
LONGEST_ID = 200
MICROSECONDS = 1_000_000
"""Microseconds in a second; moments are whole numbers of microseconds."""

PLACE = ("x", "y", "angle")
"""The attributes that every participant has at every moment."""

SPEED = "speed"
"""SUMO writes it unless told which attributes to write; else speeds follow from places."""

NOWHERE = -(2.0**30)
"""SUMO's x and y for participants without a position, for instance while teleporting."""

_OPTION = re.compile(r'<(net-file|route-files|additional-files|fcd-output\.geo)\s+value="([^"]*)"')

_LEAVES_OUT = re.compile(
    r"<(fcd-output\.filter-[a-z.-]+|(?:person-)?device\.fcd\.(?:probability|explicit|radius)"
    r"|person-fcd-output)\s+value="
)
"""Options that make floating-car data contain only a part of the traffic."""


_TRUE = frozenset({"true", "1", "yes", "on", "x", "t"})


@dataclass(frozen=True, slots=True)
class FcdHead:
    """SUMO's configuration, from a comment at the head of its output.

    ``leaves_out``: the options that keep some of the traffic out of the data.
    """

    net: str = ""
    demand: tuple[str, ...] = ()
    additional: tuple[str, ...] = ()
    geographic: bool = False
    leaves_out: tuple[str, ...] = ()


def is_true(text: str) -> bool:
    """Whether a text is true to SUMO, which reads the same words everywhere."""
    return text.lower() in _TRUE


def fcd_head(comment: str) -> FcdHead:
    """The part of the configuration in a comment that is used here."""
    options = {name: unescape(value) for name, value in _OPTION.findall(comment)}
    routes, additional = (
        tuple(filter(None, map(str.strip, options.get(key, "").split(","))))
        for key in ("route-files", "additional-files")
    )
    return FcdHead(
        options.get("net-file", ""),
        (*routes, *additional),
        additional,
        is_true(options.get("fcd-output.geo", "")),
        tuple(sorted(set(_LEAVES_OUT.findall(comment)))),
    )


@dataclass(slots=True)
class FcdTrack:
    """The track of a participant; rows are x, y (m), angle (degrees) and speed (m/s, or NaN).

    ``moments`` are indices into the moments of the file.
    """

    element: str
    type: str
    moments: array[int] = field(default_factory=lambda: array("q"))
    rows: array[float] = field(default_factory=lambda: array("d"))
    accelerations: array[float] = field(default_factory=lambda: array("d"))
    lamps: dict[int, int] = field(default_factory=dict)


@dataclass(slots=True)
class FloatingCarData:
    """The content of a floating-car data file.

    ``moments`` are times in microseconds; ``on`` maps each lane or edge that is named to which of
    the two it is, and the line of its first use.
    """

    head: FcdHead = field(default_factory=FcdHead)
    moments: list[int] = field(default_factory=list)
    tracks: dict[str, FcdTrack] = field(default_factory=dict)
    on: dict[str, tuple[str, int]] = field(default_factory=dict)
