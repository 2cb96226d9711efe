"""Lights, signs, stop lines and rights of way of Lanelet2 maps, and whom they are for."""

import numpy as np
import pytest

from rulec.recordings.lanelet2.signs import sign_of
from rulec.recordings.map_files import read_map
from support.builders.lanelet2_files import SAMPLES, MapFile

NO_LIGHT = "the map does not contain what its {} traffic lights show"


def bounds(file, start, end, width=3.0):
    """The lines at 0 and below it of a lane to the east."""
    return file.line((start, 0), (end, 0)), file.line((start, -width), (end, -width))


def road(file, start, end, **more):
    return file.lanelet(*bounds(file, start, end), **more)


def map_of(file, folder):
    return read_map(file.write(folder), 0.1)


def test_a_light_is_for_the_lanelet_before_its_line(tmp_path):
    file = MapFile()
    line = file.line((49, 0), (49, -3), type="stop_line")
    lamp = file.line((60, 2), (61, 2), type="traffic_light")
    rule = file.rule("traffic_light", [("refers", "way", lamp), ("ref_line", "way", line)])
    before, behind = road(file, 0, 50, rules=[rule]), road(file, 50, 90)
    found = map_of(file, tmp_path)
    (light,) = found.lanelets[before].lights
    # That it is there is all that is known
    assert [light.colour_at(step) for step in (0, 7, 1000)] == ["", "", ""]
    assert found.lanelets[before].stop_line.tolist() == [[49, 0], [49, -3]]
    assert found.lanelets[behind].lights == ()
    assert found.lanelets[behind].stop_line is None
    assert NO_LIGHT.format(1) in found.remarks


@pytest.mark.parametrize("with_line", [True, False])
def test_autoware_names_the_ways_behind_the_line(tmp_path, with_line):
    file = MapFile()
    line = file.line((50, 0), (50, -3), type="stop_line")
    roles = [("ref_line", "way", line)] if with_line else []
    both = file.rule("traffic_light", [("refers", "way", file.line((60, 2), (61, 2))), *roles])
    arrow = file.rule("traffic_light", [("refers", "way", file.line((62, 2), (63, 2))), *roles])
    before = road(file, 0, 50)
    on = road(file, 50, 70, rules=[both], turn_direction="straight")
    curve = file.line((50, 0), (60, 5)), file.line((50, -3), (62, 2))
    left = file.lanelet(*curve, rules=[arrow], turn_direction="left")
    found = map_of(file, tmp_path)
    lanelet = found.lanelets[before]
    assert len(lanelet.lights) == 2
    assert lanelet.lights_to.keys() == {on, left}
    assert lanelet.lights_to[on] is not lanelet.lights_to[left]
    assert not found.lanelets[on].lights
    # A line that no rule names is still on the map
    assert lanelet.stop_line is not None or not with_line
    assert found.lanelets[on].types == {"urban", "intersection"}


def test_several_lights_for_one_way_are_all_for_it(tmp_path):
    file = MapFile()
    lamps = [file.line((60 + k, 2), (61 + k, 2)) for k in (0, 2)]
    rules = [file.rule("traffic_light", [("refers", "way", lamp)]) for lamp in lamps]
    before = road(file, 0, 50)
    road(file, 50, 70, rules=rules, turn_direction="straight")
    lanelet = map_of(file, tmp_path).lanelets[before]
    assert len(lanelet.lights) == 2
    assert lanelet.lights_to == {}


def test_a_light_of_walkers_directs_their_crossing(tmp_path):
    file = MapFile()
    rule = file.rule("traffic_light", [("refers", "way", file.line((0, 9), (1, 9)))])
    name = road(file, 0, 9, rules=[rule], subtype="crosswalk")
    lanelet = map_of(file, tmp_path).lanelets[name]
    assert lanelet.types == {"crosswalk", "directed", "urban"}
    assert lanelet.lights == ()


def signed(file, kind, rule="traffic_sign", line=None, **tags):
    post = file.line((10, 5), (10, 6), type="traffic_sign", subtype=kind)
    roles = [("refers", "way", post)]
    return file.rule(rule, roles if line is None else [*roles, ("ref_line", "way", line)], **tags)


def test_a_stop_sign_and_its_line(tmp_path):
    file = MapFile()
    line = file.line((30, 0), (30, -3))
    first = road(file, 0, 50, rules=[signed(file, "de206", line=line)])
    lanelet = map_of(file, tmp_path).lanelets[first]
    assert lanelet.signs == {"STOP"}
    assert lanelet.stop_line.tolist() == [[30, 0], [30, -3]]


