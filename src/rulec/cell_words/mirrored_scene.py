"""Recorded scenes whose traffic keeps to the other side than a rulebook's: their mirror images."""

from __future__ import annotations

from dataclasses import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.cell_words.cell_messages import changed_scene
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.recordings.recording import Recording
from rulec.scenario import Scenario
from rulec.scenario.recorded.recorded_scene import seen_from_ego
from rulec.scenario.scenario_model import SceneSource


def on_side_of(rules: CompiledRulebook, scene: Scenario) -> Scenario:
    """The scene, mirrored if its recording is of traffic that keeps to the other side.

    Coordinates are then those of the mirror image: ``d`` is positive to the right of what was
    recorded. A mirrored scene is mirrored back.

    Raises RulecError R0418 for a scene that is to be mirrored and is no longer what its recording
    gives, apart from step and horizon.
    """
    source = None if scene.account is None else scene.account.source
    if not isinstance(source, SceneSource):
        return scene
    recorded = source.recording.side
    if not rules.traffic or recorded in (None, rules.traffic):
        return scene
    was_mirrored = scene.account is not None and scene.account.mirrored
    if scene != _read_again(source.recording, scene, mirrored=was_mirrored):
        raise changed_scene(source.file, str(recorded), rules.name, rules.traffic)
    return _read_again(mirrored_recording(source.recording), scene, mirrored=not was_mirrored)


def _read_again(recording: Recording, scene: Scenario, *, mirrored: bool) -> Scenario:
    """The scene of a recording, with the step and the horizon of another scene."""
    assert scene.account is not None
    assert isinstance(scene.account.source, SceneSource)
    read = seen_from_ego(recording, scene.account.source.choice, scene.account.source.file)
    assert read.account is not None  # it is a recorded scene
    account = replace(read.account, mirrored=mirrored)
    return replace(read, account=account, horizon_s=scene.horizon_s, step_s=scene.step_s)
