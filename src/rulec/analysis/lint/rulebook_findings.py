"""Diagnostics, with traces, of vacuous, redundant, conflicting or weakened rules."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import replace

from rulec.analysis.diff.rule_comparison import RuleComparison
from rulec.analysis.lint import finding_messages
from rulec.analysis.lint.changing_lines import Change
from rulec.analysis.lint.conflict_findings import (
    conflicts,
    contradictions,
)
from rulec.analysis.lint.questions import ComparedRules, RuleAnswers, Spread
from rulec.analysis.lint.related_rules import RelatedRules
from rulec.analysis.shared_compilation import AnalyzedRule, at_one_step, compile_shared
from rulec.analysis.trace_display import trace_note
from rulec.diagnostics import Diagnostic, Label, Span, named
from rulec.diagnostics.diagnostic import SourceLocation, at
from rulec.logic.printing import formula_text
from rulec.rulebook.rulebook_model import Rule, Rulebook
from rulec.rulebook.rules.antecedents import (
    Antecedent,
    AntecedentKind,
    antecedents,
    has_constant,
    occurrence,
)
from rulec.trace import Trace
from rulec.witnesses.undecided import UndecidedError


def rulebook_findings(
    book: Rulebook,
    bases: Sequence[Rulebook],
    tell: Callable[[float], object] = lambda _: None,
    *,
    extends: Span | None = None,
    spread: Spread | None = None,
    changes: Mapping[str, Change] | None = None,
) -> tuple[Diagnostic, ...]:
    """All findings about a rulebook: by rule, then about several rules.

    Args:
        book: the rulebook.
        bases: the rulebooks that it extends.
        extends: the place where it says so.
        tell: called with the number of questions about rules answered so far.
        spread: computes answers in advance, for example in other processes.
        changes: by inherited rule, the lines of the rulebook that change it.

    Raises RulecError if a rule cannot be compiled.
    """
    by_name = {rule.name: rule for rule in book.rules}
    conditions = {
        f"{rule.name} {number}": (rule, antecedent)
        for rule in book.rules
        for number, antecedent in enumerate(antecedents(rule))
    }
    occurrences = {name: occurrence(*condition, name) for name, condition in conditions.items()}
    inherited = [{rule.name: rule for rule in base.rules if rule.name in by_name} for base in bases]
    own, *of_bases = compile_shared(
        [book, *bases], _at_one_step([{**by_name, **occurrences}, *inherited])
    )
    related = RelatedRules(list(by_name), own, book.name)
    answers = RuleAnswers(ComparedRules(own, of_bases), tell)
    occurring: dict[str, list[tuple[Antecedent, str]]] = {name: [] for name in by_name}
    for asked_name, (conditioned, antecedent) in conditions.items():
        occurring[conditioned.name].append((antecedent, asked_name))

    def findings(answers: RuleAnswers) -> tuple[Diagnostic, ...]:
        diagnostics: list[Diagnostic] = []
        good: list[str] = []
        for name, rule in by_name.items():
            idle = [*_idle(rule, occurring[name], answers)]
            diagnostics += [diagnostic for _, diagnostic in idle]
            # A rule keeps its meaning without an exception that never holds.
            if all(kind == "unless" for kind, _ in idle):
                alone = [*_alone(rule, answers)]
                diagnostics += alone
                if not alone:
                    good.append(name)
        hard = [name for name in good if by_name[name].strength == "hard"]
        conflicting = [*conflicts(hard, own, by_name, answers, related)]
        conflict_places = [
            {one.place, *_labelled(one)} for one in conflicting if one.place is not None
        ]
        for name, finding, premises in _needless(good, by_name, answers, related, conflict_places):
            origins = {by_name[rule].book for rule in (name, *premises)}
            is_changed = not (changes or {}).keys().isdisjoint((name, *premises))
            if by_name[name].book == book.name:
                diagnostics.append(finding)
            elif is_changed or book.name in origins or not _have_the_same_facts(book, bases):
                diagnostics.append(_to_drop(name, finding, extends))
            else:
                diagnostics.append(_of_base(finding, extends, bases))
        diagnostics += conflicting
        diagnostics += contradictions(
            hard, own, by_name, occurring, answers=answers, related=related
        )
        for number, (base, sides) in enumerate(zip(bases, of_bases, strict=True)):
            for name, side in sides.items():
                comparison = answers.compared(name, number)
                change = (changes or {}).get(name)
                diagnostic = _weaker(by_name[name], (own[name], side), base, comparison, change)
                if diagnostic is not None:
                    is_own = by_name[name].book == book.name
                    inherited_by = _changed(diagnostic, change) or _inherited(diagnostic, extends)
                    diagnostics.append(diagnostic if is_own else inherited_by)
        return tuple(diagnostics)

    if spread is not None:
        answers.ask_ahead(findings, spread)
    return findings(answers)


def _at_one_step(rules: Sequence[Mapping[str, Rule]]) -> list[dict[str, Rule]]:
    """The rules of several rulebooks, for one common step; still by rulebook and name."""
    common = iter(at_one_step([rule for named in rules for rule in named.values()], None))
    return [dict(zip(named, common, strict=False)) for named in rules]


def _others(
    name: str, left: Set[str], rules: Mapping[str, Rule], related: RelatedRules
) -> list[str]:
    """The rules that might make a rule redundant."""
    return [
        kept
        for kept in related.of(name)
        if kept in left and (rules[kept].strength == "hard" or rules[name].strength == "soft")
    ]


def _idle(
    rule: Rule, occurring: Sequence[tuple[Antecedent, str]], answers: RuleAnswers
) -> Iterator[tuple[AntecedentKind, Diagnostic]]:
    for trigger, asked_name in occurring:
        try:
            occurs = answers.can_be_kept(asked_name)
        except UndecidedError as problem:
            question = f"{trigger.in_words} can ever hold"
            yield trigger.kind, finding_messages.undecided_diagnostic(rule, question, problem)
            continue
        if not occurs:
            message = f"{trigger.in_words} of rule `{rule.name}` never holds: "
            yield (
                trigger.kind,
                finding_messages.NEVER_TRIGGERED.at(
                    rule.span,
                    message + f"`{formula_text(trigger.formula)}`",
                    help="no state of the world can satisfy it; correct it, or leave it out",
                    severity="warning",
                ),
            )


def _alone(rule: Rule, answers: RuleAnswers) -> Iterator[Diagnostic]:
    try:
        if not answers.can_be_violated(rule.name):
            yield finding_messages.CANNOT_BE_VIOLATED.at(
                rule.span,
                f"nothing can violate rule `{rule.name}`",
                help="it holds in every possible trace"
                + (
                    ", with the constants in it, such as options, as they are set"
                    if has_constant(rule.formula)
                    else ""
                )
                + "; make it forbid something",
                severity="warning",
            )
        elif not answers.can_be_kept(rule.name):
            yield finding_messages.CANNOT_BE_KEPT.at(
                rule.span,
                f"nothing can keep rule `{rule.name}`",
                help="every trace violates it; make it allow something",
            )
    except UndecidedError as problem:
        yield finding_messages.undecided_diagnostic(rule, "it can be kept and violated", problem)


def _needless(
    names: Sequence[str],
    rules: Mapping[str, Rule],
    answers: RuleAnswers,
    related: RelatedRules,
    conflict_places: Sequence[Set[SourceLocation]],
) -> Iterator[tuple[str, Diagnostic, Sequence[str]]]:
    """Rules that can all be left out together without changing what is forbidden, by name.

    Each comes with the rules that imply it. ``conflict_places`` has the places of rules that cannot
    be kept together.
    """
    left = set(names)
    diagnostics: list[tuple[str, Diagnostic, Sequence[str]]] = []
    for name in reversed(names):
        try:
            premises = answers.implied_by(name, _others(name, left, rules, related))
        except UndecidedError as problem:
            undecided = finding_messages.undecided_diagnostic(
                rules[name], "others imply it", problem
            )
            diagnostics.append((name, undecided, ()))
            continue
        if not premises:
            continue
        finding = _implied(rules[name], [rules[premise] for premise in premises])
        # Rules that contradict each other imply everything, so the rule still counts.
        if not any(contradicting <= _labelled(finding) for contradicting in conflict_places):
            diagnostics.append((name, finding, premises))
            left.remove(name)
    yield from reversed(diagnostics)


def _labelled(finding: Diagnostic) -> Set[SourceLocation]:
    """The places of the other rules of a finding."""
    return {label.place for label in finding.labels}


def _implied(rule: Rule, premises: Sequence[Rule]) -> Diagnostic:
    verb = "forbids" if len(premises) == 1 else "together forbid"
    names = " and ".join(f"`{premise.name}`" for premise in premises)
    label = "this is enough" if len(premises) == 1 else "this is part of it"
    return finding_messages.ADDS_NOTHING.at(
        rule.span,
        f"rule `{rule.name}` adds nothing: {names} {verb} all that it forbids",
        help="leave it out, unless its provision deserves a rule of its own",
        labels=tuple(
            Label(place, label) for premise in premises if (place := at(premise.span)) is not None
        ),
        severity="warning",
    )


def _to_drop(name: str, diagnostic: Diagnostic, extends: Span | None) -> Diagnostic:
    """The finding for an inherited rule that adds nothing; it can only be dropped or overridden."""
    if diagnostic.code != finding_messages.ADDS_NOTHING.code:
        return _inherited(diagnostic, extends)
    way_out = (
        f'write `drop rule {name} because "…"`, or override it instead of writing another one, '
        "unless its provision deserves a rule of its own"
    )
    return replace(_inherited(diagnostic, extends), help=way_out)


def _have_the_same_facts(book: Rulebook, bases: Sequence[Rulebook]) -> bool:
    return bool(bases) and book.axioms == bases[-1].axioms


def _of_base(diagnostic: Diagnostic, extends: Span | None, bases: Sequence[Rulebook]) -> Diagnostic:
    """The finding for rules that are all inherited unchanged, which is a matter of the base."""
    inherited = _inherited(diagnostic, extends)
    if diagnostic.code != finding_messages.ADDS_NOTHING.code:
        return inherited
    way_out = f"it is so in `{bases[-1].name}`: there is nothing to change in this rulebook"
    return replace(inherited, help=way_out)


def _inherited(diagnostic: Diagnostic, extends: Span | None) -> Diagnostic:
    """The finding for an inherited rule, at the line that inherits it."""
    if extends is None or diagnostic.place is None:
        return diagnostic
    rule = Label(diagnostic.place, "the rule is inherited from here")
    return replace(diagnostic, place=extends.place, labels=(rule, *diagnostic.labels))


def _changed(diagnostic: Diagnostic, change: Change | None) -> Diagnostic | None:
    """The finding for an inherited rule, at the first line that changes it, if there is one."""
    if change is None or diagnostic.place is None:
        return None
    first, *others = change.lines
    rule = Label(diagnostic.place, "the rule is inherited from here")
    more = tuple(Label(line.place, "this changes it, too") for line in others)
    return replace(diagnostic, place=first.place, labels=(*more, rule, *diagnostic.labels))


def _types_of(trace: Trace, own: AnalyzedRule, inherited: AnalyzedRule) -> str:
    """The types of a trace's objects, if two rules are about objects of different types."""
    now, before = (
        [f"{variable.name}: {variable.type}" for variable in one.rule.variables]
        for one in (own, inherited)
    )
    if now == before or not trace.objects:
        return ""
    objects = named([f"{name}: {kind}" for name, kind in trace.objects.items()])
    return f", for {objects} where this rule has {named(now)}" if now else f", for {objects}"


