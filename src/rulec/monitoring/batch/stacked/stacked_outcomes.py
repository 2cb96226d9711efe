"""What a rule comes to for all choices of objects of all traces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.outcome_machine import KEPT
from rulec.monitoring.batch.stacked.instances import Instances, doubtful_instances, numbers_at
from rulec.monitoring.batch.stacked.stack_reader import Spots, StackReader, is_partial
from rulec.monitoring.batch.stacked.stacked_rule import StackedRule
from rulec.monitoring.batch.uncertain.partial_reader import number_of_value
from rulec.monitoring.uncertainty.state_letters.letter_diagram import Numbers
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.monitoring.uncertainty.supposed_constants import ConstantsReader
from rulec.monitoring.uncertainty.uncertain_machine import Answer
from rulec.trace import Value
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES


@dataclass(frozen=True, slots=True, eq=False)
class StackedWords:
    """The words of some choices of objects, one for each way to choose what does not change.

    ``numbers`` are those of the reads, ``letters`` those of the sets of letters, both at the
    ``spots``; the words begin and end at ``bounds``. Where they are ``entangled`` not all is said
    by the numbers of the reads, and where they are ``odd`` nothing is known by them.
    """

    rule: StackedRule
    instances: Instances
    bounds: NDArray[np.intp]
    spots: Spots
    supposed: Sequence[Mapping[Subject, Value]]
    is_exact: bool
    numbers: Sequence[Sequence[Numbers]]
    letters: Sequence[NDArray[np.intp]]
    entangled: NDArray[np.bool_]
    odd: NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class StackedOutcome:
    """What is not kept: the choice's place among the ``words``; no answer where it is odd."""

    words: StackedWords
    place: int
    answer: Answer | None


def outcomes(
    rule: StackedRule, reader: StackReader, rulebook: CompiledRulebook
) -> Iterator[StackedOutcome]:
    """All choices for which a rule is not kept. Raises UnencodableError."""
    instances = doubtful_instances(rule, reader)
    if not len(instances.traces):
        return
    for words in _words(rule, reader, instances, rulebook):
        bounds, odd = words.bounds.tolist(), words.odd
        for place in range(len(bounds) - 1):
            own = slice(bounds[place], bounds[place + 1])
            if odd[own].any():
                yield StackedOutcome(words, place, None)
                continue
            answers = [rule.answer(letters[own]) for letters in words.letters]
            answer = _joined(answers)
            if answer.worst != KEPT:
                yield StackedOutcome(words, place, answer)


def _joined(answers: Sequence[Answer]) -> Answer:
    """What several words come to together."""
    if len(answers) == 1:
        return answers[0]
    steps = [answer.step for answer in answers if answer.step is not None]
    return Answer(
        min(answer.best for answer in answers),
        max(answer.worst for answer in answers),
        max(steps) if len(steps) == len(answers) else None,
    )


def _words(
    rule: StackedRule, reader: StackReader, instances: Instances, rulebook: CompiledRulebook
) -> Iterator[StackedWords]:
    """The words of choices, those together of which the same constants are unknown."""
    bounds, spots = instances.bounds(), instances.spots(rule, reader.stack)
    numbers = numbers_at(rule, reader, spots, rule.variables)
    constants = rule.constants
    dark = np.zeros((len(constants), len(instances.traces)), dtype=bool)
    for row, place in enumerate(constants):
        own = np.broadcast_to(np.asarray(numbers[place]), (len(spots.states),))
        dark[row] = own[bounds[:-1]] == rule.reads[place].unknown
    for members, unknown in _alike(dark):
        which = [constants[row] for row in unknown]
        if len(members) == len(instances.traces):
            yield _of_group(rule, reader, rulebook, (instances, bounds, spots, numbers), which)
            continue
        chosen = Instances(
            instances.traces[members],
            tuple(own[members] for own in instances.objects),
            instances.firsts[members],
            instances.lasts[members],
        )
        own_spots = chosen.spots(rule, reader.stack)
        own_numbers = numbers_at(rule, reader, own_spots, rule.variables)
        told = chosen, chosen.bounds(), own_spots, own_numbers
        yield _of_group(rule, reader, rulebook, told, which)


def _alike(flags: NDArray[np.bool_]) -> Iterator[tuple[NDArray[np.intp], list[int]]]:
    """Columns with the same flags, and the rows of these."""
    if not flags.any():
        yield np.arange(flags.shape[1]), []
        return
    rows, kinds = np.unique(flags.T, axis=0, return_inverse=True)
    for kind, row in enumerate(rows):
        yield np.flatnonzero(kinds.ravel() == kind), np.flatnonzero(row).tolist()


_Told: TypeAlias = tuple[Instances, NDArray[np.intp], Spots, Sequence[Numbers]]


