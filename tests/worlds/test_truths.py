"""What counts as true in a simulated world, and what its recording can show at all."""

from pathlib import Path

import numpy as np
import pytest

from support.worlds.judging import last_moment_s
from support.worlds.simulate import WorldFiles
from support.worlds.stored import FOLDER
from support.worlds.truths.crossing_truths import pedestrian_facts
from support.worlds.truths.passing_truths import near_side_facts
from support.worlds.truths.priority_truths import oncoming_facts, roundabout_facts
from support.worlds.world_state import WorldState


def _zebra(folder, walker, faces=270):
    """A world on the stored zebra's roads: one drives over its crossing while somebody walks.

    ``faces``: the angle of who drives, 270 for straight on. ``walker``: time (s) -> its edge, x and
    y of its front (m), angle; it is seen at these times alone.
    """
    files = WorldFiles(Path(folder))
    files.net.write_bytes((FOLDER / "zebra.net.xml").read_bytes())
    moments = []
    for step in range(80):
        time, x = step / 10, 150 - step
        lane, pos = _lane(x)
        place = f'x="{x}" y="1.6" angle="{faces}" pos="{pos}" lane="{lane}"'
        bodies = [f'<vehicle id="car" {place} type="lawful" speed="10"/>']
        if time in walker:
            edge, x, y, angle = walker[time]
            place = f'x="{x}" y="{y}" angle="{angle}" pos="0" edge="{edge}"'
            bodies.append(f'<person id="walker" {place} type="walker" speed="1.3"/>')
        moments.append(f'<timestep time="{time}">{"".join(bodies)}</timestep>')
    files.data.write_text(f"<fcd-export>{''.join(moments)}</fcd-export>", encoding="utf-8")
    return files


def _lane(x):
    if x > 115:
        return "n2_n1_1", 224 - x
    return (":n1_0_0", 115 - x) if x > 111 else ("n1_n0_1", 111 - x)


def _pavement(y, angle=107):
    return {step / 10: (":n1_w0", 112.0, y, angle) for step in range(20, 45)}


@pytest.mark.parametrize(
    ("walker", "sure"),
    [
        # The simulator draws it on the road as it rounds the corner, and the world ends
        (_pavement(3.1), [False]),
        (_pavement(3.3), []),
        # It faces the pavement, and its middle is 0.1 m behind
        (_pavement(3.22, 0), [False]),
        ({step / 10: (":n1_c0", 113.0, 3.0, 107) for step in range(10, 45)}, [True]),
    ],
    ids=["drawn on the road", "on the pavement", "its middle on the road", "on the crossing"],
)
def test_who_is_drawn_on_a_crossing_is_not_sure_to_be_on_it(walker, sure, tmp_path):
    world = WorldState(_zebra(tmp_path, walker), 0.1)
    assert [fact.sure for fact in pedestrian_facts(world)] == sure


@pytest.mark.parametrize(("faces", "sure"), [(270, []), (250, [False])])
def test_a_corner_of_who_is_askew_reaches_a_crossing_before_its_front(faces, sure, tmp_path):
    """The front's middle is at the crossing's edge at 3.5 s; somebody is drawn on it just then."""
    walker = {3.5: _pavement(3.1)[3.5]}
    world = WorldState(_zebra(tmp_path, walker, faces), 0.1)
    assert [fact.sure for fact in pedestrian_facts(world)] == sure


def _roundabout(folder, ends_s, stands_m=None, comes=((0, 3, 3.5, 4), (-14, 0, 2.4, 3.3))):
    """A world on the stored roundabout's roads: one drives in, one comes on the ring, and stops.

    The first is out of the other one's way at 3.4 s, which enters the junction at 3 s, brakes from
    3.5 s on, and stands from 4 s on, 2 m before it would be in the first one's. With ``stands_m``
    the first one stands so far before its line from 0.4 s on, until it enters at 1 s. ``comes``:
    times (s) and places (m) of the one on the ring.
    """
    files = WorldFiles(Path(folder))
    files.net.write_bytes((FOLDER / "roundabout.net.xml").read_bytes())
    times = np.arange(0, ends_s + 0.05, 0.1)
    on_ring = np.interp(times, *comes)
    enters = 7 * times - 7
    if stands_m is not None:
        enters[4:10] = -stands_m
    rows = {"drives in": (enters, ("w_rw_0", 89.3), (":rw_2_0", 7.83))}
    rows["on the ring"] = (on_ring, ("rn_rw_0", 14.91), (":rw_1_0", 12.04))
    rows = {name: (*row, ("rw_rs_0", 100.0)) for name, row in rows.items()}
    _write(files, times, rows)
    return files


def _write(files, times, rows, heading=0):
    """Name -> places (m) at the times, and lanes with their lengths, of one at x = y = 0."""
    moments = []
    for k, time in enumerate(times):
        bodies = []
        for name, (places, *lanes) in rows.items():
            lane, pos = _on(places[k], lanes)
            speed = np.gradient(places, times)[k]
            where = f'x="0" y="0" angle="{heading}" speed="{speed}" pos="{pos}" lane="{lane}"'
            bodies.append(f'<vehicle id="{name}" {where} type="lawful"/>')
        moments.append(f'<timestep time="{time:.1f}">{"".join(bodies)}</timestep>')
    files.data.write_text(f"<fcd-export>{''.join(moments)}</fcd-export>", encoding="utf-8")


