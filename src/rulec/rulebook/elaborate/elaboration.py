"""Elaboration of expressions into formulas and numbers, with type checks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from rulec.diagnostics import Diagnostic
from rulec.logic import formula as ltl
from rulec.logic.printing import term_text
from rulec.rulebook.arithmetic.linear_arithmetic import (
    Linear,
    NumberByCases,
    TooManyCasesError,
    added,
    combined,
    compared,
    divided,
    either,
    measured,
    negated,
    opposite,
    scaled,
)
from rulec.rulebook.arithmetic.size_limits import exceeded_limit
from rulec.rulebook.elaborate import constant_messages
from rulec.rulebook.elaborate import elaboration_messages as say
from rulec.rulebook.elaborate.bound_elaboration import bound_of
from rulec.rulebook.elaborate.macro_expansion import expand_macro
from rulec.rulebook.elaborate.number_literals import literal
from rulec.rulebook.elaborate.parameter_values import parameter
from rulec.rulebook.elaborate.quantifiers import aggregate
from rulec.rulebook.elaborate.scope import AnyArgument, Scope
from rulec.syntax import tree

_TEMPORAL = frozenset(
    (
        *("always", "never", "eventually", "next", "weak next"),
        *("once", "historically", "previously", "weak previously"),
        *("then", "until", "release", "weak until", "strong release", "since"),
    )
)


@dataclass(frozen=True, slots=True)
class Object:
    """An object, by the actual name of its variable."""

    name: str


Meaning = ltl.Formula | NumberByCases | Object | AnyArgument


def truth(node: tree.Formula, scope: Scope) -> ltl.Formula | None:
    """The formula; None if it has a mistake, which is then reported."""
    result = elaborate(node, scope)
    match result:
        case None:
            return None
        case AnyArgument():
            return ltl.Constant(True)
        case NumberByCases():
            scope.report(say.number_for_truth(node, result, scope))
            return None
        case Object():
            scope.report(say.object_for_truth(node, scope))
            return None
        case _:
            return result


def number(node: tree.Formula, scope: Scope) -> NumberByCases | None:
    """The number; None if it has a mistake, which is then reported."""
    result = elaborate(node, scope)
    match result:
        case None | AnyArgument():
            return None
        case NumberByCases():
            return result
        case _:
            scope.report(say.no_number(node, result, scope))
            return None


def elaborate(node: tree.Formula, scope: Scope) -> Meaning | None:
    """Elaborate an expression; None if it has a reported mistake.

    Raises:
        TooDeepError, TooLargeError: with its definitions put in it is too deep or too large.
    """
    with scope.constants.one_deeper():
        try:
            match node:
                case tree.AtomUse():
                    return _name(node, scope)
                case tree.TruthLiteral(value):
                    return ltl.Constant(value)
                case tree.NumberLiteral():
                    return literal(node, scope)
                case tree.Prefix():
                    return _prefix(node, scope)
                case tree.Infix():
                    return _infix(node, scope)
                case tree.Compare():
                    return _compare(node, scope)
                case tree.Arithmetic():
                    return _arithmetic(node, scope)
                case tree.Minus(operand):
                    inside = number(operand, scope)
                    if inside is None:
                        return None
                    return NumberByCases(
                        tuple((when, opposite(linear)) for when, linear in inside.cases)
                    )
                case tree.Conditional(value, condition, otherwise):
                    first, test = elaborate(value, scope), truth(condition, scope)
                    return _either(node, first, test, elaborate(otherwise, scope), scope)
                case tree.Aggregate():
                    return aggregate(node, scope, truth)
        except TooManyCasesError:
            scope.report(say.too_many_cases(node))
            return None


def _name(node: tree.AtomUse, scope: Scope) -> Meaning | None:
    name = node.name.text
    relation = scope.relations.get(name)
    if relation is None and name in scope.variables:
        scope.used.add(name)
        if node.arguments:
            scope.report(constant_messages.object_as_relation(node, scope))
            return None
        return Object(scope.variables[name].actual)
    if isinstance(relation, AnyArgument):
        scope.used.add(name)
        scope.used |= {argument.text for argument in node.arguments}
        return relation
    if relation is not None:
        scope.used.add(name)
        node = replace(node, name=replace(node.name, text=relation))
        name = relation
    kind = scope.constants.overlay.kind_of(name)
    if kind and node.arguments and kind != "definition":
        scope.report(constant_messages.takes_no_object(node, kind, scope))
        return None
    if kind == "option":
        return ltl.Constant(scope.constants.options[name])
    if kind == "parameter":
        return parameter(node, scope, number)
    if kind == "definition":
        return expand_macro(node, scope, elaborate)
    result = scope.reference(node)
    if isinstance(result, ltl.QuantityTerm):
        unit = scope.symbols.unit_of(result.name)
        if unit is None:
            return None
        return measured(result, unit.factor, unit.dimension, term_text(result))
    return result


def _prefix(node: tree.Prefix, scope: Scope) -> ltl.Formula | None:
    operand = truth(node.operand, scope)
    bound = bound_of(node, node.bound, scope, number)
    if _out_of_place(node, node.operator, scope) or operand is None or bound is False:
        return None
    written = isinstance(node.operand, tree.TruthLiteral)
    if node.operator == "not" and isinstance(operand, ltl.Constant) and not written:
        return negated(operand)
    return ltl.Unary(ltl.UnaryOperator(node.operator), operand, bound)


def _infix(node: tree.Infix, scope: Scope) -> ltl.Formula | None:
    left, right = truth(node.left, scope), truth(node.right, scope)
    bound = bound_of(node, node.bound, scope, number)
    if node.operator == "then" and isinstance(node.left, tree.Prefix):
        for warning in _endless_phase(node.left):
            scope.report(warning)
    misplaced = _out_of_place(node, node.operator, scope)
    if misplaced or left is None or right is None or bound is False:
        return None
    return ltl.Binary(ltl.BinaryOperator(node.operator), left, right, bound)


def _out_of_place(node: tree.Prefix | tree.Infix, operator: str, scope: Scope) -> bool:
    if operator in _TEMPORAL and scope.in_moment:
        scope.report(say.temporal_in_count(node))
        return True
    return False


def _endless_phase(phase: tree.Prefix) -> Iterator[Diagnostic]:
    """Report a phase without end before ``then``.

    ``never p then q`` means ``never (p then q)``, and ``never p`` has no end.
    """
    if phase.operator in ("always", "never", "eventually") and not phase.grouped:
        yield say.endless_phase(phase)


def _compare(node: tree.Compare, scope: Scope) -> ltl.Formula | AnyArgument | None:
    for side, other in ((node.left, node.right), (node.right, node.left)):
        if isinstance(side, tree.AtomUse) and (item := scope.enumeration(side)) is not None:
            scope.used |= {argument.text for argument in side.arguments}
            scope.report(say.values_compared(node, side, item, other, scope))
            return None
    left, right = elaborate(node.left, scope), elaborate(node.right, scope)
    if isinstance(left, Object) and isinstance(right, Object):
        return _same(node, left, right, scope)
    if isinstance(left, AnyArgument) or isinstance(right, AnyArgument):
        return AnyArgument()
    if isinstance(left, ltl.Formula) and isinstance(right, ltl.Formula):
        scope.report(say.truths_compared(node, scope))
        return None
    first = _as_number(node.left, left, node, scope)
    second = _as_number(node.right, right, node, scope)
    if first is None or second is None:
        return None
    if not _fit(node, first, second, scope):
        return None
    return _checked(compared(first, node.relation, second))


def _checked(formula: ltl.Formula) -> ltl.Formula:
    """The formula. Raises TooManyCasesError: conditions have doubled its parts too often."""
    if exceeded_limit(formula):
        raise TooManyCasesError
    return formula


def _as_number(
    node: tree.Formula, meaning: Meaning | None, around: tree.Compare, scope: Scope
) -> NumberByCases | None:
    if meaning is None or isinstance(meaning, NumberByCases):
        return meaning
    scope.report(say.not_comparable(node, meaning, around, scope))
    return None


def _same(node: tree.Compare, left: Object, right: Object, scope: Scope) -> ltl.Formula | None:
    if node.relation not in ("=", "!="):
        scope.report(say.objects_have_no_order(node))
        return None
    if left.name == right.name:
        same: ltl.Formula = ltl.Constant(True)
    elif {left.name, right.name} & scope.counted:
        same = ltl.Same(*sorted((left.name, right.name)))
    else:
        # The variables of a rule stand for distinct objects.
        same = ltl.Constant(False)
    return same if node.relation == "=" else negated(same)


def _fit(node: tree.Formula, left: NumberByCases, right: NumberByCases, scope: Scope) -> bool:
    one, other = left.dimension, right.dimension
    if one is None or other is None or one == other:
        return True
    assert isinstance(node, tree.Compare | tree.Arithmetic | tree.Conditional), "these have sides"
    scope.report(say.two_dimensions(node, left, right, scope))
    return False


def _arithmetic(node: tree.Arithmetic, scope: Scope) -> NumberByCases | None:
    left, right = number(node.left, scope), number(node.right, scope)
    if left is None or right is None:
        return None
    match node.operator:
        case "+" | "-":
            if not _fit(node, left, right, scope):
                return None
            sign = 1 if node.operator == "+" else -1
            return combined(left, right, lambda one, other: added(one, other, sign))
        case "*":
            if _varies(left) and _varies(right):
                scope.report(say.not_linear(node))
                return None
            return combined(left, right, _product)
        case _:
            if _varies(right):
                scope.report(say.not_linear(node))
                return None
            if any(linear.constant == 0 for _, linear in right.cases):
                scope.report(say.divided_by_zero(node))
                return None
            return combined(left, right, divided)


def _varies(value: NumberByCases) -> bool:
    return any(linear.coefficients for _, linear in value.cases)


def _product(left: Linear, right: Linear) -> Linear:
    if right.coefficients:
        return scaled(right, left, first=True)
    return scaled(left, right, first=False)


def _either(
    node: tree.Conditional,
    value: Meaning | None,
    condition: ltl.Formula | None,
    otherwise: Meaning | None,
    scope: Scope,
) -> Meaning | None:
    if value is None or condition is None or otherwise is None:
        return None
    if isinstance(value, AnyArgument) or isinstance(otherwise, AnyArgument):
        return AnyArgument()
    if isinstance(value, NumberByCases) and isinstance(otherwise, NumberByCases):
        return either(condition, value, otherwise) if _fit(node, value, otherwise, scope) else None
    if isinstance(value, Object | NumberByCases) or isinstance(otherwise, Object | NumberByCases):
        scope.report(say.two_kinds(node, value, otherwise, scope))
        return None
    chosen = ltl.Binary(ltl.BinaryOperator.AND, condition, value)
    other = ltl.Binary(ltl.BinaryOperator.AND, negated(condition), otherwise)
    return _checked(ltl.Binary(ltl.BinaryOperator.OR, chosen, other))
