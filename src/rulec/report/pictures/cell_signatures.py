"""A cell's signature in a few letters, and what the letters mean."""

from __future__ import annotations

from rulec.partition import Cell, NavigationGraph, PartitionName

MOST_SPELLED = 8
"""With more obstacles a signature is longer than any cell is wide."""

_STATION = {"behind": "b", "beside": "n", "in_front_of": "f"}
_LATERAL = {"right_of": "r", "same_lane": "s", "left_of": "l"}

_MEANING: dict[PartitionName, str] = {
    "paper": "b behind, f in front, l left, r right",
    "fine": "first b behind, n beside, f in front; then r right of, s same lane, l left of",
}


def in_letters(cell: Cell) -> str:
    """A letter per obstacle (two with ``fine``), in the layer's object order."""
    if len(cell.objects) > MOST_SPELLED:
        return ""
    letters = [
        relation if isinstance(relation, str) else _STATION[relation[0]] + _LATERAL[relation[1]]
        for relation in cell.signature.values()
    ]
    return ("" if cell.partition == "paper" else " ").join(letters)


def in_full(cell: Cell) -> str:
    """The surface, and the relation to every obstacle by name."""
    named = [
        f"{relation if isinstance(relation, str) else ' '.join(relation)}({name})"
        for name, relation in cell.signature.items()
    ]
    return ", ".join([cell.surface, *named])


def meaning(graph: NavigationGraph) -> str:
    """Explanation of the letters, and the obstacles that they are about."""
    names = list(graph.objects)
    whose = f"of {names[0]}" if len(names) == 1 else f"of {', '.join(names)} in this order"
    return f"{_MEANING[graph.partition]}; {whose}"
