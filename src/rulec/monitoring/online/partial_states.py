"""The letters that partly known states may have, read rule by rule."""

from __future__ import annotations

from collections.abc import Mapping

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import SourceLocation
from rulec.monitoring.bindings import Binding
from rulec.monitoring.online.encoding.state_shape import Items
from rulec.monitoring.online.prepared_rule import PossibleClasses, PreparedRule
from rulec.monitoring.state_view import StateView, value_in
from rulec.monitoring.uncertainty.lazy_bindings import ReadBits
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
    Subject,
    subjects_of_read,
    unknown_in_read,
)
from rulec.trace import State, Trace
from rulec.vocabulary.partial_values import PartialValue

MOST_KNOWN = 1 << 12
"""How many values keep what a rule reads before all are discarded."""


class RulesOfAll:
    """Rules whose letters depend on more than their own objects, for the objects present.

    Their letters are cached by all values in a state that determine them.
    """

    def __init__(self, rulebook: CompiledRulebook, objects: Mapping[str, str]) -> None:
        self._rulebook = rulebook
        self._bound = bound_letters(rulebook, objects, rulebook.vocabulary)
        self._everybody = NothingKnown(objects, rulebook.vocabulary)
        self._rules: dict[tuple[PreparedRule, Items], _RuleOfAll] = {}

    def classes(self, prepared: PreparedRule, items: Items, state: State) -> PossibleClasses | None:
        """As in ``StateReader``; None if that one has to report what is wrong."""
        key = prepared, items
        rule = self._rules.get(key)
        if rule is None:
            rule = self._rules[key] = _RuleOfAll(
                prepared, prepared.bound(items), self._everybody, self._rulebook, self._bound
            )
        return rule.classes(state)


def rules_of_all(rulebook: CompiledRulebook, objects: Mapping[str, str]) -> RulesOfAll:
    """These rules for the given objects, shared by monitors if they are few."""
    if len(objects) > MOST_COUNTED:
        return RulesOfAll(rulebook, objects)
    known: dict[object, RulesOfAll] = rulebook.prepared.setdefault(RulesOfAll, {})
    key = tuple(objects.items())
    if key not in known:
        if len(known) >= MOST_SCENES:
            known.clear()
        known[key] = RulesOfAll(rulebook, objects)
    return known[key]


class _RuleOfAll:
    """One such rule for some objects."""

    def __init__(
        self,
        prepared: PreparedRule,
        objects: Mapping[str, str],
        everybody: NothingKnown,
        rulebook: CompiledRulebook,
        bound: BoundLetters,
    ) -> None:
        self._letters = letters_of_rule(
            prepared.rule,
            prepared.steps.classes,
            objects,
            rulebook,
            everybody=everybody,
            bound=bound,
        )
        self._prepared, self._objects, self._everybody = prepared, objects, everybody
        reads = self._letters.reads
        self._alone = [reads[n] for n in self._letters.independent]
        self._constants = [x for x in reads if not prepared.constants.isdisjoint(x.names)]
        entangled = self._letters.entangled
        self._entangled = entangled.subjects_of(objects) if entangled.numbers else []
        read = [x for own in self._alone for x in subjects_of_read(own.read, objects, everybody)]
        self._subjects: list[Subject] = list(dict.fromkeys([*self._entangled, *read]))
        declarations = everybody.vocabulary.declarations
        self._asked = [(name, items, declarations[name]) for name, items in self._subjects]
        self._known: dict[tuple[PartialValue | None, ...], PossibleClasses] = {}

    def classes(self, state: State) -> PossibleClasses | None:
        """The classes that the rule may read, and whether this is exact."""
        values = tuple([value_in(state, *asked) for asked in self._asked])
        known = self._known.get(values)
        if known is None:
            classes = self._read_classes(state, values)
            if classes is None:
                return None
            if len(self._known) >= MOST_KNOWN:
                self._known.clear()
            known = self._known[values] = classes
        return known

    def _read_classes(
        self, state: State, values: tuple[PartialValue | None, ...]
    ) -> PossibleClasses | None:
        entangled = self._letters.entangled
        view = StateView(state, self._everybody.objects, self._everybody.vocabulary)
        there = None if entangled.is_local else self._everybody.objects
        try:
            digits = tuple([read.in_state(self._objects, view) for read in self._alone])
            about = values[: len(self._entangled)]
            classes, is_exact = self._letters.possible(digits, about, there)
            varies = any(self._has_unknown_constant(own, view) for own in self._constants)
        except MissingValueError:
            return None
        return (classes, is_exact and not varies) if classes else None

    def _has_unknown_constant(self, read: ReadDigits, view: StateView) -> bool:
        digits = read.in_state(self._objects, view)
        if digits & (digits - 1) == 0:
            return False
        unknown = unknown_in_read(read.read, self._objects, view)
        return any(name in self._prepared.constants for name, _ in unknown)


class StateReader:
    """A checked state, read like ``verify`` does.

    ``where`` is what messages call the state, and where it was read. ``bound`` is kept from one
    state to the next while the same objects are present.
    """

    def __init__(
        self,
        state: State,
        rulebook: CompiledRulebook,
        objects: Mapping[str, str],
        where: tuple[str, SourceLocation | None],
        bound: BoundLetters,
    ) -> None:
        name, place = where
        trace = Trace("", 1.0, objects, (state,), place=place)
        self._reader = PossibleLetters(
            trace, rulebook, rulebook.vocabulary, lambda _: name, bound=bound
        )

    def view(self, number: int) -> StateView:
        """The state, which is the only one."""
        return self._reader.view(number)

    def bits_of(self, prepared: PreparedRule) -> ReadBits:
        """A reader of the digits, as bits, of a rule's single reads."""
        return self._reader.bits_of(prepared.rule)

    def classes(self, prepared: PreparedRule, items: Items) -> PossibleClasses:
        """The classes that a rule may read for some objects, and whether each is possible.

        Raises RulecError R0504 if a value without default is missing, R0508 if the state is
        impossible.
        """
        bound = prepared.bound(items)
        word = self._reader.word(prepared.rule, prepared.steps.classes, Binding(bound, 0, 0))
        (classes,) = word.classes
        if not classes:
            raise self._reader.impossible(prepared.rule, bound, 0)
        constants = prepared.constants
        is_constant = bool(constants) and any(constants & names for names in word.unknown)
        return classes, word.exact and not is_constant
