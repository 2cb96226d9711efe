"""Recordings as no simulator writes them: participants missing in any state, holes, odd ids.

Each is a small world, or a street of formulas, in which some of this has happened. As data, and
as files of several formats, whose optional fields may be left out.
"""

import pickle
from dataclasses import replace

import numpy as np

from rulec.recordings.recording import OBSTACLE_TYPES, Weather
from rulec.recordings.track import Track, TrackOutlines, TrackStates, outlines_on_track
from support.builders import sumo_files as sumo
from support.generators.small_worlds import small_world

KINDS = [*OBSTACLE_TYPES]
IDS = ("", "0", "-1", "1_2", "1#2", "2", "p_2", "é 道", "a,b", '"', "x" * 300, "None", "nan")
STEPS = (0.5, 0.5, 0.5, 0.1, 1.0, 1 / 30, 7.0)


def odd_recording(pick):
    """A recording in which anything may be missing."""
    recording = small_world(pick)
    for change in pick.sample(_OF_BODIES, pick.randrange(1, 4)):
        chosen = [pick.random() < 0.6 for _ in recording.participants]
        bodies = [
            change(body, pick) if own else body
            for own, body in zip(chosen, recording.participants, strict=True)
        ]
        if len({body.id for body in bodies}) == len(bodies):  # two of one id are refused
            recording = replace(recording, participants=tuple(bodies))
    for change in pick.sample(_OF_RECORDINGS, pick.choice((0, 0, 1, 1, 2))):
        recording = change(recording, pick)
    return replace(recording, step_s=pick.choice(STEPS))


def _on(body, steps, rows):
    """The participant on another track; as plain dictionaries where that has no order."""
    old = outlines_on_track(body).track
    track = Track(steps, rows, old.length, old.width, old.shift)
    lamps = {step: lit for step, lit in body.lamps.items() if step in set(steps.tolist())}
    return replace(body, states=TrackStates(track), outlines=TrackOutlines(track), lamps=lamps)


def _rows(body):
    track = outlines_on_track(body).track
    return track.steps.copy(), track.rows.copy()


def _some(body, pick, kept):
    steps, rows = _rows(body)
    chosen = np.flatnonzero(kept(steps))
    if not len(chosen):
        chosen = np.array([pick.randrange(len(steps))])
    return _on(body, steps[chosen], rows[chosen])


def _with_drops(body, pick):
    return _some(body, pick, lambda steps: [pick.random() < 0.7 for _ in steps])


def _with_a_hole(body, pick):
    begin, lasts = pick.randrange(40), pick.randrange(1, 12)
    return _some(body, pick, lambda steps: (steps < begin) | (steps >= begin + lasts))


def _in_one_state(body, pick):
    at = pick.choice((0, -1, pick.randrange(40)))
    return _some(body, pick, lambda steps: steps == steps[at % len(steps)])


def _from_the_end(body, pick):
    last = pick.choice((1, 1, 2, 3))
    return _some(body, pick, lambda steps: steps > steps[-1] - last)


def _from_the_beginning(body, pick):
    count = pick.choice((1, 2, 3))
    return _some(body, pick, lambda steps: steps < steps[0] + count)


def _later(body, pick):
    by = pick.choice((-100, -3, 1, 5, 30, 1000))
    steps, rows = _rows(body)
    return _on(body, steps + by, rows)


def _stretched(body, _):
    steps, rows = _rows(body)
    return _on(body, steps[0] + 2 * (steps - steps[0]), rows)


def _at_one_place(body, pick):
    steps, rows = _rows(body)
    rows[:, :2] = rows[pick.randrange(len(rows)), :2]
    rows[:, 3:] = pick.choice((0.0, 5.0))
    return _on(body, steps, rows)


def _at_the_origin(body, pick):
    """Where others are, too."""
    steps, rows = _rows(body)
    rows[:, :2] -= rows[0, :2] * pick.choice((1.0, 1.0, 0.5))
    return _on(body, steps, rows)


def _jumps(body, pick):
    steps, rows = _rows(body)
    rows[pick.randrange(len(rows)) :, :2] += pick.choice((3.0, 40.0, 1e4, 9e7))
    return _on(body, steps, rows)


def _turns_round(body, pick):
    steps, rows = _rows(body)
    rows[:, 2] = [pick.uniform(-9, 9) for _ in steps]
    return _on(body, steps, rows)


def _of_another_size(body, pick):
    track = outlines_on_track(body).track
    sizes = pick.choice(((0.01, 0.01), (0.3, 9.0), (18.0, 2.5), (200.0, 3.0)))
    other = Track(track.steps, track.rows, *sizes, pick.choice((0.0, 1.4)))
    return replace(body, states=TrackStates(other), outlines=TrackOutlines(other))


