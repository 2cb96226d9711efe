"""A compiled rulebook under another name, at each step of traces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook, Recompiler
from rulec.rulebook.files.edition_names import edition_names

MOST_BOOKS = 200
"""Renamed rulebooks are kept for this many, with what engines have prepared for them."""


def with_distinct_names(
    books: Sequence[CompiledRulebook], references: Sequence[str]
) -> list[CompiledRulebook]:
    """The rulebooks, those of one name with their ``references`` (names or paths) after it."""
    names = edition_names([book.name for book in books], references)
    return [
        book if book.name == name else renamed(book, name)
        for book, name in zip(books, names, strict=True)
    ]


def renamed(book: CompiledRulebook, name: str) -> CompiledRulebook:
    """The rulebook under another name, also if it is compiled for another step."""
    rules = tuple(
        replace(rule, book=name) if rule.book == book.name else rule for rule in book.rules
    )
    steps = None if book.recompile is None else _RenamedSteps(book.recompile, name)
    return replace(book, name=name, rules=rules, recompile=steps)


@dataclass
class _RenamedSteps:
    """A ``Recompiler`` under another name. A copy in another process starts with nothing kept."""

    steps: Recompiler
    name: str
    _kept: dict[int, tuple[CompiledRulebook, CompiledRulebook]] = field(
        default_factory=dict, repr=False
    )

    def __reduce__(self) -> tuple[type[_RenamedSteps], tuple[Recompiler, str]]:
        return _RenamedSteps, (self.steps, self.name)

    def __call__(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for a step. Raises RulecError as the compiler of the other name."""
        return self._renamed(self.steps(step_s))

    def judgeable_at(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for a step, without rules too large for that step."""
        return self._renamed(self.steps.judgeable_at(step_s))

    def _renamed(self, book: CompiledRulebook) -> CompiledRulebook:
        # By identity: comparing rulebooks takes longer than renaming one.
        if id(book) not in self._kept:
            if len(self._kept) >= MOST_BOOKS:
                self._kept.clear()
            self._kept[id(book)] = book, renamed(book, self.name)
        return self._kept[id(book)][1]
