"""Traces, and graphs whose paths are traces, as plain data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import islice
from numbers import Integral, Real
from typing import Literal, get_args

from rulec.diagnostics import SourceLocation
from rulec.diagnostics.argument_kinds import expected, is_finite
from rulec.trace.trace_messages import NO_STATES, NOT_A_TRACE, UNKNOWN_OBJECT
from rulec.value_display import brief, short_repr
from rulec.vocabulary.partial_values import PartialValue

Value = bool | float | str

State = Mapping[str, "PartialValue | Mapping[str, PartialValue]"]
"""Vocabulary name -> its value; for a per-object name, object -> value."""

Ending = Literal["complete", "cut"]
"""``complete``, or ``cut``: the recording began and ended in the middle of what happened."""


def ending_in_file(said: Ending | None, *, in_seconds: bool) -> Ending:
    """How a trace in a file ends.

    One that states its step in seconds was sampled, so unless it says otherwise it is a piece of
    something longer.
    """
    return said or ("cut" if in_seconds else "complete")


@dataclass(frozen=True, slots=True)
class Trace:
    """A finite sequence of states, ``step_s`` seconds apart.

    ``objects`` maps each object's id to its type. ``present`` maps an object that is not always
    present to the first and the last state (from 0, inclusive) in which it is. ``told`` are the
    names that the source provides, None for all; every other name is unknown. ``place`` is where
    the trace was read, for messages. A trace made in Python is complete unless ``ends`` says
    otherwise; one that a file gives in seconds is cut unless the file says otherwise.
    """

    __repr__ = short_repr

    id: str
    step_s: float
    objects: Mapping[str, str]
    states: tuple[State, ...]
    present: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    place: SourceLocation | None = field(default=None, compare=False, repr=False)
    ends: Ending = "complete"
    told: frozenset[str] | None = None

    def steps(self) -> Iterator[tuple[State, Mapping[str, str]]]:
        """Each state with the objects that are present in it, as ``Monitor.step`` takes them."""
        for number, state in enumerate(self.states):
            yield state, present_in(number, self.objects, self.present)


def present_in(
    number: int, objects: Mapping[str, str], present: Mapping[str, tuple[int, int]]
) -> Mapping[str, str]:
    """The objects present in a state, with their types; ``present`` is as in a trace."""
    if not present:
        return objects
    return {
        name: kind
        for name, kind in objects.items()
        if name not in present or present[name][0] <= number <= present[name][1]
    }


@dataclass(frozen=True, slots=True)
class TraceGraph:
    """A layered directed graph whose paths from ``start`` to ``goals`` are traces.

    ``states[p][i]`` is the state of node ``i`` of layer ``p``; ``successors[p][i]`` are the indices
    of its successors in layer ``p + 1``, ascending, ``weights[p][i]`` the whole-number costs of
    these edges, in the unit ``cost_unit`` (1/s), and ``margins[p][i]`` their time margins in layers
    (None for staying). ``objects``, ``present`` (in layers) and ``told`` are as in a trace. A
    constant has the same value in all nodes.
    """

    __repr__ = short_repr

    step_s: float
    objects: Mapping[str, str]
    present: Mapping[str, tuple[int, int]]
    states: tuple[tuple[State, ...], ...]
    successors: tuple[tuple[tuple[int, ...], ...], ...]
    weights: tuple[tuple[tuple[int, ...], ...], ...]
    margins: tuple[tuple[tuple[int | None, ...], ...], ...]
    cost_unit: Fraction
    start: int
    goals: tuple[int, ...]
    told: frozenset[str] | None = None


def paths(graph: TraceGraph) -> Iterator[tuple[int, ...]]:
    """Paths from start to goals, as node indices, in ascending order.

    Generated lazily, in memory bounded by the graph: dead ends are never entered.
    """
    alive = _alive(graph)
    last = len(graph.states) - 1
    if graph.start not in alive[0]:
        return
    path = [graph.start]
    choices = [_onward(graph, alive, path)]
    while choices:
        if len(path) - 1 == last:
            yield tuple(path)
        following = next(choices[-1], None)
        if following is None:
            choices.pop()
            path.pop()
        else:
            path.append(following)
            choices.append(_onward(graph, alive, path))


def _onward(graph: TraceGraph, alive: Sequence[set[int]], path: Sequence[int]) -> Iterator[int]:
    layer = len(path)
    if layer == len(graph.states):
        return iter(())
    return (node for node in graph.successors[layer - 1][path[-1]] if node in alive[layer])


def _alive(graph: TraceGraph) -> list[set[int]]:
    """For each layer, the nodes from which a goal can be reached."""
    alive = [set(graph.goals)]
    for successors in reversed(graph.successors):
        following = alive[-1]
        alive.append(
            {node for node, onward in enumerate(successors) if not following.isdisjoint(onward)}
        )
    return alive[::-1]


def all_traces(graph: TraceGraph, name: str, limit: int) -> Iterator[Trace]:
    """The traces of the first ``limit`` paths, named ``name-1``, ``name-2``, …."""
    for number, path in enumerate(islice(paths(graph), limit), 1):
        yield trace_of(graph, path, f"{name}-{number}")


def trace_of(graph: TraceGraph, path: Sequence[int], name: str) -> Trace:
    """The trace along a path."""
    states = tuple(states[node] for states, node in zip(graph.states, path, strict=True))
    return Trace(name, graph.step_s, graph.objects, states, graph.present, told=graph.told)


def check_trace(trace: Trace) -> None:
    """Check a trace's states, step and presence. Raises R0501, R0505, R0506."""
    check_frame(trace)
    for number, state in enumerate(trace.states):
        # A test for Mapping takes far longer than one for dict.
        if type(state) is not dict and not isinstance(state, Mapping):
            raise NOT_A_TRACE.error(trace.place, f"state {number} does not map names to values")
    check_presence(trace)