def _of_another_kind(body, pick):
    return replace(body, type=pick.choice(KINDS))


def _standing(body, pick):
    one = _in_one_state(body, pick)
    return replace(one, standing=True, type=pick.choice((body.type, "constructionZone", "car")))


def _as_dictionaries(body, pick):
    """Not on one track; outlines may have other corners, and states may be missing."""
    states, outlines = dict(body.states), dict(body.outlines)
    for step in list(states):
        match pick.randrange(8):
            case 0:
                outlines[step] = outlines[step][[0, 2, 4]]
            case 1 if not body.standing:
                del states[step]
    return body if not states else replace(body, states=states, outlines=outlines)


def _renamed(body, pick):
    return replace(body, id=pick.choice(IDS))


def _with_lamps(body, pick):
    steps = [*body.states, 0, 10**6]
    lamps = {pick.choice(steps): frozenset({"left_indicator", "horn"}) for _ in range(4)}
    return replace(body, lamps=lamps, resumes=pick.choice((None, 0, -5)))


_LASTLY = (_standing, _as_dictionaries)
_OF_TRACKS = [
    *(_with_drops, _with_a_hole, _in_one_state, _from_the_end, _from_the_beginning, _later),
    *(_stretched, _at_one_place, _at_the_origin, _jumps, _turns_round, _of_another_size),
]


def _several(body, pick):
    if outlines_on_track(body) is None:
        return body
    for change in pick.sample(_OF_TRACKS, 3):
        body = change(body, pick)
    return pick.choice(_LASTLY)(body, pick) if pick.random() < 0.2 else body


_OF_BODIES = [_several, _of_another_kind, _renamed, _with_lamps, _several]


def _without_lanes(recording, pick):
    return replace(recording, lanelets={})


def _with_fewer_lanes(recording, pick):
    """References to lanelets that are not there are dropped, as readers do."""
    kept = {key: lane for key, lane in recording.lanelets.items() if pick.random() < 0.7}

    def there(one):
        groups = {
            name: type(of)(x for x in of if x in kept)
            for name in ("successors", "predecessors")
            if (of := getattr(one, name)) is not None
        }
        sides = {
            side: of if (of := getattr(one, side)) in kept else None
            for side in ("left_of", "right_of")
        }
        return replace(one, **groups, **sides)

    return replace(recording, lanelets={key: there(lane) for key, lane in kept.items()})


def _only_crossings(recording, pick):
    lanes = {key: lane for key, lane in recording.lanelets.items() if "crosswalk" in lane.types}
    return replace(recording, lanelets=lanes)


def _with_short_lanes(recording, pick):
    """Lines of almost no length."""

    def short(one):
        if pick.random() < 0.7:
            return one
        part = pick.choice((1e-9, 1e-3, 0.1))
        lines = {
            name: (line := getattr(one, name))[0] + part * (line - line[0])
            for name in ("left", "right", "centre")
        }
        return replace(one, **lines)

    return replace(recording, lanelets={k: short(x) for k, x in recording.lanelets.items()})


def _that_says_less(recording, pick):
    return replace(
        recording,
        side=pick.choice(("left", "right", None)),
        complete=frozenset(),
        weather=Weather(wet=pick.choice((None, True)), night=pick.choice((None, True, False))),
        country=pick.choice(("", "DEU", "ZAM")),
        ego=pick.choice(("", "1", "nobody")),
    )


def _of_fewer(recording, pick):
    count = pick.randrange(len(recording.participants) + 1)
    return replace(recording, participants=recording.participants[:count])


_OF_RECORDINGS = [
    *(_without_lanes, _with_fewer_lanes, _only_crossings, _with_short_lanes),
    *(_that_says_less, _of_fewer),
]


# As files ------------------------------------------------------------------------------------


