"""Titles, legends, axis labels and cell letters of pictures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import ceil, floor, inf, log10
from typing import TYPE_CHECKING

from rulec.report.pictures.drawing import canvas
from rulec.report.pictures.drawing.canvas import LabelText, Mark, Picture, Polyline
from rulec.report.pictures.drawing.styles import STYLES
from rulec.report.text.terminal_text import counted, shown_count

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.monitoring.verdict import Verdict
    from rulec.partition import Cell, NavigationGraph, PartitionName
    from rulec.planning import Maneuvers
    from rulec.planning.ranking.cheapest import Maneuver

_SWATCH = 26.0
_GAP = 22.0

MOST_SPELLED = 8
"""With more obstacles a signature is longer than any cell is wide."""

_STATION = {"behind": "b", "beside": "n", "in_front_of": "f"}
_LATERAL = {"right_of": "r", "same_lane": "s", "left_of": "l"}

_MEANING: dict[PartitionName, str] = {
    "paper": "b behind, f in front, l left, r right",
    "fine": "first b behind, n beside, f in front; then r right of, s same lane, l left of",
}


def legend(entries: Sequence[tuple[str, str]], notes: Iterable[str]) -> Picture:
    """Lay out swatches of styles with their meanings, then notes."""
    marks: list[Mark] = []
    x, y = canvas.MARGIN, canvas.LINE_HEIGHT
    for style, words in entries:
        needed = _SWATCH + 6 + canvas.text_width([words])
        if x > canvas.MARGIN and x + needed > canvas.WIDTH - canvas.MARGIN:
            x, y = canvas.MARGIN, y + canvas.LINE_HEIGHT + 2
        marks.append(_swatch(style, x, y))
        marks.append(LabelText(words, (x + _SWATCH + 6, y)))
        x += needed + _GAP
    if entries:
        y += canvas.LINE_HEIGHT + 4
    for note in notes:
        lines = canvas.paragraph(note, (canvas.MARGIN, y), canvas.TEXT_WIDTH, "faint")
        marks += lines
        y += len(lines) * canvas.LINE_HEIGHT
    return Picture("", canvas.WIDTH, y + 2, tuple(marks))


def _swatch(style: str, x: float, y: float) -> Mark:
    if STYLES[style].fill or style == "goal":
        return canvas.filled((x, y - 6, x + _SWATCH, y + 6), style)
    return Polyline(((x, y), (x + _SWATCH, y)), style)


def ticks(low: float, high: float, at_most: int) -> list[float]:
    """Multiples of 1, 2 or 5 powers of ten within an interval.

    None if the interval is infinite, or too short for nine decimals.
    """
    span = high - low
    if not 1e-8 <= span < inf:
        return []
    power = 10.0 ** floor(log10(span / at_most))
    # The logarithm may be rounded down from a whole number, so that 10 would just not be enough.
    step = next(power * unit for unit in (1, 2, 5, 10, 20) if span / (power * unit) <= at_most)
    return [round(step * n, 9) + 0.0 for n in range(ceil(low / step), floor(high / step) + 1)]


def scene_title(
    graph: NavigationGraph, maneuvers: Maneuvers | None, maneuver: Maneuver | None, number: int
) -> str:
    """The scenario and the maneuver shown."""
    name = graph.scenario.name
    if maneuvers is None:
        return f"{name}: {graph.nodes:,} cells in {len(graph.layers)} layers"
    # The count includes open maneuvers, and all maneuvers if no hard rule is judged
    may = "that may satisfy" if maneuvers.open or not maneuvers.judges else "that satisfy"
    number_of = shown_count(maneuvers.satisfying + maneuvers.open)
    by = f"of {number_of} {may} {maneuvers.rules.name}"
    if maneuver is None:
        doubtful = f", {shown_count(maneuvers.open)} are open" if maneuvers.open else ""
        return f"{name}: no maneuver satisfies {maneuvers.rules.name}{doubtful}"
    margin = "" if maneuver.margin_s is None else f", margin {maneuver.margin_s:g} s"
    return f"{name}: maneuver {number} {by}; cost {maneuver.cost:.4g} 1/s{margin}"


def graph_title(graph: NavigationGraph, judged: Maneuvers | None, maneuvers: int) -> str:
    """The scenario, the size of its graph, and the number of maneuvers."""
    counts = f"{graph.scenario.name}: {graph.nodes:,} nodes, {graph.edges:,} edges"
    if judged is None:
        return f"{counts}, {shown_count(maneuvers)} maneuvers"
    satisfying = f"{shown_count(maneuvers)} satisfying by {judged.rules.name}"
    if judged.open:
        satisfying += f", {shown_count(judged.open)} open"
    return f"{counts}, {shown_count(judged.traces)} maneuvers, {satisfying}"


def trace_title(verdict: Verdict, rules: CompiledRulebook, only: Sequence[str] = ()) -> str:
    """The trace and its verdict, ``only`` for some rules and objects."""
    number = len(verdict.violations)
    count = counted(number, "violation") if number else "no violation"
    doubtful = f", {len(verdict.open):,} open" if verdict.open else ""
    chosen = f", only {', '.join(only)}" if only else ""
    return f"{verdict.trace}: {count}{doubtful} by {rules.name}{chosen}"


def in_letters(cell: Cell) -> str:
    """A letter per obstacle (two with ``fine``), in the order of the layer's objects."""
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
    """The meaning of the letters, and the obstacles that they refer to."""
    names = list(graph.objects)
    objects = f"of {names[0]}" if len(names) == 1 else f"of {', '.join(names)} in this order"
    return f"{_MEANING[graph.partition]}; {objects}"


def mirrored(graph: NavigationGraph) -> list[str]:
    """A note that the scene is a mirror image, if it is one."""
    account = graph.scenario.account
    if account is None or not account.mirrored:
        return []
    return ["the mirror image of what was recorded: the rules' traffic keeps to the other side"]
