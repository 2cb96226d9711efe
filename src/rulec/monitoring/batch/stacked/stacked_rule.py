"""A rule prepared for traces in arrays: its reads, its letters, and the letters without effect."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import Read
from rulec.logic import formula as ltl
from rulec.logic.free_names import names_of
from rulec.logic.kleene import holds
from rulec.monitoring.batch.stacked.stacked_read import ReadKeys, StackedRead, stacked_read
from rulec.monitoring.uncertainty.state_letters.entangled_reads import (
    EntangledReads,
    NothingKnown,
    local_reads,
)
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import LetterSets, Numbers
from rulec.monitoring.uncertainty.state_letters.related_facts import (
    is_of_one,
    related_facts,
)
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.monitoring.uncertainty.suppositions import ConstantsReader
from rulec.monitoring.uncertainty.uncertain_machine import Answer, UncertainMachine
from rulec.rulebook.rules.axiom_instances import counts
from rulec.trace import Value
from rulec.trace.plain_arrays import ODD, different_pairs
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN

NOBODY = NothingKnown({}, Vocabulary("", {}, {}))
"""A state in which nothing is known about any object."""

MOST_SETS = 1 << 14
"""How many letter sets are kept before all are discarded."""

_MOST_BITS = 63
_NO_CLASS = 1 << _MOST_BITS
"""A bit, beside those of the letter classes, for impossible letters."""


class StackedRule:
    """A rule with its machine for words of letter sets.

    ``facts`` are the axioms related to what it reads, ``in_facts`` the names in them, and ``names``
    these plus the names that it reads. ``entangled`` are its entangled reads, if its own objects
    alone determine what these may be; ``related`` are the places of all reads that may depend on
    each other. ``constants`` are those of reads of constants, ``hidden`` the names of constants in
    sums and counts. ``counts_everywhere``: it counts objects in all states, whichever its own
    objects are.
    """

    def __init__(
        self,
        rule: CompiledRule,
        machine: UncertainMachine,
        rulebook: CompiledRulebook,
        vocabulary: Vocabulary,
        keys: ReadKeys,
    ) -> None:
        self.rule = rule
        self.machine = machine
        self.variables = tuple([variable.name for variable in rule.variables])
        self.types = tuple([variable.type for variable in rule.variables])
        self.reads = tuple([stacked_read(read, vocabulary, keys) for read in rule.machine.reads])
        read_names = frozenset(name for read in self.reads for name in read.names)
        self.facts = related_facts(read_names, rulebook.axioms)
        self.in_facts = frozenset().union(*[names_of(fact.formula) for fact in self.facts])
        self.names = read_names | self.in_facts
        self.entangled: EntangledReads | None = local_reads(rule, rulebook)
        self.related = (
            _related(self.reads, self.in_facts)
            if self.entangled is None
            else self.entangled.numbers
        )
        constants = frozenset(vocabulary.constants)
        self.constants = tuple(
            [n for n, x in enumerate(self.reads) if x.is_value and x.names[0] in constants]
        )
        self.hidden = tuple(
            dict.fromkeys(
                name
                for read in self.reads
                for name in read.names
                if name in constants and not read.is_value
            )
        )
        self.counts_everywhere = any(read.count and not read.variables for read in self.reads)
        self.is_simple = _is_simple(self, vocabulary)
        self._busy_flags: NDArray[np.bool_] = np.zeros(0, dtype=bool)
        self._class_bits: NDArray[np.uint64] = np.zeros(0, dtype=np.uint64)
        self._fit_bits = machine.machine.n_classes <= _MOST_BITS
        self.letters = self._no_letters()
        self.answers = WordAnswers(machine, self.letters)
        self._vocabulary = vocabulary
        self._everybody: dict[str, str] = {}
        self._crowd: EntangledReads | None = None
        self._supposed: dict[tuple[int, ...], tuple[Sequence[Mapping[Subject, Value]], bool]] = {}

    def subject(self, place: int) -> Subject:
        """What a read of a single value is about."""
        read = self.reads[place]
        return read.names[0], read.variables

    def suppositions(
        self, places: tuple[int, ...], rulebook: CompiledRulebook
    ) -> tuple[Sequence[Mapping[Subject, Value]], bool]:
        """The possible joint values of unknown constants, by the reads of them.

        The second item says whether each of them is possible.
        """
        if not places:
            return ({},), True
        if places not in self._supposed:
            given = dict.fromkeys(map(self.subject, places), UNKNOWN)
            reader = ConstantsReader(rulebook, self._vocabulary, {})
            self._supposed[places] = reader.suppositions(self.rule, dict(given))
        return self._supposed[places]

    def reads_among(self, everybody: Mapping[str, str]) -> EntangledReads:
        """The entangled reads of a rule without variables, if these objects may be present.

        Later calls may ask about other objects, so the reads cover all objects asked about so far.
        """
        if self._crowd is None or not everybody.keys() <= self._everybody.keys():
            self._everybody |= everybody
            objects = NothingKnown(dict(self._everybody), self._vocabulary)
            self._crowd = EntangledReads(self.rule, {}, self.facts, objects)
        return self._crowd

    def _no_letters(self) -> LetterSets:
        return LetterSets(self.machine.classes.diagram, [read.meanings for read in self.reads])

    def forget_many(self) -> None:
        """Discard the known letter sets if there are many; their numbers become invalid."""
        if len(self.letters.sets) > MOST_SETS:
            self.letters = self._no_letters()
            self.answers = WordAnswers(self.machine, self.letters)
            self._busy_flags = np.zeros(0, dtype=bool)
            self._class_bits = np.zeros(0, dtype=np.uint64)

    def busy_flags(self) -> NDArray[np.bool_]:
        """For each known letter set whether it may have an effect, that is, is not idle."""
        sets = self.letters.sets
        if len(self._busy_flags) < len(sets):
            more = [not self.machine.idle.of_classes(x) for x in sets[len(self._busy_flags) :]]
            self._busy_flags = np.concatenate([self._busy_flags, np.array(more, dtype=bool)])
        return self._busy_flags

    def are_kept_in_any_order(
        self, letters: Numbers, begins: NDArray[np.intp]
    ) -> NDArray[np.bool_]:
        """Whether words are kept, judged only by their sets of letters and by their last letter.

        Each word begins at one of these positions, and none is empty. Letters that axioms exclude,
        and those of machines with very many classes, decide nothing.
        """
        if not isinstance(letters, np.ndarray):
            classes = self.letters.sets[letters]
            return np.full(len(begins), self.machine.is_surely_kept(classes, classes))
        if not self._fit_bits:
            return ~np.logical_or.reduceat(self.busy_flags().take(letters), begins)
        known = len(self._class_bits)
        more = [classes or _NO_CLASS for classes in self.letters.sets[known:]]
        if more:
            self._class_bits = np.append(self._class_bits, np.array(more, dtype=np.uint64))
        own = self._class_bits.take(letters)
        every = np.bitwise_or.reduceat(own, begins)
        last = np.empty_like(every)
        last[:-1], last[-1:] = own.take(begins[1:] - 1), own[-1:]
        # Most words are kept, and a word is certainly kept if every word of its letters is
        if self._keep(*(int(np.bitwise_or.reduce(classes)) for classes in (every, last))):
            return np.ones(len(begins), dtype=bool)
        if len(begins) <= FEW_WORDS:
            words = zip(every.tolist(), last.tolist(), strict=True)
            return np.array([self._keep(*word) for word in words], dtype=bool)
        examples, which = different_pairs(every, last)
        keys = zip(every[examples].tolist(), last[examples].tolist(), strict=True)
        return np.array([self._keep(*key) for key in keys], dtype=bool)[which]

    def _keep(self, every: int, last: int) -> bool:
        """Whether all words of these classes, as bits, that end with one of ``last`` are kept."""
        return every < _NO_CLASS and self.machine.is_surely_kept(every, last)


def _related(reads: Sequence[StackedRead], in_facts: frozenset[str]) -> tuple[int, ...]:
    """Reads that are counts, or share names with other reads or with axioms."""
    return tuple(
        n
        for n, read in enumerate(reads)
        if read.count is not None
        or not in_facts.isdisjoint(read.names)
        or any(not set(read.names).isdisjoint(other.names) for other in reads if other is not read)
    )


def _is_simple(rule: StackedRule, vocabulary: Vocabulary) -> bool:
    """Whether all of the rule's reads are of kinds that can be read from arrays."""
    names = (name for name in rule.names if name in vocabulary.declarations)
    arity = max([len(vocabulary.declarations[name].parameters) for name in names], default=0)
    is_among_two = arity == 2 and not any(read.count or read.repeats for read in rule.reads)
    return (
        len(rule.variables) <= 2
        and (arity < 2 or is_among_two)
        and all(map(is_of_one, rule.facts))
        and all(_is_simple_read(read, rule) for read in rule.reads)
        and len({rule.reads[place].names for place in rule.constants}) == len(rule.constants)
    )


