"""Rules prepared for any objects: their reads of a state, and the classes of their letters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import IMPOSSIBLE
from rulec.automata.outcome_machine import OutcomeMachine, of_running_words
from rulec.logic.free_names import names_in
from rulec.monitoring.online.encoding.digit_tables import PartNumbers, digit_bits
from rulec.monitoring.online.encoding.encoded_values import (
    MISSING,
    PARTIAL_DIGITS,
    UNKNOWN_DIGIT,
    DigitWeight,
    MonitorInput,
    monitor_inputs,
    value_inputs,
)
from rulec.monitoring.online.four_valued import (
    FourValued,
    LetterClass,
    MonitorEdge,
    RunningVerdict,
    linked_edges,
)
from rulec.monitoring.online.uncertain_steps import Edge, UncertainSteps, cut_edges
from rulec.monitoring.uncertainty.idle_letters import IdleLetters
from rulec.monitoring.uncertainty.state_letters.entangled_reads import EntangledReads, local_reads
from rulec.monitoring.uncertainty.state_letters.read_digits import names_of_read
from rulec.vocabulary import Enumeration, Vocabulary

MOST_CLASSES = 1 << 12
"""How many classes of a rule's letters are kept before all are discarded."""

BY_STATE = IMPOSSIBLE - 1
"""Replaces the class of a rule's letter that depends on the whole state."""


class WholeStateError(LookupError):
    """The letters that a rule may read depend on more than its own objects."""


