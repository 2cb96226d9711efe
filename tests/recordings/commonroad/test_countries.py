"""On which side a scenario's country drives."""

import pytest

from rulec.recordings.commonroad.countries import LEFT_HAND, RIGHT_HAND, side_in


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
    assert side_in(name) == side


def test_no_country_drives_on_both_sides():
    left, right = LEFT_HAND.split(), RIGHT_HAND.split()
    assert not set(left) & set(right)
    assert left == sorted(set(left))
    assert right == sorted(set(right))
