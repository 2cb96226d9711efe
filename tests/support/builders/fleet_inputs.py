"""A small rulebook and recordings for tests of fleets: who is too fast, too near, or neither."""

from functools import cache
from pathlib import Path

import pyarrow

import rulec

STEP_S = 0.1
RULES = """rulebook fleet_rules
use road

hard rule slowly {
  cite "1"
  require always speed <= 50 km/h
}

hard rule distance (v: vehicle) {
  require always (behind(v) and same_lane(v) implies safe_gap(v))
}

soft rule lets_go (v: vehicle) {
  require always (behind(v) implies eventually[<= 5 s] not behind(v))
}

hard rule no_lights (b: vehicle) {
  require always (beside(b) and warning_lights(b) implies speed <= 10 km/h)
}

hard rule never_so_fast (v: vehicle) {
  require always (eventually[<= 5 s] not behind(v) implies speed <= 500 km/h)
}
"""

LANES = "lane,x,y\n" + "".join(
    f"{lane},{x},{y}\n" for lane, y in (("r", 0), ("l", 3.5)) for x in (0, 400)
)


@cache
def fleet_rules():
    """The rulebook, compiled for the step of the recordings."""
    return rulec.compile_rulebook(rulec.parse_rulebook(RULES), step_s=STEP_S)


@cache
def fleet_file(folder: Path):
    """The same as a compiled file."""
    return rulec.write_compiled(fleet_rules(), folder)[-1]


def track_rows(number):
    """Rows (track, t, x, y) of a recording: who follows, and who leads or is on the left.

    Of every three the first is too fast, the second too near, the third neither.
    """
    speed = (20.0, 8.0, 8.0)[number % 3]
    gap = (60.0, 6.0, 60.0)[number % 3]
    for k in range(12 + number % 5):
        t = k * STEP_S
        yield "a", round(t, 3), 10.0 + speed * t, 0.0
        yield "b", round(t, 3), 10.0 + gap + speed * t, 0.0
        yield "c", round(t, 3), 30.0 + 9.0 * t, 3.5


def tracks(numbers):
    """Columns of a table of tracks with these recordings, called r000 and so on."""
    rows = [(f"r{number:03d}", *row) for number in numbers for row in track_rows(number)]
    names = ("recording", "track", "t", "x", "y")
    return dict(zip(names, map(list, zip(*rows, strict=True)), strict=True))


def lanes(folder: Path):
    """The path of the map of these recordings."""
    path = folder / "fleet.lanes.csv"
    path.write_text(LANES, encoding="utf-8")
    return path


def trace_table(numbers):
    """A table of traces of these drives, called t000 and so on, in the words of the rules.

    Of every three the first is too fast from its third state on, the second too near in the last
    one, and of the third it is open whether it lets go.
    """
    rows = []
    for number in numbers:
        states = 6 + number % 4
        for step in range(states):
            fast = 80.0 if number % 3 == 0 and step >= 2 else 40.0
            near = number % 3 == 1 and step == states - 1
            about = {"trace": f"t{number:03d}", "step": step, "step_s": STEP_S, "ends": "cut"}
            rows.append({**about, "speed": fast})
            values = {
                "object": "v",
                "type": "vehicle",
                "lateral": "same_lane",
                "safe_gap": not near,
            }
            rows.append({**about, **values, "station": "behind"})
    names = list(dict.fromkeys(name for row in rows for name in row))
    return pyarrow.table({name: [row.get(name) for row in rows] for name in names})
