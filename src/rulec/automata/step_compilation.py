"""Compilation of a rulebook for any step, on first use."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from rulec.automata.bundle.compiled_rulebook import (
    CompiledRule,
    CompiledRulebook,
    is_too_large,
    too_large_rule,
)
from rulec.automata.compiler import RulebookFormulas, build_all, lower
from rulec.automata.prefix_machines import prefix_machines
from rulec.automata.tables import SizeError
from rulec.diagnostics import RulecError
from rulec.logic.bounds import has_seconds
from rulec.logic.formula import Formula
from rulec.resource_limits import STEPS, CompilerTime
from rulec.rulebook.rulebook_model import Rule, Rulebook

if TYPE_CHECKING:
    from rulec.automata.outcome_machine import OutcomeMachine

MOST_STEPS = 100
"""Results are kept for this many steps. Machines are all kept: the limit ``steps`` bounds them."""


class StepCompiler:
    """The compiler of a rulebook: call it with a step (s).

    A rule is compiled once: its clocks make its machine for any step. Only a rule with bounds in
    seconds that no clocks tell is compiled for each step. Pickling keeps only the rulebook.
    """

    def __init__(self, rulebook: Rulebook, time: CompilerTime | None = None) -> None:
        self.rulebook = rulebook
        self._machines: dict[tuple[str, Formula], CompiledRule] = {}
        self._timed: dict[str, CompiledRule] = {}
        self._answers: dict[Fraction, CompiledRulebook | RulecError] = {}
        self._header: CompiledRulebook | None = None
        self._judgeable: dict[Fraction, CompiledRulebook] = {}
        self._built = 0
        self.time = time or CompilerTime()

    def __reduce__(self) -> tuple[Callable[[Rulebook], StepCompiler], tuple[Rulebook]]:
        return StepCompiler, (self.rulebook,)

    def __call__(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for traces whose states are ``step_s`` seconds apart.

        Raises RulecError: as ``build_automata``; R0718 for more steps than the limit `steps`.
        """
        if step_s not in self._answers:
            if len(self._answers) >= MOST_STEPS:
                self._answers.clear()
            try:
                self._answers[step_s] = self._compiled(self.rulebook.rules, step_s)
            except RulecError as error:
                self._answers[step_s] = error
        answer = self._answers[step_s]
        if isinstance(answer, RulecError):
            raise answer
        return answer

    def judgeable_at(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for a step (s), without rules too large for that step.

        Raises RulecError as calling it for any other problem.
        """
        if step_s not in self._judgeable:
            self._judgeable[step_s] = self._without_too_large(step_s)
        return self._judgeable[step_s]

    def _without_too_large(self, step_s: Fraction) -> CompiledRulebook:
        try:
            return self(step_s)
        except RulecError as error:
            places = [problem.place for problem in error.diagnostics]
            spans = [(rule, rule.span) for rule in self.rulebook.rules]
            rules = [rule for rule, span in spans if span is not None and span.place in places]
            if not (is_too_large(error) and rules):
                raise
            kept = tuple(rule for rule in self.rulebook.rules if rule not in rules)
            left_out = [too_large_rule(rule, step_s) for rule in rules]
            smaller = StepCompiler(replace(self.rulebook, rules=kept), self.time)
            book = smaller.judgeable_at(step_s)
            return replace(book, too_large=(*left_out, *book.too_large))

    def at_own_steps(self, rules: Sequence[Rule] | None = None) -> CompiledRulebook:
        """Compile rules (all by default) for the steps of their own examples. Raises RulecError."""
        return self._compiled(self.rulebook.rules if rules is None else rules, None)

    def built(self, formulas: RulebookFormulas) -> CompiledRulebook:
        """The rulebook with the automata of these formulas. Raises RulecError as ``build_all``."""
        machines = self._machines
        fresh = [rule for rule in formulas.rules if rule.key not in machines]
        if fresh and self._header is not None:
            _check_steps(self._built, self.rulebook)
            self._built += 1
        for rule in fresh:
            timed = self._timed.get(rule.rule.name)
            if timed is not None and rule.step_s is not None:
                # If it is too large, a compiler may know a smaller way.
                with suppress(SizeError):
                    machines[rule.key] = timed.at(rule.step_s)
        missing = tuple([rule for rule in fresh if rule.key not in machines])
        if missing or self._header is None:
            # A caller that needs a second step will probably need more.
            more_will_come = self._header is not None
            lacking = replace(formulas, rules=missing)
            built = build_all(self.rulebook, lacking, more_will_come=more_will_come, time=self.time)
            self._header = replace(built, recompile=self, prefixes=self._prefixes)
            machines.update(zip([rule.key for rule in missing], built.rules, strict=True))
            self._timed.update({rule.name: rule for rule in built.rules if rule.timed is not None})
        # Steps that hardly differ, such as those of an unsteady clock, have the same formulas.
        rules = [replace(machines[rule.key], step_s=rule.step_s) for rule in formulas.rules]
        return replace(self._header, rules=tuple(rules))

    def _prefixes(self, rulebook: CompiledRulebook) -> Mapping[str, OutcomeMachine | None]:
        return prefix_machines(rulebook, self.time)

    def _compiled(self, rules: Sequence[Rule], step_s: Fraction | None) -> CompiledRulebook:
        return self.built(lower(replace(self.rulebook, rules=tuple(rules)), step_s))


def _check_steps(before: int, rulebook: Rulebook) -> None:
    """Raise RulecError R0718 if one more step exceeds the limit."""
    places = (rule.span.place for rule in rulebook.rules if rule.span and has_seconds(rule.formula))
    STEPS.within(before + 1, next(places, None), f"rulebook `{rulebook.name}`")


def build_automata(formulas: RulebookFormulas, steps: StepCompiler) -> CompiledRulebook:
    """Build the automaton of every formula.

    For formulas of one requested step the result is for that step only; otherwise it recompiles
    itself for any step that it meets. Raises RulecError as ``build_all``.
    """
    compiled = steps.built(formulas)
    return compiled if formulas.step_s is None else replace(compiled, recompile=None)
