"""Maneuvers compared with drives through them: verdicts and words agree, or one of them is open."""

from __future__ import annotations

import numpy as np

from rulec import Maneuver, verify_many
from support.generators.driven_motions import paths_of
from support.generators.motion_kinds import KINDS, of_a_kind
from support.oracles.witness_drives import (
    contradicting,
    disagreeing,
    drives_of,
    in_layers,
    on_an_edge,
    sampled,
    states_of,
    witnesses,
)

AT_ONCE = 50

TRIED = 5
"""So many times as many motions are tried at most."""


def check(found, most):
    """Compare some maneuvers with the drives of their trajectories."""
    pairs = witnesses(found, most) if found.traces else []
    step_s, count = states_of(found)
    return compared(
        found,
        [(nodes, sampled(trajectory.states, step_s, count)) for nodes, trajectory in pairs],
    )


def compared(found, pairs, *, words=True, edges=False):
    """Compare maneuvers with drives through them, their verdicts and words: how many were drives.

    Of random motions in recordings only verdicts are: where maps are beside their tracks, sides are
    in doubt, and settled by how a drive goes on. So they are on the ``edges`` of cells.
    """
    drives = drives_of(found, [motion for _, motion in pairs]) if pairs else ()
    traced = [
        (nodes, trace)
        for (nodes, motion), drive in zip(pairs, drives, strict=True)
        if drive is not None
        and (trace := in_layers(found, drive)) is not None
        and (edges or not on_an_edge(found, nodes, motion))
    ]
    # Many motions take the same maneuver
    verdicts = {nodes: found.verdict(Maneuver(nodes, 0.0, None)) for nodes, _ in traced}
    of_drives = verify_many([trace for _, trace in traced], found.rules)
    for (nodes, trace), of_drive in zip(traced, of_drives, strict=True):
        assert not words or list(contradicting(found, nodes, trace)) == []
        assert list(disagreeing(of_drive, verdicts[nodes])) == []
    return len(traced)


def check_on_edges(found, number, chance):
    """Compare the verdicts of random motions with those of all cells that they may be in.

    As for motions that are exactly where cells meet: how many were compared.
    """
    graph, (step_s, count) = found.graph, states_of(found)
    every, pairs = round(graph.step_s / step_s), []
    for _ in range(number):
        kind = chance.choice(KINDS)
        motion = np.array(of_a_kind(kind, graph.scenario, graph.bounds, step_s, count, chance))
        path = paths_of(graph, motion[::every].tolist())
        if path is not None:
            pairs.append((_one_of(graph, path, chance), motion))
    return compared(found, pairs, words=False, edges=True)


def _one_of(graph, path, chance):
    """A path through some cells of each layer, all of which are on one."""
    nodes = [chance.choice(sorted(path[0]))]
    for rows, cells in zip(graph.successors, path[1:], strict=True):
        nodes.append(chance.choice(sorted(cells.intersection(rows[nodes[-1]]))))
    return tuple(nodes)


def check_sampled(found, number, chance, *, words=False):
    """Compare so many random motions with the maneuvers that they are: how many were.

    Fewer if too many of them leave the cells, or keep to where cells meet.
    """
    graph, (step_s, count) = found.graph, states_of(found)
    if graph.step_s < step_s:
        return 0  # No drive has states in layers between the recording's own
    every = round(graph.step_s / step_s)
    pairs, compared_so_far = [], 0
    for left in reversed(range(TRIED * number)):
        kind = chance.choice(KINDS)
        motion = np.array(of_a_kind(kind, graph.scenario, graph.bounds, step_s, count, chance))
        path = paths_of(graph, motion[::every].tolist())
        if path is not None and all(len(cells) == 1 for cells in path):
            pairs.append((tuple(next(iter(cells)) for cells in path), motion))
        if len(pairs) == AT_ONCE or not left:
            compared_so_far += compared(found, pairs, words=words)
            pairs = []
        if compared_so_far >= number:
            break
    return compared_so_far
