"""A small rulebook and recordings for tests of fleets: who is too fast, too near, or neither."""

from functools import cache
from pathlib import Path

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
