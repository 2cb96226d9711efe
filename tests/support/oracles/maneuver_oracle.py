"""What there is to say of a graph's maneuvers, by going through all of them.

Each path's trace is judged by itself, with the past in front of it; how bad it is, and which class
it belongs to, is written down again here from ``docs/ranking.md``.
"""

from collections import Counter
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import groupby, pairwise, product

from rulec.trace import Trace
from support.builders.state_traces import as_trace
from support.generators.random_traces import only
from support.oracles.presence import there
from support.oracles.rulebook_oracle import Oracle


def every_path(graph):
    """Every sequence of nodes that is a path: by trying them all."""
    for path in product(*(range(len(layer)) for layer in graph.states)):
        if (
            path[0] == graph.start
            and path[-1] in graph.goals
            and all(
                after in graph.successors[layer][here]
                for layer, (here, after) in enumerate(pairwise(path))
            )
        ):
            yield path


@dataclass(frozen=True)
class Path:
    """A path with its cost (1/s), its margin (s), and what it violates, in layers of the graph."""

    nodes: tuple
    cost: Fraction
    margin_s: float | None
    violations: tuple

    @property
    def hard(self):
        """The hard rules that it violates."""
        return {one.rule for one in self.violations if one.strength == "hard"}

    @property
    def rules(self):
        """All rules that it violates."""
        return {one.rule for one in self.violations}


class BruteForce:
    """All paths of a graph, judged by a rulebook; ``past`` are states with those who are there."""

    def __init__(self, graph, rulebook, past=()):
        self.graph, self.rulebook, self.past = graph, rulebook, past
        self._oracle = Oracle(rulebook)
        self.before = None
        paths = [self._path(nodes) for nodes in every_path(graph)]
        self.paths = sorted(paths, key=lambda one: (one.cost, one.nodes))

    def _path(self, nodes):
        graph = self.graph
        margins = [
            graph.margins[layer][here][graph.successors[layer][here].index(after)]
            for layer, (here, after) in enumerate(pairwise(nodes))
        ]
        times = [margin * Fraction(str(graph.step_s)) for margin in margins if margin is not None]
        margin_s = float(min(times)) if times else None
        cost = sum((1 / time for time in times), Fraction(0))
        return Path(nodes, cost, margin_s, self._violations(nodes))

    def _violations(self, nodes):
        """Those that are decided in the graph; the others are ``before``."""
        states = tuple(layer[node] for layer, node in zip(self.graph.states, nodes, strict=True))
        own = Trace("", self.graph.step_s, self.graph.objects, states, self.graph.present)
        journey = [(only(state, there(own, n)), there(own, n)) for n, state in enumerate(states)]
        trace = as_trace([*self.past, *journey], self.graph.step_s)
        n_past, last = len(self.past), len(trace.states) - 1
        before, later = [], []
        for one in self._oracle.judged(trace):
            ends = min((trace.present[name][1] for name in one.objects), default=last)
            said = replace(one, objects=tuple(name.split()[0] for name in one.objects))
            if (ends if one.step < 0 else one.step) < n_past:
                before.append(said)
            else:
                later.append(said if one.step < 0 else replace(said, step=one.step - n_past))
        assert self.before in (None, sorted(before)), "the past does not depend on the path"
        self.before = sorted(before)
        return tuple(sorted(later))

    @property
    def satisfying(self):
        return [path for path in self.paths if not path.hard]

    @cached_property
    def by_penalty(self):
        """The paths that violate the same weights in the same places."""
        groups = {}
        for path in self.paths:
            groups.setdefault(frozenset(self.penalty(path).items()), []).append(path)
        return list(groups.values())

    def penalty(self, path):
        """The weights of what a path violates, summed up by strength and level."""
        rules = {one.name: one for one in self.rulebook.rules}
        sums = Counter()
        for violation in path.violations:
            rule = rules[violation.rule]
            equal = (rule.level, *self._equal(rule.level))
            sums[rule.strength, min(equal)] += rule.weight
        return sums

    def _equal(self, level):
        order = self.rulebook.priorities
        return [other for one, other in order if one == level and (other, level) in order]

    def violates_less(self, one, other):
        first, second = self.penalty(one), self.penalty(other)
        return self._at_most(first, second) and not self._at_most(second, first)

    def _at_most(self, one, other):
        """Above every place where it is higher there is one where it is lower."""
        every = {*one, *other}
        return all(
            any(one[above] < other[above] and self._is_above(above, place) for above in every)
            for place in every
            if one[place] > other[place]
        )

    def _is_above(self, one, other):
        if one[0] != other[0]:
            return one[0] == "hard"
        order = self.rulebook.priorities
        return (one[1], other[1]) in order and (other[1], one[1]) not in order

    def place(self, group):
        """1 if no path violates less, else 1 more than the last place of those that do."""
        better = [one for one in self.by_penalty if self.violates_less(one[0], group[0])]
        return 1 + max(map(self.place, better), default=0)

    @cached_property
    def classes(self):
        """The paths that visit the same places in the same order."""
        where = places(self.graph)
        found = {}
        for path in self.paths:
            visited = [where[node] for node in enumerate(path.nodes)]
            found.setdefault(tuple(place for place, _ in groupby(visited)), []).append(path)
        return list(found.values())


def places(graph):
    """For each node of each layer a number: that of its place.

    A place is what one gets to and comes from by staying where states are the same.
    """
    nodes = [(layer, node) for layer, row in enumerate(graph.states) for node in range(len(row))]
    where = {node: number for number, node in enumerate(nodes)}
    for layer, rows in enumerate(graph.successors):
        for node, onward in enumerate(rows):
            for target, margin in zip(onward, graph.margins[layer][node], strict=True):
                same = graph.states[layer][node] == graph.states[layer + 1][target]
                one, other = where[layer, node], where[layer + 1, target]
                if margin is None and same:
                    where = {key: one if at == other else at for key, at in where.items()}
    return where
