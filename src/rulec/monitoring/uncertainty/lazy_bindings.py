"""Bindings of rules with many variables, built only where the rule may not be kept.

Thirty objects can be chosen for six variables in 427 million ways, of which hardly any matters:
once the values of some objects show that no state affects the rule's machine, whatever the other
objects are, no further object is tried. So a rule is bound variable by variable.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Container, Iterator, Mapping, Sequence
from heapq import merge
from itertools import chain
from typing import TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import scale
from rulec.diagnostics import RulecError
from rulec.monitoring.bindings import (
    Binding,
    Cast,
    binding_of,
    in_usual_order,
    types_of,
    usual_order,
)
from rulec.monitoring.uncertainty.idle_letters import IdleLetters
from rulec.monitoring.uncertainty.state_letters.read_digits import names_of_read
from rulec.resource_limits import CHOICES
from rulec.trace.remembered import Remembered
from rulec.vocabulary.vocabulary_model import choices, fitting_objects

ReadBits: TypeAlias = Callable[[Read | NumberRead, Mapping[str, str], tuple[int, int]], list[int]]
"""The digits, as bits, that a read may have for chosen objects in the states of a stretch.

Raises RulecError R0504.
"""


def doubtful_bindings(
    rule: CompiledRule,
    cast: Cast,
    read: ReadBits,
    idle: IdleLetters,
    begun: Collection[tuple[str, ...]] = (),
) -> Iterator[Binding]:
    """The bindings of a rule that may not be kept, and possibly others, in the usual order.

    They include those that have ``begun`` before the first state. If a value cannot be read, all
    bindings are built, so that reading them reports the error.

    Raises RulecError R0718 if even so more choices than the limit `choices` have to be tried.
    """
    search = _Search(rule, cast, read, idle)
    try:
        search.read_all()
    except RulecError:
        yield from cast.bindings(rule)
        return
    names = [variable.name for variable in rule.variables]
    # Check all choices first: judging many and refusing the rest would be wasted work.
    every = list(search.choices())
    for chosen in _in_order(iter(every), begun, cast):
        binding = binding_of(dict(zip(names, chosen, strict=True)), cast.present, cast.n_states)
        if binding.first <= binding.last:
            yield binding


def _in_order(
    doubtful: Iterator[tuple[str, ...]], already_begun: Collection[tuple[str, ...]], cast: Cast
) -> Iterator[tuple[str, ...]]:
    if not already_begun:
        return doubtful
    both = merge(doubtful, in_usual_order(already_begun, cast), key=usual_order(cast))
    return iter(dict.fromkeys(both))


class _Search:
    """A search through the choices of objects, one variable after the other.

    Of each object, and of the chosen objects together, only those states are evaluated in which
    fewer objects have not already shown that there is no effect.
    """

    def __init__(self, rule: CompiledRule, cast: Cast, read: ReadBits, idle: IdleLetters) -> None:
        self._rule, self._cast, self._read, self._idle = rule, cast, read, idle
        self._variables = [variable.name for variable in rule.variables]
        self._reads = [(own, _variables_of(own)) for own in rule.machine.reads]
        self._anything = tuple([(1 << own.size) - 1 for own in rule.machine.reads])
        places = {variable: place for place, variable in enumerate(self._variables)}
        self._about = [tuple([places[name] for name in names]) for _, names in self._reads]
        self._known = [
            [number for number, own in enumerate(self._about) if max(own, default=-1) == place]
            for place in range(-1, len(places))
        ]
        """The reads that are known without any object, then those that each variable adds."""
        self._so_far = [tuple(chain(*self._known[: end + 1])) for end in range(len(self._known))]
        self._columns = Remembered(self._column, None)
        """The digits of a read wherever its objects are present, and the first such state."""
        self._busy = Remembered(self._is_busy)
        """Whether some letter with these digits, as bits, of known reads is not idle."""
        self._most = CHOICES.value()
        self._tried = 0

    def read_all(self) -> None:
        """Read every value that some choice reads and a state may lack. Raises RulecError."""
        type_of = {variable.name: variable.type for variable in self._rule.variables}
        declarations, objects = self._cast.vocabulary.declarations, self._cast.objects
        for number, (read, variables) in enumerate(self._reads):
            if all(declarations[name].default is not None for name in names_of_read(read)):
                continue
            types = [type_of[variable] for variable in variables]
            for chosen in choices(types, objects, self._cast.vocabulary):
                self._columns[number, chosen]

    def choices(self) -> Iterator[tuple[str, ...]]:
        """The choices of objects for which some state affects the rule's machine."""
        cast = self._cast
        nobody = self._longer(dict.fromkeys(range(cast.n_states), ()), (), range(cast.n_states))
        fitting = []
        for place, kind in enumerate(types_of(self._rule)):
            busy = {
                item: self._busy_alone(place, item)
                for item in fitting_objects(kind, cast.objects, cast.vocabulary)
            }
            fitting.append({item: states for item, states in busy.items() if states})
        if all(fitting):
            self._count((), nobody, fitting)
            yield from self._extended((), nobody, fitting)

    def _count(
        self,
        chosen: tuple[str, ...],
        cubes: Mapping[int, tuple[int, ...]],
        fitting: Sequence[Mapping[str, frozenset[int]]],
    ) -> None:
        """Raise RulecError R0718 if more choices than the limit would be tried from here on.

        Most are for the last variable, and those are counted without being tried.
        """
        own = fitting[len(chosen)]
        self._tried += len(own) - sum(item in own for item in chosen)
        if self._tried > self._most:
            raise CHOICES.exceeded(self._cast.place, f"rule `{self._rule.name}`")
        if len(chosen) + 1 < len(fitting):
            for longer, both in self._next(chosen, cubes, own):
                self._count(longer, both, fitting)

    def _extended(
        self,
        chosen: tuple[str, ...],
        cubes: Mapping[int, tuple[int, ...]],
        fitting: Sequence[Mapping[str, frozenset[int]]],
    ) -> Iterator[tuple[str, ...]]:
        """Choices that begin with ``chosen``; ``cubes`` are its reads, by state."""
        if len(chosen) == len(fitting):
            yield chosen
            return
        for longer, both in self._next(chosen, cubes, fitting[len(chosen)]):
            yield from self._extended(longer, both, fitting)

    def _next(
        self,
        chosen: tuple[str, ...],
        cubes: Mapping[int, tuple[int, ...]],
        fitting: Mapping[str, frozenset[int]],
    ) -> Iterator[tuple[tuple[str, ...], Mapping[int, tuple[int, ...]]]]:
        """The chosen objects and one more, with their reads in states that may not be kept."""
        for item, own in fitting.items():
            if item not in chosen:
                longer = *chosen, item
                both = self._longer(cubes, longer, own)
                if both:
                    yield longer, both

    def _longer(
        self, cubes: Mapping[int, tuple[int, ...]], chosen: tuple[str, ...], own: Container[int]
    ) -> Mapping[int, tuple[int, ...]]:
        """The cubes with the reads of the last chosen object, where the rule may not be kept."""
        columns = [
            self._columns[number, tuple([chosen[place] for place in self._about[number]])]
            for number in self._known[len(chosen)]
        ]
        known = self._so_far[len(chosen)]
        result = {}
        for state, cube in cubes.items():
            if state in own:
                digits = *cube, *[column[state - first] for column, first in columns]
                if self._busy[known, digits]:
                    result[state] = digits
        return result

    def _busy_alone(self, place: int, item: str) -> frozenset[int]:
        """The states with an object in which the rule may not be kept, whatever the others are."""
        own = binding_of({self._variables[place]: item}, self._cast.present, self._cast.n_states)
        known = tuple([n for n, about in enumerate(self._about) if set(about) <= {place}])
        columns = [self._columns[n, (item,) * len(self._about[n])] for n in known]
        return frozenset(
            state
            for state in range(own.first, own.last + 1)
            if self._busy[known, tuple([column[state - first] for column, first in columns])]
        )

    def _column(self, key: tuple[int, tuple[str, ...]]) -> tuple[list[int], int]:
        (read, variables), items = self._reads[key[0]], key[1]
        about = dict(zip(variables, items, strict=True))
        own = binding_of(about, self._cast.present, self._cast.n_states)
        met = own.first <= own.last
        return self._read(read, about, (own.first, own.last)) if met else [], own.first

    def _is_busy(self, key: tuple[tuple[int, ...], tuple[int, ...]]) -> bool:
        cube = list(self._anything)
        for number, own in zip(*key, strict=True):
            cube[number] = own
        return not self._idle.of_cube(cube)


def _variables_of(read: Read | NumberRead) -> tuple[str, ...]:
    about = read if isinstance(read, Read) else scale(read)
    return tuple(dict.fromkeys(about.variables))
