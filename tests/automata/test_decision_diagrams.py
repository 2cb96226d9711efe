"""The compiler without Spot: the same monitors, number for number, and the same languages."""

from dataclasses import replace
from fractions import Fraction
from itertools import product
from pathlib import Path

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rulec.automata import compiler
from rulec.automata.alphabet import propositions_of, reads_of
from rulec.automata.axiom_groups import axiom_groups
from rulec.automata.compiler_jobs import Done, Failed, Job
from rulec.automata.decision_diagrams.diagram_compiler import COMPILER
from rulec.automata.decision_diagrams.diagrams import TRUE, Diagrams
from rulec.automata.decision_diagrams.symbolic_automaton import SymbolicAutomaton, merged
from rulec.automata.mealy_monitor import IMPOSSIBLE, Read
from rulec.diagnostics import RulecError
from rulec.logic.formula import Atom, Binary, BinaryOperator, Bound, Unary, UnaryOperator
from rulec.logic.semantics import holds
from rulec.rulebook.reading.rulebook_reader import read_rulebook
from rulec.rulebook.rulebook_model import Axiom
from rulec.rulebook.rules.axiom_instances import AxiomInstance
from support.asked_compilers import machine_by
from support.builders.rulebooks import P, Q, always, book, eventually, implies, rule
from support.generators.random_formulas import ATOMS
from support.generators.timed_formulas import (
    TIMED_VOCABULARY,
    letter_number,
    letters_of,
    timed_formulas,
    timed_words,
)

NOT, OR = UnaryOperator.NOT, BinaryOperator.OR
RULEBOOKS = Path(__file__).parents[2] / "rulebooks"


def job(formula, semantics="stutter"):
    reads = reads_of(formula, TIMED_VOCABULARY)
    return Job("rule", formula, reads, ("a rule",), semantics, ())


def in_reach(formula, semantics):
    answer = machine_by(job(formula, semantics), COMPILER)
    assume(answer != Failed("reach"))
    assert isinstance(answer, Done)
    return answer


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@given(timed_formulas, timed_words)
def test_its_verdict_is_that_of_the_definitions(semantics, formula, word):
    machine = in_reach(formula, semantics).machine
    state, verdict = 0, None
    for values in word:
        symbol = machine.letters[letter_number(machine.reads, values)]
        state, verdict = machine.successors[state][symbol], machine.outputs[state][symbol]
    assert verdict == holds(formula, letters_of(formula, word), semantics)


def the_same_as_spots(formula, semantics):
    spot_bridge = pytest.importorskip("rulec.automata.spot_bridge")
    own = in_reach(formula, semantics)
    other = machine_by(job(formula, semantics), spot_bridge.COMPILER)
    assert own.machine == other.machine
    return own, other


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@given(timed_formulas)
def test_its_automaton_has_the_language_of_spots(semantics, formula):
    spot = pytest.importorskip("spot")
    own, other = (spot.automaton(each.hoa) for each in the_same_as_spots(formula, semantics))
    assert spot.are_equivalent(own, other)
    assert spot.is_deterministic(own)
    assert spot.is_complete(own)


@pytest.mark.parametrize(
    ("name", "step_s"),
    [
        ("esterle2019", "1"),
        *(
            pytest.param(file.stem, step, marks=pytest.mark.long)
            for file in sorted(RULEBOOKS.rglob("*.rules"))
            if not file.is_relative_to(RULEBOOKS / "vocabulary")
            for step in ("1", "0.1")
        ),
    ],
)
def test_shipped_rules_have_the_monitors_and_languages_of_spot(name, step_s):
    spot = pytest.importorskip("spot")
    rulebook = read_rulebook(name).rulebook
    lowered = compiler.lower(rulebook, Fraction(step_s))
    jobs = [compiler._job(rulebook, each, with_texts=True) for each in lowered.rules]
    answers, _ = compiler.answers_to(jobs)
    for each, other in zip(jobs, answers, strict=True):
        own = machine_by(each, COMPILER)
        assert own.machine == other.machine, each.name
        automata = (spot.automaton(one.hoa) for one in (own, other))
        assert spot.are_equivalent(*automata), each.name


def test_letters_that_facts_exclude_have_no_class():
    """A fact about what the rule does not read excludes letters all the same."""
    red, green, near = ATOMS[3], ATOMS[4], ATOMS[0]
    facts = [Axiom((), implies(P, green)), Axiom((), implies(near, red))]
    formula = always(implies(P, near))
    groups = axiom_groups(
        propositions_of(formula),
        [AxiomInstance(fact, (), fact.formula) for fact in facts],
        TIMED_VOCABULARY,
    )
    machine = machine_by(replace(job(formula), groups=groups), COMPILER).machine
    excluded = [number for number, symbol in enumerate(machine.letters) if symbol == IMPOSSIBLE]
    assert machine.reads == (Read("p", ()), Read("place", ("x",), ("near",), others=True))
    assert excluded == [1]  # p and near


@pytest.mark.usefixtures("compiled_anew")
@pytest.mark.parametrize("choice", [pytest.param("spot", marks=pytest.mark.spot), "diagrams"])
def test_counts_of_which_letters_leave_one_are_no_product(choice):
    """Together the counts have 160,000 values, of which letters that can be lead to 802."""
    near, far, gone = (Atom("place", ("x",), value) for value in ("near", "far", "gone"))
    counts = [
        Binary(BinaryOperator.SINCE, gone, one, Bound(Fraction(0), Fraction(400), "steps"))
        for one in (near, far)
    ]
    demands = [implies(one, count) for one, count in zip((P, Q), counts, strict=True)]
    asked = job(always(Binary(BinaryOperator.AND, *demands)))
    ((answer,), _) = compiler.answers_to([asked], choice=choice)
    assert isinstance(answer, Done)
    # That neither is due, how long one still is, and that it is broken
    assert len(answer.machine.successors) == 1 + 2 * 400 + 1


