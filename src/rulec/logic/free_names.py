"""Free variables, declarations and inputs of formulas; substitution of variables."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache

from rulec.logic import formula as ltl
from rulec.logic.linear_comparison import comparison


def variables_of(part: ltl.Formula | ltl.Term) -> Iterator[str]:
    """The free variables from left to right, with repetitions."""
    match part:
        case ltl.Atom(_, arguments) | ltl.QuantityTerm(_, arguments):
            yield from arguments
        case ltl.Same(left, right):
            yield from (left, right)
        case ltl.Count(variable, _, body):
            yield from (name for name in variables_of(body) if name != variable)
        case ltl.Comparison(terms):
            for _, term in terms:
                yield from variables_of(term)
        case ltl.Unary(_, operand):
            yield from variables_of(operand)
        case ltl.Binary(_, left, right):
            yield from variables_of(left)
            yield from variables_of(right)
        case ltl.Constant():
            return


def names_in(part: ltl.Formula | ltl.Term) -> Iterator[str]:
    """The declarations that are read, from left to right, with repetitions."""
    match part:
        case ltl.Atom(name) | ltl.QuantityTerm(name):
            yield name
        case ltl.Count(_, _, body):
            yield from names_in(body)
        case ltl.Comparison(terms):
            for _, term in terms:
                yield from names_in(term)
        case ltl.Unary(_, operand):
            yield from names_in(operand)
        case ltl.Binary(_, left, right):
            yield from names_in(left)
            yield from names_in(right)
        case ltl.Constant() | ltl.Same():
            return


@lru_cache(maxsize=1 << 14)
def names_of(formula: ltl.Formula) -> frozenset[str]:
    """The declarations that are read; remembered, since each rule is asked with each fact."""
    return frozenset(names_in(formula))


def reads_in(formula: ltl.Formula) -> Iterator[ltl.Atom | ltl.Term]:
    """The atoms and what comparisons add up, from left to right, with repetitions."""
    for proposition in ltl.atoms_of(formula):
        if isinstance(proposition, ltl.Atom):
            yield proposition
        else:
            yield from (term for _, term in proposition.terms)


def rename_variables(formula: ltl.Formula, names: Mapping[str, str]) -> ltl.Formula:
    """Rename all free variables of a formula at once.

    Those not in ``names`` stay.

    Different variables keep different names, and no count inside has a new name for its variable.
    """
    match formula:
        case ltl.Atom():
            return replace(formula, arguments=_renamed(formula.arguments, names))
        case ltl.Comparison(terms, relation, limit, text):
            # Other names may come in another order.
            return comparison(
                {_renamed_term(term, names): factor for factor, term in terms},
                relation,
                limit,
                _ARGUMENT.sub(lambda match: match[1] + names.get(match[2], match[2]), text),
            )
        case ltl.Same(left, right):
            return ltl.Same(*_renamed((left, right), names))
        case ltl.Constant():
            return formula
        case ltl.Unary(_, operand):
            return replace(formula, operand=rename_variables(operand, names))
        case ltl.Binary(_, left, right):
            return replace(
                formula, left=rename_variables(left, names), right=rename_variables(right, names)
            )


_ARGUMENT = re.compile(r"([(,]\s*)(\w+)(?=\s*[,)])")


def _renamed_term(term: ltl.Term, names: Mapping[str, str]) -> ltl.Term:
    match term:
        case ltl.QuantityTerm(name, arguments):
            return ltl.QuantityTerm(name, _renamed(arguments, names))
        case ltl.Count(variable, kind, body):
            free = {old: new for old, new in names.items() if old != variable}
            return ltl.Count(variable, kind, rename_variables(body, free))


def _renamed(arguments: tuple[str, ...], names: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(names.get(argument, argument) for argument in arguments)


def required_inputs(
    formula: ltl.Formula, objects: Mapping[str, str], fits: Callable[[str, str], bool]
) -> Iterator[ltl.Atom | ltl.QuantityTerm]:
    """Every atom and quantity that a formula reads, with repetitions.

    Those of every object that may count are included.

    ``objects`` maps those that are there to their types; ``fits`` tells whether the first of two
    types is the second or one below it.
    """
    return _inputs(formula, objects, fits, {})


def _inputs(
    formula: ltl.Formula,
    objects: Mapping[str, str],
    fits: Callable[[str, str], bool],
    names: Mapping[str, str],
) -> Iterator[ltl.Atom | ltl.QuantityTerm]:
    """The inputs of a formula in which variables stand for these names."""
    for read in reads_in(formula):
        if not isinstance(read, ltl.Count):
            yield replace(read, arguments=_renamed(read.arguments, names)) if names else read
            continue
        for name, kind in objects.items():
            if fits(kind, read.type):
                # What is asked of the object that stands in the count's place.
                yield from _inputs(read.body, objects, fits, {**names, read.variable: name})
