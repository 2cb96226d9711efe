"""The order of penalties, and the least violating maneuvers by whole rulebooks.

How bad a path is is written down again here, rule by rule and without ranks.
"""

from collections import Counter
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given

from rulec import compile_rulebook, navigation_graph
from rulec.monitoring.batch.verify import verify
from rulec.planning import evaluate, partition_for
from rulec.planning.ranking.penalties import PenaltyRank, ranks_of
from rulec.trace.trace_model import paths, trace_of
from support.generators.random_priorities import LEVELS, RULES, closed, rulebooks


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
    assert ranks.ranks == (
        PenaltyRank("hard", ("c",)),
        PenaltyRank("hard", ("",)),
        PenaltyRank("soft", ("a", "b")),
    )
    assert ranks.above == (frozenset(), frozenset(), frozenset({0, 1}))
    assert [ranks.weight(one) for one in rulebook.rules] == [3, 6, 12, 6, 2]
    # Level c is below a and b, but its rules are hard; no level, and c, are not comparable.
    assert ranks.at_most((0, 0, 9), (1, 0, 0))
    assert not ranks.at_most((1, 0, 0), (0, 0, 9))
    assert not ranks.at_most((0, 1, 0), (1, 0, 0))
    assert not ranks.at_most((1, 0, 0), (0, 1, 0))
    assert ranks.at_most((1, 0, 5), (1, 1, 0))


@pytest.mark.parametrize(
    ("scenario", "name"),
    [("s2", "de"), pytest.param("s3", "fr", marks=pytest.mark.long), ("s1", "esterle2019")],
)
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
        found = evaluate(graph, rulebook)
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
