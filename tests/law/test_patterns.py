"""The shared patterns that ask for one of the newer words each, in a book made for them alone."""

from rulec.automata.compiler import compile_rulebook
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.rulebook.loader import parse_rulebook

PATTERNS = """
rulebook patterns
extends schemas
traffic right

hard rule needless_braking (v: vehicle) in gaps {
  require never (brakes_needlessly and is_ahead_of(v))
  accept  "for a light" { braking_hard and in_front_of(v) and same_lane(v) }
  accept  "nobody behind" { braking_hard and not cause_to_brake and behind(v) and same_lane(v) }
  reject  { braking_hard and not cause_to_brake and in_front_of(v) and same_lane(v) }
}

hard rule indicator_when_turning in right_of_way {
  require always (enters_junction implies indicates_turn)
  accept  { enters_junction and junction_zone and turn_near and near_indicator }
  accept  "straight on" { enters_junction and junction_zone }
  reject  { enters_junction and junction_zone and turn_near and far_indicator }
  reject  "round" { enters_junction and junction_zone and turn_round }
}

hard rule wrong_way in right_of_way {
  require never drives_against_traffic
  accept  { own_side }
  reject  { oncoming_side }
  reject  { wrong_way }
}

hard rule give_way_sign in right_of_way {
  require always (give_way_sign implies gives_way_to(conflict_from_either_side))
  accept  "waits" { give_way_sign and conflict_from_left }
  reject  { give_way_sign and enters_junction and conflict_from_right }
}

hard rule joining_motorway in right_of_way {
  require never (motorway and merges_from_entry and not lane_is_clear)
  accept  "free" { motorway and entry_lane; motorway and lane_change }
  accept  "from another lane" { motorway; motorway and lane_change and not lane_is_clear }
  reject  { motorway and entry_lane; motorway and lane_change and not lane_is_clear }
}

hard rule stopping_on_motorways in right_of_way {
  require never (motorway and stands_needlessly)
  accept  "in a queue" { motorway and speed = 0 km/h }
  accept  "it creeps" { motorway and speed = 1 km/h and not cause_to_brake }
  reject  "as a logger has it" { motorway and speed = 0.03 km/h and not cause_to_brake }
}

hard rule lights_at_night in gaps {
  require always (night implies lights_the_road)
  accept  { night }
  reject  { night and daytime_lamps }
}

hard rule move_over (v: vehicle) in emergency {
  require always moves_over_for(v)
  accept  "on the far lane" {
    behind(v) and two_lanes and far_lane and second_lane and stopped(v) and on_shoulder(v);
    beside(v) and two_lanes and far_lane and second_lane and stopped(v) and on_shoulder(v)
      and speed = 80 km/h
  }
  accept  "one lane" {
    behind(v) and stopped(v) and on_shoulder(v);
    beside(v) and stopped(v) and on_shoulder(v) and speed = 80 km/h
  }
  reject  {
    behind(v) and two_lanes and stopped(v) and on_shoulder(v);
    beside(v) and two_lanes and stopped(v) and on_shoulder(v) and speed = 80 km/h
  }
}

# At 54 km/h, 15 m/s, one needs 1 s and 15 / 6.1 = 2.459 s more.
hard rule amber_light in emergency {
  require never drives_at_amber
  accept  "it could not stop" {
    green_light and speed = 54 km/h;
    amber_light and speed = 54 km/h and time_to_stop_line = 3.45 s;
    amber_light and speed = 54 km/h and crosses_light_line
  }
  accept  "amber from the start" {
    amber_light and speed = 54 km/h and time_to_stop_line = 3.5 s;
    amber_light and speed = 54 km/h and crosses_light_line
  }
  accept  "nobody knows how far the line was" {
    green_light and speed = 54 km/h; amber_light; amber_light and crosses_light_line
  }
  accept  "red meanwhile is another rule" {
    green_light and speed = 54 km/h;
    amber_light and speed = 54 km/h and time_to_stop_line = 3.5 s;
    red_light and speed = 54 km/h and crosses_light_line
  }
  reject  {
    green_light and speed = 54 km/h;
    amber_light and speed = 54 km/h and time_to_stop_line = 3.5 s;
    amber_light and speed = 54 km/h;
    amber_light and speed = 54 km/h and crosses_light_line
  }
}
"""


def test_each_pattern_asks_what_its_name_says():
    book = parse_rulebook(PATTERNS)
    outcomes = run_rulebook_examples(book, compile_rulebook(book)).outcomes
    assert len(outcomes) == PATTERNS.count("accept  ") + PATTERNS.count("reject  ")
    assert [one for one in outcomes if not one.passed] == []
