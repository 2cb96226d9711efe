"""Single maneuvers as text: cells, violations, probabilities, and what prunes them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction
from itertools import groupby
from operator import itemgetter
from typing import TYPE_CHECKING

from rulec.diagnostics import first_of
from rulec.logic.printing import number_in_words
from rulec.monitoring.verdict import OpenVerdict, Verdict, Violation
from rulec.partition import Cell, NavigationGraph, envelope
from rulec.planning import Maneuvers, RankedManeuver, RulePruning
from rulec.planning.planning_messages import MOST_WORLDS
from rulec.planning.ranking.cheapest import Maneuver
from rulec.planning.ranking.penalties import PenaltyRank
from rulec.report.text.console import PAGE_WIDTH
from rulec.report.text.terminal_text import broken, counted, cut, shown_count, table_lines, visible
from rulec.report.verdicts.verdict_report import about, open_in_words
from rulec.rulebook.rulebook_model import cited_law

if TYPE_CHECKING:
    from rulec.partition.motion.witness_trajectory import WitnessTrajectory
    from rulec.planning.probability.rule_probability import RuleProbabilities, RuleProbability
    from rulec.scoring.maneuver_trajectories import TrajectoryScores

# Numbers of items shown as text; JSON has all of them.
MOST_BINDINGS = 3
MOST_NAMED = 6
MOST_VIOLATIONS = 20
MOST_REASONS = 3

LEAST_LABEL = 16
"""Characters of a cell's relations that are shown, however narrow the page."""

_LABEL = re.compile(r"[a-z]+(?: [a-z]+)* {2,}")
"""The label of a line, such as ``not judged  ``."""

_LEAST_SHOWN = 0.005
"""Parts of a cost below this value are not shown."""


@dataclass(frozen=True, slots=True)
class BlockLayout:
    """The width of a page in characters, and whether all open verdicts have their ``reasons``."""

    width: int = PAGE_WIDTH
    reasons: bool = False


def maneuver_block(
    graph: NavigationGraph,
    number: int,
    maneuver: Maneuver,
    layout: BlockLayout,
    *,
    remark: str = "",
    details: Sequence[str] = (),
) -> list[str]:
    """A maneuver's cost and margin with a remark, details, and its cells with their bounds."""
    margin_s = maneuver.margin_s
    margin = "never changes cell" if margin_s is None else f"margin {margin_s:g} s"
    rows = [
        (
            f"{layer.start_s:g} s",
            _label(layer.cells[index]),
            f"s {_metres(bounds.s_min)} … {_metres(bounds.s_max)} m",
            (
                f"d {_metres(min(d for _, d in bounds.d_right))} … "
                f"{_metres(max(d for _, d in bounds.d_left))} m"
            ),
        )
        for layer, index, bounds in zip(
            graph.layers, maneuver.nodes, envelope(graph, maneuver.nodes), strict=True
        )
    ]
    head = f"{number}. cost {maneuver.cost:.4g}{_cost_parts(maneuver)}{margin}{remark}"
    driven = [] if maneuver.trajectory is None else [_driven(maneuver.trajectory)]
    too_wide = max(map(len, table_lines(rows, indent="   "))) - layout.width
    if too_wide > 0:
        widest = max(max(len(label) for _, label, _, _ in rows) - too_wide, LEAST_LABEL)
        # The surface is mostly the same
        named = [label.partition(" ")[2] or label for _, label, _, _ in rows]
        rows = [
            (row[0], cut(label, widest), *row[2:]) for row, label in zip(rows, named, strict=True)
        ]
    lines = [line for text in (head, *driven, *details) for line in wrapped(text, layout.width)]
    return ["", *lines, *table_lines(rows, indent="   ")]


def wrapped(text: str, width: int) -> list[str]:
    """A line of a report, wrapped: below its label, if it has one, or else a bit further in."""
    label = _LABEL.match(text)
    indent = len(text) - len(text.lstrip(" "))
    return broken(text, width, later=" " * (len(label[0]) if label else indent + 2))


def _metres(number: float) -> str:
    """A coordinate (m), to the centimetre."""
    return f"{round(number, 2) + 0.0:g}"


