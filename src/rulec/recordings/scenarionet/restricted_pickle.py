"""Pickles of plain data and NumPy arrays, read without running anything that they name.

See CPython's ``pickletools``, which documents the machine and its opcodes; protocols 2 to 5.
Python's own reader calls whatever a pickle names; this one knows a few names, builds their values
itself, and refuses all others.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from math import prod
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.encodings.wire_format import wire_file
from rulec.recordings.encodings.xml_element import short
from rulec.recordings.scenarionet.pickle_machine import (
    MOST_OPCODES,
    PickledArray,
    PickledName,
    PickleMachine,
    called,
)

LONGEST_NAME = 200
MOST_AXES = 4
_OLDEST, _NEWEST = 2, 5
_LARGEST_KEY = 1 << 63
_LARGEST_ITEM_BYTES = 4096

_ARRAY_CORES = ("numpy.core.multiarray", "numpy._core.multiarray")
_NUMERIC_CORES = ("numpy.core.numeric", "numpy._core.numeric")
_NAMES: Mapping[str, str] = MappingProxyType(
    {
        **{f"{core} _reconstruct": "array" for core in _ARRAY_CORES},
        **{f"{core} scalar": "scalar" for core in _ARRAY_CORES},
        **{f"{core} _frombuffer": "array of bytes" for core in _NUMERIC_CORES},
        "numpy ndarray": "class",
        "numpy dtype": "dtype",
        "collections defaultdict": "default dict",
        "collections OrderedDict": "dict",
        **dict.fromkeys(("builtins set", "builtins frozenset"), "set"),
        **dict.fromkeys(("__builtin__ set", "__builtin__ frozenset"), "set"),
        **{
            f"{module} {name}": "class"
            for module in ("builtins", "__builtin__")
            for name in ("int", "long", "float", "str", "bool", "list", "dict")
        },
        **dict.fromkeys(("builtins bytes", "__builtin__ bytes"), "bytes"),
        "_codecs encode": "bytes of text",
    }
)
_ORDERS = frozenset("<>|=")
_DTYPE = re.compile(r"[<>|=]?(?:b1|[iu][1248]|f[248]|[US][0-9]{1,4})")


def read_pickle(path: Path, form: BinaryFormat) -> Any:
    """The value in a pickle: ``None``, numbers, texts, bytes, lists, tuples, dicts, sets, arrays.

    A container may contain itself, so callers must bound their traversal. Raises RulecError R0610
    for any other or broken content, with its byte, R0701 for a file that cannot be read.
    """
    data = wire_file(path, form).data
    machine = PickleMachine(data, path, form)
    if data[0] != 0x80:
        raise machine.wrong("it does not begin with a protocol, as pickles since protocol 2 do")
    return _run(machine)


def _run(machine: PickleMachine) -> Any:
    """The value of a whole pickle."""
    for _ in range(MOST_OPCODES):
        machine.begin = machine.place
        opcode = machine.take(1)
        if opcode == b".":
            return _settled(machine.pop())
        action = _ACTIONS.get(opcode)
        if action is None:
            raise machine.wrong(f"it has the opcode {opcode!r}, which no scenario needs")
        action(machine)
    raise machine.wrong(f"it has more than {MOST_OPCODES:,} opcodes")


def _settled(value: Any) -> Any:
    """A value to put into a container: an array must be complete by then."""
    return value.value if isinstance(value, PickledArray) and value.value is not None else value


def _protocol(machine: PickleMachine) -> None:
    protocol = machine.number("<B")
    if not _OLDEST <= protocol <= _NEWEST:
        raise machine.wrong(f"it is of protocol {protocol}; {_OLDEST} to {_NEWEST} are read")


def _whole(machine: PickleMachine) -> None:
    content = machine.counted("<B")
    if len(content) > 8:
        raise machine.wrong(f"it has a whole number of {len(content)} bytes; at most 8 are read")
    machine.push(int.from_bytes(content, "little", signed=True))


def _text(form: str) -> Callable[[PickleMachine], None]:
    def action(machine: PickleMachine) -> None:
        try:
            machine.push(machine.counted(form).decode("utf-8", "surrogatepass"))
        except UnicodeDecodeError:
            raise machine.wrong("a text is not UTF-8") from None

    return action


def _pushes(value_of: Callable[[PickleMachine], Any]) -> Callable[[PickleMachine], None]:
    def action(machine: PickleMachine) -> None:
        machine.push(value_of(machine))

    return action


def _tuple(count: int) -> Callable[[PickleMachine], None]:
    def action(machine: PickleMachine) -> None:
        values = [_settled(machine.pop()) for _ in range(count)]
        machine.push(tuple(reversed(values)))

    return action


def _append(machine: PickleMachine) -> None:
    value = _settled(machine.pop())
    machine.last(list, "list").append(value)


def _appends(machine: PickleMachine) -> None:
    values = machine.since_mark()
    machine.last(list, "list").extend(map(_settled, values))


def _key(machine: PickleMachine, key: Any) -> Any:
    """A dictionary key of a type for which a file cannot choose many keys with equal hashes."""
    if isinstance(key, str) or (isinstance(key, int | None) and abs(key or 0) < _LARGEST_KEY):
        return key
    raise machine.wrong(f"{called(key)} is a key; texts and whole numbers may be")


def _set_items(machine: PickleMachine, values: list[Any]) -> None:
    target = machine.last(dict, "dictionary")
    if len(values) % 2:
        raise machine.wrong("a key has no value")
    for key, value in zip(values[::2], values[1::2], strict=True):
        target[_key(machine, key)] = _settled(value)


def _set_item(machine: PickleMachine) -> None:
    value, key = machine.pop(), machine.pop()
    _set_items(machine, [key, value])


def _add_items(machine: PickleMachine) -> None:
    values = machine.since_mark()
    machine.last(set, "set").update([_key(machine, value) for value in values])


def _mark(machine: PickleMachine) -> None:
    machine.marks.append(len(machine.stack))


def _memoize(machine: PickleMachine) -> None:
    _put(machine, len(machine.memo))


def _put(machine: PickleMachine, number: int) -> None:
    value = machine.pop()
    machine.push(value)
    machine.memo[number] = value


def _get(form: str) -> Callable[[PickleMachine], None]:
    def action(machine: PickleMachine) -> None:
        number = machine.number(form)
        if number not in machine.memo:
            raise machine.wrong(f"it refers to its value {number}, which does not exist yet")
        machine.push(machine.memo[number])

    return action


def _named(machine: PickleMachine, module: Any, name: Any) -> None:
    # The text of nested tuples that share their parts doubles with each level: types come first
    if not isinstance(module, str) or not isinstance(name, str):
        raise machine.wrong(f"it asks for something by {called(module)} and {called(name)}")
    full = f"{module} {name}"
    if full not in _NAMES:
        import_name = f"{short(module)}.{short(name)}"
        raise machine.wrong(
            f"it asks for `{import_name}`, which is none of what a scenario is made of"
        )
    machine.push(PickledName(full.replace(" ", "."), _NAMES[full]))


def _global(machine: PickleMachine) -> None:
    parts = []
    for _ in range(2):
        end = machine.data.find(b"\n", machine.place, machine.place + LONGEST_NAME)
        if end < 0:
            raise machine.wrong("it asks for something with a long name")
        parts.append(machine.take(end - machine.place).decode("utf-8", "replace"))
        machine.take(1)
    _named(machine, *parts)


def _stack_global(machine: PickleMachine) -> None:
    name, module = machine.pop(), machine.pop()
    _named(machine, module, name)


def _reduce(machine: PickleMachine) -> None:
    arguments, named = machine.pop(), machine.pop()
    if not isinstance(named, PickledName) or not isinstance(arguments, tuple):
        raise machine.wrong(f"it calls {called(named)}")
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
        case "default dict", (PickledName() | None,) | ():
            machine.push({})
        case "dict", ():
            machine.push({})
        case "set", (list() | tuple() as values,):
            machine.copy(len(values))
            machine.push({_key(machine, value) for value in values})
        case "bytes", ():
            machine.push(b"")
        case "set", ():
            machine.push(set())
        case "bytes of text", (str() as text, str() as encoding) if encoding == "latin1":
            machine.copy(len(text))
            machine.push(text.encode("latin1", "replace"))
        case _:
            raise machine.wrong(f"it calls `{named.name}` with what that does not take")


def _build(machine: PickleMachine) -> None:
    state, target = machine.pop(), machine.pop()
    if not isinstance(target, PickledArray) or not isinstance(state, tuple):
        raise machine.wrong(f"it gives {called(target)} a state")
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


def _no_more(machine: PickleMachine) -> None:
    machine.pop()


def _pop_mark(machine: PickleMachine) -> None:
    machine.since_mark()


_ACTIONS: Mapping[bytes, Callable[[PickleMachine], None]] = MappingProxyType(
    {
        b"\x80": _protocol,
        b"\x95": lambda machine: machine.number("<Q") and None,
        b"N": _pushes(lambda _: None),
        b"\x88": _pushes(lambda _: True),
        b"\x89": _pushes(lambda _: False),
        b"J": _pushes(lambda machine: machine.number("<i")),
        b"K": _pushes(lambda machine: machine.number("<B")),
        b"M": _pushes(lambda machine: machine.number("<H")),
        b"\x8a": _whole,
        b"G": _pushes(lambda machine: machine.number(">d")),
        b"\x8c": _text("<B"),
        b"X": _text("<I"),
        b"\x8d": _text("<Q"),
        b"C": _pushes(lambda machine: machine.counted("<B")),
        b"B": _pushes(lambda machine: machine.counted("<I")),
        b"\x8e": _pushes(lambda machine: machine.counted("<Q")),
        b"\x96": _pushes(lambda machine: machine.counted("<Q")),
        b"]": _pushes(lambda _: []),
        b"}": _pushes(lambda _: {}),
        b"\x8f": _pushes(lambda _: set()),
        b")": _pushes(lambda _: ()),
        b"\x85": _tuple(1),
        b"\x86": _tuple(2),
        b"\x87": _tuple(3),
        b"t": _pushes(lambda machine: tuple(map(_settled, machine.since_mark()))),
        b"a": _append,
        b"e": _appends,
        b"s": _set_item,
        b"u": lambda machine: _set_items(machine, machine.since_mark()),
        b"\x90": _add_items,
        b"\x91": _pushes(lambda machine: {_key(machine, x) for x in machine.since_mark()}),
        b"(": _mark,
        b"0": _no_more,
        b"1": _pop_mark,
        b"\x94": _memoize,
        b"q": lambda machine: _put(machine, machine.number("<B")),
        b"r": lambda machine: _put(machine, machine.number("<I")),
        b"h": _get("<B"),
        b"j": _get("<I"),
        b"c": _global,
        b"\x93": _stack_global,
        b"R": _reduce,
        b"b": _build,
    }
)
"""Opcode -> its action. None: it would make an object of a class, or refer to external data."""
