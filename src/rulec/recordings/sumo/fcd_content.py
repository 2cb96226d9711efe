"""Contents of floating-car data: head, times, and a track per participant."""

from __future__ import annotations

import re
from array import array
from dataclasses import dataclass, field

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
"""In a second: moments are whole numbers of them."""

PLACE = ("x", "y", "angle", "speed")
"""What is said of everybody."""

NOWHERE = -(2.0**30)
"""What SUMO writes for x and y of who is in no place, as while it is moved elsewhere."""

_OPTION = re.compile(r'<(net-file|route-files|additional-files|fcd-output\.geo)\s+value="([^"]*)"')

_LEAVES_OUT = re.compile(
    r"<(fcd-output\.filter-[a-z.-]+|(?:person-)?device\.fcd\.(?:probability|explicit|radius)"
    r"|person-fcd-output)\s+value="
)
"""Options with which floating-car data have a part of the traffic only."""


@dataclass(frozen=True, slots=True)
class FcdHead:
    """SUMO's configuration, a comment at the head of its output.

    ``leaves_out``: the options by which some of the traffic is not in the data.
    """

    net: str = ""
    demand: tuple[str, ...] = ()
    additional: tuple[str, ...] = ()
    geographic: bool = False
    leaves_out: tuple[str, ...] = ()


def _unescaped(text: str) -> str:
    if "&" not in text:
        return text
    # The names of all characters of HTML, 3 ms: few paths have one.
    from html import unescape

    return unescape(text)


def fcd_head(comment: str) -> FcdHead:
    """The configuration in a comment, as far as it matters here."""
    options = {name: _unescaped(value) for name, value in _OPTION.findall(comment)}
    routes, additional = (
        tuple(filter(None, map(str.strip, options.get(key, "").split(","))))
        for key in ("route-files", "additional-files")
    )
    return FcdHead(
        options.get("net-file", ""),
        (*routes, *additional),
        additional,
        options.get("fcd-output.geo") in ("true", "1", "yes", "on"),
        tuple(sorted(set(_LEAVES_OUT.findall(comment)))),
    )


@dataclass(slots=True)
class FcdTrack:
    """The track of a participant in rows of floating-car data: x, y, angle and speed.

    ``moments`` are indices into those of the file.
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

    ``moments`` are times in microseconds, ``on`` the lanes and edges that are named.
    """

    head: FcdHead = field(default_factory=FcdHead)
    moments: list[int] = field(default_factory=list)
    tracks: dict[str, FcdTrack] = field(default_factory=dict)
    on: dict[str, tuple[str, int]] = field(default_factory=dict)
