"""Options, parameters and definitions of a rulebook, as its formulas find them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from rulec.logic.formula import Atom, Formula
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.arithmetic.size_limits import DEEPEST, MOST_PARTS, OverLimitError
from rulec.rulebook.overlay.rulebook_overlay import Overlay
from rulec.rulebook.rulebook_model import Traffic


@dataclass(slots=True)
class ConstantsAndMacros:
    """Constants and macros that formulas may use, on the day ``at`` (ISO).

    ``numbers`` are the parameters' values, computed on demand; None for a missing or wrong value.
    """

    overlay: Overlay
    at: str
    traffic: Traffic = ""
    numbers: dict[str, NumberByCases | None] = field(default_factory=dict)
    broken: set[str] = field(default_factory=set)
    """Definitions with a reported mistake."""
    defined: dict[Atom, Formula] = field(default_factory=dict)
    """The definitions used in the current rule, in the form of atoms, and what they mean."""
    parts: int = 0
    depth: int = 0
    """The number of parts of the current expression visited so far, and the current depth."""

    def begin(self) -> None:
        """Begin another expression, and reset the counts."""
        self.parts = self.depth = 0

    @contextmanager
    def one_deeper(self) -> Iterator[None]:
        """Visit one more part. Raises OverLimitError."""
        self.parts += 1
        if self.parts > MOST_PARTS:
            raise OverLimitError("large")
        if self.depth == DEEPEST:
            raise OverLimitError("deep")
        self.depth += 1
        try:
            yield
        finally:
            self.depth -= 1

    def names(self) -> list[str]:
        """The names of all options, parameters and definitions."""
        return [*self.overlay.options, *self.overlay.parameters, *self.overlay.definitions]

    def may_know(self, name: str) -> bool:
        """Whether unreadable text may declare a name."""
        return self.overlay.unsure or name in self.overlay.suspects
