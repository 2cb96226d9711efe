"""Recorded scenes whose traffic keeps to the other side than a rulebook's: their mirror images."""

from __future__ import annotations

from dataclasses import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code
from rulec.extraction.selection import RequestedDrives, chosen_side
from rulec.extraction.tracks.mirror import mirrored_recording
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
    account = scene.account
    if account is None or account.source is None:
        return scene
    source = account.source
    side, is_other = chosen_side(source.recording, RequestedDrives(), rules.traffic)
    if not is_other:
        return scene
    if scene != _read_again(source, scene, mirrored=account.mirrored):
        raise changed_scene(source.file, str(source.recording.side), rules.name, side)
    image = replace(source, recording=mirrored_recording(source.recording))
    return _read_again(image, scene, mirrored=not account.mirrored)


def _read_again(source: SceneSource, scene: Scenario, *, mirrored: bool) -> Scenario:
    """The scene that a source gives, with the step and the horizon of another scene."""
    read = seen_from_ego(source.recording, source.choice, source.file)
    assert read.account is not None  # it is a recorded scene
    account = replace(read.account, mirrored=mirrored)
    return replace(read, account=account, horizon_s=scene.horizon_s, step_s=scene.step_s)


CHANGED_SCENE = Code("R0418")


def changed_scene(file: str, recorded: str, rulebook: str, side: str) -> RulecError:
    """A changed scene, recorded on one side, for a rulebook of the other one."""
    return CHANGED_SCENE.error(
        SourceLocation(file),
        f"traffic keeps to the {recorded} here, and in `{rulebook}` to the {side}, and the scene "
        "was changed after it was read from its recording: it cannot be mirrored",
        help=f"change the recording instead, or use a rulebook of traffic that keeps to the "
        f"{recorded}",
    )
