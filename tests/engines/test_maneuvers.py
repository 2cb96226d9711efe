"""Counting and searching without enumerating, against going through all paths."""

from collections import Counter

import pytest
from hypothesis import Phase, given, settings

from rulec.api.named_monitor import Monitor
from rulec.planning import evaluate
from rulec.planning.product.graph_product import accepted_edges
from support.builders.rulebooks import compile_here
from support.engines.engine import said
from support.generators.random_maneuvers import Given, scene
from support.generators.seeds import seeds
from support.oracles.maneuver_oracle import BruteForce

MANY = 10**9


def counts(found, brute):
    yield found.traces, len(brute.paths)
    yield found.satisfying, len(brute.satisfying)


def the_cheapest(found, brute):
    yield shown(found.cheapest(MANY)), as_shown(brute.satisfying)
    yield shown(found.cheapest(2)), as_shown(brute.satisfying[:2])


def shown(maneuvers):
    return [(one.nodes, one.cost, one.margin_s) for one in maneuvers]


def as_shown(paths):
    return [(one.nodes, float(one.cost), one.margin_s) for one in paths]


def the_best(found, brute):
    """The Pareto front: of each lowest penalty one of the cheapest, with what it violates."""
    front = [group for group in brute.by_penalty if brute.place(group) == 1]
    best = found.best(MANY)
    yield (
        sorted((one.members, *shown([one.maneuver]), said(one.violations)) for one in best),
        sorted((len(group), *as_shown(group[:1]), group[0].violations) for group in front),
    )
    yield {one.place for one in best} <= {1}, True
    yield [one.maneuver for one in found.best(1)], [one.maneuver for one in best[:1]]


def the_ranking(found, brute):
    """Every path has its place, and stands behind all that violate less."""
    ranked = found.ranked(MANY)
    yield (
        sorted(
            (one.place, one.members, *shown([one.maneuver]), said(one.violations)) for one in ranked
        ),
        sorted(
            (brute.place(group), len(group), *as_shown([path]), path.violations)
            for group in brute.by_penalty
            for path in group
        ),
    )
    by_nodes = {path.nodes: path for path in brute.paths}
    order = [by_nodes[one.maneuver.nodes] for one in ranked]
    for place, later in enumerate(order):
        for earlier in order[:place]:
            yield brute.violates_less(later, earlier), False
            if brute.penalty(later) == brute.penalty(earlier):
                yield earlier.cost <= later.cost, True


def the_prunings(found, brute):
    strengths = {rule.name: rule.strength for rule in brute.rulebook.rules}
    for one in found.prunings():
        name = one.rule.name
        violating = [path for path in brute.paths if name in path.rules]
        alone = [path for path in brute.paths if path.hard == {name}]
        yield one.violating, len(violating)
        yield one.alone, len(alone) if strengths[name] == "hard" else None
        example = next(iter(alone or violating), None)
        yield shown([one.example] if one.example else []), as_shown([example] if example else [])
        lost = [each for each in (example.violations if example else ()) if each.rule == name]
        yield said(one.violations), tuple(lost)


def the_classes(found, brute):
    verdicts = Counter(frozenset(not path.hard for path in members) for members in brute.classes)
    known = found.classes()
    yield (
        (known.accepted, known.rejected, known.divided),
        tuple(verdicts[frozenset(one)] for one in ([True], [False], [True, False])),
    )
    satisfying = [[path for path in members if not path.hard] for members in brute.classes]
    satisfying = [members for members in satisfying if members]
    variants = found.variants(MANY)
    yield len(variants), len(satisfying)
    for one in variants:
        # Of several that are as cheap it may be any.
        cheapest = [
            (len(members), as_shown([path]))
            for members in satisfying
            for path in members
            if path.cost == members[0].cost and path.nodes == one.cheapest.nodes
        ]
        yield [(one.members, shown([one.cheapest]))], cheapest
    costs = [one.cheapest.cost for one in variants]
    yield costs, sorted(costs)


def the_passages(found, brute):
    on = accepted_edges(found.hard, found.product)
    for paths, nodes, edges in (
        (brute.paths, on.possible_nodes, on.possible),
        (brute.satisfying, on.accepted_nodes, on.accepted),
    ):
        ways = [path.nodes for path in paths]
        yield nodes, tuple(frozenset(way[n] for way in ways) for n in range(len(nodes)))
        steps = range(len(nodes) - 1)
        yield edges, tuple(frozenset((way[n], way[n + 1]) for way in ways) for n in steps)


def the_past(found, brute):
    if brute.past and brute.paths:
        hard = tuple(one for one in brute.before if one.strength == "hard")
        yield said(found.violated_before), hard


QUESTIONS = [
    counts,
    the_cheapest,
    the_best,
    the_ranking,
    the_prunings,
    the_classes,
    the_passages,
    the_past,
]


@pytest.mark.parametrize("with_past", [False, True])
@given(chance=seeds)
@settings(max_examples=2 * settings.default.max_examples, phases=[Phase.generate])
def test_answers_are_those_of_all_paths(with_past, chance):
    graph, rulebook, past = scene(chance, with_past)
    compiled = compile_here(rulebook, Given(graph).step)
    after = None
    if past:
        after = Monitor(compiled, graph.step_s)
        for state, there in past:
            after.step(state, there)
    found = evaluate(Given(graph), compiled, after)
    brute = BruteForce(graph, rulebook, past)
    wrong = [
        (question.__name__, answer, expected)
        for question in QUESTIONS
        for answer, expected in question(found, brute)
        if answer != expected
    ]
    assert wrong == []
