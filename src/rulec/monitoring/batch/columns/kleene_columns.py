"""Three-valued truth of non-temporal formulas in all states of many traces.

Kleene's strong three-valued logic, as ``rulec.monitoring.state_view`` has it for one state.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rulec.logic.fold import Algebra

Mask = NDArray[np.bool_] | np.bool_


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Truth known to be true, and known to be false, as masks."""

    true: Mask
    false: Mask


UNKNOWN = Truth(np.False_, np.False_)


def known(values: Mask) -> Truth:
    """Truth that is known in every state."""
    return Truth(values, ~values)


def _equivalence(left: Truth, right: Truth) -> Truth:
    return Truth(
        (left.true & right.true) | (left.false & right.false),
        (left.true & right.false) | (left.false & right.true),
    )


KLEENE_COLUMNS: Algebra[Truth] = Algebra(
    proposition=lambda _: UNKNOWN,
    constant=lambda value: known(np.bool_(value)),
    negation=lambda operand: Truth(operand.false, operand.true),
    conjunction=lambda left, right: Truth(left.true & right.true, left.false | right.false),
    disjunction=lambda left, right: Truth(left.true | right.true, left.false & right.false),
    equivalence=_equivalence,
)
"""The operators; what a proposition is depends on the columns."""
