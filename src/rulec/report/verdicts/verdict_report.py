"""Verdicts on traces as text.

The outcomes of an open verdict that differ only in one name, and cover all of its values, are
merged into one without that name (prime implicants as in Quine and McCluskey, for more than two
values). From the results enough are taken to cover all cases, those that cover most first.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence, Set
from typing import get_args

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook, TooLargeRule
from rulec.logic.printing import number_in_words
from rulec.monitoring.rulebook_edition import edition_of
from rulec.monitoring.verdict import (
    ConditionalOutcome,
    OpenVerdict,
    OutcomeName,
    Verdict,
    VerdictOutcome,
    Violation,
)
from rulec.report.text.console import PAGE_WIDTH
from rulec.report.text.terminal_text import broken, counted, styled, visible
from rulec.report.verdicts.state_times import NUMBERS_ALONE, StateTimes
from rulec.rulebook.rulebook_model import cited_law

MOST_CASES = 4
"""Number of cases shown for an open verdict."""

MOST_VIOLATIONS = 20
"""Number of violations shown per trace; JSON has all of them."""


def as_text(
    verdict: Verdict,
    rulebook: CompiledRulebook,
    explained: Sequence[str] = (),
    *,
    width: int = PAGE_WIDTH,
    doubts: bool = True,
    whom: Sequence[Sequence[str]] = (),
    times: StateTimes = NUMBERS_ALONE,
) -> str:
    """Write a trace's violations line by line below its name; with ``doubts`` also what is open.

    ``explained`` are texts that explain the first violations; each follows its line. ``whom`` names
    for the first violations who caused them, where their rules name no objects. ``times`` are the
    times of the states.
    """
    doubtful = [*_open_lines(verdict, rulebook), *_not_judged_lines(verdict)] if doubts else []
    doubtful = [line for text in doubtful for line in _wrapped(text, width)]
    if not verdict.violations and not doubtful:
        return f"{visible(verdict.trace)}: {styled('satisfied', 'green')}"
    word, style = _WORDS[verdict.outcome]
    word = styled(word, style)
    rules = {rule.name: rule for rule in rulebook.rules}
    lines = [f"{visible(verdict.trace)}: {word}"]
    shown = verdict.violations[:MOST_VIOLATIONS]
    for number, violation in enumerate(shown):
        line = in_a_line(violation, rules[violation.rule], rulebook.name, times)
        because = ", ".join(whom[number]) if number < len(whom) else ""
        lines += _wrapped(f"{line}, because of {because}" if because else line, width)
        if number < len(explained):
            lines.append(explained[number])
    if len(verdict.violations) > len(shown):
        text = f"and {len(verdict.violations) - len(shown):,} more; --json has them all"
        lines += _wrapped(text, width)
    return "\n".join([*lines, *doubtful])


_WORDS: Mapping[VerdictOutcome, tuple[str, str]] = {
    "satisfied": ("satisfied, but for soft rules", "yellow"),
    "violated": ("violated", "red"),
    "only soft rules": ("violated, but only soft rules", "yellow"),
    "open": ("open", "yellow"),
    "nothing found": ("nothing found in the judged rules", "yellow"),
}


def _wrapped(text: str, width: int) -> list[str]:
    """A line below a trace's name, wrapped."""
    return broken(visible(text), width, "  ", "      ")


OUTCOMES: Sequence[VerdictOutcome] = get_args(VerdictOutcome)
"""The outcomes in the order in which they are listed."""


def rule_counts(
    rules: Sequence[CompiledRule | TooLargeRule],
    judged: Set[str],
    open_in: Container[str],
    source: str,
) -> str:
    """How many rules have a verdict in some drive, are open at best, or cannot be judged."""
    all_open = sum(rule.name in open_in and rule.name not in judged for rule in rules)
    some_open = sum(rule.name in open_in and rule.name in judged for rule in rules)
    n_judged = sum(rule.name in judged for rule in rules)
    parts = [f"{n_judged:,} judged"]
    parts += [f"{some_open:,} of them open in some drive"] if some_open else []
    parts += [f"{all_open:,} open"] if all_open else []
    if never := len(rules) - n_judged - all_open:
        parts.append(f"{never:,} cannot be judged from {source}")
    return f"{counted(len(rules), 'rule')}: {', '.join(parts)}"


