"""Grids of streets with two lanes each way, whose lanelets overlap in the junctions."""

from itertools import product

import numpy as np

from support.builders.recordings import lanelet

SPACING_M = 80.0
REACH_M = 15.0
LANES_M = (2.0, 6.0)
"""How far the middles of the lanes lie to the right of the street's."""

_AHEAD = ((1, 0), (0, 1), (-1, 0), (0, -1))


def street(node, way, lane):
    """The id of the lane that leads from a node in a direction (0 is along the x axis)."""
    return f"{node[0]},{node[1]}>{way}/{lane}"


def curve(start, end, leaves, arrives):
    """A quadratic Bézier curve: straight where it leads straight on."""
    if leaves == arrives:
        middle = (start + end) / 2
    else:
        middle = np.where(np.array(_AHEAD[leaves]) != 0, end, start)
    part = np.linspace(0.0, 1.0, 15)[:, None]
    return (1 - part) ** 2 * start + 2 * part * (1 - part) * middle + part**2 * end


def lanelet_grid(count):
    """The lanelets of a grid of so many junctions a side, and the ways between its streets.

    From the right lane one turns right or goes straight on, from the left one straight on or left.
    """
    centres, successors = {}, {}
    for node, way, (lane, off) in product(
        product(range(count), repeat=2), range(4), enumerate(LANES_M)
    ):
        ahead = np.array(_AHEAD[way], dtype=float)
        to = (node[0] + _AHEAD[way][0], node[1] + _AHEAD[way][1])
        if not all(0 <= x < count for x in to):
            continue
        right = np.array([ahead[1], -ahead[0]]) * off
        start, end = (np.array(place) * SPACING_M + right for place in (node, to))
        own = street(node, way, lane)
        centres[own] = np.array([start + ahead * REACH_M, end - ahead * REACH_M])
        successors[own] = []
        for turned in (0, -1) if lane == 0 else (0, 1):
            onto = (way + turned) % 4
            after = (to[0] + _AHEAD[onto][0], to[1] + _AHEAD[onto][1])
            if all(0 <= x < count for x in after):
                successors[own].append(street(to, onto, lane))
    lanelets = []
    for own, after in successors.items():
        lane = own[-1]
        beside = own[:-1] + ("1" if lane == "0" else "0")
        where = {"left_of": beside} if lane == "0" else {"right_of": beside}
        through = [f"{own}-{end}" for end in after]
        lanelets.append(lanelet(own, centres[own], successors=through, **where))
        for name, end in zip(through, after, strict=True):
            leaves, arrives = (int(x.split(">")[1][0]) for x in (own, end))
            line = curve(centres[own][-1], centres[end][0], leaves, arrives)
            lanelets.append(lanelet(name, line, successors=(end,), predecessors=(own,)))
    return lanelets
