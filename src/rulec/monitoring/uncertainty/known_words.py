"""The words of rules in states in which everything is known, and the runs of machines on them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.monitoring.bindings import Binding
from rulec.monitoring.state_view import StateView
from rulec.monitoring.uncertainty.state_letters.possible_letters import PossibleLetters
from rulec.monitoring.uncertainty.uncertain_machine import uncertain_machine
from rulec.trace import Trace


class KnownLetters:
    """A reader of the letters of a checked trace without unknown values.

    ``where`` names a state in messages.
    """

    def __init__(
        self,
        trace: Trace,
        rulebook: CompiledRulebook,
        where: Callable[[int], str] = "state {}".format,
    ) -> None:
        self._letters = PossibleLetters(trace, rulebook, rulebook.vocabulary, where)

    def view(self, number: int) -> StateView:
        """A state with the objects that are present."""
        return self._letters.view(number)

    def word(
        self, rule: CompiledRule, objects: Mapping[str, str], first: int, last: int
    ) -> tuple[int, ...]:
        """The letter classes of states ``first`` to ``last`` (inclusive).

        Raises RulecError R0504 if a value without default is missing, R0508 if a state is
        impossible.
        """
        classes = uncertain_machine(rule, None).classes
        possible = self._letters.word(rule, classes, Binding(objects, first, last)).classes
        if 0 in possible:
            raise self._letters.impossible(rule, objects, first + possible.index(0))
        return tuple([own.bit_length() - 1 for own in possible])


def run(machine: MealyMonitor, word: Sequence[int], start: int = 0) -> tuple[bool, int | None]:
    """Run a machine on a non-empty word of letter classes from ``start``.

    Returns whether it accepts, and the index of the letter at which the word is lost, whether it
    continues or ends there; None if it is not lost. From a rejecting sink it is lost at the first
    letter.
    """
    successors, rejecting_sink = machine.successors, machine.rejecting_sink
    state = before = start
    for index, symbol in enumerate(word):
        before, state = state, successors[state][symbol]
        # A word that ends here may be accepted although no longer word is: `weak next false`.
        if state == rejecting_sink and not machine.outputs[before][symbol]:
            return False, index
    return machine.outputs[before][word[-1]], None