@pytest.mark.parametrize(("stands_m", "begins"), [(None, 1.0), (0.05, 0.4), (0.2, 1.0)])
def test_who_stands_at_the_line_may_have_entered_the_junction(stands_m, begins, tmp_path):
    """At 1 s its front is at the line, and at 1.1 s beyond it."""
    (fact,) = roundabout_facts(WorldState(_roundabout(tmp_path, 5.0, stands_m), 0.1))
    assert (fact.begin, fact.end) == pytest.approx((begins, 1.1))


def _on(place, lanes):
    """The lane on which somebody is, and how far along it, so far (m) beyond the first one."""
    (first, length), *beyond = lanes
    place += length
    if place <= length or not beyond:
        return first, place
    return _on(place - length - beyond[0][1], beyond)


@pytest.mark.parametrize(
    ("ends_s", "sure"),
    # It has not braked yet; it has, for one or another; for whom ego has left long ago
    [(3.2, []), (5.0, [False]), (8.0, [])],
)
def test_who_stops_for_whom_before_the_recording_ends_is_not_sure(ends_s, sure, tmp_path):
    world = WorldState(_roundabout(tmp_path, ends_s), 0.1)
    assert [fact.sure for fact in roundabout_facts(world)] == sure


@pytest.mark.parametrize(
    ("lane", "starts"),
    [("n2_n1_1", ["n2_n1_1"]), ("n2_n1_2", ["n2_n1_1"]), ("n1_n2_1", [])],
    ids=["its own", "beside it", "of another road"],
)
def test_who_changes_lanes_at_the_line_drives_on_over_the_junction(lane, starts, tmp_path):
    files = _zebra(tmp_path, {})
    own = '<lane id="n2_n1_1"'
    beside = '<lane id="n2_n1_2" index="2" speed="13.89" length="109" shape="224,4.8 115,4.8"/>'
    for file, old, new in (files.net, own, beside + own), (files.data, "n2_n1_1", lane):
        file.write_text(file.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    assert [one.link.start for one in WorldState(files, 0.1).crossings] == starts


@pytest.mark.parametrize(("enters_s", "sure"), [(0.9, [True]), (1.4, [False])])
def test_where_all_have_to_stop_who_enters_first_need_not_wait(enters_s, sure, tmp_path):
    """One turns left and enters at 1 s, one comes towards it; neither stops."""
    files = WorldFiles(tmp_path)
    files.net.write_bytes((FOLDER / "all_way_stop.net.xml").read_bytes())
    times = np.arange(0, 6.05, 0.1)
    turn = [("A1A0_0", 90.6), (":A0_2_0", 14.19), ("A0B0_0", 90.6)]
    ahead = [("bottom0A0_0", 97.8), (":A0_7_0", 14.4), ("A0A1_0", 90.6)]
    _write(
        files, times, {"turns": (7 * times - 7, *turn), "comes": (7 * (times - enters_s), *ahead)}
    )
    facts = oncoming_facts(WorldState(files, 0.1))
    assert [fact.sure for fact in facts if fact.vehicle == "turns"] == sure


@pytest.mark.parametrize(("fastest_mps", "sure"), [(5.0, []), (7.0, [False])])
def test_who_brakes_after_it_sped_up_may_have_been_made_to(fastest_mps, sure, tmp_path):
    """It gets to the first one's way at 5.4 s, two seconds after that one has left."""
    speeds, times = (5.0, fastest_mps, 5.0), (0, 1.5, 3, 6)
    places = 5.3 + 3 - np.array([np.dot(speeds[k:], np.diff(times)[k:]) for k in range(4)])
    world = WorldState(_roundabout(tmp_path, 6.0, comes=(times, places)), 0.1)
    assert [fact.sure for fact in roundabout_facts(world)] == sure


@pytest.mark.parametrize(
    ("ends_m", "sure"),
    # Bodies are 4.5 m long: level; in front but for a hair; in front, and a while longer
    [(3.9, set()), (4.4, {False}), (4.6, {False, True})],
)
def test_who_is_all_but_past_when_the_world_ends(ends_m, sure, tmp_path):
    files = WorldFiles(tmp_path)
    files.net.write_bytes((FOLDER / "motorway.net.xml").read_bytes())
    times = np.arange(0, 6.05, 0.1)
    other = 100 + 20 * times
    own = other + np.linspace(-20, ends_m, len(times))
    rows = {"passes": (own, ("a_b_0", 0.0)), "is passed": (other, ("a_b_2", 0.0))}
    _write(files, times, rows, heading=89.3)
    facts = near_side_facts(WorldState(files, 0.1))
    assert {(fact.vehicle, fact.sure) for fact in facts} == {("passes", one) for one in sure}


@pytest.mark.parametrize("book", ["us", "us-ca", "us-tx", "au", "au-nsw"])
def test_where_lanes_let_one_pass_on_the_near_side_nobody_violates(book, tmp_path):
    files = WorldFiles(tmp_path)
    files.net.write_bytes((FOLDER / "motorway.net.xml").read_bytes())
    times = np.arange(0, 6.05, 0.1)
    other = 100 + 20 * times
    rows = {
        "passes": (other - 20 + 7 * times, ("a_b_0", 0.0)),
        "is passed": (other, ("a_b_2", 0.0)),
    }
    _write(files, times, rows, heading=89.3)
    in_germany = near_side_facts(WorldState(files, 0.1, "de"))
    assert {one.vehicle for one in in_germany if one.sure} == {"passes"}
    assert list(near_side_facts(WorldState(files, 0.1, book))) == []


def test_a_recording_ends_with_its_last_state(tmp_path):
    """In every second state alone nobody finds what happens in the last one between."""
    assert last_moment_s(_zebra(tmp_path, {}).data) == 7.9
