"""Checks of the formulas of a compiled rulebook's file."""

from __future__ import annotations

from collections.abc import Set

from rulec.automata.bundle.clocked_entries import require
from rulec.logic import formula as ltl
from rulec.logic.bounds import BOOLEAN
from rulec.logic.free_names import terms_of
from rulec.logic.printing import term_text
from rulec.vocabulary import Enumeration, Quantity, Signal, Vocabulary


def check_formula(
    formula: ltl.Formula,
    vocabulary: Vocabulary,
    variables: Set[str],
    of: str,
    *,
    counted: bool,
    is_meaning: bool = False,
) -> None:
    """Check a formula; ``counted`` means that it is the body of a count.

    What is calculated in the meaning of a word is no word of its own.
    """
    waiting = [formula]
    while waiting:
        match waiting.pop():
            case ltl.Calculated(arguments=arguments) as calculated if is_meaning:
                require(set(arguments) <= variables, f"{of} speaks of unknown variables")
                _check_calculated(calculated, vocabulary, of, is_meaning=True)
            case ltl.Atom() as atom:
                known = _is_known(atom, vocabulary, variables)
                require(known, f"{of} uses `{atom}`, which its vocabulary lacks")
                if isinstance(atom, ltl.Calculated):
                    _check_calculated(atom, vocabulary, of)
            case ltl.Comparison(terms) as comparison:
                normal = _is_normal(comparison)
                require(normal, f"{of} compares numbers that are not in their normal form")
                for _, term in terms:
                    _check_term(term, vocabulary, variables, of, is_meaning)
            case ltl.Same(left, right):
                comparable = counted and {left, right} <= variables
                require(
                    comparable, f"{of} compares unknown variables, or compares outside of a count"
                )
            case ltl.Unary() | ltl.Binary() as operation:
                now = not counted or operation.operator in BOOLEAN
                require(now, f"{of} counts objects by what holds at other instants")
                if isinstance(operation, ltl.Unary):
                    waiting.append(operation.operand)
                else:
                    waiting += [operation.right, operation.left]


def _check_calculated(
    calculated: ltl.Calculated, vocabulary: Vocabulary, of: str, *, is_meaning: bool = False
) -> None:
    places = {f"x{place}" for place in range(1, len(calculated.arguments) + 1)}
    for term in terms_of(calculated.number):
        _check_term(term, vocabulary, places, of, is_meaning)


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


def _check_term(
    term: ltl.Term, vocabulary: Vocabulary, variables: Set[str], of: str, is_meaning: bool
) -> None:
    match term:
        case ltl.QuantityTerm(name, arguments):
            declared = vocabulary.declarations.get(name)
            require(
                isinstance(declared, Quantity)
                and len(declared.parameters) == len(arguments)
                and set(arguments) <= variables,
                f"{of} speaks of the quantity `{term_text(term)}`, which its vocabulary lacks",
            )
        case ltl.Count(variable, type_name, body):
            known = type_name in vocabulary.types
            require(known, f"{of} counts objects of the unknown type `{type_name}`")
            inside = variables | {variable}
            check_formula(body, vocabulary, inside, of, counted=True, is_meaning=is_meaning)
