"""Pickles of plain data and NumPy arrays, read without running anything that they name.

Python's ``pickletools`` splits a pickle into opcodes with their arguments, and documents them;
protocols 2 to 5 are read. Python's own reader calls whatever a pickle names; this one knows a few
names, builds their values itself, and refuses all others.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from io import BytesIO
from math import prod
from pathlib import Path
from pickletools import genops
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.wire_format import wire_file

MOST_OPCODES = 5_000_000
"""Limit on opcodes, each of which makes at most one value; a scene of 20 s has 100,000."""
MOST_AXES = 4

_OLDEST, _NEWEST = 2, 5
_LARGEST_KEY = 1 << 63
_LARGEST_ITEM_BYTES = 4096
_NAMES: Mapping[str, str] = MappingProxyType(
    {
        r"numpy\._?core\.multiarray _reconstruct": "array",
        r"numpy\._?core\.multiarray scalar": "scalar",
        r"numpy\._?core\.numeric _frombuffer": "array of bytes",
        r"numpy ndarray": "class",
        r"numpy dtype": "dtype",
        r"collections defaultdict": "default dict",
        r"collections OrderedDict": "dict",
        r"(builtins|__builtin__) (set|frozenset)": "set",
        r"(builtins|__builtin__) (int|long|float|str|bool|list|dict)": "class",
        r"(builtins|__builtin__) bytes": "bytes",
        r"_codecs encode": "bytes of text",
    }
)
"""Module and name, as patterns -> what it stands for."""

_ORDERS = frozenset("<>|=")
_DTYPE = re.compile(r"[<>|=]?(?:b1|[iu][1248]|f[248]|[US][0-9]{1,4})")


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
    begin: int = 0
    stack: list[Any] = field(default_factory=list)
    marks: list[int] = field(default_factory=list)
    memo: dict[int, Any] = field(default_factory=dict)
    copied: int = 0

    def wrong(self, why: str) -> RulecError:
        """The error at the current opcode."""
        return self.form.refused(self.path, why, self.begin)

    def copy(self, count: int) -> None:
        """Count copied values: a small file may refer to a large value again and again."""
        self.copied += count
        if self.copied > max(MOST_OPCODES, len(self.data)):
            raise self.wrong("it copies more than there is in it")

    def push(self, value: Any) -> None:
        """Push a value onto the stack."""
        self.stack.append(value)

    def top(self) -> Any:
        """The top of the stack, which is above the last mark."""
        if len(self.stack) <= (self.marks[-1] if self.marks else 0):
            raise self.wrong("it takes a value where there is none")
        return self.stack[-1]

    def pop(self) -> Any:
        """Pop the top of the stack."""
        self.top()
        return self.stack.pop()

    def since_mark(self) -> list[Any]:
        """Pop all values above the last mark."""
        if not self.marks:
            raise self.wrong("it takes values from a mark on where there is none")
        start = self.marks.pop()
        values = self.stack[start:]
        del self.stack[start:]
        return values

    def last(self, kind: type, container: str) -> Any:
        """The top of the stack, which must be of a kind."""
        if type(self.top()) is not kind:
            raise self.wrong(f"it adds to {_called(self.stack[-1])} as to a {container}")
        return self.stack[-1]


def read_pickle(path: Path, form: BinaryFormat) -> Any:
    """The value in a pickle: ``None``, numbers, texts, bytes, lists, tuples, dicts, sets, arrays.

    A container may contain itself, so callers must bound their traversal. Raises RulecError R0610
    for any other or broken content, with its byte, R0701 for a file that cannot be read.
    """
    data = wire_file(path, form).data
    machine = PickleMachine(data, path, form)
    if data[0] != 0x80:
        raise machine.wrong("it does not begin with a protocol, as pickles since protocol 2 do")
    stream = BytesIO(data)
    opcodes = genops(stream)
    for _ in range(MOST_OPCODES):
        machine.begin = place = stream.tell()
        opcode = data[place : place + 1]
        if opcode == b".":
            return _settled(machine.pop())
        if opcode and opcode not in _ACTIONS:
            raise machine.wrong(f"it has the opcode {opcode!r}, which no scenario needs")
        try:
            _, argument, _ = next(opcodes)
        except UnicodeDecodeError:
            raise machine.wrong("a text is not UTF-8, or a name is not ASCII") from None
        except ValueError:
            why = "it ends before what begins here; it has been cut short, or is none"
            raise machine.wrong(why) from None
        _ACTIONS[opcode](machine, argument)
    raise machine.wrong(f"it has more than {MOST_OPCODES:,} opcodes")


def _called(value: Any) -> str:
    """A value's type in words, for messages."""
    if isinstance(value, PickledName):
        return f"`{short(value.name)}`"
    return "an array" if isinstance(value, PickledArray) else f"a {type(value).__name__}"


