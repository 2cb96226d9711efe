"""Compiling: Spot in a process of its own, and what becomes of rules that explode."""

from dataclasses import replace
from functools import reduce

import pytest
from books import P, Q, always, book, far, implies, near, rule
from hypothesis import given, settings
from hypothesis import strategies as st
from words import formulas

from rulec.automata import compiler
from rulec.automata.compiler import compile_rulebook
from rulec.diagnostics import RulecError
from rulec.logic.formula import Atom, Binary, BinaryOperator, Unary, UnaryOperator
from rulec.logic.past import remembered
from rulec.logic.printing import in_spot, in_words
from rulec.rulebook.loader import load_rulebook
from rulec.rulebook.model import Rule, Rulebook
from rulec.vocabulary import Enumeration, Signal, Vocabulary


def signals(n):
    return Vocabulary("signals", {}, {f"s{i}": Signal(f"s{i}", (), False) for i in range(n)})


def chain(operator, formulas):
    return reduce(lambda left, right: Binary(operator, left, right), formulas)


def exploding():
    """Eight untils under exclusive or: every one of the 2^8 combinations matters."""
    atoms = [Atom(f"s{i}") for i in range(16)]
    untils = [Binary(BinaryOperator.UNTIL, *atoms[i : i + 2]) for i in range(0, 16, 2)]
    return chain(BinaryOperator.XOR, untils)


def test_a_rule_becomes_its_smallest_table():
    # always (near -> q): running, or lost. Letters: what of near, q matters: bad or not.
    compiled = compile_rulebook(book(rule("A", always(implies(near("x"), Q)), "x: thing")))
    machine = compiled.rules[0].machine
    assert [(read.name, read.size) for read in machine.reads] == [("place", 2), ("q", 2)]
    assert len(machine.following) == 2
    assert len(machine.following[0]) == 2
    assert machine.dead is not None
    assert machine.safe is None
    near_without_q = 0  # digit 0 is `near`, q is false
    others = {machine.letters[letter] for letter in range(4) if letter != near_without_q}
    assert len(others) == 1
    assert machine.following[0][machine.letters[near_without_q]] == machine.dead


def test_exclusive_values_make_letters_and_contradictions():
    never_both = book(
        rule("A", always(Binary(BinaryOperator.AND, near("x"), far("x"))), "x: thing")
    )
    (compiled,) = compile_rulebook(never_both).rules
    assert compiled.machine.reads[0].size == 3  # near, far, and all else
    assert compiled.machine.following == ((0,),)
    assert compiled.machine.dead == 0


@pytest.mark.parametrize("position", [0, 1, 2])
def test_a_rule_that_explodes_is_an_error_and_the_others_compile(position):
    vocabulary = signals(16)
    rules = [Rule(name, "hard", (), always(Atom("s0"))) for name in "AB"]
    rules.insert(position, Rule("Boom", "hard", (), exploding()))
    with pytest.raises(RulecError) as caught:
        compile_rulebook(Rulebook("test", vocabulary, tuple(rules)), cpu_limit_s=1)
    assert [d.code for d in caught.value.diagnostics] == ["R0401"]
    assert "Boom" in caught.value.diagnostics[0].message
    assert "rule of its own" in caught.value.diagnostics[0].help


def test_two_rules_that_explode_are_two_errors():
    rules = tuple(Rule(name, "hard", (), exploding()) for name in ("Boom", "Bang"))
    with pytest.raises(RulecError) as caught:
        compile_rulebook(Rulebook("test", signals(16), rules), cpu_limit_s=1)
    messages = [d.message for d in caught.value.diagnostics]
    assert ["Boom" in messages[0], "Bang" in messages[1], len(messages)] == [True, True, 2]


def test_too_many_letters_are_refused_without_trying():
    wide = chain(BinaryOperator.OR, [Atom(f"s{i}") for i in range(17)])
    with pytest.raises(RulecError) as caught:
        compile_rulebook(Rulebook("test", signals(17), (Rule("Wide", "hard", (), wide),)))
    assert "too many signals" in caught.value.diagnostics[0].message


def test_sixteen_signals_still_compile():
    wide = always(chain(BinaryOperator.OR, [Atom(f"s{i}") for i in range(16)]))
    (compiled,) = compile_rulebook(
        Rulebook("test", signals(16), (Rule("Wide", "hard", (), wide),))
    ).rules
    assert compiled.machine.letters.count(compiled.machine.letters[0]) == 1
    assert len(compiled.machine.letters) == 2**16


