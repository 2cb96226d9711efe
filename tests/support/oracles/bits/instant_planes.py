"""One long trace: a plane is a whole number with a bit for each instant.

Bit 0 is the last instant, so that what propagates from the future to the past, as ``until`` does,
propagates as carries do in an addition.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.logic.formula import Formula, Proposition
from rulec.logic.semantics import Semantics
from support.oracles.bits.plane_program import program_of

_MIRRORED = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))


def along(
    formula: Formula,
    n_instants: int,
    column: Callable[[Proposition], NDArray[Any]],
    semantics: Semantics = "stutter",
) -> bool:
    """Does a formula hold for a trace?

    Args:
        formula: the formula; its bounds are in steps.
        n_instants: how long the trace is: 1 or more.
        column: gives for an atom or a comparison ``n_instants`` values, false where 0.
        semantics: how the trace ends.
    """
    program = program_of(formula)
    more = 0 if semantics == "finite" else program.settling
    n_bits = n_instants + more
    algebra = _AlongTime(
        lambda one: _packed(column(one), more), n_bits, semantics == "finite", (1 << n_bits) - 1
    )
    return bool(program.run(algebra))


def _packed(values: NDArray[Any], more: int) -> int:
    """The plane of a column, its last value ``more`` times over."""
    packed = int.from_bytes(np.packbits(values), "big")
    packed >>= -len(values) % 8
    return packed << more | ((1 << more) - 1 if packed & 1 else 0)


@dataclass(frozen=True, slots=True)
class _AlongTime:
    """A row is 0 or 1."""

    given: Callable[[Proposition], int]
    n_instants: int
    ends: bool
    true: int

    def constant(self, value: bool) -> int:
        return self.true if value else 0

    def no(self, one: int) -> int:
        return one ^ self.true

    def both(self, one: int, other: int) -> int:
        return one & other

    def either(self, one: int, other: int) -> int:
        return one | other

    def differ(self, one: int, other: int) -> int:
        return one ^ other

    def ahead(self, one: int, steps: int) -> int:
        # Nothing beyond the last instant is worth moving.
        steps = min(steps, self.n_instants)
        moved = (one << steps) & self.true
        return moved | ((1 << steps) - 1) if one & 1 and not self.ends else moved

    def back(self, one: int, steps: int) -> int:
        return one >> steps

    def until(self, left: int | None, right: int) -> int:
        if left is None:
            # All bits from the lowest one on: it is before the last instant with ``right``.
            return (-(right & -right)) & self.true
        return _flooded(left, right)

    def since(self, left: int | None, right: int) -> int:
        if left is None:
            # All up to the first one, which is the highest bit, is after it.
            return (1 << right.bit_length()) - 1
        return self._mirrored(_flooded(self._mirrored(left), self._mirrored(right)))

    def given_first(self, proposition: Proposition) -> int:
        return self.first(self.given(proposition))

    def first(self, one: int) -> int:
        return one >> (self.n_instants - 1)

    def ever(self, one: int) -> int:
        return 1 if one else 0

    def opposite(self, row: int) -> int:
        return 1 - row

    def _mirrored(self, one: int) -> int:
        """The bits in reverse order."""
        n_bytes = (self.n_instants + 7) // 8
        data = one.to_bytes(n_bytes, "little").translate(_MIRRORED)
        return int.from_bytes(data, "big") >> (8 * n_bytes - self.n_instants)


def _flooded(left: int, right: int) -> int:
    """``right``, and the bits of ``left`` above it up to the first that is missing.

    A carry that enters a run of ones goes up to its end and leaves zeros behind.
    """
    entered = (right << 1) & left
    return right | (left & (~(left + entered) | entered))