def _is_simple_read(read: StackedRead, rule: StackedRule) -> bool:
    if isinstance(read.read, Read):
        return True
    if read.count is None:
        return not any(isinstance(term, ltl.Count) for _, term in read.read.terms)
    if counts(read.count.body):
        return False
    return not read.variables or (
        len(rule.variables) == 1 and _counts_no_stranger(read.count, rule.variables[0])
    )


def _counts_no_stranger(count: ltl.Count, variable: str) -> bool:
    """Whether nothing counts except the object that the variable stands for."""
    # Names of variables contain no space.
    binding = {variable: variable, count.variable: "a stranger"}
    return holds(count.body, binding, NOBODY) is False


MOST_BYTES = 1 << 22
"""How many bytes of words with known answers are kept before all are discarded."""

FEW_WORDS = 1 << 5
"""Fewer words are evaluated one by one, without searching for equal ones."""


class WordAnswers:
    """The answers of a machine, kept by the words that have been met.

    Words are given by the numbers of letter sets, end to end, and by the ``bounds`` between them.
    """

    def __init__(self, machine: UncertainMachine, letters: LetterSets) -> None:
        self._machine = machine
        self._letters = letters
        self._by_runs: dict[bytes, Answer | None] = {}
        self._by_letters: dict[bytes, Answer | None] = {}
        self._bytes = 0

    def of(self, letters: NDArray[np.intp], bounds: NDArray[np.intp]) -> list[Answer | None]:
        """The answer for each word; None if axioms exclude a letter of it."""
        if len(bounds) <= FEW_WORDS:
            words = [letters[begin:end] for begin, end in pairwise(bounds.tolist())]
            return [self._of_one(word) for word in words]
        first_alike = _first_alike(letters, bounds).tolist()
        rows, ends = _runs(letters, bounds)
        # One text of all words, since cutting arrays into thousands of words takes longer
        text, width = rows.tobytes(), rows.itemsize * rows.shape[1]
        answers = {}
        for place in dict.fromkeys(first_alike):
            begin, end = ends[place], ends[place + 1]
            answers[place] = self._of_runs(text[width * begin : width * end], rows[begin:end])
        return [answers[first] for first in first_alike]

    def _of_one(self, word: NDArray[np.intp]) -> Answer | None:
        key = word.tobytes()
        if key in self._by_letters:
            return self._by_letters[key]
        rows, _ = _runs(word, np.array([0, len(word)], dtype=np.intp))
        answer = self._of_runs(rows.tobytes(), rows)
        if len(key) <= MOST_BYTES >> 10:
            self._make_room(len(key))
            self._by_letters[key] = answer
        return answer

    def _of_runs(self, key: bytes, rows: NDArray[np.intp]) -> Answer | None:
        """The answer for a word, given as rows of a letter set's number and its repetitions."""
        if key not in self._by_runs:
            self._make_room(len(key))
            sets, runs = self._letters.sets, rows.tolist()
            word = [(sets[number], length) for number, length in runs]
            answer = None
            if all(classes for classes, _ in word):
                answer = Answer(*self._machine.monitor.run_stretches(iter(word)))
            self._by_runs[key] = answer
        return self._by_runs[key]

    def _make_room(self, n_bytes: int) -> None:
        self._bytes += n_bytes
        if self._bytes > MOST_BYTES:
            self._by_runs.clear()
            self._by_letters.clear()
            self._bytes = n_bytes


