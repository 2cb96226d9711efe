"""Letters that partly known states may have, read by the rules one by one."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import SourceLocation
from rulec.monitoring.bindings import Binding
from rulec.monitoring.online.encoding.state_shape import Items
from rulec.monitoring.online.four_valued import LetterClass
from rulec.monitoring.online.prepared_rule import PreparedRule
from rulec.monitoring.uncertainty.lazy_bindings import ReadBits
from rulec.monitoring.uncertainty.state_letters.possible_letters import (
    BoundLetters,
    PossibleLetters,
)
from rulec.trace import State, Trace


class PartialStateReader:
    """A checked state, read as ``verify`` does.

    ``where`` are what messages call the state, and where it was read. ``bound`` is kept from
    one state to the next while the same objects are there.
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

    def bits_of(self, prepared: PreparedRule) -> ReadBits:
        """A reader of the digits, as bits, of a rule's reads one by one."""
        return self._reader.bits_of(prepared.rule)

    def reader(self, items: Items) -> Callable[[PreparedRule], tuple[LetterClass, bool]]:
        """``letter_class`` of some objects."""
        return lambda prepared: self.letter_class(prepared, items)

    def letter_class(self, prepared: PreparedRule, items: Items) -> tuple[LetterClass, bool]:
        """The classes that a rule may read of objects, and whether no more are said than are.

        Raises RulecError R0504 if a value without default is missing, R0508 if the state cannot be.
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
