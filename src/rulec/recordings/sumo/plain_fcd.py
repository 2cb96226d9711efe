"""Floating-car data as SUMO writes them: an element a line, which need no parser of XML.

A line is parted at its quotation marks. What stands between the values of one line stands in all
of its kind, so that a parser has to look at the first of them only, and texts become numbers many
at once. Whatever is not so plain is left to who reads all XML, and says what is wrong with it.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field
from itertools import chain
from operator import itemgetter
from pathlib import Path
from xml.parsers.expat import ExpatError, ParserCreate

import numpy as np
from numpy import float64, intp
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.files import opened
from rulec.recordings.encodings.xml_element import LARGEST
from rulec.recordings.sumo.fcd_content import (
    BODIES,
    FCD,
    LONGEST_ID,
    MICROSECONDS,
    FcdTrack,
    FloatingCarData,
    fcd_head,
)

_BLOCK = 1 << 18
_PRINTABLE = bytes(range(0x20, 0x7F))
_ATTRIBUTES = ("id", "x", "y", "angle", "speed", "acceleration", "type", "signals")
_N_NUMBERS = 5
"""So many of these, behind the first one, are numbers; all but the last one every element has."""

_STEP, _STEP_ENDS = "<timestep time=", "</timestep>"


class _NotPlainError(Exception):
    """Something has to be read as XML is."""


@dataclass(frozen=True, slots=True)
class _Kind:
    """Lines with the same text between the same attributes.

    ``take`` gives the wanted values, and the lane or edge, of a line's pieces, behind which are the
    texts for what is missing if it ``lacks`` one.
    """

    name: str
    on: str
    take: Callable[[list[str]], tuple[str, ...]]
    lacks: bool


_FOR_MISSING = (_NO_SIGNALS := "\n", "nan", "")


def read_plain_fcd(path: Path) -> FloatingCarData | None:
    """The file's content; None if it is not plain, or cannot be read."""
    if not path.is_file():
        return None  # what comes through a pipe can be read only once
    blocks = _blocks(path)
    try:
        head, rest = _parted(next(blocks, b""))
        data = FloatingCarData()
        _read_head(head, data)
        reader = _Lines(data, head.count(b"\n"))
        reader.read(rest)
        for block in blocks:
            reader.read(block)
    except (_NotPlainError, RulecError, ExpatError, ArithmeticError, LookupError, ValueError):
        return None
    finally:
        blocks.close()
    return data if reader.has_ended else None


def _blocks(path: Path) -> Generator[bytes, None, None]:
    """The bytes of a file, unpacked, in blocks of whole lines."""
    rest, size = b"", 0
    with opened(path) as stream:
        while block := stream.read(_BLOCK):
            size += len(block)
            whole, end, after = block.rpartition(b"\n")
            if size > FCD.largest_bytes or not end:
                raise _NotPlainError
            yield rest + whole + end
            rest = after
    if rest:
        raise _NotPlainError


def _parted(block: bytes) -> tuple[bytes, bytes]:
    """What stands before the first moment, and the rest."""
    at = block.find(b"<timestep")
    at = block.rfind(b"\n", 0, at) + 1 if at > 0 else 0
    if not at:
        raise _NotPlainError
    return block[:at], block[at:]


def _read_head(head: bytes, data: FloatingCarData) -> None:
    """Read the comments in a file's head. Raises what expat does if it is not well-formed."""
    names: list[str] = []

    def comment(text: str) -> None:
        if "<" in text:
            data.head = fcd_head(text)

    def definition(*_: object) -> None:
        raise _NotPlainError

    parser = ParserCreate()
    parser.StartElementHandler = lambda name, _: names.append(name)
    parser.StartDoctypeDeclHandler = definition
    parser.CommentHandler = comment
    parser.Parse(head + f"</{FCD.root}>".encode(), True)
    if names != [FCD.root]:
        raise _NotPlainError


class _Lines:
    """What is known of a file after some of its lines, of which so many came before."""

    def __init__(self, data: FloatingCarData, n_lines: int) -> None:
        self.data = data
        self.has_ended = False
        self._n_lines = n_lines
        self._is_in_step = False
        self._kinds: dict[tuple[str, ...], _Kind] = {}

    def read(self, block: bytes) -> None:
        """Read whole lines. Raises _NotPlainError, or KeyError or ValueError."""
        if block.translate(None, _PRINTABLE).strip(b"\n"):
            raise _NotPlainError
        text = block.decode("ascii")
        lines = text.split("\n")[:-1]
        # One in each line is a tag's: none is in a value
        if "&" in text or text.count("<") != len(lines):
            raise _NotPlainError
        known, found, others = self._kinds, _Elements(len(self.data.moments)), list[int]()
        for line in lines:
            pieces = line.split('"')
            kind = known.get(tuple(pieces[::2]))
            if kind is None:
                n_moments = len(self.data.moments)
                kind = self._other(line, pieces)
                if kind is None:
                    others.append(len(found.kinds))
                    if len(self.data.moments) > n_moments:
                        found.steps.append(len(found.kinds))
                    continue
            if not self._is_in_step:
                raise _NotPlainError
            if kind.lacks:
                pieces += _FOR_MISSING
            found.kinds.append(kind)
            found.values.append(kind.take(pieces))
        if found.kinds:
            places = found.add_to(self.data)
            for place, k in places.items():
                line_number = self._n_lines + k + bisect_right(others, k) + 1
                self.data.on[place] = found.kinds[k].on, line_number
        self._n_lines += len(lines)

    def _other(self, line: str, pieces: list[str]) -> _Kind | None:
        """The kind of the first line of its kind; None where a moment begins or ends."""
        if self.has_ended:
            raise _NotPlainError
        if pieces[0].lstrip(" ") == _STEP and pieces[2:] in ([">"], ["/>"]):
            moment = round(float(pieces[1]) * MICROSECONDS)
            known = self.data.moments
            if self._is_in_step or (known and moment <= known[-1]):
                raise _NotPlainError
            if not abs(moment) < LARGEST * MICROSECONDS:
                raise _NotPlainError
            known.append(moment)
            self._is_in_step = pieces[2] == ">"
            return None
        if line.strip(" ") == _STEP_ENDS and self._is_in_step:
            self._is_in_step = False
            return None
        if line == f"</{FCD.root}>" and not self._is_in_step:
            self.has_ended = True
            return None
        kind = self._kinds[tuple(pieces[::2])] = _kind(line, pieces)
        return kind


