"""Traces in JSON lines whose states are written alike, read together as columns.

Most programs write all states of a trace with the same names in the same order; only values differ.
The text between values is compared with that of the previous state, for all states at once, and
values are read from where they must be. Other lines are left to be decoded one by one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias, overload

import msgspec
import numpy as np
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.trace.formats.byte_columns import (
    PADDING,
    Bytes,
    Places,
    bytes_from,
    column_words,
    end_as_before,
    read_values,
    words_for,
)
from rulec.trace.formats.json_values import BOUNDS
from rulec.trace.formats.table_blocks import Coded, Column, Numbers
from rulec.trace.trace_model import Ending, Trace

FEWEST_STATES = 32
"""With fewer states of one form, reading them together does not pay."""

_STYLES = ((b", ", b": "), (b",", b":"))
"""What separates members, and a name from its value."""

_END = b"\0"
"""A byte that no JSON contains."""

_DECODE = msgspec.json.Decoder(dict[str, Any]).decode

ColumnPath: TypeAlias = tuple[str, tuple[int, ...]]
"""A name, and the indices of the objects it is about among the trace's objects."""


HeadingReader: TypeAlias = Callable[[bytes], tuple[str, float, Mapping[str, str], Ending] | None]
"""Reads a trace's name, step (s), objects and end from a line without states; None if it has more.
"""


@dataclass(frozen=True, slots=True)
class LineHeading:
    """What a line contains besides its states; the objects are present all the time."""

    id: str
    step_s: float
    objects: Mapping[str, str]
    ends: Ending


@dataclass(frozen=True, slots=True, eq=False)
class AlikeLines:
    """Traces that have the same end and columns, except for the names of objects.

    ``lines`` are the indices of their lines, ``lengths`` their numbers of states, ``headings`` what
    else the lines contain. ``columns`` hold the states of one trace after another, in this order;
    ``names`` are all names in these, also those without a value.
    """

    lines: Places
    lengths: NDArray[np.int64]
    headings: Sequence[LineHeading]
    columns: Mapping[ColumnPath, Column]
    names: frozenset[str]


def placed_among(places: Mapping[int, int], alike: AlikeLines, first: int) -> AlikeLines:
    """The traces with items' indices for lines; one without a name is named by its line number.

    ``first`` is the number of the first line.
    """
    indices = alike.lines.tolist()
    headings = [
        heading if heading.id else replace(heading, id=f"line {first + index}")
        for index, heading in zip(indices, alike.headings, strict=True)
    ]
    return replace(alike, lines=np.array([places[index] for index in indices]), headings=headings)


@dataclass(frozen=True, slots=True, eq=False)
class LineBlock(Sequence["Trace | RulecError"]):
    """The traces of some lines; those in ``alike`` are only decoded when asked for.

    ``items`` has None for these, and ``decode`` decodes the one at an index. The ``lines`` of each
    of ``alike`` are indices of items.
    """

    items: Sequence[Trace | RulecError | None]
    decode: Callable[[int], Trace | RulecError]
    alike: Sequence[AlikeLines]

    def __len__(self) -> int:
        return len(self.items)

    @overload
    def __getitem__(self, place: int) -> Trace | RulecError: ...
    @overload
    def __getitem__(self, place: slice) -> list[Trace | RulecError]: ...
    def __getitem__(self, place: int | slice) -> Trace | RulecError | list[Trace | RulecError]:
        if isinstance(place, slice):
            return [self[index] for index in range(len(self))[place]]
        item = self.items[place]
        return self.decode(range(len(self))[place]) if item is None else item


@dataclass(frozen=True, slots=True)
class _Form:
    """How a state is written: the text before each of its values and after the last.

    ``text`` joins these, with ``_END`` for each value and ``%s`` for the names of objects
    ``named``.
    """

    comma: bytes
    text: bytes
    named: tuple[int, ...]
    paths: tuple[ColumnPath, ...]
    n_quotes: int
    names: frozenset[str]

    def between(self, names: Sequence[bytes]) -> tuple[bytes, ...]:
        """The text before each value and before the next state, for objects of these names."""
        return tuple((self.text % tuple([names[place] for place in self.named])).split(_END))


@dataclass(frozen=True, slots=True)
class _Outline:
    """A line with its ``states`` as bytes, and the text between their values."""

    line: int
    heading: LineHeading
    states: memoryview
    form: _Form
    between: tuple[bytes, ...]


