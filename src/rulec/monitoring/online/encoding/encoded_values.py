"""Encoders that check values, and the digits of encoded values.

Numbers are reduced to the breakpoints that they reach.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any, Final, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.mealy_monitor import NumberRead
from rulec.automata.thresholds import EXACT_IN_FLOATS, scale
from rulec.logic.free_names import names_in
from rulec.monitoring.state_validation import NUMBERS
from rulec.monitoring.uncertainty.state_letters.read_digits import ReadDigits
from rulec.trace.remembered import Remembered
from rulec.vocabulary import Declaration, Quantity, Signal
from rulec.vocabulary.partial_values import UNKNOWN, Interval, PartialValue

Breakpoints: TypeAlias = Mapping[str, tuple[float, ...] | None]
"""For each quantity the ``floor_of`` every rule's thresholds, ascending; None if all values matter.

The first is the least number that they distinguish, the last is the first one beyond.
"""

Encoded: TypeAlias = tuple[Any, ...]
"""Values of an enumeration or a signal as they are, and the digits of a quantity.

The digit of a number is how many of the ``Breakpoints`` it reaches, that of an interval the
``range`` of those of its numbers; where every value matters, both stand for themselves. So does
partial knowledge of an enumeration; what is entirely unknown is ``UNKNOWN_DIGIT``.
"""

MISSING: Final = object()
"""Replaces an encoded value that is not given and has no default."""

UNKNOWN_DIGIT: Final = object()
"""Replaces the digit of an unknown value.

Digits are kept as dictionary keys. The garbage collector would track keys that contain ``UNKNOWN``,
a member of an enumeration; it does not track a plain object.
"""

PARTIAL_DIGITS = frozenset({object, Interval, range})
"""The types of digits that are not known: of ``UNKNOWN_DIGIT``, and of bounds.

A range is no object that the garbage collector tracks, either.
"""

Encoder: TypeAlias = Callable[[tuple[Any, ...]], Encoded]
"""Encodes values.

Raises LookupError or TypeError if a value does not fit the declaration or needs closer inspection;
values of an enumeration are not checked.
"""


def breakpoints_of(rulebook: CompiledRulebook) -> Breakpoints:
    """The breakpoints of a vocabulary's quantities under all rules together."""
    floors: dict[str, set[float]] = {
        name: set()
        for name, declaration in rulebook.vocabulary.declarations.items()
        if isinstance(declaration, Quantity)
    }
    all_matter = set[str]()
    for rule in rulebook.rules:
        for read in rule.machine.reads:
            if isinstance(read, NumberRead):
                threshold_scale = scale(read)
                if threshold_scale.quantity is None:
                    all_matter.update(threshold_scale.names)
                else:
                    floors[threshold_scale.quantity.name].update(threshold_scale.floors)
    # Axioms may distinguish other numbers than rules do.
    all_matter.update(name for axiom in rulebook.axioms for name in names_in(axiom.formula))
    # A constant is the same number in all states, not only one that rules treat alike.
    all_matter.update(rulebook.vocabulary.constants)
    # Beyond this, the same floors no longer work for both integers and floats.
    most = float(EXACT_IN_FLOATS)
    return {
        name: None
        if name in all_matter
        else (-most, *sorted([floor for floor in own if -most < floor < most]), most)
        for name, own in floors.items()
    }


def encoder_of(declaration: Declaration, breakpoints: Breakpoints) -> Encoder:
    """The encoder of a declaration's values."""
    if isinstance(declaration, Signal):
        return _encode_truths
    if isinstance(declaration, Quantity):
        floors = breakpoints[declaration.name]
        return _encode_numbers if floors is None else partial(_encode_digits, floors)
    return tuple


def encoded_default(declaration: Declaration, breakpoints: Breakpoints) -> Any:
    """The encoding of a value that is not given. Raises like an ``Encoder``."""
    if declaration.default is None:
        return MISSING
    return encoder_of(declaration, breakpoints)((declaration.default,))[0]


def _encode_truths(values: tuple[Any, ...]) -> Encoded:
    # As keys, 1 and True are equal; as values of a signal they are not.
    for value in values:
        if value is not True and value is not False:
            return _encode_some_truths(values)
    return values


def _encode_some_truths(values: tuple[Any, ...]) -> Encoded:
    for value in values:
        if value is not True and value is not False and value is not UNKNOWN:
            raise LookupError
    return _with_unknown_digits(values)


def _with_unknown_digits(values: Iterable[Any]) -> Encoded:
    return tuple([UNKNOWN_DIGIT if value is UNKNOWN else value for value in values])


def _encode_numbers(values: tuple[Any, ...]) -> Encoded:
    # Equal integers and floats of this size have the same decimals; NaN compares as False.
    encode: Encoder = tuple
    for value in values:
        if value is UNKNOWN:
            encode = _with_unknown_digits
            continue
        for number in (value.low, value.high) if type(value) is Interval else (value,):
            if not -EXACT_IN_FLOATS <= number <= EXACT_IN_FLOATS or type(number) not in NUMBERS:
                raise LookupError
    return encode(values)


def _encode_digits(floors: Sequence[float], values: tuple[Any, ...]) -> Encoded:
    try:
        digits: Encoded = tuple([bisect_right(floors, value) for value in values])
    except TypeError:
        return tuple([_some_digits(floors, value) for value in values])
    # NaN sorts above all floors.
    if 0 in digits or len(floors) in digits or not NUMBERS.issuperset(map(type, values)):
        raise LookupError
    return digits


def _some_digits(floors: Sequence[float], value: Any) -> Any:
    if value is UNKNOWN:
        return UNKNOWN_DIGIT
    ends = (value.low, value.high) if type(value) is Interval else (value, value)
    first, last = bisect_right(floors, ends[0]), bisect_right(floors, ends[1])
    if first == 0 or last == len(floors) or not NUMBERS.issuperset(map(type, ends)):
        raise LookupError
    return digits_between(first, last)


def digits_between(first: int, last: int) -> int | range:
    """The digits from the first to the last one, or the only one."""
    return first if first == last else range(first, last + 1)


def decoded(encoded: Any, floors: Sequence[float] | None) -> PartialValue | None:
    """A value that rules treat like the one encoded, None if that is missing.

    ``floors`` are the breakpoints of a quantity of which not all values matter.
    """
    if encoded is MISSING:
        return None
    if encoded is UNKNOWN_DIGIT:
        return UNKNOWN
    value: PartialValue = encoded
    if floors is not None:
        first, last = (encoded[0], encoded[-1]) if type(encoded) is range else (encoded, encoded)
        low, high = floors[first - 1], floors[last - 1]
        value = low if first == last else Interval(low, high)
    return value


def digit_table(read: ReadDigits, floors: Sequence[float] | None) -> Remembered[Any, int]:
    """The digits, as bits, that a read of a single value may have, by the encoded value.

    Raises LookupError if the value is missing.
    """

    def digits(encoded: Any) -> int:
        (digits,) = read.of_values([decoded(encoded, floors)])
        if not digits:
            raise LookupError
        return digits

    return Remembered(digits)
