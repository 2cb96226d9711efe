"""The past as registers: propositions that replace past operators.

Every past operator is a case of ``left since[low..high] right``. If its operands contain no future
operator, the word up to an instant determines its value: a register, small and deterministic, holds
what will be needed (cf. Havelund, Roşu, "Synthesizing monitors for safety properties", 2002).
Otherwise it is expressed by its expansion laws (Lichtenstein, Pnueli, Zuck, "The glory of the
past", 1985), which need a formula's value one instant ago: a memory. The remaining formula refers
to the present and the future only.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Literal

from rulec.logic import formula as ltl
from rulec.logic.bounds import (
    PAST,
    PREVIOUS,
    Range,
    begins_at,
    bound_of,
    looks_elsewhere,
    range_of_bound,
)

NOT, AND, OR = ltl.UnaryOperator.NOT, ltl.BinaryOperator.AND, ltl.BinaryOperator.OR


@dataclass(frozen=True, slots=True)
class Register:
    """The proposition ``atom``: whether ``left since[low..high] right`` holds now.

    ``left`` and ``right`` refer to the present and to earlier registers only. The state is the set
    of instants at which the proposition holds if from now on ``left`` holds and ``right`` does not:
    bit k of an integer stands for k instants after the last letter, bit 0 for that letter. A
    negative integer has infinitely many bits set.
    """

    atom: ltl.Atom
    left: ltl.Formula
    right: ltl.Formula
    span: Range

    at_first = 0
    """The state before the first letter."""

    def after(self, state: int, left: bool, right: bool) -> int:
        """The state after a letter for which the operands have these values."""
        return register_after(self.span, state, left, right)


def register_after(span: Range, state: int, left: bool, right: bool) -> int:
    """The state of a register of this range, as ``Register.after``."""
    due = state >> 1 if left else 0
    if not right:
        return due
    low, high = span
    reached = -1 << low
    return due | (reached if high is None else reached & ((1 << (high + 1)) - 1))


@dataclass(frozen=True, slots=True)
class Clock:
    """A register whose bound may be in seconds: with a step of traces it is one."""

    atom: ltl.Atom
    left: ltl.Formula
    right: ltl.Formula
    bound: ltl.Bound

    def register(self) -> Register:
        """The register, if the bound is in steps."""
        return Register(self.atom, self.left, self.right, range_of_bound(self.bound))

    def unbounded(self) -> Clock:
        """The clock with no more of its bound than where that begins, as far as that is known.

        More is not needed to know which clocks can hold together at one instant.
        """
        low, *others = sorted(begins_at(self.bound), reverse=True)
        unit: Literal["s", "steps"] = "s" if others else "steps"
        return replace(self, bound=ltl.Bound(Fraction(low), None, unit, early=bool(others)))


@dataclass(frozen=True, slots=True)
class Memory:
    """The proposition ``atom``: whether ``formula`` held one instant ago.

    It is false at the first instant. ``formula`` has no past operator, but may contain registers
    and memories, including this one. Its value depends on the future.
    """

    atom: ltl.Atom
    formula: ltl.Formula


@dataclass(frozen=True, slots=True)
class WithoutPast:
    """A formula without past operators, and the meaning of its fresh atoms.

    For any word there is exactly one choice of values for these atoms that satisfies their
    definitions; with it, ``present`` holds at the first instant if and only if the original formula
    does.
    """

    present: ltl.Formula
    registers: tuple[Register, ...]
    memories: tuple[Memory, ...]


def eliminate_past(formula: ltl.Formula, *, registers: bool = True) -> WithoutPast:
    """Eliminate past operators from a formula; without ``registers``, by memories only.

    Its bounds must be in steps; else raises ValueError.
    """
    present, clocks, memories = _eliminated(formula, with_registers=registers)
    return WithoutPast(present, tuple([clock.register() for clock in clocks]), memories)


def with_clocks(formula: ltl.Formula) -> tuple[ltl.Formula, tuple[Clock, ...]] | None:
    """The formula with clocks in place of its past operators, and these, each after those it needs.

    None if the past depends on the future, which clocks cannot tell.
    """
    try:
        present, clocks, memories = _eliminated(formula, with_registers=True)
    except ValueError:
        return None  # a bound in seconds would have to be written out
    return None if memories else (present, clocks)


def _eliminated(
    formula: ltl.Formula, *, with_registers: bool
) -> tuple[ltl.Formula, tuple[Clock, ...], tuple[Memory, ...]]:
    result = _PastParts(with_registers)
    present = _present(formula, result)
    fresh: list[Clock | Memory] = [*result.clocks.values(), *result.memories.values()]
    needed: list[Clock | Memory] = []
    spoken_of = set(ltl.atoms_of(present))
    # Each refers only to earlier ones.
    for own in sorted(fresh, key=lambda proxy: result.order[proxy.atom], reverse=True):
        if own.atom in spoken_of:
            needed.insert(0, own)
            parts = (own.left, own.right) if isinstance(own, Clock) else (own.formula,)
            for part in parts:
                spoken_of.update(ltl.atoms_of(part))
    return (
        present,
        tuple([own for own in needed if isinstance(own, Clock)]),
        tuple([own for own in needed if isinstance(own, Memory)]),
    )


def without_clocks(formula: ltl.Formula, clocks: Iterable[Clock]) -> ltl.Formula:
    """A formula with past operators again in place of the atoms of clocks."""
    known: dict[ltl.Formula, ltl.Formula] = {}

    def written(part: ltl.Formula) -> ltl.Formula:
        if isinstance(part, ltl.Unary | ltl.Binary):
            return ltl.with_operands(part, written)
        return known.get(part, part)

    for own in clocks:
        sides = written(own.left), written(own.right)
        known[own.atom] = ltl.Binary(ltl.BinaryOperator.SINCE, *sides, own.bound)
    return written(formula)


def definition(memory: Memory) -> ltl.Formula:
    """The defining formula of a memory.

    The memory is false at the first instant, then the formula's value at the previous instant.
    """
    first = ltl.Unary(NOT, memory.atom)
    then = ltl.Unary(ltl.UnaryOperator.WEAK_NEXT, memory.atom)
    then_not = ltl.Unary(ltl.UnaryOperator.WEAK_NEXT, first)
    was = ltl.Binary(ltl.BinaryOperator.IMPLIES, memory.formula, then)
    was_not = ltl.Binary(OR, memory.formula, then_not)
    return ltl.Binary(
        AND, first, ltl.Unary(ltl.UnaryOperator.ALWAYS, ltl.Binary(AND, was, was_not))
    )


@dataclass(slots=True)
class _PastParts:
    """The registers and memories of a formula so far, by content."""

    with_registers: bool
    clocks: dict[tuple[ltl.Formula, ltl.Formula, ltl.Bound], Clock] = field(default_factory=dict)
    memories: dict[ltl.Formula, Memory] = field(default_factory=dict)
    sinces: dict[tuple[ltl.Formula, ltl.Formula, Range], ltl.Formula] = field(default_factory=dict)
    order: dict[ltl.Formula, int] = field(default_factory=dict)

    def fresh(self, kind: str) -> ltl.Atom:
        # Atoms of a rulebook contain no space.
        atom = ltl.Atom(f"{kind} {len(self.order)}")
        self.order[atom] = len(self.order)
        return atom

    def is_settled(self, formula: ltl.Formula) -> bool:
        """Whether the word up to an instant determines the formula, so a register can use it."""
        if not self.with_registers:
            return False
        unsettled = {memory.atom for memory in self.memories.values()}
        return not looks_elsewhere(formula) and unsettled.isdisjoint(ltl.atoms_of(formula))


def _present(formula: ltl.Formula, past: _PastParts) -> ltl.Formula:
    if not isinstance(formula, ltl.Unary | ltl.Binary):
        return formula
    operation = ltl.with_operands(formula, lambda operand: _present(operand, past))
    if operation.operator not in PAST:
        return operation
    span = bound_of(operation)
    if isinstance(operation, ltl.Binary):
        return _since(operation.left, operation.right, span, past)
    inner = operation.operand
    if operation.operator in (ltl.UnaryOperator.WEAK_PREVIOUSLY, ltl.UnaryOperator.HISTORICALLY):
        return ltl.Unary(NOT, _since(ltl.Constant(True), ltl.Unary(NOT, inner), span, past))
    return _since(ltl.Constant(True), inner, span, past)


def _since(
    left: ltl.Formula, right: ltl.Formula, bound: ltl.Bound, past: _PastParts
) -> ltl.Formula:
    if past.is_settled(left) and past.is_settled(right):
        # The same operator on the same operands needs no second register.
        key = (left, right, bound)
        if key not in past.clocks:
            past.clocks[key] = Clock(past.fresh("register"), left, right, bound)
        return past.clocks[key].atom
    return _unfolded(left, right, range_of_bound(bound), past)


def _unfolded(left: ltl.Formula, right: ltl.Formula, span: Range, past: _PastParts) -> ltl.Formula:
    """``left since right`` in terms of the present and the previous instant.

    Built from the shortest range to the requested one; each uses the memory of the one before.
    """
    key = (left, right, span)
    known = past.sinces.get(key)
    if known is not None:
        return known
    low, high = span
    if high is None:
        before = past.fresh("memory")
        now: ltl.Formula = ltl.Binary(OR, right, ltl.Binary(AND, left, before))
        past.memories[now] = Memory(before, now)
    else:
        now = right
        for _ in range(high - low):
            now = ltl.Binary(OR, right, ltl.Binary(AND, left, _one_ago(now, past)))
    for _ in range(low):
        now = ltl.Binary(AND, left, _one_ago(now, past))
    past.sinces[key] = now
    return now


def _one_ago(formula: ltl.Formula, past: _PastParts) -> ltl.Formula:
    if past.is_settled(formula):
        return _since(ltl.Constant(True), formula, PREVIOUS, past)
    if formula not in past.memories:
        past.memories[formula] = Memory(past.fresh("memory"), formula)
    return past.memories[formula].atom
