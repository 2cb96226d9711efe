"""Size limits of formulas, with definitions, conditions and exceptions expanded."""

from __future__ import annotations

from typing import Literal

from rulec.logic import formula as ltl
from rulec.logic.formula import operands_of

MOST_PARTS = 20_000
"""The most operators, atoms and comparisons of a rule's formula, including those within counts."""

DEEPEST = 240
"""The deepest nesting of operators, including those of expanded definitions."""

Limit = Literal["deep", "large"]


class OverLimitError(Exception):
    """An expression with expanded definitions exceeds ``DEEPEST`` or ``MOST_PARTS``."""

    def __init__(self, limit: Limit) -> None:
        super().__init__(limit)
        self.limit = limit


def exceeded_limit(formula: ltl.Formula) -> Limit | None:
    """The limit that a formula exceeds, if any; repeated parts count repeatedly."""
    rest = [(formula, 1)]
    parts = 0
    while rest:
        part, depth = rest.pop()
        parts += 1
        if depth > DEEPEST:
            return "deep"
        if parts > MOST_PARTS:
            return "large"
        terms = part.terms if isinstance(part, ltl.Comparison) else ()
        bodies = [term.body for _, term in terms if isinstance(term, ltl.Count)]
        rest += ((inner, depth + 1) for inner in (*operands_of(part), *bodies))
    return None
