"""Free variables and declarations of formulas and terms."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.logic import formula as ltl


def variables_of(what: ltl.Formula | ltl.Term) -> Iterator[str]:
    """The free variables from left to right, with repetitions."""
    match what:
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


def names_in(what: ltl.Formula | ltl.Term) -> Iterator[str]:
    """The declarations that are read, from left to right, with repetitions."""
    match what:
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
