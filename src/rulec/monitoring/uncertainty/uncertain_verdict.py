"""Verdicts on traces with unknown values, or cut out of a longer drive.

Per rule and binding: violated if every completion violates the rule, kept if every one satisfies
it, else open (cf. Leucker et al., "Runtime verification for timed event streams with partial
information", 2019). A completion is a choice of all unknown values that satisfies the axioms. For
cut traces see ``rulec.automata.prefix_machines``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.outcome_machine import KEPT, VIOLATED
from rulec.diagnostics import RulecError
from rulec.monitoring.bindings import Binding, Cast, binding_of, types_of
from rulec.monitoring.state_view import StateView
from rulec.monitoring.uncertainty.judged_rules import judged_rules
from rulec.monitoring.uncertainty.lazy_bindings import ReadBits, doubtful_bindings
from rulec.monitoring.uncertainty.state_letters.letter_classes import PossibleWord
from rulec.monitoring.uncertainty.state_letters.possible_letters import PossibleLetters
from rulec.monitoring.uncertainty.suppositions import Suppositions, by_name
from rulec.monitoring.uncertainty.uncertain_machine import (
    Answer,
    UncertainMachine,
    uncertain_machine,
)
from rulec.monitoring.uncertainty.within_tolerance import (
    is_within_bounds,
    told_within_bounds,
)
from rulec.monitoring.verdict import (
    NO_PAST,
    CarriedState,
    OpenReasons,
    OpenVerdict,
    Verdict,
    Violation,
)
from rulec.trace import State, Trace
from rulec.vocabulary import Vocabulary


class UncertainRun:
    """The judgement of one checked trace that is ``spelled_out``, by a rulebook for its step.

    A complete trace may continue a ``past``; what was settled there is not judged again. ``where``
    names a state in messages. Raises RulecError R0403 if the trace is cut and Spot, which builds
    its machines, is not installed.
    """

    def __init__(
        self,
        trace: Trace,
        rulebook: CompiledRulebook,
        past: CarriedState = NO_PAST,
        where: Callable[[int], str] = "state {}".format,
    ) -> None:
        self.trace = trace
        self.rulebook = rulebook
        self.past = past
        self.judged = judged_rules(rulebook, trace.told, cut=trace.ends == "cut")
        self.vocabulary = self.judged.vocabulary
        self._known: dict[tuple[object, ...], Answer] = {}
        self._letters = PossibleLetters(self.trace, rulebook, self.vocabulary, where)
        self._suppositions = Suppositions(trace, rulebook, self.vocabulary, self._letters)

    def verdict(self) -> Verdict:
        """The verdict of all rules.

        Raises RulecError R0504 if a value without default is missing, R0508 if a state contradicts
        an axiom.
        """
        violations: list[Violation] = []
        doubtful: list[OpenVerdict] = []
        unknown: set[str] = set()
        for rule, machine in self.judged.machines:
            if rule.name in self.judged.lacking:
                unknown |= {rule.name} if self.is_doubtful(rule.name) else set()
                continue
            for answer in self._answers(rule, machine):
                if isinstance(answer, Violation):
                    violations.append(answer)
                else:
                    doubtful.append(answer)
        not_judged, regardless = self.judged.unanswered(unknown)
        return Verdict(
            self.trace.id,
            tuple(violations),
            tuple(doubtful),
            not_judged,
            presumed_in(self.trace, self.judged.presumed),
            kept_regardless=regardless,
        )

    def view(self, number: int) -> StateView:
        """A state with the objects that are present."""
        return self._letters.view(number)

    def outcomes(
        self, rule: CompiledRule, binding: Binding, starts: Iterable[int]
    ) -> tuple[int, int]:
        """The best and the worst outcome of a complete trace, from some machine states on."""
        machine = uncertain_machine(rule, None, starts)
        best, worst, _ = machine.answer(self._words(rule, machine, binding)[0])
        return best, worst

    def bits_of(self, rule: CompiledRule) -> ReadBits:
        """A reader of the digits, as bits, that reads of the rule may have."""
        return self._letters.bits_of(rule)

    def _answers(
        self, rule: CompiledRule, machine: UncertainMachine
    ) -> Iterator[Violation | OpenVerdict]:
        trace, bound = self.trace, None
        cast = Cast(trace.objects, self.vocabulary, len(trace.states), trace.present, trace.place)
        if cast.has_many(types_of(rule)):
            read, begun = self._letters.bits_of(rule), self.past.begun(rule.name)
            bound = doubtful_bindings(rule, cast, read, machine.idle, begun)
        for binding in bound or cast.bindings(rule):
            answer = self._answer(rule, machine, binding)
            if answer is not None:
                yield answer

    def is_doubtful(self, rule_name: str) -> bool:
        """Whether a rule that lacks names is not surely kept, or its letters are contradictory."""
        try:
            return any(True for _ in self.answers(rule_name))
        except RulecError:
            return True

    def answers(self, rule_name: str) -> Iterator[Violation | OpenVerdict]:
        """The bindings of a rule that are violated or open."""
        return self._answers(*self._machine(rule_name))

    def answer(self, rule_name: str, objects: Mapping[str, str]) -> Violation | OpenVerdict | None:
        """The violation or open verdict of a rule for these objects; None if it is kept."""
        own = binding_of(objects, self.trace.present, len(self.trace.states))
        return self._answer(*self._machine(rule_name), own)

    def _machine(self, rule_name: str) -> tuple[CompiledRule, UncertainMachine]:
        return next(own for own in self.judged.machines if own[0].name == rule_name)

    def _answer(
        self, rule: CompiledRule, machine: UncertainMachine, binding: Binding
    ) -> Violation | OpenVerdict | None:
        """The violation or open verdict of a binding; None if it is kept."""
        objects, own = binding.objects, machine
        perhaps_settled = False
        if binding.first == 0 and self.past != NO_PAST:
            about = (rule.name, tuple(objects.values()))
            if about in self.past.settled:
                return None
            perhaps_settled = about in self.past.perhaps_settled
            own = uncertain_machine(rule, None, self.past.starts(about))
        words, constants, is_exact = self._words(rule, own, binding)
        # Bindings with equal words share a run.
        key = own, *[word.classes for word in words]
        answer = self._known.get(key) or own.answer(words)
        self._known[key] = answer
        if answer.worst == KEPT:
            return None
        if answer.best == VIOLATED and perhaps_settled:
            return OpenVerdict(rule.name, rule.strength, objects, ("began before",))
        if answer.best == VIOLATED:
            step = None if answer.step is None else binding.first + answer.step
            return Violation(rule.name, rule.strength, objects, step)
        states = self.trace.states[binding.first : binding.last + 1]
        why = partial(_reasons, own, words, constants, (self.vocabulary, states, is_exact))
        return OpenVerdict.explained_later(rule.name, rule.strength, objects, why)

    def _words(
        self, rule: CompiledRule, machine: UncertainMachine, binding: Binding
    ) -> tuple[list[PossibleWord], list[Mapping[str, object]], bool]:
        """The possible words, one for each choice of unknown constants."""
        supposed, is_exact = self._suppositions.of(rule, binding)
        words, constants = [], []
        for values in supposed:
            words.append(self._letters.word(rule, machine.classes, binding, values))
            constants.append(by_name(values))
        # The first state that has no possible letter, if any
        broken = [word.classes.index(0) if 0 in word.classes else None for word in words]
        if None not in broken:
            number = binding.first + (broken[0] or 0)
            raise self._letters.impossible(rule, binding.objects, number)
        possible = [n for n, place in enumerate(broken) if place is None]
        is_exact = is_exact and all(words[n].exact for n in possible)
        return [words[n] for n in possible], [constants[n] for n in possible], is_exact


def presumed_in(trace: Trace, names: Sequence[str]) -> tuple[str, ...]:
    """The names among these that no state contains."""
    return tuple(name for name in names if not any(name in state for state in trace.states))


def _reasons(
    machine: UncertainMachine,
    words: Sequence[PossibleWord],
    constants: Sequence[Mapping[str, object]],
    about: tuple[Vocabulary, Sequence[State], bool],
) -> OpenReasons:
    declared, states, is_exact = about
    reasons = machine.reasons(words, constants, tuple(declared.declarations))
    reasons = reasons._replace(exact=reasons.exact and is_exact)
    return told_within_bounds(reasons, lambda name: is_within_bounds(name, states, declared))
