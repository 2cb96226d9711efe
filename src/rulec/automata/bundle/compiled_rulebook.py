"""A compiled rulebook: everything that running it needs, and where it came from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeAlias

from rulec.automata.bundle.bundle_messages import AUTOMATON_TOO_LARGE, OTHER_STEP
from rulec.automata.clocks.clocked_machine import TimedMachine
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.argument_kinds import expected, finite
from rulec.diagnostics.diagnostic import at
from rulec.logic.bounds import longest_divisor
from rulec.logic.formula import Formula
from rulec.logic.printing import number_in_words
from rulec.rulebook import rulebook_model as model
from rulec.value_display import Rows, short_repr
from rulec.vocabulary import Vocabulary

if TYPE_CHECKING:
    from rulec.automata.outcome_machine import OutcomeMachine


@dataclass(frozen=True, slots=True)
class CompiledRule:
    """A rule with its machine.

    ``hoa`` is its automaton in HOA v1, empty until a file is written (``second_compiler``).
    ``step_s`` is the step of the traces that the machine can judge; None for any step, because the
    formula has no bounds in seconds. ``timed`` is the machine for any step, if the rule has one.
    ``trigger`` is the condition under which the rule demands
    anything, None if the formula's form does not show one (``logic.opportunities``); it is derived
    from ``parts``, or from the formula if those are None. ``certificate`` is the digest of the
    table if two compilers made the same one.
    """

    __repr__ = short_repr

    name: str
    strength: model.Strength
    variables: tuple[model.Variable, ...]
    cite: str
    says: str
    formula: Formula
    machine: MealyMonitor
    hoa: str = field(compare=False)
    step_s: Fraction | None = None
    level: str = ""
    weight: Fraction = Fraction(1)
    source: str = ""
    certainty: model.Certainty = ""
    book: str = ""
    trigger: Formula | None = None
    parts: model.RuleParts | None = None
    inherited_from: str = ""
    certificate: str = field(default="", compare=False)
    timed: TimedMachine | None = field(default=None, compare=False)

    def at(self, step_s: Fraction) -> CompiledRule:
        """The rule for traces whose states are so many seconds apart.

        Raises R0507 if it cannot be judged at this step without being compiled again, SizeError.
        """
        if self.step_s in (None, step_s):
            return self
        if self.timed is None:
            check_step(self, step_s)
            return self
        machine = self.timed.at(step_s)
        return replace(self, machine=machine, step_s=step_s, hoa="", certificate="")


@dataclass(frozen=True, slots=True)
class CompiledAxiom:
    """An axiom, which holds in every state, and where it is written."""

    variables: tuple[model.Variable, ...]
    formula: Formula
    place: SourceLocation | None = field(default=None, compare=False)


class TooLargeRule(NamedTuple):
    """A rule whose automaton would be too large for the step of some traces, and the reason."""

    name: str
    strength: model.Strength
    why: str


def too_large_rule(rule: CompiledRule | model.Rule, step_s: Fraction) -> TooLargeRule:
    """A rule that is left out for a step (s)."""
    why = f"its automaton is too large for steps of {number_in_words(step_s)} s"
    return TooLargeRule(rule.name, rule.strength, why)


class Recompiler(Protocol):
    """A compiler of one rulebook for any step (s)."""

    def __call__(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for a step."""

    def judgeable_at(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for a step, without rules that are too large for it."""


Origin: TypeAlias = Callable[[], model.Rulebook]
"""A function that gets the rulebook that another one was compiled from."""


@dataclass(frozen=True, slots=True, eq=False)
class GivenRulebook:
    """The ``Origin`` of what is compiled from a rulebook that is at hand."""

    rulebook: model.Rulebook

    def __call__(self) -> model.Rulebook:
        """The rulebook."""
        return self.rulebook


PrefixCompiler: TypeAlias = "Callable[[CompiledRulebook], Mapping[str, OutcomeMachine | None]]"
"""A function that compiles each rule for prefixes, by name; None where a machine is too large."""


class Prepared(dict[object, Any]):
    """Data that engines prepare from a rulebook's rules; a copy of the rulebook starts empty."""

    def __reduce__(self) -> tuple[type[Prepared], tuple[()]]:
        return Prepared, ()


@dataclass(frozen=True, slots=True)
class CompiledRulebook(Rows):
    """Compiled rules of a rulebook, with the vocabulary of their traces.

    ``rulec`` and ``spot`` are the versions that compiled it. ``origin`` gets the rulebook that it
    was compiled from, None if it was read from a compiled file. ``recompile`` compiles it for other
    steps; None if it is for one step alone. ``prefixes`` provides the
    machines for cut traces; ``prepared`` holds data of the engines. ``too_large`` are the rules
    that were left out for the step of recorded traces.
    """

    __repr__ = short_repr

    name: str
    vocabulary: Vocabulary
    rules: tuple[CompiledRule, ...]
    title: str
    law: str
    as_of: str
    sources: tuple[model.SourceFile, ...]
    rulec: str
    spot: str
    semantics: model.Semantics = "stutter"
    levels: tuple[str, ...] = ()
    priorities: frozenset[tuple[str, str]] = frozenset()
    extends: tuple[str, ...] = ()
    at: str = ""
    axioms: tuple[CompiledAxiom, ...] = ()
    traffic: model.Traffic = ""
    origin: Origin | None = field(default=None, compare=False, repr=False)
    recompile: Recompiler | None = field(default=None, compare=False, repr=False)
    prefixes: PrefixCompiler | None = field(default=None, compare=False, repr=False)
    too_large: tuple[TooLargeRule, ...] = field(default=(), compare=False, repr=False)
    prepared: Prepared = field(init=False, default_factory=Prepared, compare=False, repr=False)

    @property
    def source(self) -> model.Rulebook | None:
        """The rulebook that it was compiled from; None if it was read from a compiled file.

        Read again if the compiled rulebook comes from the cache. Raises RulecError if it is gone.
        """
        if self.origin is None:
            return None
        if self.origin not in self.prepared:
            self.prepared[self.origin] = self.origin()
        found: model.Rulebook = self.prepared[self.origin]
        return found

    def place_of(self, name: str) -> SourceLocation | None:
        """Where a rule is written; None if the rulebook was read from a compiled file."""
        try:
            rules = () if self.source is None else self.source.rules
        except RulecError:
            return None
        return next((at(rule.span) for rule in rules if rule.name == name), None)

    def at_step(self, step_s: Fraction | float) -> CompiledRulebook:
        """These rules for traces whose states are ``step_s`` seconds apart.

        A float stands for its decimal. Rules without bounds in seconds are the same for any step;
        each step is compiled once. Raises RulecError R0507 if the rules are for another step and
        cannot be recompiled, else as ``compile_rulebook``.
        """
        finite("step_s", expected("step_s", "Fraction | float", step_s))
        step = exact_step(step_s)
        if self.recompile is None:
            for rule in self.rules:
                check_step(rule, step)
            return self
        steps: frozenset[Fraction | None] | None = self.prepared.get(CompiledRulebook.at_step)
        if steps is None:
            steps = frozenset([rule.step_s for rule in self.rules])
            self.prepared[CompiledRulebook.at_step] = steps
        if steps <= {None, step}:
            return self
        return self._of_these_rules(self.recompile(step))

    def _of_these_rules(self, book: CompiledRulebook) -> CompiledRulebook:
        """What was compiled for another step, without rules that this rulebook does not have."""
        if len(book.rules) + len(book.too_large) == len(self.rules):
            return book  # keeps the data that engines have prepared
        kept = {rule.name for rule in self.rules}
        return replace(
            book,
            rules=tuple(rule for rule in book.rules if rule.name in kept),
            too_large=tuple(rule for rule in book.too_large if rule.name in kept),
        )

    def at_one_step(self) -> CompiledRulebook:
        """These rules for one step: if they have several, the longest that divides all of them.

        The own rules of an overlay may have another step than those it inherits. Raises as
        ``at_step``.
        """
        steps = [rule.step_s for rule in self.rules if rule.step_s is not None]
        return self.at_step(longest_divisor(steps)) if steps else self

    def fitted_to(self, step_s: Fraction | float) -> CompiledRulebook:
        """The rulebook recompiled for a step (s) if possible, else this one unchanged."""
        return self if self.recompile is None else self.at_step(step_s)

    def judgeable_at(self, step_s: Fraction | float) -> CompiledRulebook:
        """As ``fitted_to``, without the rules that are ``too_large`` for the step."""
        try:
            return self.fitted_to(step_s)
        except RulecError as error:
            if self.recompile is None or not is_too_large(error):
                raise
            return self._of_these_rules(self.recompile.judgeable_at(exact_step(step_s)))

    def rows(self) -> list[dict[str, Any]]:
        """One row per rule."""
        return model.rule_rows(self.rules)


def is_too_large(error: RulecError) -> bool:
    """Whether the only problems are rules whose automata would be too large."""
    return all(problem.code == AUTOMATON_TOO_LARGE.code for problem in error.diagnostics)


_ALIKE = {
    model.Rulebook: (
        "name",
        "title",
        "law",
        "as_of",
        "semantics",
        "levels",
        "extends",
        "at",
        "traffic",
    ),
    model.Rule: (
        *("name", "strength", "cite", "says", "level", "source", "certainty", "book"),
        "inherited_from",
    ),
}
"""Fields with equal names in both models, their compiled forms, and their entries in the file."""


def alike(kind: type[model.Rulebook | model.Rule], source: object) -> dict[str, Any]:
    """The fields that the other forms of a rulebook or rule have in common with it."""
    return {name: getattr(source, name) for name in _ALIKE[kind]}


def check_step(
    rule: CompiledRule, step_s: Fraction, subject: str = "this", place: SourceLocation | None = None
) -> None:
    """Raise R0507 if the step differs from the rule's; ``subject`` is what has that step."""
    if rule.step_s is None or rule.step_s == step_s:
        return
    step = number_in_words(step_s)
    raise OTHER_STEP.error(
        place,
        f"rule `{rule.name}` was compiled for steps of {number_in_words(rule.step_s)} s; "
        f"{subject} has steps of {step} s",
        help=f"compile its source with `--step {step}`",
    )
