"""Options, parameters and definitions of a rulebook, as its formulas find them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.arithmetic.size_limits import DEEPEST, MOST_PARTS, OverLimitError
from rulec.rulebook.overlay.rulebook_overlay import Overlay
from rulec.rulebook.rulebook_model import Traffic


@dataclass(slots=True)
class ConstantsAndMacros:
    """Constants and macros that formulas may use, on the day ``at`` (ISO).

    ``numbers`` are the parameters' values, None for one that has none or a wrong one, filled as
    they are asked for.
    """

    overlay: Overlay
    at: str
    traffic: Traffic = ""
    numbers: dict[str, NumberByCases | None] = field(default_factory=dict)
    broken: set[str] = field(default_factory=set)
    """Definitions with a mistake that has been reported."""
    parts: int = 0
    depth: int = 0
    """How much of the expression at hand has been looked at, and how deep in it we are."""

    def begin(self) -> None:
        """Begin another expression, whose parts are counted anew."""
        self.parts = self.depth = 0

    @contextmanager
    def one_deeper(self) -> Iterator[None]:
        """Look at one more part. Raises OverLimitError."""
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
        """Tell whether unreadable text may declare a name."""
        return self.overlay.unsure or name in self.overlay.suspects