def check_frame(trace: Trace) -> None:
    """Check everything about a trace except its states and presence."""
    _check_kinds(trace)
    if not trace.states:
        raise NO_STATES.error(
            trace.place, "the trace has no states; it needs at least one to judge"
        )
    if not is_finite(trace.step_s) or not trace.step_s > 0:
        shown = f"{trace.step_s:g}" if isinstance(trace.step_s, float) else brief(trace.step_s)
        message = f"`step_s` is {shown}; it has to be a number of seconds above 0"
        raise NOT_A_TRACE.error(trace.place, message)


def _check_kinds(trace: Trace) -> None:
    # A trace made in Python may contain anything
    states: object = trace.states
    step: object = trace.step_s
    name: object = trace.id
    ends: object = trace.ends
    told: object = trace.told
    pairs: tuple[tuple[str, object], ...] = (
        ("objects", trace.objects),
        ("present", trace.present),
    )
    wrong = ""
    if trace.place is not None:
        expected("place", "SourceLocation", trace.place)
    # Tests for abstract classes take far longer than those for concrete types.
    if type(states) not in (tuple, list) and (
        not isinstance(states, Sequence) or isinstance(states, str | bytes)
    ):
        wrong = f"`states` is a tuple of states, not {type(states).__name__}"
    elif type(step) is not float and (isinstance(step, bool) or not isinstance(step, Real)):
        wrong = f"`step_s` is a number of seconds, not {type(step).__name__}"
    elif not isinstance(name, str):
        wrong = f"`id` is a str, not {type(name).__name__}"
    elif not isinstance(ends, str) or ends not in get_args(Ending):
        wrong = f"`ends` is complete or cut, not {brief(ends)}"
    elif told is not None and not isinstance(told, frozenset | tuple):
        wrong = f"`told` is a frozenset of names, not {type(told).__name__}"
    for attribute, given in pairs:
        if type(given) is not dict and not isinstance(given, Mapping):
            wrong = f"`{attribute}` is a dict keyed by names of objects, not {type(given).__name__}"
    if wrong:
        raise NOT_A_TRACE.error(trace.place, wrong)


def plain_step_s(trace: Trace) -> float:
    """The step in seconds as files hold it: an int or a float, even if given as a fraction."""
    step_s: object = trace.step_s
    return step_s if isinstance(step_s, int) else float(trace.step_s)


def _is_span(given: object) -> bool:
    if not isinstance(given, tuple | list) or len(given) != 2:
        return False
    return all(isinstance(end, Integral) for end in given)


def check_presence(trace: Trace) -> None:
    """Check in which states a trace's objects are present. Raises R0501, R0505."""
    for name, span in trace.present.items():
        if not _is_span(span):
            message = (
                f"`present` has two states for `{name}`, the first and the last, not {brief(span)}"
            )
            raise NOT_A_TRACE.error(trace.place, message)
        first, last = span
        if name not in trace.objects:
            message = f"`present` names `{name}`, which is not among the trace's objects"
            raise UNKNOWN_OBJECT.error(trace.place, message)
        if not 0 <= first <= last < len(trace.states):
            message = (
                f"`present` has `{name}` in states {first} to {last}; "
                f"the trace has states 0 to {len(trace.states) - 1}"
            )
            raise UNKNOWN_OBJECT.error(trace.place, message)
