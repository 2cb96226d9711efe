"""Traffic lights of an ASAM OSI trace: bulbs, their heads, and what each lane is shown.

In the standard each bulb is a light of its own, with colour, icon and mode; the bulbs of one head
are assigned to the same lanes and stand within a metre. Some simulators write one light that
changes its colour, which is a head with a single bulb.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from rulec.recordings.encodings.wire_format import Fields, WireFile
from rulec.recordings.osi.message_fields import assigned_lanes, number, part
from rulec.recordings.osi.message_times import TimeGrid
from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import Lanelet, ObservedLight, Points

_TOLD = {"off": 1, "red": 2, "yellow": 3, "green": 4}
_BLINKS = 5
_SHOWN = ("off", "constant", "flashing", "counting")
_COLOURS = ("red", "yellow", "green")

_ANYWHERE = frozenset({"left", "straight", "right"})
ICONS: Mapping[str, frozenset[str]] = {
    **dict.fromkeys(("none", "unknown", "other", "down"), _ANYWHERE),
    **dict.fromkeys(("countdown_seconds", "countdown_percent"), _ANYWHERE),
    "straight_ahead": frozenset({"straight"}),
    **dict.fromkeys(("left", "diag_left", "down_left"), frozenset({"left"})),
    **dict.fromkeys(("right", "diag_right", "down_right"), frozenset({"right"})),
    "straight_ahead_left": frozenset({"straight", "left"}),
    "straight_ahead_right": frozenset({"straight", "right"}),
    "left_right": frozenset({"left", "right"}),
}
"""Icon -> the directions that it applies to, for icons for vehicles.

