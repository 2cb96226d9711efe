"""Results of examples and their coverage, as text."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from rulec.book_tests.example_coverage import RuleCoverage, asked_of, percent
from rulec.book_tests.example_runs import (
    ExampleOutcome,
    ExampleRun,
    example_warning,
    is_inherited,
)
from rulec.book_tests.proposed_examples import UncoveredEdge, stated
from rulec.diagnostics import Diagnostic
from rulec.logic.fold import fold_constants
from rulec.logic.formula import Constant
from rulec.logic.printing import formula_text
from rulec.report.findings.diagnostics_text import message_width, render_diagnostics
from rulec.report.text.terminal_text import (
    broken,
    column_lines,
    counted,
    styled,
    visible,
    wants_color,
)
from rulec.vocabulary import Vocabulary
from rulec.witnesses.state_synthesis import value_literal

MOST_MISSING = 5
"""Number of a rule's missing edges shown as text; JSON has all of them."""

MOST_RULES = 30
"""The number of rules shown that miss something, unless all are wanted."""

LONGEST_CONDITION = 200
"""The most characters of a condition that text shows; JSON has all of it."""


@dataclass(frozen=True, slots=True)
class Besides:
    """What there is to say about a run besides its examples.

    ``unread``: rulebook -> why it could not be tested; ``short``: result of ``shortcomings``;
    ``seconds``: how long it took.
    """

    unread: Mapping[str, Sequence[Diagnostic]]
    short: Mapping[str, str]
    seconds: float = 0.0


def as_text(
    runs: Sequence[ExampleRun],
    covered: Sequence[Sequence[RuleCoverage]] | None,
    besides: Besides,
    width: int,
    *,
    in_full: bool,
) -> str:
    """Details of failures, coverage, and the totals; ``in_full`` also a line for each example."""
    outcomes = [(run.name, outcome) for run in runs for outcome in run.outcomes]
    lines = []
    if in_full:
        verdicts = {True: styled("pass", "green"), False: styled("FAIL", "bold red")}
        for name, outcome in outcomes:
            example = visible(f"{name} {outcome.rule.name}/{outcome.name}")
            first, *rest = broken(example, width - len("pass  "), "", "  ")
            lines += [f"{verdicts[outcome.passed]}  {first}", *(f"      {line}" for line in rest)]
    problems = [problem for run in runs for problem in failures(run).values()]
    if problems:
        details = render_diagnostics(
            problems, wants_color(sys.stdout), summary=False, width=message_width(sys.stdout)
        )
        lines += [*([""] if lines else []), details.rstrip("\n"), ""]
    if covered is not None:
        for run, rules in zip(runs, covered, strict=True):
            lines += (_coverage_in_full if in_full else _least_covered)(run, rules, width)
        lines += broken(coverage_in_words(runs, covered), width)
    failed = sum(not outcome.passed for _, outcome in outcomes)
    passed = f": {len(outcomes) - failed:,} passed, {failed:,} failed" if failed else " passed"
    lines.append(f"{counted(len(outcomes), 'example')}{passed} in {besides.seconds:.1f} s")
    return "\n".join(lines)


def _coverage_in_full(run: ExampleRun, rules: Sequence[RuleCoverage], width: int) -> Iterator[str]:
    asked = asked_of(rules, run.patterns)
    for text in coverage_lines(asked, run.rulebook.vocabulary):
        first, *rest = text.split("\n")
        yield from broken(visible(f"{run.name} {first}"), width, later="  ")
        for line in rest:
            yield from broken(visible(line.strip()), width, "  ", "    ")
    if len(asked) < len(rules):
        left_out = counted(len(rules) - len(asked), "inherited rule")
        without = f"{run.name}: without {left_out}; --rule '*' shows them, too"
        yield from broken(visible(without), width, later="  ")


def _least_covered(run: ExampleRun, rules: Sequence[RuleCoverage], width: int) -> Iterator[str]:
    """The rules that examples cover least, a line each, and how many more miss something."""
    asked = asked_of(rules, run.patterns)
    short = sorted((rule for rule in asked if rule.covered < rule.total), key=_part)
    others = len(rules) - len(asked)
    inherited = f", besides {others:,} that it inherits" if others else ""
    whole = len(asked) - len(short)
    counts = f"{run.name}: {whole:,} of {counted(len(asked), 'rule')} covered as a whole{inherited}"
    yield from broken(visible(counts), width, later="  ")
    rows = [(f"{as_percent(_part(rule)):>6}", rule.rule, _missing_parts(rule)) for rule in short]
    yield from column_lines(rows[:MOST_RULES], width, indent="  ")
    more = f"and {len(short) - MOST_RULES:,} more; " if len(short) > MOST_RULES else ""
    if short:
        yield f"  {more}-v says what each misses, with examples to add"


def _part(rule: RuleCoverage) -> float:
    return percent([rule])


def _missing_parts(rule: RuleCoverage) -> str:
    missing = (rule.missing_edges, rule.missing_values, rule.missing_limits)
    parts = zip(map(len, missing), ("edge", "value", "limit"), strict=True)
    return f"misses {', '.join(counted(number, noun) for number, noun in parts if number)}"


def asked_rules(
    runs: Sequence[ExampleRun], covered: Sequence[Sequence[RuleCoverage]]
) -> list[RuleCoverage]:
    """The rules of all runs that their rulebooks have to cover."""
    pairs = zip(runs, covered, strict=True)
    return [rule for run, rules in pairs for rule in asked_of(rules, run.patterns)]