def alike_lines(lines: Sequence[bytes], heading_of: HeadingReader) -> Iterator[AlikeLines]:
    """The lines that can be read together, grouped by form; blank ones are none."""
    kinds: dict[tuple[object, ...], list[_Outline]] = {}
    form: _Form | None = None
    for number, line in enumerate(lines):
        if not line or line.isspace():
            continue
        outline = _outlined(number, line, heading_of, form)
        if outline is None:
            continue
        form, heading = outline.form, outline.heading
        types = tuple(heading.objects.values())
        written = form.text, form.named, tuple(map(len, outline.between))
        kinds.setdefault((heading.step_s, heading.ends, types, *written), []).append(outline)
    for outlines in kinds.values():
        together = _together(outlines)
        if together is not None:
            yield together


def _outlined(
    number: int,
    line: bytes,
    heading_of: HeadingReader,
    usual: _Form | None,
) -> _Outline | None:
    """A line's outline, whose first state probably has the ``usual`` form; None if irregular."""
    styles = _STYLES if usual is None or usual.comma == _STYLES[0][0] else _STYLES[::-1]
    places = ((line.find(b'"states"' + colon + b"["), comma, colon) for comma, colon in styles)
    begin, comma, colon = next((place for place in places if place[0] >= 0), (-1, b"", b""))
    if begin < 0:
        return None
    begin = line.index(b"[", begin) + 1
    end = line.rfind(b"}]") + 1
    if end <= begin or line.find(b"\\", begin, end) >= 0:
        return None
    read = heading_of(line[:begin] + line[end:])
    if read is None:
        return None
    heading = LineHeading(*read)
    if not BOUNDS.isdisjoint(heading.objects):
        return None
    names = [name.encode(errors="surrogatepass") for name in heading.objects]
    if any(b":" in name or b'"' in name for name in names):
        return None
    first = line[begin : line.find(b"}" + comma + b"{", begin, end) + 1 or end]
    form = usual
    if form is None or form.comma != comma or form.n_quotes != first.count(b'"'):
        form = _form_of(first, comma, colon, heading.objects)
    if form is None or any(place >= len(names) for place in form.named):
        return None
    # A view: states are most of a line, and joining them copies them anyway.
    states = memoryview(line)[begin:end]
    return _Outline(number, heading, states, form, form.between(names))


def _form_of(first: bytes, comma: bytes, colon: bytes, objects: Mapping[str, str]) -> _Form | None:
    """How a state is written; None if it is irregular."""
    try:
        state = _DECODE(first)
    except (ValueError, RecursionError):  # msgspec's and Unicode's errors are ValueErrors
        return None
    parts = _Parts(comma, colon, {name: place for place, name in enumerate(objects)})
    if not parts.add_state(state) or not parts.paths:
        return None
    form = _Form(
        comma=comma,
        text=bytes(parts.text + comma),
        named=tuple(parts.named),
        paths=tuple(parts.paths),
        n_quotes=first.count(b'"'),
        names=frozenset(state),
    )
    place, whole = 0, first + comma
    for part in form.between([name.encode(errors="surrogatepass") for name in objects]):
        place = whole.find(part, place)
        if place < 0:
            return None  # it is written in some other style
    return form


class _Parts:
    """The text between the values of a state that is written in a given style."""

    def __init__(self, comma: bytes, colon: bytes, places: Mapping[str, int]) -> None:
        self.text = bytearray()  # grows in place: a state may have any number of names
        self.paths: list[ColumnPath] = []
        self.named: list[int] = []
        self._comma, self._colon = comma, colon
        self._places = places

    def add_state(self, state: Mapping[str, Any]) -> bool:
        """Add the parts of a state; False if it is irregular."""
        self.text += b"{"
        for number, (name, value) in enumerate(state.items()):
            if ":" in name or '"' in name:
                return False
            own = name.encode(errors="surrogatepass").replace(b"%", b"%%")
            self.text += self._comma * (number > 0) + b'"' + own + b'"' + self._colon
            if not self._add(name, (), value):
                return False
        self.text += b"}"
        return True

    def _add(self, name: str, items: tuple[int, ...], value: Any) -> bool:
        if type(value) is not dict:
            self.text += _END
            self.paths.append((name, items))
            return value is not None and type(value) is not list
        self.text += b"{"
        for number, (item, inner) in enumerate(value.items()):
            if item not in self._places:
                return False
            self.named.append(self._places[item])
            self.text += self._comma * (number > 0) + b'"%s"' + self._colon
            if not self._add(name, (*items, self._places[item]), inner):
                return False
        self.text += b"}"
        return True


