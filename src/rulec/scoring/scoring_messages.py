"""Messages about scoring futures."""

from __future__ import annotations

from rulec.diagnostics.code import Code

_WORLD = """\
import rulec

road = rulec.build_lanelet("east", [(0, 0), (400, 0)])
ego = rulec.build_participant("ego", "car", [0, 0.5], [10, 15], [0, 0], step_s=0.5)
world = rulec.TrafficWorld(rulec.build_recording([road], [ego], step_s=0.5), "ego")
"""

BAD_CANDIDATES = Code(
    "R0780",
    title="candidates to be scored are invalid",
    why="Candidates are an array with three axes: candidate, state, and x, y (m), heading (rad) "
    "and speed (m/s) of ego's centre, with a state for each step of the world after the present. "
    "The past has the same four columns, with a row for each state; the last one is the present. "
    "Past and candidate together have at least two states, since a single one is not a drive. "
    "All numbers are finite.",
    bad=f'{_WORLD}rulec.score([[20, 0, 0, 10], [25, 0, 0, 10]], world, "de")\n',
    good=f'{_WORLD}rulec.score([[[20, 0, 0, 10], [25, 0, 0, 10]]], world, "de")\n',
    kind="python",
)

NO_TRAJECTORY = Code(
    "R0781",
    title="maneuvers have no trajectory to be scored",
    why="A maneuver has a trajectory if ego's motion has bounds and a trajectory was found along "
    "it, as for those that `cheapest` returns. To be scored it also needs the world in which ego "
    "drives it: a recording, whose others move as recorded. Built-in scenarios and those in TOML "
    "have none.",
    bad="""\
import rulec

found = rulec.find_maneuvers("s1", "esterle2019")
rulec.score_trajectories(found, found.cheapest(1))
""",
    good="""\
import rulec

road = rulec.build_lanelet("east", [(0, 0), (400, 0)])
ego = rulec.build_participant("ego", "car", [0, 0.5], [10, 15], [0, 0], step_s=0.5)
times, places = [0, 0.5, 1, 1.5, 2], [60, 65, 70, 75, 80]
ahead = rulec.build_participant("ahead", "car", times, places, [0] * 5, step_s=0.5)
live = rulec.build_recording([road], [ego, ahead], step_s=0.5)
scene = rulec.load_scenario(live, rulec.Choice(ego="ego", at_s=0.5))
found = rulec.find_maneuvers(scene, "de")
rulec.score_trajectories(found, found.cheapest(1, perhaps=True))
""",
    kind="python",
)
