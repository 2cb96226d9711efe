"""A rulebook's machines for traces of any step, made when a step is first met."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.compiler import compile_rulebook
from rulec.diagnostics import RulecError
from rulec.logic.bounds import speaks_of_seconds
from rulec.rulebook.model import Rule, Rulebook

MOST_STEPS = 100
"""Machines for so many steps are kept."""


class AnyStep:
    """Call it with a step (s) for the rulebook compiled for traces of that step.

    A bound in seconds is so many steps, so a rule that has one needs a machine for each step; one
    that has none is compiled once.
    """

    def __init__(self, rulebook: Rulebook) -> None:
        self.rulebook = rulebook
        self._machines: dict[tuple[str, Fraction | None], CompiledRule] = {}
        self._answers: dict[Fraction, CompiledRulebook | RulecError] = {}
        self._header: CompiledRulebook | None = None

    def __call__(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for traces whose states are ``step_s`` seconds apart.

        Raises:
            RulecError: as ``compile_rulebook``; R0407 for a bound that is no multiple of the step.
        """
        if step_s not in self._answers:
            if len(self._answers) >= MOST_STEPS:
                self._answers.clear()
                self._machines.clear()
            try:
                self._answers[step_s] = self._compiled(self.rulebook.rules, step_s)
            except RulecError as error:
                self._answers[step_s] = error
        answer = self._answers[step_s]
        if isinstance(answer, RulecError):
            raise answer
        return answer

    def at_own_steps(self, rules: Sequence[Rule] | None = None) -> CompiledRulebook:
        """Rules, or all of them, each for the step of its examples. Raises RulecError."""
        return self._compiled(self.rulebook.rules if rules is None else rules, None)

    def simplest(self) -> CompiledRulebook | AnyStep:
        """The rulebook compiled if the step makes no difference, else this. Raises RulecError."""
        if any(speaks_of_seconds(one.formula) for one in self.rulebook.rules):
            return self
        return self.at_own_steps()

    def _compiled(self, rules: Sequence[Rule], step_s: Fraction | None) -> CompiledRulebook:
        keys = [_key(rule, step_s) for rule in rules]
        machines = self._machines
        missing = [rule for rule, key in zip(rules, keys, strict=True) if key not in machines]
        if missing or self._header is None:
            part = replace(self.rulebook, rules=tuple(missing))
            self._header = compile_rulebook(part, step_s=step_s)
            machines.update({(one.name, one.step_s): one for one in self._header.rules})
        return replace(self._header, rules=tuple(machines[key] for key in keys))


def _key(rule: Rule, step_s: Fraction | None) -> tuple[str, Fraction | None]:
    """A rule's name, and the step that its machine is for."""
    if not speaks_of_seconds(rule.formula):
        return rule.name, None
    return rule.name, rule.step_s if step_s is None else step_s
