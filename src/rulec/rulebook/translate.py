"""From a rule as written to a rule as meant."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

from rulec.diagnostics import Diagnostic
from rulec.logic.formula import Binary, BinaryOperator, Formula, Unary, UnaryOperator
from rulec.rulebook import meaning_messages as say
from rulec.rulebook import rule_messages
from rulec.rulebook.declaration_messages import twice, unknown_type
from rulec.rulebook.declared import Declared
from rulec.rulebook.examples import example_of
from rulec.rulebook.exceptions import (
    MOST_THROUGHOUT,
    BoundedPhaseError,
    NoStretchError,
    TooManyExceptionsError,
    exempted,
)
from rulec.rulebook.meaning import meaning, number, truth
from rulec.rulebook.model import Exemption, Rule, Variable
from rulec.rulebook.numbers import negated
from rulec.rulebook.overlay import RuleEntry
from rulec.rulebook.provisions import Provisions
from rulec.rulebook.scope import Anything, BoundVariable, Call, Scope
from rulec.syntax import tree
from rulec.vocabulary.units import DIMENSIONS

DEEPEST = 240
"""Operators inside one another in a rule with its definitions put in."""


def translate_rule(
    entry: RuleEntry, declared: Declared, provisions: Provisions, levels: tuple[str, ...]
) -> tuple[Rule | None, list[Diagnostic]]:
    """The rule as meant (None if it has a mistake), its mistakes and warnings.

    ``levels`` are those of the rulebook's priorities.
    """
    item = entry.item
    mistakes: list[Diagnostic] = []
    variables = variables_of(item.variables, declared, mistakes)
    scope = Scope(declared, provisions, variables, mistakes)
    provisions.expansions = 0
    required = None if item.require is None else truth(item.require, scope)
    exemptions = _exemptions(item, scope)
    condition = None if item.when is None else truth(item.when, scope)
    formula = None
    if required is not None and exemptions is not None and (condition or item.when is None):
        formula = _with_exceptions(item, required, exemptions, condition, scope)
    if formula is not None and too_deep(formula):
        scope.report(rule_messages.too_deep(item, DEEPEST))
    if item.complete and formula is not None:
        mistakes += _unused(item, scope)
    if item.level is not None and item.level.text not in levels:
        scope.report(rule_messages.no_level(item.level, levels))
    weight = Fraction(1) if item.weight is None else Fraction(item.weight.text)
    if weight <= 0 and item.weight is not None:
        scope.report(rule_messages.weightless(item.weight))
    examples = [example_of(example, formula, scope) for example in item.examples]
    step = step_of(entry.book, scope)
    if formula is None or any(one.severity == "error" for one in mistakes):
        return None, mistakes
    dates = item.in_force or tree.InForce()
    rule = Rule(
        item.name.text,
        item.strength or "hard",
        tuple(Variable(one.name.text, one.type.text) for one in item.variables if one.type),
        formula,
        item.cite.value if item.cite else "",
        item.says.value if item.says else "",
        tuple(examples),
        item.span,
        item.level.text if item.level else "",
        weight,
        item.source.value if item.source else "",
        item.certainty,
        dates.since,
        dates.until,
        entry.book.name.text if entry.book.name else "",
        step,
        required if exemptions or condition else None,
        tuple(exemptions or ()),
        condition,
    )
    return rule, mistakes


def check_definition(
    item: tree.DefineItem, declared: Declared, provisions: Provisions
) -> list[Diagnostic]:
    """What is wrong with a definition by itself, whoever uses it."""
    mistakes: list[Diagnostic] = []
    typed = tuple(one for one in item.parameters if one.type is not None)
    variables = variables_of(typed, declared, mistakes)
    mistakes += (
        twice("parameter", one.name, variables[one.name.text].span)
        for one in item.parameters
        if one.type is None and one.name.text in variables
    )
    scope = Scope(
        declared,
        provisions,
        variables,
        mistakes,
        relations={one.name.text: Anything() for one in item.parameters if one.type is None},
        of_definition=True,
    )
    provisions.expansions = 0
    inner = replace(scope, calls=(Call(item.name.text, item.name.span),))
    found = meaning(item.body, inner) is not None
    if found:
        mistakes += (
            rule_messages.unused_parameter(item, one)
            for one in item.parameters
            if one.name.text not in inner.used
        )
    # A definition's own name as the place that it is used at says nothing.
    own = item.name.span.place
    return [
        replace(one, labels=tuple(label for label in one.labels if label.place != own))
        for one in mistakes
    ]


def step_of(file: tree.File, scope: Scope) -> Fraction:
    """How far the states of a rulebook's examples are apart, in seconds."""
    if file.step is None:
        return Fraction(1)
    found = number(file.step.amount, scope)
    if found is None:
        return Fraction(1)
    step = found.cases[0][1].constant
    if found.dimension != DIMENSIONS["time"] or step <= 0:
        scope.report(rule_messages.no_step(file.step))
        return Fraction(1)
    return step


