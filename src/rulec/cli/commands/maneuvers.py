"""``rulec maneuvers``: the maneuvers of a scenario, judged by a rulebook."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import click

import rulec
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import scenario_options
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.output import errors_told, put_answer, read_machines


@click.command()
@scenario_options.graph_options
@shared.rulebook_option()
@shared.number_option("--list", "n_listed", "List the N cheapest satisfying maneuvers.")
@shared.number_option(
    "--rank",
    "n_ranked",
    "List the N best maneuvers: by what they violate, hard rules above soft ones, by "
    "levels and weights; then by cost.",
)
@click.option(
    "--why",
    is_flag=True,
    help="Say for every rule how many maneuvers violate it, how many violate no other hard rule, "
    "and give an example.",
)
@shared.number_option(
    "--classes",
    "n_classes",
    "Count the homotopy classes, and list the cheapest satisfying maneuver of N of them.",
)
@click.option(
    "--worlds",
    is_flag=True,
    help="Where obstacles have several predictions: count also what is left if one of them does "
    "something less likely.",
)
@shared.file_option(
    "--after",
    "What was before: a file with one trace, or a monitor that was saved (.json).",
)
@scenario_options.reading_options
@click.option(
    "--strict", is_flag=True, help="Exit with 1 if no maneuver keeps every hard rule for sure."
)
@output_options(endings_of("text", "json"), "the answer")
@shared.at_option
def command(
    scenario: str,
    rulebook: str,
    n_listed: int | None,
    n_ranked: int | None,
    why: bool,
    n_classes: int | None,
    worlds: bool,
    after: Path | None,
    strict: bool,
    to: Output,
    at: str,
    **options: Any,
) -> int:
    """Count the maneuvers of SCENARIO (a name or a file) that satisfy every hard rule.

    If none does, the least violating ones are shown.

    With --after they go on where a past has ended: its last state comes one step before the
    scenario begins. What was violated for good by then is said, and not counted against them.

    Where not all is known, those that keep them whatever that may be are satisfying, and those that
    may keep them open; the list has both, and ranks suppose the worst.

    Exit status: 0 there is a satisfying or an open maneuver, 1 there is none, 2 it could not be
    answered, or no hard rule be judged.
    """
    # Maneuvers, 130 ms: not for --help.
    from rulec.planning.probability.rule_probability import alternative_counts, rule_probabilities
    from rulec.planning.trace_history import read_past
    from rulec.report.maneuvers.maneuver_report import ManeuverAnswers, as_text

    begin = time.perf_counter()
    rules = read_machines(rulebook, at)
    past = None if after is None else read_past(after)
    reading = scenario_options.scene_reading(options, rules.vocabulary)
    scene = scenario_options.read_scene(scenario, options)
    maneuvers = rulec.find_maneuvers(scene, rules, after=past, **reading, **options)
    listed = None if n_listed is None else maneuvers.cheapest(n_listed, perhaps=True)
    best = None
    legal = maneuvers.satisfying + maneuvers.open
    if not legal and n_ranked is None:
        with errors_told():
            best = maneuvers.best()
    ranked = None if n_ranked is None else maneuvers.ranked(n_ranked)
    shown = [*(listed or ()), *(rank.maneuver for rank in (*(best or ()), *(ranked or ())))]
    uncertain = any(obstacle.alternatives for obstacle in scene.obstacles)
    uncertain = uncertain or (worlds and to.form == "json")
    answers = ManeuverAnswers(
        listed=listed,
        best=best,
        ranked=ranked,
        chances={maneuver.nodes: rule_probabilities(maneuvers, maneuver) for maneuver in shown}
        if uncertain
        else {},
        verdicts={maneuver.nodes: maneuvers.verdict(maneuver) for maneuver in listed or ()}
        if maneuvers.in_doubt
        else {},
        worlds=alternative_counts(maneuvers) if worlds else None,
        prunings=maneuvers.prunings() if why else None,
        classes=None if n_classes is None else (maneuvers.classes(), maneuvers.variants(n_classes)),
    )
    seconds = time.perf_counter() - begin
    if to.form == "json":
        # Its types take 2 ms to make, for which a text need not wait.
        from rulec.report.maneuvers.maneuver_json import as_json

        put_answer(as_json(maneuvers, answers, seconds), to)
    else:
        put_answer(as_text(maneuvers, answers, seconds), to)
    kept = maneuvers.satisfying if strict else legal
    return ExitStatus.after(answered=maneuvers.judges, failed=not kept)
