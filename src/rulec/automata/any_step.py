"""A rulebook's machines for traces of any step, made when a step is first met."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction

from rulec.automata.compiled import CompiledRule, CompiledRulebook
from rulec.automata.compiler import compile_rulebook
from rulec.diagnostics import RulecError
from rulec.logic.timing import speaks_of_seconds
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
                self._answers[step_s] = self._compiled((one, step_s) for one in self.rulebook.rules)
            except RulecError as error:
                self._answers[step_s] = error
        answer = self._answers[step_s]
        if isinstance(answer, RulecError):
            raise answer
        return answer

    def at_own_steps(self, rules: Iterable[Rule] | None = None) -> CompiledRulebook:
        """Rules, or all of them, each for the step of its examples. Raises RulecError."""
        chosen = self.rulebook.rules if rules is None else rules
        return self._compiled((one, one.step_s) for one in chosen)

    def depends(self) -> bool:
        """Does the step make a difference?"""
        return any(speaks_of_seconds(one.formula) for one in self.rulebook.rules)

    def _compiled(self, wanted: Iterable[tuple[Rule, Fraction]]) -> CompiledRulebook:
        steps = [(rule, step if speaks_of_seconds(rule.formula) else None) for rule, step in wanted]
        missing: dict[Fraction | None, list[Rule]] = {}
        for rule, step in steps:
            if (rule.name, step) not in self._machines:
                missing.setdefault(step, []).append(rule)
        # What no step changes is compiled along with something else, by one start of Spot.
        if len(missing) > 1 and None in missing:
            anytime = missing.pop(None)
            missing[next(iter(missing))] += anytime
        if not missing and self._header is None:
            missing[None] = []
        for step, rules in missing.items():
            part = replace(self.rulebook, rules=tuple(rules))
            self._header = compile_rulebook(part, step_s=step)
            self._machines.update({(one.name, one.step_s): one for one in self._header.rules})
        assert self._header is not None
        machines = tuple(self._machines[rule.name, step] for rule, step in steps)
        return replace(self._header, rules=machines)
