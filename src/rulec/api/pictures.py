"""Pictures of graphs, maneuvers and traces as the content of a file."""

from __future__ import annotations

from dataclasses import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.verify import verify
from rulec.partition import NavigationGraph
from rulec.planning import Maneuvers
from rulec.planning.product.accepted_edges import accepted_edges
from rulec.planning.product.graph_product import explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.ranking.cheapest import Maneuver
from rulec.report.pictures.drawing.picture_formats import Drawing, as_bytes
from rulec.report.pictures.graph_picture import graph_picture
from rulec.report.pictures.picture_titles import graph_title, scene_title, trace_title
from rulec.report.pictures.scene_picture import scene_legend, scene_pictures
from rulec.report.pictures.trace_picture import ribbon_picture
from rulec.report.pictures.trace_ribbon import ribbon
from rulec.trace import Trace


def draw_trace(trace: Trace, rules: CompiledRulebook, form: str) -> bytes:
    """What rules read in a trace, over time, with the violations. Raises RulecError."""
    verdict = verify(trace, rules)
    shown = ribbon(trace, rules, verdict, ())
    title = trace_title(replace(verdict, violations=shown.violations), rules)
    return as_bytes(Drawing(title, [ribbon_picture(shown, rules)]), form, trace.id)


def draw_maneuvers(
    subject: NavigationGraph | Maneuvers, maneuver: Maneuver | None, form: str, *, as_graph: bool
) -> bytes:
    """A scene over time or its navigation graph, with a maneuver. Raises RulecError."""
    maneuvers = subject if isinstance(subject, Maneuvers) else None
    graph = subject.graph if isinstance(subject, Maneuvers) else subject
    if maneuver is None and maneuvers is not None:
        maneuver = next(iter(maneuvers.cheapest(1)), None)
    if not as_graph:
        pictures = scene_pictures(graph, range(len(graph.layers)), maneuver)
        title = scene_title(graph, maneuvers, maneuver, 1)
        return as_bytes(Drawing(title, pictures, scene_legend(graph, maneuver)), form, title)
    hard = maneuvers.hard if maneuvers else node_transformers(graph.trace_graph(), ())
    product = maneuvers.product if maneuvers else explore(hard)
    edges = accepted_edges(hard, product)
    picture = graph_picture(graph, edges, maneuver, judged=maneuvers is not None)
    title = graph_title(graph, maneuvers, product.accepted)
    return as_bytes(Drawing(title, [picture]), form, title)
