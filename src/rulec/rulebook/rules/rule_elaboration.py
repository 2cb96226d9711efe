"""From a rule as written to a rule as meant."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from rulec.diagnostics import Diagnostic, Label
from rulec.logic.bounds import NotAMultipleError, in_steps
from rulec.logic.formula import Binary, BinaryOperator, Constant, Formula, Unary, UnaryOperator
from rulec.rulebook.arithmetic.linear_arithmetic import negated
from rulec.rulebook.arithmetic.size_limits import TooDeepError, TooLargeError, exceeded_limit
from rulec.rulebook.elaborate import rule_messages
from rulec.rulebook.elaborate import rule_messages as say
from rulec.rulebook.elaborate.elaboration import number, truth
from rulec.rulebook.elaborate.number_literals import exact_value
from rulec.rulebook.elaborate.rule_messages import no_multiple
from rulec.rulebook.elaborate.rule_variables import variables_of
from rulec.rulebook.elaborate.scope import Scope
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.constants_and_macros import ConstantsAndMacros
from rulec.rulebook.overlay.rulebook_overlay import RuleEntry
from rulec.rulebook.rulebook_model import Exemption, Rule, Variable
from rulec.rulebook.rules.example_elaboration import example_of
from rulec.rulebook.rules.exemptions import (
    BoundedPhaseError,
    NoStretchError,
    TooManyExceptionsError,
    exempted,
)
from rulec.syntax import tree
from rulec.vocabulary.units import DIMENSIONS


def translate_rule(
    entry: RuleEntry,
    symbols: SymbolTable,
    constants: ConstantsAndMacros,
    levels: Sequence[str] | None,
) -> tuple[Rule | None, list[Diagnostic]]:
    """Elaborate a rule; return it or None, its mistakes and warnings.

    ``levels`` are those of the rulebook's priorities; None if they are not known for sure.
    """
    item = entry.item
    mistakes: list[Diagnostic] = []
    variables = variables_of(item.variables, symbols, mistakes)
    scope = Scope(symbols, constants, variables, mistakes, taken=frozenset(variables))
    constants.begin()
    parts = _parts_of(item, scope)
    formula = None if parts is None else _formula(item, parts, scope)
    if item.complete and formula is not None:
        mistakes += _unused(item, scope)
    if item.level is not None and levels is not None and item.level.text not in levels:
        scope.report(rule_messages.no_level(item.level, levels))
    weight = Fraction(1) if item.weight is None else exact_value(item.weight, scope)
    if item.weight is not None and weight == 0:
        scope.report(rule_messages.weightless(item.weight))
    sound = len(mistakes)
    examples = [example_of(example, formula, scope) for example in item.examples]
    misfit = next((mistake for mistake in mistakes[sound:] if mistake.severity == "error"), None)
    if misfit is not None and entry.changed is not None and entry.examples_from is not entry.book:
        # What is wrong with the rest of the rule may be why.
        clean = formula is not None and not any(
            mistake.severity == "error" for mistake in mistakes[:sound]
        )
        mistakes[sound:] = [rule_messages.misfit(entry.changed, misfit)] if clean else []
    step = _step_of(entry.examples_from, scope)
    if (
        parts is None
        or formula is None
        or weight is None
        or any(mistake.severity == "error" for mistake in mistakes)
    ):
        return None, [_with_change(mistake, entry) for mistake in mistakes]
    dates = item.in_force or tree.InForce()
    rule = Rule(
        name=item.name.text,
        strength=item.strength or "hard",
        variables=tuple(
            Variable(variable.name.text, variable.type.text)
            for variable in item.variables
            if variable.type
        ),
        formula=formula,
        cite=item.cite.value if item.cite else "",
        says=item.says.value if item.says else "",
        examples=tuple(examples),
        span=item.span,
        level=item.level.text if item.level else "",
        weight=weight,
        source=item.source.value if item.source else "",
        certainty=item.certainty,
        in_force_from=dates.since,
        in_force_until=dates.until,
        book=entry.book.name.text if entry.book.name else "",
        step_s=step,
        required=parts.required if parts.exemptions or parts.condition else None,
        exemptions=parts.exemptions,
        condition=parts.condition,
    )
    if rule.examples:
        try:
            in_steps(formula, step)
        except NotAMultipleError as error:
            return None, [*mistakes, no_multiple(rule, error)]
    return rule, mistakes


def _step_of(file: tree.File, scope: Scope) -> Fraction:
    """The step between states of a rulebook's examples, in seconds."""
    if file.step is None:
        return Fraction(1)
    result = number(file.step.amount, scope)
    if result is None:
        return Fraction(1)
    step = result.cases[0][1].constant
    if result.dimension != DIMENSIONS["time"] or step <= 0:
        scope.report(rule_messages.no_step(file.step))
        return Fraction(1)
    return step


