"""The outcomes of a rule for all choices of objects in all traces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.outcome_machine import KEPT
from rulec.monitoring.batch.stacked.crowded_states import CrowdedStates
from rulec.monitoring.batch.stacked.entangled_letters import EntangledLetters, entangled_letters
from rulec.monitoring.batch.stacked.instances import (
    Instances,
    NumbersAt,
    doubtful_instances,
    with_all_of,
)
from rulec.monitoring.batch.stacked.stack_reader import Spots, StackReader
from rulec.monitoring.batch.stacked.stacked_rule import FEW_WORDS, StackedRule, stretches
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import Numbers
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.monitoring.uncertainty.uncertain_machine import Answer
from rulec.trace import Value
from rulec.trace.plain_arrays import ODD, ranges
from rulec.vocabulary.partial_values import UNKNOWN


class WordLetters(NamedTuple):
    """The letters of some words, if unknown constants have the ``supposed`` values.

    ``numbers`` are those of the reads and ``letters`` those of the letter sets. Where letters are
    ``entangled``, the numbers of the reads do not determine them.
    """

    supposed: Mapping[Subject, Value]
    numbers: Mapping[int, Numbers]
    letters: NDArray[np.intp]
    entangled: EntangledLetters | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ChosenWords:
    """The words of some choices of objects, of which the same constants are ``unknown``.

    Words begin and end at ``bounds`` of the ``spots``. ``supposed`` are the values that constants
    may have together, and each of them can be if that ``is_exact``.
    """

    instances: Instances
    bounds: NDArray[np.intp]
    spots: Spots
    numbers: NumbersAt
    unknown: Sequence[int] = ()
    supposed: Sequence[Mapping[Subject, Value]] = ({},)
    is_exact: bool = True

    @staticmethod
    def of(rule: StackedRule, reader: StackReader, instances: Instances) -> ChosenWords:
        """The words of some choices, with no supposed values."""
        bounds, spots = instances.spots(rule, reader.stack)
        return ChosenWords(instances, bounds, spots, NumbersAt(rule, reader, spots))

    def part(
        self, rule: StackedRule, reader: StackReader, members: NDArray[np.intp]
    ) -> ChosenWords:
        """Some of the words."""
        if len(members) == len(self.instances.traces):
            return self
        instances = self.instances.part(members)
        bounds, spots = instances.spots(rule, reader.stack)
        at, _ = ranges(self.bounds[members], bounds[1:] - bounds[:-1])
        numbers = self.numbers.part(spots, at)
        return replace(self, instances=instances, bounds=bounds, spots=spots, numbers=numbers)


@dataclass(frozen=True, slots=True, eq=False)
class StackedOutcomes:
    """The answers for words that are not kept, by their places; None for those that are odd.

    ``letters`` are those for each way to suppose unknown constants.
    """

    rule: StackedRule
    words: ChosenWords
    letters: Sequence[WordLetters]
    answers: Mapping[int, Answer | None]


def outcomes(
    rule: StackedRule, reader: StackReader, rulebook: CompiledRulebook, suspects: Flags
) -> Iterator[StackedOutcomes]:
    """All choices for which a rule is not kept.

    They are sifted three times, ever more exactly: letters in any order (``doubtful_instances``),
    the machine on what each read allows by itself, the machine on what they allow together: fewer
    letters, so that this need not be found out for choices that are kept before. A known letter is
    a set of one, of which best and worst outcome are the same. In traces that are ``suspects`` all
    choices are examined for letters that axioms exclude. Raises UnencodableError.
    """
    instances = doubtful_instances(rule, reader)
    if rule.facts and suspects.any():
        instances = with_all_of(suspects, instances, rule, reader.stack)
    if not len(instances.traces):
        return
    for chosen in _by_unknown_constants(rule, reader, instances, rulebook):
        apart = _letters_apart(rule, reader, chosen)
        known = [_answers(rule, own.letters, chosen.bounds) for own in apart]
        doubtful = suspects[chosen.instances.traces]
        for answers in known:
            doubtful |= [answer is None or answer.worst != KEPT for answer in answers]
        if not doubtful.any():
            continue
        if not doubtful.all():
            members = doubtful.nonzero()[0]
            chosen = chosen.part(rule, reader, members)
            apart = _letters_apart(rule, reader, chosen)
            known = [[answers[member] for member in members.tolist()] for answers in known]
        together, odd = _letters_together(rule, reader, chosen, apart)
        for place, (own, before) in enumerate(zip(together, apart, strict=True)):
            if own.letters is not before.letters:
                known[place] = _answers(rule, own.letters, chosen.bounds)
        # Letters that axioms exclude make a word odd
        are_odd = np.logical_or.reduceat(odd, chosen.bounds[:-1]).tolist()
        joint = known[0] if len(known) == 1 else map(_combined, zip(*known, strict=True))
        found = [None if is_odd else own for is_odd, own in zip(are_odd, joint, strict=True)]
        kept_not = {n: own for n, own in enumerate(found) if own is None or own.worst != KEPT}
        yield StackedOutcomes(rule, chosen, together, kept_not)


def _answers(
    rule: StackedRule, letters: NDArray[np.intp], bounds: NDArray[np.intp]
) -> list[Answer | None]:
    """The answer for each word, of which many are equal; None if axioms exclude a letter of it."""
    if len(bounds) <= FEW_WORDS:
        return [rule.answer_to(letters[begin:end]) for begin, end in pairwise(bounds.tolist())]
    first_alike = _first_alike(letters, bounds)
    different = np.unique(first_alike).tolist()
    answers = dict(
        zip(different, rule.answers(*stretches(letters, bounds), different), strict=True)
    )
    return [answers[first] for first in first_alike.tolist()]


def _first_alike(letters: NDArray[np.intp], bounds: NDArray[np.intp]) -> NDArray[np.intp]:
    """For each word the position of the first equal word.

    Words are distinguished by weighted sums of their letters, then compared.
    """
    begins, lengths = bounds[:-1], bounds[1:] - bounds[:-1]
    states = np.arange(bounds[-1]) - begins.repeat(lengths)
    weights = _weights(int(lengths.max(initial=0)) + 1)
    own = np.add.reduceat((letters + 1).astype(np.uint64) * weights[states], begins)
    sums = weights[lengths] * ODD + own
    _, firsts, groups = np.unique(sums, return_index=True, return_inverse=True)
    like: NDArray[np.intp] = firsts[groups]
    if (lengths == lengths[like]).all():
        at = begins[like].repeat(lengths) + states
        if (letters == letters[at]).all():
            return like
    return np.arange(len(begins))


def _weights(count: int) -> NDArray[np.uint64]:
    """Odd pseudo-random weights: the powers of one number."""
    weights: NDArray[np.uint64] = np.cumprod(np.full(count, ODD), dtype=np.uint64)
    return weights


def _combined(of_alternatives: Sequence[Answer | None]) -> Answer | None:
    """The combined answer of several words; None if there is none."""
    answers = [answer for answer in of_alternatives if answer is not None]
    if not answers:
        return None
    steps = [answer.step for answer in answers if answer.step is not None]
    return Answer(
        min(answer.best for answer in answers),
        max(answer.worst for answer in answers),
        max(steps) if len(steps) == len(answers) else None,
    )


def _alike(flags: NDArray[np.bool_]) -> Iterator[tuple[NDArray[np.intp], list[int]]]:
    """Groups of columns that have the same flags, each with the rows that are set."""
    if not flags.any():
        yield np.arange(flags.shape[1]), []
        return
    rows, kinds = np.unique(flags.T, axis=0, return_inverse=True)
    for kind, row in enumerate(rows):
        yield (kinds.ravel() == kind).nonzero()[0], row.nonzero()[0].tolist()


def _by_unknown_constants(
    rule: StackedRule, reader: StackReader, instances: Instances, rulebook: CompiledRulebook
) -> Iterator[ChosenWords]:
    """The choices, grouped by which constants are unknown."""
    chosen = ChosenWords.of(rule, reader, instances)
    constants = rule.constants
    if not constants:
        yield chosen
        return
    are_unknown = np.zeros((len(constants), len(instances.traces)), dtype=bool)
    for row, place in enumerate(constants):
        own = np.broadcast_to(np.asarray(chosen.numbers[place]), (len(chosen.spots.states),))
        are_unknown[row] = own[chosen.bounds[:-1]] == rule.reads[place].unknown
    for members, unknown in _alike(are_unknown):
        which = tuple([constants[row] for row in unknown])
        supposed, is_exact = rule.suppositions(which, rulebook)
        own_part = chosen.part(rule, reader, members)
        yield replace(own_part, unknown=which, supposed=supposed, is_exact=is_exact)


def _letters_apart(
    rule: StackedRule, reader: StackReader, chosen: ChosenWords
) -> Sequence[WordLetters]:
    """The letters for all supposed values, from what each read allows by itself."""
    declarations = reader.stack.vocabulary.declarations
    found = []
    for values in chosen.supposed:
        instead = {}
        for place in chosen.unknown:
            value = values.get(rule.subject(place))
            if value is not None:
                instead[place] = rule.reads[place].number_of(value, declarations)
        numbers = chosen.numbers.with_others(instead) if instead else chosen.numbers
        letters = chosen.instances.letters
        if instead or letters is None:
            letters = rule.letters.letters_of(numbers)
        elif isinstance(letters, np.ndarray):
            letters = letters.take(chosen.spots.states)
        if not isinstance(letters, np.ndarray):
            letters = np.full(len(chosen.spots.states), letters, dtype=np.intp)
        found.append(WordLetters(values, numbers, letters))
    return found


def _letters_together(
    rule: StackedRule, reader: StackReader, chosen: ChosenWords, apart: Sequence[WordLetters]
) -> tuple[Sequence[WordLetters], Flags]:
    """The letters that reads allow together, and where they are odd."""
    odd = _hides_constants(rule, reader, chosen.spots)
    if len(chosen.unknown) > 1 and not any(chosen.supposed):
        odd[:] = True
    found: list[WordLetters] = []
    crowd: CrowdedStates | None = None
    for own in apart:
        entangled, letters = None, own.letters
        if rule.related and not odd.all():
            partial = np.zeros(len(letters), dtype=bool)
            partial |= rule.letters.are_partial(own.numbers, rule.related)
            if partial.any():
                about = chosen.spots, partial
                crowd = crowd or CrowdedStates(rule, reader)
                entangled = entangled_letters(
                    rule, reader, about, own.numbers, own.supposed, crowd=crowd
                )
                if entangled is None:
                    odd |= partial
                else:
                    sets = [rule.letters.number_of(classes) for classes in entangled.classes]
                    letters = letters.copy()
                    letters[entangled.places] = np.array(sets, dtype=np.intp)[entangled.numbers]
        if rule.facts:
            for nothing in rule.letters.numbers_of_none:
                odd |= letters == nothing
        found.append(own._replace(letters=letters, entangled=entangled))
    return found, odd


def _hides_constants(rule: StackedRule, reader: StackReader, spots: Spots) -> NDArray[np.bool_]:
    """Where constants are unknown that sums and counts read, with no supposed values."""
    stack = reader.stack
    hidden = np.zeros(len(spots.states), dtype=bool)
    for name in rule.hidden:
        column = stack.column(name)
        if column is None:
            hidden |= stack.default(name) is UNKNOWN
        elif column.unknown is not None:
            traces = stack.traces_at(name, column.unknown.nonzero()[0])
            first, end = stack.begins[traces], stack.begins[np.array(traces, dtype=np.intp) + 1]
            for begin, last in zip(first.tolist(), end.tolist(), strict=True):
                hidden |= (begin <= spots.states) & (spots.states < last)
    return hidden
