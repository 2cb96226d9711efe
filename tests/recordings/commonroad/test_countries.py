"""On which side a scenario's country drives."""

import pytest

from rulec import read_recording
from rulec.recordings.commonroad.countries import (
    LEFT_HAND,
    RIGHT_HAND,
    country_in,
    country_of,
    side_in,
)
from support.builders.recordings import ROAD_XML


@pytest.mark.parametrize(
    ("name", "side"),
    [
        ("DEU_A9-2_1_T-1", "right"),
        ("USA_US101-1_1_T-1", "right"),
        ("GBR_London-1_1_T-1", "left"),
        ("C-JPN_Tokyo-1_2_S-1", "left"),
        ("ZAM_Tutorial-1_1_T-1", None),  # the made-up country Zamunda
        ("OSC_PedestrianCollision-1_1_T-1", None),
        ("my own drive", None),
        ("", None),
    ],
)
def test_the_side(name, side):
    assert side_in(country_in(name)) == side


@pytest.mark.parametrize("name", ["following", "my_drive", "2026_01_01", ""])
def test_names_without_a_country_have_none(name):
    assert country_in(name) == ""


@pytest.mark.parametrize(
    ("named", "benchmark", "told"),
    [
        ("run", "GBR_Road-1_1_T-1", ("GBR", "left")),  # a copy
        ("DEU_Road-1_1_T-1", "GBR_Road-1_1_T-1", ("GBR", "left")),
        ("GBR_Road-1_1_T-1", "ZAM_Road-1_1_T-1", ("GBR", "left")),  # in no country of its own
        ("run", "ZAM_Road-1_1_T-1", ("ZAM", None)),
        ("run", "road", ("", None)),
    ],
)
def test_the_benchmark_says_where_it_is_and_else_the_name(tmp_path, named, benchmark, told):
    file = tmp_path / f"{named}.xml"
    file.write_text(ROAD_XML.replace("ZAM_Road-1_1_T-1", benchmark))
    found = read_recording(file)
    assert (found.country, found.side) == told


def test_no_code_is_that_of_two_countries():
    left, right = LEFT_HAND.split(), RIGHT_HAND.split()
    assert left == sorted(left)
    assert right == sorted(right)
    codes = [code for entry in left + right for code in entry.split("/")]
    assert len(set(codes)) == len(codes)
    assert all(len(entry) == len("DEU/DE/276") for entry in left + right)


@pytest.mark.parametrize(
    ("code", "country"),
    [
        *[("de", "DEU"), ("DE", "DEU"), ("276", "DEU"), ("gb", "GBR"), ("uk", "GBR")],
        *[("036", "AUS"), ("xx", ""), ("000", ""), ("", "")],
    ],
)
def test_a_country_by_its_other_codes(code, country):
    assert country_of(code) == country
