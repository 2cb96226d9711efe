"""Histories of rules and constants in a chain of rulebooks, and the tree of extensions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

from rulec.syntax import tree
from rulec.value_display import Rows, short_repr

LineageAction = Literal["declared", "overridden", "confirmed", "softened", "dropped", "silent"]

ConstantKind = Literal["option", "parameter", "definition"]


@dataclass(frozen=True, slots=True)
class BookHeader:
    """A rulebook of a family: its title, law, file (base name) and base."""

    name: str
    title: str = ""
    law: str = ""
    as_of: str = ""
    file: str = ""
    extends: str = ""


@dataclass(frozen=True, slots=True)
class LineageStep:
    """A change that one book made to a rule.

    ``clauses`` are the kinds of clauses that an override or a softening changed. ``rule`` is the
    rule after the change, None if it is gone. It ``gives_law`` if from then on the rule is the
    book's own law, by a provision that it cites. ``lost`` are the inherited exceptions that it
    replaces, as they were written.
    """

    book: str
    deed: LineageAction
    rule: tree.RuleItem | None
    clauses: tuple[str, ...] = ()
    because: str = ""
    gives_law: bool = False
    lost: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class RuleHistory:
    """A rule, or a silent topic, and its changes in order."""

    __repr__ = short_repr

    name: str
    steps: tuple[LineageStep, ...]

    @property
    def last(self) -> LineageStep:
        """The last change."""
        return self.steps[-1]

    @property
    def rule(self) -> tree.RuleItem | None:
        """The final version of the rule; None if it is gone."""
        return self.last.rule

    @property
    def cited_by(self) -> str:
        """The book whose law it is: the last that declared or confirmed it or set its ``cite``."""
        saying = [step for step in self.steps if step.gives_law]
        return saying[-1].book if saying else ""

    def before(self, book: str) -> tree.RuleItem | None:
        """The rule as a book inherited it, or None."""
        earlier = [step for step in self.steps if step.book != book]
        return earlier[-1].rule if earlier else None


@dataclass(frozen=True, slots=True)
class ConstantValue:
    """A value or meaning that a book gave a constant, as written.

    ``current`` marks the one that applies. ``cite`` is the provision that it is from, ``note`` the
    comment beside it. ``head`` is set if this book gave a definition other parameters than the last
    one.
    """

    book: str
    text: str
    since: str = ""
    until: str = ""
    current: bool = False
    cite: str = ""
    note: str = ""
    head: str = ""

    @property
    def written(self) -> str:
        """The text, after the definition's own head if that is another."""
        return f"{self.head} = {self.text}" if self.head else self.text


@dataclass(frozen=True, slots=True)
class ConstantHistory:
    """An option, parameter or definition with all its values in order.

    ``head`` is how it is written when used: its name, with a definition's parameters as the last
    book gives them. ``used``: some rule refers to it, directly or indirectly.
    """

    kind: ConstantKind
    name: str
    head: str
    settings: tuple[ConstantValue, ...]
    used: bool = False


@dataclass(frozen=True, slots=True)
class BookLineage(Rows):
    """A chain of rulebooks, the most general first, with all histories."""

    __repr__ = short_repr

    books: tuple[BookHeader, ...]
    rules: tuple[RuleHistory, ...]
    provisions: tuple[ConstantHistory, ...]

    @property
    def book(self) -> str:
        """The name of the rulebook at the end of the chain."""
        return self.books[-1].name

    @property
    def own_law(self) -> frozenset[str]:
        """The books whose law is the last book's own: those from the last one that names a law."""
        named = [number for number, header in enumerate(self.books) if header.law]
        return frozenset(header.name for header in self.books[named[-1] if named else -1 :])

    def inherited_from(self, history: RuleHistory) -> str:
        """The book whose law a rule is, if the last book has not confirmed it; else empty."""
        own = history.rule is None or history.cited_by in self.own_law
        return "" if own else history.cited_by

    def rows(self) -> list[dict[str, Any]]:
        """One row per rule."""
        return [
            {"rule": rule.name, "books": [step.book for step in rule.steps]} for rule in self.rules
        ]


@dataclass(frozen=True, slots=True)
class ExtensionTree:
    """A rulebook and those that extend it directly, in alphabetical order."""

    book: BookHeader
    children: tuple[ExtensionTree, ...] = ()


def extension_forest(members: Iterable[BookHeader]) -> tuple[ExtensionTree, ...]:
    """Every rulebook once, below the one that it extends, sorted by name.

    Roots extend no rulebook, or one that is not included. Rulebooks in a cycle are placed below the
    first of them by name.
    """
    by_name = {header.name: header for header in sorted(members, key=lambda header: header.name)}
    placed: set[str] = set()

    def branch(name: str) -> ExtensionTree:
        placed.add(name)
        children = [
            branch(child)
            for child, header in by_name.items()
            if header.extends == name and child not in placed
        ]
        return ExtensionTree(by_name[name], tuple(children))

    roots = [name for name, header in by_name.items() if header.extends not in by_name]
    trees = [branch(name) for name in (*roots, *by_name) if name not in placed]
    return tuple(sorted(trees, key=lambda extension_tree: extension_tree.book.name))
