"""Run the examples of a rulebook on its monitors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.book_tests.book_test_messages import EXAMPLE_FAILED
from rulec.diagnostics import Diagnostic, Label, RulecError
from rulec.diagnostics.diagnostic import at
from rulec.logic.bounds import has_seconds
from rulec.monitoring.axiom_violations import ImpossibleStateError, check_counting_axioms
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.uncertainty.known_words import KnownLetters, run
from rulec.rulebook.files.edition_names import edition_names
from rulec.rulebook.rulebook_model import Example, Rule, Rulebook
from rulec.rulebook.rules.example_messages import CONTRADICTORY_STATE
from rulec.trace import Trace
from rulec.value_display import Rows, short_repr


@dataclass(frozen=True, slots=True)
class ExampleOutcome:
    """The result of running one example.

    ``number`` counts the examples of its rule from 1. ``word`` has its states as letter classes of
    the rule's machine. ``lost_after`` is the first state, counted from 0, after which every
    continuation violates the rule; None if there is none. ``ends``: the trace ends with the last
    state; otherwise that state is repeated for ever.
    """

    __repr__ = short_repr

    rule: Rule
    example: Example
    number: int
    word: tuple[int, ...]
    accepted: bool
    lost_after: int | None
    ends: bool = False

    @property
    def passed(self) -> bool:
        """Whether the rule's verdict is the one that the example states."""
        return self.accepted == self.example.accepts

    @property
    def name(self) -> str:
        """The example's label, or its number."""
        return self.example.label or str(self.number)


@dataclass(frozen=True, slots=True)
class ExampleRun(Rows):
    """A compiled rulebook with its warnings and the outcomes of its examples.

    ``patterns`` are those that chose the examples; empty if all were run. ``edition`` is the name
    for reports if another rulebook of the same report has this one's; empty if none has.
    ``rule_names`` are all rules of the rulebook, of which patterns may have chosen some.
    """

    __repr__ = short_repr

    rulebook: Rulebook
    compiled: CompiledRulebook
    outcomes: tuple[ExampleOutcome, ...]
    warnings: tuple[Diagnostic, ...] = ()
    patterns: Sequence[str] = ()
    edition: str = ""
    rule_names: Sequence[str] = ()

    @property
    def name(self) -> str:
        """The rulebook's name in reports."""
        return self.edition or self.rulebook.name

    def names(self, rule: Rule) -> bool:
        """Whether the rule itself was requested, rather than some of its examples."""
        return _is_wanted([rule.name], self.patterns)

    def turned_round(self) -> frozenset[str]:
        """The rules that reject all they should accept and accept all they should reject."""
        own: dict[str, list[ExampleOutcome]] = {}
        for outcome in self.outcomes:
            own.setdefault(outcome.rule.name, []).append(outcome)
        return frozenset(
            rule
            for rule, outcomes in own.items()
            if not any(outcome.passed for outcome in outcomes)
            and len({outcome.example.accepts for outcome in outcomes}) > 1
        )

    def rows(self) -> list[dict[str, Any]]:
        """One row per example."""
        return [
            {
                "rule": outcome.rule.name,
                "example": outcome.name,
                "accepts": outcome.example.accepts,
                "accepted": outcome.accepted,
                "passed": outcome.passed,
            }
            for outcome in self.outcomes
        ]


def with_distinct_names(runs: Sequence[ExampleRun], references: Sequence[str]) -> list[ExampleRun]:
    """The runs, those of rulebooks of one name with their ``references`` (names or paths)."""
    names = edition_names([run.rulebook.name for run in runs], references)
    return [replace(run, edition=name) for run, name in zip(runs, names, strict=True)]


def run_rulebook_examples(
    rulebook: Rulebook,
    compiled: CompiledRulebook,
    warnings: tuple[Diagnostic, ...] = (),
    patterns: Sequence[str] = (),
) -> ExampleRun:
    """Run all examples, or those whose ``RULE`` or ``RULE/LABEL`` matches a pattern.

    An example without a label is named by its number. ``compiled`` is the compiled rulebook;
    ``warnings`` are passed on.

    Raises RulecError: R0306 if facts rule out a state of an example.
    """
    outcomes = tuple(
        _outcome(rule, machine, compiled, example, number)
        for rule, machine in zip(rulebook.rules, compiled.rules, strict=True)
        for number, example in enumerate(rule.examples, 1)
        if _is_wanted(_names(rule, example, number), patterns)
    )
    return ExampleRun(rulebook, compiled, outcomes, warnings, patterns)


def is_chosen(rule: Rule, patterns: Sequence[str]) -> bool:
    """Whether a pattern matches a rule or one of its examples, or there is no pattern."""
    numbered = enumerate(rule.examples, 1)
    names = [name for number, example in numbered for name in _names(rule, example, number)]
    return _is_wanted([rule.name, *names], patterns)


def _names(rule: Rule, example: Example, number: int) -> list[str]:
    return [rule.name, f"{rule.name}/{example.label or number}"]