def coverage_in_words(runs: Sequence[ExampleRun], covered: Sequence[Sequence[RuleCoverage]]) -> str:
    """The coverage of a rulebook's own rules, and of all rules if some are inherited."""
    everything = [rule for rules in covered for rule in rules]
    own_rules = asked_rules(runs, covered)
    if len(own_rules) == len(everything):
        return f"coverage {as_percent(percent(own_rules))}"
    with_others = as_percent(percent(everything))
    own = f" {as_percent(percent(own_rules))} of own rules" if own_rules else ": no rule is its own"
    return f"coverage{own}, {with_others} with those that are inherited"


def failures(run: ExampleRun) -> dict[int, Diagnostic]:
    """The diagnostics of a run's failing examples, by index among its outcomes."""
    turned_round = run.turned_round()
    return {
        number: _failure(outcome, run.rulebook.name, turned_round=outcome.rule.name in turned_round)
        for number, outcome in enumerate(run.outcomes)
        if not outcome.passed
    }


def _failure(example_outcome: ExampleOutcome, rulebook: str, *, turned_round: bool) -> Diagnostic:
    """The diagnostic of a failing, perhaps inherited, example.

    ``turned_round``: every example of its rule has the opposite outcome.
    """
    problem = replace(example_warning(example_outcome, rulebook), severity="error")
    rule = example_outcome.rule
    if (
        example_outcome.accepted
        and rule.condition is not None
        and fold_constants(rule.condition) == Constant(False)
    ):
        why = "the rule's condition is false as options are set"
        return replace(problem, help=f"{why}: set them, or leave the example out")
    if turned_round and not is_inherited(example_outcome, rulebook):
        why = f"all examples of rule `{rule.name}` come out the other way"
        way_out = f"{why}: a `not` may be missing or too many, or `accept` and `reject` exchanged"
        return replace(problem, help=way_out)
    return problem


def shortcomings(
    runs: Sequence[ExampleRun],
    covered: Sequence[Sequence[RuleCoverage]] | None,
    threshold: float | None,
    *,
    fail_on_empty: bool,
) -> dict[str, str]:
    """What is below a requirement: ``examples`` or ``coverage`` -> a sentence about it."""
    short = {}
    if fail_on_empty and not any(run.outcomes for run in runs):
        short["examples"] = "there is no example to run"
    if covered is not None and threshold is not None:
        rules = asked_rules(runs, covered)
        part = percent(rules)
        if part < threshold:
            own = " of own rules" if len(rules) < sum(map(len, covered)) else ""
            short["coverage"] = (
                f"coverage{own} is {as_percent(part)}, below the {threshold:g} % asked for"
            )
    return short


def coverage_lines(rules: Sequence[RuleCoverage], vocabulary: Vocabulary) -> Iterator[str]:
    """The lines of each rule's coverage, with missing parts indented below."""
    for rule in rules:
        parts = [
            (rule.n_edges, rule.missing_edges, "edges"),
            (rule.n_values, rule.missing_values, "values of atoms"),
        ]
        parts += [(rule.n_limits, rule.missing_limits, "sides of limits")] if rule.n_limits else []
        shares = ", ".join(f"{n - len(lost):,} of {n:,} {what}" for n, lost, what in parts)
        origin = " (inherited)" if rule.inherited else ""
        lines = [f"{rule.rule}{origin}: {shares} ({as_percent(percent([rule]))})"]
        for atom, value in rule.missing_values:
            text = _shortened(formula_text(atom))
            lines.append(f"`{text}` is never {'true' if value else 'false'}")
        for limit in rule.missing_limits:
            if (limit.comparison, limit.value) not in rule.missing_values:
                how = "true" if limit.value else "false"
                lines.append(f"`{formula_text(limit.comparison)}` is never narrowly {how}")
        missing = missing_examples(rule, vocabulary)
        lines += [
            # A comment is for reading; an example that can be pasted stays whole.
            f"missing: {_shortened(example) if example.startswith('#') else example}"
            for example in missing[:MOST_MISSING]
        ]
        if len(missing) > MOST_MISSING:
            more = len(missing) - MOST_MISSING
            lines.append(f"and {more:,} more; --output-format json has them all")
        yield "\n  ".join(lines)


def _shortened(text: str) -> str:
    return text if len(text) <= LONGEST_CONDITION else text[: LONGEST_CONDITION - 2] + " …"


def as_percent(number: float) -> str:
    """A percentage that is 100 only if nothing is missing."""
    return f"{min(number, 99.9) if number < 100 else 100:.1f} %"


def missing_examples(rule: RuleCoverage, vocabulary: Vocabulary) -> list[str]:
    """Examples that would take each missing edge and come close to each limit, each once."""
    edges = [*rule.missing_edges, *(limit.example for limit in rule.missing_limits)]
    return list(dict.fromkeys(missing_example(edge, vocabulary) for edge in edges))


def missing_example(edge: UncoveredEdge, vocabulary: Vocabulary) -> str:
    """An example that would take an edge, in the rule language.

    Values equal to their defaults are omitted, except numbers. What cannot be written as facts is
    said in words; the whole is a comment then, since without that it has perhaps another verdict.
    """
    states = "; ".join(
        " and ".join(
            value_literal(subject, value, vocabulary.declarations[subject[0]])
            for subject, value in stated(state.says, vocabulary).items()
        )
        or "true"
        for state in edge.states
    )
    besides = "; ".join(
        f"in state {number} {' and '.join(state.besides)}"
        for number, state in enumerate(edge.states)
        if state.besides
    )
    objects = ", ".join(f"{one.name}: {one.type}" for one in edge.objects)
    head = f"{'accept' if edge.accepted else 'reject'}{f' ({objects})' if objects else ''}"
    example = f"{head} {{ {states} }}"
    return f"# {example} where {besides}" if besides else example
