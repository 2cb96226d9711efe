"""Names, texts and places, of which all nodes are made."""

from __future__ import annotations

from dataclasses import dataclass, field

from rulec.diagnostics import Source, Span

NOWHERE = Span(Source("", ""), 0, 0)
"""The span of a node that was made by a program and not read from a file."""


@dataclass(frozen=True, slots=True)
class Name:
    """An identifier."""

    text: str
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Text:
    """A text in double quotes; ``value`` is what it means, without quotes and escapes."""

    value: str
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Parameter:
    """``name: type``; in a declaration, not in a rule's head, the type may be left out."""

    name: Name
    type: Name | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
