"""A compiled rulebook for any step, by the clocks of its rules: no compiler is needed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction

from rulec.automata.bundle.bundle_messages import AUTOMATON_TOO_LARGE
from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook, too_large_rule
from rulec.automata.bundle.cut_machines import StoredPrefixes
from rulec.automata.tables import SizeError
from rulec.diagnostics import RulecError

MOST_STEPS = 100
"""Results are kept for so many steps before all are discarded."""


@dataclass(frozen=True, slots=True, eq=False)
class AnyStep:
    """A ``Recompiler`` of a rulebook that was compiled for one step."""

    book: CompiledRulebook
    _known: dict[Fraction, CompiledRulebook] = field(default_factory=dict, repr=False)

    def __call__(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for a step.

        Raises RulecError R0401 for rules that are too large for it, R0507 for those without clocks.
        """
        book = self.judgeable_at(step_s)
        if book.too_large:
            raise RulecError(
                [
                    AUTOMATON_TOO_LARGE.at(
                        None,
                        f"rule `{left_out.name}` cannot be judged: {left_out.why}",
                        help="longer steps mean fewer states; for a recording, every fifth state "
                        "may be enough",
                    )
                    for left_out in book.too_large
                ]
            )
        return book

    def judgeable_at(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for a step, without rules too large for it. Raises R0507."""
        if step_s not in self._known:
            if len(self._known) >= MOST_STEPS:
                self._known.clear()
            self._known[step_s] = self._at(step_s)
        return self._known[step_s]

    def _at(self, step_s: Fraction) -> CompiledRulebook:
        found = [(rule, _if_small(rule, step_s)) for rule in self.book.rules]
        rules = [small for _, small in found if small is not None]
        left_out = [too_large_rule(rule, step_s) for rule, small in found if small is None]
        own = {id(rule) for rule in self.book.rules}
        prefixes = self.book.prefixes
        if isinstance(prefixes, StoredPrefixes):
            prefixes = prefixes.at_other_steps([rule for rule in rules if id(rule) not in own])
        return replace(
            self.book,
            rules=tuple(rules),
            recompile=self,
            prefixes=prefixes,
            too_large=tuple(left_out),
        )


def _if_small(rule: CompiledRule, step_s: Fraction) -> CompiledRule | None:
    try:
        return rule.at(step_s)
    except SizeError:
        return None
