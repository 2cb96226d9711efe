"""What must not matter to a verdict, on small worlds with meaning: `small_worlds` lists it."""

import os
from functools import cache
from random import Random

import numpy as np
import pytest

import rulec
from rulec.cli.main import main
from rulec.extraction.drives import Drive, Drives
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.recordings.mending.mended_recording import mended
from support.generators.odd_recordings import table
from support.generators.small_worlds import STEP_S, small_world
from support.rewriting.cut_short import contradictions, cut, steps_of
from support.rewriting.judged import judged
from support.rewriting.written_anew import WAYS

LONG = os.environ.get("RULEC_TEST_PROFILE") == "long"
BOOKS = ("de", "gb", "us-ca", "jp", "fr")
SEEDS = range(1000) if LONG else range(len(BOOKS))
MET = (1024, 2003, 2041)
"""Worlds on which faults were found."""


@cache
def book(seed):
    return rulec.compile_rulebook(BOOKS[seed % len(BOOKS)], step_s=STEP_S)


@cache
def world(seed):
    return small_world(Random(seed))


def said_of(recording, seed, **wanted):
    """What is said, or nothing where nobody drives."""
    try:
        return judged(recording, book(seed), **wanted)
    except rulec.RulecError as error:
        assert error.diagnostics[0].code == "R0612"  # noqa: PT017
        return {}


@cache
def whole(seed):
    return said_of(world(seed), seed)


def drivers(found):
    return sorted(
        {ego for (ego, rule), said in found.items() if not rule and not isinstance(said, str)}
    )


@pytest.mark.parametrize("seed", [*SEEDS, *MET])
def test_a_cut_only_opens_verdicts(seed):
    recording, pick = world(seed), Random(seed)
    first, last = steps_of(recording)
    for _ in range(4 if LONG else 1):
        until = pick.randrange(first + 1, last + 1)
        part = said_of(cut(recording, first, until), seed)
        assert contradictions(whole(seed), part, until * STEP_S) == []
        part = said_of(cut(recording, pick.randrange(first, last), last), seed)
        assert contradictions(whole(seed), part) == []


@pytest.mark.parametrize("seed", SEEDS)
def test_how_a_world_is_written_does_not_matter(seed):
    pick = Random(seed)
    way = pick.choice([way for way in WAYS if way != "in_pieces"])
    if whole(seed):
        anew = WAYS[way](world(seed), pick)
        now = judged(anew.recording, book(seed), anew.was, anew.later_s)
        assert {key: said for key, said in now.items() if "*" not in key[0]} == whole(seed)


@pytest.mark.parametrize("seed", SEEDS)
def test_each_drive_alone_equals_all_together(seed):
    for ego in drivers(whole(seed))[: None if LONG else 1]:
        own = {key: said for key, said in whole(seed).items() if key[0] == ego}
        assert said_of(world(seed), seed, egos=(ego,)) == own


@pytest.mark.parametrize("seed", SEEDS)
def test_a_future_is_scored_as_it_is_judged(seed):
    recording, pick = world(seed), Random(seed)
    egos = [body for body in recording.participants if len(body.states) > 3]
    own = pick.choice([body for body in egos if body.id in drivers(whole(seed))] or [None])
    if own is None:
        return
    steps = sorted(own.states)
    now = pick.choice(steps[1:-1])
    ahead = [own.states[step] for step in steps if step > now]
    future = np.array([(at.x, at.y, at.heading, at.speed) for at in ahead])
    live = rulec.TrafficWorld(recording, own.id, now_s=now * STEP_S)
    scored = rulec.score([future], live, book(seed), after=live.past)
    found = said_of(live.recording_of(future, live.past), seed, egos=(own.id,))
    counted = {rule: said for (_, rule), said in found.items() if rule}
    if scored.violated_before or scored.off_road[0]:
        return
    for rule in book(seed).rules:
        if any(x.rule == rule.name for x in scored.candidates[0].open_before):
            # What the past leaves open is no candidate's
            assert counted[rule.name] == "open"
            continue
        said = counted.get(rule.name, "kept")
        assert scored.outcomes(rule.name) == ["violated" if isinstance(said, frozenset) else said]


@pytest.mark.parametrize("seed", SEEDS)
def test_words_of_the_mirror_are_the_mirrors_words(seed):
    """Where numbers are rounded, the last digit may differ."""
    right = Drives(mended(world(seed)), "right")
    left = Drives(mended(mirrored_recording(world(seed))), "left")
    for ego in right.egos():
        for one, other in zip(right.of(ego), left.of(ego), strict=True):
            assert type(one) is type(other)
            if isinstance(one, Drive):
                for state, seen in zip(one.trace.states, other.trace.states, strict=True):
                    assert plain(in_a_mirror(state)) == plain(seen)


_MIRRORED = {"left_of": "right_of", "l": "r", "conflict_from_left": "conflict_from_right"}
_MIRRORED |= {other: one for one, other in _MIRRORED.items()}


def in_a_mirror(value):
    if isinstance(value, dict):
        return {_MIRRORED.get(name, name): in_a_mirror(inner) for name, inner in value.items()}
    return _MIRRORED.get(value, value) if isinstance(value, str) else value


def plain(state):
    """A state without its numbers."""
    if isinstance(state, dict):
        return {name: plain(inner) for name, inner in state.items()}
    return state if isinstance(state, bool | str) else type(state).__name__


def test_several_files_are_judged_as_each_alone(tmp_path, capsys):
    files = []
    for seed in range(3):
        folder = tmp_path / str(seed)
        folder.mkdir()
        files.append(str(table(folder, world(seed), Random(seed))))

    def lines(*of):
        main(["verify", *of, "-r", "gb", "--json"])
        return [line for line in capsys.readouterr().out.splitlines() if '"recording"' in line]

    assert lines(*files) == [line for file in files for line in lines(file)]
