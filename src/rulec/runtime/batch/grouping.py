"""Traces of one shape as walks through the states that they share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, pairwise
from typing import Any

import numpy as np

from rulec.runtime.letters import present_in
from rulec.trace import Trace
from rulec.trace.columns import TraceCells, layout_of, smallest_unsigned

Shape = tuple[object, ...]


def shape_of(trace: Trace) -> Shape:
    """What traces have in common that are judged together: step, objects, and presence."""
    return trace.step_s, tuple(trace.objects.items()), tuple(trace.present.items())


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Traces of one shape as cells; ``order`` are their places in the order of the layout."""

    cells: TraceCells
    order: Sequence[int]


def grouped(traces: Sequence[Trace]) -> Group:
    """Traces of one shape that have passed ``check_trace``.

    States are told apart by identity: a reader that meets a state again gives the same object.
    """
    lengths = np.array([len(trace.states) for trace in traces], dtype=np.int64)
    order = np.argsort(-lengths, kind="stable")
    ordered = [traces[place] for place in order.tolist()]
    layout = layout_of(lengths[order])
    one = ordered[0]
    states = list(chain.from_iterable([trace.states for trace in ordered]))
    scenes, scene_of_step = _scenes(one, layout.n_steps)
    steps_of = layout.lengths.tolist()
    keys: list[Any] = (
        list(map(id, states))
        if len(scenes) == 1
        else list(
            zip(
                map(id, states),
                chain.from_iterable([scene_of_step[:n_steps] for n_steps in steps_of]),
                strict=True,
            )
        )
    )
    known = dict(zip(keys, states, strict=True))
    numbers = {key: number for number, key in enumerate(known)}
    found = np.fromiter(map(numbers.__getitem__, keys), np.int64, layout.n_states)
    # From one trace after the other to one step after the other.
    before = np.cumsum(layout.lengths) - layout.lengths
    trace = np.repeat(np.arange(layout.n_traces), layout.lengths)
    step = np.arange(layout.n_states) - before[trace]
    cells = np.empty(layout.n_states, dtype=smallest_unsigned(len(known)))
    cells[layout.starts[step] + trace] = found
    there = () if len(scenes) == 1 else tuple([scenes[key[1]] for key in known])
    walks = TraceCells(
        layout, cells, tuple(known.values()), one.objects, one.present, there, one.step_s
    )
    return Group(walks, order.tolist())


def _scenes(trace: Trace, n_steps: int) -> tuple[list[Mapping[str, str]], list[int]]:
    """Which objects are there together at any time; and for each step which of these are."""
    changes = {0, n_steps}
    for first, last in trace.present.values():
        changes |= {first, last + 1}
    scenes: dict[tuple[str, ...], Mapping[str, str]] = {}
    places: dict[tuple[str, ...], int] = {}
    steps: list[int] = []
    for step, change in pairwise(sorted(changes)):
        there = present_in(step, trace.objects, trace.present)
        names = tuple(there)
        scenes.setdefault(names, there)
        steps += [places.setdefault(names, len(places))] * (change - step)
    return list(scenes.values()), steps
