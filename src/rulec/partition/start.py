"""The cell from which ego starts, and what to say if there is none."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic, RulecError
from rulec.partition.cells import plane
from rulec.partition.model import Plane
from rulec.partition.occupancy import Scene, scene
from rulec.partition.regions import PartitionName
from rulec.scenario import Scenario
from rulec.scenario.timing import MAX_LAYERS, Timing

_FINEST = 64


def start_cell(
    first: Plane, places: Scene, scenario: Scenario, timing: Timing, partition: PartitionName
) -> int:
    """The cell of the first layer that holds ego's centre at the start.

    On a border, the free cell to the left and ahead.

    Raises:
        RulecError: R0607 if an obstacle sweeps that place within the first interval.
    """
    s, d = places.s[scenario.ego.s], places.d[scenario.ego.d]
    cells = list(first.cells_at(s, d))
    if cells:
        return cells[-1]
    in_the_way = [region for region in places.swept[0] if region.extent.covers(s, d)]
    if not in_the_way:
        raise RulecError(
            Diagnostic(
                "R0607",
                f"ego starts off the road, at s = {s:g}, d = {d:g}",
                expected="expected a place on one of the lanes",
                help="move ego, or extend the road",
            )
        )
    blockers = " and ".join(f"`{scenario.obstacles[region.obstacle].id}`" for region in in_the_way)
    verb = "sweeps" if len(in_the_way) == 1 else "sweep"
    step = float(timing.step)
    finer = step_that_leaves_room(scenario, timing, partition, 2)
    raise RulecError(
        Diagnostic(
            "R0607",
            f"{blockers} {verb} ego's place (s = {s:g}, d = {d:g}) between 0 s and {step:g} s, "
            "so ego has no free cell to start from",
            expected="expected a free place; an obstacle takes the whole width of its lanes",
            help=f"a step of {float(finer.step):g} s would do"
            if finer
            else f"a smaller step does not help here: {_remedy(scenario)}",
        )
    )


def _remedy(scenario: Scenario) -> str:
    if scenario.account is None:
        return "move ego along the road, or that obstacle"
    return "choose another moment or another ego with --at-time and --ego"


def step_that_leaves_room(
    scenario: Scenario, timing: Timing, partition: PartitionName, fraction: int = 1
) -> Timing | None:
    """The longest step with which the first interval leaves ego's place free.

    The step of ``timing`` divided by ``fraction``, or half of that, and so on.
    """
    while fraction <= _FINEST and (timing.layers - 1) * fraction < MAX_LAYERS:
        first = Timing(timing.step / fraction, 1)
        places = scene(scenario, first, partition)
        free = plane(places.roadway, places.swept[0], partition, places.names[0])
        if list(free.cells_at(places.s[scenario.ego.s], places.d[scenario.ego.d])):
            return first
        fraction *= 2
    return None