@dataclass(frozen=True, eq=False)
class PreparedRule:
    """A rule prepared for any objects: its monitor's ``start`` and ``edges``, and its reads.

    ``letters`` has the class of each letter. ``entangled`` are its entangled reads, None if they
    depend on more than the rule's own objects; their inputs are the ``values`` on which they
    depend. ``alone`` are the places of the other reads, with an input for each. ``is_cut``: what
    was before objects appeared, and comes after they are gone, is unknown.
    """

    rule: CompiledRule
    start: Edge
    edges: Mapping[tuple[int, FourValued], MonitorEdge]
    letters: tuple[int, ...]
    entangled: EntangledReads | None
    alone: tuple[int, ...]
    inputs: tuple[tuple[MonitorInput, DigitWeight], ...]
    values: tuple[MonitorInput, ...]
    vocabulary: Vocabulary
    axioms: tuple[CompiledAxiom, ...]
    is_cut: bool = False

    @cached_property
    def uncertain(self) -> UncertainSteps:
        """The steps with unknown values."""
        return UncertainSteps(of_running_words(self.rule.machine), self.edges)

    @cached_property
    def idle(self) -> IdleLetters:
        """The letters that leave the monitor in its start state and its verdict unchanged."""
        steps = self.uncertain

        def are_idle(classes: int) -> bool:
            letters = steps.letter_class(classes)
            return letters is not None and self.is_at_start(steps.rows[self.start][letters])

        return IdleLetters(steps.classes.diagram, are_idle)

    def is_at_start(self, edge: Edge) -> bool:
        """Whether after an edge everything is as at the start."""
        return _ends(edge) == _ends(self.start)

    @cached_property
    def _strides(self) -> tuple[int, ...]:
        """The factor of each read's digit in the number of a letter."""
        strides = [1]
        for read in self.rule.machine.reads:
            strides.append(strides[-1] * read.size)
        return tuple(strides)

    @cached_property
    def n_classes(self) -> int:
        """How many letter classes it has; larger numbers stand for sets of them."""
        return max(map(len, [edge.successors for edge in self.edges.values()]), default=0)

    @property
    def name(self) -> str:
        """The rule's name."""
        return self.rule.name

    @cached_property
    def all_inputs(self) -> tuple[MonitorInput, ...]:
        """The inputs, followed by the values."""
        return (*[read for read, _ in self.inputs], *self.values)

    @cached_property
    def classes(self) -> ClassTable:
        """The classes that the rule reads, by the encoding of ``all_inputs``."""
        return ClassTable(self)

    @cached_property
    def constants(self) -> frozenset[str]:
        """The constants that the rule reads."""
        read = (name for own in self.rule.machine.reads for name in names_of_read(own))
        return frozenset(read).intersection(self.vocabulary.constants)

    def bound(self, items: Sequence[str]) -> dict[str, str]:
        """Objects by the names of the variables that they stand for."""
        return dict(zip([variable.name for variable in self.rule.variables], items, strict=True))

    def letter_class(self, digits: tuple[Any, ...]) -> tuple[LetterClass, bool]:
        """The classes that the rule reads, and whether this is exact.

        ``digits`` are those of the ``inputs``, then the ``values``, as encoded. Raises LookupError
        if one is missing or invalid, or if the classes depend on the whole state.
        """
        n_alone = len(self._weights)
        own, values = digits[:n_alone], digits[n_alone:]
        place, is_exact, letter = self._decided.get(values) or self._decided_by(values)
        if letter is None or not PARTIAL_DIGITS.isdisjoint(map(type, own)):
            return self._possible_class(own, place), is_exact and not self._varies(own)
        for weight_of, digit in zip(self._weights, own, strict=True):
            letter += weight_of(digit)
        letter_class = self.letters[letter]
        if letter_class == IMPOSSIBLE:
            raise LookupError
        return letter_class, is_exact

    @cached_property
    def _weights(self) -> tuple[DigitWeight, ...]:
        return tuple([weight_of for _, weight_of in self.inputs])

    @cached_property
    def _decided(self) -> dict[tuple[Any, ...], _Decided]:
        return {}

    def _decided_by(self, values: tuple[Any, ...]) -> _Decided:
        """The consequence of these values, which often stay the same while others change."""
        decided: _Decided = 0, True, 0
        if self.entangled is not None and self.entangled.numbers:
            for at, allowed in self._elsewhere:
                if values[at] not in allowed:
                    raise LookupError
            key = tuple([numbers[pick(values)] for pick, numbers in self._parts])
            place = self.entangled.place_of_parts(key)
            decided = self._decided_at.get(place) or self._decided_by_place(place)
            if any(type(values[at]) in PARTIAL_DIGITS for at in self._constant_places):
                decided = place, False, decided[2]
        if len(self._decided) >= MOST_CLASSES:
            self._decided.clear()
        self._decided[values] = decided
        return decided

    def _decided_by_place(self, place: int) -> _Decided:
        assert self.entangled is not None
        cubes, is_exact = self.entangled.joint_letters[place]
        weight: int | None = None
        if len(cubes) == 1 and not any(x & (x - 1) for x in cubes[0]):
            strides = [self._strides[n] for n in self.entangled.numbers]
            digits = [x.bit_length() - 1 for x in cubes[0]]
            weight = sum([x * y for x, y in zip(strides, digits, strict=True)])
        decided = self._decided_at[place] = place, is_exact, weight
        return decided

    @cached_property
    def _decided_at(self) -> dict[int, _Decided]:
        return {}

    @cached_property
    def _constant_places(self) -> tuple[int, ...]:
        """The places of constants among the values."""
        return tuple(
            [n for n, read in enumerate(self.values) if not self.constants.isdisjoint(read.names)]
        )

    def _possible_class(self, own: Sequence[Any], place: int) -> LetterClass:
        """The classes for digits of which some are partly known, and a place of joint letters."""
        reads, steps = self.rule.machine.reads, self.uncertain
        key = [
            digit_bits(reads[read], digit, weight_of)
            for read, digit, weight_of in zip(self.alone, own, self._weights, strict=True)
        ]
        if self.entangled is None:
            if any(key[read] & (key[read] - 1) for read in self._perhaps_entangled):
                raise WholeStateError
            classes = steps.classes.of((tuple(key),))
        else:
            joint = [place] if self.entangled.numbers else []
            letters = steps.classes.of_rule(self.rule, self.entangled)
            classes = letters.classes_of((*key, *joint))
        letter_class = steps.letter_class(classes)
        if letter_class is None:
            raise LookupError
        return letter_class

    def _varies(self, own: Sequence[Any]) -> bool:
        """Whether an unknown constant among these digits is taken to vary."""
        return bool(self.constants) and any(
            type(digit) in PARTIAL_DIGITS and not self.constants.isdisjoint(read.names)
            for digit, (read, _) in zip(own, self.inputs, strict=True)
        )

    @cached_property
    def _perhaps_entangled(self) -> frozenset[int]:
        """The places of reads that are counts, or share a name with other reads or axioms."""
        names = [set(names_of_read(read)) for read in self.rule.machine.reads]
        facts = [frozenset(names_in(axiom.formula)) for axiom in self.axioms]
        return frozenset(
            n
            for n, own in enumerate(names)
            if self.inputs[n][0].name is None
            or any(not own.isdisjoint(other) for other in (*names[:n], *names[n + 1 :], *facts))
        )

    @cached_property
    def _parts(self) -> Sequence[tuple[Callable[[Any], tuple[Any, ...]], PartNumbers]]:
        """The parts of the entangled reads."""
        parts = () if self.entangled is None else self.entangled.parts
        places = range(len(self.values))
        return [
            (pick, PartNumbers(number, [self._allowed[n] for n in pick(places)]))
            for pick, number in parts
        ]

    @cached_property
    def _elsewhere(self) -> Sequence[tuple[int, frozenset[object]]]:
        """The places of enumerations that belong to no part, with their possible encoded values."""
        places = range(len(self.values))
        seen = {place for pick, _ in self._parts for place in pick(places)}
        return [
            (place, allowed)
            for place, allowed in enumerate(self._allowed)
            if allowed is not None and place not in seen
        ]

    @cached_property
    def _allowed(self) -> Sequence[frozenset[object] | None]:
        """For each value that is an enumeration the possible encoded values."""
        declared = [self.vocabulary.declarations[read.names[0]] for read in self.values]
        return [
            frozenset([*own.values, MISSING, UNKNOWN_DIGIT])
            if isinstance(own, Enumeration)
            else None
            for own in declared
        ]