def headline(rules: CompiledRulebook, width: int = PAGE_WIDTH) -> str:
    """The rulebook, its law and the day of its text, and which text it is."""
    edition = edition_of(rules)
    law = f": {edition.law}" if edition.law else ""
    if edition.as_of:
        law += f" as of {edition.as_of}"
        if edition.at > edition.as_of:
            law += f", without what has changed until {edition.at}"
        elif edition.at and edition.at != edition.as_of:
            law += f", as in force on {edition.at}"
    text = visible(f"by {edition.rulebook}{law} [{edition.rulebook_hash[:8]}]")
    return "\n".join(broken(text, width, later="  "))


def _open_lines(verdict: Verdict, rulebook: CompiledRulebook) -> Iterator[str]:
    rules = {rule.name: rule for rule in rulebook.rules}
    for result in verdict.open[:MOST_VIOLATIONS]:
        rule = rules[result.rule]
        title = f"{rule.strength} rule {_title(rule, rulebook.name)}{about(result.binding)}"
        yield f"{title}: {open_in_words(result)}"
    if len(verdict.open) > MOST_VIOLATIONS:
        yield f"and {len(verdict.open) - MOST_VIOLATIONS:,} more open; --json has them all"


def open_in_words(result: OpenVerdict, most: int = MOST_CASES) -> str:
    """Why a verdict is open, and its outcome in up to ``most`` cases of what it depends on."""
    parts = []
    if result.depends_on:
        parts.append(f"depends on {', '.join(result.depends_on)}")
    if "tolerance" in result.because:
        parts.append("a limit is within the tolerance of what was measured")
    if "began before" in result.because:
        parts.append("depends on what was before the first state")
    if "not over" in result.because:
        parts.append("not over when the trace is cut" if not parts else "not over")
    fewest = fewest_cases(result.outcomes)
    cases = [f"{case.outcome} if {_conditions(case.when)}" for case in fewest[:most]]
    if len(fewest) > most:
        cases.append(f"and {len(fewest) - most} more; --json has them all")
    text = f"open, {'; '.join(parts)}"
    return f"{text}: {', '.join(cases)}" if cases else text


def _conditions(when: Mapping[str, bool | str]) -> str:
    """The conditions for all states; without any, all constant values have the same outcome."""
    return " and ".join([_condition(*pair) for pair in when.items()]) or "none of them changes"


def _condition(name: str, value: bool | str) -> str:
    if isinstance(value, bool):
        return name if value else f"not {name}"
    return f"{name} {value}" if value[0] in "<>" else f"{name} = {value}"


def _not_judged_lines(verdict: Verdict) -> Iterator[str]:
    by_reason: dict[str, list[str]] = {}
    for rule in verdict.not_judged:
        why = rule.why or f"the source does not tell {', '.join(rule.untold)}"
        by_reason.setdefault(why, []).append(rule.rule)
    for why, rules in by_reason.items():
        yield f"not judged: {', '.join(rules)} ({why})"


def about(binding: Mapping[str, str]) -> str:
    """The variables of a rule with their objects, such as `` for v = car``; empty without any."""
    where = ", ".join(f"{name} = {item}" for name, item in binding.items())
    return f" for {where}" if where else ""


def in_a_line(
    violation: Violation,
    rule: CompiledRule,
    rulebook: str,
    times: StateTimes = NUMBERS_ALONE,
) -> str:
    """The violated rule of ``rulebook``, its binding, and when it was violated."""
    when = (
        "not fulfilled when the trace ends"
        if violation.step is None
        else f"cannot be kept any more after state {violation.step}{times.of(violation.step)}"
    )
    return f"{rule.strength} rule {_title(rule, rulebook)}{about(violation.binding)}: {when}"


