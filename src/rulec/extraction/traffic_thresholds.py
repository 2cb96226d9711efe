"""The numbers that decide what recorded traffic is called. ``docs/recordings.md`` explains them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from types import MappingProxyType

from rulec.diagnostics import did_you_mean, named
from rulec.recordings.mending.mended_recording import LONGEST_HOLE_S
from rulec.scenario.recorded.lane_coordinates import TOUCHING_M
from rulec.value_display import brief, short_repr

LARGEST = 1_000_000.0
"""A threshold in m, s or km/h that is larger means nothing on a road, and overflows."""


@dataclass(frozen=True, slots=True)
class Thresholds:
    """The thresholds that turn positions into words; units end their names.

    Speeds and accelerations are taken from positions, over ``smoothing_s`` around each moment:
    positions are noisy, and what some files say of speeds is another matter than where their
    vehicles are. Below ``standing_kmh`` a vehicle stands.
    """

    __repr__ = short_repr

    place_error_m: float = 0.0
    """So far each place may be wrong, if that is more than its source is known to be."""
    speed_error_mps: float = 0.0
    """And so far speeds, be they stated or from places."""
    smoothing_s: float = 1.0
    standing_kmh: float = 1.0
    accelerating_mps2: float = 0.5
    braking_hard_mps2: float = 4.0
    stops_at_once_kmh: float = 20.0
    """So slow a vehicle can stop at once."""
    touching_m: float = TOUCHING_M
    """Who reaches into a lane by less is not in it: positions are no better than that."""
    changed_m: float = 0.3
    """A lane has been changed when the middle of the vehicle is so far beyond the mark."""
    at_edge_m: float = 0.4
    """A vehicle whose side is nearer to its lane's bound keeps at the edge."""
    near_m: float = 150.0
    """Who is farther away along the road is not there."""
    beside_road_m: float = 8.0
    """Who walks or comes towards ego beside its lanes is there up to this distance from them."""
    away_s: float = LONGEST_HOLE_S
    """Who is away for no longer was there all the time."""
    reaction_s: float = 1.0
    braking_mps2: float = 8.0
    """As hard as a vehicle brakes that has to; but for cycles and rails everybody does alike."""
    # Who brakes harder on a cycle goes over its front wheel.
    cycle_braking_mps2: float = 6.0
    rail_braking_mps2: float = 3.0
    disturbing_mps2: float = 2.0
    """Who has to brake harder for one who changes lanes is in its way."""
    cutting_in_mps2: float = 2.0
    """Who comes into ego's lane slows down sideways by no more than this."""
    parting_s: float = 4.0
    """Who is in another lane than ego so soon is being overtaken, or leaves: the gap is moot."""
    catching_up_s: float = 10.0
    """Ego is overtaking when it will be beside a slower vehicle so soon."""
    obstacle_m: float = 30.0
    """Ego goes round one that stands from so far before it on, or from ``parting_s`` before it."""
    passed_s: float = 2.0
    """And until it is so far ahead of it, by time."""
    clearly_faster_kmh: float = 5.0
    """One that is faster by less does not overtake ego."""
    congested_kmh: float = 30.0
    walking_pace_kmh: float = 10.0
    slow_queue_kmh: float = 60.0
    """A queue on the lane beside is slow below this speed."""
    fewest: int = 3
    """So many vehicles make a queue, and so many can be congested."""
    flow_reach_m: float = 100.0
    """Traffic is what there is up to this distance ahead and behind."""
    queue_headway_s: float = 2.0
    queue_gap_m: float = 20.0
    """In a queue neighbours are no farther apart than either of these two."""
    loose_headway_s: float = 3.0
    """Up to this some still speak of one who follows: HCM 2000; the seventh edition has 2.5 s."""
    zone_m: float = 5.0
    """Immediately before a crossing or a junction is so near."""
    kerb_m: float = 2.0
    """Who stands at the kerb is no farther from the lanes."""
    about_to_s: float = 2.0
    """Who walks is about to cross if it will be on the crossing so soon."""
    entering_s: float = 0.5
    """And it sets foot on it if it will be there so soon."""
    side_road_m: float = 15.0
    """Who crosses the road into which ego turns is so near behind the junction."""
    turned_deg: float = 45.0
    """Ego turns at a junction if its road does by more than this."""
    preparing_s: float = 10.0
    """Ego prepares to turn for so long."""
    light_reach_m: float = 50.0
    """A light farther ahead is not ego's yet."""
    approach_m: float = 50.0
    """Ego nears a junction, a narrowing or a level crossing from so far before it on."""
    yielding_s: float = 1.0
    """Who gets to a place at least so long after ego has left it is not in conflict with it."""
    held_up_s: float = 3.0
    """Who was held up by ego gets there at most so long after it."""
    signalling_s: float = 5.0
    """Who pulls out to overtake signals it for at most so long before."""
    overtaking_s: float = 6.0
    """Overtaking takes so long on a road where others come towards ego."""
    access_s: float = 5.0
    """Who turns off within so long crosses a line for access."""
    setting_off_s: float = 10.0
    """Who stood so short a time ago sets off, and may gain speed beside others."""
    together_s: float = 1.0
    """Who reach a junction within so long reach it at the same time."""

    def __post_init__(self) -> None:
        for own in fields(self):
            given: object = getattr(self, own.name)
            is_number = isinstance(given, int | float) and not isinstance(given, bool)
            if not (is_number and 0 <= given <= LARGEST):  # type: ignore[operator]
                message = f"`{own.name}` is a number from 0 to {LARGEST:,.0f}, not {brief(given)}"
                raise ValueError(message)


