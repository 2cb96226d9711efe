"""Causes: the parts and instants that decide a formula's value.

As long as the atoms keep their values where they decide, the formula keeps its value, whatever else
changes. The causes found are sufficient but not complete: of two false operands of `and` only the
first is a cause (cf. Beer, Ben-David, Chockler, Orni, Trefler, "Explaining counterexamples using
causality", 2009).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import accumulate, compress

from rulec.logic.bounds import PAST, range_of
from rulec.logic.formula import Binary, BinaryOperator, Formula, Unary, UnaryOperator
from rulec.logic.semantics import Semantics

_Reason = tuple[Formula, int, int]
"""A part, and the first and the last of the instants at which it decides."""


def instants_among(
    known: Mapping[Formula, Sequence[bool]],
    formula: Formula,
    n_letters: int,
    semantics: Semantics = "stutter",
    since: int = 0,
) -> dict[Formula, list[bool]]:
    """The instants at which a formula and its parts decide its value at the first instant.

    They are found from the values of its parts, operands first, on a word of ``n_letters`` whose
    last one is repeated until they settle, unless nothing follows it. If an ``always`` or
    ``never`` fails at several instants, the first one decides; with ``since``, the first one not
    before that instant, if there is one.
    """
    length, last = len(known[formula]), n_letters - 1
    onward, backward = _Columns(known), _Columns(known, turned=True)
    # Differences: a part begins to decide where its mark is above 0, and stops where it is below.
    marks = {part: [0] * (length + 1) for part in known}
    marks[formula][:2] = [1, -1]
    of_operand: dict[int, list[int]] = {}
    result = {}
    for part in reversed(list(known)):  # operands come after their operations
        if not any(marks[part]):
            result[part] = [False] * n_letters
            continue
        decides = [begun > 0 for begun in accumulate(marks[part][:length])]
        # Instants beyond the word's end repeat its last letter.
        result[part] = [*decides[:last], any(decides[last:])]
        if not isinstance(part, Unary | Binary):
            continue
        looks_back = part.operator in PAST
        for instant in compress(range(length), decides):
            if looks_back:
                # The past ends at the first instant.
                mirrored = _reasons(part, length - 1 - instant, backward, ends=True)
                reasons = [(cause, length - 1 - b, length - 1 - a) for cause, a, b in mirrored]
            else:
                reasons = list(_reasons(part, instant, onward, ends=semantics == "finite"))
                if part.operator in _INVARIANT and part.bound is None:
                    reasons = [_not_before(since, reason, onward) for reason in reasons]
            for operand, start, stop in reasons:
                own = of_operand.get(id(operand))
                if own is None:
                    own = of_operand[id(operand)] = marks[operand]
                own[start] += 1
                own[stop + 1] -= 1
    return result


class _Column:
    """A part's values, and for each instant the next one with a value, computed on demand."""

    def __init__(self, values: Sequence[bool]) -> None:
        self.values = values
        self._next: dict[bool, list[int]] = {}

    def next(self, value: bool, instant: int) -> int:
        """The next instant with this value; the number of instants if there is none."""
        instants = self._next.get(value)
        if instants is None:
            instants = self._next[value] = self._next_ones(value)
        return instants[min(instant, len(self.values))]

    def _next_ones(self, value: bool) -> list[int]:
        ahead = never = len(self.values)
        instants = [never]
        for instant, own in zip(range(never - 1, -1, -1), reversed(self.values), strict=True):
            if own is value:
                ahead = instant
            instants.append(ahead)
        instants.reverse()
        return instants


class _Columns:
    """The columns of parts with known values, optionally reversed; made when first needed.

    Parts are looked up by identity, since a formula's hash depends on all its parts.
    """

    def __init__(self, known: Mapping[Formula, Sequence[bool]], *, turned: bool = False) -> None:
        self._known, self._turned = known, turned
        self._made: dict[int, _Column] = {}

    def __getitem__(self, part: Formula) -> _Column:
        column = self._made.get(id(part))
        if column is None:
            values = self._known[part]
            column = _Column(values[::-1] if self._turned else values)
            self._made[id(part)] = column
        return column


_ALONE = {
    BinaryOperator.AND: (False, False),
    BinaryOperator.OR: (True, True),
    BinaryOperator.IMPLIES: (False, True),
}
"""For each operand, the value with which it decides alone."""

_FAILING = frozenset(
    (
        UnaryOperator.ALWAYS,
        UnaryOperator.WEAK_NEXT,
        UnaryOperator.HISTORICALLY,
        UnaryOperator.WEAK_PREVIOUSLY,
        BinaryOperator.RELEASE,
        BinaryOperator.STRONG_RELEASE,
    )
)
"""These assert that no instant is found at which the operands fail; the others assert that an
instant is found, or is not found, at which they hold.
"""

_INVARIANT = (UnaryOperator.ALWAYS, UnaryOperator.NEVER)

_WEAK = frozenset((BinaryOperator.WEAK_UNTIL, BinaryOperator.STRONG_RELEASE))


def _not_before(since: int, reason: _Reason, columns: _Columns) -> _Reason:
    """The reason for a failed ``always`` or ``never``: its first failure from ``since`` on."""
    operand, first, last = reason
    column = columns[operand]
    later = column.next(column.values[first], max(first, since))
    return (operand, later, later) if first == last and later < len(column.values) else reason


def _reasons(part: Formula, instant: int, columns: _Columns, *, ends: bool) -> Iterator[_Reason]:
    match part:
        case Unary(UnaryOperator.NOT, operand):
            yield operand, instant, instant
        case Binary(BinaryOperator.IFF | BinaryOperator.XOR, left, right):
            yield left, instant, instant
            yield right, instant, instant
        case Binary(operator, left, right) if operator in _ALONE:
            pairs = zip((left, right), _ALONE[operator], strict=True)
            alone = [
                formula for formula, value in pairs if columns[formula].values[instant] == value
            ]
            for operand in alone[:1] or (left, right):
                yield operand, instant, instant
        case Unary(_, operand):
            yield from _of_search(part, None, operand, instant, columns=columns, ends=ends)
        case Binary(_, left, right):
            yield from _of_search(part, left, right, instant, columns=columns, ends=ends)


def _of_search(
    part: Unary | Binary,
    left: Formula | None,
    right: Formula,
    instant: int,
    *,
    columns: _Columns,
    ends: bool,
) -> Iterator[_Reason]:
    """The reasons for the value of a search for ``right``.

    The search is for an instant within the range, with ``left`` at all instants before it.
    """
    sought = part.operator not in _FAILING
    weak = part.operator in _WEAK
    low, high = range_of(part)
    last = len(columns[right].values) - 1
    start, end = instant + low, last if high is None else min(instant + high, last)
    # Beyond the last instant all values stay; the last instant itself must then satisfy ``left``.
    beyond = start > last and not ends and (high is None or low <= high)
    start = last if beyond else start
    result = columns[right].next(sought, start)
    broken = last + 1 if left is None else columns[left].next(not sought, instant)
    way = result + 1 if beyond else result
    if result <= end and broken >= way:
        yield right, result, result
        if left is not None and instant < way:
            yield left, instant, way - 1
        return
    if left is not None and weak and broken > end:
        yield left, instant, end
        return
    stop = end
    if left is not None and (weak or beyond or broken < end) and broken <= last:
        yield left, broken, broken
        stop = min(broken, end)
    if start <= stop < result:
        yield right, start, stop
