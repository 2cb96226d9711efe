"""The past of a trace graph: a trace or monitor before its first layer."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice
from pathlib import Path
from typing import Any, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import RulecError, SourceLocation
from rulec.logic.bounds import PAST, operations_of
from rulec.logic.printing import number_in_words
from rulec.monitoring.online.monitor_sources import read_saved, replay_trace
from rulec.monitoring.online.running_monitor import RunningMonitor
from rulec.monitoring.state_validation import check_objects
from rulec.monitoring.verdict import CarriedState
from rulec.planning.planning_messages import UNFITTING_PAST
from rulec.planning.product.possible_instances import HARD
from rulec.rulebook.rulebook_model import Strength
from rulec.trace import Trace, TraceGraph
from rulec.trace.formats.trace_files import read_traces
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.vocabulary_model import choices


@dataclass(frozen=True, slots=True)
class SavedPast:
    """A monitor's snapshot, and the file that it was read from."""

    saved: Mapping[str, Any]
    place: SourceLocation


Before: TypeAlias = Trace | RunningMonitor | Mapping[str, Any] | SavedPast
"""A trace, a monitor that has taken one, or that monitor's snapshot."""


def past_of(
    graph: TraceGraph,
    before: Before,
    rulebook: CompiledRulebook,
    step_s: Fraction,
    strengths: Collection[Strength] = HARD,
) -> CarriedState:
    """The rules' state when a graph with this step begins, after the last state of ``before``.

    Raises RulecError: R0501 to R0508 if a trace does not fit the rulebook, R0510 if a snapshot is
    not of these rules, R0511 if ``before`` does not lead up to the graph.
    """
    check_objects(graph.objects, rulebook.vocabulary)
    monitor, place = _monitor(before, rulebook, step_s, strengths)
    there = {
        name: kind
        for name, kind in graph.objects.items()
        if name not in graph.present or graph.present[name][0] == 0
    }
    try:
        past = monitor.past(there)
    except ValueError:
        message = "it is unknown what happened before the first state of the past"
        way_out = "give a complete past: one without states before its first one"
        raise UNFITTING_PAST.error(place, message, help=way_out) from None
    violations = [own for own in past.violations if own.strength in strengths]
    past = replace(past, violations=tuple(violations))
    if isinstance(before, Trace) and before.ends == "cut":
        rules = [rule for rule in rulebook.rules if rule.strength in strengths]
        return _begun_before(past, rules, there, rulebook.vocabulary)
    return past


def _begun_before(
    past: CarriedState,
    rules: Iterable[CompiledRule],
    objects: Mapping[str, str],
    vocabulary: Vocabulary,
) -> CarriedState:
    """The past if its own beginning was not seen: rules that look back may be in any state."""
    looking_back = {
        rule.name: rule
        for rule in rules
        if any(operation.operator in PAST for operation in operations_of(rule.formula))
    }
    anywhere = {
        (name, items): frozenset(range(len(rule.machine.successors)))
        for name, rule in looking_back.items()
        for items in choices([each.type for each in rule.variables], objects, vocabulary)
    }
    known = [own for own in past.violations if own.rule not in looking_back]
    return replace(
        past,
        settled=past.settled - anywhere.keys(),
        violations=tuple(known),
        possible={**past.possible, **anywhere},
        perhaps_settled=past.perhaps_settled.union(anywhere),
    )


def read_past(path: Path) -> Before:
    """Read the one trace of a file, or a monitor's snapshot. Raises RulecError."""
    if path.suffix == ".json":
        return SavedPast(read_saved(path), SourceLocation(str(path)))
    return only_trace(read_traces(path), SourceLocation(str(path)))


def only_trace(items: Iterable[Trace | RulecError], place: SourceLocation) -> Trace:
    """The only trace of a file. Raises its error if it is invalid, R0511 if there are several."""
    traces = []
    for trace in islice(items, 2):
        if isinstance(trace, RulecError):
            raise trace
        traces.append(trace)
    if len(traces) > 1:
        raise UNFITTING_PAST.error(
            place,
            "there are several traces in this file, but a past is one trace",
            help="give a file with one trace",
        )
    return traces[0]


def _monitor(
    before: Before, rulebook: CompiledRulebook, step_s: Fraction, strengths: Collection[Strength]
) -> tuple[RunningMonitor, SourceLocation | None]:
    rules = tuple(rule for rule in rulebook.rules if rule.strength in strengths)
    if isinstance(before, Trace):
        if exact_step(before.step_s) != step_s:
            raise _no_way(
                f"the past has steps of {number_in_words(exact_step(before.step_s))} s, "
                f"the scenario's future of {number_in_words(step_s)} s",
                before.place,
            )
        return replay_trace(before, replace(rulebook, rules=rules)), before.place
    if isinstance(before, SavedPast):
        return RunningMonitor.restore(rulebook, before.saved, before.place), before.place
    if not isinstance(before, RunningMonitor):
        return RunningMonitor.restore(rulebook, before), None
    known = {rule.name: rule.machine for rule in before.rulebook.rules}
    if any(known.get(rule.name) != rule.machine for rule in rules):
        raise _no_way(f"the past was judged by other rules than those of `{rulebook.name}`", None)
    return before, None


def _no_way(message: str, place: SourceLocation | None) -> RulecError:
    way_out = "give a past that ends one step before the scenario begins, with the same objects"
    return UNFITTING_PAST.error(place, message, help=way_out)