def _ends(edge: Edge) -> tuple[object, RunningVerdict]:
    states = (edge.state,) if isinstance(edge, MonitorEdge) else edge.states
    return states, edge.verdict


class ClassTable(dict[tuple[Any, ...], "LetterClass"]):
    """The classes that a rule reads, by its inputs' digits or partly known values.

    ``inexact`` are those for which the classes are overestimated, because an unknown constant is
    taken to vary from state to state. A class that depends on the whole state is ``BY_STATE``.
    """

    def __init__(self, prepared: PreparedRule) -> None:
        self._prepared = prepared
        self.inexact: set[tuple[Any, ...]] = set()

    def __missing__(self, digits: tuple[Any, ...]) -> LetterClass:
        try:
            letter_class, is_exact = self._prepared.letter_class(digits)
        except WholeStateError:
            letter_class, is_exact = BY_STATE, True
        if len(self) >= MOST_CLASSES:
            self.clear()
            self.inexact.clear()
        if not is_exact:
            self.inexact.add(digits)
        self[digits] = letter_class
        return letter_class


_Decided: TypeAlias = tuple[int, bool, int | None]
"""The place of the joint letters of entangled reads, whether they are exact, and their weight.

The weight is None if there are several. A plain tuple of numbers is not tracked by the garbage
collector.
"""


def prepared_rule(
    rule: CompiledRule, rulebook: CompiledRulebook, cut: OutcomeMachine | None = None
) -> PreparedRule:
    """Prepare a rule; ``cut`` is its machine if the past is unknown.

    The result is cached with everything that monitors compute in it.
    """
    known: dict[object, PreparedRule] = rulebook.prepared.setdefault(PreparedRule, {})
    key = rule.name, cut
    if key not in known:
        known[key] = _prepared_rule(rule, rulebook, cut)
    return known[key]


def _prepared_rule(
    rule: CompiledRule, rulebook: CompiledRulebook, cut: OutcomeMachine | None
) -> PreparedRule:
    vocabulary, reads = rulebook.vocabulary, local_reads(rule, rulebook)
    entangled = () if reads is None else reads.numbers
    alone = tuple([n for n in range(len(rule.machine.reads)) if n not in entangled])
    inputs = monitor_inputs(rule, vocabulary)
    start, edges = linked_edges(rule.machine)
    prepared = PreparedRule(
        rule=rule,
        start=start,
        edges=edges,
        letters=rule.machine.letters,
        entangled=reads,
        alone=alone,
        inputs=tuple([inputs[n] for n in alone]),
        values=() if reads is None else value_inputs(rule, reads.subjects),
        vocabulary=vocabulary,
        axioms=rulebook.axioms,
    )
    if cut is None:
        return prepared
    first, cut_edges_, steps = cut_edges(cut)
    prepared = replace(prepared, start=first, edges=cut_edges_, letters=cut.letters, is_cut=True)
    vars(prepared)["uncertain"] = steps
    return prepared