def _cost_parts(maneuver: Maneuver) -> str:
    """The unit of the cost, or the parts of a trajectory's cost, the largest first."""
    if maneuver.trajectory is None:
        return " 1/s, "
    parts = {"changes": maneuver.changes or 0.0, **asdict(maneuver.trajectory.cost)}
    shown = sorted((-value, name) for name, value in parts.items() if value >= _LEAST_SHOWN)
    sums = " + ".join(f"{name} {-value:.2g}" for value, name in shown)
    return f" = {sums}; " if sums else "; "


def _driven(trajectory: WitnessTrajectory) -> str:
    """The greatest acceleration and braking of the witness trajectory, its speeds and its end."""
    # Rounding may leave a speed a hair below zero
    _, s, speed, d, _ = (round(number, 3) + 0.0 for number in trajectory.states[-1])
    least = min(speed for _, _, speed, _, _ in trajectory.states)
    slowest = "" if least >= min(trajectory.states[0][2], speed) - 0.1 else f", least {least:.1f}"
    return (
        f"   drivable: accelerates by at most {trajectory.greatest_acceleration:.1f} m/s², brakes "
        f"by {trajectory.greatest_braking:.1f}; from {trajectory.states[0][2]:.1f} to {speed:.1f} "
        f"m/s{slowest}; ends at s {s:.0f} m, d {d:.1f} m"
    )


@dataclass(frozen=True, slots=True)
class ShownVerdicts:
    """The verdicts on maneuvers by their nodes, those on their trajectories, and the layout."""

    verdicts: Mapping[tuple[int, ...], Verdict]
    driven: TrajectoryScores | None
    layout: BlockLayout


def listed_block(
    maneuvers: Maneuvers,
    number: int,
    maneuver: Maneuver,
    shown: ShownVerdicts,
) -> list[str]:
    """A maneuver of a list, with the verdict on its trajectory and its own open verdicts."""
    verdict = shown.verdicts.get(maneuver.nodes)
    doubtful = () if verdict is None else verdict.open
    remark = "; open" if any(open_verdict.strength == "hard" for open_verdict in doubtful) else ""
    details = _as_driven(maneuver, shown.driven)
    if not details or shown.layout.reasons:
        # Its trajectory is undecided only on rules that it puts to the test
        details += _open_lines(maneuvers, doubtful, shown.layout)
    return maneuver_block(
        maneuvers.graph, number, maneuver, shown.layout, remark=remark, details=details
    )


def driven_counts(driven: TrajectoryScores | None) -> list[str]:
    """How many of the trajectories keep every hard rule whose trigger they meet, or why none."""
    if driven is None:
        return []
    silent = dict.fromkeys(rule for own in driven.tested.values() for rule in own.not_judged)
    why = "a trajectory keeps each hard rule put to the test"
    if driven.lawful and silent:
        why = f"keep all put to the test but {first_of([*silent], MOST_NAMED)}, not judged"
    elif not driven.lawful:
        hard = (
            x.rule for own in driven.of.values() for x in own.violations if x.strength == "hard"
        )
        broken = list(dict.fromkeys(hard))
        undecided = [rule for tested in driven.tested.values() for rule in tested.undecided]
        others = [rule for rule in dict.fromkeys(undecided) if rule not in broken]
        parts = [f"violated {first_of(broken, MOST_NAMED)}"] if broken else []
        parts += [f"undecided on {first_of(others, MOST_NAMED)}"] if others else []
        why = "; ".join(parts) or "no hard rule is put to the test"
    return [visible(f"lawful      {len(driven.lawful)} of {driven.n_tried} tried: {why}")]


