"""Reads looked at in parts come to what they do when all are looked at together."""

from fractions import Fraction
from itertools import product
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rulec
from rulec.automata.outcome_machine import bits_of
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.state_letters.completions.completions import joint_digits
from rulec.monitoring.uncertainty.state_letters.entangled_reads import (
    EntangledReads,
    NothingKnown,
    local_reads,
)
from rulec.monitoring.uncertainty.state_letters.read_digits import read_digits
from rulec.monitoring.uncertainty.state_letters.reads_apart import KnownParts
from rulec.monitoring.uncertainty.state_letters.related_facts import instances_of
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import MissingValueError
from rulec.vocabulary import Enumeration, Quantity
from rulec.vocabulary.partial_values import UNKNOWN, Interval, OneOf
from rulec.vocabulary.vocabulary_model import choices
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
    joint = joint_digits(own, binding, state, instances_of(reads._axioms, state))
    return tuple(tuple(1 << n for n in one) for one in sorted(joint.digits)), joint.exact


def known(chance, declaration):
    if isinstance(declaration, Enumeration):
        return chance.choice(declaration.values)
    if isinstance(declaration, Quantity):
        return chance.choice([0.0, 30.0, 50.0])
    return chance.random() < 0.5


def one_between(chance, declarations):
    """Values that are known but for one number, whose ends are at, or beside, what rules say."""
    values = [known(chance, declaration) for declaration in declarations]
    numbers = [n for n, own in enumerate(declarations) if isinstance(own, Quantity)]
    if numbers:
        low = chance.choice([0.0, 29.9, 30.0, 49.9, 50.0, 50.1, 99.9])
        values[chance.choice(numbers)] = Interval(low, low + chance.choice([0.0, 0.1, 0.2, 20.1]))
    return tuple(values)


def of_any_kind(chance, declarations):
    return tuple(drawn(chance, declaration) for declaration in declarations)


def agree_in_parts(chance, compiled, rule, draw=of_any_kind, times=8):
    """Whether there are reads to look at; if so, all that is drawn of them has to agree."""
    reads = local_reads(rule, compiled)
    if reads is None or not reads.numbers:
        return False
    objects = {variable.name: variable.type for variable in rule.variables}
    declared = [compiled.vocabulary.declarations[name] for name, _ in reads.subjects]
    for _ in range(times):
        values = draw(chance, declared)
        lacking, expected = outcome(together, reads, rule, objects, compiled.vocabulary, values)
        missing, found = outcome(reads.number, values)
        assert missing == lacking, (rule, values)
        if expected is not None:
            assert is_told(reads.joint_letters[found], expected), (rule, values)
    return True


def is_told(found, expected):
    """Whether it is the same, or exactly so where too much was to be looked at together."""
    if found == expected:
        return True
    (letters, exact), (at_most, all_seen) = found, expected
    return exact and not all_seen and set(letters) <= set(at_most)


@given(seeds)
def test_in_parts_as_together(chance):
    compiled = compile_here(rulebook(chance, Fraction(1)), Fraction(1))
    for rule in compiled.rules:
        agree_in_parts(chance, compiled, rule)


@pytest.mark.parametrize("name", ["vienna", "de", "us-ca"])
def test_of_law_that_reads_much_in_parts_as_together(name):
    chance = Random(name)
    compiled = rulec.compile_rulebook(name).fitted_to(1)
    assert sum([agree_in_parts(chance, compiled, rule) for rule in compiled.rules]) > 10


def test_of_parts_one_is_decided_by_facts_and_another_contradicts_them():
    compiled = rulec.compile_rulebook("vienna").fitted_to(1)
    (rule,) = [one for one in compiled.rules if one.name == "position_when_turning"]
    in_middle = OneOf(frozenset({"middle_lane"}))
    said = {"level_crossing_zone": False, "enters_junction": UNKNOWN, "junction_zone": False}
    said |= {"enters_level_crossing": False, "surface": "tram_track"}

    def draw(_chance, _declared):
        known = {**said, "lane": in_middle, "lanes": "one_lane"}
        return tuple(known[name] for name, _ in local_reads(rule, compiled).subjects)

    assert agree_in_parts(None, compiled, rule, draw, 1)


