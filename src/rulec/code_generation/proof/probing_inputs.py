"""Inputs that test readings: at limits, next to them, unknown."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache, partial
from math import inf, nextafter
from random import Random
from typing import Any

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import scale
from rulec.code_generation.monitor_layout import MonitorLayout, RuleLayout
from rulec.logic import formula as ltl
from rulec.logic.kleene import Unknown, weighted_sum
from rulec.monitoring.state_view import StateView
from rulec.monitoring.uncertainty.state_letters.read_digits import names_of_read, read_digits
from rulec.trace import State
from rulec.vocabulary import Declaration, Enumeration, Signal
from rulec.vocabulary.partial_values import UNKNOWN
from rulec.vocabulary.vocabulary_model import fitting_objects

SEVERAL = 60
"""The number of states for a read of several values."""

PLAIN = (0.0, 0.125, 1.0, 2.5, 8.3, 10.0, 50.0, 130.0)


@dataclass(frozen=True, slots=True)
class ReadingProbe:
    """A state, and the digits (as bits) that a rule's read has in it for the objects of a binding.

    ``place`` is that of the digits in C. ``is_sharp`` unless rounding may change the digits.
    """

    rule: str
    number: int
    place: tuple[int, int]
    state: State
    objects: Mapping[str, str]
    binding: tuple[str, ...]
    digits: int
    is_sharp: bool


def probes(layout: MonitorLayout) -> Iterator[ReadingProbe]:
    """Probes of every read of every rule."""
    chance = Random(0)
    for own in layout.rules:
        for number, read in enumerate(own.rule.machine.reads):
            yield from _probes_of(layout, own, number, read, chance)


def _probes_of(
    layout: MonitorLayout, own: RuleLayout, number: int, read: Read | NumberRead, chance: Random
) -> Iterator[ReadingProbe]:
    vocabulary = layout.rulebook.vocabulary
    binding = {variable.name: f"x{n}" for n, variable in enumerate(own.rule.variables)}
    objects = {f"x{n}": variable.type for n, variable in enumerate(own.rule.variables)}
    counted = _counted(read)
    for n, kind in enumerate([*counted, *counted]):
        objects[f"y{n}"] = kind
    declared = [vocabulary.declarations[name] for name in dict.fromkeys(names_of_read(read))]
    ready = read_digits(read)
    for state in _states(read, declared, objects, layout, chance):
        view = StateView(state, objects, vocabulary)
        sharp = True
        if isinstance(read, NumberRead) and ready.subject is None:
            total = weighted_sum(read.terms, binding, view)
            unclear = (len(read.terms) > 1 and counted) or nests(read)
            if unclear and isinstance(total, Unknown):
                continue
            clear = isinstance(total, Unknown) and not weighs(read)
            sharp = clear or (not isinstance(total, Unknown) and _is_clear(read, total))
        yield ReadingProbe(
            own.rule.name,
            number,
            place=own.reads[number],
            state=state,
            objects=objects,
            binding=tuple(binding.values()),
            digits=ready.in_state(binding, view),
            is_sharp=sharp,
        )


def _is_clear(read: NumberRead, total: Fraction) -> bool:
    """Whether a sum is far enough from each limit for doubles to decide."""
    return not any(map(weighs, _counts(read))) and (
        len(read.terms) == 1
        or all(abs(total - side.limit) > Fraction(1, 10**6) for side in read.thresholds)
    )


def weighs(part: Read | NumberRead | ltl.Count) -> bool:
    """Whether sums of several numbers, possibly close to a limit, decide the part."""
    match part:
        case Read():
            return False
        case NumberRead():
            return len(part.terms) > 1 or any(map(weighs, _counts(part)))
    sums = [atom for atom in ltl.atoms_of(part.body) if isinstance(atom, ltl.Comparison)]
    return any(
        len(comparison.terms) > 1 or any(map(weighs, _counts(comparison))) for comparison in sums
    )


def nests(read: Read | NumberRead) -> bool:
    """Whether a count contains a count: there Python leaves more open than C for unknown values."""
    return not isinstance(read, Read) and any(
        isinstance(atom, ltl.Comparison) and _counts(atom)
        for count in _counts(read)
        for atom in ltl.atoms_of(count.body)
    )


def _counts(comparison: NumberRead | ltl.Comparison) -> list[ltl.Count]:
    return [term for _, term in comparison.terms if isinstance(term, ltl.Count)]


def _counted(read: Read | NumberRead) -> list[str]:
    """The types of objects that a read counts."""
    if isinstance(read, Read):
        return []
    types = [term.type for _, term in read.terms if isinstance(term, ltl.Count)]
    return list(dict.fromkeys(types))


def _states(
    read: Read | NumberRead,
    declared: list[Declaration],
    objects: Mapping[str, str],
    layout: MonitorLayout,
    chance: Random,
) -> Iterator[State]:
    """All states for a read of one value, a sample for any other."""
    choices = {item.name: list(values_of(item, layout)) for item in declared}
    if isinstance(read, Read) or scale(read).quantity is not None:
        (item,) = declared
        if isinstance(read, NumberRead):
            near = [(nextafter(x, -inf), x, nextafter(x, inf)) for x in scale(read).floors]
            choices[item.name] = [*PLAIN, UNKNOWN, *[x for three in near for x in three]]
        for value in choices[item.name]:
            yield {item.name: everywhere(item, objects, layout, partial(_same, value))}
        return
    for _ in range(SEVERAL):
        unknown = chance.choice([0.0, 0.0, 0.2])
        state = {
            item.name: everywhere(
                item, objects, layout, partial(drawn, chance, choices[item.name], unknown)
            )
            for item in declared
        }
        yield state
        yield from _at_limits(read, declared, objects, layout, state)


def _at_limits(
    read: NumberRead,
    declared: list[Declaration],
    objects: Mapping[str, str],
    layout: MonitorLayout,
    state: State,
) -> Iterator[State]:
    """The state with a sum's first number set so that the sum is at a limit, or next to it."""
    (factor, first), *others = read.terms
    if not isinstance(first, ltl.QuantityTerm) or not others:
        return
    declaration = next(item for item in declared if item.name == first.name)
    names = dict.fromkeys(name for _, term in others for name in _arguments(term))
    binding = {name: next(iter(objects)) for name in [*names, *first.arguments]}
    rest = weighted_sum(tuple(others), binding, StateView(state, objects, layout.fields.vocabulary))
    if isinstance(rest, Unknown):
        return
    for side in read.thresholds:
        value = float((side.limit - rest) / factor)
        for near in (value, value - 0.125, value + 0.125, nextafter(value, inf)):
            yield {
                **state,
                first.name: everywhere(declaration, objects, layout, partial(_same, near)),
            }


