"""Counts of maneuvers and further answers as a text report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import floor, prod
from typing import TYPE_CHECKING, Any

from rulec.diagnostics import first_of, named
from rulec.monitoring.verdict import Verdict, Violation
from rulec.partition import COMFORTABLE, NavigationGraph
from rulec.planning import Maneuvers, RankedManeuver, RulePruning
from rulec.planning.ranking.cheapest import Maneuver
from rulec.planning.ranking.homotopy import HomotopyClasses, Variant
from rulec.report.maneuvers import maneuver_blocks
from rulec.report.text.console import PAGE_WIDTH
from rulec.report.text.terminal_text import (
    cut,
    mirrored,
    shown_count,
    stacked_tables,
    styled,
    table_lines,
    visible,
)
from rulec.report.verdicts.verdict_report import about
from rulec.scenario import Account, Scenario

if TYPE_CHECKING:
    from rulec.planning.probability.rule_probability import AlternativeCounts, RuleProbabilities
    from rulec.scoring.maneuver_trajectories import TrajectoryScores

MOST_VIOLATIONS = 6
"""Number of past violations named as text; JSON has all of them."""

MOST_UNKNOWN = 1
"""Number of unknown names and of rules not judged that are listed; JSON has all of them."""

MOST_DEFAULTS = 4
"""Number of names listed in a line; JSON has all of them."""


@dataclass(frozen=True, slots=True)
class ManeuverAnswers:
    """Answers to further questions about maneuvers; None if not asked.

    ``best`` are the least violating maneuvers, set if none satisfies every hard rule and ``ranked``
    does not list them already. ``chances`` and ``verdicts`` map a maneuver's nodes to its
    probabilities and its verdict; the latter only if some values are unknown. ``judged`` are the
    names of the rules that can be judged from the words of cells; None if cells have no words.
    ``driven`` are the scores of the trajectories of all maneuvers shown, and of further ways that
    ego may drive, and ``lawful`` the number of those tried that are lawful, but not free.
    """

    judged: Sequence[str] | None = None
    listed: Sequence[Maneuver] | None = None
    best: Sequence[RankedManeuver] | None = None
    ranked: Sequence[RankedManeuver] | None = None
    prunings: Sequence[RulePruning] | None = None
    classes: tuple[HomotopyClasses, Sequence[Variant]] | None = None
    chances: Mapping[tuple[int, ...], RuleProbabilities] = field(default_factory=dict)
    verdicts: Mapping[tuple[int, ...], Verdict] = field(default_factory=dict)
    worlds: Sequence[AlternativeCounts] | None = None
    driven: TrajectoryScores | None = None
    lawful: int = 0


def horizon_s(graph: NavigationGraph) -> float:
    """Time from the start of the first layer to the start of the last one, in seconds."""
    return float((len(graph.layers) - 1) * graph.step)


def likeliest(scenario: Scenario) -> float:
    """The probability that every obstacle follows its likeliest prediction."""
    return float(prod((obstacle.weight for obstacle in scenario.obstacles), start=Fraction(1)))


def derived_signals(maneuvers: Maneuvers, account: Account) -> dict[str, tuple[Any, str]]:
    """Signals of the whole scene, each with value and reason; empty if its cells have words."""
    if maneuvers.words is not None:
        return {}
    supplied = maneuvers.paths.states[0][0]
    return {
        name: (supplied[name], because)
        for name, because in account.derived.items()
        if name in supplied
    }


@dataclass(frozen=True, slots=True)
class HardBraking:
    """The least braking (m/s²) of every maneuver; ``later``: or of what it leaves to be done."""

    least: float
    later: bool


def hard_braking(maneuvers: Maneuvers, answers: ManeuverAnswers) -> HardBraking | None:
    """How hard every maneuver brakes, if one shown brakes hard and all have to, or have later."""
    shown = [*(answers.listed or ())]
    shown += [maneuver.maneuver for maneuver in (*(answers.best or ()), *(answers.ranked or ()))]
    driven = [maneuver.trajectory for maneuver in shown if maneuver.trajectory is not None]
    if all(trajectory.greatest_braking <= COMFORTABLE for trajectory in driven):
        return None
    if (least := maneuvers.least_braking) is not None:
        return HardBraking(least, later=False)
    later = maneuvers.least_braking_later
    return None if later is None else HardBraking(later, later=True)


def lists_none(maneuvers: Maneuvers, answers: ManeuverAnswers) -> bool:
    """Whether a list is empty only because no trajectory was found along any maneuver."""
    is_bare = answers.listed is not None and not answers.listed
    return is_bare and bool(maneuvers.satisfying or maneuvers.open)


def as_text(
    maneuvers: Maneuvers, answers: ManeuverAnswers, seconds: float, width: int = PAGE_WIDTH
) -> str:
    """Write the counts, and a block for each maneuver requested."""
    graph, rules = maneuvers.graph, maneuvers.rules
    dark = {rule.rule for rule in maneuvers.not_judged}
    hard_rules = [rule.name for rule in rules.rules if rule.strength == "hard"]
    names = ", ".join(name for name in hard_rules if name not in dark)
    by = f"{rules.name} ({names or 'no hard rules'})" if len(names) <= 60 else rules.name
    satisfying = f"{styled(shown_count(maneuvers.satisfying), 'bold')} by {by}"
    if not maneuvers.judges:
        satisfying = f"not known: no hard rule of {rules.name} can be judged"
    horizon = f"{horizon_s(graph):g} s in steps of {graph.step_s:g} s"
    how = f"partition {graph.partition}, adjacency {graph.adjacency}"
    how += f", extent {graph.extent}" if graph.extent != "lane" else ""
    defaults = first_of(maneuvers.by_default, MOST_DEFAULTS)
    by_default = f"by default  {defaults}: the scenario does not say"
    lines = [
        f"scenario    {graph.scenario.name}: {horizon}, {how}",
        *_scene(maneuvers),
        f"graph       {graph.nodes:,} nodes, {graph.edges:,} edges",
        f"maneuvers   {_paths(maneuvers)}",
        *_shut_in(maneuvers),
        *_judged(maneuvers, answers),
        f"satisfying  {satisfying}",
        *_without_rules(maneuvers),
        *_doubts(maneuvers),
        *_violated_before(maneuvers.violated_before or ()),
        *([visible(by_default)] if maneuvers.by_default else []),
        *_predictions(graph.scenario),
        *map(_world, answers.worlds or ()),
    ]
    if answers.classes is not None:
        lines += _class_counts(maneuvers, answers.classes[0])
    hard = hard_braking(maneuvers, answers)
    if hard is not None:
        # Rounded up, it would be more than what is proved
        shown = floor(10 * hard.least) / 10
        later = f", or has to after {horizon_s(graph):g} s for what is ahead then"
        lines.append(
            f"emergency   every maneuver brakes by more than {shown:.1f} m/s²"
            + (later if hard.later else "")
        )
    lines += maneuver_blocks.driven_counts(answers.driven)
    lines.append(f"computed in {seconds:.3f} s")
    if lists_none(maneuvers, answers):
        lines.append("listed      none: no trajectory was found along those that cost least")
        if maneuvers.in_way:
            lines.append(visible(f"in the way  {first_of(maneuvers.in_way, MOST_DEFAULTS)}"))
        if maneuvers.in_way and graph.extent != "body":
            lines.append("opened by   `--extent body`, perhaps: it leaves more room")
    lines = [line for text in lines for line in maneuver_blocks.wrapped(text, width)]
    layout = maneuver_blocks.BlockLayout(width, reasons=answers.prunings is not None)
    shown_verdicts = maneuver_blocks.ShownVerdicts(answers.verdicts, answers.driven, layout)
    for number, maneuver in enumerate(answers.listed or (), 1):
        lines += maneuver_blocks.listed_block(maneuvers, number, maneuver, shown_verdicts)
        lines += _chances(answers, maneuver)
    if answers.best:
        lines += ["", "Every maneuver violates a hard rule. No other violates less than:"]
    for ranked_maneuver in (*(answers.best or ()), *(answers.ranked or ())):
        lines += maneuver_blocks.ranked_block(maneuvers, ranked_maneuver, shown_verdicts)
        lines += _chances(answers, ranked_maneuver.maneuver)
    if answers.prunings is not None:
        lines += ["", *maneuver_blocks.pruning_lines(maneuvers, answers.prunings, width)]
    if answers.classes is not None:
        for number, variant in enumerate(answers.classes[1], 1):
            members = f"{shown_count(variant.members)} satisfying members"
            remark = f"; class of {'1 member' if variant.members == 1 else members}"
            lines += maneuver_blocks.maneuver_block(
                graph, number, variant.cheapest, layout, remark=remark
            )
    return "\n".join(lines)


def _paths(maneuvers: Maneuvers) -> str:
    """The number of maneuvers, and the kind of cells they go through."""
    paths = "path" if maneuvers.traces == 1 else "paths"
    cells = "cells" if maneuvers.graph.bounds is None else "reachable cells"
    return f"{shown_count(maneuvers.traces)} {paths} through {cells}"


def _judged(maneuvers: Maneuvers, answers: ManeuverAnswers) -> Iterator[str]:
    """The number of rules that can be judged from the words of cells."""
    if answers.judged is not None and maneuvers.traces:
        n_rules = len(maneuvers.rules.rules)
        every = f"{len(answers.judged)} of {n_rules} judged"
        fewer = n_rules - len(answers.judged) - len(maneuvers.not_judged)
        on_fewer = f", {fewer} on fewer" if fewer > 0 else ""
        yield f"rules       {every} on half of the maneuvers or more{on_fewer}"


def _doubts(maneuvers: Maneuvers) -> Iterator[str]:
    """The lines about open maneuvers, unknown values and rules not judged."""
    if maneuvers.in_doubt and maneuvers.judges:
        yield f"violating   {styled(shown_count(maneuvers.violating), 'bold')}"
        fewer = "" if maneuvers.exact else ", or fewer: there were too many cases to examine"
        yield f"open        {styled(shown_count(maneuvers.open), 'bold')}{fewer}"
    if maneuvers.unknown:
        names = first_of(maneuvers.unknown, MOST_UNKNOWN)
        yield visible(f"unknown     {names}: not, or not exactly, known")
    if maneuvers.doubtful_past:
        names = first_of(maneuvers.doubtful_past, MOST_DEFAULTS)
        yield visible(f"unknown     what was before, for {names}")
    if maneuvers.not_judged:
        dark = first_of([rule.rule for rule in maneuvers.not_judged], MOST_UNKNOWN)
        number = f"{len(maneuvers.not_judged)} of {len(maneuvers.rules.rules)} rules"
        yield visible(f"not judged  {number}, for lack of words: {dark}")


def _scene(maneuvers: Maneuvers) -> Iterator[str]:
    account = maneuvers.graph.scenario.account
    if account is None:
        return
    kept = account.recorded - account.left_out
    out = f", {account.left_out} left out: not on this road" if account.left_out else ""
    if account.mirrored:
        yield f"mirrored    {mirrored(maneuvers.rules.traffic)}"
    yield f"obstacles   {kept} on the road of lanelet {account.reference}{out}"
    if float(len(maneuvers.graph.layers) * maneuvers.graph.step) > account.until_s:
        yield (
            f"recorded    until {max(account.until_s, 0):g} s; participants present then are "
            "assumed to keep their last speed"
        )
    for name, (value, because) in derived_signals(maneuvers, account).items():
        shown = str(value).lower() if isinstance(value, bool) else value
        yield visible(f"derived     {name} = {shown}: {because}")
    for remark in account.remarks:
        yield visible(f"note        {remark}")


def _shut_in(maneuvers: Maneuvers) -> Iterator[str]:
    """The reason why there is no maneuver at all."""
    graph, end = maneuvers.graph, maneuvers.dead_end
    if end is None:
        return
    within = "" if graph.bounds is None else " within the bounds of ego's motion"
    if end.layer == len(graph.layers) - 1:
        yield f"            no way leads to the goal by the end{within}"
    else:
        low, high = (f"{(end.layer + more) * graph.step_s:g} s" for more in (0, 1))
        yield f"            none leads on from between {low} and {high}{within}"
        if end.closed_by:
            names = first_of(end.closed_by, MOST_DEFAULTS)
            sweep = "it sweeps" if len(end.closed_by) == 1 else "they sweep"
            yield visible(f"closed by   {names}: in steps of {graph.step_s:g} s {sweep} its lanes")
    ways = " or ".join(f"`{option}`" for option in end.opened_by)
    longer = "longer horizon, " if end.layer == len(graph.layers) - 1 else ""
    yield f"opened by   {ways or f'no {longer}shorter step, narrower extent or other adjacency'}"


def _without_rules(maneuvers: Maneuvers) -> Iterator[str]:
    """The hard rules without which there would be a satisfying maneuver, if there is none."""
    if not maneuvers.traces or maneuvers.satisfying or maneuvers.open or not maneuvers.judges:
        return
    counts = maneuvers.without_each_rule()
    if counts:
        # Where words are unknown, what violates no other rule may still be open.
        more = "more" if maneuvers.perhaps is maneuvers.hard else "more, perhaps"
        shown = [f"{name} ({shown_count(count)} {more})" for name, count in counts.items()]
        yield visible(f"opened by   a softer {first_of(shown, MOST_DEFAULTS)}")
    else:
        yield "opened by   no single softer rule: each maneuver violates two or more"


def _violated_before(violations: Sequence[Violation]) -> Iterator[str]:
    for violation in violations[:MOST_VIOLATIONS]:
        what = f"{violation.rule}{about(violation.binding)}"
        yield visible(f"violated    {what}, before, and not counted any more")
    if len(violations) > MOST_VIOLATIONS:
        yield f"            and {len(violations) - MOST_VIOLATIONS:,} more; --json has them all"


def _predictions(scenario: Scenario) -> Iterator[str]:
    several = [obstacle for obstacle in scenario.obstacles if obstacle.alternatives]
    if several:
        obstacles = "1 obstacle has" if len(several) == 1 else f"{len(several)} obstacles have"
        probability = likeliest(scenario)
        how = f"the likeliest world is counted, with probability {probability:.4g}"
        yield f"predictions {obstacles} several; {how}"


def _world(world: AlternativeCounts) -> str:
    return visible(
        f"otherwise   {world.obstacle}, prediction {world.number + 1} "
        f"({maneuver_blocks.shown_chance(world.weight)}): {shown_count(world.traces)} maneuvers, "
        f"{shown_count(world.satisfying)} satisfying"
        + (f", {shown_count(world.open)} open" if world.open else "")
    )


def _class_counts(maneuvers: Maneuvers, classes: HomotopyClasses) -> Iterator[str]:
    satisfying, total = shown_count(classes.satisfying), shown_count(classes.total)
    doubtful = f", {shown_count(classes.open)} more open" if classes.open else ""
    yield f"classes     {satisfying} of {total} satisfying{doubtful}"
    if classes.divided:
        counting = [rule.name for rule in maneuvers.counting_steps()]
        why = f": {named(counting)} {'counts' if len(counting) == 1 else 'count'} steps"
        yield (
            f"            {shown_count(classes.divided)} of these depending on how long one stays"
            f"{why if counting else ''}"
        )


def _chances(answers: ManeuverAnswers, maneuver: Maneuver) -> list[str]:
    chances = answers.chances.get(maneuver.nodes)
    return [] if chances is None else maneuver_blocks.chance_lines(chances)


@dataclass(frozen=True, slots=True)
class ManeuverCounts:
    """A scenario's counts by one rulebook; ``is_judged``: a hard rule could be judged."""

    scenario: str
    rulebook: str
    maneuvers: int
    satisfying: int
    open: int
    violating: int
    is_judged: bool

    @classmethod
    def of(cls, scenario: str, maneuvers: Maneuvers) -> ManeuverCounts:
        """The counts of maneuvers; ``scenario`` is its name on the command line."""
        return cls(
            scenario=scenario,
            rulebook=maneuvers.rules.name,
            maneuvers=maneuvers.traces,
            satisfying=maneuvers.satisfying,
            open=maneuvers.open,
            violating=maneuvers.violating,
            is_judged=maneuvers.judges,
        )


def counts_as_text(counts: Sequence[ManeuverCounts], width: int = PAGE_WIDTH) -> str:
    """A table with a row for each scenario and rulebook."""
    rows = [("scenario", "by", "maneuvers", "satisfying", "open", "violating")]
    for count in counts:
        numbers = (count.satisfying, count.open, count.violating)
        cells = map(shown_count, numbers) if count.is_judged else ["not judged"] * len(numbers)
        rows.append(
            (visible(count.scenario), visible(count.rulebook), shown_count(count.maneuvers), *cells)
        )
    too_wide = max(map(len, table_lines(rows, right=range(2, 6)))) - width
    longest = max(len(row[0]) for row in rows)
    rows = [(cut(row[0], longest - max(too_wide, 0)), *row[1:]) for row in rows]
    if too_wide < longest:
        return "\n".join(table_lines(rows, right=range(2, 6), ruled=[0]))
    return "\n".join(stacked_tables(rows, width, ruled=[0]))
