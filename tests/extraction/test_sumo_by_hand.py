"""Twelve vehicles of a real simulation, whose verdicts were found from its positions alone.

The road is straight, so bodies are turned rectangles along x; what each of these did was counted
out from them, with the numbers of ``docs/recordings.md``, and the verdict found in the law. Times
are those of the simulation, in s: of the first state by which a rule is violated.
"""

import pytest

from rulec import read_recording
from rulec.api.rulebook_compilation import machines
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives as Wanted
from support.builders.sumo_files import SUMO

FILE = SUMO / "fcd.xml.gz"
if not FILE.exists():
    pytest.skip(f"SUMO's {FILE.name} is not here: set RULEC_RECORDINGS", allow_module_level=True)

# A bus and a car on the lane at the kerb, within the limit, pass nobody and meet nobody
QUIET = {"de": {}, "gb": {}}
# 59.6 km/h where 50 are allowed, from its first moment on
SPEEDING = {"de": {"speed_limit": 0.0}, "gb": {"speed_limit": 0.0}}
EXPECTED = {
    "eb.0": QUIET,
    "ew.2": QUIET,
    "ew.0": SPEEDING,
    # Passes two that stand in a queue of the left lane at the crossing, by at most 16 km/h; drives
    # over the crossing when p.2 has left its lane (1.2 m beside it at 45.1 s) and walks away. For
    # Britain the two stand: no overtaking.
    "ws.0": {"de": {"crossing_overtaking": 40.8}, "gb": {}},
    # Passes we.9 on the right by up to 28 km/h, too much for a German queue on the left lane; p.3
    # has left its lane, too
    "ws.1": {"de": {"near_side_passing": 61.6, "crossing_overtaking": 61.6}, "gb": {}},
    # Passes we.28 on the right, with no queue: two vehicles on the left lane
    "we.29": {
        "de": {"near_side_passing": 138.6, "crossing_overtaking": 138.6},
        "gb": {"near_side_passing": 138.6, "crossing_overtaking": 138.6},
    },
    # Passes the queue on the left lane, which stands, by less than 20 km/h, up to the crossing
    "we.5": {
        "de": {"speed_limit": 20.0, "crossing_overtaking": 47.3},
        "gb": {"speed_limit": 20.0},
    },
    # Passes ew.4 on the left, at times by less than 1 km/h, but in a lane of its own all along. For
    # Britain that is not the nearest to the crossing: ew.2 moves on 7.8 m in front of it
    "ew.5": {
        "de": {"speed_limit": 25.8, "crossing_overtaking": 51.3},
        "gb": {"speed_limit": 25.8},
    },
    # 28.4 m behind ew.7 at 15.1 m/s, and it takes 29.4 m. But ew.7 has its middle in the other
    # lane and is 0.2 m in the way: whether it is ahead in this one is open
    "ew.8": {book: {"speed_limit": 41.2} for book in ("de", "gb")},
    # Stands askew into the lane beside until p.5 has left its own, and turns away from p.5 into it.
    # Who crosses is not passed, though p.5 is 0.9 m away when they are level.
    "we.9": {book: {"speed_limit": 36.0} for book in ("de", "gb")},
    # Passes we.8 on the right where at times there is no queue; p.6 has left its lane
    "we.12": {
        book: {"near_side_passing": 81.2, "crossing_overtaking": 81.2} for book in ("de", "gb")
    },
    # Passes we.11 on the right, which stood when that began, at the crossing; with one more near
    # behind it, and the next far behind, that is no queue
    "we.10": {
        "de": {"speed_limit": 40.0, "near_side_passing": 74.8, "crossing_overtaking": 74.8},
        "gb": {"speed_limit": 40.0, "near_side_passing": 74.8},
    },
}
COUNTED = {
    "de": {
        "speed_limit",
        "near_side_passing",
        "crossing_overtaking",
        "give_way_to_pedestrians",
        "following_distance",
        "lateral_gap_to_pedestrians",
        "speed_advantage",
    },
    "gb": {
        "speed_limit",
        "near_side_passing",
        "crossing_overtaking",
        "give_way_to_pedestrians",
        "lateral_gap_to_pedestrians",
    },
}


@pytest.fixture(scope="module")
def simulated():
    return read_recording(FILE)


@pytest.mark.parametrize("book", ["de", "gb"])
def test_what_they_did(simulated, book):
    # Nothing says whether the road is in a town: the defaults, out of town and no lorry, are meant
    wanted = Wanted(tuple(EXPECTED), defaults=True)
    judged = RecordingVerdicts(simulated, machines(book), wanted, str(FILE))
    found = {}
    for one in judged.answers():
        times = found.setdefault(one.drive.ego, {})
        for violation in one.answer.violations:
            if violation.rule in COUNTED[book]:
                at = round(one.drive.time_s(violation.step), 1)
                times[violation.rule] = min(at, times.get(violation.rule, at))
    assert found == {ego: verdicts[book] for ego, verdicts in EXPECTED.items()}
    assert judged.mirrored == (book == "gb")
