"""Decoding of JSON lines, and diagnostics for lines that are refused."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, TypeVar, get_args, get_type_hints

import msgspec

from rulec.diagnostics import RulecError, SourceLocation, did_you_mean, named
from rulec.diagnostics.phrases import json_words
from rulec.trace.formats.stream_lines import not_utf8, placed
from rulec.trace.trace_messages import NOT_A_TRACE

LONGEST_LINE_BYTES = 128 << 20
"""A longer line is refused: the file or stream has no line ends."""

_MOST_SEARCHED = 1 << 24
"""For a longer line the message does not say in which state it ends."""

_UNKNOWN_FIELD = re.compile(r"unknown field `(.*?)`(?! - at)", re.DOTALL)
_UNKNOWN_CHOICE = re.compile(r"nvalid enum value '.*' - at `\$\.(\w+)`", re.DOTALL)
_REFUSED_BYTE = re.compile(r" \(byte ([0-9]+)\)")
_MARK = re.compile(rb'\\.|["{}\[\],]', re.DOTALL)
_SURROGATES = re.compile(
    rb"\\u[dD][89abAB]\w\w\\u[dD][c-fC-F]\w\w|(?P<half>\\u[dD][89a-fA-F]\w\w)|\\.", re.DOTALL
)
"""The escapes of a text, so that a backslash that is itself escaped begins none."""

_CALLED = re.compile(rb'\s*:\s*([0-9]+\b|"[^"\\]{1,100}")')

ONE_LINE = "write it without line breaks, as `jq -c . FILE` does"


Record = TypeVar("Record", bound=msgspec.Struct)


@dataclass(frozen=True)
class Kind(Generic[Record]):
    """What lines should contain: its name, such as ``"trace"``, the structure, an example.

    ``object_type`` is a type that objects may have; empty if there are no types.
    """

    name: str
    structure: type[Record]
    example: str
    object_type: str = "car"

    @property
    def no_list(self) -> str:
        """Help for a file that is one JSON list."""
        return f"{self.example}; `jq -c '.[]' FILE` splits a list into lines"

    @cached_property
    def _decoder(self) -> msgspec.json.Decoder[Record]:
        return msgspec.json.Decoder(self.structure)

    def read(self, line: bytes, place: SourceLocation) -> Record | RulecError:
        """Decode a line, or say why it is refused (R0501)."""
        if len(line) > LONGEST_LINE_BYTES:
            return self.bad(f"the line is longer than {LONGEST_LINE_BYTES >> 20} MiB", place)
        try:
            return self._decoder.decode(line)
        except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as problem:
            return self._refused(problem, line, place)

    def bad(self, message: str, place: SourceLocation, help_text: str = "") -> RulecError:
        """Error R0501: the line at this place is not of this kind."""
        return NOT_A_TRACE.error(place, message, help=help_text or self.example)

    def _refused(self, problem: Exception, line: bytes, place: SourceLocation) -> RulecError:
        this = f"this is not a {self.name}"
        if isinstance(problem, RecursionError):
            return self.bad(f"{this}: it is nested too deep", place)
        at = not_utf8(line)
        if at is not None:
            words = f"the byte 0x{line[at]:02x} is not UTF-8"
            return self.bad(f"{this}: {words}", placed(place, line, at), "save the file in UTF-8")
        if is_beginning(line):
            message = f"the line ends in the middle of a {self.name}: it has been cut short"
            return self.bad(message, placed(place, line, len(line) - 1))
        if "surrogate" in str(problem) or "truncated" in str(problem):
            half = next(each for each in _SURROGATES.finditer(line) if each["half"])
            words = f"`{half[0].decode()}` is half of a surrogate pair"
            help_text = "write a character beyond U+FFFF as it is, or as both halves of its pair"
            return self.bad(f"{this}: {words}", placed(place, line, half.start()), help_text)
        words = json_words(problem)
        byte = _REFUSED_BYTE.search(words)
        help_text = self.no_list if line.lstrip().startswith(b"[") else self.example
        if byte is not None:
            at = int(byte[1])
            words = words.replace(byte[0], "")
            place = placed(place, line, at)
            help_text = _spelling(line[at : at + 10]) or help_text
        unknown = _UNKNOWN_FIELD.search(str(problem))
        if unknown is not None:
            fields = self.structure.__struct_fields__
            help_text = did_you_mean(unknown[1], fields) or (
                f"the fields are {named(fields)}; {self.example}"
            )
            if unknown[1] == "version":
                help_text = _answer_of_rulec(line) or help_text
        if "at `$.objects" in str(problem):
            help_text = f'objects have types: write "objects": {{"v1": "{self.object_type}"}}'
            if not self.object_type:
                help_text = 'the rulebook has no types of objects: leave out "objects"'
        if "trailing characters" in words:
            help_text = f"write each {self.name} on a line of its own"
        if "expected a number, got a string" in words:
            help_text = "numbers are written without quotes"
        choice = _UNKNOWN_CHOICE.search(str(problem))
        if choice is not None:
            given, _ = get_args(get_type_hints(self.structure)[choice[1]])  # or nothing is given
            help_text = " or ".join(f'`"{choice[1]}": "{value}"`' for value in get_args(given))
        return self.bad(f"{this}: {words}", place, help_text)


def rows_of_tracks(line: bytes, place: SourceLocation) -> RulecError | None:
    """Error R0501 if a line is a row of tracks or a list of such rows; otherwise None."""
    if b'"states"' in line or len(line) > LONGEST_LINE_BYTES:
        return None
    try:
        given = msgspec.json.decode(line)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return None
    is_list = isinstance(given, list)
    row = given[0] if is_list and given else given
    if not isinstance(row, dict) or not {"x", "y"} <= row.keys():
        return None
    reads = f"read_json('{place.file}'{'' if is_list else ', lines=True'})"
    return NOT_A_TRACE.error(
        SourceLocation(place.file, place.line),
        "these are not traces but rows of tracks, which are read as CSV or Parquet",
        help=f"`pandas.{reads}.to_csv('tracks.csv', index=False)` writes them so",
    )


def _answer_of_rulec(line: bytes) -> str:
    """Help for a line written by `rulec verify`: what it is, and what reads it; else empty."""
    if b'"outcome":' in line:
        return "it is a finding of `rulec verify`, which `rulec rates` counts"
    if b'"satisfied":' in line:
        return "it is a verdict of `rulec verify`: give the traces that were judged"
    return ""


def _spelling(text: bytes) -> str:
    if text.lstrip(b"-+").startswith((b"NaN", b"nan", b"Infinity", b"inf")):
        return "JSON has neither `NaN` nor infinity: write `null` for an unknown value"
    if text.startswith((b"'", b"True", b"False", b"None")):
        return "JSON has texts in double quotes, and `true`, `false`, `null` in lower case"
    return ""


def is_beginning(line: bytes) -> bool:
    """Whether a line is valid JSON so far but ends too early."""
    # If it ends within a number, such as `0.`, that is recognised only with another digit.
    return (_is_truncated(line) or _is_truncated(line + b"0")) and not _is_whole(line)


def _is_truncated(line: bytes) -> bool:
    try:
        msgspec.json.decode(line)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as problem:
        return "truncated" in str(problem)
    return False


def _is_whole(line: bytes) -> bool:
    """Whether a line is JSON except for halves of surrogate pairs, near its end too."""
    try:
        json.loads(line)
    except (ValueError, RecursionError):
        return False
    return True


def middle_of(line: bytes) -> str:
    """Where a trace is cut off, such as ``state 6 of trace `t1` ``."""
    open_: list[int | bytes | None] = []
    """The current index for each open list, the current key (if read) for each open object."""
    called = b""
    begun: int | None = None
    """Where the current string began; None outside of strings."""
    for match_ in _MARK.finditer(line) if len(line) <= _MOST_SEARCHED else ():
        mark = match_[0]
        if mark == b'"' and begun is None:
            begun = match_.end()
        elif mark == b'"' and begun is not None:
            if open_ and open_[-1] is None:
                open_[-1] = line[begun : match_.start()]
                id_match = _CALLED.match(line, match_.end())
                if open_ == [b"id"] and id_match is not None:
                    called = id_match[1].strip(b'"')
            begun = None
        elif begun is not None:
            continue
        elif mark in b"{[":
            open_.append(None if mark == b"{" else 0)
        elif mark in b"}]":
            del open_[-1:]
        elif mark == b"," and open_:
            open_[-1] = open_[-1] + 1 if isinstance(open_[-1], int) else None
    whole = f"trace `{called.decode('utf-8', 'replace')}`" if called else "a trace"
    match open_:
        case [b"states", int(number), *_]:
            return f"state {number} of {whole}"
    return whole
