"""Several predictions per obstacle, likeliest first.

Cells avoid what is occupied if everybody does what is likeliest. Each other prediction cuts the
road too, as an obstacle of its own would, but what it occupies is road: there ego is hit by it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from rulec.partition.cells.regions import OCCUPIED, Region
from rulec.scenario import Obstacle, Scenario

HIT = ord("x")
"""In place of a relation to an obstacle as a less likely prediction has it: that is here."""


@dataclass(frozen=True, slots=True)
class Predicted:
    """Obstacle by one prediction; ``number`` 0 is the likeliest.

    ``obstacle`` moves by that prediction. Its ``id`` is like that of no other; ``of`` is the id in
    the scenario.
    """

    obstacle: Obstacle
    of: str
    number: int


def predicted(scenario: Scenario) -> tuple[Predicted, ...]:
    """Obstacles by their likeliest predictions, then by each further one."""
    predicteds = [Predicted(obstacle, obstacle.id, 0) for obstacle in scenario.obstacles]
    taken = {obstacle.id for obstacle in scenario.obstacles}
    for obstacle in scenario.obstacles:
        for number, alternative in enumerate(obstacle.alternatives, start=1):
            name = f"{obstacle.id}~{number}"
            while name in taken:
                name += "~"
            taken.add(name)
            moving = replace(
                obstacle,
                id=name,
                motion=alternative.motion,
                weight=alternative.weight,
                alternatives=(),
            )
            predicteds.append(Predicted(moving, obstacle.id, number))
    return tuple(predicteds)


def entered(region: Region) -> Region:
    """Region of a less likely prediction, which may be entered."""
    return replace(region, table=region.table.replace(bytes([OCCUPIED]), bytes([HIT])))
