"""A runtime monitor: verifies a trace state by state while it runs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from types import MappingProxyType
from typing import Any, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook, check_step
from rulec.automata.outcome_machine import OutcomeMachine
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.argument_kinds import expected, finite
from rulec.diagnostics.fault_messages import contained
from rulec.monitoring.implied_values import DefinedWords
from rulec.monitoring.online.bound_rules import BoundRules
from rulec.monitoring.online.four_valued import without_sink, worst_of
from rulec.monitoring.online.monitor_state import (
    MonitorState,
    SoFar,
    VerdictChange,
    awake,
    carry_over,
    initial_state,
    take_step,
    with_constants_known,
    with_inexact,
)
from rulec.monitoring.online.rule_group import MOST_CACHED, rule_groups
from rulec.monitoring.online.running_constants import (
    Arrival,
    constants_of_world,
    with_known_constants,
)
from rulec.monitoring.online.snapshot import from_data, restored, to_data, with_source
from rulec.monitoring.online.transition_cache import TransitionCache
from rulec.monitoring.state_validation import check_objects, check_told
from rulec.monitoring.uncertainty.judged_rules import judged_rules
from rulec.monitoring.verdict import CarriedState, RuleFor, Violation
from rulec.trace import State
from rulec.trace.trace_messages import NOT_A_TRACE
from rulec.vocabulary.vocabulary_model import choices

NO_OBJECTS: Mapping[str, str] = MappingProxyType({})

_Now: TypeAlias = tuple[MonitorState, int, tuple[VerdictChange, ...], TransitionCache]
"""The monitor's state, the number of the last state, its changes, and a cache of steps.

