"""Free variables and declarations of formulas and terms."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.logic.formula import (
    Atom,
    Binary,
    Comparison,
    Constant,
    Count,
    Formula,
    QuantityTerm,
    Same,
    Term,
    Unary,
)


def variables_of(what: Formula | Term) -> Iterator[str]:
    """The free variables from left to right, with repetitions."""
    match what:
        case Atom(_, arguments) | QuantityTerm(_, arguments):
            yield from arguments
        case Same(left, right):
            yield from (left, right)
        case Count(variable, _, body):
            yield from (name for name in variables_of(body) if name != variable)
        case Comparison(terms):
            for _, term in terms:
                yield from variables_of(term)
        case Unary(_, operand):
            yield from variables_of(operand)
        case Binary(_, left, right):
            yield from variables_of(left)
            yield from variables_of(right)
        case Constant():
            return


def names_in(what: Formula | Term) -> Iterator[str]:
    """The declarations that are read, from left to right, with repetitions."""
    match what:
        case Atom(name) | QuantityTerm(name):
            yield name
        case Count(_, _, body):
            yield from names_in(body)
        case Comparison(terms):
            for _, term in terms:
                yield from names_in(term)
        case Unary(_, operand):
            yield from names_in(operand)
        case Binary(_, left, right):
            yield from names_in(left)
            yield from names_in(right)
        case Constant() | Same():
            return