def table(folder, recording, pick):
    """Tracks and lanes as tables, some of whose columns and cells are left out."""
    columns = ["type", "heading", "speed", "length", "width", "brake_light"]
    columns = pick.sample(columns, pick.randrange(len(columns) + 1))
    lines = [",".join(["track", "t", "x", "y", *columns])]
    for body in recording.participants:
        for step, state in body.states.items():
            told = {
                "type": body.type,
                "heading": state.heading,
                "speed": abs(state.speed),
                "length": 4.5,
                "width": 1.8,
                "brake_light": int("brake_light" in body.lamps.get(step, ())),
            }
            cells = [told[name] if pick.random() < 0.98 else "" for name in columns]
            name = body.id.replace(",", "").replace('"', "")
            own = [name, round(step * recording.step_s, 6), state.x, state.y, *cells]
            lines.append(",".join(map(str, own)))
    if pick.random() < 0.3:
        lines[1:] = pick.sample(lines[1:], len(lines) - 1)
    lanes = ["lane,x,y,type,successors,junction"]
    for lane in recording.lanelets.values():
        for k, (x, y) in enumerate(lane.centre.tolist()):
            more = ("urban", " ".join(lane.successors), lane.junction) if not k else ("", "", "")
            lanes.append(",".join([lane.id, f"{x:g}", f"{y:g}", *more]))
    (folder / "lanes.csv").write_text("\n".join(lanes) + "\n")
    file = folder / "cars.csv"
    file.write_text("\n".join(lines) + "\n")
    return file


def scenarionet(folder, recording, pick):
    """ScenarioNet's dictionary, with holes, late begins, and cones."""
    steps = sorted({step for body in recording.participants for step in body.states}) or [0]
    count = min(steps[-1] - steps[0] + 1, 200)
    tracks = {}
    for body in recording.participants:
        state = {
            "position": np.zeros((count, 3)),
            "heading": np.zeros(count),
            "velocity": np.zeros((count, 2)),
            "length": np.full(count, 4.5),
            "width": np.full(count, 1.8),
            "valid": np.zeros(count, dtype=bool),
        }
        for step, own in body.states.items():
            at = step - steps[0]
            if at < count:
                ahead = np.array([np.cos(own.heading), np.sin(own.heading)])
                state["position"][at, :2] = own.x, own.y
                state["heading"][at] = own.heading
                state["velocity"][at] = own.speed * ahead
                state["valid"][at] = True
        kind = pick.choice(("VEHICLE", "VEHICLE", "PEDESTRIAN", "CYCLIST", "TRAFFIC_CONE", "?"))
        tracks[body.id] = {"type": kind, "state": state, "metadata": {"type": kind}}
    features = {
        lane.id: {
            "type": "LANE_SURFACE_STREET",
            "polyline": np.column_stack((lane.centre, np.zeros(len(lane.centre)))),
            "entry_lanes": list(lane.predecessors),
            "exit_lanes": list(lane.successors),
            "left_neighbor": [],
            "right_neighbor": [],
        }
        for lane in recording.lanelets.values()
    }
    for feature in features.values():
        for key in [key for key in feature if key not in {"type", "polyline"}]:
            if pick.random() < 0.1:
                del feature[key]
    metadata = {
        "ts": np.arange(count) * recording.step_s,
        "coordinate": "right-handed",
        "dataset": pick.choice(("nuscenes", "waymo", "other")),
    }
    if pick.random() < 0.7 and tracks:
        metadata["sdc_id"] = pick.choice(list(tracks))
    value = {
        "id": "odd",
        "version": "1",
        "length": count,
        "tracks": tracks,
        "map_features": features,
        "dynamic_map_states": {},
        "metadata": metadata,
    }
    file = folder / "odd.pkl"
    file.write_bytes(pickle.dumps(value, 4))
    return file


def floating_car_data(folder, recording, pick):
    """SUMO's data on its small road, with some attributes of all, or of some, left out."""
    every = ("speed", "type", "lane", "signals", "acceleration")
    gone = {name for name in every if pick.random() < 0.3}
    moments = {}
    for body in recording.participants:
        for step, state in body.states.items():
            own = {
                "angle": round((90 - np.degrees(state.heading)) % 360, 2),
                "kind": pick.choice(("small", "lorry", "none")),
                "lane": "in_1",
                "signals": 8,
                "acceleration": 0.1,
            }
            element = "person" if body.type == "pedestrian" else "vehicle"
            x, y = 100 + state.x % 150, -4.8 + state.y % 5
            text = sumo.body(
                body.id.replace('"', "") or "e", round(x, 2), round(y, 2),
                round(abs(state.speed), 2), element=element, **own,
            )  # fmt: skip
            attributes = [
                part
                for part in text[:-2].split(" ")
                if part.split("=")[0] not in gone or pick.random() < 0.01
            ]
            moments.setdefault(step, []).append(" ".join(attributes) + "/>\n")
    own = [
        sumo.moment(step * recording.step_s, *bodies)
        for step, bodies in sorted(moments.items())
        if step >= 0
    ]
    return sumo.written(folder, sumo.data(*own))


WRITERS = {"table": table, "scenarionet": scenarionet, "sumo": floating_car_data}
