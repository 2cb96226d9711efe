"""Random graphs with rulebooks and pasts, by a source of chance."""

from dataclasses import dataclass
from fractions import Fraction
from types import SimpleNamespace

from rulec.trace import TraceGraph
from support.generators.random_graphs import layered
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import KINDS, only, state_of


@dataclass(frozen=True)
class Given:
    """A navigation graph, as far as maneuvers are judged by it."""

    traces: TraceGraph
    scenario = SimpleNamespace(name="random", account=None)
    bounds = None

    @property
    def step(self):
        return Fraction(str(self.traces.step_s))

    @property
    def objects(self):
        return self.traces.objects

    def trace_graph(self):
        return self.traces


def scene(chance, with_past):
    """A graph, a rulebook, and a past, which is empty without: states with those who are there."""
    names = sorted(chance.sample("abc", chance.choice([0, 1, 2, 2, 3])))
    objects = {name: KINDS[name] for name in names}
    pool = [state_of(chance, objects, gaps=False) for _ in range(chance.randint(3, 8))]
    graph = layered(
        chance, objects, lambda: chance.choice(pool), chance.choice([1, 2, 3, 4, 4, 5, 5, 5])
    )
    past = []
    for _ in range(chance.randint(1, 4) if with_past else 0):
        there = {name: kind for name, kind in objects.items() if chance.random() < 0.7}
        past.append((only(chance.choice(pool), there), there))
    return graph, rulebook(chance, Fraction(1, 2), for_graphs=True), past
