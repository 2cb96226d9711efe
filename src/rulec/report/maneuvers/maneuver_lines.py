"""One maneuver: its cells and bounds in time, as lines of text."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import groupby

from rulec.partition import Cell, NavigationGraph, envelope
from rulec.planning.ranking.cheapest import Maneuver
from rulec.report.text.terminal_text import table_lines, visible

MOST_NAMED = 6
"""So many objects' relations fit on a line of text; JSON has them all."""


def in_a_line(maneuver: Maneuver) -> str:
    """Its cost and margin."""
    margin_s = maneuver.margin_s
    margin = "never changes cell" if margin_s is None else f"margin {margin_s:g} s"
    return f"cost {maneuver.cost:.4g} 1/s, {margin}"


def cell_lines(graph: NavigationGraph, maneuver: Maneuver) -> list[str]:
    """Its cells, a line each, with the bounds."""
    rows = [
        (
            f"{layer.start_s:g} s",
            _label(layer.cells[index]),
            f"s {bounds.s_min:g} … {bounds.s_max:g} m",
            f"d {_least(bounds.d_right)} … {_most(bounds.d_left)} m",
        )
        for layer, index, bounds in zip(
            graph.layers, maneuver.nodes, envelope(graph, maneuver.nodes), strict=True
        )
    ]
    return table_lines(rows, indent="   ")


def relations_in_time(graph: NavigationGraph, maneuver: Maneuver, objects: Collection[str]) -> str:
    """Times at which the maneuver's relations to objects, or its surface, change."""
    told = [
        (f"{layer.start_s:g} s", _label(layer.cells[index], objects))
        for layer, index in zip(graph.layers, maneuver.nodes, strict=True)
    ]
    changes = [next(group) for _, group in groupby(told, key=lambda one: one[1])]
    return ", ".join(f"{when} {what}" for when, what in changes)


def _label(cell: Cell, objects: Collection[str] | None = None) -> str:
    signature: Mapping[str, str | tuple[str, str]] = cell.signature
    if objects is not None:
        signature = {name: signature[name] for name in objects if name in signature}
    named = [
        f"{relation if isinstance(relation, str) else ' '.join(relation)}({visible(name)})"
        for name, relation in list(signature.items())[:MOST_NAMED]
    ]
    if len(signature) > MOST_NAMED:
        named.append(f"and {len(signature) - MOST_NAMED} more")
    return " ".join([cell.surface, *named])


def _least(profile: Sequence[tuple[float, float]]) -> str:
    return f"{min(d for _, d in profile):g}"


def _most(profile: Sequence[tuple[float, float]]) -> str:
    return f"{max(d for _, d in profile):g}"
