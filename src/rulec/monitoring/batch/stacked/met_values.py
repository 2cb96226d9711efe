"""The values that names take anywhere in traces in arrays, found for many names at once."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold
from rulec.monitoring.batch.stacked.stack import Stack
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.vocabulary import Enumeration
from rulec.vocabulary.partial_values import UNKNOWN as UNKNOWN_VALUE
from rulec.vocabulary.partial_values import PartialValue

TRUE, FALSE = Truth.known(np.array(True)), Truth.known(np.array(False))
UNKNOWN = Truth(FALSE.sure, TRUE.sure)

KLEENE_COLUMNS: Algebra[Truth] = Algebra(
    proposition=lambda _: UNKNOWN,
    constant=lambda value: Truth.known(np.asarray(value)),
    negation=Truth.__invert__,
    conjunction=Truth.__and__,
    disjunction=Truth.__or__,
    equivalence=Truth.same_as,
    identity=lambda _: TRUE,
)
"""The operators; the values of propositions depend on the columns."""

_BITS = {bits: 1 << np.arange(bits, dtype=f"u{bits // 8}") for bits in (8, 64)}
"""For each number the bit at its place."""


class MetValues:
    """The values of each name anywhere in the traces, or the range of its numbers.

    Raises UnencodableError.
    """

    def __init__(self, stack: Stack) -> None:
        self._stack = stack

    def with_default(self, name: str) -> int | None:
        """The values that a signal has anywhere, as bits; 0 if some are not known.

        None for a signal that no state contains and that has no default.
        """
        met = self.signals.get(name)
        if met is not None or name in self._stack.arity:
            return met or 0
        default = self._stack.default(name)
        return None if default is None or default is UNKNOWN_VALUE else 1 << int(default)

    def only_value(self, name: str) -> PartialValue | None:
        """The value that a signal has everywhere; None if it has several or some are not known.

        It is unknown if no state contains the signal.
        """
        declaration, met = self._stack.vocabulary.declarations[name], self.with_default(name)
        if met is None:
            return UNKNOWN_VALUE if self._stack.default(name) is UNKNOWN_VALUE else None
        if met == 0 or met & (met - 1):
            return None
        place = met.bit_length() - 1
        return declaration.values[place] if isinstance(declaration, Enumeration) else bool(place)

    def truth_anywhere(self, formula: ltl.Formula) -> Truth:
        """Whether a formula without temporal operators is true, or false, by the values that occur.

        Every variable stands for the same object.
        """
        return fold(formula, self._anywhere)

    @property
    def _anywhere(self) -> Algebra[Truth]:
        # Not stored: a reference cycle would keep all columns alive after their verdicts.
        return replace(KLEENE_COLUMNS, proposition=self._truth)

    def _truth(self, part: ltl.Proposition) -> Truth:
        if isinstance(part, ltl.Comparison):
            return UNKNOWN
        met = self.with_default(part.name)
        if not met:
            return UNKNOWN
        declaration, holds = self._stack.vocabulary.declarations[part.name], 1 << 1
        if isinstance(declaration, Enumeration):
            assert part.value is not None, "the rulebook has been checked"
            holds = 1 << declaration.values.index(part.value)
        if met == holds:
            return TRUE
        return UNKNOWN if met & holds else FALSE

    @cached_property
    def signals(self) -> dict[str, int]:
        """The values, as bits, of each signal whose values are all known and few enough."""
        bits_of: dict[str, int] = {}
        for name, column in self._stack.columns.items():
            values = column.values
            # Only quantities can be non-integers
            if column.unknown is not None or values.dtype.kind == "f" or not len(values):
                continue
            if values.dtype == bool:
                there = values.tobytes()  # looked at faster than an array, however short
                bits_of[name] = 2 * (1 in there) + (0 in there)
            elif (most := int(np.maximum.reduce(values))) < 64:
                bits = _BITS[8 if most < 8 else 64].take(values)
                bits_of[name] = int(np.bitwise_or.reduce(bits))
        return bits_of
