"""The operators of Kleene's strong three-valued logic, on columns of truths."""

from __future__ import annotations

import numpy as np

from rulec.logic.fold import Algebra
from rulec.trace.partly_known.partly_known_values import Truth

TRUE, FALSE = Truth.known(np.array(True)), Truth.known(np.array(False))
UNKNOWN = Truth(FALSE.sure, TRUE.sure)

KLEENE_COLUMNS: Algebra[Truth] = Algebra(
    proposition=lambda _: UNKNOWN,
    constant=lambda value: Truth.known(np.asarray(value)),
    negation=Truth.__invert__,
    conjunction=Truth.__and__,
    disjunction=Truth.__or__,
    equivalence=Truth.same_as,
)
"""The operators; the values of propositions depend on the columns."""
