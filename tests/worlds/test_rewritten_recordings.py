"""Verdicts that must agree whatever is true: on a recording, and on the same one in other words.

Written in another way it has the same verdicts, of everybody, at the same moments. Where less is
said of it, or is known less exactly, they may be open, never the opposite.
"""

import os
import random
from functools import cache
from itertools import product

import pytest

import rulec
from support.rewriting.judged import judged
from support.rewriting.told_less import TOLD_LESS
from support.rewriting.written_anew import WAYS
from support.worlds.stored import SMALL, StoredWorld

LONG = os.environ.get("RULEC_TEST_PROFILE") == "long"
BOOKS = ("de", "fr", "us-ca", "jp", "it", "nl", "in", "gb")
WORLDS = list(SMALL) if LONG else ["priority", "stop_signs_left"]
SEEDS = range(3) if LONG else range(1)


@cache
def read(name):
    world = StoredWorld(name)
    return rulec.read_recording(world.data, world.net)


@cache
def book_of(name, seed):
    """That of the world, then others in turn."""
    books = (StoredWorld(name).book, *BOOKS)
    return rulec.compile_rulebook(books[seed % len(books)])


@cache
def before(name, seed):
    return judged(read(name), book_of(name, seed))


def opposites(one, other):
    """What is violated in one of two, and kept in the other."""
    drives = {drive for drive, _ in one} & {drive for drive, _ in other}
    return [
        (key, first.get(key), second.get(key))
        for first, second in ((one, other), (other, one))
        for key, said in first.items()
        if isinstance(said, frozenset) and key[0] in drives and key not in second
    ]


@pytest.mark.parametrize(("name", "way", "seed"), [*product(WORLDS, WAYS, SEEDS)])
def test_a_recording_that_is_written_in_another_way_has_the_same_verdicts(name, way, seed):
    anew = WAYS[way](read(name), random.Random(seed))
    rules, then = book_of(name, seed), before(name, seed)
    now = judged(anew.recording, rules, anew.was, anew.later_s)
    assert {key: said for key, said in now.items() if "*" not in key[0]} == then
    # In the copy of the world, all goes on once more
    there = {key for key in now if "*" in key[0]}
    assert not there or there == {(f"{drive}*", rule) for drive, rule in then}


@pytest.mark.parametrize(("name", "less", "seed"), [*product(WORLDS, TOLD_LESS, SEEDS)])
def test_where_less_is_said_nothing_is_the_opposite(name, less, seed):
    worse = TOLD_LESS[less](read(name), random.Random(seed))
    assert opposites(before(name, seed), judged(worse, book_of(name, seed))) == []


@pytest.mark.parametrize("name", WORLDS)
def test_where_less_is_known_exactly_nothing_is_the_opposite(name):
    thresholds = rulec.Thresholds(place_error_m=0.5, speed_error_mps=0.4)
    now = judged(read(name), book_of(name, 0), thresholds=thresholds)
    assert opposites(before(name, 0), now) == []


@pytest.mark.parametrize("name", WORLDS)
def test_what_is_sure_is_so_whatever_is_true_of_the_unknown(name):
    """By the defaults of what is unknown, which may be true, a violation is one as well."""
    now, then = judged(read(name), book_of(name, 0), defaults=True), before(name, 0)
    sure = {key for key, said in then.items() if isinstance(said, frozenset)}
    assert {key for key in sure if not isinstance(now.get(key), frozenset)} == set()
    assert sure


@pytest.mark.parametrize("name", WORLDS)
def test_one_who_is_asked_for_alone_has_the_same_verdict(name):
    then = before(name, 0)
    for ego in sorted({drive for drive, _ in then})[::5]:
        now = judged(read(name), book_of(name, 0), egos=(ego,))
        assert now == {key: said for key, said in then.items() if key[0] == ego}


@pytest.mark.parametrize("name", WORLDS)
def test_something_is_violated_kept_and_open(name):
    """Where nothing is decided, nothing can be the opposite."""
    then = before(name, 0)
    kinds = [type(said) for said in then.values()]
    assert kinds.count(frozenset) >= 3
    assert kinds.count(str) >= 3
    drives = {drive for drive, _ in then}
    assert len(drives) * len(book_of(name, 0).rules) > len(then) + 100