def _as_driven(maneuver: Maneuver, driven: TrajectoryScores | None) -> list[str]:
    """The verdict on a maneuver's trajectory, if it has one."""
    score = None if driven is None else driven.of.get(maneuver.nodes)
    if driven is None or score is None:
        return []
    parts = []
    if score.off_road:
        parts.append("leaves the road")
    violated = [
        f"{'soft ' if violation.strength == 'soft' else ''}{violation.rule}"
        + about(violation.binding)
        + ("" if violation.step is None else f" from {driven.time_s(violation.step):g} s on")
        for violation in score.violations
    ]
    if violated:
        parts.append(f"violates {first_of(violated, MOST_NAMED)}")
    tested = driven.tested[maneuver.nodes]
    if tested.undecided:
        parts.append(f"undecided on {first_of(tested.undecided, MOST_NAMED)}")
    if maneuver.nodes in driven.lawful_as_driven:
        parts.insert(0, "lawful")
    elif maneuver.nodes in driven.lawful:
        parts.append("another way through its cells is lawful")
    if tested.kept:
        parts.append(f"keeps {counted(len(tested.kept), 'hard rule')} put to the test")
    until = f" until {driven.until_s:g} s" if driven.is_cut else ""
    return [visible(f"   trajectory{until}: {'; '.join(parts)}")]


def _open_lines(
    maneuvers: Maneuvers, doubtful: Sequence[OpenVerdict], layout: BlockLayout
) -> list[str]:
    """The open verdicts with their reasons; of more than a few only how many each rule has."""
    if len(doubtful) > MOST_REASONS and not layout.reasons:
        numbers = Counter(open_verdict.rule for open_verdict in doubtful)
        shown = [f"{rule} ({number})" if number > 1 else rule for rule, number in numbers.items()]
        return [f"   open: {first_of(shown, MOST_REASONS)}; --why has the reasons"]
    lines = [
        f"   {visible(f'{_rule_title(maneuvers, open_verdict)}: {open_in_words(open_verdict)}')}"
        for open_verdict in doubtful[:MOST_VIOLATIONS]
    ]
    if len(doubtful) > MOST_VIOLATIONS:
        lines.append(f"   and {len(doubtful) - MOST_VIOLATIONS} more open")
    return lines


def ranked_block(maneuvers: Maneuvers, ranked: RankedManeuver, shown: ShownVerdicts) -> list[str]:
    """A ranked maneuver with the verdict on its trajectory, and its own violations."""
    surely = "surely " if ranked.open else ""
    same = f"; {shown_count(ranked.members)} {surely}violate the same" if ranked.members > 1 else ""
    penalty = _penalty(ranked.penalty)
    if ranked.open:
        penalty = f"at most {penalty}, at least {_penalty(ranked.at_least)}"
    details = [*_as_driven(ranked.maneuver, shown.driven), f"   violates {penalty}"]
    details += [
        f"     {_violation_line(maneuvers, violation)}"
        for violation in ranked.violations[:MOST_VIOLATIONS]
    ]
    if len(ranked.violations) > MOST_VIOLATIONS:
        details.append(f"     and {len(ranked.violations) - MOST_VIOLATIONS} more")
    details += [f"  {line}" for line in _open_lines(maneuvers, ranked.open, shown.layout)]
    return maneuver_block(
        maneuvers.graph, ranked.place, ranked.maneuver, shown.layout, remark=same, details=details
    )


def _penalty(penalty: Mapping[PenaltyRank, Fraction]) -> str:
    parts = [
        f"{rank.strength} {' = '.join(level or '(no level)' for level in rank.levels)} "
        f"{number_in_words(weight)}"
        for rank, weight in penalty.items()
    ]
    return ", ".join(parts) or "no rule"


def _violation_line(maneuvers: Maneuvers, violation: Violation) -> str:
    return f"{_rule_title(maneuvers, violation)}: {_when_lost(maneuvers, violation)}"


def _rule_title(maneuvers: Maneuvers, finding: Violation | OpenVerdict) -> str:
    rule = next(rule for rule in maneuvers.rules.rules if rule.name == finding.rule)
    law = cited_law(rule.cite, rule.inherited_from)
    cite = f" [{law}]" if law else ""
    return visible(f"{rule.strength} rule {rule.name}{cite}{about(finding.binding)}")


def _when_lost(maneuvers: Maneuvers, violation: Violation) -> str:
    """The time from which the rule can no longer be kept."""
    if violation.step is None:
        return "by how it ends"
    return f"cannot be kept any more from {maneuvers.graph.layers[violation.step].start_s:g} s on"