def _is_wanted(names: Sequence[str], patterns: Sequence[str]) -> bool:
    """Whether a pattern matches one of the names, or there is no pattern."""
    return not patterns or any(fnmatchcase(name, pattern) for pattern in patterns for name in names)


def _outcome(
    rule: Rule, machine: CompiledRule, compiled: CompiledRulebook, example: Example, number: int
) -> ExampleOutcome:
    where = "this state".format
    trace = with_derived_values(example_trace(rule, example), compiled.vocabulary, where)
    reader = KnownLetters(trace, compiled, where)
    last = len(trace.states) - 1
    try:
        check_counting_axioms(compiled, last + 1, reader.view, where, trace.place)
        word = reader.word(machine, own_names(rule), 0, last)
    except ImpossibleStateError as error:
        raise _no_state(rule, example, error) from None
    accepted, lost_after = run(machine.machine, word)
    return ExampleOutcome(
        rule,
        example,
        number,
        word,
        accepted=accepted,
        lost_after=lost_after,
        ends=compiled.semantics == "finite",
    )


def word_of(
    rule: Rule, machine: CompiledRule, compiled: CompiledRulebook, example: Example
) -> tuple[int, ...] | None:
    """The states of an example as letter classes; None if one of them cannot be."""
    try:
        return _outcome(rule, machine, compiled, example, 1).word
    except RulecError:
        return None


def _no_state(rule: Rule, example: Example, error: ImpossibleStateError) -> RulecError:
    (diagnostic,) = error.diagnostics
    spans = example.state_spans
    place = spans[error.number].place if spans else at(example.span)
    notes = (*diagnostic.notes[:1], f"in an example of rule `{rule.name}`")
    return RulecError(replace(diagnostic, code=CONTRADICTORY_STATE.code, place=place, notes=notes))


def example_trace(rule: Rule, example: Example) -> Trace:
    """The trace of an example, with the rule's variables and further objects."""
    states = []
    for mentioned in example.states:
        state: dict[str, Any] = {}
        for (name, variables), value in mentioned.items():
            *outer, last = (name, *variables)
            inside = state
            for key in outer:
                inside = inside.setdefault(key, {})
            inside[last] = value
        states.append(state)
    objects = {item.name: item.type for item in (*rule.variables, *example.objects)}
    name, place = example.label or rule.name, at(example.span)
    return Trace(name, float(rule.step_s), objects, tuple(states), place=place)


def own_names(rule: Rule) -> dict[str, str]:
    """The binding of examples: every variable to the object with its name."""
    return {variable.name: variable.name for variable in rule.variables}


def example_warnings(
    rulebook: Rulebook, compiled: Callable[[Sequence[Rule]], CompiledRulebook]
) -> list[Diagnostic]:
    """Warnings about failing examples; ``compiled`` compiles rules for their own steps.

    Raises RulecError.
    """
    # A rule with bounds in seconds but no examples need not fit the step of examples.
    rules = tuple(rule for rule in rulebook.rules if rule.examples or not has_seconds(rule.formula))
    outcomes = run_rulebook_examples(replace(rulebook, rules=rules), compiled(rules)).outcomes
    return [example_warning(outcome, rulebook.name) for outcome in outcomes if not outcome.passed]


def is_inherited(outcome: ExampleOutcome, book: str) -> bool:
    """Whether rule or example are from another book, so that ``book`` should undo its change."""
    own, example = outcome.rule.span, outcome.example.span
    apart = own is not None and example is not None and own.source != example.source
    return outcome.rule.book != book or apart


def example_warning(outcome: ExampleOutcome, book: str) -> Diagnostic:
    """The warning (R0406) about an example that fails in a book."""
    rule, example = outcome.rule, outcome.example
    name = f"`{example.label}`" if example.label else f"number {outcome.number}"
    claim, truth = ("accept", "rejects") if example.accepts else ("reject", "accepts")
    labels: list[Label] = []
    notes = []
    after = outcome.lost_after
    if after is not None:
        notes.append(f"the rule cannot be kept any more after state {after}, counted from 0")
        if example.state_spans:
            place = example.state_spans[after].place
            labels.append(Label(place, "cannot be kept any more after this state"))
    elif not outcome.accepted:
        end = (
            "the example did not end here"
            if outcome.ends
            else "the last state did not go on for ever"
        )
        notes.append(f"the rule could still be kept, if {end}")
    way_out = "correct the example or the formula; `rulec show` puts the formula into words"
    if is_inherited(outcome, book):
        variables = ", ".join(f"{variable.name}: {variable.type}" for variable in rule.variables)
        head = f"{rule.name} ({variables})" if variables else rule.name
        way_out = (
            "the example is inherited: undo what makes the rule another one here, or give it "
            f"examples of this rulebook's own in `override rule {head} {{ … }}`"
        )
    return EXAMPLE_FAILED.at(
        example.span,
        f"example {name} of rule `{rule.name}` says `{claim}`, but the rule {truth} it",
        help=way_out,
        labels=tuple(labels),
        notes=tuple(notes),
        severity="warning",
    )
