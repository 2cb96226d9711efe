"""Snapshots of monitors: data that outlive the program."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, Literal

import msgspec

from rulec.automata.bundle.bundle_file import read_to_data
from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.json_problems import json_words
from rulec.monitoring.monitoring_messages import UNRESTORABLE_MONITOR
from rulec.monitoring.online.bound_rules import BoundRules
from rulec.monitoring.online.four_valued import FourValued, MonitorEdge
from rulec.monitoring.online.monitor_state import MonitorState, initial_state, nodes_at, state_at
from rulec.monitoring.online.rule_group import RuleGroups
from rulec.monitoring.state_validation import check_objects
from rulec.monitoring.verdict import Violation

FORMAT = "rulec monitor"
VERSION = 1


class _Header(msgspec.Struct):
    format: Literal["rulec monitor"]
    version: int


class _Binding(msgspec.Struct, forbid_unknown_fields=True):
    objects: tuple[str, ...]
    state: int
    verdict: FourValued


class _Rule(msgspec.Struct, forbid_unknown_fields=True):
    rule: str
    bindings: list[_Binding]


class _Violation(msgspec.Struct, forbid_unknown_fields=True):
    rule: str
    binding: dict[str, str]
    step: int | None


class SavedMonitor(msgspec.Struct, forbid_unknown_fields=True):
    """Saved monitor: its number of ``states``, and states by rule and binding."""

    format: str
    version: int
    rulebook: str
    machines: str
    step_s: str | None
    states: int
    objects: dict[str, str]
    rules: list[_Rule]
    violations: list[_Violation]


def to_data(
    current: MonitorState,
    number: int,
    rulebook: CompiledRulebook,
    step_s: Fraction | None,
    violations: Sequence[Violation],
) -> dict[str, Any]:
    """JSON data of a monitor after a state, for ``from_data``."""
    return {
        "format": FORMAT,
        "version": VERSION,
        "rulebook": rulebook.name,
        "machines": fingerprint(rulebook),
        "step_s": None if step_s is None else str(step_s),
        "states": number + 1,
        "objects": dict(current.bound_rules.objects),
        "rules": [
            {
                "rule": rule.prepared.name,
                "bindings": [
                    {"objects": list(items), "state": edge.state, "verdict": edge.verdict}
                    for items, edge in zip(rule.bindings, rule.edges(current.nodes), strict=True)
                ],
            }
            for rule in current.bound_rules.rules
        ],
        "violations": [
            {"rule": violation.rule, "binding": dict(violation.binding), "step": violation.step}
            for violation in violations
        ],
    }


def fingerprint(rulebook: CompiledRulebook) -> str:
    """Hash of all rules' machines and of everything that defines their reads."""
    rules = [
        {
            "name": rule.name,
            "strength": rule.strength,
            "variables": [(variable.name, variable.type) for variable in rule.variables],
            "step_s": None if rule.step_s is None else str(rule.step_s),
            "reads": [read_to_data(read) for read in rule.machine.reads],
            "letters": rule.machine.letters,
            "following": rule.machine.successors,
            "accepting": rule.machine.outputs,
        }
        for rule in rulebook.rules
    ]
    return hashlib.sha256(json.dumps(rules, sort_keys=True).encode()).hexdigest()


def from_data(
    data: Any, rulebook: CompiledRulebook, place: SourceLocation | None
) -> tuple[SavedMonitor, Fraction | None]:
    """A saved monitor, and its step (s).

    Raises RulecError R0510 if this is no saved monitor, one of another rulebook or damaged.
    """
    try:
        header = msgspec.convert(data, _Header)
    except msgspec.ValidationError as problem:
        raise _refused(f"this is not a saved monitor: {json_words(problem)}", place) from None
    if header.version != VERSION:
        raise _refused(
            f"this saved monitor is of version {header.version}; "
            f"this rulec reads version {VERSION}",
            place,
        )
    try:
        saved = msgspec.convert(data, SavedMonitor)
        step_s = None if saved.step_s is None else Fraction(saved.step_s)
    except (msgspec.ValidationError, ValueError, ZeroDivisionError) as problem:
        raise _refused(f"this saved monitor is damaged: {json_words(problem)}", place) from None
    if saved.machines != fingerprint(rulebook):
        whose = (
            f"an earlier or later `{rulebook.name}`"
            if saved.rulebook == rulebook.name
            else f"rulebook `{saved.rulebook}`, not of `{rulebook.name}`"
        )
        raise _refused(f"this monitor was saved with the rules of {whose}", place)
    if saved.states < 0 or (step_s is not None and step_s <= 0):
        raise _refused("this saved monitor is damaged", place)
    return saved, step_s


def restored(
    saved: SavedMonitor,
    rulebook: CompiledRulebook,
    groups: RuleGroups,
    place: SourceLocation | None,
) -> tuple[int, MonitorState, list[Violation]]:
    """Last state's number, monitor state and violations of a saved monitor.

    Raises RulecError R0510 if it is damaged.
    """
    try:
        check_objects(saved.objects, rulebook.vocabulary)
        bound_rules = BoundRules(rulebook, groups, saved.objects)
        if saved.states == 0 and not saved.objects and not saved.violations:
            return -1, initial_state(bound_rules), []
        edges = _edges(saved, bound_rules)
        rules = {rule.name: rule for rule in rulebook.rules}
        violations = [_violation(violation, saved.states, rules) for violation in saved.violations]
    except (LookupError, ValueError, RulecError):
        raise _refused("this saved monitor is damaged", place) from None
    violated_rules = {violation.rule for violation in violations}
    nodes = nodes_at(bound_rules, edges)
    current = state_at(bound_rules, nodes, violated_rules, len(violations))
    return saved.states - 1, current, violations


def _edges(saved: SavedMonitor, bound_rules: BoundRules) -> dict[str, list[MonitorEdge]]:
    """Edges of exactly these bindings. Raises LookupError or ValueError otherwise."""
    edges: dict[str, list[MonitorEdge]] = {}
    for bound_rule, rule in zip(bound_rules.rules, saved.rules, strict=True):
        prepared = bound_rule.prepared
        by_objects = {binding.objects: binding for binding in rule.bindings}
        if rule.rule != prepared.name or len(rule.bindings) != len(bound_rule.bindings):
            raise ValueError
        bindings = [by_objects[items] for items in bound_rule.bindings]
        edges[prepared.name] = [
            prepared.edges[binding.state, binding.verdict] for binding in bindings
        ]
    return edges


def _violation(saved: _Violation, n_states: int, rules: Mapping[str, CompiledRule]) -> Violation:
    rule = rules[saved.rule]
    if {variable.name for variable in rule.variables} != set(saved.binding):
        raise ValueError
    if saved.step is not None and not 0 <= saved.step < n_states:
        raise ValueError
    return Violation(rule.name, rule.strength, saved.binding, saved.step)


def _refused(message: str, place: SourceLocation | None) -> RulecError:
    way_out = "restore it with the rulebook that it was saved with, or begin anew"
    return UNRESTORABLE_MONITOR.error(place, message, help=way_out)
