"""Checks of a compiled formula against its vocabulary and its variables."""

from __future__ import annotations

from collections.abc import Iterator, Set

from rulec.logic import formula as ltl
from rulec.logic.bounds import BOOLEAN
from rulec.logic.printing import term_text
from rulec.vocabulary import Enumeration, Signal, Vocabulary
from rulec.vocabulary import Quantity as DeclaredQuantity


def problem_in(formula: ltl.Formula, vocabulary: Vocabulary, variables: Set[str]) -> str | None:
    """First problem of a formula as a clause; None if sound."""
    return next(_problems(formula, vocabulary, variables, counted=False), None)


def _problems(
    formula: ltl.Formula, vocabulary: Vocabulary, variables: Set[str], *, counted: bool
) -> Iterator[str]:
    """Problems of a formula; ``counted`` says that it is a count's body."""
    waiting = [formula]
    while waiting:
        match waiting.pop():
            case ltl.Atom() as atom:
                if not _is_known(atom, vocabulary, variables):
                    yield f"speaks of `{atom}`, which its vocabulary lacks"
            case ltl.Comparison(terms) as comparison:
                if not _is_normal(comparison):
                    yield "compares numbers that are not in their normal form"
                for _, term in terms:
                    yield from _problems_of_term(term, vocabulary, variables)
            case ltl.Same(left, right):
                if not counted or not {left, right} <= variables:
                    yield "asks for the same object where there is none to compare"
            case ltl.Unary() | ltl.Binary() as operation:
                if counted and operation.operator not in BOOLEAN:
                    yield "counts objects by what they do at other instants"
                if isinstance(operation, ltl.Unary):
                    waiting.append(operation.operand)
                else:
                    waiting += [operation.right, operation.left]
            case ltl.Constant():
                pass


def _is_known(atom: ltl.Atom, vocabulary: Vocabulary, variables: Set[str]) -> bool:
    declaration = vocabulary.declarations.get(atom.name)
    match declaration:
        case Enumeration(values=values):
            known = atom.value in values
        case Signal():
            known = atom.value is None
        case _:
            return False
    about = len(declaration.parameters) == len(atom.arguments)
    return known and about and set(atom.arguments) <= variables


def _is_normal(comparison: ltl.Comparison) -> bool:
    coefficients = [coefficient for coefficient, _ in comparison.terms]
    texts = [term_text(term) for _, term in comparison.terms]
    return (
        len(texts) > 0
        and coefficients[0] == 1
        and 0 not in coefficients
        and texts == sorted(texts)
        and len({term for _, term in comparison.terms}) == len(texts)
    )


def _problems_of_term(term: ltl.Term, vocabulary: Vocabulary, variables: Set[str]) -> Iterator[str]:
    match term:
        case ltl.QuantityTerm(name, arguments):
            declaration = vocabulary.declarations.get(name)
            if (
                not isinstance(declaration, DeclaredQuantity)
                or len(declaration.parameters) != len(arguments)
                or not set(arguments) <= variables
            ):
                yield f"speaks of the quantity `{term_text(term)}`, which its vocabulary lacks"
        case ltl.Count(variable, type_name, body):
            if type_name not in vocabulary.types:
                yield f"counts objects of the unknown type `{type_name}`"
            yield from _problems(body, vocabulary, variables | {variable}, counted=True)
