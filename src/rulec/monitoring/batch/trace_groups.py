"""Groups of traces that differ only in their objects' names, as cells of shared states."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, pairwise, repeat
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rulec.monitoring.verdict import Violation
from rulec.trace import Trace
from rulec.trace.trace_columns import TraceCells, layout_of, smallest_unsigned
from rulec.trace.trace_model import present_in

Shape: TypeAlias = tuple[object, ...]

Names: TypeAlias = tuple[str, ...]
"""The objects of a trace, in their order."""

Placed: TypeAlias = tuple[int, Trace]
"""A trace with its position among all traces."""

_PLAIN = frozenset((bool, int, float, str))


def shape_of(trace: Trace) -> Shape:
    """The shape of a trace: step, object types in order, and presence, without names."""
    places = {name: place for place, name in enumerate(trace.objects)}
    stretches = [(places[name], stretch) for name, stretch in trace.present.items()]
    return trace.step_s, tuple(trace.objects.values()), tuple(sorted(stretches))


@dataclass(frozen=True, slots=True, eq=False)
class TraceGroup:
    """Traces of one shape as cells, their places in layout ``order``.

    The objects are the first trace's. ``names`` has for each state what they are called there, in
    their order; it is empty if all traces have the same.
    """

    cells: TraceCells
    order: Sequence[int]
    names: Sequence[Names] = ()


def group_traces(traces: Sequence[Trace]) -> TraceGroup:
    """Traces of one shape that have passed ``check_trace``.

    States are told apart by identity: readers intern them, and give the same object for a state
    that they meet again. The traces keep all of them alive.
    """
    lengths = np.array([len(trace.states) for trace in traces], dtype=np.int64)
    order = np.argsort(-lengths, kind="stable")
    ordered = [traces[place] for place in order.tolist()]
    layout = layout_of(lengths[order])
    example = ordered[0]
    states = list(chain.from_iterable([trace.states for trace in ordered]))
    scenes, scene_of_step = _scenes(example, layout.n_steps)
    steps_of = layout.lengths.tolist()
    names = [tuple(trace.objects) for trace in ordered]
    are_alike = names.count(names[0]) == len(names)
    now = list(chain.from_iterable([scene_of_step[:n_steps] for n_steps in steps_of]))
    owners = list(chain.from_iterable(map(repeat, names, steps_of)))
    places: Sequence[int]
    ids = list(map(id, states))
    if len(set(ids)) == len(ids):
        places, numbers = range(len(ids)), np.arange(len(ids))
    elif len(scenes) == 1 and are_alike:
        places, numbers = _distinct(ids)
    else:
        places, numbers = _distinct(list(zip(ids, now, owners, strict=True)))
    # Reorder from trace by trace to step by step.
    before = np.cumsum(layout.lengths) - layout.lengths
    trace = np.repeat(np.arange(layout.n_traces), layout.lengths)
    step = np.arange(layout.n_states) - before[trace]
    cells = np.empty(layout.n_states, dtype=smallest_unsigned(len(places)))
    cells[layout.starts[step] + trace] = numbers
    shared = TraceCells(
        layout=layout,
        cells=cells,
        states=tuple([states[place] for place in places]),
        objects=example.objects,
        present=example.present,
        there=() if len(scenes) == 1 else tuple([scenes[now[place]] for place in places]),
        step_s=example.step_s,
    )
    own_names = () if are_alike else [owners[place] for place in places]
    return TraceGroup(shared, order.tolist(), own_names)


def _distinct(keys: Sequence[Hashable]) -> tuple[Sequence[int], NDArray[np.int64]]:
    places = dict(zip(keys, range(len(keys)), strict=True))
    numbers = {key: number for number, key in enumerate(places)}
    return list(places.values()), np.fromiter(map(numbers.__getitem__, keys), np.int64, len(keys))


def _scenes(trace: Trace, n_steps: int) -> tuple[list[Mapping[str, str]], list[int]]:
    """Distinct sets of objects present together, and their index by step."""
    changes = {0, n_steps}
    for first, last in trace.present.values():
        changes |= {first, last + 1}
    scenes: list[Mapping[str, str]] = []
    places: dict[Names, int] = {}
    steps: list[int] = []
    for step, change in pairwise(sorted(changes)):
        objects = present_in(step, trace.objects, trace.present)
        place = places.setdefault(tuple(objects), len(scenes))
        if place == len(scenes):
            scenes.append(objects)
        steps += [place] * (change - step)
    return scenes, steps


def under_own_names(
    violations: Sequence[Violation], objects: Names, own: Names
) -> tuple[Violation, ...]:
    """Violations with the group's object names replaced by a trace's own."""
    if not violations or objects == own:
        return tuple(violations)
    names = dict(zip(objects, own, strict=True))
    return tuple(
        [
            Violation(
                violation.rule,
                violation.strength,
                {variable: names[item] for variable, item in violation.binding.items()},
                violation.step,
            )
            for violation in violations
        ]
    )
