"""Scenarios for property tests: anything on or near a short road, moving in any way."""

from dataclasses import replace
from fractions import Fraction

from hypothesis import strategies as st

from rulec.scenario import (
    Alternative,
    Box,
    ConstantAcceleration,
    Ego,
    Footprints,
    MissingLane,
    Obstacle,
    Road,
    Scenario,
    Stretch,
    Trajectory,
)

LENGTH = 40.0


def numbers(low: float, high: float):
    """Half of them on a coarse grid, so that borders coincide; the others anywhere."""
    grid = st.integers(int(low * 2), int(high * 2)).map(lambda n: n / 2)
    return grid | st.floats(low, high, allow_nan=False).map(lambda x: round(x, 2))


@st.composite
def roads(draw):
    widths = draw(st.lists(st.sampled_from([2.0, 3.0, 3.5]), min_size=1, max_size=4))
    lanes = [-2.0]
    for width in widths:
        lanes.append(lanes[-1] + width)
    surfaces, missing = (), ()
    if draw(st.booleans()):
        at = draw(numbers(2, 34))
        surfaces = (Stretch("crossing", (at, at + 4)),)
    if len(widths) > 1 and draw(st.booleans()):
        at = draw(numbers(0, 30))
        lane = draw(st.integers(1, len(widths)))
        missing = (MissingLane(lane, (at, draw(numbers(at + 1, 50)))),)
    return Road((0.0, LENGTH), tuple(lanes), surfaces, missing)


@st.composite
def motions(draw):
    if draw(st.integers(0, 3)) == 0:
        times = sorted(
            draw(st.sets(st.sampled_from([0.0, 0.5, 0.7, 1.0, 1.5, 2.2, 3.0]), min_size=2))
        )
        return Trajectory(tuple((t, draw(numbers(-5, 45)), draw(numbers(-4, 12))) for t in times))
    sideways = draw(st.just(0.0) | numbers(-3, 3))
    d = draw(numbers(-4, 12))
    until = None if sideways == 0 or draw(st.booleans()) else d + sideways
    return ConstantAcceleration(
        draw(numbers(-5, 45)),
        d,
        draw(numbers(-15, 15)),
        draw(st.just(0.0) | numbers(-8, 8)),
        sideways,
        until,
    )


@st.composite
def footprints(draw):
    """As recordings have them: bounds that come and go, and change as a vehicle turns."""
    times = sorted(draw(st.sets(st.sampled_from([0.0, 0.4, 0.5, 1.0, 1.6, 2.0]), min_size=1)))
    boxes = []
    for _ in times:
        s, d = draw(numbers(-5, 40)), draw(numbers(-4, 10))
        box = Box(s, s + draw(numbers(1, 5)), d, d + draw(numbers(1, 3)))
        boxes.append(None if draw(st.integers(0, 4)) == 0 else box)
    return Footprints(tuple(times), tuple(boxes))


@st.composite
def obstacles(draw, name: str):
    kind = draw(st.sampled_from(["vehicle", "vehicle", "cyclist", "pedestrian"]))
    walking = draw(st.sampled_from([0, 45, 90, 180, -90, -135])) if kind == "pedestrian" else None
    return Obstacle(
        name,
        kind,
        draw(st.sampled_from([0.5, 2.0, 5.0])),
        draw(st.sampled_from([0.5, 2.0, 4.0])),
        draw(motions() | footprints()),
        walking,
    )


@st.composite
def scenarios(draw, most: int = 4):
    count = draw(st.integers(0, most))
    road = draw(roads())
    ego = Ego(draw(numbers(0, LENGTH)), draw(numbers(road.lanes[0], road.lanes[-1])))
    width = draw(st.sampled_from([0.0, 0.6, 1.8]))
    ego = Ego(ego.s, min(max(ego.d, road.lanes[0]), road.lanes[-1]), 0.0, width)
    goal = Box(20.0, 40.0, -2.0, 1.0) if draw(st.booleans()) else None
    return Scenario(
        "random",
        road,
        ego,
        tuple(draw(obstacles(f"o{i}")) for i in range(count)),
        {"CONGESTED": draw(st.booleans())},
        goal,
        horizon_s=draw(st.sampled_from([1.0, 2.0])),
        step_s=draw(st.sampled_from([0.5, 1.0])),
    )


@st.composite
def with_predictions(draw, most: int = 3):
    """A scenario whose obstacles may do one thing or another."""
    scenario = draw(scenarios(most))
    several = []
    for one in scenario.obstacles:
        motions_of = [one.motion, *draw(st.lists(motions() | footprints(), max_size=2))]
        parts = [draw(st.integers(1, 5)) for _ in motions_of]
        parts[0] = max(parts)
        whole = Fraction(1, sum(parts))
        (_, *rest) = zip(motions_of, parts, strict=True)
        several.append(
            replace(
                one,
                weight=parts[0] * whole,
                alternatives=tuple(Alternative(part * whole, motion) for motion, part in rest),
            )
        )
    return replace(scenario, obstacles=tuple(several))