def _weaker(
    rule: Rule,
    compared: tuple[AnalyzedRule, AnalyzedRule],
    base: Rulebook,
    comparison: RuleComparison,
    change: Change | None,
) -> Diagnostic | None:
    own, inherited = compared
    if comparison.undecided:
        problem = UndecidedError(comparison.undecided)
        return finding_messages.undecided_diagnostic(
            rule, f"it is as strict as in `{base.name}`", problem
        )
    # As for a dropped rule, a reason says that the law wants it so.
    explained = change is not None and change.softened_why
    softer = inherited.rule.strength == "hard" and rule.strength == "soft" and not explained
    if not comparison.second_forbids and not softer:
        return None
    how = "laxer" if comparison.second_forbids else "softer"
    if comparison.relation == "incomparable":
        how = "neither stricter nor laxer"
    notes = [
        note
        for trace in comparison.second_forbids
        for note in trace_note(
            f"`{base.name}` forbids{_types_of(trace, own, inherited)}", trace, (own, inherited)
        )
    ]
    return finding_messages.WEAKER_THAN_BASE.at(
        rule.span,
        f"rule `{rule.name}` is {how} than in `{base.name}`, which this rulebook extends",
        help="if that is what the law says, leave it as it is",
        notes=tuple(notes),
        severity="warning",
    )
