"""Snapshots of monitors: data that outlive the program."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence, Set
from fractions import Fraction
from typing import Any, Literal

import msgspec

from rulec.automata.bundle.bundle_file import read_to_data
from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.phrases import json_words
from rulec.logic.codec import number_from_data
from rulec.monitoring.bindings import types_of
from rulec.monitoring.monitoring_messages import UNRESTORABLE_MONITOR
from rulec.monitoring.online import running_constants
from rulec.monitoring.online.bound_rules import BoundRules
from rulec.monitoring.online.encoding.state_shape import Items
from rulec.monitoring.online.four_valued import FourValued, VerdictRange
from rulec.monitoring.online.monitor_state import (
    MonitorState,
    initial_state,
    nodes_at,
    state_at,
    with_constants_known,
    with_inexact,
)
from rulec.monitoring.online.prepared_rule import PreparedRule
from rulec.monitoring.online.rule_group import RuleGroups
from rulec.monitoring.online.rule_steps import Edge
from rulec.monitoring.online.running_constants import SavedConstant
from rulec.monitoring.state_validation import check_objects
from rulec.monitoring.verdict import Violation

FORMAT = "rulec monitor"
VERSION, PARTIAL_VERSION = 1, 2
"""Versions of the files; the second is for monitors with unknown values, or with constants."""


class _Header(msgspec.Struct):
    format: Literal["rulec monitor"]
    version: int


class _Binding(msgspec.Struct, forbid_unknown_fields=True):
    objects: tuple[str, ...]
    state: int | list[int]
    verdict: FourValued | tuple[FourValued, FourValued]


class _Rule(msgspec.Struct, forbid_unknown_fields=True):
    rule: str
    bindings: list[_Binding]


class _Violation(msgspec.Struct, forbid_unknown_fields=True):
    rule: str
    binding: dict[str, str]
    step: int | None


class SavedMonitor(msgspec.Struct, forbid_unknown_fields=True):
    """A saved monitor: its number of ``states``, and machine states by rule and binding.

    With unknown values there are several machine states, and the best and worst verdict;
    ``doubted`` are rules that may have been violated by objects that have left, ``inexact`` those
    with overestimated letters; ``told`` and ``cut`` are as in a trace. ``constants`` are those
    given so far.
    """

    format: str
    version: int
    rulebook: str
    machines: str
    step_s: str | None
    states: int
    objects: dict[str, str]
    rules: list[_Rule]
    violations: list[_Violation]
    told: list[str] | None = None
    cut: bool = False
    doubted: list[str] = []
    inexact: list[str] = []
    constants: list[SavedConstant] = []


def to_data(
    current: MonitorState,
    number: int,
    rulebook: CompiledRulebook,
    step_s: Fraction | None,
    violations: Sequence[Violation],
) -> dict[str, Any]:
    """JSON data of a monitor after a state, for ``from_data``."""
    edges = {rule: rule.edges(current.nodes) for rule in current.bound_rules.rules}
    single = all(edge.is_known for row in edges.values() for edge in row)
    doubted, inexact = sorted(current.doubted), sorted(current.inexact)
    constants = running_constants.to_data(current.constants)
    is_plain = single and not doubted and not inexact and not constants
    return {
        "format": FORMAT,
        "version": VERSION if is_plain else PARTIAL_VERSION,
        "rulebook": rulebook.name,
        "machines": fingerprint(rulebook),
        "step_s": None if step_s is None else str(step_s),
        "states": number + 1,
        "objects": dict(current.bound_rules.objects),
        "rules": [
            {
                "rule": rule.prepared.name,
                "bindings": [
                    {"objects": list(items), **_saved(edge)}
                    for items, edge in zip(rule.bindings, edges[rule], strict=True)
                ],
            }
            for rule in current.bound_rules.rules
        ],
        **({"doubted": doubted} if doubted else {}),
        **({"inexact": inexact} if inexact else {}),
        **({"constants": constants} if constants else {}),
        "violations": [
            {"rule": violation.rule, "binding": dict(violation.binding), "step": violation.step}
            for violation in violations
        ],
    }


def _saved(edge: Edge) -> dict[str, Any]:
    if edge.is_known:
        return {"state": edge.states[0], "verdict": edge.verdict}
    open_verdict = isinstance(edge.verdict, VerdictRange)
    return {
        "state": list(edge.states),
        "verdict": list(edge.verdict) if open_verdict else edge.verdict,
    }


def with_source(data: dict[str, Any], told: Set[str] | None, *, cut: bool) -> dict[str, Any]:
    """The snapshot, extended by which names its source can provide."""
    if told is None and not cut:
        return data
    names = None if told is None else sorted(told)
    return {**data, "version": PARTIAL_VERSION, "told": names, "cut": cut}


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
    except ValueError as problem:  # msgspec's own, and texts that are none
        raise UNRESTORABLE_MONITOR.error(
            place,
            f"this is not a saved monitor: {json_words(problem)}",
            help="give a file that `rulec monitor --save` has written",
        ) from None
    if header.version not in (VERSION, PARTIAL_VERSION):
        raise _refused(
            f"this saved monitor is of version {header.version}; "
            f"this rulec reads versions {VERSION} and {PARTIAL_VERSION}",
            place,
        )
    try:
        saved = msgspec.convert(data, SavedMonitor)
        step_s = None if saved.step_s is None else number_from_data(saved.step_s)
    except ValueError as problem:
        raise _refused(f"this saved monitor is damaged: {json_words(problem)}", place) from None
    if saved.machines != fingerprint(rulebook):
        whose = (
            f"an earlier or later `{rulebook.name}`"
            if saved.rulebook == rulebook.name
            else f"rulebook `{saved.rulebook}`, not of `{rulebook.name}`"
        )
        steps = {rule.step_s for rule in rulebook.rules} - {None}
        if saved.rulebook == rulebook.name and steps and step_s not in steps:
            raise _at_another_step(step_s, steps, place)
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
    """The last state's number, monitor state and violations of a saved monitor.

    Raises RulecError R0510 if it is damaged.
    """
    try:
        check_objects(saved.objects, rulebook.vocabulary)
        awake = _saved_choices(saved, rulebook)
        bound_rules = BoundRules(rulebook, groups, saved.objects, awake)
        if saved.states == 0 and not saved.objects and not saved.violations:
            return -1, initial_state(bound_rules), []
        edges = _edges(saved, bound_rules)
        rules = {rule.name: rule for rule in rulebook.rules}
        violations = [_violation(violation, saved.states, rules) for violation in saved.violations]
        constants = running_constants.from_data(saved.constants, saved.objects, rulebook.vocabulary)
    except (LookupError, ValueError, RulecError):
        raise _refused("this saved monitor is damaged", place) from None
    violated_rules = {violation.rule for violation in violations}
    nodes = nodes_at(bound_rules, edges)
    lost = violated_rules, frozenset(saved.doubted)
    current = state_at(bound_rules, nodes, lost, len(violations))
    known = current.rules.keys()
    if not known >= set(saved.inexact):
        raise _refused("this saved monitor is damaged", place)
    current = with_constants_known(with_inexact(current, frozenset(saved.inexact)), constants)
    return saved.states - 1, current, violations


def _saved_choices(
    saved: SavedMonitor, rulebook: CompiledRulebook
) -> dict[tuple[str, ...], set[Items]]:
    """The choices of objects in a saved monitor. Raises ValueError for invalid ones."""
    types = {rule.name: types_of(rule) for rule in rulebook.rules}
    choices: dict[tuple[str, ...], set[Items]] = {}
    for rule in saved.rules:
        for binding in rule.bindings:
            own = types[rule.rule]
            kinds = [saved.objects[item] for item in binding.objects]
            fit = map(rulebook.vocabulary.is_subtype, kinds, own)
            if not len(own) == len(kinds) == len(set(binding.objects)) or not all(fit):
                raise ValueError
            choices.setdefault(own, set()).add(binding.objects)
    return choices


def _edges(saved: SavedMonitor, bound_rules: BoundRules) -> dict[str, list[Edge]]:
    """The edges of exactly these bindings. Raises LookupError or ValueError otherwise."""
    edges: dict[str, list[Edge]] = {}
    for bound_rule, rule in zip(bound_rules.rules, saved.rules, strict=True):
        prepared = bound_rule.prepared
        by_objects = {binding.objects: binding for binding in rule.bindings}
        if rule.rule != prepared.name or len(rule.bindings) != len(bound_rule.bindings):
            raise ValueError
        bindings = [by_objects[items] for items in bound_rule.bindings]
        edges[prepared.name] = [_edge(prepared, binding) for binding in bindings]
    return edges


def _edge(prepared: PreparedRule, saved: _Binding) -> Edge:
    ends = prepared.steps.known_ends
    states = [saved.state] if isinstance(saved.state, int) else saved.state
    if not states or not {state for state, _ in ends}.issuperset(states):
        raise ValueError
    verdicts = [saved.verdict] if isinstance(saved.verdict, str) else saved.verdict
    edge = prepared.steps.edge(states, verdicts)
    if isinstance(saved.state, int) and edge.is_known and (*states, *verdicts) not in ends:
        raise ValueError
    return edge


def _violation(saved: _Violation, n_states: int, rules: Mapping[str, CompiledRule]) -> Violation:
    rule = rules[saved.rule]
    if {variable.name for variable in rule.variables} != set(saved.binding):
        raise ValueError
    if saved.step is not None and not 0 <= saved.step < n_states:
        raise ValueError
    return Violation(rule.name, rule.strength, saved.binding, saved.step)


def _at_another_step(
    saved: Fraction | None, steps: Set[Fraction | None], place: SourceLocation | None
) -> RulecError:
    own = " and ".join(f"{number} s" for number in sorted(filter(None, steps)))
    was = "any step" if saved is None else f"a step of {saved} s"
    return UNRESTORABLE_MONITOR.error(
        place,
        f"this monitor was saved for {was}, and these rules are compiled for {own}",
        help="leave `--step` out, so that it is the saved one, or begin anew",
    )


def _refused(message: str, place: SourceLocation | None) -> RulecError:
    way_out = "restore it with the rulebook that it was saved with, or begin anew"
    return UNRESTORABLE_MONITOR.error(place, message, help=way_out)
