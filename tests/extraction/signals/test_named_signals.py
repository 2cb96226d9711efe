"""Only signals of the names given are computed, and each is the same as among all."""

from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest

from rulec.extraction.signals import clearance_signals, ego_signals, flow_signals, lane_mark_signals
from rulec.extraction.signals.conduct import (
    being_overtaken,
    called_signals,
    lamp_signals,
    manoeuvre_signals,
    next_lane_signals,
    oncoming_conflicts,
    overtaking_signals,
    reason_signals,
    turning_conflicts,
)
from rulec.extraction.signals.conduct.lane_changes import indicator_signals, lane_change_signals
from rulec.extraction.signals.map import (
    crossing_signals,
    exit_room,
    junction_signals,
    lanes_ahead,
    level_crossing_signals,
    line_signals,
    map_signals,
    merge_signals,
    priority_signals,
    road_signals,
    roundabout_signals,
    zone_signals,
)
from rulec.extraction.signals.participants import (
    following_signals,
    intention_signals,
    participant_conduct,
    participant_signals,
)
from rulec.extraction.signals.signal_columns import world_signals
from rulec.extraction.signals.words import word
from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.recordings.recording import Weather
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import recording
from support.defined_words import LEFT_TO_DEFINITIONS
from support.generators.random_recordings import lanes
from support.signal_arrays import bounds_of, texts_of, unknown_in, values_of
from support.words import words_of

GROUPS = [
    words_of(module)
    for module in (
        ego_signals,
        participant_signals,
        participant_conduct,
        lanes_ahead,
        following_signals,
        map_signals,
        road_signals,
        junction_signals,
        line_signals,
        priority_signals,
        crossing_signals,
        roundabout_signals,
        level_crossing_signals,
        zone_signals,
        exit_room,
        intention_signals,
        called_signals,
        merge_signals,
        clearance_signals,
        flow_signals,
        overtaking_signals,
        being_overtaken,
        lane_change_signals,
        indicator_signals,
        lane_mark_signals,
        manoeuvre_signals,
        lamp_signals,
        reason_signals,
        turning_conflicts,
        next_lane_signals,
        oncoming_conflicts,
    )
]
LAMPS = frozenset({"left_indicator", "right_indicator", "hazard_lights", "dipped_beam"})
LAMPS |= frozenset({"main_beam", "front_fog_lamp", "rear_fog_lamp"})
COMPLETE = (
    *("light", "rail", "officer", "YIELD", "STOP", "PRIORITY", "GREEN_ARROW"),
    *("NO_TURN_ON_RED", "NO_OVERTAKING_START"),
)


def everything():
    """A drive of which everything is told that a recording can tell."""
    types = frozenset({"urban", "mainCarriageWay", "tunnel", "highway"})
    limits = {"limit_mps": 30.0, "minimum_mps": 20.0}
    road = lanes(2, types=types, left_mark="solid", right_mark="broken", **limits)
    ego, car, walker, rider = (
        steady(7, 0, 0),
        steady(8, 20, 0, speed=5),
        steady(9, 15, -3, speed=0, kind="pedestrian"),
        steady(10, -3, 1.5, kind="bicycle"),
    )
    ego, car = (
        replace(one, shows=LAMPS, lamps={k: frozenset({"left_indicator"}) for k in range(4)})
        for one in (ego, car)
    )
    weather = Weather(wet=True, icy=False, visibility_m=80.0, raining=True, night=True)
    found = recording(road, [ego, car, walker, rider])
    return replace(found, complete=frozenset(COMPLETE), weather=weather)


def names(signals):
    return {*signals.world, *signals.about}


def test_together_they_give_all_words_that_some_format_can_tell():
    context = context_of(everything())
    given = [names(signals_of(context)) for signals_of in GROUPS]
    assert set().union(*given) | LEFT_TO_DEFINITIONS == set().union(*TELLABLE_WORDS.values())
    assert LEFT_TO_DEFINITIONS.isdisjoint(set().union(*given))
    assert sum(map(len, given)) == len(set().union(*given))


@pytest.mark.parametrize("signals_of", GROUPS)
def test_a_signal_is_the_same_without_the_others(signals_of):
    found = everything()
    together = signals_of(context_of(found))
    for name in names(together):
        alone = signals_of(context_of(found), frozenset({name}))
        assert names(alone) == {name}
        assert (name in alone.world) == (name in together.world)
        assert texts_of(alone, name) == texts_of(together, name)
        for part in (values_of, unknown_in, bounds_of):
            np.testing.assert_array_equal(part(alone, name), part(together, name))
        np.testing.assert_array_equal(alone.only.get(name), together.only.get(name))


def test_what_nobody_wants_is_not_computed():
    context, asked = context_of(everything()), []

    def gives(name):
        def definition(context):
            asked.append(name)
            return world_signals(**{name: np.zeros(context.states), "by_the_way": np.ones(1)})

        definition.__module__ = "made_up"
        return definition

    word("wet", "icy")(gives("wet"))
    word("speed")(gives("speed"))
    words = words_of(ModuleType("made_up"))
    assert names(words(context, frozenset({"speed", "lane"}))) == {"speed"}
    assert asked == ["speed"]
    assert names(words(context, frozenset({"icy"}))) == set()
    assert asked == ["speed", "wet"]
