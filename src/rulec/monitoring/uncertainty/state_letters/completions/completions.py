"""The joint digits of a rule's reads in a state with unknown values.

Unknown values that are independent are handled separately: two are dependent if one read, one
counted object or one axiom refers to both.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import prod
from typing import TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.logic.kleene import Between, Unknown, holds, number_of, weighted_sum
from rulec.monitoring.uncertainty.state_letters.read_digits import read_digits
from rulec.monitoring.uncertainty.state_letters.related_facts import FactInstance, instances_of
from rulec.monitoring.uncertainty.state_letters.truth_table import TruthTable, united
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    PartialView,
    Subject,
    candidates,
    is_unknown,
    unknown_in_read,
    unknown_subjects,
)
from rulec.trace import Value
from rulec.valuations.connections import connected
from rulec.valuations.linear_arrangement import LinearPlane, sample_points
from rulec.vocabulary import Quantity
from rulec.vocabulary.partial_values import Interval, OneOf
from rulec.vocabulary.vocabulary_model import values_of

Digits: TypeAlias = tuple[int, ...]
"""A digit for each read."""

Numbers: TypeAlias = tuple[tuple[int, int], ...]
"""Reads by their places, each with its digit or, if it is a count, how many more objects count."""

MOST_COMPLETIONS = 1 << 12
"""Unknown values with more joint completions are taken to be independent."""


@dataclass(frozen=True, slots=True)
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


@dataclass(frozen=True, slots=True)
class PossibleDigits:
    """The possible joint digits of the reads; ``exact`` unless there were too many completions."""

    digits: frozenset[Digits]
    exact: bool = True


def joint_digits(
    reads: Sequence[Read | NumberRead],
    binding: Mapping[str, str],
    view: PartialView,
    facts: Iterable[FactInstance],
) -> PossibleDigits:
    """The joint digits of ``reads`` for the objects of a binding.

    There are none if the state contradicts one of the ``facts``. Raises MissingValueError.
    """
    counted: dict[int, int] = {}
    links = list(_links_of_reads(reads, binding, view, counted))
    touched = {link.read: 0 for link in links} | counted
    surely = [
        touched[number]
        if number in touched
        else read_digits(read).in_state(binding, view).bit_length() - 1
        for number, read in enumerate(reads)
    ]
    sums = {tuple(surely)}
    is_exact = True
    for cluster in _clusters([*links, *_links_of_facts(facts, view)]):
        if reads and all(link.read is None for link in cluster):
            continue  # axioms on which no read depends are irrelevant
        possible: Iterable[Numbers] | None = _completed(cluster, reads, view)
        if possible is None:
            is_exact = False
            possible = _independent(cluster, reads)
        sums = {added(before, after) for before in sums for after in possible}
    digits = [
        tuple([digit_of_count(reads[n], x) if n in counted else x for n, x in enumerate(numbers)])
        for numbers in sums
    ]
    return PossibleDigits(frozenset(digits), is_exact)


def can_be(view: PartialView, axioms: Sequence[CompiledAxiom]) -> bool:
    """Whether some completion of a state satisfies all axioms; False also if there are too many."""
    clusters = _clusters(list(_links_of_facts(instances_of(axioms, view), view)))
    return all(_completed(cluster, (), view) for cluster in clusters)


def _links_of_reads(
    reads: Sequence[Read | NumberRead],
    binding: Mapping[str, str],
    view: PartialView,
    counted: dict[int, int],
) -> Iterator[Link]:
    """Links of reads with unknown subjects; ``counted`` receives the numbers that surely count."""
    for number, read in enumerate(reads):
        match read:
            case NumberRead(terms=((_, ltl.Count() as count),)):
                counted[number] = 0
                for item in candidates(count, view):
                    inner = {**binding, count.variable: item}
                    value = holds(count.body, inner, view)
                    if isinstance(value, Unknown):
                        about = unknown_subjects(count.body, inner, view)
                        yield Link(about, number, inner, count.body, counted=True)
                    else:
                        counted[number] += value
            case _:
                about = unknown_in_read(read, binding, view)
                if about and not _is_sure(read, binding, view):
                    yield Link(about, number, binding)


def _is_sure(read: Read | NumberRead, binding: Mapping[str, str], view: PartialView) -> bool:
    """Whether all possible values of a sum have the same digit."""
    total = weighted_sum(read.terms, binding, view) if isinstance(read, NumberRead) else None
    if not (isinstance(total, Between) and isinstance(read, NumberRead)):
        return False
    return read.digit(total.low) == read.digit(total.high)


def _clusters(links: Sequence[Link]) -> list[list[Link]]:
    """The links in groups that share no subjects."""
    apart = connected([link.subjects for link in links])
    return [[links[place] for place in places] for _, places in apart]


def _links_of_facts(facts: Iterable[FactInstance], view: PartialView) -> Iterator[Link]:
    for formula, environment in facts:
        truth = holds(formula, environment, view)
        if truth is not True:
            about = unknown_subjects(formula, environment, view)
            yield Link(about, None, environment, formula)


def _completed(
    cluster: Sequence[Link], reads: Sequence[Read | NumberRead], view: PartialView
) -> set[Numbers] | None:
    """The results of a cluster's completions; None if there are too many."""
    values: dict[Subject, Sequence[Value]] = {}
    bounds: dict[ltl.Term, tuple[Fraction, Fraction] | None] = {}
    for subject in sorted(frozenset[Subject]().union(*[link.subjects for link in cluster])):
        declaration = view.vocabulary.declarations[subject[0]]
        given = view.given(*subject)
        if isinstance(declaration, Quantity):
            number = ltl.QuantityTerm(*subject)
            bounds[number] = None
            if isinstance(given, Interval):
                bounds[number] = exact(given.low), exact(given.high)
        else:
            every = values_of(declaration)
            among = given.values if isinstance(given, OneOf) else every
            values[subject] = [value for value in every if value in among]
    n_discrete = prod(len(each) for each in values.values())
    if n_discrete > MOST_COMPLETIONS:
        return None
    planes = [plane for link in cluster for plane in _planes(link, reads, view)]
    points = sample_points(bounds, planes)
    if points is None or n_discrete * len(points) > MOST_COMPLETIONS:
        return None
    numbers = [
        {(x.name, x.arguments): n for x, n in point.items() if isinstance(x, ltl.QuantityTerm)}
        for point in points
    ]
    words = {subject: [[value] for value in among] for subject, among in values.items()}
    return _results(cluster, reads, TruthTable(words, numbers, view))


