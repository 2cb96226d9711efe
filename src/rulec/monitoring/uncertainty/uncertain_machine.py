"""A rule's machine on words of possible letters, and why an outcome is not settled."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from functools import cached_property
from itertools import groupby, product
from math import prod
from typing import NamedTuple, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.outcome_machine import (
    KEPT,
    PENDING,
    VIOLATED,
    OutcomeMachine,
    SetMonitor,
    bits_of,
    of_complete_words,
)
from rulec.automata.thresholds import scale
from rulec.logic.printing import number_in_words
from rulec.monitoring.uncertainty.dependence import BEFORE, Dependence, PossibleAlternative
from rulec.monitoring.uncertainty.idle_letters import IdleLetters, idle_letters
from rulec.monitoring.uncertainty.required_names import RequiredNames
from rulec.monitoring.uncertainty.run_pairs import RunPairs
from rulec.monitoring.uncertainty.state_letters.letter_classes import LetterClasses, PossibleWord
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters
from rulec.monitoring.verdict import ConditionalOutcome, OpenReasons, OutcomeName, Reason
from rulec.trace.remembered import Remembered

MOST_OUTCOMES = 1 << 4
"""For so many combinations of values the outcome of an open verdict is listed."""

MOST_STRETCHES = 1 << 10
"""For how many stretches of words the reasons of a rule are cached; long words differ anyway."""

_NAMES: Mapping[tuple[int, int], OutcomeName] = {
    (KEPT, KEPT): "kept",
    (VIOLATED, VIOLATED): "violated",
}

_Stretches: TypeAlias = tuple[tuple[Letters, int], ...]


class Answer(NamedTuple):
    """The best and the worst outcome of all completions.

    ``step`` is the first letter after which all completions are lost.
    """

    best: int
    worst: int
    step: int | None = None


class UncertainMachine:
    """The answers of one rule's machine, cached.

    ``monitor`` runs it on the ``classes`` of possible letters.
    """

    def __init__(self, machine: OutcomeMachine) -> None:
        self._reads = machine.reads
        self.machine = machine
        self.monitor = SetMonitor(machine)
        self.classes = LetterClasses(machine)
        self._reasons: dict[object, OpenReasons] = {}
        self._n_stretches = 0
        self._surely_kept = Remembered(self._keeps)
        self._required = RequiredNames(machine, self.classes)

    @cached_property
    def _runs(self) -> RunPairs:
        return RunPairs(self.machine, self.classes)

    @cached_property
    def idle(self) -> IdleLetters:
        """The letters without effect on it, computed on demand."""
        return idle_letters(self.monitor, self.classes.diagram)

    def answer(self, words: Sequence[PossibleWord]) -> Answer:
        """The outcome of the completions; there is a word for each choice of unknown constants."""
        runs = [self.monitor.run(word.classes) for word in words]
        best, worst = min(run[0] for run in runs), max(run[1] for run in runs)
        steps = [step for *_, step in runs if step is not None]
        return Answer(best, worst, max(steps) if len(steps) == len(runs) else None)

    def is_surely_kept(self, letters: int, last: int) -> bool:
        """Whether all words of these classes of letters, as bits, are kept, in whatever order.

        They end with one of the ``last`` classes. False if there are none.
        """
        return self._surely_kept[letters, last]

    def _keeps(self, about: tuple[int, int]) -> bool:
        machine = self.machine
        symbols, ends = map(bits_of, about)
        if not ends:
            return False
        reached = set(machine.starts)
        for state in (waiting := list(reached)):
            if state in machine.safe:
                continue
            outputs, targets = machine.outputs[state], machine.successors[state]
            if any(outputs[symbol] != KEPT for symbol in ends):
                return False
            for symbol in symbols:
                target = targets[symbol]
                if target not in reached:
                    reached.add(target)
                    waiting.append(target)
        return True

    def reasons(
        self,
        words: Sequence[PossibleWord],
        constants: Sequence[Mapping[str, object]],
        order: Sequence[str],
    ) -> OpenReasons:
        """Why the answer is open; ``order`` is that of names in the vocabulary."""
        alternatives, unknown = _possible_alternatives(words, constants)
        key = tuple([(x.stretches, tuple(x.constants.items())) for x in alternatives]), unknown
        open_reasons = self._reasons.get(key)
        if open_reasons is None:
            n_own = 1 + sum([len(x.stretches) for x in alternatives])
            if self._n_stretches + n_own > MOST_STRETCHES:
                self._reasons.clear()
                self._n_stretches = 0
            self._n_stretches += n_own
            best, worst, _ = self.answer(words)
            open_reasons = self._reasons_of(alternatives, unknown, order, {best, worst})
            self._reasons[key] = open_reasons
        return open_reasons

    def depends_beyond(
        self,
        words: Sequence[PossibleWord],
        constants: Sequence[Mapping[str, object]],
        order: Sequence[str],
        names: Set[str],
    ) -> frozenset[str]:
        """The names other than these on which it depends which of two outcomes words have.

        They are among those of ``reasons``.
        """
        alternatives, unknown = _possible_alternatives(words, constants)
        doubtful = _doubtful(alternatives, unknown)
        others = doubtful - names
        if not others:
            return others
        dependence = Dependence(self._runs, alternatives, unknown)
        smallest = dependence.smallest(self._in_order(doubtful, order))
        return others if smallest is None else others.intersection(smallest)

    def _in_order(self, doubtful: Set[str], order: Sequence[str]) -> list[str]:
        """Names in their order, followed by the past if that may matter."""
        names = [name for name in order if name in doubtful]
        return [*names, BEFORE] if len(self.machine.starts) > 1 else names

    def _reasons_of(
        self,
        alternatives: Sequence[PossibleAlternative],
        unknown: tuple[frozenset[str], ...],
        order: Sequence[str],
        outcomes: Set[int],
    ) -> OpenReasons:
        pending: tuple[Reason, ...] = ("not over",) if PENDING in outcomes else ()
        if len(outcomes) == 1:
            return OpenReasons(pending)
        doubtful = _doubtful(alternatives, unknown)
        names = self._in_order(doubtful, order)
        dependence = Dependence(self._runs, alternatives, unknown)
        smallest = dependence.smallest(names)
        on = names if smallest is None else smallest
        not_told: tuple[Reason, ...] = ("not told",) if any(on) else ()
        before: tuple[Reason, ...] = ("began before",) if BEFORE in on else ()
        depends_on = tuple([name for name in on if name])
        cases = () if before else tuple(self._outcomes(depends_on, alternatives, unknown))
        if len({case.outcome for case in cases}) == 1:
            # It matters when they change, so no constant value determines the outcome.
            cases = ()
        return OpenReasons((*not_told, *before, *pending), depends_on, cases, smallest is not None)

    def _run(self, word: _Stretches) -> tuple[int, int]:
        own = [(self.classes.of(letters), length) for letters, length in word]
        best, worst, _ = self.monitor.run_stretches(own)
        return best, worst

    def _outcomes(
        self,
        names: Sequence[str],
        alternatives: Sequence[PossibleAlternative],
        unknown: Sequence[frozenset[str]],
    ) -> Iterator[ConditionalOutcome]:
        """The outcomes if the names have certain values wherever they are unknown."""
        if any(name in own.constants for own in alternatives for name in names):
            yield from self._outcomes_of_constants(names, alternatives)
            return
        options = [self._options(name, unknown) for name in names]
        if not all(options) or prod(map(len, options)) > MOST_OUTCOMES:
            return
        for chosen in product(*options):
            allowed: dict[int, int] = {}
            for _, masks in chosen:
                allowed |= masks
            words = [self._narrowed(x.stretches, allowed) for x in alternatives]
            runs = [self._run(word) for word in words if word is not None]
            if runs:
                result = min(run[0] for run in runs), max(run[1] for run in runs)
                when = {name: value for name, (value, _) in zip(names, chosen, strict=True)}
                yield ConditionalOutcome(when, _NAMES.get(result, "open"))

    def _outcomes_of_constants(
        self,
        names: Sequence[str],
        alternatives: Sequence[PossibleAlternative],
    ) -> Iterator[ConditionalOutcome]:
        """The outcomes if the only deciding name is a constant of the world."""
        if len(names) > 1 or len(alternatives) > MOST_OUTCOMES:
            return
        for alternative in alternatives:
            value = alternative.constants.get(names[0])
            if not isinstance(value, bool | str):
                return
            best, worst = self._run(alternative.stretches)
            yield ConditionalOutcome({names[0]: value}, _NAMES.get((best, worst), "open"))

    def _options(
        self, name: str, unknown: Sequence[frozenset[str]]
    ) -> list[tuple[bool | str, dict[int, int]]]:
        """The values of a name, each with the digits that it allows; none if there are too many."""
        about = [n for n, names in enumerate(unknown) if name in names]
        reads = [self._reads[n] for n in about]
        if all(isinstance(read, Read) for read in reads):
            texts = dict.fromkeys(
                value for read in reads if isinstance(read, Read) for value in read.values
            )
            values: list[bool | str] = [*texts] if texts else [False, True]
            if texts and any(isinstance(read, Read) and read.others for read in reads):
                values.append("another")
            return [
                (
                    value,
                    {
                        n: 1 << read.digit(value)
                        for n, read in zip(about, reads, strict=True)
                        if isinstance(read, Read)
                    },
                )
                for value in values
            ]
        if len(reads) == 1 and isinstance(reads[0], NumberRead) and scale(reads[0]).quantity:
            return [
                (_side(reads[0], digit), {about[0]: 1 << digit}) for digit in range(reads[0].size)
            ]
        return []

    def _narrowed(self, word: _Stretches, allowed: Mapping[int, int]) -> _Stretches | None:
        """The word restricted to these digits of some reads, where they are unknown."""
        narrowed: list[tuple[Letters, int]] = []
        for letters, length in word:
            cubes = []
            for cube in letters:
                masks = [
                    mask & allowed[n] if n in allowed and _is_open(letters, n) else mask
                    for n, mask in enumerate(cube)
                ]
                if all(masks):
                    cubes.append(tuple(masks))
            if not cubes or not self.classes.of(tuple(cubes)):
                return None
            narrowed.append((tuple(cubes), length))
        return tuple(narrowed)

    def untold(self, untold: frozenset[str]) -> tuple[str, ...]:
        """Names among these that are missing for some word to be known to violate the rule."""
        return self._required.missing_of(untold)


def _possible_alternatives(
    words: Sequence[PossibleWord], constants: Sequence[Mapping[str, object]]
) -> tuple[tuple[PossibleAlternative, ...], tuple[frozenset[str], ...]]:
    """The letters of words, and for each read the names that are unknown in some of them."""
    alternatives = tuple(
        [
            PossibleAlternative(_stretches(word.states), own)
            for word, own in zip(words, constants, strict=True)
        ]
    )
    unknown = zip(*(word.unknown for word in words), strict=True)
    return alternatives, tuple(frozenset().union(*names) for names in unknown)


def _doubtful(
    alternatives: Sequence[PossibleAlternative], unknown: Sequence[frozenset[str]]
) -> frozenset[str]:
    """The names on which the outcome may depend."""
    doubtful = frozenset[str]().union(*unknown)
    if alternatives[1:]:
        doubtful = doubtful.union(*[own.constants for own in alternatives])
    return doubtful


def _stretches(states: Sequence[Letters]) -> _Stretches:
    return tuple([(letters, len(list(alike))) for letters, alike in groupby(states)])


def _is_open(letters: Letters, read: int) -> bool:
    union = 0
    for cube in letters:
        union |= cube[read]
    return bool(union & (union - 1))


def _side(read: NumberRead, digit: int) -> str:
    """The numbers that have a digit, in words."""
    texts = []
    if digit:
        below = read.thresholds[digit - 1]
        texts.append(f"{'>=' if below.inclusive else '>'} {number_in_words(below.limit)}")
    if digit < len(read.thresholds):
        above = read.thresholds[digit]
        texts.append(f"{'<' if above.inclusive else '<='} {number_in_words(above.limit)}")
    return " and ".join(texts)


_PREPARED: dict[tuple[int, frozenset[int]], tuple[object, UncertainMachine]] = {}
_MOST_PREPARED = 1 << 10


def uncertain_machine(
    rule: CompiledRule, outcomes: OutcomeMachine | None, starts: Iterable[int] = (0,)
) -> UncertainMachine:
    """The rule's machine for uncertain words; ``outcomes`` is that for prefixes, if any.

    Without it a run begins in any of the ``starts``.
    """
    source: object = rule.machine if outcomes is None else outcomes
    key = id(source), frozenset(starts)
    known = _PREPARED.get(key)
    if known is None or known[0] is not source:
        if len(_PREPARED) >= _MOST_PREPARED:
            _PREPARED.clear()
        machine = outcomes or replace(of_complete_words(rule.machine), starts=key[1])
        known = source, UncertainMachine(machine)
        _PREPARED[key] = known
    return known[1]