Icons that are not listed are for pedestrians, cycles, buses or trams, or, as a cross, close a lane.
"""

_HEAD_M = 1.0
_TURNED = np.radians(30.0)


@dataclass(slots=True)
class Bulb:
    """A light of a trace read so far: what it showed at each moment."""

    id: str
    icon: str
    place: tuple[float, float]
    lanes: tuple[str, ...]
    codes: bytearray = field(default_factory=bytearray)

    @classmethod
    def of(cls, key: str, fields: Fields, file: WireFile) -> Bulb:
        """The light in a message. Raises RulecError R0610."""
        place = part(fields, "base", "position")
        kind = part(fields, "classification")
        return cls(
            id=key,
            icon=kind.get("icon", "unknown"),
            place=(number(place, "x", file), number(place, "y", file)),
            lanes=assigned_lanes(kind),
        )

    def add(self, moment: int, fields: Fields) -> None:
        """Note what it shows at a moment; at moments without a message its state is unknown."""
        self.codes.extend(bytes(max(moment + 1 - len(self.codes), 0)))
        state = part(fields, "classification")
        mode, colour = state.get("mode"), state.get("color")
        code = 0
        if state.get("is_out_of_service") or mode == "off":
            code = _TOLD["off"]
        elif colour in _COLOURS and mode in _SHOWN:
            code = _BLINKS if mode == "flashing" and colour == "yellow" else _TOLD[colour]
        self.codes[moment] = code


@dataclass(frozen=True, slots=True)
class Head:
    """Bulbs that stand together: the directions that they apply to, and what they show by step."""

    directions: frozenset[str]
    has_red: bool
    colours: Mapping[int, str]


def with_lights(
    lanelets: Mapping[str, Lanelet],
    bulbs: Iterable[Bulb],
    of_lane: Mapping[str, Sequence[str]],
    grid: TimeGrid,
) -> dict[str, Lanelet]:
    """The lanelets with the lights that their lanes were shown.

    ``of_lane``: the lanelets of each lane of the trace. A light assigned to a way through an
    intersection applies to traffic that takes that way.
    """
    by_lane: dict[str, list[Bulb]] = defaultdict(list)
    for bulb in bulbs:
        if bulb.icon in ICONS:
            for lane in bulb.lanes:
                for name in of_lane.get(lane, ()):
                    by_lane[name].append(bulb)
    heads: dict[tuple[str, ...], list[Head]] = {}
    lit = dict(lanelets)
    to_way: dict[str, dict[str, list[Head]]] = defaultdict(dict)
    own: dict[str, list[Head]] = {}
    for name, there in by_lane.items():
        key = tuple(bulb.id for bulb in there)
        if key not in heads:
            heads[key] = _heads(there, grid)
        lanelet = lanelets[name]
        if "intersection" in lanelet.types and lanelet.predecessors:
            for before in lanelet.predecessors:
                to_way[before][name] = heads[key]
        else:
            own[name] = heads[key]
    for name in {**own, **to_way}:
        lit[name] = _lit(lanelets, lanelets[name], own.get(name, []), to_way[name])
    return lit


def _lit(
    lanelets: Mapping[str, Lanelet],
    lanelet: Lanelet,
    own: Sequence[Head],
    to_way: Mapping[str, Sequence[Head]],
) -> Lanelet:
    """A lanelet with its lights, separately for each way onward if these differ."""
    known = [lanelets[x] for x in lanelet.successors if x in lanelets]
    by_way = {
        onward.id: _combined(
            [*to_way.get(onward.id, ()), *_towards(own, _direction(lanelet, onward))]
        )
        for onward in known
    }
    whole = _combined(_towards(own, None)) if own else None
    light_of = {way: light for way, light in by_way.items() if light is not None}
    if not light_of:
        return replace(lanelet, lights=() if whole is None else (whole,))
    different = {id(x.colours): x for x in light_of.values()}
    lights = tuple(different.values())
    same = len(light_of) == len(known) and all(x.colours == lights[0].colours for x in lights)
    if same:
        return replace(lanelet, lights=lights[:1])
    return replace(lanelet, lights=lights, lights_to=light_of)


def _direction(lanelet: Lanelet, onward: Lanelet) -> str:
    """The direction of the way onward, from how it ends."""
    before, after = (_heading(x.centre[-2:]) for x in (lanelet, onward))
    turned = wrapped(after - before)
    return "straight" if abs(turned) < _TURNED else "left" if turned > 0 else "right"


def _heading(pair: Points) -> float:
    step = pair[1] - pair[0]
    return float(np.arctan2(step[1], step[0]))


def _towards(heads: Sequence[Head], direction: str | None) -> list[Head]:
    """The heads for a direction: those with arrows that apply to it, else all heads."""
    heads = [x for x in heads if direction is None or direction in x.directions]
    arrows = [x for x in heads if x.directions != _ANYWHERE and x.has_red]
    return arrows if arrows and direction is not None else heads


def _combined(heads: Sequence[Head]) -> ObservedLight | None:
    """What several heads show together: the same state, or one allows what another does not."""
    if not heads:
        return None
    if len(heads) == 1:
        return ObservedLight(heads[0].colours)
    colours = {}
    for step in heads[0].colours.keys() | {x for head in heads[1:] for x in head.colours}:
        shown = {head.colours.get(step, "") for head in heads} - {"inactive"}
        if len(shown) < 2:
            colours[step] = next(iter(shown), "inactive")
        elif "" not in shown and "green" in shown and any(not head.has_red for head in heads):
            # A green arrow beside a red light
            colours[step] = "green"
    return ObservedLight({step: colour for step, colour in colours.items() if colour})


def _heads(bulbs: Sequence[Bulb], grid: TimeGrid) -> list[Head]:
    """The heads of a lane's bulbs: bulbs with the same icons that stand together."""
    groups: list[list[Bulb]] = []
    for bulb in bulbs:
        for group in groups:
            away = np.subtract(bulb.place, group[0].place)
            if ICONS[bulb.icon] == ICONS[group[0].icon] and float(np.hypot(*away)) <= _HEAD_M:
                group.append(bulb)
                break
        else:
            groups.append([bulb])
    return [_head(group, grid) for group in groups]


def _head(bulbs: Sequence[Bulb], grid: TimeGrid) -> Head:
    count = len(grid.steps)
    rows = np.zeros((len(bulbs), count), dtype=np.uint8)
    for row, bulb in zip(rows, bulbs, strict=True):
        row[: len(bulb.codes)] = np.frombuffer(bytes(bulb.codes), dtype=np.uint8)
    known = (rows > 0).all(axis=0)
    red, yellow, green = ((rows == _TOLD[colour]).any(axis=0) for colour in _COLOURS)
    colours = {}
    for moment in np.flatnonzero(known).tolist():
        colours[int(grid.steps[moment])] = _colour(red[moment], yellow[moment], green[moment])
    has_red = bool(red.any()) or len(bulbs) > 1
    return Head(ICONS[bulbs[0].icon], has_red, {x: c for x, c in colours.items() if c})


def _colour(red: bool, yellow: bool, green: bool) -> str:
    """A head's colour, empty for an unusual combination; a flashing bulb counts as off."""
    if red and green:
        return ""
    if red:
        return "redYellow" if yellow else "red"
    if green:
        return "" if yellow else "green"
    return "yellow" if yellow else "inactive"