def _results(
    cluster: Sequence[Link], reads: Sequence[Read | NumberRead], table: TruthTable
) -> set[Numbers]:
    """What the links come to in some way that the axioms allow. Raises MissingValueError."""
    about = {link.read for link in cluster if link.read is not None}
    places = {read: n for n, read in enumerate(sorted(about))}
    found, kept = {(0,) * len(places): table.all}, table.all
    for link in cluster:
        if link.read is None:
            assert link.formula is not None, "it is an axiom"
            kept &= table.truth(link.formula, link.environment).possible
            continue
        if link.formula is None:
            numbers = table.digits(reads[link.read], link.environment)
        else:
            numbers = table.counted(link.formula, link.environment)
        place = places[link.read]
        found = united(
            ((*before[:place], before[place] + number, *before[place + 1 :]), ways & own)
            for before, ways in found.items()
            for number, own in numbers.items()
        )
    return {tuple(zip(places, numbers, strict=True)) for numbers, x in found.items() if x & kept}


def added(before: tuple[int, ...], more: Iterable[tuple[int, int]]) -> tuple[int, ...]:
    """The numbers of all reads, with some added."""
    after = list(before)
    for read, number in more:
        after[read] += number
    return tuple(after)


def digit_of_count(read: Read | NumberRead, number: int) -> int:
    """The digit of a read that is a count, if so many objects count."""
    assert isinstance(read, NumberRead), "it counts"
    return read.digit(read.terms[0][0] * number)


def _independent(cluster: Sequence[Link], reads: Sequence[Read | NumberRead]) -> list[Numbers]:
    """A superset of a cluster's results: all its links independently, without axioms."""
    alone = [
        [(link.read, number) for number in range(2 if link.counted else reads[link.read].size)]
        for link in cluster
        if link.read is not None
    ]
    return list(product(*alone))


def _planes(
    link: Link, reads: Sequence[Read | NumberRead], view: PartialView
) -> Iterator[LinearPlane]:
    if link.formula is None:
        assert link.read is not None
        read = reads[link.read]
        if isinstance(read, NumberRead):
            for threshold in read.thresholds:
                yield from _planes_of_sum(read.terms, threshold.limit, link.environment, view)
    else:
        yield from _planes_in(link.formula, link.environment, view)


def _planes_in(
    formula: ltl.Formula, environment: Mapping[str, str], view: PartialView
) -> Iterator[LinearPlane]:
    for atom in ltl.atoms_of(formula):
        if isinstance(atom, ltl.Comparison):
            yield from _planes_of_sum(atom.terms, atom.limit, environment, view)


def _planes_of_sum(
    terms: Sequence[tuple[Fraction, ltl.Term]],
    limit: Fraction,
    environment: Mapping[str, str],
    view: PartialView,
) -> Iterator[LinearPlane]:
    coefficients: dict[ltl.Term, Fraction] = {}
    limits = [limit]
    for factor, term in terms:
        match term:
            case ltl.QuantityTerm(name, arguments):
                subject = name, tuple([environment[variable] for variable in arguments])
                if is_unknown(subject, view):
                    number = ltl.QuantityTerm(*subject)
                    coefficients[number] = coefficients.get(number, Fraction(0)) + factor
                else:
                    known = number_of(term, environment, view)
                    if isinstance(known, Unknown):
                        return  # a value is missing, which a completion may do without
                    limits = [each - factor * known for each in limits]
            case ltl.Count(variable, _, body):
                items = list(candidates(term, view))
                limits = [each - factor * n for each in limits for n in range(len(items) + 1)]
                for item in items:
                    yield from _planes_in(body, {**environment, variable: item}, view)
    if coefficients:
        yield from (LinearPlane(coefficients, each) for each in limits)