@dataclass(slots=True)
class _Elements:
    """The elements of some lines: the kind and the wanted ``values`` of each.

    ``steps`` are the numbers of the first one of each moment, of which so many came before.
    """

    n_moments: int
    kinds: list[_Kind] = field(default_factory=list)
    values: list[tuple[str, ...]] = field(default_factory=list)
    steps: list[int] = field(default_factory=list)

    def add_to(self, data: FloatingCarData) -> dict[str, int]:
        """Add them to tracks; the lanes and edges that are new, and by which element.

        Raises _NotPlainError, or ValueError.
        """
        keys, *numbers, types, lamps, places = zip(*self.values, strict=True)
        moments = np.searchsorted(self.steps, np.arange(len(keys)), "right") + self.n_moments - 1
        whose = {key: number for number, key in enumerate(dict.fromkeys(keys))}
        if len({(key, kind.name) for key, kind in zip(keys, self.kinds, strict=True)}) > len(whose):
            raise _NotPlainError
        which = np.fromiter(map(whose.__getitem__, keys), intp, len(keys))
        order = np.argsort(which, kind="stable")
        at, rows = moments[order], _rows(numbers)[order]
        bounds = np.append(np.flatnonzero(np.diff(which[order], prepend=-1)), len(keys)).tolist()
        for key, start, end in zip(whose, bounds[:-1], bounds[1:], strict=True):
            own, name = at[start:end], self.kinds[order[start]].name
            if key not in data.tracks:
                data.tracks[key] = FcdTrack(name, types[order[start]])
            track = data.tracks[key]
            is_twice = not np.diff(own).all() or track.moments[-1:].tolist() == [own[0]]
            if is_twice or track.element != name or not 0 < len(key) <= LONGEST_ID:
                raise _NotPlainError
            track.moments.frombytes(own.tobytes())
            track.rows.frombytes(rows[start:end, :-1].tobytes())
            track.accelerations.frombytes(rows[start:end, -1].tobytes())
        if lamps.count(_NO_SIGNALS) < len(lamps):
            for key, bits, moment in zip(keys, lamps, moments.tolist(), strict=True):
                if bits != _NO_SIGNALS:
                    data.tracks[key].lamps[moment] = int(_number(bits))
        return {
            place: places.index(place)
            for place in dict.fromkeys(places)
            if place and place not in data.on
        }


def _rows(texts: Sequence[Sequence[str]]) -> NDArray[float64]:
    """The numbers of elements, a row each, of columns of texts."""
    numbers = np.fromiter(map(float, chain(*texts)), float, _N_NUMBERS * len(texts[0]))
    columns = numbers.reshape(_N_NUMBERS, -1)
    is_known = np.abs(columns) < LARGEST  # NaN is not
    if not is_known[:-1].all():
        raise _NotPlainError
    columns[-1][~is_known[-1]] = np.nan
    rows: NDArray[float64] = columns.T
    return rows


def _number(text: str) -> float:
    value = float(text)
    if not abs(value) < LARGEST:
        raise _NotPlainError
    return value


def _kind(line: str, pieces: list[str]) -> _Kind:
    """The kind of an element's line, as a parser understands it."""
    found: list[tuple[str, list[str]]] = []
    parser = ParserCreate()
    parser.ordered_attributes = True
    parser.StartElementHandler = lambda name, attributes: found.append((name, attributes))
    parser.Parse(line.encode(), True)
    ((name, attributes),) = found
    names = attributes[::2]
    at = {key: 2 * number + 1 for number, key in enumerate(names)}
    rides = "vehicle" in names
    if rides or name not in BODIES or attributes[1::2] != pieces[1::2]:
        raise _NotPlainError
    if not set(_ATTRIBUTES[:_N_NUMBERS]) <= set(names) or {"lane", "edge"} <= set(names):
        raise _NotPlainError
    on = "lane" if "lane" in names else "edge"
    empty = {"signals": -3, "acceleration": -2}
    take = itemgetter(*(at.get(key, empty.get(key, -1)) for key in (*_ATTRIBUTES, on)))
    return _Kind(name, on, take, lacks=not {*_ATTRIBUTES, on} <= set(names))
