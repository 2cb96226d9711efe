"""A rulebook as meant: names resolved, types checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from rulec.diagnostics import Span
from rulec.logic.formula import Formula
from rulec.vocabulary import Vocabulary

Strength = Literal["hard", "soft"]


@dataclass(frozen=True, slots=True)
class Variable:
    """``name: type`` in a rule's head."""

    name: str
    type: str


ExampleState = Mapping[tuple[str, tuple[str, ...]], bool | str]
"""(declaration, variables) -> value: what one state of an example mentions."""


@dataclass(frozen=True, slots=True)
class Example:
    """A trace that its rule must accept or reject; unmentioned values take their defaults."""

    accepts: bool
    states: tuple[ExampleState, ...]
    label: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)
    state_spans: tuple[Span, ...] = field(default=(), compare=False, repr=False)
    """Where each state is written; empty for an example that was not read from a text."""


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule. Without variables it speaks of ego and the world alone."""

    name: str
    strength: Strength
    variables: tuple[Variable, ...]
    formula: Formula
    cite: str = ""
    says: str = ""
    examples: tuple[Example, ...] = ()
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A file that went into a rulebook, by its base name and its content's SHA-256."""

    name: str
    sha256: str


@dataclass(frozen=True)
class Rulebook:
    """A jurisdiction's rules over one vocabulary."""

    name: str
    vocabulary: Vocabulary
    rules: tuple[Rule, ...]
    title: str = ""
    law: str = ""
    as_of: str = ""
    sources: tuple[SourceFile, ...] = ()
