"""Synthesised states as a trace, with names for all objects."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import count, product
from typing import Any

from rulec.diagnostics import RulecError
from rulec.trace import Trace
from rulec.vocabulary import Enumeration, Signal
from rulec.vocabulary.vocabulary_model import default_value
from rulec.witnesses.counted_objects import (
    CountedObjectKinds,
    counted_objects_of_types,
    fewest_counted_objects,
)
from rulec.witnesses.object_universe import EXTRA, ObjectUniverse
from rulec.witnesses.state_synthesis import JointState, Subject, Value, subjects_of
from rulec.witnesses.undecided import ChangingConstantsError, UndecidedError


def place_objects(
    states: Sequence[JointState], universe: ObjectUniverse
) -> tuple[dict[str, str], list[dict[Subject, Value]]]:
    """Name the objects that the counts of all states need besides the universe's, by their types.

    Returns their types by name, and the values of each state. Raises UndecidedError if objects that
    one state needs contradict another.
    """
    # Each type as often as the state that needs most of it.
    most: Counter[str] = Counter()
    kinds = CountedObjectKinds(universe)
    for state in states:
        needed = fewest_counted_objects(state, kinds) or ()
        most |= Counter(companion.type for companion in needed)
    types = sorted(most.elements())
    names: list[str] = []
    for kind in types:
        numbered = (f"{kind}{number}" for number in count(1))
        names.append(next(name for name in numbered if name not in {*universe.objects, *names}))
    placed: list[dict[Subject, Value]] = []
    for state in states:
        further = counted_objects_of_types(state, kinds, types)
        if further is None:
            raise UndecidedError("objects needed for counts in one state contradict another state")
        values = dict(state.values)
        for name, companion in zip(names, further, strict=True):
            for (declaration, items), value in companion.values.items():
                own = tuple(name if item == EXTRA else item for item in items)
                values[declaration, own] = value
        placed.append(values)
    return dict(zip(names, types, strict=True)), placed


def synthesize_trace(
    states: Sequence[JointState],
    universe: ObjectUniverse,
    step_s: Fraction,
    shows: Callable[[Trace], bool],
    is_possible: Callable[[Trace], bool] = lambda _: True,
) -> Trace:
    """Synthesise a possible trace through these states for which ``shows`` holds.

    ``is_possible`` is asked where that does not follow from the states: objects added for counts
    are chosen one by one, and one value of a constant replaces others.
    Raises UndecidedError if objects needed for counts prevent that, or if a constant would have to
    change.
    """
    objects, placed = place_objects(states, universe)
    all_objects = {**universe.objects, **objects}
    types = list(objects.values())
    changing = _changing_constants(placed, universe)
    variants = product(_settled(placed, changing), _fills(universe, types))
    for settled, fill in variants:
        written = tuple(_written(values, universe, all_objects, fill) for values in settled)
        trace = Trace("witness", float(step_s), all_objects, written)
        try:
            if (not (types or changing) or is_possible(trace)) and shows(trace):
                return trace
        except RulecError:
            # The facts that a rule knows may exclude objects added for counts, or the value chosen
            # for a constant.
            if not types and not changing:
                raise
    if changing:
        raise ChangingConstantsError(tuple(sorted(changing)))
    if types:
        raise UndecidedError(
            "further objects, needed for counts, are subject to the rule, too, or to facts"
        )
    raise AssertionError(f"a trace does not do what it is to show: {trace.states}")


def _changing_constants(
    placed: Sequence[Mapping[Subject, Value]], universe: ObjectUniverse
) -> dict[Subject, tuple[Value, ...]]:
    """The constants whose values differ between states, with the values in the order of states.

    Automata read each state separately, and a missing value has its default.
    """
    declarations = universe.vocabulary.declarations
    constants = set(universe.vocabulary.constants)
    values_of = {
        subject: tuple(
            dict.fromkeys(
                values.get(subject, default_value(declarations[subject[0]])) for values in placed
            )
        )
        for subject in dict.fromkeys(subject for values in placed for subject in values)
        if subject[0] in constants
    }
    return {subject: values for subject, values in values_of.items() if len(values) > 1}


def _settled(
    placed: list[dict[Subject, Value]], changing: Mapping[Subject, Sequence[Value]]
) -> Iterator[list[dict[Subject, Value]]]:
    """The states, with one value throughout for each constant that changes.

    A value that one state gives is used in all of them, instead of the default.
    """
    for chosen in product(*changing.values()):
        settled = dict(zip(changing, chosen, strict=True))
        yield [{**values, **settled} for values in placed]


def _fills(universe: ObjectUniverse, types: Sequence[str]) -> Iterable[Mapping[str, Value]]:
    yield {}
    for name, declaration in universe.vocabulary.declarations.items() if types else ():
        if declaration.parameters and isinstance(declaration, Signal | Enumeration):
            for value in getattr(declaration, "values", (False, True)):
                yield {name: value}


def _written(
    values: Mapping[Subject, Value],
    universe: ObjectUniverse,
    all_objects: Mapping[str, str],
    fill: Mapping[str, Value],
) -> dict[str, Any]:
    state: dict[str, Any] = {}
    for (name, items), declaration in subjects_of(universe.vocabulary, all_objects):
        value = values.get((name, items))
        if value is None:
            if name in universe.unsaid:
                continue
            value = fill.get(name, default_value(declaration))
        if value == declaration.default and type(value) is type(declaration.default):
            continue
        inside = state
        *outer, last = (name, *items)
        for key in outer:
            inside = inside.setdefault(key, {})
        inside[last] = value
    return state