def _with_change(mistake: Diagnostic, entry: RuleEntry) -> Diagnostic:
    """Inherited mistake, labelled with the line that changed the rule."""
    changed = None if entry.changed is None else entry.changed.span.place
    if changed is None or mistake.place is None or mistake.place.file == changed.file:
        return mistake
    return replace(mistake, labels=(*mistake.labels, Label(changed, "the rule is changed here")))


@dataclass(frozen=True, slots=True)
class _Parts:
    """The parts of a rule: requirement, exemptions, condition."""

    required: Formula
    exemptions: tuple[Exemption, ...]
    condition: Formula | None


def _parts_of(item: tree.RuleItem, scope: Scope) -> _Parts | None:
    """Parts of a rule's formula; None after a reported mistake."""
    try:
        required = None if item.require is None else truth(item.require, scope)
        result = [
            (truth(unless.formula, scope), unless.scope or "throughout") for unless in item.unless
        ]
        condition = None if item.when is None else truth(item.when, scope)
    except TooDeepError:
        scope.report(rule_messages.too_deep("formula", item.name))
        return None
    except TooLargeError:
        scope.report(rule_messages.too_large("formula", item.name))
        return None
    exemptions = tuple(Exemption(formula, when) for formula, when in result if formula is not None)
    whole = len(exemptions) == len(result) and (condition is not None or item.when is None)
    # What depends on an option alone says nothing once that is known.
    exemptions = tuple(
        exemption for exemption in exemptions if exemption.formula != Constant(False)
    )
    condition = None if condition == Constant(True) else condition
    return None if required is None or not whole else _Parts(required, exemptions, condition)


def _formula(item: tree.RuleItem, parts: _Parts, scope: Scope) -> Formula | None:
    """Formula of a whole rule; None after a reported mistake."""
    formula = _with_exceptions(item, parts, scope)
    match "" if formula is None else exceeded_limit(formula):
        case "deep":
            scope.report(rule_messages.too_deep("formula", item.name))
            return None
        case "large":
            scope.report(rule_messages.too_large("formula", item.name))
            return None
    return formula


def _with_exceptions(item: tree.RuleItem, parts: _Parts, scope: Scope) -> Formula | None:
    formula, exemptions = parts.required, list(parts.exemptions)
    if parts.condition is not None:
        if _guards_a_stretch(formula):
            exemptions.append(Exemption(negated(parts.condition), "at some point"))
        else:
            formula = Binary(BinaryOperator.IMPLIES, parts.condition, formula)
    try:
        return exempted(formula, exemptions)
    except NoStretchError:
        wrong = next(unless for unless in item.unless if unless.scope != "initially")
        require = None if item.require is None else item.require.span
        scope.report(say.no_stretch(wrong, wrong.scope or "", require))
    except BoundedPhaseError:
        scope.report(say.bounded_phase(_throughout(item)))
    except TooManyExceptionsError:
        scope.report(say.too_many_exceptions(_throughout(item)))
    return None


def _throughout(item: tree.RuleItem) -> tree.Unless:
    return [unless for unless in item.unless if unless.scope in (None, "throughout")][-1]


def _guards_a_stretch(formula: Formula) -> bool:
    guarding = (UnaryOperator.ALWAYS, UnaryOperator.NEVER)
    return isinstance(formula, Unary) and formula.operator in guarding


def _unused(item: tree.RuleItem, scope: Scope) -> Iterator[Diagnostic]:
    for variable in item.variables:
        if variable.name.text not in scope.used:
            yield say.unused_in_rule(item, variable)
