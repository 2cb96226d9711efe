"""Resolves a written rule."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

from rulec.diagnostics import Diagnostic, Label
from rulec.logic import formula as ltl
from rulec.logic.bounds import between_instants
from rulec.logic.formula import negated
from rulec.rulebook.arithmetic.size_limits import exceeded_limit
from rulec.rulebook.elaborate import rule_messages as say
from rulec.rulebook.elaborate.amounts import exact_value
from rulec.rulebook.elaborate.elaboration import number, truth
from rulec.rulebook.elaborate.scope import Scope, bound_variables
from rulec.rulebook.elaborate.time_reach import (
    covers,
    operator_warnings,
    requirement_warnings,
)
from rulec.rulebook.names.referenced_names import formulas_of
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.constants_and_macros import ConstantsAndMacros
from rulec.rulebook.overlay.rulebook_overlay import RuleEntry
from rulec.rulebook.rulebook_model import Exemption, Rule, RuleParts, Variable
from rulec.rulebook.rules.example_elaboration import example_of
from rulec.rulebook.rules.exemptions import ExemptionError, exempted
from rulec.syntax import tree
from rulec.vocabulary.dimensions import DIMENSIONS


def translate_rule(
    entry: RuleEntry,
    symbols: SymbolTable,
    constants: ConstantsAndMacros,
    levels: Sequence[str] | None,
    *,
    confirmed: bool = True,
) -> tuple[Rule | None, list[Diagnostic]]:
    """Elaborate a rule; returns it or None, with its mistakes and warnings.

    ``levels`` are those of the rulebook's priorities; None if they are not known for certain.
    ``confirmed``: it is the rulebook's own law.
    """
    item = entry.item
    mistakes: list[Diagnostic] = []
    variables = bound_variables(item.variables, symbols, mistakes.append)
    scope = Scope(symbols, constants, variables, mistakes, taken=frozenset(variables))
    parts = None
    constants.defined.clear()
    with scope.within_limits("formula", item.name):
        parts = _parts_of(item, scope)
    defined = tuple(constants.defined.items())
    formula = None if parts is None else _formula(item, parts, scope)
    if item.complete and formula is not None:
        mistakes += scope.unused(item.variables, item)
        mistakes += _time_warnings(item, scope)
        mistakes += say.exceptions_on_one_line(item)
    if (crowded := say.many_choices(item, len(variables))) is not None:
        scope.report(crowded)
    if item.level is not None and levels is not None and item.level.text not in levels:
        scope.report(say.no_level(item.level, levels))
    weight = Fraction(1) if item.weight is None else exact_value(item.weight, scope)
    if item.weight is not None and weight == 0:
        scope.report(say.weightless(item.weight))
    mistakes += constants.overlay.wrong_topics(item)
    sound = len(mistakes)
    examples = [example_of(example, formula, scope) for example in item.examples]
    misfits = _errors(mistakes[sound:])
    if misfits and entry.changed is not None and entry.examples_from is not entry.book:
        # What is wrong with the rest of the rule may be why.
        clean = formula is not None and not _errors(mistakes[:sound])
        mistakes[sound:] = [say.misfit(entry.changed, misfits[0])] if clean else []
    step = _step_of(entry.examples_from, scope)
    if parts is None or formula is None or weight is None or _errors(mistakes):
        return None, [_with_change(mistake, entry) for mistake in mistakes]
    dates, law = item.in_force or tree.InForce(), entry.law
    rule = Rule(
        name=item.name.text,
        strength=item.strength or "hard",
        variables=tuple(
            Variable(variable.name.text, variable.type.text)
            for variable in item.variables
            if variable.type
        ),
        formula=formula,
        cite=item.cite.value.strip() if item.cite else "",
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
        topics=constants.overlay.topics_of(item),
        defined=defined,
        inherited_from=law.name.text if law.name and not confirmed else "",
    )
    between = between_instants(formula, step) if rule.examples else None
    if between is not None:
        mistakes.append(say.no_multiple(rule, *between))
    return rule, mistakes


def _time_warnings(item: tree.RuleItem, scope: Scope) -> Iterator[Diagnostic]:
    overlay = scope.constants.overlay
    narrow = [
        diagnostic for part in formulas_of(item) for diagnostic in operator_warnings(part, overlay)
    ]
    yield from narrow
    if item.require is not None:
        for warning in requirement_warnings(item.require, scope.symbols, overlay):
            # What an operator was meant to speak of is not blamed a second time.
            if not any(covers(diagnostic, warning) for diagnostic in narrow):
                yield warning


def _errors(mistakes: Sequence[Diagnostic]) -> list[Diagnostic]:
    return [mistake for mistake in mistakes if mistake.severity == "error"]


def _step_of(file: tree.File, scope: Scope) -> Fraction:
    amount = None if file.step is None else number(file.step.amount, scope)
    if file.step is None or amount is None:
        return Fraction(1)
    step = amount.cases[0][1].constant
    if amount.dimension == DIMENSIONS["time"] and step > 0:
        return step
    scope.report(say.no_step(file.step))
    return Fraction(1)


def _with_change(mistake: Diagnostic, entry: RuleEntry) -> Diagnostic:
    changed = None if entry.changed is None else entry.changed.span.place
    if changed is None or mistake.place is None or mistake.place.file == changed.file:
        return mistake
    return replace(mistake, labels=(*mistake.labels, Label(changed, "the rule is changed here")))


def _parts_of(item: tree.RuleItem, scope: Scope) -> RuleParts | None:
    """Parts of a rule's formula; None after a reported mistake. Raises OverLimitError."""
    required = None if item.require is None else truth(item.require, scope)
    exempt = [(truth(part.formula, scope), part.scope or "throughout") for part in item.unless]
    condition = None if item.when is None else truth(item.when, scope)
    if required is None or (condition is None and item.when is not None):
        return None
    exemptions = [Exemption(formula, when) for formula, when in exempt if formula is not None]
    if len(exemptions) < len(exempt):
        return None
    # What depends on an option alone says nothing once that is known.
    return RuleParts(
        required,
        tuple(exemption for exemption in exemptions if exemption.formula != ltl.Constant(False)),
        None if condition == ltl.Constant(True) else condition,
    )


def _formula(item: tree.RuleItem, parts: RuleParts, scope: Scope) -> ltl.Formula | None:
    formula, exemptions = parts.required, list(parts.exemptions)
    if parts.condition is not None:
        guarding = (ltl.UnaryOperator.ALWAYS, ltl.UnaryOperator.NEVER)
        if isinstance(formula, ltl.Unary) and formula.operator in guarding:
            exemptions.append(Exemption(negated(parts.condition), "at some point"))
        else:
            formula = ltl.Binary(ltl.BinaryOperator.IMPLIES, parts.condition, formula)
    try:
        formula = exempted(formula, exemptions)
    except ExemptionError as error:
        narrow = item.require is not None and any(
            requirement_warnings(item.require, scope.symbols, scope.constants.overlay)
        )
        scope.report(say.unfitting_exception(error.problem, item, first_state_only=narrow))
        return None
    limit = exceeded_limit(formula)
    if limit is not None:
        scope.report(say.over_limit(limit, "formula", item.name))
    return formula if limit is None else None