USUAL = Thresholds()

LEAST_S: Mapping[str, float] = MappingProxyType(
    dict.fromkeys(
        (
            "lateral",
            "position",
            "precedes",
            "one_between",
            "safe_gap",
            "stopped",
            "oncoming",
            "straddling",
            "lane_position",
            "on_solid_line",
            "broken_on_own_side",
            "single_line",
            "accelerating",
            "braking_hard",
            "can_stop_at_once",
            "dense_all_lanes",
            "far_lane_queue",
            "own_lane_queue",
            "overtaking",
            "being_overtaken",
        ),
        0.3,
    )
    | dict.fromkeys(
        ("driving_side", "reversing", "congested", "CONGESTED", "walking_pace_flow"), 1.0
    )
)
"""Word -> how long (s) a value of it lasts at least; a shorter one is noise.

Others have none: they are of one moment, or cannot waver.
"""


def threshold_options(texts: Iterable[str]) -> Thresholds:
    """The usual thresholds but for some, from texts such as ``near_m=200``.

    Raises ValueError: with what is wrong, for people.
    """
    known = {field.name: field.default for field in fields(Thresholds)}
    numbers: dict[str, float | int] = {}
    for text in texts:
        name, value = pair_of(text, "near_m=200")
        if name not in known:
            message, among = f"there is no threshold `{name}`", f" among {named(list(known))}"
            raise ValueError(hinted(message, name, known, among))
        try:
            number = float(value)
        except ValueError:
            number = -1.0
        if not 0 <= number <= LARGEST:
            unit = next((says for end, says in _UNITS.items() if name.endswith(end)), "")
            raise ValueError(f"`{name}` is a number from 0 to {LARGEST:,.0f}{unit}, not `{value}`")
        if isinstance(known[name], int) and number != int(number):
            raise ValueError(f"`{name}` is a whole number, not `{value}`")
        numbers[name] = int(number) if isinstance(known[name], int) else number
    return replace(Thresholds(), **numbers)  # type: ignore[arg-type]


def pair_of(text: str, example: str) -> tuple[str, str]:
    """Name and value of a text such as ``near_m=200``. Raises ValueError."""
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise ValueError(f"`{text}` is not written as in `{example}`")
    return name.strip(), value.strip()


def hinted(message: str, name: str, known: Iterable[str], otherwise: str = "") -> str:
    """A message with a name that may be meant, else with something else behind it."""
    hint = did_you_mean(name, list(known))
    return f"{message}; {hint}" if hint else message + otherwise


_UNITS = {
    f"_{end}": f" without a unit, in {unit}"
    for end, unit in (("m", "m"), ("s", "s"), ("kmh", "km/h"), ("mps", "m/s"), ("mps2", "m/s²"))
}
"""How names of thresholds end -> what is said of their unit."""
