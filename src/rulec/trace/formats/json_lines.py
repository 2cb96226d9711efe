"""Traces as JSON Lines, and states of a running trace (docs/traces.md, docs/online.md)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain
from pathlib import PurePath
from typing import IO, Any, cast

import msgspec

from rulec.diagnostics import RulecError, SourceLocation
from rulec.garbage_collection import no_garbage_collection
from rulec.resource_limits import STATES
from rulec.trace.formats import json_line_problems
from rulec.trace.formats.json_values import (
    BOUNDS,
    as_written,
    exactly,
    from_json,
    may_be_no_float,
    to_json,
)
from rulec.trace.formats.stream_lines import foreign, lines_as_they_come, placed
from rulec.trace.trace_messages import NOT_A_TRACE
from rulec.trace.trace_model import Ending, State, Trace, ending_in_file, plain_step_s

_INTERVAL = 'an interval is written {"from": 1, "to": 2.5}'
_LONGEST_HEAD_BYTES = 1 << 16


class _Header(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    id: str | int = ""
    step_s: float | msgspec.UnsetType = msgspec.UNSET
    objects: dict[str, str] = {}
    present: dict[str, tuple[int, int]] = {}
    ends: Ending | msgspec.UnsetType = msgspec.UNSET
    told: list[str] | None = None

    @property
    def seconds(self) -> float:
        """The step, also if none is given."""
        return 1.0 if self.step_s is msgspec.UNSET else self.step_s

    @property
    def ending(self) -> Ending:
        """How the trace ends, also if it does not say."""
        said = None if self.ends is msgspec.UNSET else self.ends
        return ending_in_file(said, in_seconds=self.step_s is not msgspec.UNSET)


class _Record(_Header):
    states: list[dict[str, bool | float | str | dict[str, Any] | None]]


class _Outline(_Header):
    """A trace whose states are not decoded yet."""

    states: list[msgspec.Raw]


_TRACE = json_line_problems.Kind(
    "trace", _Record, 'a trace is a line such as {"id": "t1", "states": [{…}, {…}]}'
)
_OF_TEXTS = (".md", ".markdown", ".txt", ".rst", ".html", ".py", ".rules", ".toml", ".yml", ".yaml")
"""Endings of files usually written for people: one message is enough, not one for each line."""

_OUTLINE_DECODER = msgspec.json.Decoder(_Outline)


def read_chunks(stream: IO[bytes], file: str) -> Iterator[Sequence[Trace | RulecError]]:
    """Read traces, one per line, one block of the stream at a time.

    A block of a pipe is what has arrived. Each line that is not blank gives a Trace, or the
    RulecError (R0501, R0718) that says why it is not one; a stream without any trace gives one
    RulecError (R0501). Messages call the stream ``file``. States with the same text are the same
    object, as long as there is room to remember them.
    """
    number = result = 0
    read_state = _StateReader()
    torn: _Torn | None = None
    most = STATES.value()
    for lines in lines_as_they_come(stream, json_line_problems.LONGEST_LINE_BYTES):
        if not number:
            lines[0] = lines[0].removeprefix(b"\xef\xbb\xbf")
            error = _no_traces(lines[0], SourceLocation(file, 1))
            if error is not None:
                yield [error]
                return
        chunk: list[Trace | RulecError] = []
        with no_garbage_collection():
            for line in lines:
                number += 1
                if not line or line.isspace():
                    continue
                place = SourceLocation(file, number)
                is_large = _objects_in(line, most) > most
                trace = STATES.exceeded(place) if is_large else _trace(line, place, read_state)
                is_refused = isinstance(trace, RulecError)
                if torn is not None:
                    if is_refused and not line.startswith(b"{"):
                        torn.goes_on = True
                        continue
                    chunk.append(torn.error(at_the_end=False))
                    torn = None
                if is_refused and not is_large and json_line_problems.is_beginning(line):
                    torn = _Torn(line, place)
                else:
                    chunk.append(trace)
        result += len(chunk)
        if chunk:
            yield chunk
    if torn is not None:
        yield [torn.error(at_the_end=True)]
    elif not result:
        yield [_TRACE.bad("there is no trace in this file: it is empty", SourceLocation(file))]


def _objects_in(line: bytes, most: int) -> int:
    """The number of JSON objects in a line; 0 if it is too short to contain more than ``most``."""
    return line.count(b"{") if len(line) > 2 * most else 0


@dataclass(slots=True)
class _Torn:
    """A line with the beginning of a trace that may continue on the next lines."""

    line: bytes
    place: SourceLocation
    goes_on: bool = False

    def error(self, *, at_the_end: bool) -> RulecError:
        """The diagnostic, which depends on the lines that follow."""
        cut = f"the line ends in the middle of {json_line_problems.middle_of(self.line)}"
        place = placed(self.place, self.line, len(self.line) - 1)
        if self.goes_on:
            return _TRACE.bad(
                f"{cut} and goes on below: a trace is one line", place, json_line_problems.ONE_LINE
            )
        if at_the_end:
            message = f"{cut.replace('line', 'file', 1)}: it has been cut short"
            return _TRACE.bad(message, place, "write or copy the file again")
        return _TRACE.bad(f"{cut}: it has been cut short", place, "write it again, or delete it")


def _no_traces(first: bytes, place: SourceLocation) -> RulecError | None:
    result = foreign(first)
    if result is not None:
        return _TRACE.bad(
            f"these are not traces but {result.noun}", SourceLocation(place.file), result.help
        )
    if {b"trace", b"step"} <= set(first[:_LONGEST_HEAD_BYTES].strip().split(b",")):
        return _TRACE.bad("these are not traces in JSON but CSV", place, "add `--input-format csv`")
    if PurePath(place.file).suffix == ".rules":
        way_out = f"give traces, and the rulebook with `-r {place.file}`"
        return _TRACE.bad("this is a rulebook, not traces", SourceLocation(place.file), way_out)
    if PurePath(place.file).suffix.lower() in _OF_TEXTS and not first.lstrip().startswith(
        (b"{", b"[")
    ):
        return _TRACE.bad(
            "these are not traces but text", SourceLocation(place.file), _TRACE.example
        )
    if first.startswith(b"[") and json_line_problems.is_beginning(first):
        message = "this is a list in JSON, not one trace per line"
        return _TRACE.bad(message, place, _TRACE.no_list)
    return json_line_problems.rows_of_tracks(first, place)


def _trace(line: bytes, place: SourceLocation, read_state: _StateReader) -> Trace | RulecError:
    if may_be_no_float(line):
        return _as_written(line, place)
    if read_state.pays and len(line) <= json_line_problems.LONGEST_LINE_BYTES:
        with suppress(ValueError, RecursionError):  # msgspec's errors are ValueErrors
            outline = _OUTLINE_DECODER.decode(line)
            read_state.read += len(outline.states)
            if BOUNDS.isdisjoint(outline.objects):
                return _made(outline, [read_state[bytes(raw)] for raw in outline.states], place)
    # Decoding the whole line also finds what is wrong with it.
    record = _TRACE.read(line, place)
    if isinstance(record, RulecError):
        return record
    if _is_plain(line):
        return _made(record, cast("list[State]", record.states), place)
    return _of_record(record, place)


def _of_record(record: _Record, place: SourceLocation) -> Trace | RulecError:
    states: list[State] = []
    try:
        states.extend(from_json(state, record.objects) for state in record.states)
    except ValueError as wrong:
        return _TRACE.bad(f"in state {len(states)} {wrong}", place, _INTERVAL)
    return _made(record, states, place)


def _as_written(line: bytes, place: SourceLocation) -> Trace | RulecError:
    """The trace of a line that may contain numbers that no float represents."""
    record = _TRACE.read(line, place)
    if isinstance(record, RulecError):
        return record
    try:
        written = exactly(line)
    except ValueError as wrong:
        return _TRACE.bad(str(wrong), place)
    record.step_s, record.states = written.get("step_s", record.step_s), written["states"]
    return _of_record(record, place)


def _made(record: _Header, states: Sequence[State], place: SourceLocation) -> Trace:
    return Trace(
        str(record.id) or f"line {place.line}",
        record.seconds,
        record.objects,
        tuple(states),
        record.present,
        place=place,
        ends=record.ending,
        told=None if record.told is None else frozenset(record.told),
    )


def _is_plain(text: bytes) -> bool:
    """Whether JSON has no unknown values, intervals or escapes: decoded, it is a state as it is."""
    return (
        b"null" not in text and b'"from"' not in text and b'"to"' not in text and b"\\" not in text
    )


class _StateReader(dict[bytes, State]):
    """Decodes states, and equal texts only once as long as that saves time."""

    _MOST = 1 << 16
    _LONGEST = 1 << 12
    _DECODE = msgspec.json.Decoder(dict[str, bool | float | str | dict[str, Any] | None]).decode

    _FEW = 1 << 12

    pays = True
    read = 0
    _met = 0

    def __missing__(self, text: bytes) -> State:
        decoded = self._DECODE(text)
        state = cast("State", decoded) if _is_plain(text) else from_json(decoded, ())
        self._met += 1
        few = self._met < self._FEW or self._met * 2 < self.read
        if self._met > self._MOST or len(text) > self._LONGEST or not few:
            # Too many distinct states: remembering them does not pay.
            self.pays = False
            self.clear()
        else:
            self[text] = state
        return state


def write_traces(traces: Iterable[Trace], stream: IO[bytes]) -> int:
    """Write traces, one per line, and return their number."""
    encoder = msgspec.json.Encoder(enc_hook=as_written)
    count = 0
    for count, trace in enumerate(traces, 1):  # noqa: B007 - the count is the result
        fields: dict[str, object] = {"id": trace.id, "step_s": plain_step_s(trace)}
        fields |= {"objects": trace.objects, "states": [to_json(state) for state in trace.states]}
        if trace.present:
            fields["present"] = trace.present
        fields["ends"] = trace.ends
        if trace.told is not None:
            fields["told"] = sorted(trace.told)
        try:
            stream.write(encoder.encode(fields))
        except UnicodeEncodeError:
            why = f"trace `{trace.id}` has half a character (a surrogate), which no file can hold"
            raise NOT_A_TRACE.error(trace.place, why) from None
        stream.write(b"\n")
    return count


@dataclass(frozen=True, slots=True)
class LiveState:
    """A state with its objects' types and its source location."""

    state: State
    objects: dict[str, str]
    place: SourceLocation