def _settled(value: Any) -> Any:
    """A value to put into a container: an array must be complete by then."""
    return value.value if isinstance(value, PickledArray) and value.value is not None else value


def _protocol(machine: PickleMachine, protocol: int) -> None:
    if not _OLDEST <= protocol <= _NEWEST:
        raise machine.wrong(f"it is of protocol {protocol}; {_OLDEST} to {_NEWEST} are read")


def _whole(machine: PickleMachine, number: int) -> None:
    size = max(number, ~number).bit_length() // 8 + 1
    if size > 8:
        raise machine.wrong(f"it has a whole number of {size} bytes; at most 8 are read")
    machine.push(number)


def _tuple(count: int) -> Callable[[PickleMachine, None], None]:
    def action(machine: PickleMachine, _: None) -> None:
        machine.push(tuple([_settled(machine.pop()) for _ in range(count)][::-1]))

    return action


def _add(machine: PickleMachine, values: list[Any]) -> None:
    machine.last(list, "list").extend(map(_settled, values))


def _key(machine: PickleMachine, key: Any) -> Any:
    """A dictionary key of a type for which a file cannot choose many keys with equal hashes."""
    if isinstance(key, str) or (isinstance(key, int | None) and abs(key or 0) < _LARGEST_KEY):
        return key
    raise machine.wrong(f"{_called(key)} is a key; texts and whole numbers may be")


def _set_items(machine: PickleMachine, values: list[Any]) -> None:
    target = machine.last(dict, "dictionary")
    if len(values) % 2:
        raise machine.wrong("a key has no value")
    for key, value in zip(values[::2], values[1::2], strict=True):
        target[_key(machine, key)] = _settled(value)


def _keys(machine: PickleMachine, values: Iterable[Any]) -> set[Any]:
    return {_key(machine, value) for value in values}


def _add_items(machine: PickleMachine, _: None) -> None:
    values = _keys(machine, machine.since_mark())
    machine.last(set, "set").update(values)


def _put(machine: PickleMachine, number: int | None) -> None:
    machine.memo[len(machine.memo) if number is None else number] = machine.top()


def _get(machine: PickleMachine, number: int) -> None:
    if number not in machine.memo:
        raise machine.wrong(f"it refers to its value {number}, which does not exist yet")
    machine.push(machine.memo[number])


def _named(machine: PickleMachine, module: Any, name: Any) -> None:
    # The text of nested tuples that share their parts doubles with each level: types come first
    if not isinstance(module, str) or not isinstance(name, str):
        raise machine.wrong(f"it asks for something by {_called(module)} and {_called(name)}")
    full = f"{module} {name}"
    makes = next((makes for form, makes in _NAMES.items() if re.fullmatch(form, full)), None)
    if makes is None:
        import_name = f"{short(module)}.{short(name)}"
        raise machine.wrong(
            f"it asks for `{import_name}`, which is none of what a scenario is made of"
        )
    machine.push(PickledName(full.replace(" ", "."), makes))


def _reduce(machine: PickleMachine, _: None) -> None:
    arguments, named = machine.pop(), machine.pop()
    if not isinstance(named, PickledName) or not isinstance(arguments, tuple):
        raise machine.wrong(f"it calls {_called(named)}")
    match named.makes, arguments:
        case "array", _:
            machine.push(PickledArray())
        case "array of bytes", (
            bytes() as raw,
            np.dtype() as kind,
            tuple() as shape,
            str() as order,
        ):
            machine.push(_array(machine, shape, kind, raw, order == "F"))
        case "dtype", (str() as text, *_) if _DTYPE.fullmatch(text):
            machine.push(PickledArray(np.dtype(text)))
        case "scalar", (np.dtype() as kind, bytes() as raw) if len(raw) == kind.itemsize:
            machine.push(np.frombuffer(raw, kind)[0].item())
        case ("default dict", (PickledName() | None,)) | ("default dict" | "dict", ()):
            machine.push({})
        case "set", () | (list() | tuple(),):
            values = arguments[0] if arguments else ()
            machine.copy(len(values))
            machine.push(_keys(machine, values))
        case "bytes", ():
            machine.push(b"")
        case "bytes of text", (str() as text, str() as encoding) if encoding == "latin1":
            machine.copy(len(text))
            machine.push(text.encode("latin1", "replace"))
        case _:
            raise machine.wrong(f"it calls `{named.name}` with what that does not take")


