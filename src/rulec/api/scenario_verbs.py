"""Verbs about scenarios: navigation graph, maneuvers, envelopes, pictures."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from rulec.api import lazy_imports as lazy
from rulec.api.session_settings import SessionSettings
from rulec.garbage_collection import no_garbage_collection
from rulec.trace import Trace
from rulec.trace.plain_unknowns import with_plain_unknowns
from rulec.trace.trace_model import all_traces, check_trace

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rulec.api.rulebook_compilation import Rules
    from rulec.monitoring.assumptions import Assumptions
    from rulec.partition import Envelope, GraphOptions, NavigationGraph
    from rulec.planning import Maneuvers
    from rulec.planning.probability.rule_probability import AlternativeCounts, RuleProbabilities
    from rulec.planning.ranking.cheapest import Maneuver
    from rulec.planning.trace_history import Before
    from rulec.recordings.recording import Recording
    from rulec.scenario import Choice, Scenario
    from rulec.scoring.scores import Scores

PictureFormat = Literal["svg", "png", "html"]


class ScenarioVerbs(SessionSettings):
    """The verbs of a session that are about scenarios and pictures."""

    def load_scenario(
        self, reference: str | Path | Recording, choice: Choice | None = None
    ) -> Scenario:
        """Load a scenario by name or path, or make one of a recording.

        ``choice`` is for recorded scenes.
        """
        if isinstance(reference, str | Path):
            return lazy.load_scenario(reference, choice)
        return lazy.scene_of(reference, choice or lazy.Choice(), Path(reference.name))

    @no_garbage_collection()
    def navigation_graph(
        self, scenario: str | Path | Scenario, **options: Unpack[GraphOptions]
    ) -> NavigationGraph:
        """A scenario as cells and successors over time. Raises RulecError."""
        scene = self.load_scenario(scenario) if isinstance(scenario, str | Path) else scenario
        return lazy.navigation_graph(scene, **options)

    @no_garbage_collection()
    def find_maneuvers(
        self,
        scenario: str | Path | Scenario,
        rules: Rules,
        *,
        after: Before | None = None,
        assumptions: Assumptions | None = None,
        told_only: bool = False,
        **options: Unpack[GraphOptions],
    ) -> Maneuvers:
        """Count the maneuvers that keep every hard rule, without enumerating them.

        ``after`` is the past, up to one step before the scenario begins: a trace, a ``Monitor``, or
        its snapshot. The default ``partition`` is the one whose relations the rules read.
        ``assumptions`` are values for what is unknown or missing in the scenario; other missing
        values have their defaults, or with ``told_only`` are unknown. A recorded scene is mirrored
        if its side of traffic is not that of the rules. Source: algorithm 1 of the paper. Raises
        RulecError.
        """
        reading = lazy.SceneReading(assumptions or lazy.Assumptions(), told_only)
        compiled = self._compiled(rules)
        lazy.check_assumed(reading.assumptions.values, compiled.vocabulary, "values")
        options["partition"] = lazy.partition_for(compiled, options.get("partition"))
        scene = self.load_scenario(scenario) if isinstance(scenario, str | Path) else scenario
        if scene.account is not None:
            scene = lazy.on_side_of(compiled, scene)
        graph = self.navigation_graph(scene, **options)
        account, words = graph.scenario.account, None
        # As in the paper, its relations come from the cells, not from the recording
        is_papers = graph.partition == "paper" or graph.bounds is None
        if account is not None and account.origin is not None and not is_papers:
            words = lazy.cell_words(graph, compiled)
        return lazy.evaluate(graph, compiled, after, reading, words)

    def envelope(self, graph: NavigationGraph, nodes: Sequence[int]) -> Sequence[Envelope]:
        """The bounds of a maneuver by layer. Raises RulecError R0609 if ``nodes`` is not a path."""
        return lazy.envelope(graph, tuple(nodes))

    def envelopes(self, maneuvers: Maneuvers, n: int = 1) -> tuple[Sequence[Envelope], ...]:
        """The envelopes of the ``n`` cheapest maneuvers that are satisfying or open."""
        cheapest = maneuvers.cheapest(n, perhaps=True)
        return tuple(self.envelope(maneuvers.graph, maneuver.nodes) for maneuver in cheapest)

    def score_trajectories(self, maneuvers: Maneuvers, listed: Sequence[Maneuver]) -> Scores:
        """Score the trajectories of maneuvers in a recorded scene, as ``score`` does with samples.

        The world is the recording at the scene's beginning, with ego's past. Candidates are the
        ``listed`` maneuvers, in their order.

        Raises:
            RulecError: R0781 if a maneuver has no trajectory, or the scene is not recorded; R0507
                for rules compiled for another step than the recording's.
        """
        return lazy.score_trajectories(maneuvers, tuple(listed))

    def traces(
        self,
        scenario: str | Path | Scenario,
        rules: Rules | None = None,
        *,
        limit: int = 10_000_000,
        **options: Unpack[GraphOptions],
    ) -> Iterator[Trace]:
        """Generate a scenario's maneuvers lazily as traces, in the rules' vocabulary."""
        if limit < 0:
            raise ValueError(f"`limit` is how many are wanted at most, not {limit}")
        scene = self.load_scenario(scenario) if isinstance(scenario, str | Path) else scenario
        if rules is None:
            options.setdefault("partition", "paper")
            graph = self.navigation_graph(scene, **options).trace_graph()
        else:
            graph = self.find_maneuvers(scene, rules, **options).paths
        return map(with_plain_unknowns, all_traces(graph, scene.name, min(limit, sys.maxsize)))

    def rule_probabilities(self, maneuvers: Maneuvers, maneuver: Maneuver) -> RuleProbabilities:
        """The probability that a maneuver keeps each rule, over the obstacles' predictions."""
        return lazy.rule_probabilities(maneuvers, maneuver)

    def alternative_counts(self, maneuvers: Maneuvers) -> tuple[AlternativeCounts, ...]:
        """Counts of maneuvers for each less likely prediction of an obstacle."""
        return tuple(lazy.alternative_counts(maneuvers))

    def draw(
        self,
        subject: NavigationGraph | Maneuvers | Trace,
        rules: Rules | None = None,
        *,
        maneuver: Maneuver | None = None,
        as_graph: bool = False,
        form: PictureFormat = "svg",
    ) -> bytes:
        """Draw a scene over time, a navigation graph, or a judged trace.

        A trace needs the ``rules`` that judge it. ``maneuver`` is the one to show, by default the
        cheapest if ``subject`` is ``Maneuvers``; ``as_graph`` draws the navigation graph instead of
        the scene. PNG requires the extra ``pictures``. Returns the content of a file.
        """
        if isinstance(subject, Trace):
            check_trace(subject)
            if rules is None:
                raise TypeError("drawing a trace needs the rules that judge it")
            used = self._compiled(rules).fitted_to(subject.step_s)
            return lazy.picture_formats.as_bytes(
                lazy.pictures.trace_drawing(subject, used), form, subject.id
            )
        draw = lazy.pictures.graph_drawing if as_graph else lazy.pictures.scene_drawing
        if isinstance(subject, lazy.NavigationGraph):
            drawing = draw(subject, None, maneuver)
        else:
            if maneuver is None:
                maneuver = next(iter(subject.cheapest(1, perhaps=True)), None)
            drawing = draw(subject.graph, subject, maneuver)
        return lazy.picture_formats.as_bytes(drawing, form, drawing.title)
