"""The letters that all bindings of a rule read in one state, in one go."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from operator import add
from typing import Any, TypeAlias

from rulec.automata.compiled import CompiledRule
from rulec.runtime.online.columns import Items, OneStateColumns
from rulec.runtime.online.weighing import Weighing

Reading: TypeAlias = Callable[[list[Any], list[Sequence[Any]]], Iterable[int]]
"""From the values and the columns of a state, a class of letters for each binding.

Raises a LookupError or a TypeError where a value is missing.
"""


def reading(
    rule: CompiledRule,
    weighings: Sequence[Weighing],
    bindings: Sequence[Items],
    columns: OneStateColumns,
) -> Reading:
    """What reads the letters of a rule for these bindings, of which there are some."""
    variables = {variable.name: place for place, variable in enumerate(rule.variables)}
    shared, each = [], []
    for one in weighings:
        places = [variables[variable] for variable in one.variables]
        items = [tuple([binding[place] for place in places]) for binding in bindings]
        if one.name is None:
            assert one.computed is not None
            each.append((one, columns.column_of_sum(one.computed, one.variables, items)))
        elif places:
            each.append((one, columns.column_of(one.name, items)))
        else:
            shared.append((one.one, columns.value_of(one.name)))
    classes = rule.machine.letters

    def base_of(values: list[Any]) -> int:
        base = 0
        for weigh, place in shared:
            base += weigh(values[place])
        return base

    if not each:
        return lambda values, _: [classes[base_of(values)]] * len(bindings)
    (first, place), *others = each
    if not others and first.digits is not None:
        digits = first.digits.items()
        by_base: dict[int, Callable[[Any], int]] = {}

        def of_one_column(values: list[Any], found: list[Sequence[Any]]) -> Iterable[int]:
            base = base_of(values)
            if base not in by_base:
                letters = {value: classes[base + weight] for value, weight in digits}
                by_base[base] = letters.__getitem__
            return map(by_base[base], found[place])

        return of_one_column

    def of_several(values: list[Any], found: list[Sequence[Any]]) -> Iterable[int]:
        base = base_of(values)
        weights: Iterable[int] = first.many(found[place])
        for one, where in others:
            weights = map(add, weights, one.many(found[where]))
        return [classes[base + weight] for weight in weights]

    return of_several
