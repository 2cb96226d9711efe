"""Findings about hard rules that cannot all be kept."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

from rulec.analysis.lint.conflict_search import Conflict, are_related, conflict
from rulec.analysis.lint.finding_messages import CONFLICTING_RULES, undecided_diagnostic
from rulec.analysis.lint.finding_notes import trace_note
from rulec.analysis.lint.redundancy import small_premises
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.diagnostics import Diagnostic, Label
from rulec.diagnostics.diagnostic import at
from rulec.rulebook.rulebook_model import Rule
from rulec.witnesses.undecided import UndecidedError


def conflicts(
    names: Sequence[str], sides: dict[str, AnalyzedRule], rules: dict[str, Rule]
) -> Iterator[Diagnostic]:
    """Pairs of hard rules in conflict, then groups without such a pair."""
    conflicting: list[frozenset[str]] = []
    for pair in combinations(names, 2):
        if not are_related(sides[pair[0]], sides[pair[1]]):
            continue
        try:
            clash = conflict([sides[name] for name in pair])
        except UndecidedError as problem:
            what = f"it can always be kept together with `{pair[0]}`"
            yield undecided_diagnostic(rules[pair[1]], what, problem)
            continue
        if clash is not None:
            conflicting.append(frozenset(pair))
            yield _cannot_be_kept(pair, clash, sides, rules)
    for name in names:
        related = [
            sides[other_name] for other_name in names if are_related(sides[name], sides[other_name])
        ]
        premises = [other_name for other_name in related if other_name.rule.name != name]
        group = [sides[name], *small_premises(sides[name], premises)]
        clash = None if _holds_one(conflicting, group) else _clash(group)
        if clash is not None:
            smaller = _smallest(group)
            chosen = tuple(
                other_name
                for other_name in names
                if other_name in {side.rule.name for side in smaller}
            )
            conflicting.append(frozenset(chosen))
            yield _cannot_be_kept(chosen, _clash(smaller) or clash, sides, rules)


def _holds_one(conflicting: Sequence[frozenset[str]], group: Sequence[AnalyzedRule]) -> bool:
    names = {rule_names.rule.name for rule_names in group}
    return any(rule_names <= names for rule_names in conflicting)


def _clash(group: Sequence[AnalyzedRule]) -> Conflict | None:
    """A conflict within a group of three or more; None if undecided."""
    if len(group) < 3:
        return None
    try:
        return conflict(group)
    except UndecidedError:
        return None


def _smallest(group: Sequence[AnalyzedRule]) -> Sequence[AnalyzedRule]:
    """The group without those that its conflict does not need."""
    for analyzed in group:
        fewer = [kept for kept in group if kept is not analyzed]
        if _clash(fewer) is not None:
            return _smallest(fewer)
    return group


def _cannot_be_kept(
    names: Sequence[str], clash: Conflict, sides: dict[str, AnalyzedRule], rules: dict[str, Rule]
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
