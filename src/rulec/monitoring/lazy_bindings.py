"""Bindings of rules with many variables, made only where the rule may be anything but kept.

Thirty objects can be chosen for six variables in 427 million ways, of which hardly one matters:
where what is known of some of the objects already shows that no state does anything to the rule's
machine, whoever the others are, no other is looked for. So a rule is bound variable by variable.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import prod

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Read
from rulec.automata.thresholds import scale
from rulec.diagnostics import RulecError
from rulec.monitoring.bindings import Binding, binding_of, bindings, check_choices
from rulec.monitoring.letter_reader import LetterReader
from rulec.resource_limits import CHOICES
from rulec.vocabulary.vocabulary_model import choices, fitting_objects


def doubtful_bindings(rule: CompiledRule, reader: LetterReader, n_states: int) -> Iterator[Binding]:
    """The bindings of a rule that may not be kept, and perhaps others, in the usual order.

    Where something cannot be read it is for whoever reads all of them to say so: then all are
    made.

    Raises RulecError R0718 if even of these more than the limit `choices` have to be looked at.
    """
    search = _Search(rule, reader, n_states)
    try:
        search.read_all()
    except RulecError:
        vocabulary = reader.rulebook.vocabulary
        check_choices(rule, vocabulary, reader.objects, reader.place)
        yield from bindings(rule, vocabulary, reader.objects, reader.present, n_states)
        return
    yield from search.bindings()


class _Search:
    """A search through the choices of objects, one variable after the other."""

    def __init__(self, rule: CompiledRule, reader: LetterReader, n_states: int) -> None:
        self._rule, self._reader, self._n_states = rule, reader, n_states
        self._variables = [variable.name for variable in rule.variables]
        self._reads = [(read, _variables_of(read)) for read in rule.machine.reads]
        self._idle = IdleReads(rule.machine)
        self._most = CHOICES.value()
        self._tried = 0

    def read_all(self) -> None:
        """Read everything that any choice reads. Raises RulecError for what is not there."""
        type_of = {variable.name: variable.type for variable in self._rule.variables}
        vocabulary, objects = self._reader.rulebook.vocabulary, self._reader.objects
        for _, variables in self._reads:
            for chosen in choices([type_of[x] for x in variables], objects, vocabulary):
                self._is_idle(dict(zip(variables, chosen, strict=True)))

    def bindings(self) -> Iterator[Binding]:
        """Those that may not be kept."""
        vocabulary = self._reader.rulebook.vocabulary
        fitting = [
            [
                item
                for item in fitting_objects(variable.type, self._reader.objects, vocabulary)
                if not self._is_idle({variable.name: item})
            ]
            for variable in self._rule.variables
        ]
        if all(fitting):
            yield from self._extended({}, fitting)

    def _extended(
        self, chosen: Mapping[str, str], fitting: Sequence[Sequence[str]]
    ) -> Iterator[Binding]:
        if len(chosen) == len(fitting):
            yield self._binding(chosen)
            return
        variable = self._variables[len(chosen)]
        for item in fitting[len(chosen)]:
            if item in chosen.values():
                continue
            self._tried += 1
            if self._tried > self._most:
                whose = f"rule `{self._rule.name}`"
                raise CHOICES.exceeded(self._reader.place, whose)
            longer = {**chosen, variable: item}
            if not self._is_idle(longer):
                yield from self._extended(longer, fitting)

    def _binding(self, chosen: Mapping[str, str]) -> Binding:
        return binding_of(chosen, self._reader.present, self._n_states)

    def _is_idle(self, chosen: Mapping[str, str]) -> bool:
        """Whether the rule is kept for these objects, whoever the others are."""
        own = self._binding(chosen)
        if own.first > own.last:
            return True  # they never meet
        known, places = [], np.zeros(own.last - own.first + 1, dtype=np.intp)
        stride = 1
        for number, (read, variables) in enumerate(self._reads):
            if chosen.keys() >= set(variables):
                digits = self._reader.digits(read, chosen, (own.first, own.last), self._rule.name)
                places += stride * np.asarray(digits, dtype=np.intp)
                stride *= read.size
                known.append(number)
        return bool(self._idle.of(tuple(known))[places].all())


def _variables_of(read: Read | NumberRead) -> tuple[str, ...]:
    about = read if isinstance(read, Read) else scale(read)
    return tuple(dict.fromkeys(about.variables))


class IdleReads:
    """What has to be read to see that a letter does nothing to a machine.

    Such letters lead the machine to where they keep it, with every word of them kept.
    """

    def __init__(self, machine: MealyMonitor) -> None:
        self._sizes = [read.size for read in machine.reads]
        assert prod(self._sizes) == len(machine.letters)
        home = _idle_classes(machine)
        # What cannot be is never idle, lest nobody notice it.
        self._idle = np.array([n != IMPOSSIBLE and n in home for n in machine.letters])
        self._known: dict[tuple[int, ...], NDArray[np.bool_]] = {}

    def of(self, known: tuple[int, ...]) -> NDArray[np.bool_]:
        """Whether all letters with some digits are idle, by the place that these digits make.

        ``known`` are the numbers of the reads whose digits they are, in ascending order, the first
        of which counts once.
        """
        if known not in self._known:
            # The first read's digits are next to each other, so its axis is the last one.
            letters = self._idle.reshape(self._sizes[::-1])
            n_reads = len(self._sizes)
            others = [n_reads - 1 - n for n in range(n_reads) if n not in known]
            self._known[known] = letters.all(axis=tuple(others)).reshape(-1)
        return self._known[known]


def _idle_classes(machine: MealyMonitor) -> set[int]:
    """The largest set of letter classes that keep the machine at one of its states."""
    classes = range(len(machine.successors[0]))
    best: set[int] = set()
    for home in dict.fromkeys([0, *machine.successors[0]]):
        staying = {
            n
            for n in classes
            if machine.successors[0][n] == machine.successors[home][n] == home
            and machine.outputs[0][n]
            and machine.outputs[home][n]
        }
        best = max(best, staying, key=len)
    return best
