"""The kinds of simulated worlds, each with its planted violators."""

from support.worlds.demand import Demand
from support.worlds.simulate import WorldKind

_TOWN = {"red_runner": 0.3, "speeder": 0.12, "tailgater": 0.2}
_BREAKERS = {"priority_breaker": 0.6, "speeder": 0.08}


def _kinds():
    lights = Demand(vehicles=26, over_s=40, planted=_TOWN)
    # More would only stand in queues, where nobody takes anybody's way
    crowded = Demand(vehicles=30, over_s=40, planted=_BREAKERS)
    zebra = Demand(
        vehicles=30, over_s=60, planted={"pedestrian_breaker": 0.4, "speeder": 0.08}, walkers=26
    )
    lanes = {"speeder": 0.1, "tailgater": 0.12, "right_overtaker": 0.25, "left_hogger": 0.2}
    motorway = Demand(vehicles=30, over_s=50, planted=lanes, headway_s=2.4)
    for hand, book in (("", "de"), ("_left", "gb")):
        more = {"book": book, "lefthand": bool(hand)}
        town = more | {"demand": lights, "ends_s": 70}
        junction = more | {"demand": crowded, "ends_s": 65}
        signs = junction | {"book": "gb" if hand else "fr"}
        # Where all have to stop who came first goes first in California, and nobody in Britain
        all_stop = junction | {"book": "gb" if hand else "us-ca"}
        yield WorldKind(name=f"grid{hand}", layout="lights", **town)
        yield WorldKind(name=f"spider{hand}", layout="spider", **town)
        yield WorldKind(name=f"wide_grid{hand}", layout="wide_lights", **town)
        yield WorldKind(name=f"priority{hand}", layout="priority", **signs)
        yield WorldKind(name=f"stop_signs{hand}", layout="priority_stop", **junction)
        yield WorldKind(name=f"all_way_stop{hand}", layout="allway_stop", **all_stop)
        yield WorldKind(name=f"roundabout{hand}", layout="roundabout", **junction)
        yield WorldKind(name=f"zebra{hand}", layout="zebra", demand=zebra, **more)
        yield WorldKind(name=f"motorway{hand}", layout="motorway", demand=motorway, **more)
        yield WorldKind(name=f"merge{hand}", layout="merge", demand=motorway, **more)
    # In Britain nobody has priority at a junction without signs
    yield WorldKind(
        name="right_before_left", layout="right_before_left", demand=crowded, ends_s=65, book="de"
    )


KINDS = {kind.name: kind for kind in _kinds()}
