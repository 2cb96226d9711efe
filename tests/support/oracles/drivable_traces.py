"""What physics and roads allow of a trace in the words of `road`, written without the search.

It looks at the values of the words that some rule reads; of others nothing is said.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

MOST_MPS2, MOST_FASTER_MPS2 = 12.0, 7.0
"""No car brakes harder, or speeds up harder."""

MOST_MPS = 70.0
NEAR_M = 10.0
LOOSE_M, LOOSE_S = 4.0, 0.5
"""So well distances and times ahead fit the way driven."""

LASTING = ("lanes", "one_way", "divided", "marked_lanes", "road_class", "ego_type", "ego_length")
LASTING_OF_OTHERS = ("two_wheeled", "oncoming")
DISTANCES = ("distance_to_crossing", "distance_to_junction", "distance_to_stop_line")
MOVES = (
    *("enters_junction", "enters_roundabout", "enters_level_crossing", "lane_change"),
    *("crosses_stop_line", "crosses_light_line", "overtaking"),
)


@dataclass(frozen=True)
class _Words:
    """The words of one state: None for those that no rule reads."""

    state: Mapping
    names: frozenset
    declarations: Mapping

    def __call__(self, name, other=None):
        if name not in self.names:
            return None
        value = self.state.get(name)
        if other is not None and value is not None:
            value = value.get(other)
        return self.declarations[name].default if value is None else value


def doubts(trace, names, vocabulary) -> list[str]:
    """What of a trace no car can drive or no road can be, in words."""
    states = [_Words(state, frozenset(names), vocabulary.declarations) for state in trace.states]
    others = [
        name for name, kind in trace.objects.items() if vocabulary.is_subtype(kind, "road_user")
    ]
    vehicles = {name for name in others if vocabulary.is_subtype(trace.objects[name], "vehicle")}
    found = []
    for number, words in enumerate(states):
        told = [*_of_ego(words), *_of_road(words)]
        for other in others:
            told += _of_other(words, other, is_vehicle=other in vehicles)
        found += [f"{number}: {doubt}" for doubt in told]
    for number, (before, after) in enumerate(pairwise(states)):
        told = [*_of_motion(before, after, trace.step_s), *_of_change(before, after, others)]
        found += [f"{number} to {number + 1}: {doubt}" for doubt in told]
    return found


def _of_ego(words) -> Iterator[str]:
    speed, stops = words("speed"), words("can_stop_at_once")
    if speed is not None:
        if not 0 <= speed <= MOST_MPS * 3.6:
            yield f"{speed} km/h"
        for name in MOVES:
            if words(name) and speed == 0:
                yield f"{name} while it stands"
        if stops is False and speed <= 20:
            yield f"cannot stop at once at {speed} km/h"
        if stops and speed >= 50:
            yield f"stops at once at {speed} km/h"
        if (words("time_to_stop_line") or 0) > 0 and speed == 0:
            yield "stands and comes nearer to the line"
        if words("reversing") and speed > 30:
            yield f"reverses at {speed} km/h"
        if words("ego_type") in ("ego_cycle", "ego_moped") and speed > 70:
            yield f"a light vehicle at {speed} km/h"
    mass, length = words("ego_mass"), words("ego_length")
    if words("ego_type") == "ego_car" and mass is not None and mass > 5:
        yield f"a car of {mass} t"
    if words("ego_type") == "ego_car" and words("ego_tows") is False and (length or 0) > 8:
        yield f"a car of {length} m"
    if words("told_to_stop") and words("told_to_go"):
        yield "told to stop and to go"
    if words("joins_road") and (words("u_turn") or words("turn") == "turn_round"):
        yield "sets off and turns round"


def _of_road(words) -> Iterator[str]:
    crossing, junction = words("distance_to_crossing"), words("distance_to_junction")
    if (words("surface") == "crossing" or words("crossing_zone")) and (crossing or 0) > NEAR_M:
        yield f"at a crossing that is {crossing} m away"
    if (words("junction_zone") or words("enters_junction")) and (junction or 0) > NEAR_M:
        yield f"at a junction that is {junction} m away"
    if words("u_turn") and (words("junction_zone") or words("enters_junction")):
        yield "turns round away from junctions and is at one"
    if words("enters_junction") and words("enters_roundabout"):
        yield "drives into a junction and a roundabout"
    line = words("distance_to_stop_line")
    if words("crosses_stop_line") and line is not None and line > NEAR_M:
        yield f"crosses a line that is {line} m away"
    lane, lanes = words("lane"), words("lanes")
    if lanes == "one_lane" and lane in ("middle_lane", "far_lane"):
        yield f"on the {lane} of one lane"
    if lanes == "two_lanes" and lane == "middle_lane":
        yield "between two lanes"
    if words("driving_side") == "oncoming_side" and (words("one_way") or words("divided")):
        yield "on the other side of a road that has none"
    if words("merged") and words("narrowing"):
        yield "before and after a narrowing"
    signs = words("stop_sign") or words("give_way_sign")
    if signs and words("light") in ("green_light", "amber_light", "red_light"):
        yield "a light and a sign that it overrides"
    if words("own_road_ends") and words("other_road_ends"):
        yield "both roads end"
    least = words("minimum_limit")
    if least and (least % 10 or least < 20):
        yield f"a sign with {least} km/h"


def _of_other(words, other, *, is_vehicle) -> Iterator[str]:
    station, lateral = words("station", other), words("lateral", other)
    speed, faster = words("speed"), words("speed_difference", other)
    stopped, oncoming = words("stopped", other), words("oncoming", other)
    if words("on_shoulder", other) and lateral == "same_lane":
        yield "beside the road and in ego's lane"
    if words("precedes", other) and (
        station not in (None, "behind") or lateral not in (None, "same_lane")
    ):
        yield "the next one ahead is elsewhere"
    if stopped is False and any(
        words(name, other) for name in ("parked", "boarding", "stopped_for_pedestrian")
    ):
        yield "stands and moves"
    if stopped and words("goes_across", other):
        yield "stands and crosses"
    if None not in (speed, faster):
        if stopped and faster != speed:
            yield f"stands, at {speed - faster} km/h"
        if oncoming is False and faster > speed:
            yield f"goes ego's way at {speed - faster} km/h"
    gap, headway = words("gap", other), words("time_headway", other)
    across = words("lateral_gap", other)
    if (gap is not None and gap < 0.5) or (across is not None and across < 0.3):
        yield "touches ego"
    most_mps = MOST_MPS if speed is None else speed / 3.6
    if words("safe_gap", other) is False and (gap or 0) > NEAR_M + 4 * most_mps:
        yield f"too near at {gap} m"
    if gap is not None and headway is not None and headway < 1000:
        slow, fast = (0, MOST_MPS) if speed is None else (speed / 3.6, speed / 3.6)
        if not slow * headway / 2 - 1 <= gap <= 2 * fast * headway + 1:
            yield f"{gap} m away, and {headway} s"
    if (
        is_vehicle
        and (station, oncoming) == ("beside", False)
        and lateral in ("left_of", "right_of")
    ):
        one_lane = words("lanes") == "one_lane" and words("driving_side") == "own_side"
        if one_lane and words("on_shoulder", other) is False:
            yield "two vehicles abreast in one lane"
    if words("abreast_at_narrowing", other) and words("narrowing") is False:
        yield "abreast where nothing narrows"


def _of_motion(before, after, step_s) -> Iterator[str]:
    speeds = [words("speed") for words in (before, after)]
    low, high = 0.0, MOST_MPS * step_s
    if None not in speeds:
        faster = (speeds[1] - speeds[0]) / 3.6
        if not -MOST_MPS2 * step_s <= faster <= MOST_FASTER_MPS2 * step_s:
            yield f"from {speeds[0]} to {speeds[1]} km/h"
        low, high = (step_s * speed / 3.6 for speed in sorted(speeds))
    for name in DISTANCES:
        then, now = before(name), after(name)
        if then is None or then == now == before.declarations[name].default:
            continue
        if then <= high + NEAR_M and now in (0, 1000):
            continue  # passed, and nothing else is ahead
        if not low - LOOSE_M <= then - now <= high + LOOSE_M:
            yield f"{name} from {then} to {now} m"
    then, now = before("time_to_stop_line"), after("time_to_stop_line")
    if then and (now or then > step_s + LOOSE_S) and abs(then - now - step_s) > LOOSE_S:
        yield f"the line {then} s away, then {now} s"


def _of_change(before, after, others) -> Iterator[str]:
    for name in LASTING:
        if before(name) != after(name):
            yield f"{name} from {before(name)} to {after(name)}"
    if after("light") == "amber_light" and before("light") not in ("amber_light", "green_light"):
        yield "amber not after green"
    for other in others:
        for name in LASTING_OF_OTHERS:
            if before(name, other) != after(name, other):
                yield f"{name} changes"
        if {before("station", other), after("station", other)} == {"behind", "in_front_of"}:
            yield "past another one without being beside"
        if {before("lateral", other), after("lateral", other)} == {"left_of", "right_of"}:
            yield "from one side of another one to the other"
        if after("boarding", other) and before("stopped", other) is False:
            yield "boards as soon as it stands"
