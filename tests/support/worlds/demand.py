"""Who drives and walks in a simulated world: lawful drivers and planted violators."""

import random
from dataclasses import dataclass

LAWFUL = {
    "speedFactor": "normc(0.94,0.03,0.8,0.99)",
    "sigma": "0.2",
    "tau": "1.6",
    "minGap": "2.5",
    "decel": "4.5",
    "length": "4.5",
    "width": "1.8",
    "jmDriveAfterYellowTime": "1",
    "jmTimegapMinor": "3",
    "impatience": "off",
    "jmStopSignWait": "1.2",
    "jmAllwayStopWait": "1.2",
    "lcKeepRight": "1",
}

PLANTED = {
    "red_runner": {"jmDriveAfterRedTime": "1000", "jmDriveRedSpeed": "20"},
    "speeder": {"speedFactor": "normc(1.35,0.05,1.25,1.5)"},
    "tailgater": {"tau": "0.35", "minGap": "0.8", "speedFactor": "1.0", "sigma": "0"},
    "priority_breaker": {
        "jmIgnoreFoeProb": "1",
        "jmIgnoreFoeSpeed": "50",
        "jmIgnoreJunctionFoeProb": "1",
        "jmStopSignWait": "0",
        "jmAllwayStopWait": "0",
    },
    "pedestrian_breaker": {
        "jmIgnoreFoeProb": "1",
        "jmIgnoreFoeSpeed": "50",
        "jmIgnoreJunctionFoeProb": "1",
    },
    "right_overtaker": {
        "lcOvertakeRight": "1",
        "lcSpeedGain": "2",
        "lcKeepRight": "0",
        "speedFactor": "0.99",
    },
    "left_hogger": {
        "speedFactor": "normc(0.66,0.02,0.62,0.70)",
        "lcKeepRight": "0",
        "lcSpeedGain": "0",
        "lcCooperative": "0",
    },
}
"""Violators by what of SUMO's parameters makes them so; the hogger is whom others pass."""


@dataclass(frozen=True, kw_only=True)
class Demand:
    """How many depart at random in so many seconds; ``planted``: violator -> share of all."""

    vehicles: int
    over_s: int
    planted: dict[str, float]
    walkers: int = 0
    headway_s: float = 1.6


def routes(demand, net, seed):
    """The text of a file of SUMO's routes."""
    pick = random.Random(seed * 7919 + 13)
    usual = {"tau": str(demand.headway_s)}
    types = ['<vType id="walker" vClass="pedestrian"/>', _type("lawful", usual)]
    types += [_type(name, usual | PLANTED[name]) for name in demand.planted]
    moments = sorted(round(pick.uniform(0, demand.over_s), 1) for _ in range(demand.vehicles))
    bodies = [(at, _trip(number, at, demand, net, pick)) for number, at in enumerate(moments)]
    bodies += _walkers(demand, net, pick)
    rows = "\n".join(row for _, row in sorted(bodies))
    return "<routes>\n" + "\n".join(types) + "\n" + rows + "\n</routes>\n"


def _type(name, more):
    words = " ".join(f'{key}="{value}"' for key, value in (LAWFUL | more).items())
    blind = '<param key="junctionModel.ignoreTypes" value="walker"/>'
    inside = blind if name == "pedestrian_breaker" else ""
    return f'<vType id="{name}" vClass="passenger" {words}>{inside}</vType>'


def _trip(number, at, demand, net, pick):
    kind = _kind(demand.planted, pick)
    start, end = _ends(net, pick)
    lane = "best" if len(net.edges[start].lanes) < 3 else "random"
    if kind == "left_hogger" and len(net.edges[start].lanes) == 3:
        lane = pick.choice(("1", "2"))
    words = f'departLane="{lane}" departSpeed="max" departPos="base"'
    name = f"{kind}.{number}"
    return f'<trip id="{name}" type="{kind}" depart="{at}" from="{start}" to="{end}" {words}/>'


def _kind(planted, pick):
    left = pick.random()
    for name, share in planted.items():
        if left < share:
            return name
        left -= share
    return "lawful"


def _ends(net, pick):
    while True:
        start, end = pick.choice(net.entries), pick.choice(net.exits)
        if net.edges[start].start != net.edges[end].end:
            return start, end


def _walkers(demand, net, pick):
    """People who cross the road at one of its crossings, from 5 to 40 m away on the pavement."""
    found = []
    for number in range(demand.walkers):
        ends = list(pick.choice(net.crossings))
        pick.shuffle(ends)
        begin, end = (_along(net, edge, pick.uniform(5, 40)) for edge in ends)
        at = round(pick.uniform(0, demand.over_s), 1)
        walk = f'<walk edges="{" ".join(ends)}" arrivalPos="{end:.1f}"/>'
        name = f'id="walker.{number}" depart="{at}" departPos="{begin:.1f}"'
        found.append((at, f'<person type="walker" {name}>{walk}</person>'))
    return found


def _along(net, edge, away):
    """Where on an edge one is so far from the crossing at the end where it has one."""
    ends_there = any(
        edge in pair and net.edges[edge].end in {net.edges[other].start for other in pair}
        for pair in net.crossings
    )
    return net.edges[edge].length - away if ends_there else away
