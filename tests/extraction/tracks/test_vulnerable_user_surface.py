"""The surface under vulnerable road users."""

from rulec.extraction.tracks.tracks import tracks_of
from rulec.extraction.traffic_thresholds import USUAL
from support.builders.recordings import lanelet, recording, straight, vehicle

ZEBRA = lanelet(9, [(50, -6), (50, 6)], width=4, types=frozenset({"crosswalk"}))
PAVEMENT = straight(8, 0, 100, y=-4, types=frozenset({"sidewalk"}))


def test_lanes_of_any_direction_and_crossings_count():
    walker = vehicle(
        1, {0: (50, -5), 1: (50, 0), 2: (60, 0), 3: (60, -4), 4: (60, 9)}, "pedestrian"
    )
    cyclist = vehicle(2, {0: (20, 1), 2: (20, 30)}, "bicycle")
    car = vehicle(3, dict.fromkeys(range(5), (50, 0)))
    found = recording([straight(1, 100, 0), ZEBRA, PAVEMENT], [walker, cyclist, car])
    tracks = tracks_of(found, USUAL)
    assert tracks.on_lane.tolist() == [
        [False, True, True, False, False],
        [True, False, False, False, False],
        [False] * 5,
    ]
    assert tracks.on_crosswalk.tolist() == [
        [True, True, False, False, False],
        [False] * 5,
        [False] * 5,
    ]


def test_a_map_without_such_surfaces_has_nobody_on_them():
    found = recording([PAVEMENT], [vehicle(1, {0: (50, 0)}, "pedestrian")])
    tracks = tracks_of(found, USUAL)
    assert not tracks.on_lane.any()
    assert not tracks.on_crosswalk.any()
