"""Where a monitor stands, as data that outlives the program."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, Literal

import msgspec

from rulec.automata.bundle.bundle_file import read_to_data
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.json_problems import json_words
from rulec.monitoring.monitoring_messages import UNRESTORABLE_MONITOR
from rulec.monitoring.online.bound_rules import BoundRules
from rulec.monitoring.online.four_valued import Edge, Prefix
from rulec.monitoring.online.monitor_state import MonitorState, beginning, standing_at
from rulec.monitoring.online.rule_group import Ready, RuleGroups
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
    verdict: Prefix


class _Rule(msgspec.Struct, forbid_unknown_fields=True):
    rule: str
    bindings: list[_Binding]


class _Violation(msgspec.Struct, forbid_unknown_fields=True):
    rule: str
    binding: dict[str, str]
    step: int | None


class _Saved(msgspec.Struct, forbid_unknown_fields=True):
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
    here: MonitorState,
    number: int,
    rulebook: CompiledRulebook,
    step_s: Fraction | None,
    violations: Sequence[Violation],
) -> dict[str, Any]:
    """What ``from_data`` reads, behind the state with a number: JSON has a word for all of it."""
    return {
        "format": FORMAT,
        "version": VERSION,
        "rulebook": rulebook.name,
        "machines": fingerprint(rulebook),
        "step_s": None if step_s is None else str(step_s),
        "states": number + 1,
        "objects": dict(here.scene.objects),
        "rules": [
            {
                "rule": crowd.ready.rule.name,
                "bindings": [
                    {"objects": list(items), "state": edge.state, "verdict": edge.verdict}
                    for items, edge in zip(crowd.bindings, crowd.edges(here.nodes), strict=True)
                ],
            }
            for crowd in here.scene.crowds
        ],
        "violations": [
            {"rule": one.rule, "binding": dict(one.binding), "step": one.step} for one in violations
        ],
    }


def fingerprint(rulebook: CompiledRulebook) -> str:
    """The same for rulebooks whose rules judge by the same machines, and for no others."""
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


def step_in(data: Any, rulebook: CompiledRulebook, place: SourceLocation | None) -> Fraction | None:
    """The step that a monitor was saved with, once it is clear that it fits the rulebook.

    Raises:
        RulecError: R0510.
    """
    return _checked(data, rulebook, place)[1]


def from_data(
    data: Any, rulebook: CompiledRulebook, teams: RuleGroups, place: SourceLocation | None
) -> tuple[int, MonitorState, list[Violation]]:
    """Behind which state a monitor with these rules stood, where, and what was violated by then.

    Raises:
        RulecError: R0510 if this is no saved monitor, one of another rulebook or damaged.
    """
    saved, _ = _checked(data, rulebook, place)
    try:
        check_objects(saved.objects, rulebook.vocabulary)
        scene = BoundRules(rulebook, teams, saved.objects)
        if saved.states == 0 and not saved.objects and not saved.violations:
            return -1, beginning(scene), []
        edges = _edges(saved, scene)
        violations = [_violation(one, saved.states, teams.rules) for one in saved.violations]
    except (LookupError, ValueError, RulecError):
        raise _refused("this saved monitor is damaged", place) from None
    lost = {one.rule for one in violations}
    standing = standing_at(scene, edges, lost, len(violations))
    return saved.states - 1, standing, violations


def _checked(
    data: Any, rulebook: CompiledRulebook, place: SourceLocation | None
) -> tuple[_Saved, Fraction | None]:
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
        saved = msgspec.convert(data, _Saved)
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


def _edges(saved: _Saved, scene: BoundRules) -> dict[str, list[Edge]]:
    """Raises LookupError or ValueError unless each binding stands somewhere, and no other does."""
    edges: dict[str, list[Edge]] = {}
    for crowd, rule in zip(scene.crowds, saved.rules, strict=True):
        known = {one.objects: one for one in rule.bindings}
        if rule.rule != crowd.ready.rule.name or len(rule.bindings) != len(crowd.bindings):
            raise ValueError
        stood = [known[items] for items in crowd.bindings]
        links = crowd.ready.links.edges
        edges[rule.rule] = [links[one.state, one.verdict] for one in stood]
    return edges


def _violation(one: _Violation, n_states: int, ready: Sequence[Ready]) -> Violation:
    rules: Mapping[str, Ready] = {each.rule.name: each for each in ready}
    rule = rules[one.rule].rule
    if {variable.name for variable in rule.variables} != set(one.binding):
        raise ValueError
    if one.step is not None and not 0 <= one.step < n_states:
        raise ValueError
    return Violation(rule.name, rule.strength, one.binding, one.step)


def _refused(message: str, place: SourceLocation | None) -> RulecError:
    way_out = "restore it with the rulebook that it was saved with, or begin anew"
    return UNRESTORABLE_MONITOR.error(place, message, help=way_out)
