"""Reads uniformly written elements of floating-car data as columns, directly from their bytes.

Lines of one kind have the same text between their values, so only the first line of each kind goes
through an XML parser. Other lines are compared with it, and their values are converted together.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from xml.parsers.expat import ParserCreate

import numpy as np
from numpy import float64, intp
from numpy.typing import NDArray

from rulec.recordings.encodings.xml_element import LARGEST, number_in
from rulec.recordings.sumo.fcd_content import BODIES, PLACE, SPEED
from rulec.trace.formats.byte_words import (
    BYTES,
    Bytes,
    Places,
    begin_with,
    short_decimals,
    words_for,
    words_from,
)

PADDING = 1 << 10
"""Bytes needed behind the last line; longer names or pieces of lines are left to the XML parser."""

N_NUMBERS = 5
_NUMBERS = (*PLACE, SPEED, "acceleration")
_EVERY = frozenset({"id", *PLACE})
"""The attributes that each element has."""

_MOST_KINDS = 1 << 6
_MINUS = ord("-")
_ODD = np.uint64(0x9E3779B97F4A7C15)
"""A multiplier for hashing, from the digits of the golden ratio."""

_MASKS = np.array([(1 << 8 * n) - 1 for n in range(BYTES + 1)], dtype=np.uint64)
"""Masks for the first n bytes of a word, by n."""


class NotPlainError(Exception):
    """The file has to be read by an XML parser."""


@dataclass(frozen=True, slots=True)
class _Kind:
    """Elements with the same ``name``, and the same text ``between`` their attributes' values.

    ``at`` has the position of each attribute; ``on``, lane or edge, is the one that gives the
    place.
    """

    name: str
    on: str
    at: dict[str, int]
    between: tuple[bytes, ...]


KnownKinds = dict[int, list[_Kind]]
"""The kinds of elements found so far in a file, by their number of quotation marks."""


@dataclass(frozen=True, eq=False, slots=True)
class TextPlaces:
    """Where texts begin and end in a byte array, which is padded at its end."""

    text: Bytes
    begins: Places
    ends: Places

    def __getitem__(self, number: int) -> str:
        """A text by its number."""
        return self.text[self.begins[number] : self.ends[number]].tobytes().decode("ascii")

    def part(self, members: NDArray[intp]) -> TextPlaces:
        """The texts with these numbers."""
        return TextPlaces(self.text, self.begins[members], self.ends[members])


@dataclass(frozen=True, eq=False, slots=True)
class Elements:
    """The elements of several lines, in columns.

    ``named`` are indices into ``names``, and ``owners`` into ``keys``. Keys are in the order of
    their first element, whose type is in ``types``. ``rows`` are the numbers, NaN for a missing
    speed or acceleration. ``on`` maps each lane or edge to which of the two it is, and its first
    element; ``lamps`` maps elements to bits.
    """

    names: Sequence[str]
    named: NDArray[intp]
    keys: Sequence[str]
    types: Sequence[str]
    owners: NDArray[intp]
    rows: NDArray[float64]
    on: dict[str, tuple[str, int]]
    lamps: dict[int, int]


def read_elements(lines: TextPlaces, quotes: Places, bounds: Places, kinds: KnownKinds) -> Elements:
    """Read lines; the quotation marks of each lie between its ``bounds``, and may differ in number.

    Raises NotPlainError, ValueError, or expat's errors.
    """
    count = len(lines.begins)
    columns = {key: (np.zeros(count, intp), np.zeros(count, intp)) for key in ("id", "type", "on")}
    rows = np.full((count, N_NUMBERS), np.nan)
    names: dict[str, int] = {}
    named, is_lane, lamps = np.zeros(count, intp), np.zeros(count, bool), dict[int, int]()
    for kind, members, marks in _by_kind(lines, quotes, bounds, kinds):
        named[members] = names.setdefault(kind.name, len(names))
        is_lane[members] = kind.on == "lane"
        for key, (begins, ends) in columns.items():
            place = kind.at.get(kind.on if key == "on" else key)
            if place is not None:
                begins[members], ends[members] = marks[2 * place] + 1, marks[2 * place + 1]
        for n, key in enumerate((*_NUMBERS, "signals")):
            if key in kind.at:
                place = 2 * kind.at[key]
                values = _numbers(TextPlaces(lines.text, marks[place] + 1, marks[place + 1]))
                is_number = np.abs(values) < LARGEST  # False for NaN
                if key == "acceleration":
                    values[~is_number] = np.nan
                elif not is_number.all():
                    raise NotPlainError
                if key == "signals":
                    lamps.update(zip(members.tolist(), map(int, values.tolist()), strict=True))
                else:
                    rows[members, n] = values
    keys, types, places = (TextPlaces(lines.text, *columns[key]) for key in ("id", "type", "on"))
    firsts, owners = _distinct_texts(keys)
    on = {
        places[n]: ("lane" if is_lane[n] else "edge", n)
        for n in _distinct_texts(places)[0].tolist()
        if places.begins[n] < places.ends[n]
    }
    own = firsts.tolist()
    keys_of, types_of = ([texts[n] for n in own] for texts in (keys, types))
    return Elements(list(names), named, keys_of, types_of, owners, rows=rows, on=on, lamps=lamps)


def _by_kind(
    lines: TextPlaces, quotes: Places, bounds: Places, kinds: KnownKinds
) -> Iterator[tuple[_Kind, NDArray[intp], Places]]:
    """For each kind, its members and the positions of their quotation marks (first axis)."""
    counts = np.diff(bounds)
    for count in np.flatnonzero(np.bincount(counts)).tolist():
        members = np.flatnonzero(counts == count)
        marks = quotes[bounds[members] + np.arange(count)[:, None]]
        known = kinds.setdefault(count, [])
        tried = 0
        while len(members):
            if tried == len(known):
                if tried == _MOST_KINDS:
                    raise NotPlainError
                known.append(_kind(lines[int(members[0])]))
            fits = _fit(known[tried], lines.part(members), marks)
            if fits.any():
                yield known[tried], members[fits], marks[:, fits]
                members, marks = members[~fits], marks[:, ~fits]
            tried += 1


def _fit(kind: _Kind, lines: TextPlaces, marks: Places) -> NDArray[np.bool_]:
    """Mask of the lines that are of a kind."""
    fit = np.ones(len(lines.begins), dtype=bool)
    begins = [lines.begins, *(marks[1::2] + 1)]
    for part, begin, end in zip(kind.between, begins, [*marks[::2], lines.ends], strict=True):
        fit &= end - begin == len(part)
        fit &= begin_with(words_from(lines.text, begin, words_for(len(part))), part)
    return fit


def _kind(line: str) -> _Kind:
    """The kind of an element's line, as an XML parser reads it."""
    elements: list[tuple[str, list[str]]] = []
    parser = ParserCreate()
    parser.ordered_attributes = True
    parser.StartElementHandler = lambda name, attributes: elements.append((name, attributes))
    parser.Parse(line.encode(), True)
    ((name, attributes),) = elements
    pieces, names = line.split('"'), attributes[::2]
    if "vehicle" in names or name not in BODIES or attributes[1::2] != pieces[1::2]:
        raise NotPlainError
    if not set(names) >= _EVERY or {"lane", "edge"} <= set(names):
        raise NotPlainError
    between = tuple([part.encode() for part in pieces[::2]])
    if max(map(len, between)) > PADDING:
        raise NotPlainError
    on = "lane" if "lane" in names else "edge"
    return _Kind(name, on, {key: place for place, key in enumerate(names)}, between)


