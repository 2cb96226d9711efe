"""The start cell of ego, and the message where there is none."""

from __future__ import annotations

from collections.abc import Mapping

from rulec.diagnostics import RulecError
from rulec.partition.cells.cell_model import Plane
from rulec.partition.cells.cell_plane import plane
from rulec.partition.cells.occupancy import Occupancy, scene
from rulec.partition.cells.regions import ExtentName, PartitionName
from rulec.partition.partition_messages import NO_START_CELL
from rulec.scenario import Scenario
from rulec.scenario.time_grid import MAX_LAYERS, Timing

_FINEST = 64

_TAKEN: Mapping[ExtentName, str] = {
    "lane": "the whole width of its lanes",
    "clearance": "the whole width of its lanes, if it leaves ego no room there",
    "body": "its own width, and half of ego's to either side",
}


def start_cell(
    first: Plane,
    places: Occupancy,
    scenario: Scenario,
    timing: Timing,
    *,
    partition: PartitionName,
    extent: ExtentName,
) -> int:
    """The cell of ego's centre; on a border the one to the left and ahead.

    Raises RulecError R0607 if an obstacle sweeps that place within the first interval.
    """
    s, d = places.s[scenario.ego.s], places.d[scenario.ego.d]
    cells = list(first.cells_at(s, d))
    if cells:
        return cells[-1]
    in_the_way = [
        region
        for region in places.swept[0]
        if region.obstacle < len(scenario.obstacles) and region.extent.covers(s, d)
    ]
    free = places.roadway.free
    if free.d_min == free.d_max:
        raise _no_start(
            f"ego is {scenario.ego.width:g} m wide, and the road is no wider",
            "a road with room for ego, as its extent is `body`",
            "correct ego's `width`, or use the extent `lane`, which ignores it",
        )
    if not in_the_way:
        message = f"ego starts off the road, at s = {s:g}, d = {d:g}"
        raise _no_start(message, "a place on one of the lanes", "move ego, or extend the road")
    blockers = " and ".join(f"`{scenario.obstacles[region.obstacle].id}`" for region in in_the_way)
    verb = "sweeps" if len(in_the_way) == 1 else "sweep"
    step = float(timing.step)
    finer = step_that_leaves_room(scenario, timing, partition, extent, 2)
    remedy = "choose another moment or another ego with --at-time and --ego"
    if scenario.account is None:
        remedy = "move ego along the road, or that obstacle"
    smaller = f"a smaller step does not help here: {remedy}"
    # Rounded to the centimetre, because recorded places carry rounding errors
    at = f"s = {round(s, 2) + 0.0:g}, d = {round(d, 2) + 0.0:g}"
    raise _no_start(
        f"{blockers} {verb} ego's place ({at}) between 0 s and {step:g} s, "
        "so ego has no free cell to start from",
        f"a free place; an obstacle takes {_TAKEN[extent]}",
        f"a step of {float(finer.step):g} s would do" if finer else smaller,
    )


def _no_start(message: str, expected: str, way_out: str) -> RulecError:
    return NO_START_CELL.error(None, message, expected=f"expected {expected}", help=way_out)


def step_that_leaves_room(
    scenario: Scenario,
    timing: Timing,
    partition: PartitionName,
    extent: ExtentName = "lane",
    fraction: int = 1,
) -> Timing | None:
    """The longest step whose first interval leaves ego's place free.

    Tried are the step of ``timing`` divided by ``fraction``, half of that, and so on.
    """
    while fraction <= _FINEST and (timing.layers - 1) * fraction < MAX_LAYERS:
        first = Timing(timing.step / fraction, 1)
        places = scene(scenario, first, partition, extent)
        free = plane(places.roadway, places.swept[0], partition, places.names[0])
        if list(free.cells_at(places.s[scenario.ego.s], places.d[scenario.ego.d])):
            return first
        fraction *= 2
    return None
