"""Queues: most of the gaps on a lane are short, by distance or by time."""

import pytest

from rulec.extraction.drives import Drives
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.recordings import recording, straight, vehicle


def queue_on_the_left(gaps, mps=0.0):
    """Is there one for ego on the right lane, beside the first of cars of 4 m with these gaps?"""
    lanes = [straight(1, -200, 400, left_of=2), straight(2, -200, 400, y=4.0, right_of=1)]
    x, cars = 0.0, []
    for number, gap in enumerate([*gaps, 0.0], 1):
        cars.append(vehicle(number, {k: (x + mps * k / 2, 4.0) for k in range(3)}))
        x += 4.0 + gap
    ego = vehicle(99, {k: (0.0 + mps * k / 2, 0.0) for k in range(3)})
    (drive,) = Drives(recording(lanes, [*cars, ego]), "right").of("99")
    return drive.trace.states[1]["far_lane_queue"]


@pytest.mark.parametrize(
    ("gaps", "mps", "queue"),
    [
        ((19, 19), 0.0, True),
        ((19, 30), 0.0, False),  # one of two is no more than a half
        ((30, 30), 0.0, False),
        ((19, 30, 30), 0.0, False),
        ((5, 30, 5, 30), 0.0, False),
        ((5, 30, 5), 0.0, True),
        ((19,), 0.0, False),  # two cars are no queue
        ((30, 30), 15.5, True),  # 31 m are 2 s
        ((31.1, 31.1), 15.5, UNKNOWN),  # speeds are good to 0.1 m/s
        ((45, 45), 15.5, UNKNOWN),  # 2.9 s: some call that following
        ((47, 47), 15.5, False),
    ],
)
def test_most_of_the_gaps_are_short(gaps, mps, queue):
    assert queue_on_the_left(gaps, mps) is queue


@pytest.mark.parametrize("on_main", [0, 3], ids=["free lanes", "queues on all"])
def test_the_lanes_of_the_road_that_ego_joins_do_not_begin_there(on_main):
    """From a ramp ego gets beside three lanes that come from elsewhere: all of them count."""
    lanes = [
        straight(1, -150, 0, successors=(2,)),
        straight(2, 0, 200, predecessors=(1,), left_of=12),
    ]
    for k in (1, 2, 3):
        more = {} if k == 3 else {"left_of": 10 * k + 12}
        before = {"right_of": 10 * k - 9} if k > 1 else {}
        further = {} if k == 3 else {"left_of": 10 * k + 11}
        y = 4.0 * k
        lanes.append(
            straight(10 * k + 1, -300, 0, y=y, successors=(10 * k + 2,), **before, **further)
        )
        lanes.append(
            straight(
                10 * k + 2, 0, 400, y=y, predecessors=(10 * k + 1,), right_of=10 * k - 8, **more
            )
        )
    bodies = (
        [(10.0 * j, 4.0) for j in (2, 3, 4)] + [(3.0, 4.0)] + [(10.0 * j, 0.0) for j in range(1, 4)]
    )
    bodies += [(10.0 * j, y) for y in (8.0, 12.0) for j in range(on_main)]
    places = [[(-30, 0), (0, 0), (10.0, 4.0), (10.0, 4.0)], *[[body] * 4 for body in bodies]]
    cars = [vehicle(k, dict(enumerate(way))) for k, way in enumerate(places, 1)]
    (drive,) = Drives(recording(lanes, cars), "right").of("1")
    told = drive.trace.states[3]["dense_all_lanes"]
    assert (told is False) is (on_main == 0)


@pytest.mark.parametrize(
    ("front", "ahead", "dense"),
    [
        # At 30 m/s gaps of a queue are up to 90 m, and the map has 200 m of it: too few for three
        (60.0, None, False),
        (112.0, None, UNKNOWN),
        (60.0, 40.0, UNKNOWN),
        (60.0, 95.0, False),
    ],
)
def test_ego_leads_no_queue_of_a_short_map_where_its_lane_is_empty(front, ahead, dense):
    """Its lane goes on for 200 m - ``front``, perhaps with somebody so far ahead of it."""
    lanes = [straight(1, 0, 200, left_of=2), straight(2, 0, 200, y=4.0, right_of=1)]
    places = [(front - 2.0, 0.0)] + ([] if ahead is None else [(front + ahead + 2.0, 0.0)])
    cars = [
        vehicle(k, {step: (x + 3.0 * (step - 1), y) for step in range(3)}, speed=30.0)
        for k, (x, y) in enumerate(places, 1)
    ]
    found = recording(lanes, cars, step_s=0.1)
    (drive,) = Drives(found, "right").of("1")
    assert drive.trace.states[1]["dense_all_lanes"] is dense
