"""A trace judged while it runs, state by state."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook, check_step
from rulec.automata.thresholds import exact
from rulec.diagnostics import RulecError, SourceLocation
from rulec.monitoring.letter_reader import NOBODY
from rulec.monitoring.online.bound_rules import BoundRules
from rulec.monitoring.online.carried_state import CarriedState
from rulec.monitoring.online.monitor_state import (
    Change,
    MonitorState,
    SoFar,
    beginning,
    carried_over,
    onward,
)
from rulec.monitoring.online.rule_group import MOST_LEARNED, rule_groups
from rulec.monitoring.online.snapshot import from_data, step_in, to_data
from rulec.monitoring.state_validation import check_objects
from rulec.monitoring.verdict import Violation
from rulec.trace import State
from rulec.trace.trace_messages import NOT_A_TRACE

_Now: TypeAlias = tuple[MonitorState, int, tuple[Change, ...]]
"""Where a monitor stands, behind which state, and what has changed by that."""


class Monitor:
    """Judges a trace whose states come one after the other.

    A step takes as long after a million states as after one: what has been is known by the states
    of the rules' machines, one for each binding of a rule to objects that are there.

    Args:
        rulebook: the rules; they are not compiled here.
        step_s: seconds from one state to the next; needed only by rules with bounds in seconds. If
            left out, the step that they were compiled for.

    Raises:
        RulecError: R0507 if a rule was compiled for another step and cannot be compiled again.
    """

    def __init__(self, rulebook: CompiledRulebook, step_s: Fraction | float | None = None) -> None:
        steps = [rule.step_s for rule in rulebook.rules if rule.step_s is not None]
        self._step_s = exact(step_s) if step_s is not None else steps[0] if steps else None
        if self._step_s is not None:
            rulebook = rulebook.fitted_to(self._step_s)
            for rule in rulebook.rules:
                check_step(rule, self._step_s, "the monitor")
        self._rulebook = rulebook
        self._strengths = {rule.name: rule.strength for rule in rulebook.rules}
        self._now: _Now = beginning(BoundRules(rulebook, rule_groups(rulebook), NOBODY)), -1, ()
        self._violations: list[Violation] = []

    @property
    def rulebook(self) -> CompiledRulebook:
        """The rules that judge."""
        return self._rulebook

    @property
    def step_s(self) -> Fraction | None:
        """Seconds from one state to the next; None if it makes no difference."""
        return self._step_s

    @property
    def so_far(self) -> SoFar:
        """What the last state has led to; before the first one, the state has the number -1."""
        return _so_far(*self._now)

    @property
    def objects(self) -> Mapping[str, str]:
        """The objects that were there in the last state, with their types."""
        return dict(self._now[0].scene.objects)

    @property
    def violations(self) -> tuple[Violation, ...]:
        """All that is violated for good, in the order in which it came to that.

        The ``step`` is that of ``verify``: None if the end of a stretch has decided.
        """
        return tuple(self._violations[: self._now[0].n_violations])

    def step(
        self, state: State, objects: Mapping[str, str] = NOBODY, place: SourceLocation | None = None
    ) -> SoFar:
        """Take the next state.

        Args:
            state: as in a trace.
            objects: those that are there in it, and their types. Who is no longer among them has
                left; who comes back later begins anew.
            place: where the state was read, for messages.

        Returns:
            The verdicts as of this state, and what has changed.

        Raises:
            RulecError: R0501 to R0505 or R0508 if the state does not fit the rulebook, as in
                ``verify``. Then the monitor is as if there had been no such state.
        """
        here, number, _ = self._now
        scene = here.scene
        same_objects = objects == scene.objects
        if same_objects:
            # A method that is looked up and called at once would be looked up in the class first.
            key = scene.memory.key
            try:
                after, changes = here.after[key(state)]
            except (LookupError, TypeError):
                pass
            else:
                number += 1
                self._now = after, number, changes
                return SoFar(number, after.verdict, after.rules, changes)
        return self._step_slowly(state, objects, place, same_objects)

    def _step_slowly(
        self,
        state: State,
        objects: Mapping[str, str],
        place: SourceLocation | None,
        same_objects: bool,
    ) -> SoFar:
        """As ``step``, whether such a state has been there before or not."""
        here, number, _ = self._now
        number += 1
        scene = here.scene
        if same_objects:
            # They may be given in another order.
            objects = scene.objects
        else:
            if not isinstance(objects, Mapping):
                raise _no_object("what is given as objects", "names and types", place)
            check_objects(objects, self._rulebook.vocabulary, place)
        is_full = scene.teams.learned.n > MOST_LEARNED
        if is_full or not same_objects:
            teams = scene.teams.forgetful() if is_full else scene.teams
            scene = BoundRules(self._rulebook, teams, objects)
        if type(state) is not dict and not isinstance(state, Mapping):
            raise _no_object(f"state {number}", "names and values", place)
        letters, known = scene.read(state, number, place)
        after, changes = onward(here, scene, letters)
        same = scene is here.scene and after.n_violations == here.n_violations
        if same and known is not None:
            after = scene.memory.learn(known, number, here, after, changes)
        if after.n_violations > here.n_violations:
            self._note_violations(here.n_violations, number, changes)
        # All at once: whatever interrupts this, the state has been taken or it has not.
        self._now = after, number, changes
        return _so_far(after, number, changes)

    def past(self, objects: Mapping[str, str]) -> CarriedState:
        """What has been, as far as it bears on a next state in which these objects are there."""
        here, _, _ = self._now
        scene = BoundRules(self._rulebook, here.scene.teams, objects)
        edges, ended = carried_over(here.scene, here.nodes, scene)
        states, settled = {}, set()
        for crowd in scene.crowds:
            for items, edge in zip(crowd.bindings, edges[crowd.ready.rule.name], strict=True):
                states[crowd.ready.rule.name, items] = edge.state
                if edge.verdict == "violated":
                    settled.add((crowd.ready.rule.name, items))
        lost = [
            Violation(one.rule, self._strengths[one.rule], dict(one.binding), None) for one in ended
        ]
        return CarriedState(states, frozenset(settled), (*self.violations, *lost))

    def snapshot(self) -> dict[str, Any]:
        """Where the monitor stands, for ``restore``: data that JSON can take."""
        here, number, _ = self._now
        return to_data(here, number, self._rulebook, self._step_s, self.violations)

    @classmethod
    def restore(
        cls, rulebook: CompiledRulebook, snapshot: Any, place: SourceLocation | None = None
    ) -> Monitor:
        """A monitor that goes on where another one stood.

        Args:
            rulebook: the rules of that monitor, or others whose machines are the same.
            snapshot: what its ``snapshot`` has returned, or JSON has made of that.
            place: where it was read, for messages.

        Raises:
            RulecError: R0510 if this is no snapshot, one of other rules, or damaged.
        """
        monitor = cls(rulebook, step_in(snapshot, rulebook, place))
        teams = monitor._now[0].scene.teams
        number, standing, violations = from_data(snapshot, rulebook, teams, place)
        monitor._now, monitor._violations = (standing, number, ()), violations
        return monitor

    def __reduce__(self) -> tuple[Callable[..., Monitor], tuple[Any, ...]]:
        state = self.snapshot(), self._now[2], self._violations
        return _unpickled, (self._rulebook, self._step_s, *state)

    def __repr__(self) -> str:
        so_far = self.so_far
        return f"Monitor({self._rulebook.name}, state={so_far.state}, verdict={so_far.verdict!r})"

    def _note_violations(self, n_before: int, number: int, changes: Sequence[Change]) -> None:
        # What an interrupted step has noted was none.
        del self._violations[n_before:]
        self._violations += [
            Violation(
                one.rule,
                self._strengths[one.rule],
                dict(one.binding),
                None if one.ended else number,
            )
            for one in changes
            if one.verdict == "violated"
        ]


def _unpickled(
    rulebook: CompiledRulebook,
    step_s: Fraction | None,
    snapshot: Any,
    changes: tuple[Change, ...],
    violations: list[Violation],
) -> Monitor:
    """A monitor where another stood: what it has learned is learned anew."""
    monitor = Monitor(rulebook, step_s)
    restored = Monitor.restore(rulebook, snapshot)
    standing, number, _ = restored._now
    monitor._now, monitor._violations = (standing, number, changes), violations
    return monitor


def _so_far(standing: MonitorState, number: int, changes: tuple[Change, ...]) -> SoFar:
    return SoFar(number, standing.verdict, standing.rules, changes)


def _no_object(what: str, of: str, place: SourceLocation | None) -> RulecError:
    return NOT_A_TRACE.error(place, f"{what} is no object of {of}")
