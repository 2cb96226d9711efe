"""The machine that executes pickles: its bytes, stack, marks and memory."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.encodings.xml_element import short

MOST_OPCODES = 5_000_000
"""Limit on opcodes, each of which makes at most one value; a scene of 20 s has 100,000."""


@dataclass(frozen=True, slots=True)
class PickledName:
    """A name that a pickle may call, and the function that it stands for."""

    name: str
    makes: str


@dataclass(slots=True)
class PickledArray:
    """An array or number type that is complete only once its state was read."""

    value: np.ndarray[Any, Any] | np.dtype[Any] | None = None


@dataclass(slots=True)
class PickleMachine:
    """The machine that executes a pickle. Its methods raise RulecError R0610."""

    data: bytes
    path: Path
    form: BinaryFormat
    place: int = 0
    begin: int = 0
    stack: list[Any] = field(default_factory=list)
    marks: list[int] = field(default_factory=list)
    memo: dict[int, Any] = field(default_factory=dict)
    copied: int = 0

    def wrong(self, why: str) -> RulecError:
        """The error at the current opcode."""
        return self.form.refused(self.path, why, self.begin)

    def take(self, count: int) -> bytes:
        """The next ``count`` bytes."""
        if count > len(self.data) - self.place:
            raise self.wrong("it ends before what begins here; it has been cut short, or is none")
        self.place += count
        return self.data[self.place - count : self.place]

    def number(self, form: str) -> Any:
        """A number in a format of ``struct``."""
        return struct.unpack(form, self.take(struct.calcsize(form)))[0]

    def counted(self, form: str) -> bytes:
        """Bytes, preceded by their number."""
        return self.take(self.number(form))

    def copy(self, count: int) -> None:
        """Count copied values: a small file may refer to a large value again and again."""
        self.copied += count
        if self.copied > max(MOST_OPCODES, len(self.data)):
            raise self.wrong("it copies more than there is in it")

    def push(self, value: Any) -> None:
        """Push a value onto the stack."""
        self.stack.append(value)

    def pop(self) -> Any:
        """Pop the top of the stack, but nothing below the last mark."""
        if len(self.stack) <= (self.marks[-1] if self.marks else 0):
            raise self.wrong("it takes a value where there is none")
        return self.stack.pop()

    def since_mark(self) -> list[Any]:
        """Pop all values above the last mark."""
        if not self.marks:
            raise self.wrong("it takes values from a mark on where there is none")
        start = self.marks.pop()
        values = self.stack[start:]
        del self.stack[start:]
        return values

    def last(self, kind: type | tuple[type, ...], container: str) -> Any:
        """The top of the stack, which must be of a kind."""
        if len(self.stack) <= (self.marks[-1] if self.marks else 0):
            raise self.wrong("it takes a value where there is none")
        if type(self.stack[-1]) is not kind:
            raise self.wrong(f"it adds to {called(self.stack[-1])} as to a {container}")
        return self.stack[-1]


def called(value: Any) -> str:
    """A value's type in words, for messages."""
    if isinstance(value, PickledName):
        return f"`{short(value.name)}`"
    return "an array" if isinstance(value, PickledArray) else f"a {type(value).__name__}"