def chance_lines(chances: RuleProbabilities) -> list[str]:
    """The probabilities of a maneuver, a line each; rules kept for certain are omitted."""
    rows = [
        ("nobody hits ego", shown_chance(chances.clear)),
        ("every hard rule", shown_chance(chances.hard, chances.hard_at_most)),
    ]
    rows += [(rule.rule.name, _of_rule(rule)) for rule in chances.rules if rule.kept != 1]
    return table_lines(rows, indent="   ")


def _of_rule(rule_probability: RuleProbability) -> str:
    if rule_probability.kept is None:
        return f"not known: more than {MOST_WORLDS:,} worlds make a difference"
    bindings = rule_probability.bindings
    parts = [
        visible(f"{shown_chance(binding.kept, binding.at_most)}{about(binding.binding)}")
        for binding in bindings[:MOST_BINDINGS]
    ]
    if len(bindings) > MOST_BINDINGS:
        parts.append(f"and for {len(bindings) - MOST_BINDINGS:,} more")
    return "; ".join([shown_chance(rule_probability.kept, rule_probability.at_most), *parts])


def shown_chance(number: Fraction | None, at_most: Fraction | None = None) -> str:
    """A probability as text, or its bounds."""
    if number is None:
        return "not known"
    above = "" if at_most in (None, number) else f" … {float(at_most or 0):.4g}"
    return f"{float(number):.4g}{above}"


def pruning_lines(maneuvers: Maneuvers, prunings: Sequence[RulePruning], width: int) -> list[str]:
    """A table of the rules that exclude maneuvers, and the names of the other rules.

    An example that does not fit beside its rule stands below it.
    """
    some_open = any(pruning.open for pruning in prunings)
    rows = [("rule", "violated by", "alone by", *(["open"] if some_open else []), "for example")]
    rows += [
        (
            pruning.rule.name,
            shown_count(pruning.violating),
            "soft" if pruning.alone is None else shown_count(pruning.alone),
            *([shown_count(pruning.open)] if some_open else []),
            _example(maneuvers, pruning) if pruning.example else "",
        )
        for pruning in prunings
        if pruning.violating or pruning.open
    ]
    right = (1, 2, 3) if some_open else (1, 2)
    lines = table_lines(rows, right=right) if len(rows) > 1 else []
    if any(len(line) > width for line in lines):
        narrow = table_lines([row[:-1] for row in rows], right=right)
        lines = narrow[:1]
        for line, row in zip(narrow[1:], rows[1:], strict=True):
            example = broken(f"for example {row[-1]}", width, "  ", "    ") if row[-1] else []
            lines += [line, *example]
    not_judged = {rule.rule for rule in maneuvers.not_judged}
    idle = [
        pruning.rule.name
        for pruning in prunings
        if not (pruning.violating or pruning.open or pruning.rule.name in not_judged)
    ]
    text = f"violated by none: {', '.join(idle)}"
    return [*lines, *broken(text, width, later="  ")] if idle else lines


def _example(maneuvers: Maneuvers, pruning: RulePruning) -> str:
    """The times at which an example's relations to the objects, or its surface, change."""
    assert pruning.example is not None, "something violates it"
    first = pruning.violations[0]
    labels = [
        (f"{layer.start_s:g} s", _label(layer.cells[index], first.binding.values()))
        for layer, index in zip(maneuvers.graph.layers, pruning.example.nodes, strict=True)
    ]
    changes = [next(group) for _, group in groupby(labels, key=itemgetter(1))]
    return f"{', '.join(map(' '.join, changes))}; {_when_lost(maneuvers, first)}"


def _label(cell: Cell, objects: Collection[str] | None = None) -> str:
    """The surface, and the relations to some objects, or to all if ``objects`` is None."""
    signature: Mapping[str, str | tuple[str, str]] = cell.signature
    if objects is not None:
        signature = {name: signature[name] for name in objects if name in signature}
    # Those in ego's own lane first
    relations = sorted(signature.items(), key=lambda item: "same_lane" not in item[1])
    named = [
        f"{relation if isinstance(relation, str) else ' '.join(relation)}({visible(name)})"
        for name, relation in relations[:MOST_NAMED]
    ]
    if len(signature) > MOST_NAMED:
        named.append(f"and {len(signature) - MOST_NAMED} more")
    return " ".join([cell.surface, *named])
