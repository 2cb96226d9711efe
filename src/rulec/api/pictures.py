"""Drawings of scenes, navigation graphs and traces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.verify import verify
from rulec.partition import NavigationGraph
from rulec.planning import Maneuvers
from rulec.planning.product.accepted_edges import accepted_edges
from rulec.planning.product.graph_product import explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.ranking.cheapest import Maneuver
from rulec.report.pictures.drawing.picture_formats import Drawing
from rulec.report.pictures.graph_picture import graph_picture
from rulec.report.pictures.picture_captions import graph_title, scene_title, trace_title
from rulec.report.pictures.scene_picture import scene_legend, scene_pictures
from rulec.report.pictures.trace_picture import ribbon_picture
from rulec.report.pictures.trace_ribbon import ribbon
from rulec.trace import Trace


def trace_drawing(
    trace: Trace,
    rules: CompiledRulebook,
    objects: Sequence[str] = (),
    patterns: Sequence[str] = (),
) -> Drawing:
    """Draw a trace's rule inputs over time, with violations. Raises RulecError.

    ``objects`` are those to show, if not all; ``patterns`` have chosen the rules, for the title.
    """
    verdict = verify(trace, rules)
    shown = ribbon(trace, rules, verdict, objects)
    title = trace_title(replace(verdict, violations=shown.violations), rules, (*patterns, *objects))
    return Drawing(title, [ribbon_picture(shown, rules)])


def scene_drawing(
    graph: NavigationGraph,
    maneuvers: Maneuvers | None = None,
    maneuver: Maneuver | None = None,
    layers: Sequence[int] = (),
    number: int = 1,
) -> Drawing:
    """Draw a scene over time, or some of its layers."""
    chosen = sorted(set(layers)) or range(len(graph.layers))
    title = scene_title(graph, maneuvers, maneuver, number)
    return Drawing(title, scene_pictures(graph, chosen, maneuver), scene_legend(graph, maneuver))


def graph_drawing(
    graph: NavigationGraph, maneuvers: Maneuvers | None = None, maneuver: Maneuver | None = None
) -> Drawing:
    """A navigation graph, layer by layer, with a maneuver."""
    hard = maneuvers.hard if maneuvers else node_transformers(graph.trace_graph(), ())
    product = maneuvers.product if maneuvers else explore(hard)
    edges = accepted_edges(hard, product)
    picture = graph_picture(graph, edges, maneuver, judged=maneuvers is not None)
    return Drawing(graph_title(graph, maneuvers, product.accepted), [picture])
