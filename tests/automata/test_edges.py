"""Edges: the cubes of a state's edges are its letters, each once."""

from itertools import product

import pytest
from hypothesis import given

from rulec.automata.guards import edges, literals
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, Read
from rulec.diagnostics import RulecError
from rulec.resource_limits import in_force
from support.builders.rulebooks import book as book_of
from support.builders.rulebooks import compile_here
from support.builders.rulebooks import rule as rule_of
from support.generators.random_formulas import formulas
from support.generators.random_machines import READS, machines


def letters_of(cubes, sizes):
    found = []
    for cube in cubes:
        for digits in product(*(sorted(allowed) for allowed in cube)):
            letter, stride = 0, 1
            for digit, size in zip(digits, sizes, strict=True):
                letter += digit * stride
                stride *= size
            found.append(letter)
    return set(found)


def possible(machine):
    return {letter for letter, symbol in enumerate(machine.letters) if symbol != IMPOSSIBLE}


def check(machine):
    sizes = [read.size for read in machine.reads]
    for state in range(len(machine.successors)):
        if state in (machine.rejecting_sink, machine.accepting_sink):
            continue
        seen = {}
        for edge in edges(machine):
            if edge.source == state:
                for letter in letters_of(edge.cubes, sizes) & possible(machine):
                    assert letter not in seen
                    seen[letter] = edge
        for letter in possible(machine):
            symbol = machine.letters[letter]
            edge = seen[letter]
            assert edge.target == machine.successors[state][symbol]
            assert edge.accepted == machine.outputs[state][symbol]
        assert sum(edge.otherwise for edge in set(seen.values())) <= 1


@given(machines())
def test_the_edges_of_a_state_share_out_the_letters(machine):
    # A class may have no letter here; then an edge has no cube, and leads nowhere.
    check(machine)


@pytest.mark.spot
@given(formulas)
def test_so_do_those_of_a_rule(formula):
    compiled = compile_here(book_of(rule_of("r", formula, "x: car"))).rules[0]
    check(compiled.machine)


@given(machines())
def test_no_cube_is_needless(machine):
    sizes = [read.size for read in machine.reads]
    for edge in edges(machine):
        whole = letters_of(edge.cubes, sizes)
        for left_out in range(len(edge.cubes)):
            fewer = edge.cubes[:left_out] + edge.cubes[left_out + 1 :]
            met = possible(machine)
            assert letters_of(fewer, sizes) & met < whole & met


def test_letters_that_no_state_has_make_conditions_shorter():
    """p and q exclude each other: where p holds, no need to say that q does not."""
    reads = (READS[0], READS[3])
    machine = MealyMonitor(
        reads, (0, 1, 0, IMPOSSIBLE), ((0, 1), (1, 1)), ((True, False), (False, False)), 1, None
    )
    cubes = {edge.target: edge.cubes for edge in edges(machine)}
    assert cubes[1] == ((frozenset({1}), frozenset({0, 1})),)


def test_what_is_easily_said_is_said_in_one_cube():
    sizes = [2, 3, 4, 2]
    letters = [
        int(p == 1 and place in (0, 2) and speed in (0, 2, 3))
        for _, speed, place, p in product(range(2), range(4), range(3), range(2))
    ]
    machine = MealyMonitor(
        READS, tuple(letters), ((0, 1), (1, 1)), ((True, False), (False, True)), None, None
    )
    stay, go = [edge for edge in edges(machine) if edge.source == 0]
    assert go.cubes == (
        (frozenset({1}), frozenset({0, 2}), frozenset({0, 2, 3}), frozenset({0, 1})),
    )
    assert literals(go.cubes, sizes) == 3
    assert stay.otherwise
    assert not go.otherwise


def test_a_condition_of_too_many_cubes_is_refused_before_it_is_put_together():
    reads = tuple(Read(f"p{number}", ()) for number in range(12))
    parity = tuple(letter.bit_count() % 2 for letter in range(1 << 12))
    machine = MealyMonitor(
        reads, parity, ((0, 1), (1, 1)), ((True, False), (False, False)), None, None
    )
    with in_force(["cubes=20"]), pytest.raises(RulecError, match="R0718") as refused:
        edges(machine, "rule `odd`")
    (said,) = refused.value.diagnostics
    assert said.message.startswith("rule `odd`: more than 20 alternatives")