def _runs(
    letters: NDArray[np.intp], bounds: NDArray[np.intp]
) -> tuple[NDArray[np.intp], list[int]]:
    """The letters as rows of letter and repetitions, and the bounds of words in these."""
    is_new = np.ones(len(letters), dtype=bool)
    np.not_equal(letters[1:], letters[:-1], out=is_new[1:])
    is_new[bounds[:-1]] = True
    starts = is_new.nonzero()[0]
    rows = np.empty((len(starts), 2), dtype=np.intp)
    rows[:, 0] = letters[starts]
    rows[:-1, 1] = starts[1:] - starts[:-1]
    rows[-1:, 1] = len(letters) - starts[-1:]
    return rows, starts.searchsorted(bounds).tolist()


def _first_alike(letters: NDArray[np.intp], bounds: NDArray[np.intp]) -> NDArray[np.intp]:
    """For each word the position of the first equal word.

    Words are distinguished by weighted sums of their letters, then compared.
    """
    begins, lengths = bounds[:-1], bounds[1:] - bounds[:-1]
    states = np.arange(bounds[-1]) - begins.repeat(lengths)
    # Odd pseudo-random weights: the powers of one number
    weights = np.cumprod(np.full(int(lengths.max(initial=0)) + 1, ODD), dtype=np.uint64)
    own = np.add.reduceat((letters + 1).astype(np.uint64) * weights[states], begins)
    sums = weights[lengths] * ODD + own
    _, firsts, groups = np.unique(sums, return_index=True, return_inverse=True)
    like: NDArray[np.intp] = firsts[groups]
    if (lengths == lengths[like]).all():
        at = begins[like].repeat(lengths) + states
        if (letters == letters[at]).all():
            return like
    return np.arange(len(begins))