class _StateRecord(msgspec.Struct, forbid_unknown_fields=True):
    state: dict[str, bool | float | str | dict[str, Any] | None]
    objects: dict[str, str] = {}


def read_live(
    stream: IO[bytes], file: str, object_type: str = "vehicle"
) -> Iterator[LiveState | RulecError]:
    """Read the states of a stream as their lines arrive.

    Each line that is not blank gives a LiveState, or the RulecError (R0501) that says why it is not
    one; messages call the stream ``file``, and their examples have objects of ``object_type``, none
    if it is empty.
    """
    objects = f', "objects": {{"v1": "{object_type}"}}' if object_type else ""
    example = f'a state is a line such as {{"state": {{…}}{objects}}}'
    kind = json_line_problems.Kind("state", _StateRecord, example, object_type)
    lines = chain.from_iterable(lines_as_they_come(stream, json_line_problems.LONGEST_LINE_BYTES))
    for number, line in enumerate(lines, 1):
        if number == 1:
            line = line.removeprefix(b"\xef\xbb\xbf")
            result = foreign(line)
            if result is not None:
                message = f"these are not states but {result.noun}"
                yield kind.bad(message, SourceLocation(file), result.help)
                return
        if line.strip():
            place = SourceLocation(file, number)
            record = kind.read(line, place)
            if isinstance(record, RulecError):
                yield record
            else:
                try:
                    if may_be_no_float(line):
                        record.state = exactly(line)["state"]
                except ValueError as wrong:
                    yield kind.bad(str(wrong), place)
                    continue
                try:
                    state = from_json(record.state, record.objects)
                except ValueError as wrong:
                    yield kind.bad(str(wrong), place, _INTERVAL)
                else:
                    yield LiveState(state, record.objects, place)
