"""Nodes of header lines."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from rulec.diagnostics import Span
from rulec.syntax.tree.formulas import NumberLiteral
from rulec.syntax.tree.names import NOWHERE, Name, Text


@dataclass(frozen=True, slots=True)
class FileLine:
    """``rulebook NAME`` or ``vocabulary NAME``."""

    kind: Literal["rulebook", "vocabulary"]
    name: Name
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TitleLine:
    """``title "…"``."""

    text: Text
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class LawLine:
    """Header line of the law: ``law "…" as of DATE``.

    The date is ISO text, empty when not given.
    """

    text: Text
    as_of: str = ""
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class UseLine:
    """``use NAME``: a vocabulary."""

    name: Name
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ExtendsLine:
    """``extends NAME``: the rulebook that this one builds upon."""

    name: Name
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TrafficLine:
    """``traffic left`` or ``traffic right``."""

    side: Literal["left", "right"]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class SemanticsLine:
    """``semantics stutter`` or ``semantics finite``."""

    kind: Literal["stutter", "finite"]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class StepLine:
    """``step 0.5 s``: how far the states of examples are apart."""

    amount: NumberLiteral
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class PriorityLine:
    """Order of priority levels: ``priority a > b = c``.

    ``relations[i]`` stands between levels i and i + 1.
    """

    levels: tuple[Name, ...]
    relations: tuple[Literal[">", "="], ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


HeaderLine = (
    TitleLine
    | LawLine
    | UseLine
    | ExtendsLine
    | TrafficLine
    | SemanticsLine
    | StepLine
    | PriorityLine
)
