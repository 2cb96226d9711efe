"""What the search for maneuvers found, as text and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import click

from rulec.maneuvers import Maneuvers
from rulec.partition import Cell, Envelope, NavigationGraph, envelope
from rulec.report.excerpt import visible
from rulec.runtime.cheapest import Maneuver
from rulec.runtime.verdict import Violation

MOST_NAMED = 6
"""So many objects' relations fit on a line of text; JSON has them all."""

MOST_DIGITS = 30


def as_json(found: Maneuvers, listed: Sequence[Maneuver] | None, seconds: float) -> str:
    """The counts and, if maneuvers were asked for, each with cells, cost, margin and envelope."""
    graph = found.graph
    data: dict[str, Any] = {
        "scenario": graph.scenario.name,
        "rulebook": found.rules.name,
        "partition": graph.partition,
        "adjacency": graph.adjacency,
        "step_s": graph.step_s,
        "horizon_s": _horizon_s(graph),
        "nodes": graph.nodes,
        "edges": graph.edges,
        "traces": found.traces,
        "satisfying": found.satisfying,
        "seconds": round(seconds, 6),
    }
    if found.violated_before is not None:
        data["violated_before"] = [
            {"rule": one.rule, "binding": dict(one.binding), "step": one.step}
            for one in found.violated_before
        ]
    if listed is not None:
        data["maneuvers"] = [_as_data(graph, maneuver) for maneuver in listed]
    return json.dumps(data, ensure_ascii=False)


def _as_data(graph: NavigationGraph, maneuver: Maneuver) -> dict[str, Any]:
    return {
        "cost": maneuver.cost,
        "margin_s": maneuver.margin_s,
        "cells": [
            {
                "cell": index,
                "start_s": layer.start_s,
                "surface": layer.cells[index].surface,
                "signature": layer.cells[index].signature,
            }
            for layer, index in zip(graph.layers, maneuver.nodes, strict=True)
        ],
        "envelope": [_bounds(bounds) for bounds in envelope(graph, maneuver.nodes)],
    }


def _bounds(bounds: Envelope) -> dict[str, Any]:
    return {
        "s_min": bounds.s_min,
        "s_max": bounds.s_max,
        "d_left": bounds.d_left,
        "d_right": bounds.d_right,
    }


def as_text(found: Maneuvers, listed: Sequence[Maneuver] | None, seconds: float) -> str:
    """The counts in four lines, and a block for every maneuver that was asked for."""
    graph, rules = found.graph, found.rules
    names = ", ".join(rule.name for rule in rules.rules if rule.strength == "hard")
    by = f"{rules.name} ({names or 'no hard rules'})" if len(names) <= 60 else rules.name
    horizon = f"{_horizon_s(graph):g} s in steps of {graph.step_s:g} s"
    how = f"partition {graph.partition}, adjacency {graph.adjacency}"
    lines = [
        f"scenario    {graph.scenario.name}: {horizon}, {how}",
        f"graph       {graph.nodes:,} nodes, {graph.edges:,} edges",
        f"maneuvers   {shown_count(found.traces)}",
        f"satisfying  {click.style(shown_count(found.satisfying), bold=True)} by {by}",
        *_violated_before(found.violated_before or ()),
        f"computed in {seconds:.3f} s",
    ]
    if listed:
        for rank, maneuver in enumerate(listed, 1):
            lines += ["", *_block(graph, rank, maneuver)]
    return "\n".join(lines)


def _violated_before(violations: Sequence[Violation]) -> Iterator[str]:
    """A line for each rule that the past has violated, which no maneuver can mend."""
    for one in violations[:MOST_NAMED]:
        where = ", ".join(f"{name} = {item}" for name, item in one.binding.items())
        about = f" for {where}" if where else ""
        yield visible(f"violated    {one.rule}{about}, before, and not counted any more")
    if len(violations) > MOST_NAMED:
        yield f"            and {len(violations) - MOST_NAMED:,} more; --json has them all"


def shown_count(count: int) -> str:
    """A count for people: exact as long as it can be read, then its size; JSON has every digit."""
    digits = str(count)
    if len(digits) <= MOST_DIGITS:
        return f"{count:,}"
    return f"about {digits[0]}.{digits[1:3]}e{len(digits) - 1}"


def _block(graph: NavigationGraph, rank: int, maneuver: Maneuver) -> list[str]:
    margin_s = maneuver.margin_s
    margin = "never changes cell" if margin_s is None else f"margin {margin_s:g} s"
    lines = [f"{rank}. cost {maneuver.cost:.4g} 1/s, {margin}"]
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
    widths = [max(len(row[column]) for row in rows) for column in range(4)]
    for row in rows:
        padded = [text.ljust(width) for text, width in zip(row, widths, strict=True)]
        lines.append("   " + "  ".join(padded).rstrip())
    return lines


def _label(cell: Cell) -> str:
    signature: Mapping[str, str | tuple[str, str]] = cell.signature
    named = [
        f"{relation if isinstance(relation, str) else ' '.join(relation)}({name})"
        for name, relation in list(signature.items())[:MOST_NAMED]
    ]
    if len(signature) > MOST_NAMED:
        named.append(f"and {len(signature) - MOST_NAMED} more")
    return " ".join([cell.surface, *named])


def _least(profile: Sequence[tuple[float, float]]) -> str:
    return f"{min(d for _, d in profile):g}"


def _most(profile: Sequence[tuple[float, float]]) -> str:
    return f"{max(d for _, d in profile):g}"


def _horizon_s(graph: NavigationGraph) -> float:
    return float((len(graph.layers) - 1) * graph.step)
