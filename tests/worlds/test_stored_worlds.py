"""The stored worlds: whoever is planted there is found, and nobody else accused."""

from functools import cache

import pytest

from support.worlds.not_yet import STORED, STORED_UNDECIDED
from support.worlds.scoring import MOST_OPEN, answers, open_share, scores, with_open, wrong
from support.worlds.stored import SMALL, StoredWorld


@cache
def judged(name):
    world = StoredWorld(name)
    found = answers(world.data, world.book, world.net)
    return scores(world.facts(), found, world.book)


@pytest.mark.parametrize("name", list(SMALL))
def test_verdicts_are_true(name):
    assert list(wrong(judged(name), STORED.get(name, ()))) == []


@pytest.mark.parametrize("name", list(SMALL))
def test_where_the_truth_is_known_a_verdict_is_not_open(name):
    assert with_open(judged(name)) <= STORED_UNDECIDED.get(name, set())


@pytest.mark.parametrize("name", list(SMALL))
def test_few_verdicts_are_open(name):
    assert open_share(judged(name)) <= MOST_OPEN


@pytest.mark.parametrize("book", ["us", "us-ca", "us-fl", "us-tx", "au", "au-nsw"])
def test_where_lanes_let_one_pass_on_the_near_side_nobody_is_blamed(book):
    """Some do so on the stored motorway, whom Germany's law blames."""
    world = StoredWorld("motorway")
    facts = [fact for fact in world.facts() if fact.rule == "near_side_passing" and fact.sure]
    passed = {fact.vehicle for fact in facts}
    found = answers(world.data, book, world.net)
    assert len(passed) >= 3
    for vehicle in passed:
        answer = found[vehicle]
        assert "near_side_passing" not in {*answer.violated, *answer.open, *answer.not_judged}


def test_something_is_planted_in_each():
    """A world without a violation shows little."""
    planted = {name: {f.rule for f in StoredWorld(name).facts() if f.sure} for name in SMALL}
    assert all(planted.values())
    assert len(set().union(*planted.values())) >= 8
