"""Elaboration of expressions into formulas and numbers, with type checks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

from rulec.logic import formula as ltl
from rulec.logic.formula import negated
from rulec.logic.printing import formula_text, term_text
from rulec.rulebook.arithmetic import linear_arithmetic as numbers
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases, TooManyCasesError
from rulec.rulebook.arithmetic.size_limits import exceeded_limit
from rulec.rulebook.elaborate import constant_messages
from rulec.rulebook.elaborate import elaboration_messages as say
from rulec.rulebook.elaborate.amounts import bound_of, literal
from rulec.rulebook.elaborate.dimension_messages import bare_beside_share, two_dimensions
from rulec.rulebook.elaborate.macro_expansion import expand_macro, parameter_value
from rulec.rulebook.elaborate.rule_messages import unused_variable
from rulec.rulebook.elaborate.scope import AnyArgument, BoundVariable, Scope
from rulec.rulebook.names.declaration_messages import twice
from rulec.syntax import tree
from rulec.syntax.keywords import BINDS_NARROWLY, OF_ONE_STATE
from rulec.vocabulary.dimensions import DIMENSIONS

_ONE = numbers.constant(Fraction(1), DIMENSIONS["number"], "1")


@dataclass(frozen=True, slots=True)
class Object:
    """An object, by the actual name of its variable."""

    name: str


Meaning = ltl.Formula | NumberByCases | Object | AnyArgument


def truth(node: tree.Formula, scope: Scope) -> ltl.Formula | None:
    """The formula; None if it has a mistake, which is then reported."""
    meaning = elaborate(node, scope)
    match meaning:
        case AnyArgument():
            return ltl.Constant(True)
        case NumberByCases():
            scope.report(say.number_for_truth(node, meaning, scope))
            return None
        case Object():
            scope.report(say.object_for_truth(node, scope))
            return None
        case _:
            return meaning


def number(node: tree.Formula, scope: Scope) -> NumberByCases | None:
    """The number; None if it has a mistake, which is then reported."""
    return _as_number(node, elaborate(node, scope), scope)


def _as_number(
    node: tree.Formula, meaning: Meaning | None, scope: Scope, around: tree.Compare | None = None
) -> NumberByCases | None:
    if meaning is None or isinstance(meaning, NumberByCases):
        return meaning
    if not isinstance(meaning, AnyArgument):
        scope.report(say.no_number(node, meaning, scope, around))
    return None


def elaborate(node: tree.Formula, scope: Scope) -> Meaning | None:
    """Elaborate an expression; None if it has a reported mistake.

    Raises OverLimitError: with its definitions put in it is too deep or too large.
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
                    return None if inside is None else numbers.opposite(inside)
                case tree.Conditional(value, condition, otherwise):
                    first, test = elaborate(value, scope), truth(condition, scope)
                    return _either(node, first, test, elaborate(otherwise, scope), scope)
                case tree.Aggregate():
                    return _aggregate(node, scope)
        except TooManyCasesError:
            scope.report(say.too_many_cases(node))
            return None


def _name(node: tree.AtomUse, scope: Scope) -> Meaning | None:
    name = node.name.text
    relation = scope.relations.get(name)
    if relation is not None or name in scope.variables:
        scope.used.add(name)
    if isinstance(relation, AnyArgument):
        scope.used |= {argument.text for argument in node.arguments}
        return relation
    if relation is not None:
        node = replace(node, name=replace(node.name, text=relation))
        name = relation
    elif name in scope.variables:
        if not node.arguments:
            return Object(scope.variables[name].actual)
        scope.report(constant_messages.object_as_relation(node, scope))
        return None
    kind = scope.constants.overlay.kind_of(name)
    if kind and node.arguments and kind != "definition":
        scope.report_wrong_arity(node, constant_messages.takes_no_object(node, kind, scope))
        return None
    if kind == "option":
        return ltl.Constant(scope.constants.overlay.options[name])
    if kind == "parameter":
        return parameter_value(node, scope, number)
    if kind == "definition":
        return expand_macro(node, scope, elaborate)
    result = scope.reference(node)
    if not isinstance(result, ltl.QuantityTerm):
        return result
    unit = scope.symbols.unit_of(result.name)
    if unit is None:
        return None
    return numbers.measured(result, unit, term_text(result))


def _prefix(node: tree.Prefix, scope: Scope) -> ltl.Formula | None:
    operand = truth(node.operand, scope)
    bound = bound_of(node, scope, number)
    if _out_of_place(node, scope) or operand is None or bound is False:
        return None
    written = isinstance(node.operand, tree.TruthLiteral)
    if node.operator == "not" and isinstance(operand, ltl.Constant) and not written:
        return negated(operand)
    return ltl.Unary(ltl.UnaryOperator(node.operator), operand, bound)


