"""The letters that partly known states may have, read rule by rule."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.bindings import Binding
from rulec.monitoring.online.encoding.state_shape import Items
from rulec.monitoring.online.prepared_rule import PossibleClasses, PreparedRule
from rulec.monitoring.state_view import StateView, value_in
from rulec.monitoring.uncertainty.state_letters.entangled_reads import MOST_COUNTED, NothingKnown
from rulec.monitoring.uncertainty.state_letters.possible_letters import (
    MOST_SCENES,
    BoundLetters,
    PossibleLetters,
    bound_letters,
    letters_of_rule,
)
from rulec.monitoring.uncertainty.state_letters.read_digits import ReadDigits
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    MissingValueError,
    subjects_of_read,
    unknown_in_read,
)
from rulec.trace import State
from rulec.trace.remembered import Remembered
from rulec.vocabulary.partial_values import PartialValue

MOST_KNOWN = 1 << 12
"""How many values keep what a rule reads before all are discarded."""

RulesOfAll: TypeAlias = Remembered[tuple[PreparedRule, Items], "RuleOfAll"]
"""Rules whose letters depend on more than their own objects, for the objects present."""


def rules_of_all(rulebook: CompiledRulebook, objects: Mapping[str, str]) -> RulesOfAll:
    """These rules for the given objects, shared by monitors if they are few."""

    def rules(objects: tuple[tuple[str, str], ...]) -> RulesOfAll:
        everybody = NothingKnown(dict(objects), rulebook.vocabulary)
        bound = bound_letters(rulebook, everybody.objects, rulebook.vocabulary)
        return Remembered(lambda own: RuleOfAll(*own, everybody, rulebook, bound))

    key = tuple(objects.items())
    if len(objects) > MOST_COUNTED:
        return rules(key)
    known: Remembered[tuple[tuple[str, str], ...], RulesOfAll]
    known = rulebook.prepared.setdefault(RuleOfAll, Remembered(rules, MOST_SCENES))
    return known[key]


class RuleOfAll:
    """A rule whose letters depend on more than its own objects, the ``items``.

    Its letters are cached by all values in a state that determine them.
    """

    def __init__(
        self,
        prepared: PreparedRule,
        items: Items,
        everybody: NothingKnown,
        rulebook: CompiledRulebook,
        bound: BoundLetters,
    ) -> None:
        self._prepared, self._everybody = prepared, everybody
        self._objects = objects = prepared.bound(items)
        classes = prepared.steps.classes
        self._letters = letters_of_rule(
            prepared.rule, classes, objects, rulebook, everybody=everybody, bound=bound
        )
        reads = self._letters.reads
        self._alone = [reads[n] for n in self._letters.independent]
        self._constants = [x for x in reads if not prepared.constants.isdisjoint(x.names)]
        self._entangled = self._letters.entangled.subjects
        read = [x for own in self._alone for x in subjects_of_read(own.read, objects, everybody)]
        self._subjects = list(dict.fromkeys([*self._entangled, *read]))
        declarations = everybody.vocabulary.declarations
        self._asked = [(name, items, declarations[name]) for name, items in self._subjects]
        self._known: dict[tuple[PartialValue | None, ...], PossibleClasses] = {}

    def classes(self, state: State) -> PossibleClasses:
        """As ``careful_classes``, which has to report what is wrong after a LookupError."""
        values = tuple([value_in(state, *asked) for asked in self._asked])
        known = self._known.get(values)
        if known is None:
            if len(self._known) >= MOST_KNOWN:
                self._known.clear()
            known = self._known[values] = self._read_classes(state, values)
        return known

    def _read_classes(
        self, state: State, values: tuple[PartialValue | None, ...]
    ) -> PossibleClasses:
        everybody = self._everybody
        view = StateView(state, everybody.objects, everybody.vocabulary)
        try:
            digits = tuple([read.in_state(self._objects, view) for read in self._alone])
            about = values[: len(self._entangled)]
            classes, is_exact = self._letters.possible(digits, about, everybody.objects)
            varies = any(self._has_unknown_constant(own, view) for own in self._constants)
        except MissingValueError:
            raise LookupError from None
        if not classes:
            raise LookupError
        return classes, is_exact and not varies

    def _has_unknown_constant(self, read: ReadDigits, view: StateView) -> bool:
        digits = read.in_state(self._objects, view)
        if digits & (digits - 1) == 0:
            return False
        unknown = unknown_in_read(read.read, self._objects, view)
        return any(name in self._prepared.constants for name, _ in unknown)


def careful_classes(
    reader: PossibleLetters, prepared: PreparedRule, items: Items
) -> PossibleClasses:
    """The classes that a rule may read for some objects in the only state, read like ``verify``.

    Raises RulecError R0504 if a value without default is missing, R0508 if the state is impossible.
    """
    bound = prepared.bound(items)
    word = reader.word(prepared.rule, prepared.steps.classes, Binding(bound, 0, 0))
    (classes,) = word.classes
    if not classes:
        raise reader.impossible(prepared.rule, bound, 0)
    constants = prepared.constants
    is_constant = bool(constants) and any(constants & names for names in word.unknown)
    return classes, word.exact and not is_constant