def _together(outlines: Sequence[_Outline]) -> AlikeLines | None:
    """The lines whose states are all written alike; None if they have too few states."""
    form, between = outlines[0].form, outlines[0].between
    colons_before = np.cumsum([part.count(b":") for part in between])
    n_colons = int(colons_before[-1])
    text, colons, ends = _joined(outlines, form.comma)
    counts = np.diff(np.searchsorted(colons, ends), prepend=0)
    are_whole = (counts % n_colons == 0) & (counts > 0)
    if text.min() < _FIRST_IN_JSON:
        are_whole[np.searchsorted(ends, np.flatnonzero(text < _FIRST_IN_JSON), "right")] = False
    if not are_whole.all():
        outlines = [outlines[place] for place in np.flatnonzero(are_whole).tolist()]
        counts = counts[are_whole]
        text, colons, ends = _joined(outlines, form.comma)
    lengths = counts // n_colons
    if lengths.sum() < FEWEST_STATES:
        return None
    line_of = np.repeat(np.arange(len(outlines)), lengths)
    first = np.cumsum(lengths) - lengths
    # A value begins after the last colon of the text before it.
    behind = len(between[0]) - between[0].rindex(b":")
    begins = colons.reshape(-1, n_colons)[:, colons_before[:-1] - 1] + behind
    heads = begins[:, 0] - len(between[0])
    next_heads = np.append(heads[1:], 0)
    next_heads[first + lengths - 1] = ends
    befores = [*(begins - [len(part) for part in between[:-1]]).T, next_heads - len(between[-1])]
    fits = np.ones(len(line_of), dtype=bool)
    fits[first] = heads[first] == np.append(PADDING, ends[:-1])
    is_first = np.zeros(len(line_of), dtype=bool)
    is_first[first] = True
    columns = {}
    paths: list[ColumnPath | None] = [*form.paths, None]
    for place, (path, before) in enumerate(zip(paths, befores, strict=True)):
        # One access reads the text between two values and the value after it.
        width = len(between[place])
        starts = before + width
        stops = starts if path is None else befores[place + 1]
        n_between = words_for(width)
        words = column_words(text, starts, np.maximum(stops, starts + 1), n_between)
        fits[1:] &= end_as_before(words[:, :n_between], width) | is_first[1:]
        parts = bytes_from(text, before[first], width)
        fits[first] &= parts == np.array([outline.between[place] for outline in outlines])
        if path is not None:
            fits &= stops > starts
            column = read_values(text, starts, np.maximum(stops, starts + 1), words[:, n_between:])
            fits &= column.read
            columns[path] = column.column
    is_whole = np.ones(len(outlines), dtype=bool)
    is_whole[line_of[~fits]] = False
    if lengths[is_whole].sum() < FEWEST_STATES:
        return None
    kept = np.flatnonzero(is_whole).tolist()
    if len(kept) < len(outlines):
        columns = {path: _rows_of(column, is_whole[line_of]) for path, column in columns.items()}
    return AlikeLines(
        lines=np.array([outlines[place].line for place in kept]),
        lengths=lengths[kept],
        headings=[outlines[place].heading for place in kept],
        columns=columns,
        names=form.names,
    )


_FIRST_IN_JSON = 32
"""The least byte that may appear unescaped in a JSON string."""


def _joined(outlines: Sequence[_Outline], comma: bytes) -> tuple[Bytes, Places, Places]:
    """All states, each followed by a comma; the positions of colons, and where lines end."""
    parts: list[bytes | memoryview] = [b" " * PADDING]
    for outline in outlines:
        parts += outline.states, comma
    whole = b"".join([*parts, b" " * PADDING])
    text = np.frombuffer(whole, np.uint8)
    ends = PADDING + np.cumsum([len(line.states) + len(comma) for line in outlines])
    return text, np.flatnonzero(text == ord(":")), ends


def _rows_of(column: Column, rows: NDArray[np.bool_]) -> Column:
    if isinstance(column, Coded):
        return Coded(column.codes[rows], column.values)
    return Numbers(column.numbers[rows], column.given[rows])
