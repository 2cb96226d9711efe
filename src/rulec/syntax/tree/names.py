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
    """Text in double quotes; ``value`` has no quotes and no escapes."""

    value: str
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Parameter:
    """Parameter with its type: ``name: type``.

    In a declaration, not in a rule's head, the type may be left out.
    """

    name: Name
    type: Name | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
