"""``rulec maneuvers``: the maneuvers of a scenario, judged by a rulebook."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import click

import rulec
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import scenario_options
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.verb_class import gathered, option, verb
from rulec.cli.output import (
    answer_lines,
    errors_told,
    print_written,
    read_machines,
    rulebooks_named,
)
from rulec.diagnostics import SourceLocation
from rulec.diagnostics.fault_messages import contained
from rulec.recordings.recording_inputs import InputFiles, input_files
from rulec.report.findings.diagnostics_text import print_diagnostics
from rulec.report.text.console import page_width, print_remark


@dataclass(frozen=True, slots=True)
class ManeuverQuestions:
    """The questions about a scenario's maneuvers besides their numbers."""

    n_listed: int | None = shared.number_option(
        "--list",
        "List the N cheapest satisfying maneuvers.",
    )
    n_ranked: int | None = shared.number_option(
        "--rank",
        "List the N best maneuvers: ranked by what they violate (hard rules before soft "
        "ones, by level and weight), then by cost.",
    )
    why: bool = option(
        "--why",
        is_flag=True,
        help="Show for every rule how many maneuvers violate it, how many violate no other hard "
        "rule, and an example; of listed maneuvers why each rule is open.",
    )
    n_classes: int | None = shared.number_option(
        "--classes",
        "Count the homotopy classes, and list the cheapest satisfying maneuver of N of them.",
    )
    worlds: bool = option(
        "--worlds",
        is_flag=True,
        help="If obstacles have several predictions, also count the maneuvers that remain when one "
        "of them does something less likely.",
    )

    def answered(self, maneuvers: lazy.Maneuvers, form: str) -> lazy.ManeuverAnswers:
        """The answers; in JSON also those that text gives only for several predictions."""
        listed = None if self.n_listed is None else maneuvers.cheapest(self.n_listed, perhaps=True)
        best = None
        if not maneuvers.satisfying + maneuvers.open and self.n_ranked is None:
            with errors_told():
                best = maneuvers.best()
        ranked = None if self.n_ranked is None else maneuvers.ranked(self.n_ranked)
        shown = [*(listed or ()), *(rank.maneuver for rank in (*(best or ()), *(ranked or ())))]
        driven = _driven(maneuvers, shown)
        uncertain = any(obstacle.alternatives for obstacle in maneuvers.graph.scenario.obstacles)
        uncertain = uncertain or (self.worlds and form == "json")
        classes = None
        if self.n_classes is not None:
            classes = (maneuvers.classes(), maneuvers.variants(self.n_classes))
        judged = None
        if maneuvers.words is not None:
            judged = [own.rule.name for own in maneuvers.rule_outcomes() if own.judged]
        return lazy.ManeuverAnswers(
            judged=judged,
            listed=listed,
            best=best,
            ranked=ranked,
            chances=_chances(maneuvers, shown) if uncertain else {},
            verdicts={maneuver.nodes: maneuvers.verdict(maneuver) for maneuver in listed or ()}
            if maneuvers.in_doubt
            else {},
            worlds=lazy.alternative_counts(maneuvers) if self.worlds else None,
            prunings=maneuvers.prunings() if self.why else None,
            classes=classes,
            driven=driven,
            lawful=0 if driven is None else sum(_is_open(maneuvers, x) for x in driven.lawful),
        )


