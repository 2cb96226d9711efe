"""The node of a whole file."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from rulec.diagnostics import Span
from rulec.syntax.tree.declarations import Declaration
from rulec.syntax.tree.definitions import Definition
from rulec.syntax.tree.header import (
    ExtendsLine,
    LawLine,
    PriorityLine,
    SemanticsLine,
    StepLine,
    TitleLine,
    TrafficLine,
    UseLine,
)
from rulec.syntax.tree.names import NOWHERE, Name
from rulec.syntax.tree.rules import RuleItem


@dataclass(frozen=True, slots=True)
class BrokenItem:
    """Unreadable item; it may have declared any of ``names``.

    ``word`` is its first word, ``"rule"`` for a rule whose head could not be read. A ``nameless``
    one lacks the name that it declares.
    """

    names: frozenset[str]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    word: str = ""
    nameless: bool = False


Item = Declaration | Definition | RuleItem | BrokenItem


@dataclass(frozen=True, slots=True)
class File:
    """Syntax tree of a file; ``name`` is None if unreadable."""

    kind: Literal["rulebook", "vocabulary"]
    name: Name | None
    title: TitleLine | None = None
    law: LawLine | None = None
    uses: tuple[UseLine, ...] = ()
    items: tuple[Item, ...] = ()
    complete: bool = True
    """False when a header line could not be read, or anything that might be one."""
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    extends: ExtendsLine | None = None
    traffic: TrafficLine | None = None
    semantics: SemanticsLine | None = None
    step: StepLine | None = None
    priorities: tuple[PriorityLine, ...] = ()
