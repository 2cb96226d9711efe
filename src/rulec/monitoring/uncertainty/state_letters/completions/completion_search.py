"""A search through the joint completions of unknown values, as far as they matter."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.logic.kleene import Between, Unknown, evaluator_of, weighted_sum
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    CompletedView,
    MissingValueError,
    PartialView,
    Subject,
)
from rulec.trace import Value


@dataclass(slots=True)
class Link:
    """Something that depends on unknown subjects: a read, a counted object, or an axiom.

    ``read`` is the number of the read, None for an axiom. ``counted``: it says whether an object
    counts.
    """

    subjects: frozenset[Subject]
    read: int | None
    environment: Mapping[str, str]
    formula: ltl.Formula | None = None
    counted: bool = False


Numbers: TypeAlias = tuple[tuple[int, int], ...]
"""Reads by their places, each with its digit or, if it is a count, how many more objects count."""


class CompletionSearch:
    """A search through a cluster's completions that supposes only values that matter.

    ``values`` are those of non-numeric subjects; ``points`` are values of all numbers.
    """

    def __init__(
        self,
        links: Sequence[Link],
        reads: Sequence[Read | NumberRead],
        view: PartialView,
        values: Mapping[Subject, Sequence[Value]],
        points: Sequence[Mapping[Subject, Value | Fraction]],
    ) -> None:
        # A lookup would hash whole formulas
        self._links = [
            (link, None if link.formula is None else evaluator_of(link.formula)) for link in links
        ]
        self._reads, self._view = reads, view
        self._values, self._points = values, points
        self._possible: set[Numbers] = set()

    def possible(self) -> set[Numbers]:
        """The results of the completions. Raises MissingValueError."""
        self._go_on(0, {}, {})
        return self._possible

    def _go_on(
        self,
        number: int,
        supposed: Mapping[Subject, Value | Fraction],
        found: Mapping[int, int],
    ) -> None:
        """Evaluate the links from a number on, given the supposed values and earlier results."""
        numbers = dict(found)
        view = CompletedView(self._view, supposed)
        for link, evaluate in self._links[number:]:
            deciding = None
            if evaluate is None:
                assert link.read is not None
                deciding = self._unsupposed(link, supposed)
                if deciding is None:
                    numbers[link.read] = digit_of(self._reads[link.read], link.environment, view)
            else:
                truth = evaluate(link.environment, view)
                if isinstance(truth, Unknown):
                    deciding = self._deciding(truth, link, supposed)
                elif link.read is not None:
                    numbers[link.read] = numbers.get(link.read, 0) + truth
                elif not truth:
                    return  # no state is so
            if deciding is not None:
                for values in self._alternatives(deciding):
                    self._go_on(number, {**supposed, **values}, numbers)
                return
            number += 1
        self._possible.add(tuple(sorted(numbers.items())))

    def _deciding(
        self, truth: Unknown, link: Link, supposed: Mapping[Subject, Value | Fraction]
    ) -> Subject | None:
        """The subject on which a truth value depends; None for an axiom that lacks a value."""
        subject = truth.name, truth.objects
        if subject in link.subjects and subject not in supposed:
            return subject
        # Another link may show that the missing value is not needed
        other = self._unsupposed(link, supposed)
        if other is None and link.read is not None:
            raise MissingValueError(*subject)
        return other

    def _unsupposed(
        self, link: Link, supposed: Mapping[Subject, Value | Fraction]
    ) -> Subject | None:
        return min(link.subjects - supposed.keys(), default=None)

    def _alternatives(self, subject: Subject) -> Iterable[Mapping[Subject, Value | Fraction]]:
        if subject in self._values:
            return ({subject: value} for value in self._values[subject])
        return self._points


def digit_of(
    read: Read | NumberRead, binding: Mapping[str, str], view: PartialView | CompletedView
) -> int:
    """The digit of a read without unknown values. Raises MissingValueError."""
    if isinstance(read, Read):
        value = view.value(read.name, tuple([binding[variable] for variable in read.variables]))
        assert not isinstance(value, Unknown), "it has been supposed, or is known"
        return read.digit(value)
    total = weighted_sum(read.terms, binding, view)
    total = total.low if isinstance(total, Between) else total
    if isinstance(total, Unknown):
        raise MissingValueError(total.name, total.objects)  # all else has been supposed
    return read.digit(total)


def digit_of_count(read: Read | NumberRead, number: int) -> int:
    """The digit of a read that is a count, if so many objects count."""
    assert isinstance(read, NumberRead), "it counts"
    return read.digit(read.terms[0][0] * number)


def added(before: tuple[int, ...], more: Iterable[tuple[int, int]]) -> tuple[int, ...]:
    """The numbers of all reads, with some added."""
    after = list(before)
    for read, number in more:
        after[read] += number
    return tuple(after)
