"""Several predictions per obstacle: what is free, and what less likely predictions say of it.

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
    """An obstacle as one prediction has it: its ``number``, 0 being the likeliest.

    ``obstacle`` moves by that prediction. Its ``id`` is like that of no other; ``of`` is the id in
    the scenario.
    """

    obstacle: Obstacle
    of: str
    number: int


def predicted(scenario: Scenario) -> tuple[Predicted, ...]:
    """All obstacles as it is likeliest, in their order, then as each other prediction has them."""
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
    """The region of a less likely prediction: what it occupies can be entered."""
    return replace(region, table=region.table.replace(bytes([OCCUPIED]), bytes([HIT])))
