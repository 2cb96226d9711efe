"""``some``, ``every`` and ``count`` over the objects of the moment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

from rulec.logic import formula as ltl
from rulec.logic.printing import formula_text, term_text
from rulec.rulebook.arithmetic import linear_arithmetic as numbers
from rulec.rulebook.arithmetic.size_limits import exceeded_limit
from rulec.rulebook.elaborate.rule_messages import unused_variable
from rulec.rulebook.elaborate.scope import BoundVariable, Scope
from rulec.rulebook.names.declaration_messages import twice
from rulec.syntax import tree
from rulec.vocabulary.units import DIMENSIONS

_ONE = numbers.constant(Fraction(1), DIMENSIONS["number"], "1")


def aggregate(
    node: tree.Aggregate, scope: Scope, truth: Callable[[tree.Formula, Scope], ltl.Formula | None]
) -> ltl.Formula | numbers.NumberByCases | None:
    """Elaborate a count, ``some`` or ``every``; None after a mistake.

    ``truth`` gives the formula that the body means. Raises TooManyCasesError for a body that has
    grown too large.
    """
    name, kind = node.variable.name, node.variable.type
    assert kind is not None, "the grammar asks for a type"
    known_type = scope.symbols.known_type(kind, scope.report)
    if name.text in scope.variables:
        scope.report(twice("variable", name, scope.variables[name.text].span))
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
    if exceeded_limit(body):
        raise numbers.TooManyCasesError
    every = node.kind == "every"
    term = ltl.Count(actual, known_type, numbers.negated(body) if every else body)
    count = numbers.measured(term, Fraction(1), DIMENSIONS["number"], term_text(term))
    if node.kind == "count":
        return count
    comparison = numbers.compared(count, "<" if every else ">=", _ONE)
    assert isinstance(comparison, ltl.Comparison), "a count varies"
    return replace(comparison, text=f"{node.kind} {actual}: {known_type} ({formula_text(body)})")