@pytest.fixture
def without_spot(monkeypatch):
    monkeypatch.setattr(
        compiler, "_WORKER", "import sys; sys.modules['spot'] = None\n" + compiler._WORKER
    )


def compiled(*formulas):
    rules = [rule(f"r{number}", formula) for number, formula in enumerate(formulas)]
    return compiler.compile_rulebook(book(*rules))


@pytest.mark.usefixtures("without_spot", "compiled_anew")
def test_without_spot_it_compiles_what_is_in_its_reach():
    nested = always(Binary(OR, always(eventually(P)), Unary(NOT, Q)))
    with pytest.raises(RulecError) as caught:
        compiled(always(implies(P, eventually(Q))), nested)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "R0403"
    assert "`r1`" in diagnostic.message
    assert "conda" in diagnostic.help


@pytest.mark.usefixtures("compiled_anew")
def test_who_asks_for_diagrams_gets_no_other(monkeypatch):
    monkeypatch.setenv("RULEC_COMPILER", "diagrams")
    result = compiled(always(implies(P, eventually(Q))))
    assert result.spot == ""
    assert len(result.rules[0].machine.successors) == 2  # whether somebody waits


@pytest.mark.usefixtures("compiled_anew")
def test_a_compiler_that_there_is_not_is_refused(monkeypatch):
    monkeypatch.setenv("RULEC_COMPILER", "spott")
    with pytest.raises(RulecError) as caught:
        compiled(P)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "R0416"
    assert "spot" in diagnostic.help


def steps_of(size):
    """Of each state where it leads, with which mark, on each of two letters."""
    step = st.tuples(st.integers(0, size - 1), st.integers(0, 1))
    return st.lists(st.tuples(step, step), min_size=size, max_size=size)


@given(st.integers(1, 12).flatmap(steps_of), st.lists(st.integers(0, 1), max_size=20))
def test_states_are_merged_that_no_word_tells_apart(steps, word):
    diagrams = Diagrams()
    diagrams.declare("p")
    p = diagrams.variable("p")
    rows = []
    for yes, no in steps:
        rows.append({yes: TRUE} if yes == no else {yes: p, no: -p})
    small = merged(SymbolicAutomaton(tuple(rows)), diagrams).edges

    blocks = [0] * len(steps)
    for _ in steps:  # so many rounds suffice
        keys = [
            (block, *((blocks[target], mark) for target, mark in row))
            for block, row in zip(blocks, steps, strict=True)
        ]
        numbers = {key: number for number, key in enumerate(dict.fromkeys(keys))}
        blocks = [numbers[key] for key in keys]
    assert len(small) == len(set(blocks))

    one = another = 0
    for letter in word:
        one, mark = steps[one][letter]
        taken = [edge for edge, way in small[another].items() if way in (TRUE, (p, -p)[letter])]
        assert [mark] == [taken_mark for _, taken_mark in taken]
        ((another, _),) = taken


NAMES = tuple("abcd")

STEPS = st.one_of(
    st.tuples(st.just("ite"), *[st.integers(-20, 20)] * 3),
    st.tuples(
        st.just("given"), st.integers(), st.dictionaries(st.sampled_from(NAMES), st.booleans())
    ),
    st.tuples(st.just("for_some"), st.integers(), st.sets(st.sampled_from(NAMES))),
)
ALL_VALUES = [dict(zip(NAMES, values, strict=True)) for values in product((False, True), repeat=4)]


def value_of(diagrams, function, values):
    while abs(function) != TRUE:
        name, low, high = diagrams.parts(function)
        function = high if values[name] else low
    return function == TRUE


@given(st.lists(STEPS, min_size=1, max_size=30))
def test_functions_are_their_truth_tables_and_equal_ones_one_number(steps):
    """The tables are computed beside them, row by row; a negation has the opposite sign."""
    diagrams = Diagrams()
    for name in NAMES:
        diagrams.declare(name)
    functions = [TRUE, *map(diagrams.variable, NAMES)]
    tables = [[True] * 16, *[[values[name] for values in ALL_VALUES] for name in NAMES]]

    def picked(number):
        place = abs(number) % len(functions)
        if number < 0:
            return -functions[place], [not value for value in tables[place]]
        return functions[place], tables[place]

    for kind, first, *rest in steps:
        function, table = picked(first)
        if kind == "ite":
            (yes, if_yes), (no, if_no) = map(picked, rest)
            functions.append(diagrams.ite(function, yes, no))
            rows = zip(table, if_yes, if_no, strict=True)
            tables.append([one if test else other for test, one, other in rows])
            continue
        functions.append(getattr(diagrams, kind)(function, *rest))
        fixed = rest[0] if kind == "given" else {}
        open_ones = rest[0] if kind == "for_some" else set()
        tables.append(
            [
                any(
                    value
                    for other, value in zip(ALL_VALUES, table, strict=True)
                    if all(
                        other[name] == fixed.get(name, values[name])
                        for name in NAMES
                        if name not in open_ones
                    )
                )
                for values in ALL_VALUES
            ]
        )
    numbers = {}
    for function, table in zip(functions, tables, strict=True):
        assert [value_of(diagrams, function, values) for values in ALL_VALUES] == table
        read = {
            name
            for name in NAMES
            if diagrams.given(function, {name: True}) != diagrams.given(function, {name: False})
        }
        assert diagrams.variables(function) == read
        assert numbers.setdefault(tuple(table), function) == function
        assert numbers.setdefault(tuple(not value for value in table), -function) == -function
