"""Steps of recordings are those of the frame rates that they round, and no others."""

from math import nextafter

import pytest

from rulec import build_lanelet, build_participant, build_recording
from rulec.recordings.recording import frame_step


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        (0.033333, 1 / 30),
        (0.0333333, 1 / 30),
        (0.016667, 1 / 60),
        (0.041667, 1 / 24),
        (0.033367, 1001 / 30000),
        (0.03336667, 1001 / 30000),
        (nextafter(1 / 30, 1), 1 / 30),
        (1 / (30 * (1000 / 1001)), 1001 / 30000),
        (0.1 + 0.1 + 0.1 - 0.2, 0.1),
        (0.3 - 0.2, 0.1),
        (0.49999999999999994, 0.5),
        (0.5000000000000001, 0.5),
    ],
)
def test_what_rounds_the_step_of_a_frame_rate(written, meant):
    assert frame_step(written) == meant


@pytest.mark.parametrize(
    "step_s",
    [
        *(0.04, 0.1, 0.5, 1.0, 0.3, 2.5, 40.0, 0.03125),
        *(0.033, 0.0333, 0.017),  # too few digits: whole milliseconds may be meant
        *(0.033334, 0.0333334, 0.033332),  # off by more than half a unit
        *(0.50005, 0.50001, 0.5000000001, 0.49999, 0.1001, 0.10001, 0.1000001, 0.099999),
        *(1e-9, 5e-324, 1e300),
    ],
)
def test_what_is_another_step_stays(step_s):
    assert frame_step(step_s) == step_s


@pytest.mark.parametrize("digits", range(4, 15))
def test_what_is_nearer_is_rounded_first(digits):
    """Of numbers with as many decimals, none of which is 0 at the end, the nearest is the step."""
    unit = 10.0**-digits
    whole = round(1 / 30 / unit)
    steps = sorted((round((whole + k) * unit, digits) for k in range(-2, 4)), key=off_thirty)
    rounded = [frame_step(step) == 1 / 30 for step in steps]
    assert rounded == [digits > 5, *[False] * 5]


def off_thirty(step_s):
    return abs(step_s - 1 / 30)


def test_a_recording_has_the_step_of_its_frame_rate():
    t = [0.033333 * k for k in range(4)]
    body = build_participant("a", "car", t, [10, 11, 12, 13], [0] * 4, step_s=0.033333)
    lane = build_lanelet("l", [(0.0, 0.0), (100.0, 0.0)])
    assert build_recording([lane], [body], step_s=0.033333).step_s == 1 / 30
    assert build_recording([lane], [body], step_s=0.0333).step_s == 0.0333
