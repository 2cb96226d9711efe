"""``some``, ``every`` and ``count`` over the objects of the moment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

from rulec.logic.formula import Comparison, Count, Formula, Relation
from rulec.logic.printing import formula_text, term_text
from rulec.rulebook.arithmetic.linear_arithmetic import (
    NumberByCases,
    TooManyCasesError,
    compared,
    constant,
    measured,
    negated,
)
from rulec.rulebook.arithmetic.size_limits import exceeded_limit
from rulec.rulebook.elaborate import elaboration_messages as say
from rulec.rulebook.elaborate.scope import BoundVariable, Scope
from rulec.rulebook.names.declaration_messages import twice, unknown_type
from rulec.syntax import tree
from rulec.vocabulary.units import DIMENSIONS

_ONE = Fraction(1)


def aggregate(
    node: tree.Aggregate, scope: Scope, truth: Callable[[tree.Formula, Scope], Formula | None]
) -> Formula | NumberByCases | None:
    """Elaborate a count, ``some`` or ``every``; None after a mistake.

    ``truth`` gives the formula that the body means. Raises TooManyCasesError for a body that has
    grown too large.
    """
    name, kind = node.variable.name, node.variable.type
    assert kind is not None, "the grammar asks for a type"
    known = kind.text in scope.symbols.types
    if not known and not scope.symbols.may_know_type(kind.text):
        scope.report(unknown_type(kind, list(scope.symbols.types)))
    if name.text in scope.variables:
        scope.report(twice("variable", name, scope.variables[name.text].span))
        return None
    inner = _with_counted(node, scope, kind.text if known else None)
    body = truth(node.body, inner)
    if body is not None and name.text not in inner.used:
        scope.report(say.unused_variable(node))
    scope.used |= inner.used - {name.text}
    if body is None or not known:
        return None
    if exceeded_limit(body):
        raise TooManyCasesError
    term = Count(
        inner.variables[name.text].actual,
        kind.text,
        negated(body) if node.kind == "every" else body,
    )
    count = measured(term, _ONE, DIMENSIONS["number"], term_text(term))
    if node.kind == "count":
        return count
    relation: Relation = "<" if node.kind == "every" else ">="
    comparison = compared(count, relation, constant(_ONE, DIMENSIONS["number"], "1"))
    assert isinstance(comparison, Comparison), "a count varies"
    return replace(
        comparison, text=f"{node.kind} {term.variable}: {kind.text} ({formula_text(body)})"
    )


def _with_counted(node: tree.Aggregate, scope: Scope, kind: str | None) -> Scope:
    """Scope of the body, in which the counted variable is bound."""
    written = node.variable.name.text
    actual, number = written, 2
    while actual in scope.taken:
        actual, number = f"{written}_{number}", number + 1
    variable = BoundVariable(kind, node.variable.span, actual)
    return replace(
        scope,
        variables={**scope.variables, written: variable},
        counted=scope.counted | {actual},
        taken=scope.taken | {actual},
        in_moment=True,
        used=set(),
    )
