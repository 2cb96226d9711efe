"""Rules prepared for any objects: what they read of a state, and the classes of their letters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule, CompiledRulebook
from rulec.automata.outcome_machine import OutcomeMachine, of_running_words
from rulec.logic.free_names import names_in
from rulec.monitoring.online.encoding.encoded_values import PARTIAL_DIGITS, decoded
from rulec.monitoring.online.four_valued import ClassSet
from rulec.monitoring.online.rule_steps import Edge, RuleSteps
from rulec.monitoring.uncertainty.idle_letters import IdleLetters
from rulec.monitoring.uncertainty.state_letters.entangled_reads import EntangledReads, local_reads
from rulec.monitoring.uncertainty.state_letters.read_digits import (
    ReadDigits,
    names_of_read,
    read_digits,
)
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import MissingValueError, Subject
from rulec.trace.remembered import Remembered
from rulec.vocabulary import Vocabulary

BY_STATE: ClassSet = -1
"""Replaces the classes of a rule's letters that depend on the whole state."""

PossibleClasses: TypeAlias = tuple[ClassSet, bool]
"""The classes that a rule may read, and whether each is possible."""


class ReadSource(NamedTuple):
    """A value that rules read, of objects given by the places of variables.

    It is that of ``name`` or, if this is None, a ``sum`` or count, whose value are its digits.
    """

    name: str | None
    places: tuple[int, ...]
    sum: ReadDigits | None = None


@dataclass(frozen=True, eq=False)
class PreparedRule:
    """A rule prepared for any objects: the ``steps`` of its monitor, and its reads.

    ``entangled`` are its entangled reads, None if they depend on more than the rule's own objects;
    they depend on the ``values``. ``alone`` are the other reads, each with its source. ``is_cut``:
    what was before objects appeared, and comes after they are gone, is unknown.
    """

    rule: CompiledRule
    steps: RuleSteps
    entangled: EntangledReads | None
    alone: tuple[tuple[ReadDigits, ReadSource], ...]
    values: tuple[ReadSource, ...]
    vocabulary: Vocabulary
    axioms: tuple[CompiledAxiom, ...]
    is_cut: bool = False

    @property
    def start(self) -> Edge:
        """The edge before the first letter."""
        return self.steps.start

    @cached_property
    def idle(self) -> IdleLetters:
        """The letters that leave the monitor in its start state and its verdict unchanged."""
        return IdleLetters(
            self.steps.classes.diagram, lambda classes: self.is_at_start(self.start[classes])
        )

    def is_at_start(self, edge: Edge) -> bool:
        """Whether after an edge everything is as at the start."""
        return edge.ends == self.start.ends

    @property
    def name(self) -> str:
        """The rule's name."""
        return self.rule.name

    @property
    def sources(self) -> tuple[ReadSource, ...]:
        """All that it reads."""
        return (*[source for _, source in self.alone], *self.values)

    @cached_property
    def constants(self) -> frozenset[str]:
        """The constants that the rule reads."""
        read = (name for own in self.rule.machine.reads for name in names_of_read(own))
        return frozenset(read).intersection(self.vocabulary.constants)

    def bound(self, items: Sequence[str]) -> dict[str, str]:
        """Objects by the names of the variables that they stand for."""
        return dict(zip([variable.name for variable in self.rule.variables], items, strict=True))

    def possible_classes(self, read: tuple[Any, ...]) -> PossibleClasses:
        """The classes of its letters, ``BY_STATE`` if these depend on the whole state.

        ``read`` are the digits, as bits, of the reads that are ``alone``, then the encoded
        ``values``. Raises LookupError if a value is missing, or if axioms exclude all letters.
        """
        return self._known[read]

    @cached_property
    def _known(self) -> Remembered[tuple[Any, ...], PossibleClasses]:
        return Remembered(self._classes_of)

    def _classes_of(self, read: tuple[Any, ...]) -> PossibleClasses:
        digits, values = read[: len(self.alone)], read[len(self.alone) :]
        several = [n for n, own in enumerate(digits) if own & (own - 1)]
        if self.entangled is None:
            if not self._perhaps_entangled.isdisjoint(several):
                return BY_STATE, True
            classes, is_exact = self.steps.classes.of((digits,)), True
        else:
            letters = self.steps.classes.of_rule(self.rule, self.entangled)
            given = tuple([decoded(value, None) for value in values])
            try:
                classes, is_exact = letters.possible(digits, given)
            except MissingValueError:
                raise LookupError from None
        if not classes:
            raise LookupError
        # An unknown constant is taken to vary from state to state.
        varying = {name for n in several for name in self.alone[n][0].names}
        for source, value in zip(self.values, values, strict=True):
            if source.name is not None and type(value) in PARTIAL_DIGITS:
                varying.add(source.name)
        return classes, is_exact and varying.isdisjoint(self.constants)

    @cached_property
    def _perhaps_entangled(self) -> frozenset[int]:
        """The places of reads that are counts, or share a name with other reads or axioms."""
        names = [set(read.names) for read, _ in self.alone]
        facts = [frozenset(names_in(axiom.formula)) for axiom in self.axioms]
        return frozenset(
            n
            for n, own in enumerate(names)
            if self.alone[n][0].subject is None
            or any(not own.isdisjoint(other) for other in (*names[:n], *names[n + 1 :], *facts))
        )


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
    places = {variable.name: place for place, variable in enumerate(rule.variables)}
    entangled = local_reads(rule, rulebook)
    numbers = () if entangled is None else entangled.numbers
    alone = [read_digits(x) for n, x in enumerate(rule.machine.reads) if n not in numbers]
    subjects = () if entangled is None else entangled.subjects
    return PreparedRule(
        rule=rule,
        steps=RuleSteps(of_running_words(rule.machine) if cut is None else cut),
        entangled=entangled,
        alone=tuple([(read, _source(read, places)) for read in alone]),
        values=tuple([_source_of(subject, places) for subject in subjects]),
        vocabulary=rulebook.vocabulary,
        axioms=rulebook.axioms,
        is_cut=cut is not None,
    )


def _source(read: ReadDigits, places: Mapping[str, int]) -> ReadSource:
    if read.subject is not None:
        return _source_of(read.subject, places)
    return ReadSource(None, tuple([places[variable] for variable in read.variables]), read)


def _source_of(subject: Subject, places: Mapping[str, int]) -> ReadSource:
    return ReadSource(subject[0], tuple([places[variable] for variable in subject[1]]))
