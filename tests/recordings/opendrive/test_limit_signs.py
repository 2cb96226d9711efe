"""Signs of OpenDRIVE maps that limit the speed, with their numbers, units, plates and meanings."""

import pytest

from rulec.recordings.map_files import read_map
from support.builders.opendrive_files import document, road, section, signals, two_way, written
from support.builders.opendrive_files import lane as one_lane

KMH = 1 / 3.6
OF_ROAD = '<type s="0" type="town"><speed max="50" unit="km/h"/></type>'
LIMIT = {"id": "a", "s": 60, "t": -4, "orientation": "+", "type": "274", "country": "DE"}
THIRTY = LIMIT | {"value": 30, "unit": "km/h"}
HIDES = "signs limit the speed, or may do so"


def map_with(folder, *signs, more="", parts=()):
    """A road of two lanes with a limit of 50 km/h, and these signs along it."""
    one = road(1, two_way(), more=OF_ROAD + signals(*signs) + more)
    return read_map(written(folder, document(*parts, one)), 0.1)


def behind(folder, *signs):
    """The last lanelet that leads east, behind all signs."""
    return max(
        (x for x in map_with(folder, *signs).lanelets.values() if x.id.endswith("-1")),
        key=lambda x: x.centre[0, 0],
    )


def unknown(lanelet):
    return lanelet.limit_mps is None and "MAX_SPEED" in lanelet.untold_signs


@pytest.mark.parametrize(
    ("changes", "kmh"),
    [
        # Of the old catalogue, of the new one
        *[({"subtype": "55"}, 50), ({"subtype": "62"}, 120), ({"subtype": "100"}, 100)],
        *[({"subtype": "70"}, 70), ({"subtype": "130"}, 130), ({"subtype": "30"}, 30)],
        *[({"type": "274-100"}, 100), ({"type": "274.1-20"}, 20)],
        *[({"value": 20, "unit": "mph"}, 20 * 1.609344), ({"value": 36, "unit": "KM/H"}, 36)],
        ({"inside": '<semantics><speed type="maximum" value="80" unit="km/h"/></semantics>'}, 80),
        ({"inside": '<semantics><speed type="maximum" value="10" unit="m/s"/></semantics>'}, 36),
        (
            {
                "country": "AT",
                "type": "52.10a",
                "inside": '<semantics><speed type="zone" value="30" unit="km/h"/></semantics>',
            },
            30,
        ),
    ],
)
def test_numbers_that_are_read(tmp_path, changes, kmh):
    lanelet = behind(tmp_path, LIMIT | changes)
    assert lanelet.limit_mps == pytest.approx(kmh * KMH)
    assert lanelet.untold_signs == frozenset()


@pytest.mark.parametrize(
    "changes",
    [
        # 100 km/h in the old catalogue, and 60 in the new one
        *[
            {"subtype": "60"},
            {"subtype": "50"},
            {"type": "274-60"},
            {},
            {"value": 20, "unit": "mi/h"},
        ],
        {"inside": '<semantics><speed type="maximum" value="80" unit="knots"/></semantics>'},
        {"dynamic": "yes", "value": 30},
        {
            "value": 30,
            "inside": '<semantics><speed type="maximum" value="80" unit="km/h"/></semantics>',
        },
        {"type": "-1", "inside": '<staticBoard><sign type="274" value="30"/></staticBoard>'},
        {"type": "-1", "inside": "<vmsBoard/>"},
        {"country": "AT", "type": "52.10a", "value": 30, "unit": "km/h"},
        {"country": "AT", "type": "52.10a"},
        {"country": "FR", "type": "C4a", "value": 30, "unit": "km/h"},
    ],
)
def test_a_sign_that_is_not_read_hides_the_limit_of_the_road(tmp_path, changes):
    """Neither the road's 50 km/h nor those of the sign before it are certain behind it."""
    before = {"id": "b", "s": 20, "orientation": "+", "type": "274", "value": 40}
    found = map_with(tmp_path, before, LIMIT | changes)
    lanelets = found.lanelets
    limits = [lanelets[f"1.{piece}.-1"].limit_mps for piece in range(3)]
    assert limits == [pytest.approx(50 * KMH), pytest.approx(40 * KMH), None]
    assert unknown(lanelets["1.2.-1"])
    assert lanelets["1.2.1"].limit_mps == pytest.approx(50 * KMH)
    assert any(remark.startswith(f"1 {HIDES}") for remark in found.remarks)


