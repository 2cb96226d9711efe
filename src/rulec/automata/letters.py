"""Which letters a rule meets: the values of what it reads, an enumeration having exactly one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import prod

from rulec.automata.machine import Read
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
from rulec.vocabulary import Enumeration, Vocabulary

NOT, AND, OR = UnaryOperator.NOT, BinaryOperator.AND, BinaryOperator.OR


def reads_of(formula: Formula, vocabulary: Vocabulary) -> tuple[Read, ...]:
    """What the formula reads, in the order in which it first mentions it."""
    used: dict[tuple[str, tuple[str, ...]], set[str]] = {}
    for atom in atoms_of(formula):
        used.setdefault((atom.name, atom.arguments), set()).add(atom.value or "")
    return tuple(
        _read(name, variables, values, vocabulary) for (name, variables), values in used.items()
    )


def _read(name: str, variables: tuple[str, ...], used: set[str], vocabulary: Vocabulary) -> Read:
    declaration = vocabulary.declarations[name]
    if not isinstance(declaration, Enumeration):
        return Read(name, variables)
    values = tuple(value for value in declaration.values if value in used)
    return Read(name, variables, values, others=len(values) < len(declaration.values))


def count_letters(reads: tuple[Read, ...]) -> int:
    """How many letters these reads make."""
    return prod(read.size for read in reads)


def letters_with(reads: tuple[Read, ...]) -> dict[Atom, int]:
    """For every atom the set of letters in which it is true, as the bits of an integer."""
    total = count_letters(reads)
    sets: dict[Atom, int] = {}
    stride = 1
    for read in reads:
        period = stride * read.size
        repeated = _repeat((1 << stride) - 1, period, total)
        if read.values:
            for digit, value in enumerate(read.values):
                sets[Atom(read.name, read.variables, value)] = repeated << (digit * stride)
        else:
            sets[Atom(read.name, read.variables)] = repeated << stride
        stride = period
    return sets


def _repeat(pattern: int, period: int, total: int) -> int:
    """``pattern`` once every ``period`` bits, up to ``total`` bits, a multiple of the period."""
    return pattern * (((1 << total) - 1) // ((1 << period) - 1))


def knowledge(reads: tuple[Read, ...]) -> Formula:
    """What the vocabulary knows of these reads: at any instant one value, no more and no less."""
    facts: list[Formula] = []
    for read in reads:
        atoms: list[Formula] = [Atom(read.name, read.variables, value) for value in read.values]
        facts += [Unary(NOT, Binary(AND, one, other)) for one, other in combinations(atoms, 2)]
        if atoms and not read.others:
            facts.append(_joined(OR, atoms))
    return _joined(AND, facts) if facts else Constant(True)


def _joined(operator: BinaryOperator, formulas: Sequence[Formula]) -> Formula:
    """The formulas under one operator, as a tree no deeper than it has to be."""
    if len(formulas) == 1:
        return formulas[0]
    half = len(formulas) // 2
    left, right = _joined(operator, formulas[:half]), _joined(operator, formulas[half:])
    return Binary(operator, left, right)
