"""Encodes syntax trees as lists of numbers, texts and lists, and decodes them.

A node is the number of its kind, the start and end of its span, then its other fields in order. A
tuple is ``_TUPLE`` and its items, a further span ``_SPAN``, start and end. A span that belongs to
no file has -1 for both.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from typing import Any

from rulec.diagnostics import Source, Span
from rulec.syntax import tree

_TUPLE, _SPAN = 0, 1

_KINDS: tuple[type[Any], ...] = tuple(
    kind
    for _, kind in sorted(vars(tree).items())
    if isinstance(kind, type) and is_dataclass(kind) and kind.__module__ == tree.__name__
)
_FIELDS = [[field.name for field in fields(kind) if field.name != "span"] for kind in _KINDS]
_FIRST = _SPAN + 1
_NUMBERS = {kind: number for number, kind in enumerate(_KINDS, _FIRST)}
_PLAIN = (str, int, float, type(None))


def encoded(file: tree.File, source: Source) -> list[Any]:
    """A file's tree as data.

    Raises TypeError for a node that occurs only in trees with mistakes.
    """

    def place(span: Span) -> tuple[int, int]:
        if span.source is source:
            return span.start, span.end
        if span is tree.NOWHERE:
            return -1, -1
        raise TypeError("a span of another text")

    def data_of(value: Any) -> Any:
        number = _NUMBERS.get(type(value))
        if number is not None:
            own = [data_of(getattr(value, name)) for name in _FIELDS[number - _FIRST]]
            return [number, *place(value.span), *own]
        if isinstance(value, tuple):
            return [_TUPLE, *map(data_of, value)]
        if isinstance(value, Span):
            return [_SPAN, *place(value)]
        if isinstance(value, _PLAIN):
            return value
        raise TypeError(f"a {type(value).__name__}")

    data = data_of(file)
    assert isinstance(data, list)
    return data


def decoded(data: Any, source: Source) -> tree.File:
    """The tree that ``encoded`` wrote for the same text.

    Raises TypeError, ValueError or LookupError for other data.
    """

    def span_of(start: int, end: int) -> Span:
        return Span(source, start, end) if start >= 0 else tree.NOWHERE

    def value_of(data: Any) -> Any:
        if data.__class__ is not list:
            return data
        number = data[0]
        if number == _TUPLE:
            return tuple([value_of(item) for item in data[1:]])
        if number == _SPAN:
            return span_of(data[1], data[2])
        _, start, end, *own = data
        kind: Callable[..., Any] = _KINDS[number - _FIRST]
        names = _FIELDS[number - _FIRST]
        values = {name: value_of(item) for name, item in zip(names, own, strict=True)}
        return kind(**values, span=span_of(start, end))

    file = value_of(data)
    if not isinstance(file, tree.File):
        raise TypeError("no tree of a file")
    return file
