"""Only signals of the names given are computed, and each is the same as among all."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.clearance_signals import clearance_signals
from rulec.extraction.signals.conduct.called_signals import called_signals
from rulec.extraction.signals.conduct.lamp_signals import lamp_signals
from rulec.extraction.signals.conduct.lane_changes.lane_change_signals import lane_change_signals
from rulec.extraction.signals.conduct.manoeuvre_signals import manoeuvre_signals
from rulec.extraction.signals.conduct.next_lane_signals import next_lane_signals
from rulec.extraction.signals.conduct.oncoming_conflicts import oncoming_conflicts
from rulec.extraction.signals.conduct.overtaking_signals import overtaking_signals
from rulec.extraction.signals.conduct.reason_signals import reason_signals
from rulec.extraction.signals.conduct.turning_conflicts import turning_conflicts
from rulec.extraction.signals.ego_signals import ego_signals
from rulec.extraction.signals.flow_signals import flow_signals
from rulec.extraction.signals.lane_mark_signals import lane_mark_signals
from rulec.extraction.signals.map.crossing_signals import crossing_signals
from rulec.extraction.signals.map.junction_signals import junction_signals
from rulec.extraction.signals.map.level_crossing_signals import level_crossing_signals
from rulec.extraction.signals.map.line_signals import line_signals
from rulec.extraction.signals.map.map_signals import map_signals
from rulec.extraction.signals.map.merge_signals import merge_signals
from rulec.extraction.signals.map.priority_signals import priority_signals
from rulec.extraction.signals.map.road_signals import road_signals
from rulec.extraction.signals.map.roundabout_signals import roundabout_signals
from rulec.extraction.signals.map.zone_signals import zone_signals
from rulec.extraction.signals.participants.following_signals import following_signals
from rulec.extraction.signals.participants.intention_signals import intention_signals
from rulec.extraction.signals.participants.participant_signals import participant_signals
from rulec.extraction.signals.signal_columns import world_signals
from rulec.extraction.signals.signal_passes import SignalPasses
from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.recordings.recording import Weather
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import recording
from support.defined_words import LEFT_TO_DEFINITIONS
from support.generators.random_recordings import lanes
from support.signal_arrays import bounds_of, texts_of, unknown_in, values_of

GROUPS = (
    *(ego_signals, participant_signals, following_signals, map_signals, road_signals),
    *(junction_signals, line_signals, priority_signals, crossing_signals, roundabout_signals),
    *(level_crossing_signals, zone_signals),
    *(intention_signals, called_signals, merge_signals, clearance_signals),
    *(flow_signals, overtaking_signals),
    *(lane_change_signals, lane_mark_signals),
    *(manoeuvre_signals, lamp_signals, reason_signals, turning_conflicts, next_lane_signals),
    oncoming_conflicts,
)
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
        def signals_of(context):
            asked.append(name)
            return world_signals(**{name: np.zeros(context.states), "by_the_way": np.ones(1)})

        return signals_of

    passes = {("wet", "icy"): gives("wet"), ("speed",): gives("speed")}
    assert names(SignalPasses(passes)(context, frozenset({"speed", "lane"}))) == {"speed"}
    assert asked == ["speed"]
    assert names(SignalPasses(passes)(context, frozenset({"icy"}))) == set()
    assert asked == ["speed", "wet"]
