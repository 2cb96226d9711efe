"""Every word of a vocabulary, in the cells of recordings, holds for random drives through them."""

import random
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from rulec import Choice, RulecError, compile_rulebook, load_scenario, navigation_graph
from rulec.cell_words import cell_words
from rulec.extraction.recording_verdicts import names_read
from rulec.recordings.recording_files import read_recording
from support.builders.recorded_data import RECORDINGS
from support.generators.driven_motions import paths_of
from support.generators.motion_kinds import KINDS, of_a_kind
from support.oracles.witness_drives import (
    contradicting,
    drives_of,
    in_layers,
    on_an_edge,
    states_of,
)

FOLDERS = (RECORDINGS, RECORDINGS.with_name("commonroad_more"))
FILES = sorted(file for folder in FOLDERS for file in folder.glob("*.xml"))
NAMES = {file.stem: file for file in FILES}

ONCE_WRONG = [
    ("USA_Peach-2_1_T-1", "464", 1.5, 1.0),  # marked_lanes, lateral: lanes that part
    ("USA_Peach-3_1_T-1", "415", 0.0, 0.2),  # gap: a line that leads back for a hand
    ("DEU_Flensburg-35_1_T-1", "325", 3.0, 1.0),  # lateral: the next lane comes another way
    ("DEU_Flensburg-35_1_T-1", "323", 1.6, 0.2),  # lateral: it comes from another road
    ("DEU_AAH-4_2002_T-1", "268", 4.96, 0.2),  # enters_junction: of the next lane
]
MOTIONS = 60
TRIED = 4
"""So many times as many motions are tried at most."""


@pytest.fixture(scope="module", params=["de", "us-ca"])
def rules(request):
    """A rulebook of which all words are asked for."""
    own = replace(compile_rulebook(request.param))
    own.prepared[names_read] = frozenset(own.vocabulary.declarations)
    return own


def contradictions(scene, step_s, rules, chance):
    """What cells of a scene say that random drives through them contradict, and how many were."""
    graph = navigation_graph(scene, partition="fine", step_s=step_s, horizon_s=4.0)
    words = cell_words(graph, rules)
    paths = SimpleNamespace(states=words.states)
    found = SimpleNamespace(graph=graph, rules=rules, paths=paths)
    state_s, count = states_of(found)
    every, driven = round(step_s / state_s), []
    for _ in range(TRIED * MOTIONS):
        kind = chance.choice(KINDS)
        motion = np.array(of_a_kind(kind, scene, graph.bounds, state_s, count, chance))
        cells = paths_of(graph, motion[::every].tolist()) or [()]
        if all(len(own) == 1 for own in cells) and len(driven) < MOTIONS:
            driven.append((tuple(next(iter(own)) for own in cells), motion))
    wrong, number = [], 0
    drives = drives_of(found, [motion for _, motion in driven]) if driven else ()
    for (nodes, motion), drive in zip(driven, drives, strict=True):
        trace = drive and in_layers(found, drive)
        if trace and not on_an_edge(found, nodes, motion):
            wrong += contradicting(found, nodes, trace)
            number += 1
    return wrong, number


@pytest.mark.skipif(not FILES, reason="CommonRoad's scenarios are not here")
@pytest.mark.parametrize(
    ("name", "ego", "at_s", "step_s"),
    [*ONCE_WRONG[:1], *(pytest.param(*own, marks=pytest.mark.long) for own in ONCE_WRONG[1:])],
)
def test_what_was_told_wrong_once(rules, name, ego, at_s, step_s):
    if name not in NAMES:
        pytest.skip("this one is not here")
    scene = load_scenario(NAMES[name], Choice(ego=ego, at_s=at_s))
    wrong, number = contradictions(scene, step_s, rules, random.Random(name))
    assert wrong == []
    assert number > MOTIONS / 2


@pytest.mark.long
@pytest.mark.skipif(not FILES, reason="CommonRoad's scenarios are not here")
@pytest.mark.parametrize("file", FILES or [""], ids=lambda file: getattr(file, "stem", ""))
def test_words_of_random_egos(rules, file):
    recording, chance = read_recording(file), random.Random(f"{file} {rules.name}")
    driving = [own for own in recording.participants if not own.standing and len(own.states) > 5]
    for ego in chance.sample(driving, min(len(driving), 3)):
        steps = sorted(ego.states)
        at_s = chance.choice(steps[: 1 + len(steps) // 2]) * recording.step_s
        for step_s in (0.2, 0.5, 1.0):
            per_state = step_s / recording.step_s
            if abs(per_state - round(per_state)) < 1e-6 <= per_state:
                try:
                    scene = load_scenario(file, Choice(ego=ego.id, at_s=at_s))
                except RulecError:
                    continue  # It is a walker, or goes back along its lanes there
                assert contradictions(scene, step_s, rules, chance)[0] == [], (ego.id, at_s, step_s)
