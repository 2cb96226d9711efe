"""The five most important rules that readers of the statutes missed in each book are there.

What they missed, and the rules that are about it. One that could not be read says so by its
certainty.
"""

import pytest

from support.builders.national_books import read

MISSED = {
    "vienna": {
        "34(1)": "emergency_vehicles",
        "16(2)": "oncoming_priority",
        "14": "indicator_when_turning indicator_when_changing_lanes indicator_when_starting",
        "25": "joining_motorway reversing_on_motorways turning_on_motorways stopping_on_motorways",
        "17(1)": "needless_braking",
    },
    "de": {
        "signs 205, 301": "give_way_sign stop_sign_give_way junction_priority",
        "9(3)": "oncoming_priority cyclists_when_turning give_way_to_pedestrians_when_turning",
        "18(7), (8)": "reversing_on_motorways turning_on_motorways stopping_on_motorways",
        "4(1) s. 2, 3(2)": "needless_braking too_slow",
        "9(1), 10": "indicator_when_turning indicator_when_starting joining_road",
        "amber": "amber_light",
        "18(3)": "joining_motorway",
        "37(3)": "closed_lane",
    },
    "at": {
        "20": "speed_limit",
        "52, 19(4)": "stop_sign give_way_sign stop_sign_give_way",
        "26(5)": "emergency_vehicles",
        "38": "amber_light",
        "19(5)": "oncoming_priority",
    },
    "fr": {
        "R415-4": "oncoming_priority",
        "R412-10": "indicator_when_turning indicator_when_changing_lanes indicator_when_starting",
        "R421-6, R421-7": "reversing_on_motorways turning_on_motorways stopping_on_motorways",
        "cyclists alongside": "cyclists_when_turning",
        "R413-4, R413-8": "speed_limit_without_sight speed_limit_by_class",
    },
    "nl": {
        "signs": "give_way_sign stop_sign",
        "18": "oncoming_priority cyclists_when_turning give_way_to_pedestrians_when_turning",
        "roundabout": "roundabout_priority",
        "17(2), 55": "indicator_when_turning indicator_when_changing_lanes indicator_when_starting",
        "43": "reversing_on_motorways turning_on_motorways stopping_on_motorways hard_shoulder",
    },
    "se": {
        "3:17": "speed_limit",
        "3:21 and signs": "give_way_sign stop_sign joining_road",
        "3:25-26": "oncoming_priority cyclists_when_turning",
        "3:65": "indicator_when_turning indicator_when_changing_lanes indicator_when_starting",
        "3:44": "zipper",
    },
    "pl": {
        "signs": "stop_sign give_way_sign",
        "25(1)": "oncoming_priority",
        "roundabout": "roundabout_priority",
        "22(5)": "indicator_when_turning indicator_when_changing_lanes",
        "20(3)": "speed_limit_by_class",
    },
    "gb": {
        "175, 170": "amber_light give_way_to_pedestrians_when_turning",
        "165": "no_overtaking_sign",
        "258, 263, 265": "closed_lane reversing_on_motorways wrong_way heavy_vehicle_lanes",
        "H3": "cyclists_when_turning",
        "103": "indicator_when_turning indicator_when_starting",
    },
    "ie": {
        "signs": "stop_sign give_way_sign",
        "level crossings": "rail_priority",
        "pedestrians at lights": "give_way_to_pedestrians_when_turning",
        "boarding": "boarding_passengers",
        "indicator": "indicator_when_turning indicator_when_starting",
    },
    "it": {
        "145": "junction_priority oncoming_priority give_way_sign stop_sign",
        "154": "indicator_when_turning indicator_when_changing_lanes changing_lanes",
        "176": "joining_motorway reversing_on_motorways turning_on_motorways stopping_on_motorways",
        "158": "no_stopping_on_crossings no_stopping_in_tunnels",
        "146": "solid_line red_light",
    },
    "us-ca": {
        "21801": "oncoming_priority",
        "22352": "speed_limit",
        "22107, 22108": "indicator_when_turning indicator_when_changing_lanes",
        "21451": "give_way_to_pedestrians_when_turning",
        "21650, 21651": "wrong_way turning_on_motorways",
    },
    "au-nsw": {
        "20-25": "speed_limit speed_limit_by_class",
        "67-68": "stop_sign",
        "62": "give_way_to_pedestrians_when_turning oncoming_priority",
        "46-48": "indicator_when_turning indicator_when_changing_lanes",
        "132, 147": "wrong_way solid_line",
    },
    "jp": {
        "22, Order 11, 27": "speed_limit speed_limit_by_class",
        "43": "stop_sign",
        "37": "oncoming_priority",
        "53": "indicator_when_turning",
        "25-2, 75-5, 75-8": "turning_round reversing joining_road turning_on_motorways "
        "reversing_on_motorways stopping_on_motorways",
    },
    "in": {
        "speed limits": "speed_limit speed_limit_by_class",
        "level crossings": "stop_at_level_crossings rail_priority",
        "oncoming": "oncoming_priority",
        "give way": "give_way_sign",
        "lane discipline": "changing_lanes solid_line bus_lane",
    },
}

GERMAN_PEERS = {
    "R_G1": "following_distance",
    "R_G2": "needless_braking",
    "R_G3": "speed_limit speed_limit_by_class speed_limit_without_sight",
    "R_G4": "too_slow",
    "R_I1": "stopping_on_motorways",
    "R_I2": "near_side_passing",
    "R_I3": "reversing_on_motorways turning_on_motorways",
    "R_I4": "emergency_corridor",
    "R_I5": "joining_motorway",
    "R_IN1": "stop_sign",
    "R_IN2": "red_light",
    "R_IN3": "junction_priority",
    "R_IN4": "give_way_sign",
    "R_IN5": "oncoming_priority",
}
"""The rules of Germany in crmonitor (Maierhofer et al., IV 2020 and 2022), and the book's."""


@pytest.mark.parametrize(
    ("book", "missed", "rules"),
    [(book, missed, rules) for book, of in MISSED.items() for missed, rules in of.items()],
)
def test_a_book_has_the_rules_that_were_missed_with_an_article_of_its_own(book, missed, rules):
    own = {rule.name: rule for rule in read(book).rulebook.rules if not rule.inherited_from}
    for name in rules.split():
        assert name in own, missed
        assert own[name].cite, name
        assert {example.accepts for example in own[name].examples} == {True, False}, name


@pytest.mark.parametrize(("peer", "rules"), GERMAN_PEERS.items())
def test_the_german_book_covers_what_its_peers_cover(peer, rules):
    own = {rule.name for rule in read("de").rulebook.rules if not rule.inherited_from}
    assert set(rules.split()) <= own, peer