def test_a_sign_at_the_line_behind_which_a_lanelet_begins(tmp_path):
    file = MapFile()
    line = file.line((50, 0), (50, -3))
    before = road(file, 0, 50)
    behind = road(file, 50, 70, rules=[signed(file, "usR1-1", line=line)], turn_direction="left")
    found = map_of(file, tmp_path).lanelets
    assert (found[before].signs, found[behind].signs) == ({"STOP"}, frozenset())


@pytest.mark.parametrize(
    ("kind", "name", "kmh"),
    [
        *[("de205", "YIELD", None), ("de306", "PRIORITY", None), ("DE206", "STOP", None)],
        *[("de274-30", "MAX_SPEED", 30), ("de274_1", "MAX_SPEED_ZONE_START", None)],
        *[("usR1-1", "STOP", None), ("us_r1-2", "YIELD", None), ("usR2-1", "MAX_SPEED", None)],
        *[("stop_sign", "STOP", None), ("jp330", "STOP", None), ("plA-7", "YIELD", None)],
        *[("frAB3a", "YIELD", None), ("se_b4", "PRIORITY", None), ("jp206", "UNKNOWN", None)],
        *[("jp330-A", "STOP", None), ("jp330_2", "STOP", None), ("ch2.30.1", "MAX_SPEED", None)],
        # Numbers of countries whose signs are not known here are not Germany's
        *[("at206", "UNKNOWN", None), ("xx206", "UNKNOWN", None), ("", "UNKNOWN", None)],
        *[("50 km/h", "MAX_SPEED", 50), ("30mph", "MAX_SPEED", 30 * 1.609344)],
        # A zone begins and ends; the least speed
        *[("de274.1-30", "MAX_SPEED_ZONE_START", 30), ("de274_1-20", "MAX_SPEED_ZONE_START", 20)],
        *[("de274_2", "MAX_SPEED_ZONE_END", None), ("de275-60", "MIN_SPEED", 60)],
    ],
)
def test_signs(kind, name, kmh):
    expected = None if kmh is None else pytest.approx(kmh / 3.6)
    found = sign_of(kind)
    assert (found.name, found.limit_mps) == (name, expected)
    numbered = {"MAX_SPEED": "MAX_SPEED", "MAX_SPEED_ZONE_START": "MAX_SPEED"}
    assert found.untold == ("" if kmh else numbered.get(name, ""))


def test_limits_of_signs_go_before_those_of_tags(tmp_path):
    file = MapFile()
    by_sign = signed(file, "de274-30", "speed_limit")
    by_word = file.rule("speed_limit", [], sign_type="20 km/h")
    changing = signed(file, "de274-10", "speed_limit", dynamic="yes")
    signs = road(file, 0, 50, rules=[by_sign], speed_limit="50")
    both = road(file, 50, 90, rules=[by_sign, by_word])
    dynamic = road(file, 90, 99, rules=[changing], speed_limit="50")
    found = map_of(file, tmp_path).lanelets
    kmh = {name: round(found[name].limit_mps * 3.6, 6) for name in (signs, both)}
    assert kmh == {signs: 30, both: 20}
    # It may show less than the tag says, or more
    assert (found[dynamic].limit_mps, found[dynamic].untold_signs) == (None, {"MAX_SPEED"})


@pytest.mark.parametrize("plate", ["de1040-30", "de1010-51", "de1042-33", "de1020"])
@pytest.mark.parametrize("referred", [True, False])
def test_a_limit_with_a_plate_is_not_one_for_everybody(tmp_path, plate, referred):
    """Whether the rule refers to the plate, or it only stands below the sign."""
    file = MapFile()
    post = file.line((10, 5), (10.5, 5), type="traffic_sign", subtype="de274-30")
    below = file.line((10, 4.8), (10.5, 4.8), type="traffic_sign", subtype=plate)
    roles = [("refers", "way", post)] + [("refers", "way", below)] * referred
    first = road(file, 0, 50, rules=[file.rule("speed_limit", roles)], speed_limit="50")
    far = file.line((60, 5), (60.5, 5), type="traffic_sign", subtype="de276")
    other = road(file, 50, 90, rules=[file.rule("traffic_sign", [("refers", "way", far)])])
    found = map_of(file, tmp_path)
    lanelet = found.lanelets[first]
    assert (lanelet.limit_mps, lanelet.untold_signs) == (None, {"MAX_SPEED"})
    assert lanelet.signs == {"UNKNOWN"}
    assert any("on 1 lanelets only for some" in remark for remark in found.remarks)
    # Elsewhere it is for nobody
    assert found.lanelets[other].signs == {"NO_OVERTAKING_START"}


