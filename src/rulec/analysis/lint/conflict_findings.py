"""Findings about hard rules that cannot all be kept."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set

from rulec.analysis.lint.conflict_search import Conflict
from rulec.analysis.lint.finding_messages import (
    CONFLICTING_RULES,
    CONTRADICTING_RULES,
    undecided_diagnostic,
)
from rulec.analysis.lint.questions import RuleAnswers
from rulec.analysis.lint.redundancy import small_premises
from rulec.analysis.lint.related_rules import RelatedRules
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.analysis.trace_display import trace_note
from rulec.diagnostics import Diagnostic, Label, named
from rulec.diagnostics.diagnostic import at
from rulec.logic.printing import formula_text
from rulec.rulebook.rulebook_model import Rule
from rulec.rulebook.rules.antecedents import Antecedent
from rulec.witnesses.undecided import UndecidedError

Occurring = Mapping[str, Sequence[tuple[Antecedent, str]]]
"""The antecedents of each rule, with the names of the rules that state that they occur."""


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
            question = f"it can always be kept together with `{first}`"
            yield undecided_diagnostic(rules[second], question, problem)
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
    """A rule and related rules whose product stays small."""
    premises = [sides[premise] for premise in related.of(name) if premise in names]
    return (name, *(rule.rule.name for rule in small_premises(sides[name], premises)))


def _clash(group: Sequence[str], answers: RuleAnswers) -> Conflict | None:
    """A conflict within a group of three or more; None if there is none or it is undecided."""
    if len(group) < 3:
        return None
    try:
        return answers.conflict(group)
    except UndecidedError:
        return None


def _smallest(group: Sequence[str], answers: RuleAnswers) -> Sequence[str]:
    """The group reduced to the rules that its conflict needs."""
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
    when = "at all" if clash.trace is None else "after some trace"
    if clash.objects is not None:
        exactly = named([f"{name}: {kind}" for name, kind in clash.objects.items()])
        when = f"for objects of exactly these types: {exactly}"
    notes = () if clash.trace is None else trace_note("after the trace", clash.trace, whole)
    both = "both" if len(names) == 2 else "all"
    return CONFLICTING_RULES.at(
        rules[last].span,
        f"rules {', '.join(f'`{name}`' for name in firsts)} and `{last}` cannot {both} be kept "
        f"{when}; each alone could",
        help="give one of them an exception for what another one demands, or make it soft",
        labels=tuple(
            Label(place, f"`{name}` is here")
            for name in firsts
            if (place := at(rules[name].span)) is not None
        ),
        notes=notes,
    )


def contradictions(
    names: Sequence[str],
    sides: Mapping[str, AnalyzedRule],
    rules: Mapping[str, Rule],
    occurring: Occurring,
    *,
    answers: RuleAnswers,
    related: RelatedRules,
) -> Iterator[Diagnostic]:
    """Pairs of hard rules that can both be kept only if an antecedent of one never holds.

    Each pair is reported for the first such antecedent.
    """
    reported: set[frozenset[str]] = set()
    for name, other, antecedent, occurs in _triggered(names, sides, occurring, related):
        pair = frozenset((name, other))
        if pair in reported or not _contradict(name, other, occurs, answers):
            continue
        reported.add(pair)
        first, second = sorted(pair, key=names.index)
        label = at(rules[first].span)
        yield CONTRADICTING_RULES.at(
            rules[second].span,
            f"rules `{first}` and `{second}` cannot both be kept where "
            f"`{formula_text(antecedent.formula)}`",
            help="limit one of them, by `when` or `unless`, to where the other one does not apply; "
            "or forbid that situation outright",
            labels=() if label is None else (Label(label, f"`{first}` is here"),),
            severity="warning",
        )


def _triggered(
    names: Sequence[str],
    sides: Mapping[str, AnalyzedRule],
    occurring: Occurring,
    related: RelatedRules,
) -> Iterator[tuple[str, str, Antecedent, str]]:
    """Related rules about the same objects, with an antecedent of the first and its occurrence.

    With more objects, an antecedent would have to hold for all of them.
    """
    chosen = frozenset(names)
    for name in names:
        types = sorted(variable.type for variable in sides[name].rule.variables)
        for other in related.of(name):
            own = sorted(variable.type for variable in sides[other].rule.variables)
            if other in chosen and own in (types, []):
                for antecedent, occurs in occurring[name]:
                    if antecedent.kind != "unless":
                        yield name, other, antecedent, occurs


def _contradict(name: str, other: str, occurs: str, answers: RuleAnswers) -> bool:
    """Whether the occurrence is possible with either rule but not with both; False if undecided."""
    try:
        return (
            _never_kept((name, other, occurs), answers)
            and not _never_kept((name, occurs), answers)
            and not _never_kept((other, occurs), answers)
            # Rules in conflict are reported by ``conflicts`` in more detail
            and answers.conflict((name, other)) is None
        )
    except UndecidedError:
        return False


def _never_kept(group: Sequence[str], answers: RuleAnswers) -> bool:
    """Whether rules, each of which can be kept, can never be kept together."""
    clash = answers.conflict(group)
    return clash == Conflict(None)