def short_title(rule: CompiledRule) -> str:
    """The rule's name and provision, with its book if inherited and not confirmed."""
    law = " ".join(filter(None, (rule.inherited_from, rule.cite)))
    return f"{rule.name} [{law}]" if law else rule.name


def _title(rule: CompiledRule, rulebook: str) -> str:
    """The rule's name with level and weight unless default, and its provision."""
    title, place = rule.name, rule.cite
    if rule.level:
        title += f" in {rule.level}"
    if rule.strength == "soft" and rule.weight != 1:
        title += f" weight {number_in_words(rule.weight)}"
    if rule.inherited_from:
        place = cited_law(rule.cite, rule.inherited_from)
    elif rule.book and rule.book != rulebook:
        place = f"{rule.book}, {place}" if place else rule.book
    return f"{title} [{place}]" if place else title


def summary(outcomes: Mapping[VerdictOutcome, int], not_judged: int, noun: str = "trace") -> str:
    """The summary line of a run: the numbers of traces or drives by outcome."""
    total = sum(outcomes.values()) + not_judged
    if total == not_judged == 1:
        # Also for a file that holds none
        return f"no {noun} could be judged"
    # Where some rule cannot be judged, nothing is satisfied, and it need not be said
    some_unjudged = outcomes.get("nothing found") or outcomes.get("only soft rules")
    always = {"violated"} if some_unjudged else {"satisfied", "violated"}
    parts = [
        f"{outcomes.get(outcome, 0):,} {outcome}"
        for outcome in OUTCOMES
        if outcomes.get(outcome) or outcome in always
    ]
    parts += [f"{not_judged:,} not judged"] if not_judged else []
    return f"{counted(total, noun)}: {', '.join(parts)}"


Case = frozenset[tuple[str, bool | str]]


def fewest_cases(outcomes: Sequence[ConditionalOutcome]) -> list[ConditionalOutcome]:
    """Few cases that cover the given ones with their outcomes; violations come first."""
    by_outcome: dict[OutcomeName, list[Case]] = {}
    for outcome in outcomes:
        by_outcome.setdefault(outcome.outcome, []).append(frozenset(outcome.when.items()))
    order = sorted(by_outcome, key=lambda name: name != "violated")
    names = {name: place for place, name in enumerate(outcomes[0].when)} if outcomes else {}
    values = {name: {outcome_.when[name] for outcome_ in outcomes} for name in names}
    return [
        ConditionalOutcome(dict(sorted(case, key=lambda pair: names[pair[0]])), name)
        for name in order
        for case in _cover(by_outcome[name], values)
    ]


def _cover(cases: Sequence[Case], values: Mapping[str, Set[bool | str]]) -> list[Case]:
    primes, left, chosen = _primes(set(cases), values), set(cases), []
    while left:
        best = max(primes, key=lambda prime: (len(_within(prime, left)), -len(prime)))
        chosen.append(best)
        left -= _within(best, left)
    return chosen


def _within(prime: Case, cases: Set[Case]) -> set[Case]:
    return {case for case in cases if prime <= case}


def _primes(cases: Set[Case], values: Mapping[str, Set[bool | str]]) -> list[Case]:
    """The merged cases with the fewest conditions, in a reproducible order."""
    primes: set[Case] = set()
    while cases:
        merged: set[Case] = set()
        used: set[Case] = set()
        for case in cases:
            for name, value in case:
                without = case - {(name, value)}
                alike = {without | {(name, other)} for other in values[name]}
                if alike <= cases:
                    merged.add(without)
                    used |= alike
        primes |= cases - used
        cases = merged
    return sorted(primes, key=lambda case: sorted((name, str(value)) for name, value in case))