def _build(machine: PickleMachine, _: None) -> None:
    state, target = machine.pop(), machine.pop()
    if not isinstance(target, PickledArray) or not isinstance(state, tuple):
        raise machine.wrong(f"it gives {_called(target)} a state")
    match target.value, state:
        case np.dtype() as kind, (_, str() as order, None, None, None, *_) if order in _ORDERS:
            way: Literal["<", ">", "="] = "<" if order == "<" else ">" if order == ">" else "="
            target.value = kind if way == "=" else kind.newbyteorder(way)
        case None, (_, tuple() as shape, np.dtype() as kind, bool() as is_fortran, bytes() as raw):
            target.value = _array(machine, shape, kind, raw, is_fortran)
        case _:
            raise machine.wrong("it gives an array a state that none has")
    machine.push(target)


def _array(
    machine: PickleMachine,
    shape: tuple[Any, ...],
    kind: np.dtype[Any],
    raw: bytes,
    is_fortran: bool,
) -> np.ndarray[Any, Any]:
    """An array that uses the file's bytes, without allocating memory."""
    sizes = [size for size in shape if type(size) is int and 0 <= size <= len(machine.data)]
    if len(sizes) < len(shape) or len(shape) > MOST_AXES or not kind.itemsize:
        raise machine.wrong("an array has a shape that none has")
    if kind.itemsize > _LARGEST_ITEM_BYTES or prod(sizes) * kind.itemsize != len(raw):
        why = f"an array of the shape {tuple(sizes)} has {len(raw):,} bytes"
        raise machine.wrong(why)
    return np.frombuffer(raw, kind).reshape(tuple(sizes), order="F" if is_fortran else "C")


_ACTIONS: Mapping[bytes, Callable[[PickleMachine, Any], object]] = MappingProxyType(
    {
        b"\x80": _protocol,
        b"\x95": lambda *_: None,
        b"N": lambda machine, _: machine.push(None),
        b"\x88": lambda machine, _: machine.push(True),
        b"\x89": lambda machine, _: machine.push(False),
        b"\x8a": _whole,
        **dict.fromkeys((b"J", b"K", b"M", b"G"), PickleMachine.push),
        **dict.fromkeys((b"\x8c", b"X", b"\x8d"), PickleMachine.push),
        **dict.fromkeys((b"C", b"B", b"\x8e"), PickleMachine.push),
        b"\x96": lambda machine, content: machine.push(bytes(content)),
        b"]": lambda machine, _: machine.push([]),
        b"}": lambda machine, _: machine.push({}),
        b"\x8f": lambda machine, _: machine.push(set()),
        b")": lambda machine, _: machine.push(()),
        b"\x85": _tuple(1),
        b"\x86": _tuple(2),
        b"\x87": _tuple(3),
        b"t": lambda machine, _: machine.push(tuple(map(_settled, machine.since_mark()))),
        b"a": lambda machine, _: _add(machine, [machine.pop()]),
        b"e": lambda machine, _: _add(machine, machine.since_mark()),
        b"s": lambda machine, _: _set_items(machine, [machine.pop(), machine.pop()][::-1]),
        b"u": lambda machine, _: _set_items(machine, machine.since_mark()),
        b"\x90": _add_items,
        b"\x91": lambda machine, _: machine.push(_keys(machine, machine.since_mark())),
        b"(": lambda machine, _: machine.marks.append(len(machine.stack)),
        b"0": lambda machine, _: machine.pop(),
        b"1": lambda machine, _: machine.since_mark(),
        **dict.fromkeys((b"\x94", b"q", b"r"), _put),
        **dict.fromkeys((b"h", b"j"), _get),
        b"c": lambda machine, full: _named(machine, *full.split(" ", 1)),
        b"\x93": lambda machine, _: _named(machine, *[machine.pop(), machine.pop()][::-1]),
        b"R": _reduce,
        b"b": _build,
    }
)
"""Opcode -> its action. All others would make an object of a class, or refer to external data."""
