"""What readers of the statutes found wrong in the books stays mended.

A row names the finding, the book, the rule, and labels of examples that come out otherwise without
the mend; ``test_books`` runs them. A rule that is no law in a country is not in its book.
"""

import pytest

from support.builders.national_books import read

SHOWN = [
    (1, "de", "stop_sign", ["until the last state"], ["on the line only"]),
    (1, "de", "red_light", ["after a stop, until the last state"], []),
    (1, "pl", "red_light", ["after a stop, until the last state"], []),
    (3, "de", "speed_limit", ["a divided road outside town"], ["a sign on a divided road"]),
    (3, "de", "speed_limit", ["two marked lanes each way outside town"], ["outside town"]),
    (3, "de", "speed_limit_advisory", ["a divided road"], ["two marked lanes each way"]),
    (4, "de", "speed_limit_by_class", ["a van"], ["a lorry on the motorway"]),
    (4, "nl", "speed_limit_by_class", ["a van"], ["a lorry"]),
    (5, "de", "give_way_sign", ["free"], ["from the left"]),
    (5, "nl", "give_way_sign", ["free"], ["from the left"]),
    (6, "de", "stop_sign_give_way", ["free"], ["from the left, after a stop"]),
    (6, "nl", "stop_sign_give_way", ["free"], ["from the left, after a stop"]),
    (6, "nl", "stop_sign", [""], ["stood farther back"]),
    (8, "de", "amber_light", ["too near to stop"], ["far enough to stop"]),
    (8, "nl", "amber_light", ["too near to stop"], ["far enough to stop"]),
    (4, "at", "speed_limit_by_class", ["a van"], ["a lorry on a motorway"]),
    (4, "pl", "speed_limit_by_class", ["a van"], ["a lorry on a motorway"]),
    (4, "se", "speed_limit_by_class", ["a van"], ["a lorry on a motorway"]),
    (5, "at", "give_way_sign", ["free"], ["from the left"]),
    (5, "pl", "give_way_sign", ["free"], ["from the left"]),
    (5, "se", "give_way_sign", ["free"], ["from the left"]),
    (6, "at", "stop_sign", [""], ["stood farther back"]),
    (6, "at", "stop_sign_give_way", ["free"], ["from the left, after a stop"]),
    (6, "pl", "stop_sign", [""], ["stood farther back"]),
    (6, "pl", "stop_sign_give_way", ["free"], ["from the left, after a stop"]),
    (6, "se", "stop_sign", [""], ["stood farther back"]),
    (6, "se", "stop_sign_give_way", ["free"], ["from the left, after a stop"]),
    (8, "at", "amber_light", ["too near to stop"], ["far enough to stop"]),
    (8, "pl", "amber_light", ["too near to stop"], ["far enough to stop"]),
    (8, "se", "amber_light", ["too near to stop"], ["far enough to stop"]),
    (9, "pl", "junction_overtaking", ["with lights"], ["on a road with priority, too"]),
    (11, "pl", "straddling_lanes", ["a path for an emergency vehicle"], []),
    (10, "de", "rail_priority", ["a tram where the right goes first"], []),
    (10, "de", "rail_priority", [], ["a tram that goes on where ego turns"]),
    (12, "vienna", "junction_overtaking", ["on a road with priority"], []),
    (12, "vienna", "junction_overtaking", ["with an officer"], ["where a sign has ego give way"]),
    (12, "vienna", "level_crossing_overtaking", ["a motorcycle"], []),
    (13, "vienna", "emergency_vehicles", ["in time"], [""]),
    (14, "de", "rail_side", ["tracks too far right"], ["on the left"]),
    (23, "de", "keep_near_side", ["somebody was there a while ago"], []),
    (23, "de", "keep_near_side", [], ["the middle of three, the right one empty"]),
    (15, "de", "bus_leaving", ["waits beside it", "beside it when it signalled"], [""]),
    (15, "nl", "bus_leaving", ["waits beside it", "beside it when it signalled"], [""]),
    (15, "pl", "bus_leaving", ["waits beside it", "beside it when it signalled"], [""]),
    (15, "se", "bus_leaving", ["waits beside it", "beside it when it signalled"], [""]),
    (23, "pl", "keep_near_side", ["in queues"], ["a motorway"]),
    (25, "at", "closed_lane", ["a green arrow"], [""]),
    (25, "pl", "closed_lane", ["a green arrow"], [""]),
    (25, "se", "closed_lane", ["a green arrow"], [""]),
    (25, "at", "stopping_on_motorways", ["in a queue"], ["a motorway"]),
    (25, "pl", "stopping_on_motorways", ["in a queue"], ["a motorway"]),
    (25, "se", "stopping_on_motorways", ["in a queue"], ["a motorway"]),
    (25, "at", "overtaking_against_a_sign", [""], [""]),
    (25, "pl", "overtaking_against_a_sign", [""], [""]),
    (25, "se", "overtaking_against_a_sign", [""], [""]),
    (25, "de", "closed_lane", ["a green arrow"], [""]),
    (25, "de", "stopping_on_motorways", ["in a queue"], ["its shoulder"]),
    (25, "nl", "stopping_on_motorways", ["in a queue"], ["a motorway"]),
    (25, "nl", "overtaking_against_a_sign", [""], [""]),
    (25, "de", "level_crossing_overtaking", ["past it"], ["from the warning sign on"]),
    (12, "fr", "junction_overtaking", ["on the road that has priority"], []),
    (12, "fr", "junction_overtaking", ["an officer lets ego go"], ["before a give-way sign"]),
    (19, "fr", "speed_limit", [], ["motorway in rain with a sign of 110"]),
    (19, "fr", "speed_limit", ["wet, but no rain"], ["divided, in rain"]),
    (4, "fr", "speed_limit_by_class", ["a lorry outside town"], ["a lorry outside town"]),
    (4, "gb", "speed_limit_by_class", ["a lorry on a motorway"], ["a car with a caravan"]),
    (6, "fr", "stop_sign", ["waits for the others"], ["stops, and goes before another one"]),
    (6, "gb", "stop_sign", ["waits for the others"], ["stops, and goes before another one"]),
    (8, "fr", "amber_light", ["too near to stop"], ["there was time to stop"]),
    (8, "gb", "amber_light", ["too near to stop"], ["there was time to stop"]),
    (18, "fr", "move_over", ["parked in the road"], [""]),
    (24, "gb", "reversing_on_motorways", ["another road"], [""]),
    (24, "gb", "wrong_way", ["the right way"], [""]),
    (25, "fr", "stopping_on_motorways", ["in a queue"], [""]),
    (25, "fr", "closed_lane", ["stopped before it"], [""]),
    (19, "fr", "speed_limit_without_sight", ["50 km/h"], [""]),
    (20, "fr", "roundabout_priority", ["without signs R415-5 holds"], []),
    (21, "fr", "following_distance_heavy", [], ["a little faster, as measured"]),
    (24, "gb", "crossing_overtaking", ["another one is nearer to the crossing"], []),
    (24, "gb", "following_distance", ["icy, a second less than twenty"], ["icy"]),
    (24, "gb", "heavy_vehicle_lanes", ["7.5 t"], ["goods"]),
    (24, "gb", "closed_lane", ["stopped before it"], [""]),
    (24, "gb", "red_light_at_level_crossings", ["waits"], [""]),
    (25, "fr", "no_overtaking_sign", ["no sign"], ["all the way"]),
    (25, "gb", "no_overtaking_sign", ["no sign"], [""]),
    (4, "us-ca", "speed_limit_by_class", ["a truck of 15 t"], ["a car with a trailer"]),
    (6, "us-ca", "stop_sign_giving_way", ["waits"], ["from the left"]),
    (7, "us-ca", "give_way_to_pedestrians_when_turning", ["straight on"], ["at green, too"]),
    (
        16,
        "us-ca",
        "near_side_passing",
        ["lanes without marks in a district"],
        ["lanes without marks"],
    ),
    (17, "us-ca", "solid_line", ["a single line"], ["straight on"]),
    (18, "us-ca", "move_over", ["it drives"], ["no freeway"]),
    (4, "it", "speed_limit_by_class", ["a lorry of 12 t"], ["a heavy lorry"]),
    (5, "it", "give_way_sign", ["waits"], ["from the left"]),
    (6, "it", "stop_sign", ["waits for the others"], ["stops, and goes before another one"]),
    (8, "it", "amber_light", ["too near to stop"], ["there was time to stop"]),
    (25, "it", "stopping_on_motorways", ["in a queue"], [""]),
    (25, "it", "closed_lane", ["stopped before it"], [""]),
    (4, "au-nsw", "speed_limit_by_class", ["4.5 t"], [""]),
    (4, "jp", "speed_limit_by_class", ["a lighter lorry"], ["a lorry"]),
    (4, "in", "speed_limit_by_class", ["a lorry"], ["a lorry"]),
    (4, "ie", "speed_limit_by_class", ["a van"], ["a lorry"]),
    (5, "jp", "give_way_sign", ["waits"], ["from the left"]),
    (6, "au-nsw", "stop_sign", ["waits for the others"], ["stops, and goes before another one"]),
    (6, "jp", "stop_sign", ["waits for the others"], ["stops, and goes before another one"]),
    (6, "ie", "stop_sign", ["waits for the others"], ["stops, and goes before another one"]),
    (6, "in", "stop_sign", ["waits for the others"], ["stops, and goes before another one"]),
    (7, "au-nsw", "give_way_to_pedestrians_when_turning", [], ["at green, too"]),
    (7, "jp", "give_way_to_pedestrians_when_turning", [], ["at green, too"]),
    (8, "jp", "amber_light", ["too near to stop"], ["there was time to stop"]),
    (22, "jp", "give_way_to_pedestrians", ["waits at a corner without marks"], []),
    (22, "jp", "give_way_to_pedestrians", [], ["crosses at a corner without marks"]),
    (22, "jp", "keep_near_side", ["in full queues"], []),
    (22, "jp", "crossing_overtaking", ["green light"], []),
    (25, "jp", "stopping_on_motorways", ["in a queue"], [""]),
]

NO_LAW = [
    (9, "de", "junction_overtaking"),
    (9, "nl", "junction_overtaking"),
    (11, "de", "straddling_lanes"),
    (11, "nl", "straddling_lanes"),
    (11, "at", "straddling_lanes"),
    (11, "fr", "straddling_lanes"),
]


def labels(book: str, name: str, accepts: bool) -> list[str]:
    rule = next(one for one in read(book).rulebook.rules if one.name == name)
    return [one.label for one in rule.examples if one.accepts is accepts]


@pytest.mark.parametrize(("_finding", "book", "rule", "accepted", "rejected"), SHOWN)
def test_examples_show_what_was_mended(_finding, book, rule, accepted, rejected):
    assert set(accepted) <= set(labels(book, rule, accepts=True))
    assert set(rejected) <= set(labels(book, rule, accepts=False))


@pytest.mark.parametrize(("_finding", "book", "rule"), NO_LAW)
def test_what_is_no_law_is_dropped_with_its_reason(_finding, book, rule):
    rulebook = read(book).rulebook
    assert rule not in {one.name for one in rulebook.rules}
    assert [one.because for one in rulebook.remarks if one.name == rule and one.because]
