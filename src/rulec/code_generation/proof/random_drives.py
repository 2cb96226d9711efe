"""Drives for comparing monitors: random states, and states made for letters of the tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from random import Random
from typing import Any, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.code_generation.monitor_layout import MonitorLayout
from rulec.code_generation.proof.probing_inputs import drawn, everywhere, values_of
from rulec.monitoring.online.four_valued import FourValued, four_valued
from rulec.trace import State
from rulec.vocabulary import Declaration
from rulec.vocabulary.partial_values import UNKNOWN_TYPES
from rulec.witnesses.class_witness import ClassWitnesses
from rulec.witnesses.undecided import UndecidedError

Drive: TypeAlias = list[tuple[State, Mapping[str, str]]]
"""States, and the objects that are present in each."""

CASTS = 3
STATES_OF_A_CAST = 24
"""The states of several drives are drawn from a small pool, so that each is prepared once."""

POOLS = 8
STATES_OF_A_POOL = 40, 4000
LENGTHS = (2, 5, 10, 20, 100, 500)
QUIET = (0.0, 0.0, 0.5, 0.8, 0.95)
"""Probabilities that a name has its default, so that rules are kept for a while, too."""


def drives(
    layout: MonitorLayout, chance: Random, n_states: int, share_unknown: float
) -> Iterator[Drive]:
    """Random drives with objects that appear and disappear, with ``n_states`` states in all.

    If values may be unknown, so may be the past of objects that had no seat.
    """
    left = n_states
    least, most = STATES_OF_A_POOL
    while left > 0:
        of_pool = min(left, max(least, min(most, n_states // POOLS)))
        n = max(2, min(STATES_OF_A_CAST, of_pool // CASTS))
        casts = list(_casts(layout, chance))
        if share_unknown == 0:
            casts = [_seated(layout, cast) for cast in casts]
        shares = share_unknown, chance.choice(QUIET)
        # Python's monitor refuses a state in which a constant has changed, and a drive would end.
        constants = {
            item.name: _value(chance, item, layout, shares)
            for item in layout.fields.read
            if item.constant
        }
        pools = [
            [_state(layout, chance, cast, shares, constants) for _ in range(n)] for cast in casts
        ]
        left -= of_pool
        longest = max(LENGTHS[0], of_pool // 4)
        while of_pool > 0:
            drive: Drive = []
            at = chance.randrange(CASTS)
            length = min(chance.choice(LENGTHS), longest)
            # In short drives the objects present change often.
            changes = 0.5 if length <= 20 else 0.01
            for _ in range(min(of_pool, length)):
                if chance.random() < changes:
                    at = chance.randrange(CASTS)
                drive.append((chance.choice(pools[at]), casts[at]))
            of_pool -= len(drive)
            yield drive


def _casts(layout: MonitorLayout, chance: Random) -> Iterator[dict[str, str]]:
    """Sets of present objects; an object may reappear with another type."""
    kinds = [kind for kind, (first, end) in layout.seats.items() if first < end]
    known = {f"o{number}": chance.choice(kinds) for number in range(6)}
    for _ in range(CASTS):
        there = chance.sample(sorted(known), chance.randrange(5))
        yield {
            name: chance.choice(kinds) if chance.random() < 0.1 else known[name] for name in there
        }


def _seated(layout: MonitorLayout, objects: Mapping[str, str]) -> dict[str, str]:
    """The objects that have a seat; Python's monitor would judge the others, too."""
    room = {stretch: stretch[1] - stretch[0] for stretch in layout.seats.values()}
    seated = {}
    for name, kind in objects.items():
        stretch = layout.seats[kind]
        if room[stretch] > 0:
            room[stretch] -= 1
            seated[name] = kind
    return seated


def _state(
    layout: MonitorLayout,
    chance: Random,
    objects: Mapping[str, str],
    shares: tuple[float, float],
    constants: Mapping[str, Any],
) -> dict[str, Any]:
    def value(item: Declaration) -> Any:
        if item.name in constants:
            return constants[item.name]
        return _value(chance, item, layout, shares)

    return {
        item.name: everywhere(item, objects, layout, partial(value, item))
        for item in layout.fields.read
    }


def _value(
    chance: Random, item: Declaration, layout: MonitorLayout, shares: tuple[float, float]
) -> Any:
    """A random value, with given probabilities of unknown (first) and of the default."""
    share_unknown, quiet = shares
    if chance.random() < quiet and type(item.default) not in (*UNKNOWN_TYPES, type(None)):
        return item.default
    return drawn(chance, values_of(item, layout)[:-1], share_unknown)


@dataclass(frozen=True, slots=True)
class TableDrive:
    """A drive whose states were made for letters of a rule, and the table's verdicts on it."""

    rule: CompiledRule
    drive: Drive
    verdicts: tuple[FourValued, ...]


def table_drives(layout: MonitorLayout, chance: Random, n_states: int) -> Iterator[TableDrive]:
    """Random words of each rule as drives, using one readable letter for each class."""
    vocabulary = layout.rulebook.vocabulary
    for own in layout.rules:
        rule, machine = own.rule, own.rule.machine
        try:
            witnesses = ClassWitnesses(rule, vocabulary)
            classes = [*filter(witnesses.is_read, range(len(machine.successors[0])))]
            example = witnesses.example(classes)
        except UndecidedError:
            continue
        if example is None:
            continue
        objects = {item.name: item.type for item in (*rule.variables, *example[0])}
        if len(_seated(layout, objects)) < len(objects):
            continue
        states = [
            _with(values, _state(layout, chance, objects, (0.0, 1.0), {})) for values in example[1]
        ]
        left = max(len(states), n_states // len(layout.rules))
        while left > 0:
            drive: Drive = []
            verdicts: list[FourValued] = []
            at = 0
            for _ in range(min(left, chance.choice(LENGTHS))):
                place = chance.randrange(len(states))
                by = classes[place]
                at, accepted = machine.successors[at][by], machine.outputs[at][by]
                drive.append((states[place], objects))
                verdicts.append(four_valued(machine, at, accepted))
            left -= len(drive)
            yield TableDrive(rule, drive, tuple(verdicts))


def _with(values: Mapping[tuple[str, tuple[str, ...]], Any], state: dict[str, Any]) -> State:
    """The state with these values replaced."""
    for (name, arguments), value in values.items():
        inner, key = state, name
        for argument in arguments:
            inner, key = inner.setdefault(key, {}), argument
        inner[key] = value
    return state
