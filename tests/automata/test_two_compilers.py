"""Spot and the compiler without it, held against each other: tables of 10^5 random formulas."""

from dataclasses import replace
from fractions import Fraction
from random import Random

import pytest

from rulec.automata.alphabet import count_letters, reads_of
from rulec.automata.compiler_jobs import BeyondReachError, Job
from rulec.automata.decision_diagrams.diagram_compiler import COMPILER
from rulec.automata.tables import build_machine, rows_of
from rulec.logic.formula import Binary, BinaryOperator, Bound, Unary, UnaryOperator
from support.asked_compilers import machine_by
from support.generators.timed_formulas import (
    ATOMS,
    BOOLEAN,
    DISTANCE,
    RELATIONS,
    SUMS,
    TIMED_VOCABULARY,
    comparison,
)

pytestmark = [pytest.mark.long, pytest.mark.spot]

LIMITS = [Fraction(n, 2) for n in range(-1, 6)]
COMPARISONS = [comparison(of, how, limit) for of in SUMS for how in RELATIONS for limit in LIMITS]
IN_REACH = 10_000


def bound(chance, operator):
    if operator.value in BOOLEAN or chance.random() < 0.5:
        return None
    low = Fraction(chance.randrange(4))
    if operator.value in DISTANCE:
        return Bound(low, low, "steps")
    return Bound(low, chance.choice([None, *[low + n for n in range(4)]]), "steps")


def formula(chance, n_leaves):
    if n_leaves == 1 and chance.random() < 0.6:
        return chance.choice(chance.choice([ATOMS, ATOMS, ATOMS, COMPARISONS]))
    if n_leaves == 1 or chance.random() < 0.35:
        operator = chance.choice([*UnaryOperator])
        return Unary(operator, formula(chance, n_leaves), bound(chance, operator))
    left = chance.randrange(1, n_leaves)
    operator = chance.choice([*BinaryOperator])
    both = formula(chance, left), formula(chance, n_leaves - left)
    return Binary(operator, *both, bound(chance, operator))


def machine_of(compiler, job):
    found = compiler.translate(job)
    every = (1 << count_letters(job.reads)) - 1
    possible = every if found.possible is None else found.possible
    return build_machine(rows_of(found.automaton, possible), job.reads)


@pytest.mark.parametrize("seed", range(10))
def test_ten_thousand_formulas_have_one_table(seed, record_property):
    spot_bridge = pytest.importorskip("rulec.automata.spot_bridge")
    chance = Random(seed)
    n, beyond = 0, 0
    while n < IN_REACH:
        one = formula(chance, chance.choice([1, 1, 2, 2, 3]))
        reads = reads_of(one, TIMED_VOCABULARY)
        meaning = chance.choice(["stutter", "finite"])
        job = Job("rule", one, reads, ("a rule",), meaning, ())
        try:
            own = machine_of(COMPILER, job)
        except BeyondReachError:
            beyond += 1
            continue
        n += 1
        assert own == machine_of(spot_bridge.COMPILER, job), one
        assert own == machine_by(replace(job, remarks=()), spot_bridge.COMPILER).machine, one
    record_property("beyond_reach", beyond)
