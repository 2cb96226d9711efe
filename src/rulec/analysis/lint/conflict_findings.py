"""Findings about hard rules that cannot all be kept."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set

from rulec.analysis.lint.conflict_search import Conflict
from rulec.analysis.lint.finding_messages import CONFLICTING_RULES, undecided_diagnostic
from rulec.analysis.lint.questions import Question, RuleAnswers
from rulec.analysis.lint.redundancy import small_premises
from rulec.analysis.lint.related_rules import RelatedRules
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.analysis.trace_display import trace_note
from rulec.diagnostics import Diagnostic, Label
from rulec.diagnostics.diagnostic import at
from rulec.rulebook.rulebook_model import Rule
from rulec.witnesses.undecided import UndecidedError


def conflict_questions(
    names: Sequence[str], sides: Mapping[str, AnalyzedRule], related: RelatedRules
) -> Iterator[Question]:
    """What ``conflicts`` asks where there is none."""
    chosen = frozenset(names)
    for pair in related.pairs():
        if chosen.issuperset(pair):
            yield Question("conflict", pair)
    for name in names:
        group = _group(name, chosen, sides, related)
        if len(group) > 2:
            yield Question("conflict", group)


def conflicts(
    names: Sequence[str],
    sides: Mapping[str, AnalyzedRule],
    rules: Mapping[str, Rule],
    answers: RuleAnswers,
    related: RelatedRules,
) -> Iterator[Diagnostic]:
    """Pairs of hard rules in conflict, then groups without such a pair."""
    conflicting: list[frozenset[str]] = []
    hard = frozenset(names)
    for first, second in related.pairs():
        if not {first, second} <= hard:
            continue
        try:
            clash = answers.conflict([first, second])
        except UndecidedError as problem:
            what = f"it can always be kept together with `{first}`"
            yield undecided_diagnostic(rules[second], what, problem)
            continue
        if clash is not None:
            conflicting.append(frozenset((first, second)))
            yield _cannot_be_kept((first, second), clash, sides, rules)
    for name in names:
        group = _group(name, hard, sides, related)
        if any(pair <= set(group) for pair in conflicting):
            continue
        clash = _clash(group, answers)
        if clash is not None:
            smaller = _smallest(group, answers)
            chosen = tuple(other for other in names if other in smaller)
            conflicting.append(frozenset(chosen))
            yield _cannot_be_kept(chosen, _clash(smaller, answers) or clash, sides, rules)


def _group(
    name: str, names: Set[str], sides: Mapping[str, AnalyzedRule], related: RelatedRules
) -> tuple[str, ...]:
    """A rule with others that speak of the same, as long as all stay small together."""
    premises = [sides[premise] for premise in related.of(name) if premise in names]
    return (name, *(one.rule.name for one in small_premises(sides[name], premises)))


def _clash(group: Sequence[str], answers: RuleAnswers) -> Conflict | None:
    """A conflict within a group of three or more; None if undecided."""
    if len(group) < 3:
        return None
    try:
        return answers.conflict(group)
    except UndecidedError:
        return None


def _smallest(group: Sequence[str], answers: RuleAnswers) -> Sequence[str]:
    """The group without those that its conflict does not need."""
    for name in group:
        fewer = [kept for kept in group if kept != name]
        if _clash(fewer, answers) is not None:
            return _smallest(fewer, answers)
    return group


def _cannot_be_kept(
    names: Sequence[str],
    clash: Conflict,
    sides: Mapping[str, AnalyzedRule],
    rules: Mapping[str, Rule],
) -> Diagnostic:
    *firsts, last = names
    whole = [sides[name] for name in names]
    when = "at all" if clash.trace is None else "any more"
    notes = () if clash.trace is None else trace_note("after the trace", clash.trace, whole)
    both = "both" if len(names) == 2 else "all"
    return CONFLICTING_RULES.at(
        rules[last].span,
        f"rules {', '.join(f'`{name}`' for name in firsts)} and `{last}` cannot {both} be kept "
        f"{when}, though each alone could",
        help="except from one of them what another one asks for, or make it soft",
        labels=tuple(
            Label(place, f"`{name}` is here")
            for name in firsts
            if (place := at(rules[name].span)) is not None
        ),
        notes=notes,
    )
