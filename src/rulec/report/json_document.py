"""JSON outputs: typed documents, turned by msgspec into data and schemas.

A document's class is its JSON: the fields are the keys, in this order, and one that is ``UNSET``
is not there. ``docs/schemas`` is generated from the classes, see ``src/tools/json_schemas.py``.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cache
from types import NoneType, UnionType
from typing import Any, Literal, TypeAlias, TypeVar, Union, get_args, get_origin

import msgspec
from msgspec import UnsetType

Number = int | float
_NOTHING = object()
Inside: TypeAlias = Callable[[Any], Any]
Filled = TypeVar("Filled", bound=msgspec.Struct)


class JsonPart(msgspec.Struct, frozen=True, kw_only=True):
    """An object inside of a document."""


class JsonDocument(msgspec.Struct, frozen=True, kw_only=True):
    """A whole output, or a line of one.

    ``version`` grows with every change that readers have to know of: a field that is removed, or
    that changes its meaning. Fields may be added without a new version.
    """

    version: Literal[1] = 1


def filled(kind: type[Filled], *sources: object, **own: Any) -> Filled:
    """Make a part from its ``own`` fields and, for others, attributes of the first source with any.

    Parts inside of it are made of what the source has in their place. A field that may be absent is
    left out if nothing has it or it is empty; an empty text is null where null is allowed.
    """
    values = {}
    for name, required, nullable, inside in _fields(kind):
        if name in own:
            value = own[name]
            if value is None and not (required or nullable):
                continue
        else:
            for source in sources:
                value = getattr(source, name, _NOTHING)
                if value is not _NOTHING:
                    break
            else:
                if required:
                    raise AttributeError(name)
                continue
            if not (value or required or isinstance(value, int | float)):
                continue
        if nullable and value == "":
            value = None
        values[name] = value if inside is None else inside(value)
    return kind(**values)


@cache
def _fields(kind: type[msgspec.Struct]) -> list[tuple[str, bool, bool, Inside | None]]:
    """Each field's name, whether it is required, may be null, and what makes parts in it."""
    return [
        (field.name, field.required, NoneType in get_args(field.type), _inside(field.type))
        for field in msgspec.structs.fields(kind)
        if field.name != "version"
    ]


def _inside(hint: Any) -> Inside | None:
    """What makes the parts in a field of this type, if there are any."""
    if isinstance(hint, type) and issubclass(hint, JsonPart):
        plain = (hint, str, int, float, NoneType, UnsetType)
        return lambda value: value if isinstance(value, plain) else filled(hint, value)
    make = next(filter(None, map(_inside, get_args(hint))), None)
    if make is None or get_origin(hint) in (Union, UnionType):
        return make
    if get_origin(hint) is Mapping:
        return lambda value: {name: make(item) for name, item in value.items()} if value else value
    return lambda value: [make(item) for item in value] if value else value


def made_class(
    name: str, fields: Mapping[str, Any], about: str, base: type[msgspec.Struct] = JsonPart
) -> Any:
    """Make the class of a part that has these fields with their types."""
    return msgspec.defstruct(
        name,
        [*fields.items()],
        bases=(base,),
        namespace={"__doc__": about},
        frozen=True,
        kw_only=True,
    )


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
