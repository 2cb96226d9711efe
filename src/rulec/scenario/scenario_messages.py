"""Messages about scenarios."""

from __future__ import annotations

from rulec.diagnostics.code import Code

UNKNOWN_SCENARIO = Code(
    "R0601",
    title="a scenario is unknown",
    why="A scenario is one of those built in (`rulec list scenarios`), or a file, given by its "
    "path.",
    bad="rulec maneuvers s9 -r esterle2019",
    good="rulec maneuvers s1 -r esterle2019",
    kind="command",
)

_ROAD = "[road]\ns = [0.0, 100.0]\nlanes = [-1.75, 1.75]\n\n"
_GOOD = f"{_ROAD}[ego]\ns = 10.0\nd = 0.0\n"
NOT_A_SCENARIO = Code(
    "R0602",
    title="a scenario file is too large or not TOML",
    why="Scenario files are TOML of at most 4 MB. The message says what the TOML parser found at "
    "the underlined place.",
    bad=_GOOD.replace("[0.0, 100.0]", "0.0 to 100.0"),
    good=_GOOD,
    kind="scenario",
)

MISSING_OR_UNKNOWN_FIELD = Code(
    "R0603",
    title="a field of a scenario is missing or unknown",
    why="Road and ego are required, with their fields. Unknown fields are errors, because a "
    "misspelt field would otherwise be ignored.",
    bad=_GOOD.replace("d = 0.0", "D = 0.0"),
    good=_GOOD,
    kind="scenario",
)

UNFITTING_FIELD = Code(
    "R0604",
    title="a field's value in a scenario is invalid",
    why="Numbers are finite and in metres, seconds, m/s, m/s² and degrees, written without a "
    "unit; the message says what is expected.",
    bad=_GOOD.replace("s = 10.0", 's = "10 m"'),
    good=_GOOD,
    kind="scenario",
)

INCONSISTENT_SCENARIO = Code(
    "R0605",
    title="parts of a scenario contradict each other",
    why="Each part is valid by itself, but together they are not: for instance a place beside the "
    "road, an id given twice, or times that run backwards.",
    bad=_GOOD.replace("s = 10.0", "s = 110.0"),
    good=_GOOD,
    kind="scenario",
)

UNFITTING_BOUNDS = Code(
    "R0770",
    title="bounds of ego's motion are invalid",
    why="Bounds are `none`, a type of vehicle, or numbers by name in m/s, m/s² and m: `speed`, "
    "`acceleration`, `braking`, `lateral_speed`, `lateral_acceleration`, `length` and `width`.",
    bad=f'{_GOOD}speed = 8.0\nbounds = "spaceship"\n',
    good=f'{_GOOD}speed = 8.0\nbounds = "truck,braking=6"\n',
    kind="scenario",
)

UNFITTING_HORIZON = Code(
    "R0606",
    title="horizon and step do not fit together",
    why="The horizon is divided into steps, so it must be a whole multiple of the step, and both "
    "must be greater than 0.",
    bad=f"horizon_s = 4.0\nstep_s = 0.3\n\n{_GOOD}",
    good=f"horizon_s = 4.2\nstep_s = 0.3\n\n{_GOOD}",
    kind="scenario",
)
