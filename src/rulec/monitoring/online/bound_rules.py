"""Rules bound to the objects that are present.

Rules with very many choices of objects are bound only to those for which something has happened
(see ``waking``): for all other choices each rule is still in its start state.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import SourceLocation, named
from rulec.monitoring.axiom_violations import check_counting_axioms
from rulec.monitoring.bindings import Cast, in_usual_order
from rulec.monitoring.implied_values import with_implied_signals
from rulec.monitoring.online.encoding.encoded_values import Encoded
from rulec.monitoring.online.encoding.state_shape import Items, StateShape
from rulec.monitoring.online.group_letters import GroupLetters
from rulec.monitoring.online.partial_states import RulesOfAll, careful_classes, rules_of_all
from rulec.monitoring.online.prepared_rule import PossibleClasses, PreparedRule
from rulec.monitoring.online.rule_group import GroupNode, RuleGroup, RuleGroups
from rulec.monitoring.online.rule_steps import Edge
from rulec.monitoring.state_validation import check_state
from rulec.monitoring.uncertainty.lazy_bindings import doubtful_bindings
from rulec.monitoring.uncertainty.state_letters.possible_letters import (
    BoundLetters,
    PossibleLetters,
    bound_letters,
)
from rulec.resource_limits import CHOICES
from rulec.rulebook.rules.axiom_instances import counts
from rulec.trace import State, Trace
from rulec.trace.remembered import Remembered
from rulec.vocabulary.vocabulary_model import choices

Awake: TypeAlias = Mapping[tuple[str, ...], Collection[Items]]
"""Choices of objects by the types of variables."""

NONE_AWAKE: Awake = {}

Letters: TypeAlias = list[int]
"""The letter read by each binding of each group, one after the other."""

MOST_SHAPES = 64
"""How many shapes of states are kept before all are discarded."""

KnownState: TypeAlias = tuple[StateShape, tuple[Encoded, ...]]
"""The shape of a state, and the state encoded."""


@dataclass(frozen=True, slots=True, eq=False)
class BoundRule:
    """A rule with every binding of its variables to present objects.

    ``bindings`` are these objects, in the order of the variables. ``places`` are their positions
    among all bindings of all groups; there the rule is the one with this ``number`` in its
    ``group``.
    """

    prepared: PreparedRule
    bindings: tuple[Items, ...]
    group: RuleGroup
    places: slice
    number: int

    def edges(self, nodes: Sequence[GroupNode]) -> list[Edge]:
        """The edge of the rule's monitor for each binding."""
        return [node.edges[self.number] for node in nodes[self.places]]


