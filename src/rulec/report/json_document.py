"""JSON outputs: typed documents, turned by msgspec into data and schemas.

A document's class is its JSON: the fields are the keys, in this order, and one that is ``UNSET``
is not there. ``docs/schemas`` is generated from the classes, see ``src/tools/json_schemas.py``.
"""

from __future__ import annotations

import json
from fractions import Fraction
from functools import cache
from typing import Any, Literal, TypeVar

import msgspec

Number = int | float
Filled = TypeVar("Filled", bound=msgspec.Struct)


class JsonPart(msgspec.Struct, frozen=True, kw_only=True):
    """An object inside of a document."""


class JsonDocument(msgspec.Struct, frozen=True, kw_only=True):
    """A whole output, or a line of one.

    ``version`` grows with every change that readers have to know of: a field that is removed, or
    that changes its meaning. Fields may be added without a new version.
    """

    version: Literal[1] = 1


def filled(kind: type[Filled], source: object, **own: Any) -> Filled:
    """Make a part from its ``own`` fields and attributes of the source.

    The source is read for every required field that is not given.
    """
    names = [name for name in _required(kind) if name not in own]
    return kind(**{name: getattr(source, name) for name in names}, **own)


@cache
def _required(kind: type[msgspec.Struct]) -> list[str]:
    return [field.name for field in msgspec.structs.fields(kind) if field.required]


def as_line(document: msgspec.Struct) -> str:
    """Write a document on one line."""
    return _ENCODER.encode(as_builtins(document))


def as_indented(document: Any) -> str:
    """Write a document, or a list of them, over several lines."""
    return json.dumps(as_builtins(document), ensure_ascii=False, indent=2)


def as_builtins(document: Any) -> Any:
    """Turn a document into dicts, lists, texts and numbers.

    ``json`` writes them: it spells numbers as Python does, and allows integers of any size.
    """
    return msgspec.to_builtins(document, enc_hook=_plain)


_ENCODER = json.JSONEncoder(ensure_ascii=False)


def _plain(value: object) -> object:
    """Convert views of dicts, fractions and a library's number types to plain values."""
    if isinstance(value, Fraction) and value.denominator == 1:
        return int(value)
    if isinstance(value, float | Fraction):
        return float(value)
    try:
        return dict(value)  # type: ignore[call-overload]
    except (TypeError, ValueError):
        raise NotImplementedError from None
