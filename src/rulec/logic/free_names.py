"""Free variables, declarations and inputs of formulas; substitution of variables."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache

from rulec.logic import formula as ltl
from rulec.logic.formula import operands_of
from rulec.logic.linear_comparison import comparison
from rulec.logic.printing import term_text


def variables_of(part: ltl.Formula | ltl.Term) -> Iterator[str]:
    """The free variables, from left to right, with repetitions."""
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
        case _:
            for operand in operands_of(part):
                yield from variables_of(operand)


def names_in(part: ltl.Formula | ltl.Term) -> Iterator[str]:
    """The names of the declarations that are read, from left to right, with repetitions."""
    match part:
        case ltl.Calculated(number=number):
            for term in terms_of(number):
                yield from names_in(term)
        case ltl.Atom(name) | ltl.QuantityTerm(name):
            yield name
        case ltl.Count(_, _, body):
            yield from names_in(body)
        case ltl.Comparison(terms):
            for _, term in terms:
                yield from names_in(term)
        case _:
            for operand in operands_of(part):
                yield from names_in(operand)


@lru_cache(maxsize=1 << 14)
def names_of(formula: ltl.Formula) -> frozenset[str]:
    """The names of the declarations read; cached, since each rule is matched with each fact."""
    return frozenset(names_in(formula))


def terms_of(number: ltl.NumberSum) -> Iterator[ltl.Term]:
    """The quantities and counts in a number, from left to right, with repetitions."""
    for _, part in number.parts:
        if isinstance(part, ltl.Operation):
            yield from terms_of(part.left)
            yield from terms_of(part.right)
        else:
            yield part


def reads_in(formula: ltl.Formula) -> Iterator[ltl.Atom | ltl.Term]:
    """The atoms and the terms of comparisons, from left to right, with repetitions."""
    for proposition in ltl.atoms_of(formula):
        if isinstance(proposition, ltl.Calculated):
            names = {f"x{place}": name for place, name in enumerate(proposition.arguments, 1)}
            yield from (renamed_term(term, names) for term in terms_of(proposition.number))
        elif isinstance(proposition, ltl.Atom):
            yield proposition
        else:
            yield from (term for _, term in proposition.terms)


def rename_variables(formula: ltl.Formula, names: Mapping[str, str]) -> ltl.Formula:
    """Rename all free variables of a formula at once.

    Variables that are not in ``names`` stay. No new name may be the variable of a count inside the
    formula.
    """
    match formula:
        case ltl.Atom():
            return replace(formula, arguments=_renamed(formula.arguments, names))
        case ltl.Comparison(terms, relation, limit, text):
            # The new names may change the order of the terms, and one that two variables get may
            # make terms equal.
            coefficients: dict[ltl.Term, Fraction] = {}
            for factor, term in terms:
                renamed = renamed_term(term, names)
                coefficients[renamed] = coefficients.get(renamed, Fraction(0)) + factor
            return comparison(
                {term: factor for term, factor in coefficients.items() if factor},
                relation,
                limit,
                ltl.with_arguments(text, names),
            )
        case ltl.Same(left, right):
            return ltl.Same(*_renamed((left, right), names))
        case ltl.Constant():
            return formula
        case ltl.Unary() | ltl.Binary():
            return ltl.with_operands(formula, lambda operand: rename_variables(operand, names))


def renamed_term(term: ltl.Term, names: Mapping[str, str]) -> ltl.Term:
    """The term with other variables, as ``rename_variables``."""
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

    Those of every object that a count may include are part of this. ``objects`` maps the present
    objects to their types; ``fits`` returns whether its first type is its second type or a subtype.
    """
    return _inputs(formula, objects, fits, {})


def _inputs(
    formula: ltl.Formula,
    objects: Mapping[str, str],
    fits: Callable[[str, str], bool],
    names: Mapping[str, str],
) -> Iterator[ltl.Atom | ltl.QuantityTerm]:
    """The inputs of a formula whose variables stand for the objects in ``names``."""
    for read in reads_in(formula):
        if not isinstance(read, ltl.Count):
            yield replace(read, arguments=_renamed(read.arguments, names)) if names else read
            continue
        for name, kind in objects.items():
            if fits(kind, read.type):
                # The inputs of the body, for this object.
                yield from _inputs(read.body, objects, fits, {**names, read.variable: name})


def number_of(proposition: ltl.Calculated) -> ltl.NumberSum:
    """The number that is compared with 0, of the proposition's own arguments."""
    arguments = enumerate(proposition.arguments, 1)
    return renamed_number(proposition.number, {f"x{place}": name for place, name in arguments})


def renamed_number(number: ltl.NumberSum, names: Mapping[str, str]) -> ltl.NumberSum:
    """The number with other variables, as ``rename_variables``."""
    coefficients: dict[ltl.Term | ltl.Operation, Fraction] = {}
    for factor, part in number.parts:
        own: ltl.Term | ltl.Operation
        if isinstance(part, ltl.Operation):
            own = ltl.Operation(
                part.operator, *(renamed_number(x, names) for x in (part.left, part.right))
            )
        else:
            own = renamed_term(part, names)
        coefficients[own] = coefficients.get(own, Fraction(0)) + factor
    return number_sum(coefficients, number.constant)


def number_sum(
    coefficients: Mapping[ltl.Term | ltl.Operation, Fraction], constant: Fraction
) -> ltl.NumberSum:
    """A sum in normal form: parts sorted by their text."""
    parts = sorted(coefficients.items(), key=lambda pair: term_text(pair[0]))
    return ltl.NumberSum(tuple([(factor, part) for part, factor in parts]), constant)