@pytest.mark.parametrize(
    "changes",
    [
        {
            "country": "AT",
            "type": "52.24",
            "inside": '<semantics><priority type="stop"/></semantics>',
        },
        *[{"country": "FR", "type": "A1a"}, {"type": "-1"}, {"type": "142-10"}],
        {"country": "AT", "type": "1000001", "dynamic": "yes"},
    ],
)
def test_what_is_no_limit_leaves_that_of_the_road(tmp_path, changes):
    lanelet = behind(tmp_path, LIMIT | changes)
    assert lanelet.limit_mps == pytest.approx(50 * KMH)


def test_an_end_and_another_sign_are_certain_again(tmp_path):
    signs = [
        LIMIT | {"s": 20},
        LIMIT | {"id": "b", "s": 40, "value": 70},
        LIMIT | {"id": "c", "s": 60},
        LIMIT | {"id": "d", "s": 80, "type": "278"},
    ]
    lanelets = map_with(tmp_path, *signs).lanelets
    of = [lanelets[f"1.{piece}.-1"] for piece in range(5)]
    assert [x.limit_mps and round(x.limit_mps / KMH) for x in of] == [50, None, 70, None, 50]
    assert [unknown(x) for x in of] == [False, True, False, True, False]


def test_a_limit_of_the_lane_itself_comes_first(tmp_path):
    own = '<speed sOffset="0" max="36" unit="km/h"/>'
    one = road(1, section(one_lane(-1, more=own)), more=OF_ROAD + signals(LIMIT))
    found = read_map(written(tmp_path, document(one)), 0.1).lanelets["1.1.-1"]
    assert (found.limit_mps, found.untold_signs) == (pytest.approx(10), frozenset())


PLATE = {"id": "p", "s": 60, "t": -4, "orientation": "+", "type": "1040", "subtype": "30"}


@pytest.mark.parametrize(
    ("main", "plate"),
    [
        ({}, PLATE),
        ({}, PLATE | {"type": "1010", "subtype": "51", "t": -4.2}),
        ({}, PLATE | {"type": "1053-35", "subtype": "-1"}),
        # Some tools give all signals one id, or plates no direction
        ({}, PLATE | {"id": "a", "orientation": "none"}),
        # Elsewhere, but linked
        ({"inside": '<dependency id="p" type="supplementary"/>'}, PLATE | {"t": 9}),
        ({"inside": '<reference elementType="signal" elementId="p"/>'}, PLATE | {"t": 9}),
        ({}, PLATE | {"t": 9, "inside": '<dependency id="a"/>'}),
        ({"inside": '<semantics><supplementaryTime type="time" value="7"/></semantics>'}, None),
        ({"inside": '<semantics><supplementaryDistance type="in"/></semantics>'}, None),
        ({"type": "B14", "country": "FR"}, PLATE | {"type": "M4d1", "country": "FR"}),
    ],
)
def test_a_limit_with_a_plate_is_not_one_for_everybody(tmp_path, main, plate):
    found = behind(tmp_path, THIRTY | main, *([] if plate is None else [plate]))
    assert unknown(found)
    assert found.signs == frozenset()


@pytest.mark.parametrize(
    ("main", "plate"),
    [
        ({}, PLATE | {"t": 4}),
        ({}, PLATE | {"orientation": "-"}),
        ({}, PLATE | {"s": 70}),
        # For how many metres
        ({}, PLATE | {"type": "1001", "subtype": "30"}),
        ({"inside": '<semantics><supplementaryDistance type="for"/></semantics>'}, None),
        ({"inside": '<reference elementType="object" elementId="p"/>'}, PLATE | {"t": 9}),
    ],
)
def test_plates_elsewhere_and_of_length_leave_a_limit_as_it_is(tmp_path, main, plate):
    found = behind(tmp_path, THIRTY | main, *([] if plate is None else [plate]))
    assert found.limit_mps == pytest.approx(30 * KMH)


def test_a_ban_of_overtaking_with_a_plate(tmp_path):
    found = behind(tmp_path, LIMIT | {"type": "276"}, PLATE | {"type": "1049", "subtype": "13"})
    assert (found.signs, found.untold_signs) == (frozenset(), {"NO_OVERTAKING_START"})
    assert found.limit_mps == pytest.approx(50 * KMH)


@pytest.mark.parametrize(
    ("plate", "signs", "untold"), [("1000-32", {"STOP"}, set()), ("1004-32", set(), {"STOP"})]
)
def test_a_stop_sign_with_a_plate(tmp_path, plate, signs, untold):
    at = {"s": 95, "type": "206"}
    found = behind(tmp_path, LIMIT | at, PLATE | {"s": 95, "type": plate, "subtype": ""})
    assert (found.signs, found.untold_signs) == (signs, untold)