@pytest.mark.parametrize(
    ("kind", "plate", "signs", "untold"),
    [
        ("de206", "de1000-32", {"STOP"}, set()),
        ("de206", "de1004-32", set(), {"STOP"}),
        ("de276", "de1049-13", {"UNKNOWN"}, {"NO_OVERTAKING_START"}),
        ("de274-30", "de1001-30", {"MAX_SPEED"}, set()),
    ],
)
def test_what_plates_leave_of_signs(tmp_path, kind, plate, signs, untold):
    file = MapFile()
    posts = [
        file.line((10, y), (10.5, y), type="traffic_sign", subtype=word)
        for y, word in ((5, kind), (4.8, plate))
    ]
    rule = file.rule("traffic_sign", [("refers", "way", post) for post in posts])
    name = road(file, 0, 50, rules=[rule])
    lanelet = map_of(file, tmp_path).lanelets[name]
    assert lanelet.signs - ({"UNKNOWN"} - signs) == signs
    assert lanelet.untold_signs == untold


def test_a_limit_without_a_number_leaves_that_of_a_tag(tmp_path):
    file = MapFile()
    rules = [signed(file, "de274_1")]
    tagged = road(file, 0, 50, rules=rules, speed_limit="30")
    plain = road(file, 50, 90, rules=rules)
    found = map_of(file, tmp_path).lanelets
    assert found[tagged].limit_mps == pytest.approx(30 / 3.6)
    assert (found[plain].limit_mps, found[plain].untold_signs) == (None, {"MAX_SPEED"})


def test_the_least_speed_is_no_limit(tmp_path):
    file = MapFile()
    name = road(file, 0, 50, rules=[signed(file, "de275-60")], speed_limit="100")
    lanelet = map_of(file, tmp_path).lanelets[name]
    assert (lanelet.minimum_mps, lanelet.limit_mps) == pytest.approx((60 / 3.6, 100 / 3.6))


def test_a_line_for_several_lanes_is_parted(tmp_path):
    file = MapFile()
    # Aslant across two lanes of 3 m: 2 m farther on the right than on the left
    line = file.line((45, 3), (47, -3), type="stop_line")
    rule = file.rule("traffic_light", [("ref_line", "way", line)])
    middle = file.line((0, 0), (50, 0))
    left = file.lanelet(file.line((0, 3), (50, 3)), middle, rules=[rule])
    right = file.lanelet(middle, file.line((0, -3), (50, -3)), rules=[rule])
    found = map_of(file, tmp_path).lanelets
    assert found[left].stop_line == pytest.approx(np.array([[45, 3], [46, 0]]))
    assert found[right].stop_line == pytest.approx(np.array([[46, 0], [47, -3]]))


def test_everybody_stops(tmp_path):
    file = MapFile()
    lines = [file.line((48, 0), (48, -3)), file.line((60, 0), (60, -3))]
    one, other = road(file, 0, 50), road(file, 90, 60)
    members = [("yield", "relation", x) for x in (one, other)]
    file.rule("all_way_stop", [*members, *[("ref_line", "way", line) for line in lines]])
    found = map_of(file, tmp_path).lanelets
    assert found[one].signs == found[other].signs == {"STOP_4_WAY"}
    assert found[one].stop_line[0].tolist() == [48, 0]
    assert found[other].stop_line[0].tolist() == [60, 0]


def test_lines_across_a_lane_are_for_it(tmp_path):
    file = MapFile()
    first, second = road(file, 0, 50), road(file, 50, 90)
    file.line((50, 0.2), (50, -3.1), type="stop_line")
    file.line((70, -1), (80, -1.2), type="stop_line")
    found = map_of(file, tmp_path).lanelets
    # Its part between the lane's bounds
    assert found[first].stop_line.tolist() == [[50, 0], [50, -3]]
    # One where it begins is the other's, and one along it is none
    assert found[second].stop_line is None


def test_the_line_of_a_rule_is_not_for_the_other_direction_as_well(tmp_path):
    """The road behind it may be driven both ways; a line of a rule for nobody is for all."""
    file = MapFile()
    line, other = (file.line((x, 0), (x, -3), type="stop_line") for x in (50, 90))
    rule = file.rule("traffic_light", [("ref_line", "way", line)])
    file.rule("traffic_light", [("ref_line", "way", other)])
    before = road(file, 0, 50, rules=[rule])
    behind = road(file, 50, 90, one_way="no")
    found = map_of(file, tmp_path).lanelets
    assert found[before].stop_line.tolist() == [[50, 0], [50, -3]]
    assert found[f"{behind}_reversed"].stop_line is None
    assert found[behind].stop_line.tolist() == [[90, 0], [90, -3]]


