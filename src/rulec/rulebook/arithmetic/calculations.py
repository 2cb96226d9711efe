"""Products and quotients of numbers that change, and comparisons of them."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.logic import formula as ltl
from rulec.logic.free_names import renamed_number, terms_of, variables_of
from rulec.logic.printing import sum_text


def multiplication(left: ltl.NumberSum, right: ltl.NumberSum) -> ltl.Operation:
    """The product of two numbers, the same in either order."""
    first, second = sorted((left, right), key=sum_text)
    return ltl.Operation("*", first, second)


def calculated(number: ltl.NumberSum, relation: ltl.Relation, text: str) -> ltl.Calculated:
    """The comparison of a number with 0, which a rulebook spells like this."""
    variables = tuple(dict.fromkeys(_variables(number)))
    places = {name: f"x{place}" for place, name in enumerate(variables, 1)}
    name = ltl.with_arguments(text, places)
    return ltl.Calculated(name, variables, number=renamed_number(number, places), relation=relation)


def _variables(number: ltl.NumberSum) -> Iterator[str]:
    for term in terms_of(number):
        yield from variables_of(term)