@pytest.mark.parametrize("zone", [{"type": "274.1"}, {"type": "274", "subtype": "1"}])
def test_a_zone_limits_the_speed_until_its_end(tmp_path, zone):
    signs = [
        THIRTY | {"id": "b", "s": 20, "value": 60},
        THIRTY | zone,
        LIMIT | {"id": "c", "s": 80, "type": "274.2"},
    ]
    lanelets = map_with(tmp_path, *signs).lanelets
    of = [lanelets[f"1.{piece}.-1"] for piece in range(4)]
    assert [round(x.limit_mps / KMH) for x in of] == [50, 60, 30, 50]
    assert of[1].signs == {"MAX_SPEED"}
    assert "MAX_SPEED_ZONE_START" in of[2].signs
    assert of[3].signs == frozenset()


@pytest.mark.parametrize(
    ("country", "limit", "ends"),
    [
        ("BE", "C43", ("C45", "C46")),
        ("CH", "2.30", ("2.53", "2.58")),
        ("ES", "R301", ("R501", "R500")),
        ("ES", "R-301", ("R-501", "R-500")),
        ("FR", "B14", ("B33", "B31")),
        ("FR", "B30", ("B51",)),
        ("GB", "670", ("671",)),
        ("NL", "A1", ("A2", "F8")),
        ("PL", "B-33", ("B-34", "B-42")),
        ("PL", "B-43", ("B-44",)),
        ("RU", "3.24", ("3.25", "3.31")),
        ("SE", "C31", ("C32",)),
    ],
)
def test_other_countries_signs_end_a_limit(tmp_path, country, limit, ends):
    for end in ends:
        signs = [
            THIRTY | {"s": 20, "type": limit, "country": country},
            LIMIT | {"id": "b", "type": end, "country": country},
        ]
        lanelets = map_with(tmp_path, *signs).lanelets
        of = [lanelets[f"1.{piece}.-1"] for piece in range(3)]
        assert [x.limit_mps and round(x.limit_mps / KMH) for x in of] == [50, 30, 50], end
        assert [unknown(x) for x in of] == [False, False, False], end


@pytest.mark.parametrize(
    ("country", "ban", "end"),
    [
        *[("BE", "C35", "C37"), ("CH", "2.44", "2.55"), ("FR", "B3", "B34"), ("NL", "F1", "F2")],
        *[("ES", "r305", "R502"), ("PL", "B-25", "B-27"), ("SE", "C27", "C28")],
    ],
)
def test_other_countries_signs_end_a_ban_of_overtaking(tmp_path, country, ban, end):
    signs = [
        LIMIT | {"s": 20, "type": ban, "country": country},
        LIMIT | {"id": "b", "type": end, "country": country},
    ]
    lanelets = map_with(tmp_path, *signs).lanelets
    assert lanelets["1.1.-1"].signs == {"NO_OVERTAKING_START"}
    assert lanelets["1.2.-1"].signs == frozenset()


def test_what_ends_within_a_zone_leaves_its_limit(tmp_path):
    signs = [
        THIRTY | {"s": 20, "type": "274.1"},
        THIRTY | {"id": "b", "s": 40, "value": 40},
        LIMIT | {"id": "c", "type": "278"},
    ]
    assert unknown(behind(tmp_path, *signs))


@pytest.mark.parametrize("kind", ["275", "277", "310", "245", "250"])
def test_signs_other_than_those_of_priority_do_not_hold_before_their_place(tmp_path, kind):
    lanelets = map_with(tmp_path, LIMIT | {"s": 50, "type": kind, "value": 60}).lanelets
    assert lanelets["1.0.-1"].signs == frozenset()
    assert len(lanelets["1.1.-1"].signs) == 1


def test_the_least_speed(tmp_path):
    signs = [
        LIMIT | {"s": 20, "type": "275", "value": 60, "unit": "km/h"},
        LIMIT | {"id": "b", "s": 50, "type": "275"},
        LIMIT | {"id": "c", "s": 70, "type": "279"},
    ]
    lanelets = map_with(tmp_path, *signs).lanelets
    of = [lanelets[f"1.{piece}.-1"] for piece in range(4)]
    assert [x.minimum_mps for x in of] == [None, pytest.approx(60 * KMH), None, None]
    assert [x.untold_signs for x in of] == [set(), set(), {"MIN_SPEED"}, set()]


def test_what_is_left_out_is_said(tmp_path):
    signs = [
        LIMIT | {"id": str(k), "country": country, "type": "x"}
        for k, country in enumerate(("AT", "AT", "DK"))
    ]
    include = '<include file="other.xodr"/>'
    remarks = map_with(tmp_path, *signs, parts=(include,)).remarks
    left_out = (
        "signs of countries whose catalogue is not known here are left out: 2 of AUT, 1 of DNK"
    )
    assert left_out in remarks
    assert "files that the map includes are not read: `other.xodr`" in remarks
