"""States of the world for the letter classes of one rule's monitor, with the objects it counts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.rulebook.rulebook_model import Axiom, ExampleState, Variable
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.vocabulary_model import default_value
from rulec.witnesses.joint_alphabet import JointAlphabet
from rulec.witnesses.letter_functions import monitor_function
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.relevant_axioms import subjects_read
from rulec.witnesses.trace_synthesis import place_objects


class ClassWitnesses:
    """The plainest state of each class; ``classes`` of letters may be finer than the monitor's.

    Every method, and making one, raises UndecidedError where that is too much to decide.
    """

    def __init__(
        self,
        rule: CompiledRule,
        vocabulary: Vocabulary,
        facts: Iterable[Axiom] = (),
        classes: Sequence[int] = (),
    ) -> None:
        objects = {variable.name: variable.type for variable in rule.variables}
        own = monitor_function(rule.machine, {name: name for name in objects})
        declared = vocabulary.declarations
        # What is read and has no default has to be said, although it is arbitrary.
        self._without_default = {
            subject: default_value(declared[subject[0]])
            for subject in sorted(subjects_read(own.reads))
            if declared[subject[0]].default is None
        }
        self._universe = ObjectUniverse(objects, vocabulary, tuple(facts))
        self._alphabet = JointAlphabet(
            self._universe, [replace(own, letters=tuple(classes or own.letters))]
        )

    def is_read(self, letter_class: int) -> bool:
        """Whether some state has a letter of the class."""
        return self._alphabet.can_be_read((letter_class,))

    def example(
        self, word: Sequence[int]
    ) -> tuple[tuple[Variable, ...], tuple[ExampleState, ...]] | None:
        """Objects besides the rule's own, and states with letters of these classes, if any have."""
        if not all(map(self.is_read, word)):
            return None
        states = self._alphabet.states_of((letter_class,) for letter_class in word)
        objects, values = place_objects(states, self._universe)
        further = tuple(Variable(name, kind) for name, kind in objects.items())
        return further, tuple({**self._without_default, **state} for state in values)
