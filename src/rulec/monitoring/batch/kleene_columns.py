"""Formulas about one instant, for all states of many traces: true, false, or not known.

Kleene's strong three-valued logic, as ``rulec.monitoring.state_view`` has it for one state.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_] | np.bool_


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Where something is known to hold, and where it is known not to: columns, or one value."""

    true: Mask
    false: Mask


UNKNOWN = Truth(np.False_, np.False_)


def known(values: Mask) -> Truth:
    """What is known everywhere."""
    return Truth(values, ~values)


def negated(one: Truth) -> Truth:
    """Not."""
    return Truth(one.false, one.true)


def conjoined(one: Truth, other: Truth) -> Truth:
    """And, which one operand that is false settles."""
    return Truth(one.true & other.true, one.false | other.false)


def disjoined(one: Truth, other: Truth) -> Truth:
    """Or, which one operand that is true settles."""
    return Truth(one.true | other.true, one.false & other.false)


def alike(one: Truth, other: Truth) -> Truth:
    """Both or neither."""
    return Truth(
        (one.true & other.true) | (one.false & other.false),
        (one.true & other.false) | (one.false & other.true),
    )