@verb
def command(
    *,
    scenarios: tuple[str, ...] = scenario_options.scenarios_argument,
    cut: scenario_options.SceneOptions = scenario_options.cell_options,
    rulebooks: tuple[str, ...] = shared.rulebooks_option(
        shared.RULEBOOK_HELP + " May be given several times, for counts side by side."
    ),
    questions: ManeuverQuestions = gathered(ManeuverQuestions),
    after: Path | None = option(
        "--after",
        metavar="FILE",
        type=click.Path(dir_okay=False),
        callback=shared.beside,
        help="The past to continue from: a file with one trace, or a saved monitor (.json).",
    ),
    missing: scenario_options.ReadingOptions = scenario_options.reading_options,
    strict: bool = option(
        "--strict",
        is_flag=True,
        help="Exit with 1 if no maneuver certainly satisfies every hard rule.",
    ),
    to: Output = output_options(endings_of("text", "json"), "the answer"),
    at: str = shared.at_option,
) -> int:
    """Count the maneuvers of each SCENARIO (a name or a file) that satisfy every hard rule.

    If none does, the least violating ones are shown. A folder stands for all recordings in it, at
    any depth, and a pattern such as `*.xml` for all files that match. For several scenarios or
    rulebooks a table follows at the end; JSON has one line each.

    With --after, maneuvers continue a past whose last state lies one step before the scenario
    begins. What the past already violates is reported, and not counted against the maneuvers.

    Where values are unknown, a maneuver is satisfying if it satisfies the rules whatever those
    values are, and open if it does for some of them. The list contains both; ranking assumes the
    worst.

    Exit status: 0 each scenario has a satisfying or open maneuver, 1 some scenario has none, 2 a
    scenario could not be evaluated, or no hard rule could be judged.
    """
    begin = time.perf_counter()
    books = rulebooks_named(rulebooks)
    inputs = _inputs(scenarios)
    several = len(books) * len(inputs.paths) > 1
    machines = [read_machines(book, at) for book in dict.fromkeys(books)]
    past = None
    if after is not None:
        past = lazy.read_past(after)
    counts: list[lazy.ManeuverCounts] = []
    failed = False
    for problem in inputs.problems:
        print_diagnostics(problem.diagnostics)
    with answer_lines(to) as write:
        for path, rules in product(inputs.paths, machines):
            place = SourceLocation(path)
            with errors_told() if several else nullcontext(), contained("not evaluated", place):
                reading = missing.reading(rules.vocabulary)
                scene = cut.scene(path)
                maneuvers = rulec.find_maneuvers(scene, rules, after=past, **reading, **cut.cells())
                shown = questions.answered(maneuvers, to.form)
                seconds = time.perf_counter() - begin
                begin += seconds
                write(_shown(maneuvers, shown, seconds, to.form, several=several))
                counts.append(lazy.ManeuverCounts.of(path, maneuvers))
                failed |= not (maneuvers.satisfying + (0 if strict else maneuvers.open))
        if not counts:
            # Raised so that no file is written.
            raise click.exceptions.Exit(ExitStatus.NOT_ANSWERED)
        if several and to.form == "text":
            write(lazy.maneuver_report.counts_as_text(counts, page_width()))
    print_written(to.path, to)
    answered = len(counts) == len(inputs.paths) * len(machines) and not inputs.problems
    return ExitStatus.after(
        answered=answered and all(count.is_judged for count in counts), failed=failed
    )


def _inputs(scenarios: Sequence[str]) -> InputFiles:
    """The scenarios given by names, files, folders and patterns."""
    known = lazy.available_scenarios()
    inputs_of_each = [
        InputFiles((name,)) if name in known else input_files([name])
        for name in dict.fromkeys(scenarios)
    ]
    for searched in (folder for inputs in inputs_of_each for folder in inputs.searched):
        print_remark(f"rulec: {searched.in_words}")
    return InputFiles(
        tuple(dict.fromkeys(path for inputs in inputs_of_each for path in inputs.paths)),
        problems=tuple(problem for inputs in inputs_of_each for problem in inputs.problems),
    )


def _shown(
    maneuvers: lazy.Maneuvers,
    answers: lazy.ManeuverAnswers,
    seconds: float,
    form: str,
    *,
    several: bool,
) -> str:
    if form == "json":
        return lazy.maneuver_json.as_json(maneuvers, answers, seconds)
    return lazy.maneuver_report.as_text(maneuvers, answers, seconds, page_width()) + (
        "\n" if several else ""
    )


def _driven(
    maneuvers: lazy.Maneuvers, shown: Sequence[lazy.Maneuver]
) -> lazy.TrajectoryScores | None:
    """The verdicts on the trajectories of maneuvers in a recorded scene."""
    if maneuvers.words is None:
        return None
    try:
        with contained("verdicts on trajectories"):
            return lazy.trajectory_scores(maneuvers, shown)
    except rulec.RulecError as error:
        print_diagnostics(error.diagnostics)
        return None


def _is_open(maneuvers: lazy.Maneuvers, nodes: tuple[int, ...]) -> bool:
    """Whether a maneuver, of which a trajectory is lawful, is not free."""
    if not maneuvers.satisfying:
        return True
    return not maneuvers.verdict(lazy.Maneuver(nodes, 0.0, None)).satisfied


def _chances(
    maneuvers: lazy.Maneuvers, shown: Iterable[lazy.Maneuver]
) -> dict[tuple[int, ...], lazy.RuleProbabilities]:
    return {maneuver.nodes: lazy.rule_probabilities(maneuvers, maneuver) for maneuver in shown}
