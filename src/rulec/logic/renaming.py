"""Formulas with other variables."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from rulec.logic import formula as ltl
from rulec.logic.linear_comparison import comparison


def rename_variables(formula: ltl.Formula, names: Mapping[str, str]) -> ltl.Formula:
    """Rename all free variables of a formula at once.

    Those not in ``names`` stay.

    Different variables keep different names, and no count inside has a new name for its variable.
    """
    match formula:
        case ltl.Atom():
            return replace(formula, arguments=_each(formula.arguments, names))
        case ltl.Comparison(terms, relation, limit, text):
            # Other names may come in another order.
            return comparison(
                {_term(term, names): factor for factor, term in terms},
                relation,
                limit,
                _ARGUMENT.sub(lambda found: found[1] + names.get(found[2], found[2]), text),
            )
        case ltl.Same(left, right):
            return ltl.Same(*_each((left, right), names))
        case ltl.Constant():
            return formula
        case ltl.Unary(_, operand):
            return replace(formula, operand=rename_variables(operand, names))
        case ltl.Binary(_, left, right):
            return replace(
                formula, left=rename_variables(left, names), right=rename_variables(right, names)
            )


_ARGUMENT = re.compile(r"([(,]\s*)(\w+)(?=\s*[,)])")


def _term(term: ltl.Term, names: Mapping[str, str]) -> ltl.Term:
    match term:
        case ltl.QuantityTerm(name, arguments):
            return ltl.QuantityTerm(name, _each(arguments, names))
        case ltl.Count(variable, kind, body):
            free = {old: new for old, new in names.items() if old != variable}
            return ltl.Count(variable, kind, rename_variables(body, free))


def _each(arguments: tuple[str, ...], names: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(names.get(argument, argument) for argument in arguments)
