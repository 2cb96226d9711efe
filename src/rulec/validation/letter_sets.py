"""The letters of a table: what each says about a state, checked against what it claims to read.

A letter is a number in mixed radix, with the first read as its lowest digit (docs/compiled.md).
Every atom and comparison of a formula must be true in all states of a letter or in none, and every
value that a state can have must have a digit.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor
from typing import Any

from rulec.validation.unprovable import exact, require

MOST_LETTERS = 1 << 16
"""The greatest number of letters; rulec compiles no more."""

TRUE_FOR: Mapping[str, Callable[[Fraction, Fraction], bool]] = {
    "<": lambda value, limit: value < limit,
    "<=": lambda value, limit: value <= limit,
    "=": lambda value, limit: value == limit,
    "!=": lambda value, limit: value != limit,
    ">=": lambda value, limit: value >= limit,
    ">": lambda value, limit: value > limit,
}


@dataclass(frozen=True, slots=True)
class DigitRead:
    """A digit of letters: what it is about, its number of values, and the meaning of each."""

    about: Any
    size: int
    digits: tuple[str, ...]
    stride: int
    entry: Any


class NumberedLetters:
    """A number of letters; a set of them is an integer whose bits are the letters."""

    def __init__(self, count: int) -> None:
        self.count = count
        self.everything = (1 << count) - 1

    def described(self, letter: int) -> dict[str, str]:
        """What a letter says about a state, in words."""
        return {"letter": str(letter)}


class Letters(NumberedLetters):
    """The letters made up of these reads."""

    def __init__(self, reads: Sequence[Any], vocabulary: Mapping[str, Any]) -> None:
        self.reads: list[DigitRead] = []
        stride = 1
        for entry in reads:
            about, digits = _digits(entry, vocabulary)
            require(about not in [read.about for read in self.reads], "it reads a word twice")
            self.reads.append(DigitRead(about, len(digits), digits, stride, entry))
            stride *= len(digits)
            require(stride <= MOST_LETTERS, f"it distinguishes more than {MOST_LETTERS} letters")
        super().__init__(stride)

    def where(self, read: DigitRead, digits: Iterable[int]) -> int:
        """The letters in which a read has one of these digits."""
        zeros = ((1 << read.stride) - 1) * (self.everything // ((1 << read.stride * read.size) - 1))
        return sum(zeros << digit * read.stride for digit in set(digits))

    def of(self, atom: Any) -> int:
        """The letters in which an atom or a comparison of a formula is true."""
        about = subject(atom)
        read = next((read for read in self.reads if read.about == about), None)
        require(read is not None, "its table does not read everything that its formula mentions")
        assert read is not None
        if "terms" in atom:
            return self.where(read, _digits_where(atom, read.entry["thresholds"]))
        if atom["value"] is None:
            require(not read.entry["values"], "it treats an enumeration as a signal")
            return self.where(read, [1])
        require(atom["value"] in read.entry["values"], "its table does not distinguish a value")
        return self.where(read, [read.entry["values"].index(atom["value"])])

    def digit(self, read: DigitRead, value: Fraction | str | bool) -> int:
        """The digit of a value."""
        if "terms" in read.entry:
            places = [
                (exact(item["limit"]), item["inclusive"]) for item in read.entry["thresholds"]
            ]
            return sum(_passes(value, limit, own) for limit, own in places)
        if isinstance(value, bool):
            return int(value)
        values = read.entry["values"]
        return values.index(value) if value in values else len(values)

    def described(self, letter: int) -> dict[str, str]:
        """What a letter says about a state, in words."""
        return {
            _name(read.about): read.digits[letter // read.stride % read.size] for read in self.reads
        }


def _passes(value: Fraction | str | bool, limit: Fraction, inclusive: bool) -> bool:
    assert isinstance(value, Fraction)
    return value >= limit if inclusive else value > limit


def told_apart(letters: int, sets: Iterable[int], most: int, reason: str) -> list[int]:
    """The coarsest partition of ``letters`` cut by none of ``sets``; at most ``most`` parts."""
    parts = [letters]
    for own in sets:
        parts = [cut for part in parts for cut in (part & own, part & ~own) if cut]
        require(len(parts) <= most, reason)
    return parts


def subject(entry: Any) -> Any:
    """What a read or an atom is about, as a value that can be compared."""
    if "terms" in entry:
        return ("terms", json.dumps(_wordless(entry["terms"]), sort_keys=True))
    return ("word", entry["name"], tuple(entry["variables"]))


def _wordless(data: Any) -> Any:
    """Terms without the words of comparisons in counts, which may give one limit in two units."""
    if isinstance(data, dict):
        return {key: _wordless(part) for key, part in data.items() if key != "text"}
    return [_wordless(part) for part in data] if isinstance(data, list) else data


def _name(about: Any) -> str:
    if about[0] == "terms":
        return str(about[1])
    return f"{about[1]}({', '.join(about[2])})" if about[2] else str(about[1])


def _digits(entry: Any, vocabulary: Mapping[str, Any]) -> tuple[Any, tuple[str, ...]]:
    """What a read is about, and what each of its digits means."""
    if entry["kind"] == "number":
        return subject(entry), _intervals(entry["thresholds"])
    declared = vocabulary.get(entry["name"])
    require(
        isinstance(declared, dict) and len(declared["parameters"]) == len(entry["variables"]),
        "it reads a word that its vocabulary lacks",
    )
    assert declared is not None
    if declared["kind"] == "signal":
        require(not entry["values"] and entry["others"] is False, "it misreads a signal")
        return subject(entry), ("false", "true")
    require(declared["kind"] == "enumeration", "it misreads a number")
    values, known = entry["values"], declared["values"]
    distinct = len(set(values)) == len(values) > 0 and set(values) <= set(known)
    require(distinct, "it reads values that an enumeration does not have")
    others = set(values) != set(known)
    require(entry["others"] is others, "its letters leave out values of an enumeration")
    return subject(entry), (*values, *(["another value"] if others else []))


def _intervals(thresholds: Sequence[Any]) -> tuple[str, ...]:
    """The intervals into which its thresholds divide a number, in words."""
    places = [(exact(item["limit"]), item["inclusive"]) for item in thresholds]
    known = all(type(inclusive) is bool for _, inclusive in places)
    order = [(limit, not inclusive) for limit, inclusive in places]
    ascending = all(first < second for first, second in itertools.pairwise(order))
    require(known and ascending, "the thresholds of a number do not ascend")
    below = ["", *(f"{'at least' if own else 'more than'} {limit}" for limit, own in places)]
    above = [*(f"{'less than' if own else 'at most'} {limit}" for limit, own in places), ""]
    return tuple(
        [" and ".join(filter(None, pair)) or "any" for pair in zip(below, above, strict=True)]
    )


def _digits_where(comparison: Any, thresholds: Sequence[Any]) -> list[int]:
    """The digits for which a comparison is true; every digit must decide it."""
    places = [(exact(item["limit"]), item["inclusive"]) for item in thresholds]
    limit, holds = exact(comparison["limit"]), TRUE_FOR.get(comparison["relation"])
    require(holds is not None, "it compares numbers in an unknown way")
    assert holds is not None
    terms = comparison["terms"]
    whole = len(terms) == 1 and "count" in terms[0][1]
    true = []
    for digit in range(len(places) + 1):
        low = places[digit - 1] if digit else None
        high = places[digit] if digit < len(places) else None
        answers = {holds(value, limit) for value in _samples(low, high, limit, whole=whole)}
        require(len(answers) < 2, "the thresholds of a number do not decide a comparison")
        if answers == {True}:
            true.append(digit)
    return true


def _samples(
    low: tuple[Fraction, bool] | None,
    high: tuple[Fraction, bool] | None,
    limit: Fraction,
    *,
    whole: bool,
) -> list[Fraction]:
    """Numbers of an interval below a limit, at it and above it, as far as it contains any.

    The interval lies beyond the threshold ``low`` and before ``high``; an inclusive threshold
    belongs to the interval above it. A ``whole`` number counts objects: 0 or more.
    """
    near = [limit]
    for place in (low, high):
        near += [] if place is None else [place[0]]
    if whole:
        # The neighbouring whole numbers suffice: between them no truth value changes. None of them
        # may be a count, so there is 0, too.
        near = [
            Fraction(0),
            *(
                Fraction(round_(each) + n)
                for each in near
                for round_ in (floor, ceil)
                for n in (-1, 0, 1)
            ),
        ]
        near = [each for each in near if each >= 0]
    else:
        ordered = sorted(set(near))
        near += [(first + second) / 2 for first, second in itertools.pairwise(ordered)]
        near += [ordered[0] - 1, ordered[-1] + 1]
    return [
        each
        for each in near
        if (low is None or each > low[0] or (each == low[0] and low[1]))
        and (high is None or each < high[0] or (each == high[0] and not high[1]))
    ]