@pytest.mark.parametrize("n", [46, 150])
def test_an_enumeration_of_many_values(n):
    values = tuple(f"v{i}" for i in range(n))
    vocabulary = Vocabulary("wide", {}, {"x": Enumeration("x", (), values)})
    never_last = always(chain(BinaryOperator.OR, [Atom("x", (), v) for v in values[:-1]]))
    (compiled,) = compile_rulebook(
        Rulebook("test", vocabulary, (Rule("Wide", "hard", (), never_last),))
    ).rules
    machine = compiled.machine
    assert len(machine.letters) == n
    assert [machine.following[0][c] == machine.dead for c in machine.letters].index(True) == n - 1


def test_a_rulebook_without_rules_compiles():
    assert compile_rulebook(book()).rules == ()


def test_without_spot_the_way_out_is_named(monkeypatch):
    absent = "import sys; sys.modules['spot'] = None\n" + compiler._WORKER
    monkeypatch.setattr(compiler, "_WORKER", absent)
    with pytest.raises(RulecError) as caught:
        compile_rulebook(book(rule("A", P)))
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "R0403"
    assert "conda" in diagnostic.help


def test_a_process_that_cannot_start_is_no_traceback(monkeypatch):
    monkeypatch.setattr(compiler, "_WORKER", "raise SystemExit(3)")
    with pytest.raises(RulecError) as caught:
        compile_rulebook(book(rule("A", P)))
    assert caught.value.diagnostics[0].code == "R0403"


def test_an_automaton_that_fails_its_check_is_refused():
    """Had Spot translated `p` as `not p`, the check would not let it pass."""
    import spot

    from rulec.automata import spot_bridge

    spot_bridge._check(spot.translate("p", "parity", "det", "complete"), spot.formula("p"))
    # Another language, one too small, one too large; then the right one, but nondeterministic.
    for wrong in ("!p", "G p", "F p"):
        automaton = spot.translate(wrong, "parity", "det", "complete")
        with pytest.raises(spot_bridge.CheckError):
            spot_bridge._check(automaton, spot.formula("p"))
    with pytest.raises(spot_bridge.CheckError):
        spot_bridge._check(spot.translate("FG p", "BA"), spot.formula("FG p"))


MEMORY = '"memory 0"'
ONCE = Unary(UnaryOperator.ONCE, P)


@pytest.mark.parametrize(
    ("automaton", "why"),
    [
        (f"G(q -> (p | {MEMORY}))", "the memory is still a proposition"),
        ("G(q -> p)", "what was is forgotten"),
        ("G(q -> (p | XF p))", "what comes is taken for what was"),
        ("1", "nothing is asked for"),
    ],
)
def test_an_automaton_that_forgets_fails_its_check(automaton, why):
    """`always (q implies once p)` is `p R (p | !q)`, and nothing else passes for it."""
    import spot

    from rulec.automata import spot_bridge

    present, memories = remembered(always(implies(Q, ONCE)))
    assert len(memories) == 1
    language = spot.formula(in_spot(present))
    right = spot.translate("p R (p | !q)", "parity", "det", "complete")
    spot_bridge._check(right, language, memories)
    wrong = spot.translate(automaton, "parity", "det", "complete")
    with pytest.raises(spot_bridge.CheckError):
        spot_bridge._check(wrong, language, memories)


def test_a_rule_about_the_past_becomes_its_smallest_table():
    # always (q implies once near): not near yet, near once and safe, or lost.
    formula = always(implies(Q, Unary(UnaryOperator.ONCE, near("x"))))
    (compiled,) = compile_rulebook(book(rule("A", formula, "x: thing"))).rules
    machine = compiled.machine
    assert len(machine.following) == 3
    assert None not in (machine.dead, machine.safe)
    near_at_once = machine.letters[0]  # digit 0 is `near`, q is false
    assert machine.following[0][near_at_once] == machine.safe
    assert 'AP: 2 "q" "near(x)"' in compiled.hoa or 'AP: 2 "near(x)" "q"' in compiled.hoa
    assert "memory" not in compiled.hoa
    assert "\nStates: 3\n" in compiled.hoa
    assert in_words(compiled.formula) == "always (q implies once near(x))"