def _infix(node: tree.Infix, scope: Scope) -> ltl.Formula | None:
    left, right = truth(node.left, scope), truth(node.right, scope)
    bound = bound_of(node, scope, number)
    phase = node.left if node.operator == "then" else None
    if isinstance(phase, tree.Prefix) and phase.operator in BINDS_NARROWLY and not phase.grouped:
        # `never p then q` means `never (p then q)`, and `never p` has no end.
        scope.report(say.endless_phase(phase, node))
    if _out_of_place(node, scope) or left is None or right is None or bound is False:
        return None
    return ltl.Binary(ltl.BinaryOperator(node.operator), left, right, bound)


def _out_of_place(node: tree.Prefix | tree.Infix, scope: Scope) -> bool:
    """Whether a temporal operator is used where only one state is considered; if so, report it."""
    misplaced = scope.in_moment and node.operator not in OF_ONE_STATE
    if misplaced:
        scope.report(say.temporal_in_count(node))
    return misplaced


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
    first = _as_number(node.left, left, scope, node)
    second = _as_number(node.right, right, scope, node)
    if first is None or second is None or not _fit(node, first, second, scope):
        return None
    return _checked(numbers.compared(first, node.relation, second))


def _checked(formula: ltl.Formula) -> ltl.Formula:
    """The formula. Raises TooManyCasesError if conditions have multiplied its parts too often."""
    if exceeded_limit(formula):
        raise TooManyCasesError
    return formula


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


def _fit(
    node: tree.Compare | tree.Arithmetic | tree.Conditional,
    left: NumberByCases,
    right: NumberByCases,
    scope: Scope,
) -> bool:
    """Whether two numbers have the same dimension; if not, report it.

    Beside a share, such as a quantity in %, a number without a unit is of another kind.
    """
    share = (left.is_bare and right.share) or (right.is_bare and left.share)
    if share:
        scope.report(bare_beside_share(node, left, share, scope))
        return False
    if left.dimension is None or right.dimension in (None, left.dimension):
        return True
    scope.report(two_dimensions(node, left, right, scope))
    return False


def _arithmetic(node: tree.Arithmetic, scope: Scope) -> NumberByCases | None:
    left, right = number(node.left, scope), number(node.right, scope)
    if left is None or right is None:
        return None
    if node.operator in ("+", "-"):
        if not _fit(node, left, right, scope):
            return None
        sign = 1 if node.operator == "+" else -1
        return numbers.combined(left, right, partial(numbers.added, sign=sign))
    if node.operator == "*":
        return numbers.combined(left, right, numbers.multiplied)
    if any(not linear.coefficients and linear.constant == 0 for _, linear in right.cases):
        scope.report(say.divided_by_zero(node))
        return None
    return numbers.combined(left, right, numbers.divided)


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
        fit = _fit(node, value, otherwise, scope)
        return numbers.either(condition, value, otherwise) if fit else None
    if isinstance(value, Object | NumberByCases) or isinstance(otherwise, Object | NumberByCases):
        scope.report(say.two_kinds(node, value, otherwise, scope))
        return None
    sides = ((condition, value), (negated(condition), otherwise))
    first, second = (ltl.Binary(ltl.BinaryOperator.AND, test, side) for test, side in sides)
    return _checked(ltl.Binary(ltl.BinaryOperator.OR, first, second))


def _aggregate(node: tree.Aggregate, scope: Scope) -> ltl.Formula | NumberByCases | None:
    name, kind = node.variable.name, node.variable.type
    assert kind is not None, "the grammar asks for a type"
    known_type = scope.symbols.known_type(kind, scope.report)
    if name.text in scope.variables:
        again = twice("variable", name, scope.variables[name.text].span)
        # Whoever changes its name has to change all its uses.
        scope.report(replace(again, offers=()))
        return None
    actual, number = name.text, 2
    while actual in scope.taken:
        actual, number = f"{name.text}_{number}", number + 1
    variable = BoundVariable(known_type, node.variable.span, actual)
    inner = replace(
        scope,
        variables={**scope.variables, name.text: variable},
        counted=scope.counted | {actual},
        taken=scope.taken | {actual},
        in_moment=True,
        used=set(),
    )
    body = truth(node.body, inner)
    if body is not None and name.text not in inner.used:
        scope.report(unused_variable(node.variable, node))
    scope.used |= inner.used - {name.text}
    if body is None or known_type is None:
        return None
    every = node.kind == "every"
    term = ltl.Count(actual, known_type, negated(_checked(body)) if every else _checked(body))
    count = numbers.counted(term, term_text(term))
    if node.kind == "count":
        return count
    comparison = numbers.compared(count, "<" if every else ">=", _ONE)
    assert isinstance(comparison, ltl.Comparison), "a count varies"
    return replace(comparison, text=f"{node.kind} {actual}: {known_type} ({formula_text(body)})")
