"""Trajectories of maneuvers as drives that were recorded, and what these say in the layers."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice, pairwise

import numpy as np

from rulec.cell_words.probe_drives import body_along, world_of
from rulec.extraction.recording_verdicts import names_read
from rulec.extraction.signals.settling import fewest_states
from rulec.extraction.traces.recorded_drive import Drive
from rulec.extraction.traces.to_trace import TraceWriter
from rulec.extraction.traffic_thresholds import LEAST_S
from rulec.planning.ranking.cheapest import cheapest
from rulec.vocabulary.partial_values import UNKNOWN, Interval, OneOf

_EDGE_M = 0.05
"""So well places are known."""

_ON_S, _ON_MPS, _ON_MPS2 = 8.0, 10.0, 3.0
"""For how long a motion goes on, and how fast; it speeds up by no more than the third."""


def witnesses(found, most):
    """Maneuvers that violate nothing for sure, the cheapest first, each with its trajectory."""
    paths = (path.nodes for path in islice(cheapest(found.possible), 40 * most))
    driven = ((nodes, found.witness_search.of(nodes)) for nodes in paths)
    return list(islice((pair for pair in driven if pair[1] is not None), most))


def sampled(states, step_s, count):
    """Place and speed, along and across, at multiples of a step."""
    rows = []
    for time in np.arange(count) * step_s:
        (t0, s0, v0, d0, w0), (t1, _, v1, _, w1) = next(
            pair for pair in pairwise(states) if time <= pair[1][0] + 1e-9
        )
        x, piece = time - t0, t1 - t0
        along, across = (v1 - v0) / piece, (w1 - w0) / piece
        rows.append(
            (
                s0 + v0 * x + along * x * x / 2,
                v0 + along * x,
                d0 + w0 * x + across * x * x / 2,
                w0 + across * x,
            )
        )
    return np.array(rows)


def _going_on(motion, step_s, count):
    """A motion that goes on along the road, so that its drive shows which one that is."""
    s, v, d, _ = motion[-1]
    times = step_s * np.arange(1, count + 1)
    fast = max(v, _ON_MPS)
    for_s = np.minimum(times, (fast - v) / _ON_MPS2)
    speeds = v + _ON_MPS2 * for_s
    places = s + v * for_s + _ON_MPS2 * for_s**2 / 2 + fast * (times - for_s)
    onward = np.column_stack((places, speeds, np.full(count, d), np.zeros(count)))
    return np.concatenate((motion, onward))


def states_of(found):
    """The recording's step (s), and how many states of it a maneuver has."""
    graph = found.graph
    step_s = graph.scenario.account.origin.recording.step_s
    return step_s, round((len(graph.layers) - 1) * graph.step_s / step_s) + 1


def drives_of(found, motions):
    """The drive of each motion, given by place and speed along and across in each state.

    None in place of one that leaves the map, or the scene's road: its words are about another one.
    """
    graph, origin = found.graph, found.graph.scenario.account.origin
    step_s, count = states_of(found)
    after = round(_ON_S / step_s)
    bodies = []
    for motion in motions:
        s, v, d, w = _going_on(motion, step_s, after).T
        turned = np.where(v > 0.05, np.arctan2(w, np.maximum(v, 1e-6)), 0.0)
        row = s, d, np.clip(turned, -np.pi / 4, np.pi / 4)
        bodies.append(body_along(graph, origin, row, np.hypot(v, w)))
    among = world_of(origin, bodies[0], found.rules.traffic or "right", count + after)
    writer = TraceWriter(found.rules.vocabulary, names_read(found.rules))
    road = among.map.road(origin.way)
    rows = () if isinstance(road, str) else road[0].rows
    lanelets = {lanelet.id for row in rows for lanelet in row if lanelet is not None}
    for drives in among.of(bodies, writer):
        own = [drive for drive in drives if isinstance(drive, Drive)]
        # One that leaves the map in between has several
        there = len(own) == 1 and own[0].first_step == origin.start.step
        stays = there and all(place.lanelet in lanelets for place in own[0].places)
        yield own[0] if stays else None


