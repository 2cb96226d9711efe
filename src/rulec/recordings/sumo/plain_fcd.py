"""Reads floating-car data as SUMO writes them, one element per line, without an XML parser.

All lines are split at their quotation marks at once. Files written otherwise, or with errors, are
left to the reader of general XML, which reports the errors.
"""

from __future__ import annotations

from collections.abc import Generator
from pathlib import Path
from xml.parsers.expat import ExpatError, ParserCreate

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.files.read_files import opened
from rulec.recordings.encodings.xml_element import LARGEST, number_in
from rulec.recordings.sumo.fcd_content import (
    FCD,
    LONGEST_ID,
    MICROSECONDS,
    FcdTrack,
    FloatingCarData,
    fcd_head,
)
from rulec.recordings.sumo.plain_elements import (
    PADDING,
    Elements,
    KnownKinds,
    NotPlainError,
    TextPlaces,
    read_elements,
)

_BLOCK = 1 << 20
_PRINTABLE = bytes(range(0x20, 0x7F))

_STEP, _STEP_ENDS = "<timestep time=", "</timestep>"
_MOST_OF_STEPS = 2
"""The most quotation marks in a line that begins or ends a time step; others are elements."""


def read_plain_fcd(path: Path) -> FloatingCarData | None:
    """The file's content; None if it is not in this plain form or cannot be read."""
    if not path.is_file():
        return None  # a pipe can be read only once
    blocks = _blocks(path)
    try:
        head, rest = _parted(next(blocks, b""))
        data = FloatingCarData()
        _read_head(head, data)
        reader = _Lines(data, head.count(b"\n"))
        reader.read(rest)
        for block in blocks:
            reader.read(block)
    except (NotPlainError, RulecError, ExpatError, ArithmeticError, LookupError, ValueError):
        return None
    finally:
        blocks.close()
    return data if reader.has_ended else None


def _blocks(path: Path) -> Generator[bytes, None, None]:
    """The unpacked bytes of a file in blocks of whole lines."""
    rest, size = b"", 0
    with opened(path) as stream:
        while block := stream.read(_BLOCK):
            size += len(block)
            whole, end, after = block.rpartition(b"\n")
            if size > FCD.largest_bytes or not end:
                raise NotPlainError
            yield rest + whole + end
            rest = after
    if rest:
        raise NotPlainError


def _parted(block: bytes) -> tuple[bytes, bytes]:
    """The text before the first moment, and the rest."""
    at = block.find(b"<timestep")
    at = block.rfind(b"\n", 0, at) + 1 if at > 0 else 0
    if not at:
        raise NotPlainError
    return block[:at], block[at:]


def _read_head(head: bytes, data: FloatingCarData) -> None:
    """Read the comments in a file's head. Raises expat's error if it is not well-formed."""
    names: list[str] = []

    def comment(text: str) -> None:
        if "<" in text:
            data.head = fcd_head(text)

    def definition(*_: object) -> None:
        raise NotPlainError

    parser = ParserCreate()
    parser.StartElementHandler = lambda name, _: names.append(name)
    parser.StartDoctypeDeclHandler = definition
    parser.CommentHandler = comment
    parser.Parse(head + f"</{FCD.root}>".encode(), True)
    if names != [FCD.root]:
        raise NotPlainError


class _Lines:
    """The state of reading a file line by line, after ``n_lines`` lines of its head."""

    def __init__(self, data: FloatingCarData, n_lines: int) -> None:
        self.data = data
        self.has_ended = False
        self._n_lines = n_lines
        self._is_in_step = False
        self._kinds: KnownKinds = {}

    def read(self, block: bytes) -> None:
        """Read whole lines. Raises NotPlainError, ValueError, or expat's errors."""
        if not block:
            return
        if b"&" in block or block.translate(None, _PRINTABLE).strip(b"\n"):
            raise NotPlainError
        text = np.frombuffer(block + bytes(PADDING), np.uint8)
        ends = np.flatnonzero(text == ord("\n"))
        # Each line has one `<`, that of its tag, so that none is in a value
        if block.count(b"<") != len(ends):
            raise NotPlainError
        lines = TextPlaces(text, np.append(0, ends[:-1] + 1), ends)
        quotes = np.flatnonzero(text == ord('"'))
        bounds = np.append(0, np.searchsorted(quotes, ends))
        counts = np.diff(bounds)
        borders = np.flatnonzero(counts <= _MOST_OF_STEPS)
        n_moments, is_in_step = [len(self.data.moments)], [self._is_in_step]
        for number in borders.tolist():
            self._pass(lines[number])
            n_moments.append(len(self.data.moments))
            is_in_step.append(self._is_in_step)
        others = np.flatnonzero(counts > _MOST_OF_STEPS)
        if len(others):
            behind = np.searchsorted(borders, others)
            if not np.take(is_in_step, behind).all():
                raise NotPlainError
            # Leaves out the few quotation marks of lines without elements, too
            own = np.repeat(counts > _MOST_OF_STEPS, counts)
            elements = read_elements(
                lines.part(others),
                quotes[own],
                np.append(0, np.cumsum(counts[others])),
                self._kinds,
            )
            _add(self.data, elements, np.take(n_moments, behind) - 1)
            for place, (kind, number) in elements.on.items():
                if place not in self.data.on:
                    self.data.on[place] = kind, self._n_lines + int(others[number]) + 1
        self._n_lines += len(ends)

    def _pass(self, line: str) -> None:
        """Handle a line that begins or ends a time step, or ends the file."""
        if self.has_ended:
            raise NotPlainError
        pieces = line.split('"')
        if pieces[0].lstrip(" ") == _STEP and pieces[2:] in ([">"], ["/>"]):
            moment = round(number_in(pieces[1]) * MICROSECONDS)
            known = self.data.moments
            if self._is_in_step or (known and moment <= known[-1]):
                raise NotPlainError
            if not abs(moment) < LARGEST * MICROSECONDS:
                raise NotPlainError
            known.append(moment)
            self._is_in_step = pieces[2] == ">"
        elif line.strip(" ") == _STEP_ENDS and self._is_in_step:
            self._is_in_step = False
        elif line == f"</{FCD.root}>" and not self._is_in_step:
            self.has_ended = True
        else:
            raise NotPlainError


def _add(data: FloatingCarData, new: Elements, moments: NDArray[intp]) -> None:
    """Add elements to their tracks. Raises NotPlainError."""
    order = np.argsort(new.owners.astype(np.uint32), kind="stable")
    at, rows, named = moments[order], new.rows[order], new.named[order]
    bounds = np.searchsorted(new.owners[order], np.arange(len(new.keys) + 1)).tolist()
    for number, (key, start, end) in enumerate(zip(new.keys, bounds, bounds[1:], strict=False)):
        own, name = at[start:end], new.names[named[start]]
        if key not in data.tracks:
            data.tracks[key] = FcdTrack(name, new.types[number])
        track = data.tracks[key]
        is_twice = not np.diff(own).all() or track.moments[-1:].tolist() == [own[0]]
        are_others = track.element != name or (named[start:end] != named[start]).any()
        if is_twice or are_others or not 0 < len(key) <= LONGEST_ID:
            raise NotPlainError
        track.moments.frombytes(own.tobytes())
        track.rows.frombytes(rows[start:end, :-1].tobytes())
        track.accelerations.frombytes(rows[start:end, -1].tobytes())
    for number, bits in new.lamps.items():
        data.tracks[new.keys[new.owners[number]]].lamps[int(moments[number])] = bits
