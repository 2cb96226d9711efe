"""Reads looked at in parts come to what they do when all are looked at together."""

from fractions import Fraction
from random import Random

import pytest
from hypothesis import given

import rulec
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.state_letters.completions import joint_digits
from rulec.monitoring.uncertainty.state_letters.entangled_reads import local_reads
from rulec.monitoring.uncertainty.state_letters.read_digits import read_digits
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import MissingValueError
from rulec.vocabulary import Enumeration, Quantity
from rulec.vocabulary.partial_values import UNKNOWN, Interval, OneOf
from support.builders.rulebooks import compile_here
from support.generators.random_rulebooks import rulebook
from support.generators.seeds import seeds


def drawn(chance, declaration):
    if chance.random() < 0.4:
        return UNKNOWN
    if isinstance(declaration, Enumeration):
        if chance.random() < 0.3:
            n_left = chance.randint(1, len(declaration.values))
            return OneOf(frozenset(chance.sample(declaration.values, n_left)))
        return chance.choice(declaration.values)
    if isinstance(declaration, Quantity):
        low = chance.choice([-3.0, 0.0, 2.5, 10.0])
        return chance.choice([low, Interval(low, low + 5)])
    return chance.random() < 0.5


def together(reads, rule, objects, vocabulary, values):
    state = StateView(
        with_values({}, dict(zip(reads.subjects, values, strict=True))), objects, vocabulary
    )
    binding = {name: name for name in objects}
    own = [rule.machine.reads[n] for n in reads.numbers]
    digits = [read_digits(read).in_state(binding, state) for read in own]
    if all(one & (one - 1) == 0 for one in digits):
        return (tuple(digits),), True
    joint = joint_digits(own, binding, state, reads._axioms)
    return tuple(tuple(1 << n for n in one) for one in sorted(joint.digits)), joint.exact


def agree_in_parts(chance, compiled, rule):
    """Whether there are reads to look at; if so, all that is drawn of them has to agree."""
    reads = local_reads(rule, compiled)
    if reads is None or not reads.numbers:
        return False
    objects = {variable.name: variable.type for variable in rule.variables}
    declared = [compiled.vocabulary.declarations[name] for name, _ in reads.subjects]
    for _ in range(8):
        values = tuple(drawn(chance, declaration) for declaration in declared)
        lacking, expected = outcome(together, reads, rule, objects, compiled.vocabulary, values)
        missing, found = outcome(reads.number, values)
        assert missing == lacking, (rule, values)
        if expected is not None:
            assert reads.found[found] == expected, (rule, values)
    return True


@given(seeds)
def test_in_parts_as_together(chance):
    compiled = compile_here(rulebook(chance, Fraction(1)), Fraction(1))
    for rule in compiled.rules:
        agree_in_parts(chance, compiled, rule)


@pytest.mark.parametrize("name", ["vienna", "de"])
def test_of_law_that_reads_much_in_parts_as_together(name):
    chance = Random(name)
    compiled = rulec.compile_rulebook(name).fitted_to(1)
    assert sum([agree_in_parts(chance, compiled, rule) for rule in compiled.rules]) > 10


def outcome(call, *given):
    """The subject whose value is missing, if one is, and what is returned."""
    try:
        return None, call(*given)
    except MissingValueError as missing:
        return missing.subject, None