def _of_group(
    rule: StackedRule,
    reader: StackReader,
    rulebook: CompiledRulebook,
    told: _Told,
    unknown: Sequence[int],
) -> StackedWords:
    """The words of choices of which the same constants are ``unknown``, places of reads."""
    instances, bounds, spots, numbers = told
    vocabulary, n_spots = reader.stack.vocabulary, len(spots.states)
    entangled = np.zeros(n_spots, dtype=bool)
    odd = _hides_constants(rule, reader, spots)
    supposed: Sequence[Mapping[Subject, Value]] = [{}]
    is_exact = True
    if unknown:
        subjects = {place: _subject(rule, place) for place in unknown}
        given = dict.fromkeys(subjects.values(), UNKNOWN)
        supposed, is_exact = ConstantsReader(rulebook, vocabulary, {}).suppositions(
            rule.rule, dict(given)
        )
        if len(given) > 1 and supposed == [{}]:
            odd[:] = True
    every_numbers, every_letters = [], []
    for values in supposed:
        own = list(numbers)
        for place in unknown:
            value = values.get(_subject(rule, place))
            if value is not None:
                read = rule.reads[place].read
                own[place] = number_of_value(read, value, vocabulary)[1]
        letters = np.array(np.broadcast_to(np.asarray(rule.letters.numbers(own)), (n_spots,)))
        if rule.related and not odd.all():
            partial = rule.letters.are_partial(own, rule.related)
            dark = _are_entangled(rule, reader, spots) & partial
            places = np.flatnonzero(dark)
            if len(places):
                entangled |= dark
                if rule.entangled is None:
                    odd |= dark
                else:
                    about = spots.part(places), places
                    letters[places] = _entangled(rule, reader, about, own, values)
        every_numbers.append(own)
        every_letters.append(letters)
    return StackedWords(
        rule,
        instances,
        bounds=bounds,
        spots=spots,
        supposed=supposed,
        is_exact=is_exact,
        numbers=every_numbers,
        letters=every_letters,
        entangled=entangled,
        odd=odd,
    )


def _hides_constants(rule: StackedRule, reader: StackReader, spots: Spots) -> NDArray[np.bool_]:
    """Where constants are unknown that sums and counts read, and that nothing is supposed of."""
    stack = reader.stack
    found = np.zeros(len(spots.states), dtype=bool)
    for name in rule.hidden:
        column = stack.column(name)
        if column is None:
            found |= stack.default(name) is UNKNOWN
        elif column.unknown is not None:
            traces = stack.traces_at(name, np.flatnonzero(column.unknown))
            first, end = stack.begins[traces], stack.begins[np.array(traces, dtype=np.intp) + 1]
            for begin, last in zip(first.tolist(), end.tolist(), strict=True):
                found |= (begin <= spots.states) & (spots.states < last)
    return found


def _subject(rule: StackedRule, place: int) -> Subject:
    read = rule.reads[place]
    return read.names[0], read.variables


def _are_entangled(rule: StackedRule, reader: StackReader, spots: Spots) -> NDArray[np.bool_]:
    """Where unknown values have to do with each other; everywhere if that is not known."""
    n_spots, reads = len(spots.states), rule.entangled
    if reads is None:
        return np.ones(n_spots, dtype=bool)
    found = np.zeros(n_spots, dtype=bool)
    for about in reads.subjects:
        name, variables = about
        column = reader.stack.column(name)
        if column is None:
            if about in reads.shared and reader.stack.default(name) is UNKNOWN:
                found[:] = True
            continue
        flags = is_partial(column) if about in reads.shared else column.apart
        if flags is not None:
            found |= flags[spots.cells[variables[0]] if variables else spots.states]
    return found


def _entangled(
    rule: StackedRule,
    reader: StackReader,
    about: tuple[Spots, NDArray[np.intp]],
    numbers: Sequence[Numbers],
    supposed: Mapping[Subject, Value],
) -> list[int]:
    """The numbers of sets of letters where reads have to do with each other."""
    spots, places = about
    reads = rule.entangled
    assert reads is not None
    letters = rule.machine.classes.of_rule(rule.rule, reads)
    columns = []
    for subject in reads.subjects:
        values = reader.values_at(*subject, spots)
        if subject in supposed:
            instead = supposed[subject]
            values = [instead if type(value) in UNKNOWN_TYPES else value for value in values]
        columns.append(values)
    rows = zip(*columns, strict=True) if columns else [()] * len(places)
    digits = [digits_at(rule, n, numbers[n], places) for n in letters.independent]
    keys = list(zip(*digits, map(reads.number, rows), strict=True))
    return [rule.letters.number_of(classes) for classes in letters.classes(keys)]


def digits_at(
    rule: StackedRule, read: int, numbers: Numbers, places: NDArray[np.intp] | slice
) -> list[int]:
    """The digits, as bits, that a read may have at some places of its numbers."""
    meanings = rule.reads[read].meanings
    if isinstance(numbers, np.ndarray):
        return [meanings[number] for number in numbers[places].tolist()]
    n_places = places.stop - places.start if isinstance(places, slice) else len(places)
    return [meanings[numbers]] * n_places
