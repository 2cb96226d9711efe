"""The thresholds that classify recorded traffic. ``docs/recordings.md`` explains them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from rulec.diagnostics import did_you_mean, named
from rulec.recordings.mending.short_holes import LONGEST_HOLE_S
from rulec.scenario.recorded.lane_coordinates import TOUCHING_M
from rulec.value_display import brief, short_repr
from rulec.vocabulary import Vocabulary

LARGEST = 1_000_000.0
"""Largest threshold (m, s or km/h): larger ones mean nothing on a road, and overflow."""


@dataclass(frozen=True, slots=True)
class Thresholds:
    """The thresholds that turn positions into words; the suffix of a name is its unit.

    Speeds and accelerations are derived from positions, over ``smoothing_s`` around each moment:
    positions are noisy, and the speeds that some files state do not agree with their positions.
    Below ``standing_kmh`` a vehicle stands.
    """

    __repr__ = short_repr

    place_error_m: float = 0.0
    """Least error of each place; larger if the source is known to be less accurate."""
    speed_error_mps: float = 0.0
    """Least error of speeds, whether stated or derived from places."""
    smoothing_s: float = 1.0
    standing_kmh: float = 1.0
    accelerating_mps2: float = 0.5
    braking_hard_mps2: float = 4.0
    stops_at_once_kmh: float = 20.0
    """A vehicle up to this speed can stop at once."""
    touching_m: float = TOUCHING_M
    """A participant that reaches into a lane by less is not in it: places are no more accurate."""
    changed_m: float = 0.3
    """A lane change is done when the vehicle's middle is this far beyond the mark."""
    at_edge_m: float = 0.4
    """A vehicle whose side is nearer than this to its lane's bound keeps at the edge."""
    near_m: float = 150.0
    """Participants farther away than this along the road do not count."""
    beside_road_m: float = 8.0
    """Pedestrians and oncoming traffic beside ego's lanes count up to this distance from them."""
    away_s: float = LONGEST_HOLE_S
    """A participant that is absent for no longer than this counts as present throughout."""
    reaction_s: float = 1.0
    braking_mps2: float = 8.0
    """Deceleration of a vehicle that must brake: the same for all but cycles and rail vehicles."""
    # A cyclist who brakes harder goes over the front wheel.
    cycle_braking_mps2: float = 6.0
    rail_braking_mps2: float = 3.0
    disturbing_mps2: float = 2.0
    """A vehicle that changes lanes is in the way of one that has to brake harder for it."""
    cutting_in_mps2: float = 2.0
    """Largest lateral deceleration of a vehicle that moves into ego's lane."""
    parting_s: float = 4.0
    """A vehicle out of ego's lane within this time is passed or leaves: its gap is moot."""
    catching_up_s: float = 10.0
    """Ego is overtaking when it will be beside a slower vehicle within this time."""
    obstacle_m: float = 30.0
    """Ego goes round a standing vehicle from this far before it on, or from ``parting_s``."""
    passed_s: float = 2.0
    """And until ego is this far ahead of it, by time."""
    clearly_faster_kmh: float = 5.0
    """A vehicle whose speed exceeds ego's by less does not overtake ego."""
    congested_kmh: float = 30.0
    walking_pace_kmh: float = 10.0
    slow_queue_kmh: float = 60.0
    """A queue on the lane beside is slow below this speed."""
    fewest: int = 3
    """Least number of vehicles that make a queue or can be congested."""
    flow_reach_m: float = 100.0
    """Traffic flow is judged from vehicles up to this distance ahead and behind."""
    queue_headway_s: float = 2.0
    queue_gap_m: float = 20.0
    """Neighbours in a queue are no farther apart than either of these two."""
    loose_headway_s: float = 3.0
    """Largest headway that some still call following: HCM 2000; the seventh edition has 2.5 s."""
    zone_m: float = 5.0
    """Up to this distance ego is immediately before a crossing or a junction."""
    kerb_m: float = 2.0
    """A pedestrian at the kerb is at most this far from the lanes."""
    about_to_s: float = 2.0
    """A pedestrian is about to cross if it will be on the crossing within this time."""
    entering_s: float = 0.5
    """And it steps onto the crossing if it will be there within this time."""
    side_road_m: float = 15.0
    """Pedestrians crossing the road that ego turns into are this near behind the junction."""
    turned_deg: float = 45.0
    """Ego turns at a junction if its road changes direction by more than this."""
    preparing_s: float = 10.0
    """A vehicle prepares to turn, or a bus to leave its stop, up to this long before."""
    light_reach_m: float = 50.0
    """A traffic light farther ahead does not concern ego yet."""
    approach_m: float = 50.0
    """Ego nears a junction, a narrowing or a level crossing from this distance before it on."""
    yielding_s: float = 1.0
    """A participant reaching a place this long after ego left it is not in conflict with ego."""
    held_up_s: float = 3.0
    """A participant held up by ego gets there at most this long after ego."""
    signalling_s: float = 5.0
    """A vehicle that pulls out to overtake signals for at most this long before."""
    overtaking_s: float = 6.0
    """Overtaking takes this long on a road with oncoming traffic."""
    access_s: float = 5.0
    """A vehicle that turns off within this time crosses a line for access."""
    setting_off_s: float = 10.0
    """A vehicle that stood within this time sets off, and may gain speed beside others."""
    together_s: float = 1.0
    """Participants that reach a junction within this time arrive together."""

    def __post_init__(self) -> None:
        for own in fields(self):
            given: object = getattr(self, own.name)
            is_number = isinstance(given, int | float) and not isinstance(given, bool)
            if not (is_number and 0 <= given <= LARGEST):  # type: ignore[operator]
                message = f"`{own.name}` is a number from 0 to {LARGEST:,.0f}, not {brief(given)}"
                raise ValueError(message)


