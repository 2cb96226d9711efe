"""The past as a memory: operators of the past give way to propositions about the instant before.

An operator of the past needs no more of the past than its own value one instant ago: `once p` holds
if p does or `once p` did. What did is a fresh proposition, a memory, that is false at the first
instant and afterwards what the operator was (the expansion laws of Lichtenstein, Pnueli, Zuck,
"The glory of the past", 1985). What is left speaks of the present and the future alone.
"""

from __future__ import annotations

from dataclasses import dataclass

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Constant,
    Formula,
    Unary,
    UnaryOperator,
    atoms_of,
)

NOT, AND, OR = UnaryOperator.NOT, BinaryOperator.AND, BinaryOperator.OR

_AT_FIRST: dict[UnaryOperator | BinaryOperator, bool] = {
    UnaryOperator.PREVIOUSLY: False,
    UnaryOperator.WEAK_PREVIOUSLY: True,
    UnaryOperator.ONCE: False,
    UnaryOperator.HISTORICALLY: True,
    BinaryOperator.SINCE: False,
}
"""The operators of the past, and what each memory says where there is no instant before."""

_BOOLEAN = frozenset((NOT, AND, OR, BinaryOperator.IMPLIES, BinaryOperator.IFF, BinaryOperator.XOR))


@dataclass(frozen=True, slots=True)
class Memory:
    """The proposition ``atom``: did ``formula`` hold one instant ago?

    ``at_first`` is its value at the first instant. ``formula`` has no operator of the past; it may
    speak of memories, of this one too. ``settled``: no operator of the future has a say in it, so
    that the word up to an instant decides what is remembered there.
    """

    atom: Atom
    at_first: bool
    formula: Formula
    settled: bool


def remembered(formula: Formula) -> tuple[Formula, tuple[Memory, ...]]:
    """The formula without operators of the past, and the memories that it speaks of.

    For any word there is one way to choose the memories' values such that each does what its
    ``definition`` says; with these it holds at the first instant if the formula does.
    """
    memories: dict[Formula, Memory] = {}
    present = _present(formula, memories)
    if not memories:
        return formula, ()
    at_first = _at_first(present, {one.atom: one.at_first for one in memories.values()})
    needed: list[Memory] = []
    spoken_of = set(atoms_of(at_first))
    # A memory speaks of itself and of earlier ones.
    for memory in reversed(memories.values()):
        if memory.atom in spoken_of:
            needed.insert(0, memory)
            spoken_of.update(atoms_of(memory.formula))
    return at_first, tuple(needed)


def _at_first(formula: Formula, values: dict[Atom, bool]) -> Formula:
    """The same, with the memories' first values where it speaks of the first instant alone."""
    match formula:
        case Atom() if formula in values:
            return Constant(values[formula])
        case Unary(UnaryOperator.NOT, operand):
            return Unary(NOT, _at_first(operand, values))
        case Binary(operator, left, right) if operator in _BOOLEAN:
            return Binary(operator, _at_first(left, values), _at_first(right, values))
        case _:
            return formula


def definition(memory: Memory) -> Formula:
    """What makes a memory a memory: its value at the first instant, and at any after that."""
    first = memory.atom if memory.at_first else Unary(NOT, memory.atom)
    after = Unary(UnaryOperator.NEXT, memory.atom)
    always = Unary(UnaryOperator.ALWAYS, Binary(BinaryOperator.IFF, after, memory.formula))
    return Binary(AND, first, always)


def _present(formula: Formula, memories: dict[Formula, Memory]) -> Formula:
    match formula:
        case Atom() | Constant():
            return formula
        case Unary(operator, operand):
            return _unfolded(Unary(operator, _present(operand, memories)), memories)
        case Binary(between, first, second):
            left, right = _present(first, memories), _present(second, memories)
            return _unfolded(Binary(between, left, right), memories)


def _unfolded(now: Unary | Binary, memories: dict[Formula, Memory]) -> Formula:
    """What an operator whose operands do without the past says, by what was the case before."""
    at_first = _AT_FIRST.get(now.operator)
    if at_first is None:
        return now
    # The same operator on the same operands needs no second memory.
    memory = memories.get(now)
    if memory is None:
        # No atom of a rulebook has a space there.
        before = Atom(f"memory {len(memories)}")
        formula = _to_be_kept(now, before)
        unsettled = {one.atom for one in memories.values() if not one.settled}
        settled = _is_present(formula) and unsettled.isdisjoint(atoms_of(formula))
        memory = memories[now] = Memory(before, at_first, formula, settled)
    looks_at_one = now.operator in (UnaryOperator.PREVIOUSLY, UnaryOperator.WEAK_PREVIOUSLY)
    return memory.atom if looks_at_one else memory.formula


def _to_be_kept(now: Unary | Binary, before: Atom) -> Formula:
    """What one instant later is to be known: the operand of ``previously``, else the operator."""
    match now:
        case Unary(UnaryOperator.ONCE, operand):
            return Binary(OR, operand, before)
        case Unary(UnaryOperator.HISTORICALLY, operand):
            return Binary(AND, operand, before)
        case Unary(_, operand):
            return operand
        case Binary(_, left, right):
            return Binary(OR, right, Binary(AND, left, before))


def _is_present(formula: Formula) -> bool:
    """Does it speak of the present alone?"""
    match formula:
        case Atom() | Constant():
            return True
        case Unary(operator, operand):
            return operator in _BOOLEAN and _is_present(operand)
        case Binary(between, left, right):
            return between in _BOOLEAN and _is_present(left) and _is_present(right)