class BoundRules:
    """Rules bound to the present objects, whose types the vocabulary knows.

    Rules in ``lazy`` groups are bound to the choices of objects that are ``awake``, by types.
    """

    def __init__(
        self,
        rulebook: CompiledRulebook,
        groups: RuleGroups,
        objects: Mapping[str, str],
        awake: Awake = NONE_AWAKE,
    ) -> None:
        self.objects = dict(objects)
        self.groups = groups
        self._rulebook = rulebook
        self._counting = any(counts(axiom.formula) for axiom in rulebook.axioms)
        self._letters: BoundLetters | None = None
        self._of_all: RulesOfAll | None = None
        self._readers = Remembered(self._reader_of, MOST_SHAPES)
        self.lazy: list[RuleGroup] = []
        self._awake: dict[tuple[str, ...], frozenset[Items]] = {}
        cast = Cast(self.objects, rulebook.vocabulary, 1, {})
        self._bindings: list[tuple[RuleGroup, tuple[Items, ...]]] = []
        self._at: list[tuple[RuleGroup, Items]] = []
        by_name: dict[str, BoundRule] = {}
        end = 0
        for group in groups.groups:
            if cast.has_many(group.types):
                self.lazy.append(group)
                bindings = _chosen(group, cast, awake)
                self._awake[group.types] = frozenset(bindings)
            else:
                bindings = tuple(choices(group.types, self.objects, rulebook.vocabulary))
            begin, end = end, end + len(bindings)
            for number, prepared in enumerate(group.rules):
                places = slice(begin, end)
                by_name[prepared.name] = BoundRule(prepared, bindings, group, places, number)
            if bindings:
                self._bindings.append((group, bindings))
                self._at += [(group, items) for items in bindings]
        self.rules = tuple([by_name[prepared.name] for prepared in groups.rules])
        self.hard = tuple([rule.name for rule in rulebook.rules if rule.strength == "hard"])

    def has(self, waking: Awake) -> bool:
        """Whether these choices of objects are all bound."""
        return all(self._awake[types].issuperset(own) for types, own in waking.items())

    def waking(self, state: State, number: int, place: SourceLocation | None) -> Awake:
        """The choices of objects in lazy groups for whose rules a state may have an effect.

        Raises RulecError as ``read`` does, and R0718 if there are too many.
        """
        reader = self._checked(state, number, place)
        cast = Cast(self.objects, self._rulebook.vocabulary, 1, {}, place)
        awake: dict[tuple[str, ...], dict[Items, None]] = {}
        for group in self.lazy:
            own = awake.setdefault(group.types, {})
            for prepared in group.rules:
                bits = reader.bits_of(prepared.rule)
                bound = doubtful_bindings(prepared.rule, cast, bits, prepared.idle)
                own.update((tuple(binding.objects.values()), None) for binding in bound)
        return awake

    def read(
        self, state: State, number: int, place: SourceLocation | None
    ) -> tuple[Letters, KnownState | None]:
        """The letters of a state, and its encoding if it has one.

        Raises RulecError R0502 to R0505 or R0508, naming the state by its ``number``.
        """
        known = letters = None
        try:
            state = with_implied_signals(state, self._rulebook.vocabulary)
            names = tuple(state)
            reader = self._readers[names]
            if reader is not None:
                encoded = reader.shape.encode(state)
                known = reader.shape, encoded
                letters = reader.letters(state, encoded)
        except (LookupError, TypeError, AttributeError):
            pass
        if letters is None or self._counting:
            careful = self._checked(state, number, place)
            state = careful.view(0).state
            letters = self._careful_letters(careful) if letters is None else letters
        if self.groups.cache_size.has_holes:
            letters = self._filled(letters, state, (number, place))
        return letters, known

    def _reader_of(self, names: tuple[str, ...]) -> GroupLetters | None:
        """A new reader of states with these names.

        None if they must be read like ``verify`` does.
        """
        with suppress(LookupError, TypeError):
            vocabulary, breakpoints = self._rulebook.vocabulary, self.groups.breakpoints
            shape = StateShape(names, self.objects, vocabulary, breakpoints)
            return GroupLetters(shape, self._bindings)
        return None

    def _state_reader(
        self, state: State, where: tuple[str, SourceLocation | None]
    ) -> PossibleLetters:
        if self._letters is None:
            rulebook = self._rulebook
            self._letters = bound_letters(rulebook, self.objects, rulebook.vocabulary)
        name, place = where
        trace = Trace("", 1.0, self.objects, (state,), place=place)
        vocabulary = self._rulebook.vocabulary
        return PossibleLetters(
            trace, self._rulebook, vocabulary, lambda _: name, bound=self._letters
        )

    def inexact(self, letters: Letters) -> frozenset[str]:
        """Rules whose possible letters are overestimated in a state with these letters."""
        inexact: frozenset[str] = frozenset()
        begin = 0
        for group, bindings in self._bindings:
            if group.inexact:
                for letter in letters[begin : begin + len(bindings)]:
                    inexact |= group.inexact.get(letter, frozenset())
            begin += len(bindings)
        return inexact

    def _checked(self, state: State, number: int, place: SourceLocation | None) -> PossibleLetters:
        """A reader like that of ``verify``, with all cases and errors."""
        name, rulebook = f"state {number}", self._rulebook
        check_state(state, self.objects, rulebook.vocabulary, name, place)
        state = with_implied_signals(state, rulebook.vocabulary)
        reader = self._state_reader(state, (name, place))
        check_counting_axioms(rulebook, 1, reader.view, name.format, place)
        return reader

    def _careful_letters(self, reader: PossibleLetters) -> Letters:
        """Letters read like ``verify`` does, in the same order, so that it finds the same error."""
        read: list[list[PossibleClasses]] = [[] for _ in self._at]
        for own in self.rules:
            for at, items in enumerate(own.bindings, own.places.start):
                read[at].append(careful_classes(reader, own.prepared, items))
        return [group.letter_read(own) for (group, _), own in zip(self._at, read, strict=True)]

    def _filled(
        self,
        letters: Letters,
        state: State,
        where: tuple[int, SourceLocation | None],
    ) -> Letters:
        """The letters, with missing ones read from the whole state.

        Raises RulecError as ``read`` does.
        """
        has_holes = [
            (place, group, items)
            for place, (letter, (group, items)) in enumerate(zip(letters, self._at, strict=True))
            if letter in group.holes
        ]
        if not has_holes:
            return letters
        if self._of_all is None:
            self._of_all = rules_of_all(self._rulebook, self.objects)
        of_all, number = self._of_all, where[0]

        def read(prepared: PreparedRule, items: Items) -> PossibleClasses:
            try:
                return of_all[prepared, items].classes(state)
            except LookupError:
                # Something is wrong.
                reader = self._state_reader(state, (f"state {number}", where[1]))
                return careful_classes(reader, prepared, items)

        for at, group, items in has_holes:
            letters[at] = group.filled(letters[at], items, read)
        return letters


def _chosen(group: RuleGroup, cast: Cast, awake: Awake) -> tuple[Items, ...]:
    chosen = awake.get(group.types, ())
    CHOICES.within(len(chosen), None, f"rule {named([own.name for own in group.rules])}")
    return tuple(in_usual_order(chosen, cast))
