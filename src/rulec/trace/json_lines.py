"""Traces as JSON Lines: one trace a line, read and written one at a time. See docs/traces.md."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import IO, Any

import msgspec

from rulec.diagnostics import Diagnostic, Place, RulecError, did_you_mean
from rulec.diagnostics.json_words import json_words
from rulec.trace.model import Trace

LONGEST_LINE_BYTES = 256 << 20
"""A longer line is refused: it is not a trace but a file that lacks its line ends."""


class _Record(msgspec.Struct, forbid_unknown_fields=True):
    states: list[dict[str, bool | float | str | dict[str, Any]]]
    id: str | int = ""
    step_s: float = 1.0
    objects: dict[str, str] = {}
    present: dict[str, tuple[int, int]] = {}


_UNKNOWN_FIELD = re.compile(r"unknown field `(.*?)`(?! - at)", re.DOTALL)
_REFUSED_BYTE = re.compile(r"\(byte ([0-9]+)\)")
_DECODER = msgspec.json.Decoder(_Record)


def read_traces(stream: IO[bytes], file: str) -> Iterator[Trace | RulecError]:
    """The traces of a stream, one per line, blank lines skipped; never more than a line in memory.

    Args:
        stream: the open file.
        file: its name, for messages.

    Yields:
        For every line a Trace, or the RulecError (R0501) that says why it is none; for a stream
        without any trace one RulecError (R0501).
    """
    number = found = 0
    while line := stream.readline(LONGEST_LINE_BYTES + 1):
        number += 1
        if number == 1:
            line = line.removeprefix(b"\xef\xbb\xbf")
        place = Place(file, number)
        found += bool(line.strip())
        if len(line) > LONGEST_LINE_BYTES:
            yield _bad(f"the line is longer than {LONGEST_LINE_BYTES >> 20} MiB", place)
            while line and not line.endswith(b"\n"):
                line = stream.readline(LONGEST_LINE_BYTES)
        elif line.strip():
            yield _trace(line, place)
    if not found:
        yield _bad("there is no trace in this file", Place(file))


def _trace(line: bytes, place: Place) -> Trace | RulecError:
    try:
        record = _DECODER.decode(line)
    except RecursionError:
        return _bad("this is not a trace: it is nested too deep", place)
    except (msgspec.MsgspecError, UnicodeDecodeError) as problem:
        message = f"this is not a trace: {json_words(problem)}"
        return _bad(message, place, _way_out(str(problem), line))
    return Trace(
        str(record.id) or f"line {place.line}",
        record.step_s,
        record.objects,
        tuple(record.states),
        record.present,
        place,
    )


def _way_out(problem: str, line: bytes) -> str:
    """Help with a line that the decoder refuses in these words."""
    unknown = _UNKNOWN_FIELD.search(problem)
    if unknown is not None:
        near = did_you_mean(unknown[1], _Record.__struct_fields__)
        if near:
            return near
    refused = _REFUSED_BYTE.search(problem)
    if refused is not None:
        found = line[int(refused[1]) :]
        if found.lstrip(b"-+").startswith((b"NaN", b"nan", b"Infinity", b"inf")):
            return "JSON has no `NaN` and no infinity: a value has to be a number"
        if found.startswith((b"'", b"True", b"False", b"None")):
            return "in JSON texts stand in double quotes, and it is `true`, `false`, `null`"
    return 'a trace is a line such as {"id": "t1", "states": [{…}, {…}]}'


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