def variables_of(
    parameters: tuple[tree.Parameter, ...], declared: Declared, mistakes: list[Diagnostic]
) -> dict[str, BoundVariable]:
    """Variables with their types; what is wrong with them is added to ``mistakes``."""
    found: dict[str, BoundVariable] = {}
    for one in parameters:
        name, type_ = one.name, one.type
        assert type_ is not None, "the grammar asks for a variable's type"
        known = type_.text in declared.types
        if not known and not declared.may_know_type(type_.text):
            mistakes.append(unknown_type(type_, list(declared.types)))
        if name.text in found:
            mistakes.append(twice("variable", name, found[name.text].span))
        else:
            found[name.text] = BoundVariable(type_.text if known else None, one.span, name.text)
    return found


def _exemptions(item: tree.RuleItem, scope: Scope) -> list[Exemption] | None:
    """What `unless` says; None if it has a mistake, which is then reported."""
    found = [(truth(one.formula, scope), one.scope or "throughout") for one in item.unless]
    good = [Exemption(formula, when) for formula, when in found if formula is not None]
    return good if len(good) == len(found) else None


def _with_exceptions(
    item: tree.RuleItem,
    formula: Formula,
    exemptions: list[Exemption],
    condition: Formula | None,
    scope: Scope,
) -> Formula | None:
    """The formula with `unless` and `when`; None if they don't fit it, which is then reported."""
    if condition is not None:
        if _guards_a_stretch(formula):
            exemptions = [*exemptions, Exemption(negated(condition), "at some point")]
        else:
            formula = Binary(BinaryOperator.IMPLIES, condition, formula)
    try:
        return exempted(formula, exemptions)
    except NoStretchError:
        wrong = next(one for one in item.unless if one.scope != "initially")
        require = None if item.require is None else item.require.span
        scope.report(say.no_stretch(wrong, wrong.scope or "", require))
    except BoundedPhaseError:
        scope.report(say.bounded_phase(_throughout(item)))
    except TooManyExceptionsError:
        scope.report(say.too_many_exceptions(_throughout(item), MOST_THROUGHOUT))
    return None


def _throughout(item: tree.RuleItem) -> tree.Unless:
    return [one for one in item.unless if one.scope in (None, "throughout")][-1]


def _guards_a_stretch(formula: Formula) -> bool:
    guarding = (UnaryOperator.ALWAYS, UnaryOperator.NEVER)
    return isinstance(formula, Unary) and formula.operator in guarding


def too_deep(formula: Formula) -> bool:
    """Has it more than ``DEEPEST`` operators inside one another?"""
    layer: list[Formula] = [formula]
    for _ in range(DEEPEST):
        layer = [part for one in layer for part in _parts(one)]
        if not layer:
            return False
    return True


def _parts(formula: Formula) -> tuple[Formula, ...]:
    match formula:
        case Unary(_, operand):
            return (operand,)
        case Binary(_, left, right):
            return left, right
        case _:
            return ()


def _unused(item: tree.RuleItem, scope: Scope) -> Iterator[Diagnostic]:
    for one in item.variables:
        if one.name.text not in scope.used:
            yield Diagnostic(
                "R0207",
                f"the formula of `{item.name.text}` says nothing about `{one.name.text}`",
                one.span.place,
                expected="not used in `require`",
                help="leave the variable out, or speak of it",
                severity="warning",
            )
