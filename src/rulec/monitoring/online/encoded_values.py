"""What is told of a declaration: its values, checked, and left of numbers only what matters."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from functools import partial
from operator import itemgetter
from typing import Any, Final, TypeAlias

from rulec.automata.thresholds import EXACT_IN_FLOATS
from rulec.monitoring.online.breakpoints import Floors
from rulec.vocabulary import Declaration, Quantity, Signal

Told: TypeAlias = tuple[Any, ...]
"""Values of an enumeration or a signal as they are, and of a quantity their digits.

The digit of a number is how many of the ``Floors`` it reaches; where every value matters, it is the
number itself.
"""

MISSING: Final = object()
"""In place of what is told of a value that is not given and has no default."""

Check: TypeAlias = Callable[[tuple[Any, ...]], Told]
"""From values what is told of them.

Raises a LookupError or a TypeError if one does not fit the declaration or needs a closer look;
values of an enumeration may be wrong.
"""

_NUMBERS = frozenset({int, float})


def check_of(declaration: Declaration, floors: Floors) -> Check:
    """What checks values of a declaration."""
    if isinstance(declaration, Signal):
        return _truths
    if isinstance(declaration, Quantity):
        those = floors[declaration.name]
        return _numbers if those is None else partial(_digits, those)
    return tuple


def default_told(declaration: Declaration, floors: Floors) -> Any:
    """What is told of a value that is not given. Raises as a ``Check``."""
    if declaration.default is None:
        return MISSING
    return check_of(declaration, floors)((declaration.default,))[0]


def values_of(names: Sequence[Any]) -> Callable[[Any], tuple[Any, ...]]:
    """What gets the values at these names or places; it raises a LookupError if there is none."""
    if len(names) > 1:
        return itemgetter(*names)
    if names:
        (name,) = names
        return lambda given: (given[name],)
    return lambda _: ()


def _truths(values: Told) -> Told:
    # As keys 1 and true are the same; as values of a signal they are not.
    for value in values:
        if value is not True and value is not False:
            raise LookupError
    return values


def _numbers(values: Told) -> Told:
    # Whole numbers and floats of this size that are equal have the same decimals. nan has no size.
    for value in values:
        if not -EXACT_IN_FLOATS <= value <= EXACT_IN_FLOATS or type(value) not in _NUMBERS:
            raise LookupError
    return values


def _digits(floors: Sequence[float], values: Told) -> Told:
    digits = tuple([bisect_right(floors, value) for value in values])
    # nan is above all floors.
    if 0 in digits or len(floors) in digits or not _NUMBERS.issuperset(map(type, values)):
        raise LookupError
    return digits