They form one value, so that an interrupted step cannot leave them inconsistent.
"""


class RunningMonitor:
    """A monitor of a trace by a compiled rulebook; see ``rulec.Monitor``, which takes any form.

    Raises TypeError for rules that are not compiled.
    """

    def __init__(
        self,
        rulebook: CompiledRulebook,
        step_s: Fraction | float | None = None,
        *,
        told: Iterable[str] | None = None,
        cut: bool = False,
    ) -> None:
        expected("rulebook", "CompiledRulebook", rulebook)
        finite("step_s", step_s)
        expected("told", "Iterable[str] | None", told)
        expected("cut", "bool", cut)
        if step_s is None:
            rulebook = rulebook.at_one_step()
        steps = [rule.step_s for rule in rulebook.rules if rule.step_s is not None]
        self._step_s = exact_step(step_s) if step_s is not None else steps[0] if steps else None
        if self._step_s is not None:
            rulebook = rulebook.fitted_to(self._step_s)
            for rule in rulebook.rules:
                check_step(rule, self._step_s, "the monitor")
        self._rulebook = rulebook
        self._strengths = {rule.name: rule.strength for rule in rulebook.rules}
        self._told = None if told is None else frozenset(told)
        check_told(self._told, rulebook.vocabulary)
        self._meant = DefinedWords(rulebook.vocabulary, self._told)
        self._cut = cut
        machines: Mapping[str, OutcomeMachine] | None = None
        if self._told is not None or cut:
            judged = judged_rules(rulebook, self._told, cut=cut)
            if cut:
                machines = {rule.name: machine.machine for rule, machine in judged.machines}
            rulebook = judged.rulebook
        self._judged = rulebook
        lacks_hard = any(self._strengths[name] == "hard" for name in self.not_judged)
        groups = rule_groups(rulebook, machines, lacks_hard=lacks_hard)
        start = initial_state(BoundRules(rulebook, groups, NO_OBJECTS))
        self._now: _Now = start, -1, (), TransitionCache()
        self._violations: list[Violation] = []

    @property
    def rulebook(self) -> CompiledRulebook:
        """The rules by which the trace is judged."""
        return self._rulebook

    @property
    def not_judged(self) -> tuple[str, ...]:
        """The rules that cannot be judged because the source lacks values that they need."""
        judged = {rule.name for rule in self._judged.rules}
        return tuple(rule.name for rule in self._rulebook.rules if rule.name not in judged)

    @property
    def step_s(self) -> Fraction | None:
        """The time step (s); None if no rule depends on it."""
        return self._step_s

    @property
    def so_far(self) -> SoFar:
        """The verdicts as of the last state; its number is -1 before the first one."""
        current, number, changes, _ = self._now
        return SoFar(number, current.verdict, current.rules, changes, current.exact)

    @property
    def objects(self) -> Mapping[str, str]:
        """The objects present in the last state, with their types."""
        return dict(self._now[0].bound_rules.objects)

    @property
    def violations(self) -> tuple[Violation, ...]:
        """All violations for good, in the order in which they occurred.

        The ``step`` is that of ``verify``: None if the end of a stretch decided.
        """
        return tuple(self._violations[: self._now[0].n_violations])

    def step(
        self,
        state: State,
        objects: Mapping[str, str] = NO_OBJECTS,
        place: SourceLocation | None = None,
    ) -> SoFar:
        """Take the next state.

        Args:
            state: as in a trace.
            objects: those that are present in it, with their types. An object that is missing has
                left; if it returns later it counts as a new object.
            place: where the state was read, for messages.

        Returns the verdicts as of this state, and what has changed. Raises RulecError R0501 to
        R0505 or R0508 if the state does not fit the rulebook, as in ``verify``, and R0790 for a
        fault of rulec; the monitor then ignores the state.
        """
        if self._meant:
            state = self._meant.in_state(state, objects)
        current, number, _, cache = self._now
        same_objects = objects == current.bound_rules.objects
        if same_objects is True:  # and no array of such answers
            # Calling through the instance would look up the method in the class first.
            key = cache.key
            try:
                known = current.after.get(key(state))
            except (LookupError, TypeError):
                known = None
            if known is not None:
                after, changes = known
                number += 1
                self._now = after, number, changes, cache
                return SoFar(number, after.verdict, after.rules, changes, after.exact)
        return self._step_slowly(state, objects, place, same_objects)

    def _step_slowly(
        self,
        state: State,
        objects: Mapping[str, str],
        place: SourceLocation | None,
        same_objects: bool,
    ) -> SoFar:
        """Take the next state without the cache of earlier steps."""
        if place is not None:
            expected("place", "SourceLocation | None", place)
        current, number = self._now[0], self._now[1] + 1
        bound_rules = current.bound_rules
        if same_objects is True:  # and no array of such answers
            # The objects may be given in another order.
            objects = bound_rules.objects
        else:
            if not isinstance(objects, Mapping):
                raise _no_object("what is given as objects", "names and types", place)
            check_objects(objects, self._judged.vocabulary, place)
        if type(state) is not dict and not isinstance(state, Mapping):
            raise _no_object(f"state {number}", "names and values", place)
        try:
            return self._taken(state, objects, place, same_objects)
        except Exception:
            # Entered only then: it takes as long as a third of a step.
            with contained(f"state {number}", place):
                raise

    def _taken(
        self,
        state: State,
        objects: Mapping[str, str],
        place: SourceLocation | None,
        same_objects: bool,
    ) -> SoFar:
        current, number, _, cache = self._now
        number, bound_rules = number + 1, current.bound_rules
        is_full = bound_rules.groups.cache_size.n > MOST_CACHED
        if is_full or not same_objects:
            groups = bound_rules.groups.without_cache() if is_full else bound_rules.groups
            bound_rules = BoundRules(self._judged, groups, objects, awake(current, objects))
            cache = TransitionCache()
        constants = current.constants
        if self._judged.vocabulary.constants:
            arrival = Arrival(number, objects, current.bound_rules.objects, place)
            state, constants = with_known_constants(
                state, arrival, constants, self._judged.vocabulary
            )
        if bound_rules.lazy:
            waking = bound_rules.waking(state, number, place)
            if not bound_rules.has(waking):
                before, groups = awake(current, objects), bound_rules.groups
                every = {types: {*own, *before.get(types, ())} for types, own in waking.items()}
                bound_rules = BoundRules(self._judged, groups, objects, every)
                cache = TransitionCache()
        letters, known = bound_rules.read(state, number, place)
        after, changes = take_step(current, bound_rules, letters)
        if current.inexact or bound_rules.groups.cache_size.is_inexact:
            after = with_inexact(after, current.inexact | bound_rules.inexact(letters))
        if constants is not current.constants:
            # What follows this state depends on them, and so does what was cached
            known, cache = None, TransitionCache()
        after = with_constants_known(after, constants)
        n_before = current.n_violations
        same = bound_rules is current.bound_rules and after.n_violations == n_before
        if same and known is not None:
            after = cache.remember(known, number, current, (after, changes))
        if after.n_violations > n_before:
            # Changes noted by an interrupted step are void.
            del self._violations[n_before:]
            self._violations += [
                self._violation(change, None if change.ended else number)
                for change in changes
                if change.verdict == "violated"
            ]
        # Assigned at once, so that an interrupt leaves the state either taken or not.
        self._now = after, number, changes, cache
        return SoFar(number, after.verdict, after.rules, changes, after.exact)

    def past(self, objects: Mapping[str, str]) -> CarriedState:
        """The past, as far as it affects verdicts on future states with these objects.

        Raises ValueError if the time before the first state is unknown.
        """
        expected("objects", "Mapping[str, str]", objects)
        current = self._now[0]
        if self._cut:
            raise ValueError("it is unknown what was before")
        begun = awake(current, objects)
        bound_rules = BoundRules(self._judged, current.bound_rules.groups, objects, begun)
        edges, ended = carry_over(current.bound_rules, current.nodes, bound_rules)
        states, settled = {}, set()
        possible: dict[RuleFor, frozenset[int]] = {}
        doubtful: set[RuleFor] = set()
        for bound_rule in bound_rules.rules:
            name = bound_rule.prepared.name
            for items, edge in zip(bound_rule.bindings, edges[name], strict=True):
                if edge.is_known:
                    states[name, items] = edge.states[0]
                    if edge.verdict == "violated":
                        settled.add((name, items))
                    continue
                possible[name, items] = frozenset(edge.states)
                if worst_of(edge.verdict) == "violated":
                    doubtful.add((name, items))
        if self.so_far.state >= 0:
            dark = [rule for rule in self._rulebook.rules if rule.name in self.not_judged]
            for rule in dark:
                kinds = [variable.type for variable in rule.variables]
                for items in choices(kinds, objects, self._rulebook.vocabulary):
                    possible[rule.name, items] = frozenset(range(len(rule.machine.successors)))
                    doubtful.add((rule.name, items))
        machines = {rule.name: rule.machine for rule in self._rulebook.rules}
        for about in doubtful:
            possible[about] = without_sink(machines[about[0]], possible[about])
        lost = [self._violation(change, None) for change in ended if change.verdict == "violated"]
        violations = (*self.violations, *lost)
        return CarriedState(
            states,
            frozenset(settled),
            violations,
            possible,
            frozenset(doubtful),
            constants=constants_of_world(current.constants),
        )

    def snapshot(self) -> dict[str, Any]:
        """The monitor's state, for ``restore``, as data that can be written as JSON."""
        current, number, *_ = self._now
        data = to_data(current, number, self._rulebook, self._step_s, self.violations)
        return with_source(data, self._told, cut=self._cut)

    @classmethod
    def restore(
        cls, rulebook: CompiledRulebook, snapshot: Any, place: SourceLocation | None = None
    ) -> RunningMonitor:
        """A monitor that continues where another one stopped.

        Args:
            rulebook: the rules of that monitor, or others with the same machines.
            snapshot: the result of its ``snapshot``, possibly written to JSON and read again.
            place: where it was read, for messages.

        Raises RulecError R0510 if this is no snapshot, or one of other rules, or damaged.
        """
        expected("rulebook", "CompiledRulebook", rulebook)
        saved, step_s = from_data(snapshot, rulebook, place)
        monitor = cls(rulebook, step_s, told=saved.told, cut=saved.cut)
        groups = monitor._now[0].bound_rules.groups
        number, current, violations = restored(saved, monitor._judged, groups, place)
        monitor._now, monitor._violations = (current, number, (), TransitionCache()), violations
        return monitor

    def __reduce__(self) -> tuple[Callable[..., RunningMonitor], tuple[Any, ...]]:
        state = self.snapshot(), self._now[2], self._violations
        return _unpickled, (type(self), self._rulebook, self._step_s, state)

    def __repr__(self) -> str:
        so_far = self.so_far
        about = f"{self._rulebook.name}, state={so_far.state}, verdict={so_far.verdict!r}"
        return f"{type(self).__name__}({about})"

    def _violation(self, change: VerdictChange, number: int | None) -> Violation:
        strength = self._strengths[change.rule]
        return Violation(change.rule, strength, dict(change.binding), number)


def _unpickled(
    kind: type[RunningMonitor],
    rulebook: CompiledRulebook,
    step_s: Fraction | None,
    state: tuple[Any, tuple[VerdictChange, ...], list[Violation]],
) -> RunningMonitor:
    """A monitor with another one's snapshot, last changes and violations; its caches are empty."""
    snapshot, changes, violations = state
    monitor = kind.restore(rulebook, snapshot)
    monitor._step_s = step_s
    current, number, _, cache = monitor._now
    monitor._now, monitor._violations = (current, number, changes, cache), violations
    return monitor


def _no_object(item: str, owner: str, place: SourceLocation | None) -> RulecError:
    return NOT_A_TRACE.error(place, f"{item} is no object of {owner}")