def _arguments(term: ltl.Term) -> tuple[str, ...]:
    return term.arguments if isinstance(term, ltl.QuantityTerm) else ()


def everywhere(
    item: Declaration, objects: Mapping[str, str], layout: MonitorLayout, draw: Callable[[], Any]
) -> Any:
    """A value drawn for every choice of objects that a name can have as arguments."""
    vocabulary = layout.rulebook.vocabulary

    def of(parameters: tuple[str, ...]) -> Any:
        if not parameters:
            return draw()
        fitting = fitting_objects(parameters[0], objects, vocabulary)
        return {value: of(parameters[1:]) for value in fitting}

    return of(item.parameters)


def values_of(item: Declaration, layout: MonitorLayout) -> list[Any]:
    """The values of a name that rules distinguish; the last one is unknown."""
    if isinstance(item, Signal):
        return [False, True, UNKNOWN]
    if isinstance(item, Enumeration):
        return [*item.values, UNKNOWN]
    return [*PLAIN, *_limits(layout).get(item.name, ()), UNKNOWN]


@lru_cache(maxsize=4)
def _limits(layout: MonitorLayout) -> Mapping[str, tuple[float, ...]]:
    """By quantity, the limits that rules compare it with on its own, and adjacent floats."""
    limits: dict[str, set[float]] = {}
    for own in layout.rules:
        for read in own.rule.machine.reads:
            if isinstance(read, NumberRead) and (about := scale(read).quantity) is not None:
                for floor in scale(read).floors:
                    limits.setdefault(about.name, set()).update({floor, nextafter(floor, -inf)})
    return {name: tuple(sorted(numbers)) for name, numbers in limits.items()}


def _same(value: Any) -> Any:
    return value


def drawn(chance: Random, values: Sequence[Any], share_unknown: float) -> Any:
    """A random value, or unknown."""
    return UNKNOWN if chance.random() < share_unknown else chance.choice(values)