def junction(rule=None, light=False, **tags):
    """A road from the west that crosses one from the south, and one from the east to its left.

    The first gives way to the second, or whatever ``rule`` makes of their ids.
    """
    file = MapFile()
    lamp = [file.rule("traffic_light", [("refers", "way", file.line((0, 9), (1, 9)))])]
    west = road(file, -50, 0, rules=lamp if light else ())
    on = road(file, 0, 12, **tags)
    south = file.lanelet(file.line((4, -50), (4, -8)), file.line((7, -50), (7, -8)))
    up = file.lanelet(file.line((4, -8), (4, 5)), file.line((7, -8), (7, 5)), **tags)
    east = file.lanelet(file.line((50, 0), (12, 0)), file.line((50, 3), (12, 3)))
    turn = file.lanelet(
        file.line((12, 0), (8, -2), (7, -8)), file.line((12, 3), (5, -1), (4, -8)), **tags
    )
    post = file.line((0, -5), (0, -6), type="traffic_sign", subtype="de205")
    file.rule(
        "right_of_way",
        rule({"west": west, "on": on, "south": south, "up": up, "east": east, "turn": turn})
        if rule
        else [
            ("refers", "way", post),
            ("yield", "relation", west),
            ("right_of_way", "relation", south),
        ],
    )
    return file, {"west": west, "on": on, "south": south, "up": up, "east": east, "turn": turn}


def test_the_sign_of_a_right_of_way_is_where_one_gives_way(tmp_path):
    file, names = junction()
    found = map_of(file, tmp_path).lanelets
    signs = {place: set(found[name].signs) for place, name in names.items() if found[name].signs}
    assert signs == {"west": {"YIELD"}}


def test_who_turns_waits_for_whom_the_map_names(tmp_path):
    def oncoming(names):
        return [("yield", "relation", names["turn"]), ("right_of_way", "relation", names["on"])]

    file, names = junction(oncoming, turn_direction="straight")
    found = map_of(file, tmp_path).lanelets
    assert found[names["turn"]].first == {names["on"]}
    # Who comes towards it waits, and so nobody goes first
    assert found[names["on"]].first == frozenset()
    assert found[names["up"]].first is None
    # No sign is named, so there may be none
    assert not any(lanelet.signs for lanelet in found.values())


def test_who_is_not_told_to_wait_for_oncoming_traffic_is_told_nothing(tmp_path):
    def other(names):
        return [("yield", "relation", names["turn"]), ("right_of_way", "relation", names["up"])]

    file, names = junction(other, turn_direction="straight")
    assert map_of(file, tmp_path).lanelets[names["turn"]].first is None


def test_lanelets_before_the_junction_stand_for_those_in_it(tmp_path):
    def roads(names):
        prior = [("right_of_way", "relation", names[place]) for place in ("south", "east")]
        return [("yield", "relation", names["west"]), *prior]

    file, names = junction(roads)
    found = map_of(file, tmp_path).lanelets
    assert found[names["on"]].first == {names["up"], names["turn"]}
    assert found[names["west"]].first is None


def test_signs_hold_where_lights_do_not(tmp_path):
    file, names = junction(light=True)
    lanelet = map_of(file, tmp_path).lanelets[names["west"]]
    assert len(lanelet.lights) == 1
    assert lanelet.signs == frozenset()


@pytest.mark.parametrize(
    ("region", "side", "country"),
    [("de", "right", "DEU"), ("jp", "left", "JPN"), ("us-ca", "right", "USA"), ("zz", None, "")],
)
def test_the_side_of_the_country(tmp_path, region, side, country):
    file = MapFile()
    road(file, 0, 50, region=region)
    found = map_of(file, tmp_path)
    assert (found.side, found.country) == (side, country)
    assert any("side" in remark for remark in found.remarks) == (side is None)


@pytest.mark.parametrize(("one_way", "side"), [("yes", "left"), ("no", None)])
def test_the_side_of_lanes_that_share_a_line(tmp_path, one_way, side):
    file = MapFile()
    shared = file.line((0, 0), (50, 0))
    # Who leads east is above the line that both share, who leads west below
    file.lanelet(file.line((0, 3), (50, 3)), shared, one_way=one_way)
    file.lanelet(file.line((0, -3), (50, -3)), shared, one_way=one_way)
    assert map_of(file, tmp_path).side == side


@pytest.mark.skipif(
    not SAMPLES.is_dir(), reason="no Lanelet2 maps are at hand: set RULEC_RECORDINGS"
)
def test_maps_of_others():
    names = ("mapping_example", "crossroads_with_stoplines", "kashiwanoha")
    maps = {name: read_map(SAMPLES / f"{name}.osm", 0.1) for name in names}
    counts = {}
    for name, found in maps.items():
        lanes = [x for x in found.lanelets.values() if not x.id.endswith("_reversed")]
        lights = {id(light) for lanelet in lanes for light in lanelet.lights}
        crossings = [x for x in lanes if "crosswalk" in x.types]
        counts[name] = len(lanes), len(lights), len(crossings), found.side
    assert counts == {
        "mapping_example": (371, 6, 8, "right"),
        "crossroads_with_stoplines": (83, 2, 4, "left"),
        "kashiwanoha": (81, 1, 4, "left"),
    }
