"""Limit on the number of product nodes, which can grow exponentially."""

from __future__ import annotations

from rulec.diagnostics import RulecError
from rulec.planning.planning_messages import TOO_MANY_MANEUVERS
from rulec.trace import TraceGraph

MOST = 1 << 17
"""So many kinds of partial paths are kept apart at most, whatever the graph."""

MOST_PER_NODE = 32
"""So many for each of its nodes, if that is more. Rules of the law come to less than one."""


def largest_product(graph: TraceGraph) -> int:
    """Largest number of product nodes for a graph."""
    return max(MOST, MOST_PER_NODE * sum(map(len, graph.states)))


def too_large(graph: TraceGraph) -> RulecError:
    """There is no room for so many."""
    message = (
        f"these rules keep more than {largest_product(graph):,} kinds of partial maneuvers "
        "apart, by where they are, what the automata remember, and what is violated"
    )
    help_text = "take fewer rules at a time, a larger step, or the same weight for several rules"
    return TOO_MANY_MANEUVERS.error(None, message, help=help_text)
