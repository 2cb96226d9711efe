"""Traces as JSON Lines: one trace a line, read and written one at a time. See docs/traces.md."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import IO, Any

import msgspec

from rulec.diagnostics import Diagnostic, Place, RulecError
from rulec.diagnostics.json_words import json_words
from rulec.trace.lines import lines_as_they_come
from rulec.trace.mending import way_out
from rulec.trace.model import State, Trace

LONGEST_LINE_BYTES = 256 << 20
"""A longer line is refused: it is not a trace but a file that lacks its line ends."""


class _Record(msgspec.Struct, forbid_unknown_fields=True):
    states: list[dict[str, bool | float | str | dict[str, Any]]]
    id: str | int = ""
    step_s: float = 1.0
    objects: dict[str, str] = {}
    present: dict[str, tuple[int, int]] = {}


class _Outline(msgspec.Struct, forbid_unknown_fields=True):
    """The same, its states not yet read."""

    states: list[msgspec.Raw]
    id: str | int = ""
    step_s: float = 1.0
    objects: dict[str, str] = {}
    present: dict[str, tuple[int, int]] = {}


_EXAMPLE = 'a trace is a line such as {"id": "t1", "states": [{…}, {…}]}'
_DECODER = msgspec.json.Decoder(_Record)
_OUTLINE_DECODER = msgspec.json.Decoder(_Outline)


def read_traces(stream: IO[bytes], file: str) -> Iterator[Trace | RulecError]:
    """The traces of a stream, one per line, blank lines skipped. See ``read_chunks``."""
    for chunk in read_chunks(stream, file):
        yield from chunk


def read_chunks(stream: IO[bytes], file: str) -> Iterator[list[Trace | RulecError]]:
    """The same, as many at a time as a block of the stream holds; of a pipe, as have arrived.

    States that are written alike are the same object, as far as there is room to remember them.

    Args:
        stream: the open file.
        file: its name, for messages.

    Yields:
        For every line a Trace, or the RulecError (R0501) that says why it is none; for a stream
        without any trace one RulecError (R0501).
    """
    number = found = 0
    read_state = _StateReader()
    for lines in lines_as_they_come(stream, LONGEST_LINE_BYTES):
        chunk: list[Trace | RulecError] = []
        for line in lines:
            number += 1
            if number == 1:
                line = line.removeprefix(b"\xef\xbb\xbf")
            if line.isspace() or not line:
                continue
            place = Place(file, number)
            if len(line) > LONGEST_LINE_BYTES:
                chunk.append(_bad(f"the line is longer than {LONGEST_LINE_BYTES >> 20} MiB", place))
            else:
                chunk.append(_trace(line, place, read_state))
        found += len(chunk)
        if chunk:
            yield chunk
    if not found:
        yield [_bad("there is no trace in this file", Place(file))]


def _trace(line: bytes, place: Place, read_state: _StateReader) -> Trace | RulecError:
    record: _Outline | _Record
    if read_state.pays:
        try:
            record = _OUTLINE_DECODER.decode(line)
            states = tuple([read_state[bytes(raw)] for raw in record.states])
            return _made(record, states, place)
        except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
            pass  # read as a whole, it says what is wrong
    try:
        record = _DECODER.decode(line)
    except RecursionError:
        return _bad("this is not a trace: it is nested too deep", place)
    except (msgspec.MsgspecError, UnicodeDecodeError) as problem:
        message = f"this is not a trace: {json_words(problem)}"
        return _bad(message, place, way_out(problem, line, _Record.__struct_fields__, _EXAMPLE))
    return _made(record, tuple(record.states), place)


def _made(record: _Outline | _Record, states: tuple[State, ...], place: Place) -> Trace:
    name = str(record.id) or f"line {place.line}"
    return Trace(name, record.step_s, record.objects, states, record.present, place)


class _StateReader(dict[bytes, State]):
    """Reads each state once, however often it is met, as long as that happens."""

    _MOST = 1 << 16
    _LONGEST = 1 << 12
    _DECODE = msgspec.json.Decoder(dict[str, bool | float | str | dict[str, Any]]).decode

    pays = True
    _met = 0

    def __missing__(self, text: bytes) -> State:
        state = self._DECODE(text)
        self._met += 1
        if self._met > self._MOST or len(text) > self._LONGEST:
            # There is no end to them: what is remembered is of no use.
            self.pays = False
            self.clear()
        else:
            self[text] = state
        return state


def _bad(message: str, place: Place, help_text: str = "") -> RulecError:
    return RulecError(Diagnostic("R0501", message, place, help=help_text))


def write_traces(traces: Iterable[Trace], stream: IO[bytes]) -> int:
    """Write traces, one a line, and return how many."""
    encoder = msgspec.json.Encoder()
    count = 0
    for count, trace in enumerate(traces, 1):  # noqa: B007 - the count is the result
        stream.write(encoder.encode(as_record(trace)))
        stream.write(b"\n")
    return count


def as_record(trace: Trace) -> dict[str, Any]:
    """A trace as the object of its line."""
    record: dict[str, Any] = {
        "id": trace.id,
        "step_s": trace.step_s,
        "objects": trace.objects,
        "states": trace.states,
    }
    return {**record, "present": trace.present} if trace.present else record
