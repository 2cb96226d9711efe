"""Engines that judge a trace as the only path of a graph."""

from dataclasses import replace
from fractions import Fraction

from rulec.api.named_monitor import Monitor
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.product.possible_instances import HARD, SOFT, instances, violations
from rulec.planning.ranking.pruning import violating
from rulec.planning.trace_history import past_of
from rulec.trace import TraceGraph
from support.engines.engine import each, said
from support.oracles.presence import part, stays_of, there
from support.oracles.state_oracle import number


def chain(trace):
    """The graph whose one path is a trace."""
    onward = (((0,),),) * (len(trace.states) - 1)
    return TraceGraph(
        trace.step_s,
        trace.objects,
        trace.present,
        tuple((state,) for state in trace.states),
        successors=onward,
        weights=onward,
        margins=onward,
        cost_unit=Fraction(1),
        start=0,
        goals=(0,),
    )


BOTH = (*HARD, *SOFT)


@each
def path(rulebook, compiled, trace):
    bound = instances(chain(trace), compiled, strengths=BOTH)
    return said(violations(bound, (0,) * len(trace.states)))


@each
def count(rulebook, compiled, trace):
    """Which rules there are paths against."""
    graph = chain(trace)
    found = violating(node_transformers(graph, instances(graph, compiled, strengths=BOTH)))
    assert all(product.accepted == 1 for product in found.values())
    return tuple(sorted(found))


def after(past_as):
    """The first half is the past of a graph that has the second half for a path."""

    @each
    def judge_one(rulebook, compiled, trace):
        n = len(trace.states) // 2
        stays = stays_of(trace)
        before = part(trace, stays, 0, n - 1)
        graph = chain(part(trace, stays, n, len(trace.states) - 1))
        past = past_of(graph, past_as(before, compiled), compiled, number(trace.step_s), BOTH)
        bound = instances(graph, compiled, strengths=BOTH, past=past)
        later = violations(bound, (0,) * len(graph.states))
        shifted = [one if one.step is None else replace(one, step=one.step + n) for one in later]
        return said([*past.violations, *shifted])

    return judge_one


def as_a_trace(trace, compiled):
    return trace


def saved(trace, compiled):
    monitor = Monitor(compiled, trace.step_s)
    for n, state in enumerate(trace.states):
        monitor.step(state, there(trace, n))
    return monitor.snapshot()