USUAL = Thresholds()

_SET_BY_BOOKS: Mapping[str, tuple[str, Fraction]] = {
    "reaction_time": ("reaction_s", Fraction(1)),
    "full_braking": ("braking_mps2", Fraction(1)),
    "cycle_braking": ("cycle_braking_mps2", Fraction(1)),
    "rail_braking": ("rail_braking_mps2", Fraction(1)),
    "speed_to_stop_at_once": ("stops_at_once_kmh", Fraction(18, 5)),
    "least_acceleration": ("accelerating_mps2", Fraction(1)),
    "hard_braking": ("braking_hard_mps2", Fraction(1)),
    "bearable_braking": ("disturbing_mps2", Fraction(1)),
    "overtaken_by": ("clearly_faster_kmh", Fraction(18, 5)),
    "congested_below": ("congested_kmh", Fraction(18, 5)),
    "walking_below": ("walking_pace_kmh", Fraction(18, 5)),
    "flow_reach": ("flow_reach_m", Fraction(1)),
}
"""Parameter of a vocabulary -> the threshold that it sets, and its unit's share of a base unit."""

_OF_DEFINITIONS = frozenset(("stops_at_once_kmh", "accelerating_mps2", "braking_hard_mps2"))
"""The thresholds that only rulebooks set: recordings leave their words to the definitions."""


def check_chosen(given: Thresholds) -> None:
    """Raise ValueError, with a message for users, for a threshold that only rulebooks set."""
    for parameter, (name, _) in _SET_BY_BOOKS.items():
        if name in _OF_DEFINITIONS and getattr(given, name) != getattr(USUAL, name):
            raise ValueError(f"`{name}` is a rulebook's: `set {parameter} = …` there")


def thresholds_by(vocabulary: Vocabulary | None, given: Thresholds) -> Thresholds:
    """The thresholds, with the numbers of a rulebook's law where the user has chosen no others."""
    law = {} if vocabulary is None else vocabulary.parameters
    own: dict[str, Any] = {
        field: float(law[name] * units)
        for name, (field, units) in _SET_BY_BOOKS.items()
        if name in law and getattr(given, field) == getattr(USUAL, field)
    }
    return replace(given, **own) if own else given


LEAST_S: Mapping[str, float] = MappingProxyType(
    dict.fromkeys(
        (
            *("lateral", "position", "precedes", "one_between", "safe_gap", "stopped", "oncoming"),
            *("straddling", "lane_position", "on_solid_line", "broken_on_own_side", "single_line"),
            *("dense_all_lanes", "far_lane_queue", "own_lane_queue", "overtaking"),
            "being_overtaken",
        ),
        0.3,
    )
    | dict.fromkeys(
        ("driving_side", "reversing", "congested", "CONGESTED", "walking_pace_flow"), 1.0
    )
)
"""Word -> the least time (s) that a value of it lasts; shorter ones are noise.

Other words have none: they concern one moment, or cannot waver.
"""


def threshold_options(texts: Iterable[str]) -> Thresholds:
    """The usual thresholds with some changed, from texts such as ``near_m=200``.

    Raises ValueError with a message for users.
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
    chosen = replace(Thresholds(), **numbers)  # type: ignore[arg-type]
    check_chosen(chosen)
    return chosen


def pair_of(text: str, example: str) -> tuple[str, str]:
    """Name and value from a text such as ``near_m=200``. Raises ValueError for another form."""
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise ValueError(f"`{text}` is not written as in `{example}`")
    return name.strip(), value.strip()


def hinted(message: str, name: str, known: Iterable[str], otherwise: str = "") -> str:
    """A message followed by a suggestion of a similar known name, or else by ``otherwise``."""
    hint = did_you_mean(name, list(known))
    return f"{message}; {hint}" if hint else message + otherwise


_UNITS = {
    f"_{end}": f" without a unit, in {unit}"
    for end, unit in (("m", "m"), ("s", "s"), ("kmh", "km/h"), ("mps", "m/s"), ("mps2", "m/s²"))
}
"""Suffix of a threshold's name -> the note on its unit in error messages."""