def in_layers(found, drive):
    """A drive's trace with its states in the layers alone, as a complete one.

    None if the layers are not among its states.
    """
    graph = found.graph
    per_layer = graph.step_s / states_of(found)[0]
    every, last = round(per_layer), len(graph.layers) - 1
    if abs(per_layer - every) > 1e-6 or drive.arrays.n_states < every * last + 1:
        return None
    trace = of_some_states(drive.arrays.trace(), range(0, every * last + 1, every))
    return replace(trace, step_s=graph.step_s, ends="complete")


def of_some_states(trace, chosen):
    """The trace of some of its states, and the objects that are present in any of them."""
    there = {}
    for name in trace.objects:
        first, last = trace.present.get(name, (0, len(trace.states) - 1))
        there[name] = [n for n, state in enumerate(chosen) if first <= state <= last]
    return replace(
        trace,
        objects={name: kind for name, kind in trace.objects.items() if there[name]},
        states=tuple([trace.states[state] for state in chosen]),
        present={
            name: (own[0], own[-1]) for name, own in there.items() if 0 < len(own) < len(chosen)
        },
    )


def on_an_edge(found, nodes, motion):
    """Whether ego is on the border of a cell, across the road, when a layer begins.

    Or is so near to it that it gets beyond and back before that is more than noise.
    """
    graph, step_s = found.graph, states_of(found)[0]
    places = motion[:: round(graph.step_s / step_s), 2]
    rows = zip(graph.layers, nodes, places, strict=True)
    return any(_is_near_an_edge(found, layer.cells[node], d) for layer, node, d in rows)


def begins_on_an_edge(found):
    """Whether ego begins on the border of a cell, so that all its motions are on one."""
    graph = found.graph
    return _is_near_an_edge(found, graph.layers[0].cells[graph.start], graph.scenario.ego.d)


def _is_near_an_edge(found, cell, d):
    step_s = states_of(found)[0]
    least = fewest_states(LEAST_S["lateral"], step_s)
    most = found.graph.bounds.lateral_acceleration
    beyond = most * (least * step_s) ** 2 / 8 if least > 1 else 0.0
    edges = [edge for box in cell.boxes for edge in (box.d_min, box.d_max)]
    return min(abs(d - edge) for edge in edges) < _EDGE_M + beyond


def disagreeing(of_drive, mine):
    """What the verdicts on a drive and on its maneuver say for sure, and the other one otherwise.

    A drive violates nothing that the maneuver keeps, and keeps nothing that it violates.
    """
    own, own_doubtful = _keys(of_drive.violations), _keys(of_drive.open)
    violated, doubtful = _keys(mine.violations), _keys(mine.open)
    dark = {rule.rule for rule in mine.not_judged}
    yield from (key for key in own - violated - doubtful if key[0] not in dark)
    dark = {rule.rule for rule in of_drive.not_judged}
    yield from (key for key in violated - own - own_doubtful if key[0] not in dark)


def _keys(results):
    return {(one.rule, tuple(sorted(one.binding.items()))) for one in results}


def contradicting(found, nodes, trace):
    """What cells say that a trace through them contradicts: layer, name, object, both values."""
    for layer, (node, theirs) in enumerate(zip(nodes, trace.states, strict=True)):
        for name, value in found.paths.states[layer][node].items():
            own = value.items() if isinstance(value, dict) else [(None, value)]
            for item, said in own:
                known = theirs.get(name, UNKNOWN)
                if isinstance(known, dict):
                    known = known.get(item, UNKNOWN)
                if not contains(said, known):
                    yield layer, name, item, said, known


def contains(said, known):
    """Whether a value that is known is among those that a cell leaves open."""
    if said is UNKNOWN or known is UNKNOWN:
        return True
    if isinstance(said, OneOf):
        return known in said.values
    low, high = (known.low, known.high) if isinstance(known, Interval) else (known, known)
    if isinstance(said, Interval):
        # What was measured is within both
        return said.low - 1e-6 <= high and low <= said.high + 1e-6
    return low <= said <= high if isinstance(known, Interval) else said == known
