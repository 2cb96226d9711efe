"""Conditions in words: read back, they are true of exactly the letters that they stand for."""

import re
from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Threshold
from rulec.logic.formula import Atom, Comparison, Count, QuantityTerm
from rulec.report.automata.automaton_model import automaton_of
from rulec.report.verdicts.guard_text import GuardWording
from support.generators.random_machines import READS, VOCABULARY, machines

SPEED = {0: Fraction(2), 1: Fraction(3), 2: Fraction(4), 3: Fraction(7)}
"""A number for each digit of the speed that is read."""

PLACES = {0: "near", 1: "far", 2: "gone"}


def rule_with(machine, formula=Atom("p")):  # noqa: B008 - frozen
    return CompiledRule("r", "hard", (), "", "", formula, machine, "")


def is_true(text, world):
    """A reader of conditions that knows the world, and nothing of how they were made."""
    if text.startswith("(") and closes(text):
        return is_true(text[1:-1], world)
    among = re.fullmatch(r"(\w+(?:\(\w+\))?) is (neither |none of )?([\w, ]+)", text)
    if among:
        values = set(re.split(r", or |, | or | nor ", among[3]))
        return (world[among[1]] in values) != bool(among[2])
    for joint, combine in ((" or ", any), (" and ", all)):
        parts = split(text, joint)
        if len(parts) > 1:
            return combine([is_true(part, world) for part in parts])
    if text.startswith("not "):
        return not is_true(text[4:], world)
    compared = re.fullmatch(r"(\w+) (<|<=|=|!=|>=|>) ([\d.]+) km/h", text)
    if compared:
        number, limit = world[compared[1]], Fraction(compared[3])
        return {
            "<": number < limit,
            "<=": number <= limit,
            "=": number == limit,
            "!=": number != limit,
            ">=": number >= limit,
            ">": number > limit,
        }[compared[2]]
    if text in ("true", "false"):
        return text == "true"
    value, _, arguments = text.partition("(")
    return world[f"place({arguments}"] == value if arguments else world[text]


def closes(text):
    depth = 0
    for index, character in enumerate(text):
        depth += (character == "(") - (character == ")")
        if not depth:
            return index == len(text) - 1
    return False


def split(text, joint):
    parts, depth, start = [], 0, 0
    for index, character in enumerate(text):
        depth += (character == "(") - (character == ")")
        if not depth and text.startswith(joint, index):
            parts.append(text[start:index])
            start = index + len(joint)
    return [*parts, text[start:]]


def worlds(reads):
    """Every letter with what it says of the world; what is not read is nowhere looked for."""
    for letter, digits in enumerate(product(*(range(read.size) for read in reversed(reads)))):
        world = {}
        for read, digit in zip(reads, reversed(digits), strict=True):
            if isinstance(read, NumberRead):
                world["speed"] = SPEED[digit]
            elif read.values:
                world["place(x)"] = PLACES[digit]
            else:
                world[read.name] = bool(digit)
        yield letter, world


@given(machines())
def test_what_is_said_shares_out_the_letters(machine):
    automaton = automaton_of(rule_with(machine), VOCABULARY)
    for letter, world in worlds(machine.reads):
        symbol = machine.letters[letter]
        if symbol == IMPOSSIBLE:
            continue
        for state, row in enumerate(machine.successors):
            true = [
                one
                for one in automaton.transitions
                if one.source == state and is_true(one.condition, world)
            ]
            assert [(one.target, one.accepted) for one in true] == [
                (row[symbol], machine.outputs[state][symbol])
            ]


def cube(p=(0, 1), place=(0, 1, 2), speed=(0, 1, 2, 3), q=(0, 1)):
    return tuple(frozenset(digits) for digits in (p, place, speed, q))


@pytest.mark.parametrize(
    ("cubes", "text"),
    [
        ([cube()], "true"),
        ([cube(p=[1])], "p"),
        ([cube(p=[0], place=[0])], "not p and near(x)"),
        ([cube(place=[0, 1])], "place(x) is near or far"),
        ([cube(place=[2])], "place(x) is gone or lost"),
        ([cube(place=[1, 2])], "not near(x)"),
        ([cube(place=[0, 1], q=[1])], "(place(x) is near or far) and q"),
        ([cube(speed=[0])], "speed < 3 km/h"),
        ([cube(speed=[0, 1])], "speed <= 3 km/h"),
        ([cube(speed=[1])], "speed = 3 km/h"),
        ([cube(speed=[0, 2, 3])], "speed != 3 km/h"),
        ([cube(speed=[2, 3])], "speed > 3 km/h"),
        ([cube(speed=[2])], "speed > 3 km/h and speed < 5 km/h"),
        ([cube(speed=[0, 3], p=[1])], "p and (speed < 3 km/h or speed >= 5 km/h)"),
        ([cube(p=[1]), cube(q=[1], speed=[3])], "p or (speed >= 5 km/h and q)"),
    ],
)
def test_the_words(cubes, text):
    machine = MealyMonitor(READS, (0,) * 48, ((0,),), ((True,),), None, 0)
    assert GuardWording(rule_with(machine), VOCABULARY).condition(cubes) == text


GAPS = (
    (Fraction(1), QuantityTerm("gap", ("v",))),
    (Fraction(-5, 9), QuantityTerm("speed")),
)


@pytest.mark.parametrize(
    ("formula", "digit", "text"),
    [
        (Comparison(GAPS, ">=", Fraction(0), "gap(v) >= 2 s * speed"), 1, "gap(v) >= 2 s * speed"),
        (Comparison(GAPS, ">=", Fraction(0), "gap(v) >= 2 s * speed"), 0, "gap(v) < 2 s * speed"),
        # Written the other way around, it is denied the other way around.
        (Comparison(GAPS, ">=", Fraction(0), "2 s * speed <= gap(v)"), 0, "2 s * speed > gap(v)"),
        (Atom("p"), 1, "gap(v) - 5/9 * speed >= 0"),
    ],
)
def test_a_comparison_is_said_as_the_rulebook_says_it(formula, digit, text):
    read = NumberRead(GAPS, (Threshold(Fraction(0), inclusive=True),))
    machine = MealyMonitor((read,), (0, 0), ((0,),), ((True,),), None, 0)
    wording = GuardWording(rule_with(machine, formula), VOCABULARY)
    assert wording.condition([(frozenset({digit}),)]) == text


def test_a_count_that_holds_a_comparison_is_denied_as_a_whole():
    body = Comparison(((Fraction(1), QuantityTerm("speed")),), "<", Fraction(3), "speed < 3 km/h")
    terms = ((Fraction(1), Count("x", "thing", body)),)
    text = "count x: thing (speed < 3 km/h) >= 8"
    read = NumberRead(terms, (Threshold(Fraction(8), inclusive=True),))
    machine = MealyMonitor((read,), (0, 0), ((0,),), ((True,),), None, 0)
    wording = GuardWording(
        rule_with(machine, Comparison(terms, ">=", Fraction(8), text)), VOCABULARY
    )
    assert wording.condition([(frozenset({0}),)]) == f"not ({text})"