def test_what_was_before_takes_as_many_states_as_there_are_pasts():
    # always (q implies p three instants ago): the last three p, and lost. In the first three
    # instants there is no such p, as if it had been false.
    ago = reduce(lambda inner, _: Unary(UnaryOperator.PREVIOUSLY, inner), range(3), P)
    (compiled,) = compile_rulebook(book(rule("A", always(implies(Q, ago))))).rules
    assert len(compiled.machine.following) == 2**3 + 1


def test_a_past_as_deep_as_a_formula_may_be():
    deep = reduce(lambda inner, _: Unary(UnaryOperator.ONCE, inner), range(198), P)
    (deepest, plain) = compile_rulebook(
        book(rule("A", always(implies(Q, deep))), rule("B", always(implies(Q, ONCE))))
    ).rules
    assert deepest.machine == plain.machine


def test_phases_in_phases_that_explode_are_an_error():
    """On the left a sequence is said twice, and what stands in it four times."""
    deep = reduce(lambda inner, _: Binary(BinaryOperator.THEN, inner, Q), range(99), P)
    with pytest.raises(RulecError) as caught:
        compile_rulebook(book(rule("A", deep)), cpu_limit_s=1)
    assert [one.code for one in caught.value.diagnostics] == ["R0401"]


def test_a_past_that_explodes_is_an_error():
    """Which of 14 signals there have been, told apart at every instant."""
    pasts = [Unary(UnaryOperator.ONCE, Atom(f"s{i}")) for i in range(14)]
    rules = (Rule("Boom", "hard", (), always(chain(BinaryOperator.XOR, pasts))),)
    with pytest.raises(RulecError) as caught:
        compile_rulebook(Rulebook("test", signals(14), rules), cpu_limit_s=1)
    assert [one.code for one in caught.value.diagnostics] == ["R0401"]


def test_a_failed_check_is_an_error_of_its_own(monkeypatch):
    failing = """
from rulec.automata import spot_bridge
def fail(*_): raise spot_bridge.CheckError
spot_bridge._check = fail
main()
"""
    worker = compiler._WORKER.replace("\nmain()\n", failing)
    assert worker != compiler._WORKER
    monkeypatch.setattr(compiler, "_WORKER", worker)
    with pytest.raises(RulecError) as caught:
        compile_rulebook(book(rule("A", P), rule("B", Q)))
    assert [one.code for one in caught.value.diagnostics] == ["R0402", "R0402"]


def test_what_nobody_thought_of_is_a_bug_with_a_traceback(monkeypatch):
    worker = compiler._WORKER.replace(
        "\nmain()\n",
        "\nfrom rulec.automata import spot_bridge\nspot_bridge._check = None\nmain()\n",
    )
    monkeypatch.setattr(compiler, "_WORKER", worker)
    with pytest.raises(RuntimeError, match="while compiling rule A"):
        compile_rulebook(book(rule("A", P)))


@settings(max_examples=10)
@given(st.lists(formulas, min_size=2, max_size=8))
def test_a_rules_table_does_not_depend_on_its_neighbours(several):
    rules = [rule(f"r{n}", formula, "x: thing") for n, formula in enumerate(several)]
    forward = [one.machine for one in compile_rulebook(book(*rules)).rules]
    backward = [one.machine for one in compile_rulebook(book(*rules[::-1])).rules]
    assert forward == backward[::-1]
    assert compile_rulebook(book(rules[-1])).rules[0].machine == forward[-1]


def test_nor_do_the_files_of_the_papers_rules():
    source = load_rulebook("esterle2019")
    together = compile_rulebook(source).rules
    for rule_alone in together:
        (one,) = (each for each in source.rules if each.name == rule_alone.name)
        assert compile_rulebook(replace(source, rules=(one,))).rules == (rule_alone,)
    backward = compile_rulebook(replace(source, rules=source.rules[::-1])).rules
    assert backward[::-1] == together


def test_files_of_the_working_directory_are_not_imported(tmp_path, monkeypatch):
    (tmp_path / "spot.py").write_text("raise RuntimeError('not this one')")
    monkeypatch.chdir(tmp_path)
    assert compile_rulebook(book(rule("A", P))).rules
