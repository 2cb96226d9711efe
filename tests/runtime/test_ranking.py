"""The least violating paths, against judging them all.

How bad a path is is written down again here, rule by rule and without ranks.
"""

from collections import Counter
from dataclasses import replace
from fractions import Fraction

import pytest
from graphs import graphs
from hypothesis import given
from random_priorities import LEVELS, RULES, closed, rulebooks

from rulec.maneuvers import judged, partition_for
from rulec.runtime.cheapest import cheapest
from rulec.runtime.effects import effects
from rulec.runtime.instances import HARD, SOFT, instances, violations
from rulec.runtime.penalties import Rank, ranks_of
from rulec.runtime.ranking import front, ranked, with_penalty
from rulec.runtime.verify import verify
from rulec.trace.paths import paths, trace_of
from rulec.workflow import compile_rulebook, navigation_graph


def penalty(rulebook, graph, path):
    """The weights of what a path violates, summed up by strength and level."""
    rules = {one.name: one for one in rulebook.rules}
    sums = Counter()
    for violation in verify(trace_of(graph, path, ""), rulebook).violations:
        violated = rules[violation.rule]
        sums[violated.strength, violated.level] += violated.weight
    return sums


def is_above(one, other, order):
    """Is a level of rules of a strength strictly above another one?"""
    if one[0] != other[0]:
        return one[0] == "hard"
    return (one[1], other[1]) in order and (other[1], one[1]) not in order


def at_most(one, other, order):
    """Rulebooks' order: whatever is worse is outweighed by something better above it."""

    def total(sums, place):
        equal = {one for one, same in order if same == place[1] and (same, one) in order}
        return sum(sums[place[0], level] for level in {place[1], *equal})

    every = {*one, *other}
    return all(
        total(one, place) <= total(other, place)
        or any(
            total(one, higher) < total(other, higher)
            for higher in every
            if is_above(higher, place, order)
        )
        for place in every
    )


def searched(graph, rulebook):
    return effects(graph, instances(graph, rulebook, strengths=(*HARD, *SOFT))), ranks_of(rulebook)


@given(graphs(objects=("car1", "car2")), rulebooks())
def test_the_front_is_what_nothing_is_better_than(graph, rulebook):
    every = {path: penalty(rulebook, graph, path) for path in paths(graph)}
    order = rulebook.priorities
    best = sorted(
        path
        for path, mine in every.items()
        if not any(
            at_most(other, mine, order) and not at_most(mine, other, order)
            for other in every.values()
        )
    )
    found, ranks = searched(graph, rulebook)
    penalties = list(front(found, ranks))
    assert len(set(penalties)) == len(penalties)
    products = [with_penalty(found, ranks, one) for one in penalties]
    assert sorted(m.nodes for product in products for m in cheapest(product)) == best
    assert sum(product.accepted for product in products) == len(best)


@given(graphs(objects=("car1", "car2")), rulebooks())
def test_every_penalty_comes_once_behind_all_better_ones(graph, rulebook):
    every = {path: penalty(rulebook, graph, path) for path in paths(graph)}
    order = rulebook.priorities

    def place(mine):
        better = [
            other
            for other in every.values()
            if at_most(other, mine, order) and not at_most(mine, other, order)
        ]
        return 1 + max(map(place, better), default=0)

    found, ranks = searched(graph, rulebook)
    seen = []
    for position, one in ranked(found, ranks):
        members = [m.nodes for m in cheapest(with_penalty(found, ranks, one))]
        assert {place(every[path]) for path in members} == {position}
        assert all(at_most(every[path], every[members[0]], order) for path in members)
        assert not any(at_most(every[members[0]], every[path], order) for path in seen)
        seen += members
    assert sorted(seen) == sorted(every)


@given(graphs(objects=("car1", "car2")), rulebooks())
def test_what_a_path_violates_is_what_its_trace_does(graph, rulebook):
    bound = instances(graph, rulebook, strengths=(*HARD, *SOFT))
    key = repr
    for path in paths(graph):
        verdict = verify(trace_of(graph, path, ""), rulebook)
        assert sorted(violations(bound, path), key=key) == sorted(verdict.violations, key=key)


@given(rulebooks())
def test_ranks_are_a_linear_order_that_extends_the_rulebooks(rulebook):
    ranks = ranks_of(rulebook)
    for index, higher in enumerate(ranks.above):
        assert all(one < index for one in higher)
    for one in rulebook.rules:
        assert ranks.weight(one) * ranks.unit == one.weight
        for other in rulebook.rules:
            above = is_above(
                (one.strength, one.level), (other.strength, other.level), rulebook.priorities
            )
            assert (ranks.of(one) in ranks.above[ranks.of(other)]) == above


def test_hard_rules_stand_above_soft_ones_and_equal_levels_are_one():
    places = [
        ("soft", "a", Fraction(1, 2)),
        ("soft", "b", Fraction(1)),
        ("hard", "c", Fraction(2)),
        ("hard", "", Fraction(1)),
        ("hard", "c", Fraction(1, 3)),
    ]
    rulebook = replace(
        RULES,
        rules=tuple(
            replace(one, strength=strength, level=level, weight=weight)
            for one, (strength, level, weight) in zip(RULES.rules, places, strict=False)
        ),
        levels=LEVELS,
        priorities=closed({("a", "b"), ("b", "a"), ("b", "c")}),
    )
    ranks = ranks_of(rulebook)
    assert ranks.ranks == (Rank("hard", ("c",)), Rank("hard", ("",)), Rank("soft", ("a", "b")))
    assert ranks.above == (frozenset(), frozenset(), frozenset({0, 1}))
    assert [ranks.weight(one) for one in rulebook.rules] == [3, 6, 12, 6, 2]
    # Level c is below a and b, but its rules are hard; no level, and c, are not comparable.
    assert ranks.at_most((0, 0, 9), (1, 0, 0))
    assert not ranks.at_most((1, 0, 0), (0, 0, 9))
    assert not ranks.at_most((0, 1, 0), (1, 0, 0))
    assert not ranks.at_most((1, 0, 0), (0, 1, 0))
    assert ranks.at_most((1, 0, 5), (1, 1, 0))


@pytest.mark.parametrize(("scenario", "name"), [("s2", "de"), ("s3", "fr"), ("s1", "esterle2019")])
def test_a_whole_rulebook_on_a_scenario(scenario, name):
    """Also with what it calls hard and soft exchanged."""
    compiled = compile_rulebook(name, step_s=1)
    other = {"hard": "soft", "soft": "hard"}
    for rulebook in (
        compiled,
        replace(
            compiled,
            rules=tuple(replace(one, strength=other[one.strength]) for one in compiled.rules),
        ),
    ):
        graph = navigation_graph(scenario, partition=partition_for(rulebook, None))
        found = judged(graph, rulebook)
        every = {path: penalty(rulebook, found.paths, path) for path in paths(found.paths)}
        best = found.best()
        order = rulebook.priorities
        least = [
            mine
            for mine in every.values()
            if all(at_most(mine, one, order) for one in every.values() if at_most(one, mine, order))
        ]
        assert sum(one.members for one in best) == len(least)
        assert all(every[one.maneuver.nodes] in least for one in best)
        violated = Counter(
            rule
            for path in every
            for rule in {
                one.rule for one in verify(trace_of(found.paths, path, ""), rulebook).violations
            }
        )
        assert {one.rule.name: one.violating for one in found.prunings() if one.violating} == dict(
            violated
        )
