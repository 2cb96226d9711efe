"""The letters that partly known states may have, read rule by rule."""

from __future__ import annotations

from collections.abc import Mapping

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import SourceLocation
from rulec.monitoring.bindings import Binding
from rulec.monitoring.online.encoding.state_shape import Items
from rulec.monitoring.online.four_valued import LetterClass
from rulec.monitoring.online.prepared_rule import PreparedRule
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

    def letter_class(
        self, prepared: PreparedRule, items: Items, state: State
    ) -> tuple[LetterClass, bool] | None:
        """As in ``StateReader``; None if that one has to report what is wrong."""
        key = prepared, items
        rule = self._rules.get(key)
        if rule is None:
            rule = self._rules[key] = _RuleOfAll(
                prepared, prepared.bound(items), self._everybody, self._rulebook, self._bound
            )
        return rule.letter_class(state)


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
        classes = prepared.uncertain.classes
        self._letters = letters_of_rule(
            prepared.rule, classes, objects, rulebook, everybody=everybody, bound=bound
        )
        self._prepared, self._objects, self._everybody = prepared, objects, everybody
        reads = self._letters.reads
        self._alone = [reads[n] for n in self._letters.independent]
        self._constants = [x for x in reads if not prepared.constants.isdisjoint(x.names)]
        entangled = self._letters.entangled
        self._entangled = entangled.subjects_of(objects) if entangled.numbers else []
        read = [x for own in self._alone for x in subjects_of_read(own.read, objects, everybody)]
        self._subjects: list[Subject] = list(dict.fromkeys([*self._entangled, *read]))
        # Most reads depend on a single value.
        self._places = [self._place_of(read) for read in self._alone]
        declarations = everybody.vocabulary.declarations
        self._asked = [(name, items, declarations[name]) for name, items in self._subjects]
        self._known: dict[tuple[PartialValue | None, ...], tuple[LetterClass, bool]] = {}

    def letter_class(self, state: State) -> tuple[LetterClass, bool] | None:
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
    ) -> tuple[LetterClass, bool] | None:
        entangled = self._letters.entangled
        view = StateView(state, self._everybody.objects, self._everybody.vocabulary)
        is_exact = True
        try:
            key = [
                self._digits(read, view) if place is None else read.of_values([values[place]])[0]
                for read, place in zip(self._alone, self._places, strict=True)
            ]
            if 0 in key:
                return None
            if entangled.numbers:
                there = None if entangled.is_local else self._everybody.objects
                number = entangled.number(values[: len(self._entangled)], there)
                is_exact = entangled.joint_letters[number][1]
                key.append(number)
            is_exact = is_exact and not any(
                self._has_unknown_constant(own, view) for own in self._constants
            )
        except MissingValueError:
            return None
        steps = self._prepared.uncertain
        letter_class = steps.letter_class(self._letters.classes_of(tuple(key)))
        return None if letter_class is None else (letter_class, is_exact)

    def _place_of(self, read: ReadDigits) -> int | None:
        if read.subject is None:
            return None
        name, variables = read.subject
        items = tuple([self._objects[variable] for variable in variables])
        return self._subjects.index((name, items))

    def _digits(self, read: ReadDigits, view: StateView) -> int:
        return read.in_state(self._objects, view)

    def _has_unknown_constant(self, read: ReadDigits, view: StateView) -> bool:
        digits = self._digits(read, view)
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

    def letter_class(self, prepared: PreparedRule, items: Items) -> tuple[LetterClass, bool]:
        """The classes that a rule may read for some objects, and whether this is exact.

        Raises RulecError R0504 if a value without default is missing, R0508 if the state is
        impossible.
        """
        bound = prepared.bound(items)
        classes = prepared.uncertain.classes
        word = self._reader.word(prepared.rule, classes, Binding(bound, 0, 0))
        letter_class = prepared.uncertain.letter_class(word.classes[0])
        if letter_class is None:
            raise self._reader.impossible(prepared.rule, bound, 0)
        constants = prepared.constants
        is_constant = bool(constants) and any(constants & names for names in word.unknown)
        return letter_class, word.exact and not is_constant