def _numbers(texts: TextPlaces) -> NDArray[float64]:
    """The numbers in texts. Raises ValueError for a text that is not a number."""
    is_minus = texts.text[texts.begins] == _MINUS
    begins = texts.begins + is_minus
    lengths = texts.ends - begins
    is_short = (lengths > 0) & (lengths <= BYTES)
    words = words_from(texts.text, begins, 1)[:, 0]
    values, is_read = short_decimals(words, lengths.clip(1, BYTES))
    np.negative(values, out=values, where=is_minus)
    for n in np.flatnonzero(~(is_read & is_short)).tolist():
        values[n] = number_in(texts[n])
    return values


def _distinct_texts(texts: TextPlaces) -> tuple[NDArray[intp], NDArray[intp]]:
    """The first occurrence of each distinct text, in order, and the index of each text's in these.

    Equal texts are found by a hash of their words, and then compared.
    """
    lengths = texts.ends - texts.begins
    longest = int(lengths.max())
    if longest > PADDING:
        raise NotPlainError
    words = words_from(texts.text, texts.begins, words_for(longest))
    for place in range(words.shape[1]):
        words[:, place] &= _MASKS[(lengths - BYTES * place).clip(0, BYTES)]
    sums = lengths.astype(np.uint64)
    for own in words.T:
        sums = (sums ^ own) * _ODD
        sums ^= sums >> np.uint64(32)
    order = np.argsort(sums, kind="stable")
    ascending = sums[order]
    is_new = np.ones(len(sums), dtype=bool)
    np.not_equal(ascending[1:], ascending[:-1], out=is_new[1:])
    firsts = order[is_new]
    like = np.empty(len(sums), dtype=intp)
    like[order] = np.cumsum(is_new) - 1
    same = firsts[like]
    if (lengths != lengths[same]).any() or (words != words[same]).any():
        raise NotPlainError  # different texts with the same hash
    by_place = np.argsort(firsts)
    ranks = np.empty(len(firsts), dtype=intp)
    ranks[by_place] = np.arange(len(firsts))
    return firsts[by_place], ranks[like]
