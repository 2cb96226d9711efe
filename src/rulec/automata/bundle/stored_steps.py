"""A compiled rulebook for several steps, none of which needs a compiler."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from rulec.automata.bundle.bundle_messages import OTHER_STEP
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.logic.printing import number_in_words


@dataclass(frozen=True, slots=True)
class StoredSteps:
    """A ``Recompiler`` for some stored steps; ``books`` has the rulebook for each of them."""

    steps: tuple[Fraction, ...]
    books: tuple[CompiledRulebook, ...]

    def __call__(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for one of the steps. Raises RulecError R0507 for any other."""
        if step_s in self.steps:
            return replace(self.books[self.steps.index(step_s)], recompile=self)
        rule = next(rule for rule in self.books[0].rules if rule.step_s is not None)
        wanted = number_in_words(step_s)
        raise OTHER_STEP.error(
            None,
            f"rule `{rule.name}` was compiled for steps of "
            f"{_listed([f'{number_in_words(step)} s' for step in self.steps])}; "
            f"this has steps of {wanted} s",
            help=f"compile its source with `--step {wanted}`, too",
        )

    def judgeable_at(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for one of the steps, whose rules all have automata. Raises R0507."""
        return self(step_s)


def for_steps(books: Sequence[CompiledRulebook], steps: Sequence[Fraction]) -> CompiledRulebook:
    """The rulebook for several steps: ``books`` has one for each; the first provides its own rules.

    Duplicate steps count once.
    """
    own = dict(zip(steps, [replace(book, recompile=None) for book in books], strict=True))
    if len(own) == 1:
        return next(iter(own.values()))
    return replace(books[0], recompile=StoredSteps(tuple(own), tuple(own.values())))


def _listed(steps: Sequence[str]) -> str:
    return f"{', '.join(steps[:-1])} and {steps[-1]}"
