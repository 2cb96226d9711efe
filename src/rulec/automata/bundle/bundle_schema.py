"""The fields of a compiled rulebook's file, version 3, as docs/compiled.md describes them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import msgspec


class Source(msgspec.Struct, forbid_unknown_fields=True):
    """A file that went into it."""

    name: str
    sha256: str


class Enumeration(msgspec.Struct, tag="enumeration", tag_field="kind", forbid_unknown_fields=True):
    """A state with one of several values."""

    name: str
    parameters: list[str]
    values: list[str]
    default: str | None


class Signal(msgspec.Struct, tag="signal", tag_field="kind", forbid_unknown_fields=True):
    """A Boolean."""

    name: str
    parameters: list[str]
    default: bool | None


class Quantity(msgspec.Struct, tag="quantity", tag_field="kind", forbid_unknown_fields=True):
    """A number with a unit."""

    name: str
    parameters: list[str]
    unit: str
    default: float | None


class Vocabulary(msgspec.Struct, forbid_unknown_fields=True):
    """What the rules speak of."""

    name: str
    types: dict[str, str | None]
    declarations: list[Enumeration | Signal | Quantity]


class Read(msgspec.Struct, tag="state", tag_field="kind", forbid_unknown_fields=True):
    """An enumeration or a signal that a machine asks of a state."""

    name: str
    variables: list[str]
    values: list[str]
    others: bool


class Threshold(msgspec.Struct, forbid_unknown_fields=True):
    """A place on the number line; the limit is a fraction."""

    limit: str
    inclusive: bool


class NumberRead(msgspec.Struct, tag="number", tag_field="kind", forbid_unknown_fields=True):
    """A number that a machine asks of a state."""

    terms: Any
    thresholds: list[Threshold]


WRITTEN_AS = {
    "successors": "following",
    "outputs": "accepting",
    "rejecting_sink": "dead",
    "accepting_sink": "safe",
}
"""Fields of a Mealy monitor by the names that version 3 of the format gives them."""


class Machine(msgspec.Struct, forbid_unknown_fields=True, rename=WRITTEN_AS):
    """A rule as a table."""

    reads: list[Read | NumberRead]
    letters: list[int]
    successors: list[list[int]]
    outputs: list[list[bool]]
    rejecting_sink: int | None
    accepting_sink: int | None


class Rule(msgspec.Struct, forbid_unknown_fields=True):
    """One rule."""

    name: str
    strength: Literal["hard", "soft"]
    level: str
    weight: str
    variables: list[tuple[str, str]]
    cite: str
    says: str
    source: str
    certainty: Literal["", "verified", "secondary", "unverified"]
    book: str
    step_s: str | None
    formula: str
    tree: Any
    machine: Machine
    hoa: str


class Fact(msgspec.Struct, forbid_unknown_fields=True):
    """What holds in every state, and where it is written: file and line, from 1."""

    variables: list[tuple[str, str]]
    formula: str
    tree: Any
    file: str
    line: Annotated[int, msgspec.Meta(ge=1)] | None


class Header(msgspec.Struct):
    """What is looked at first: is it such a file, and of which version?"""

    format: Literal["rulec compiled rulebook"]
    version: int


class File(msgspec.Struct, forbid_unknown_fields=True):
    """The whole file."""

    format: str
    version: int
    rulec: str
    spot: str
    name: str
    title: str
    law: str
    as_of: str
    sources: list[Source]
    semantics: Literal["stutter", "finite"]
    levels: list[str]
    priorities: list[tuple[str, str]]
    extends: list[str]
    at: str
    vocabulary: Vocabulary
    facts: list[Fact]
    rules: list[Rule]
    traffic: Literal["", "left", "right"] = ""