def test_of_law_with_one_number_between_others_in_parts_as_together():
    chance = Random(17)
    compiled = rulec.compile_rulebook("de").fitted_to(1)
    several = [agree_in_parts(chance, compiled, x, one_between, 60) for x in compiled.rules]
    assert sum(several) > 10


SUMS = """
rulebook sums
quantity a in m default 0
quantity b in m default 0
signal   p
hard rule r {
  require always (p or FIRST or SECOND or THIRD)
}
"""
NEAR = st.integers(-4, 4).map(float)
SUM = st.tuples(st.integers(-2, 2), st.integers(-2, 2), st.integers(-3, 3)).filter(any)


@given(
    st.lists(SUM, min_size=3, max_size=3),
    st.lists(st.tuples(NEAR, NEAR, st.booleans(), NEAR, NEAR), min_size=20, max_size=20),
)
def test_of_two_numbers_between_others_in_parts_as_together(sums, drawn_values):
    """Lines that cross in, beside or at corners of small rectangles, or are parallel, or none."""
    text = SUMS
    for place, (first, second, limit) in zip(("FIRST", "SECOND", "THIRD"), sums, strict=True):
        text = text.replace(place, f"{first} * a + {second} * b <= {limit} m")
    compiled = compile_here(rulec.parse_rulebook(text), Fraction(1))
    (rule,) = compiled.rules
    values = iter(drawn_values)

    def draw(_chance, declared):
        low, high, truth, least, most = next(values)
        known = {"a": Interval(*sorted((low, high))), "b": Interval(*sorted((least, most)))}
        return tuple(known.get(one.name, truth) for one in declared)

    agree_in_parts(None, compiled, rule, draw, len(drawn_values))


def outcome(call, *given):
    """The subject whose value is missing, if one is, and what is returned."""
    try:
        return None, call(*given)
    except MissingValueError as missing:
        return missing.subject, None


def agree_on_who_counts(chance, compiled, rule, objects):
    """Whether each who may count is looked at by himself; if so, all that is drawn has to agree."""
    kinds = [variable.type for variable in rule.variables]
    (*_, chosen) = [(), *choices(kinds, objects, compiled.vocabulary)]
    if len(chosen) < len(kinds) or local_reads(rule, compiled) is not None:
        return False
    binding = {variable.name: x for variable, x in zip(rule.variables, chosen, strict=True)}
    asked = rule, binding, compiled.axioms, NothingKnown(objects, compiled.vocabulary)
    together, apart = EntangledReads(*asked), EntangledReads(*asked, known=KnownParts())
    if apart._apart is None:
        return False
    declared = [compiled.vocabulary.declarations[name] for name, _ in apart.subjects]
    for _ in range(12):
        values = tuple(drawn(chance, declaration) for declaration in declared)
        lacking, expected = outcome(together.number, values, objects)
        missing, found = outcome(apart.number, values, objects)
        assert missing == lacking, (rule, values)
        if expected is not None:
            (letters, is_exact), (own, _) = (
                together.joint_letters[expected],
                apart.joint_letters[found],
            )
            assert set(own) == set(spelled(letters)) or (not is_exact and set(own) < set(letters))
    return True


def spelled(letters):
    """Letters one by one."""
    return [tuple(1 << n for n in one) for cube in letters for one in product(*map(bits_of, cube))]


@given(seeds)
def test_each_who_may_count_by_himself_as_all_together(chance):
    compiled = compile_here(rulebook(chance, Fraction(1)), Fraction(1))
    kinds = list(compiled.vocabulary.types)
    objects = {f"o{n}": chance.choice(kinds) for n in range(chance.randint(1, 4))} if kinds else {}
    for rule in compiled.rules:
        agree_on_who_counts(chance, compiled, rule, objects)


def test_of_law_who_may_count_by_himself_as_all_together():
    chance = Random("who counts")
    compiled = rulec.compile_rulebook("de").fitted_to(1)
    cars = {"a": "car", "b": "car"}
    own = [rule for rule in compiled.rules if agree_on_who_counts(chance, compiled, rule, cars)]
    assert [rule.name for rule in own] == ["keep_near_side", "speed_limit_by_class"]
