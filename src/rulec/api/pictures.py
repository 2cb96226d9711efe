"""Drawings of scenes, navigation graphs, traces and recorded drives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import SourceLocation
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.partition import NavigationGraph
from rulec.planning import Maneuvers
from rulec.planning.product.graph_product import accepted_edges, explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.ranking.cheapest import Maneuver
from rulec.recordings.recording_messages import NOT_IN_RECORDING
from rulec.report.pictures.drawing.picture_formats import Drawing
from rulec.report.pictures.drives.drive_page import drive_page
from rulec.report.pictures.drives.drive_picture import chosen_moment, drive_entries, drive_picture
from rulec.report.pictures.drives.scene_of_drive import drive_scene
from rulec.report.pictures.graph_picture import graph_picture
from rulec.report.pictures.picture_captions import (
    graph_title,
    legend,
    scene_title,
    trace_title,
)
from rulec.report.pictures.scene_picture import scene_legend, scene_pictures
from rulec.report.pictures.trace_picture import ribbon_entries, ribbon_picture
from rulec.report.pictures.trace_ribbon import ribbon
from rulec.trace import Trace


def trace_drawing(
    trace: Trace,
    rules: CompiledRulebook,
    objects: Sequence[str] = (),
    patterns: Sequence[str] = (),
    *,
    every_row: bool = False,
) -> Drawing:
    """Draw the values that violated rules read over time, or ``every_row``. Raises RulecError.

    ``objects`` are the objects to show, all if empty; ``patterns`` selected the rules, for the
    title.
    """
    verdict = verify(trace, rules)
    shown = ribbon(trace, rules, verdict, objects, every_row=every_row)
    title = trace_title(replace(verdict, violations=shown.violations), rules, (*patterns, *objects))
    return Drawing(title, [ribbon_picture(shown, rules)], legend(ribbon_entries(shown), []))


def drive_drawing(
    verdicts: RecordingVerdicts,
    trace: str = "",
    kept: frozenset[str] | None = None,
    at_s: float | None = None,
) -> Drawing:
    """Draw a judged drive from above, at the first violation or at a time (s of the recording).

    ``trace`` names the drive; if empty it is the one with the earliest violation of the rules
    ``kept`` (None: of any rule). Raises RulecError: R0612 if there is no such drive, or it has no
    state at that time.
    """
    drive, verdict = _chosen_drive(verdicts, trace, kept)
    scene = drive_scene(drive, verdict, verdicts, kept)
    first_s, last_s = scene.time_s(0), scene.time_s(scene.states - 1)
    if at_s is not None and not first_s - scene.step_s < at_s < last_s + scene.step_s:
        message = f"`{drive.arrays.id}` has no state at {at_s:g} s"
        way_out = f"choose a time from {first_s:g} s to {last_s:g} s"
        raise NOT_IN_RECORDING.error(SourceLocation(verdicts.recording.name), message, help=way_out)
    state, violation = chosen_moment(scene, at_s)
    picture = drive_picture(scene, state, violation)
    return Drawing(
        scene.title,
        [picture],
        legend(drive_entries(scene, violation, picture), []),
        page=partial(drive_page, scene, state, violation),
    )


def _chosen_drive(
    verdicts: RecordingVerdicts, trace: str, kept: frozenset[str] | None
) -> tuple[Drive, Verdict]:
    first: tuple[Drive, Verdict] | None = None
    first_s = math.inf
    why = "nobody in this recording drives on a lane"
    for answer in verdicts.answers():
        if isinstance(answer, NoDrive):
            why = f"`{answer.ego}` has no drive: {answer.why}"
            continue
        if isinstance(answer.answer, NotJudged):
            raise answer.answer.error
        judged = answer.drive, answer.answer
        if trace and trace == answer.drive.arrays.id:
            return judged
        times = (
            answer.drive.time_s(violation.step)
            for violation in answer.answer.violations
            if kept is None or violation.rule in kept
        )
        violated_s = min(times, default=math.inf)
        if first is None or violated_s < first_s:
            first, first_s = judged, violated_s
    if first is None or trace:
        message = why if first is None else f"there is no drive `{trace}`"
        raise NOT_IN_RECORDING.error(SourceLocation(verdicts.recording.name), message)
    return first


def scene_drawing(
    graph: NavigationGraph,
    maneuvers: Maneuvers | None = None,
    maneuver: Maneuver | None = None,
    layers: Sequence[int] = (),
    number: int = 1,
) -> Drawing:
    """Draw a scene over time, or some of its layers."""
    chosen = sorted(set(layers)) or range(len(graph.layers))
    title = scene_title(graph, maneuvers, maneuver, number)
    return Drawing(title, scene_pictures(graph, chosen, maneuver), scene_legend(graph, maneuver))


def graph_drawing(
    graph: NavigationGraph, maneuvers: Maneuvers | None = None, maneuver: Maneuver | None = None
) -> Drawing:
    """Draw a navigation graph, layer by layer, with a maneuver."""
    hard = maneuvers.hard if maneuvers else node_transformers(graph.trace_graph(), ())
    product = maneuvers.product if maneuvers else explore(hard)
    edges = accepted_edges(hard, product)
    picture = graph_picture(graph, edges, maneuver, judged=maneuvers is not None)
    return Drawing(graph_title(graph, maneuvers, product.accepted), [picture])
