"""``unless`` and ``when``: what a rule exempts, and when.

A rule that forbids a sequence guards a stretch of it: the phases between the first and the last,
which only say where the sequence comes from and where it leads. For a sequence of two phases the
stretch is the last instant of the first and the first instant of the second; for a single phase,
and for ``always``, it is one instant. An exception exempts a sequence if it holds at the stretch's
start, at its end, throughout it, or at some point of it. A sequence violates the rule if no
exception exempts it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from rulec.logic import formula as ltl
from rulec.logic.opportunities import trigger_of
from rulec.rulebook.rulebook_model import Exemption, ExemptionScope, Rule

_THEN, _UNTIL = ltl.BinaryOperator.THEN, ltl.BinaryOperator.UNTIL


class ExemptionError(Exception):
    """A formula guards no stretch, or bounds its phases."""

    def __init__(self, problem: Literal["no stretch", "bounded phase"]) -> None:
        super().__init__(problem)
        self.problem = problem


def exempted(formula: ltl.Formula, exemptions: Sequence[Exemption]) -> ltl.Formula:
    """The formula with its exceptions.

    Raises ExemptionError: for another scope than ``initially`` of a formula that guards no
    stretch, and for ``throughout`` if a phase's length is bounded.
    """
    inside = [exemption for exemption in exemptions if exemption.scope != "initially"]
    initially = [exemption.formula for exemption in exemptions if exemption.scope == "initially"]
    match formula:
        case _ if not inside:
            pass
        case ltl.Unary(ltl.UnaryOperator.ALWAYS, operand):
            exempt = ltl.any_of(exemption.formula for exemption in inside)
            formula = replace(formula, operand=ltl.any_of([exempt, operand]))
        case ltl.Unary(ltl.UnaryOperator.NEVER, operand):
            formula = replace(formula, operand=_counted(_phases(operand), inside))
        case _:
            raise ExemptionError("no stretch")
    return ltl.any_of([*initially, formula])


def rule_trigger(rule: Rule) -> ltl.Formula | None:
    """What must hold in a state for the rule to be breached there.

    None if its form has no trigger.
    """
    exceptions = [(part.formula, part.scope == "initially") for part in rule.exemptions]
    return trigger_of(rule.required or rule.formula, exceptions, rule.condition)


@dataclass(frozen=True, slots=True)
class _Phase:
    """A phase of a sequence with its duration; the last one has none."""

    formula: ltl.Formula
    bound: ltl.Bound | None = None


def _phases(formula: ltl.Formula) -> list[_Phase]:
    phases: list[_Phase] = []
    while isinstance(formula, ltl.Binary) and formula.operator is _THEN:
        phases.append(_Phase(formula.left, formula.bound))
        formula = formula.right
    return [*phases, _Phase(formula)]


def _counted(phases: list[_Phase], exemptions: Sequence[Exemption]) -> ltl.Formula:
    """The sequence of these phases, unless an exemption exempts it."""
    denied: dict[ExemptionScope, list[ltl.Formula]] = {}
    for exemption in exemptions:
        denied.setdefault(exemption.scope, []).append(ltl.negated(exemption.formula))
    if len(phases) == 1:
        return ltl.all_of(
            [phases[0].formula, *(ltl.negated(exemption.formula) for exemption in exemptions)]
        )
    throughout = tuple(dict.fromkeys(denied.get("throughout", [])))
    if throughout and any(phase.bound is not None for phase in phases):
        raise ExemptionError("bounded phase")
    at_start, at_end = ltl.all_of(denied.get("at start", [])), ltl.all_of(denied.get("at end", []))
    everywhere = ltl.all_of(denied.get("at some point", []))
    if len(phases) == 2:
        before, behind = (ltl.all_of([own, everywhere]) for own in (at_start, at_end))
        return _border(phases, before, behind, throughout)
    return _Inner(phases, at_start, at_end, everywhere).whole(throughout)


def _border(
    phases: list[_Phase], before: ltl.Formula, behind: ltl.Formula, somewhere: Sequence[ltl.Formula]
) -> ltl.Formula:
    """The formula of two phases, split at the border between them.

    ``before`` holds in the last instant of the first phase, ``behind`` in the first instant of the
    second, each of ``somewhere`` in one of both.
    """
    first, second = phases
    behind = ltl.all_of([second.formula, behind])
    if not somewhere:
        return _ends(first, before, behind)
    each = [ltl.any_of([own, ltl.Unary(ltl.UnaryOperator.NEXT, own)]) for own in somewhere]
    last = ltl.all_of([first.formula, before, ltl.Unary(ltl.UnaryOperator.NEXT, behind), *each])
    return ltl.Binary(_UNTIL, first.formula, last)


def _ends(phase: _Phase, at_last: ltl.Formula, behind: ltl.Formula) -> ltl.Formula:
    """The formula of the rest of a phase and the instant after it.

    ``at_last`` holds in its last instant, ``behind`` in the one after it.
    """
    if at_last == ltl.all_of([]):
        return ltl.Binary(_THEN, phase.formula, behind, phase.bound)
    if phase.bound is not None:
        before = ltl.Unary(ltl.UnaryOperator.PREVIOUSLY, at_last)
        return ltl.Binary(_THEN, phase.formula, ltl.all_of([before, behind]), phase.bound)
    last = ltl.all_of([phase.formula, at_last, ltl.Unary(ltl.UnaryOperator.NEXT, behind)])
    return ltl.Binary(_UNTIL, phase.formula, last)


@dataclass(frozen=True, slots=True)
class _Inner:
    """A sequence of at least three phases; the inner ones are guarded.

    ``at_start``, ``at_end`` and ``everywhere`` must hold at the first, the last, and all instants
    of the stretch for the sequence to violate the rule.
    """

    phases: list[_Phase]
    at_start: ltl.Formula
    at_end: ltl.Formula
    everywhere: ltl.Formula

    def whole(self, somewhere: Sequence[ltl.Formula]) -> ltl.Formula:
        """The formula of all phases, each of ``somewhere`` holding somewhere in the stretch.

        Each may find an end of its own: up to the last of these ends, all of them hold somewhere.
        """
        first = self.phases[0]
        inner = ltl.all_of([self._enter(1, own) for own in somewhere or (None,)])
        return ltl.Binary(_THEN, first.formula, inner, first.bound)

    def _enter(self, index: int, somewhere: ltl.Formula | None) -> ltl.Formula:
        if index == len(self.phases) - 1:
            return self.phases[-1].formula
        inside = self._inside(index, somewhere)
        return ltl.all_of([self.at_start, inside]) if index == 1 else inside

    def _inside(self, index: int, somewhere: ltl.Formula | None) -> ltl.Formula:
        """The formula from some instant of an inner phase on."""
        phase = replace(
            self.phases[index], formula=ltl.all_of([self.phases[index].formula, self.everywhere])
        )
        is_last = index == len(self.phases) - 2
        at_last = self.at_end if is_last else ltl.all_of([])
        if somewhere is None:
            return _ends(phase, at_last, self._enter(index + 1, None))
        leaves = ltl.all_of(
            [at_last, ltl.Unary(ltl.UnaryOperator.NEXT, self._enter(index + 1, None))]
        )
        stays = ltl.Unary(ltl.UnaryOperator.NEXT, self._inside(index, None))
        ways = [ltl.all_of([somewhere, ltl.any_of([leaves, stays])])]
        if not is_last:
            ways.insert(0, ltl.Unary(ltl.UnaryOperator.NEXT, self._enter(index + 1, somewhere)))
        return ltl.Binary(_UNTIL, phase.formula, ltl.all_of([phase.formula, ltl.any_of(ways)]))
